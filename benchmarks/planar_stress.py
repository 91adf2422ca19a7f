"""Solves planar cells' beams by solid elements for their stresses, which estimates interpolate, and measures
the interpolation on beams that it has not seen.

    python benchmarks/planar_stress.py src/tactcad/families/planar/data    half an hour
    python benchmarks/planar_stress.py DIR --few                           a tenth of it, to try

Range and places as for `planar_beams`, but r/w by its logarithm. Then climbs from the worst designs of every
mode push its error further.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from math import expm1, log
from pathlib import Path

import numpy as np
from foil_elements import SITES, stresses
from numpy.typing import NDArray
from planar_beams import CLIMB, HIGH, LOW, STARTS, WIDEST_FILLET, corners, places, pushed

from tactcad.families.planar import beam as closed
from tactcad.families.planar.beam import MODES, STRESSED, FoilBeam

Array = NDArray[np.float64]
COLUMNS = [(mode, site) for mode in MODES for site in STRESSED[mode]]


def beam_at(unit: Array) -> FoilBeam:
    """The beam at a place of the unit cube; s = 1 mm, E = 1 MPa."""
    w, slender, _, nu = LOW + unit * (HIGH - LOW)
    r = w * LOW[2] * (HIGH[2] / LOW[2]) ** unit[2]
    return FoilBeam(1.0, float(w), float(1.0 / slender), float(min(r, WIDEST_FILLET)), 1.0, float(nu))


def ratios(beam: FoilBeam, modes: Sequence[str] = MODES) -> tuple[dict[str, float], dict[str, Array]]:
    """Logarithms of what solid elements say over beam theory: of the modes' stiffness, and of their stress by
    SITES, over beam theory's at that stiffness."""
    stiffness, found = stresses(beam, modes=modes)
    base, nominal = closed.base(beam), closed.nominal_stress(beam)
    k = {m: log(v / base[m]) for m, v in stiffness.items()}
    return k, {m: np.log(v / nominal[m]) - k[m] for m, v in found.items()}


def kept(by_mode: dict[str, Array]) -> list[float]:
    """Columns of the table."""
    return [float(by_mode[mode][SITES.index(site)]) for mode, site in COLUMNS]


def errors(unit: Array, points: Array, c: Array, modes: Sequence[str] = MODES) -> list[float]:
    """Of each mode's largest stress on the whole surface, relative."""
    beam = beam_at(unit)
    told = (closed.spline(closed.place(beam)[None], points) @ c)[0]
    found = ratios(beam, modes)[1]
    most = {m: max(v for v, (mode, _) in zip(told, COLUMNS) if mode == m) for m in modes}
    return [abs(expm1(most[m] - found[m].max())) for m in modes]


def table(path: Path, names: Sequence[str], units: Array, row: Callable[[FoilBeam], list[float]]) -> Array:
    """Writes a row for each beam, once if places name it twice; numbers as they are read back."""
    beams = [beam_at(u) for u in units]
    keys = np.array([[b.width, 1.0 / b.thickness, b.fillet / b.width, b.poisson] for b in beams])
    first = np.sort(np.unique(np.round(keys, 6), axis=0, return_index=True)[1])
    lines = [",".join(["w/s", "s/t", "r/w", "nu", *names])]
    for i in first:
        lines.append(",".join([f"{v:.6g}" for v in keys[i]] + [f"{v:.5f}" for v in row(beams[i])]))
    path.write_text("\n".join(lines) + "\n", "utf-8")
    return np.array([[float(v) for v in line.split(",")] for line in lines[1:]])


def main(folder: Path, few: bool) -> None:
    share = 10 if few else 1
    train, held = np.concatenate([places(400 // share, 44), corners()]), places(80 // share, 45)
    names = [" ".join(column) for column in COLUMNS]
    data = table(folder / "beam-stress.csv", names, train, lambda beam: kept(ratios(beam)[1]))
    points = np.array(
        [closed.place(FoilBeam(1.0, w, 1.0 / s, r * w, 1.0, nu)) for w, s, r, nu in data[:, :4]]
    )
    c = closed.interpolated(points, data[:, 4:])

    def error(unit: Array, i: int) -> float:
        return errors(unit, points, c, MODES[i : i + 1])[0]

    report = {
        "source": "python benchmarks/planar_stress.py, solid elements of order 4, density 2",
        "designs": {"solved": len(data), "held_out": len(held), "climb_steps": CLIMB, "climbs": STARTS},
        "errors": pushed(
            held, np.array([errors(u, points, c) for u in held]), len(held), None if few else error, 46
        ),
    }
    (folder / "beam-stress.json").write_text(json.dumps(report, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), "--few" in sys.argv)
