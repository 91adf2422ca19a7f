"""Solves planar cells' beams by solid elements for their stresses, which estimates interpolate, and measures
the interpolation on beams that it has not seen.

    python benchmarks/planar_stress.py src/tactcad/families/planar/data    fifteen minutes
    python benchmarks/planar_stress.py DIR --few                           a tenth of it, to try

Range and places as for `planar_beams`, but r/w by its logarithm. Then a climb from the worst design of every
mode pushes its error further.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
from foil_elements import FACES, SITES, stresses
from numpy.typing import NDArray
from planar_beams import HIGH, LOW, WIDEST_FILLET, places

from tactcad.families.planar import beam as closed
from tactcad.families.planar.beam import MODES, STRESSED, FoilBeam

Array = NDArray[np.float64]
COLUMNS = [(mode, site) for mode in MODES for site in STRESSED[mode]]
CLIMB = 12


def beam_at(unit: Array) -> FoilBeam:
    """The beam at a place of the unit cube; s = 1 mm, E = 1 MPa."""
    w, slender, _, nu = LOW + unit * (HIGH - LOW)
    r = w * LOW[2] * (HIGH[2] / LOW[2]) ** unit[2]
    return FoilBeam(1.0, float(w), float(1.0 / slender), float(min(r, WIDEST_FILLET)), 1.0, float(nu))


def measured(unit: Array) -> Array:
    """Logarithms of stresses over beam theory's, (6 modes, 6 sites of the face)."""
    beam = beam_at(unit)
    stiffness, found = stresses(beam)
    base, nominal = closed.base(beam), closed.nominal_stress(beam)
    return np.log([found[m][:FACES] / nominal[m] / stiffness[m] * base[m] for m in MODES])


def kept(values: Array) -> Array:
    """Columns of the table, of designs' values."""
    return np.stack([values[:, MODES.index(m), SITES.index(site)] for m, site in COLUMNS], axis=1)


def errors(units: Array, values: Array, points: Array, c: Array) -> Array:
    """Of each mode's largest stress on the whole face, relative, (designs, modes)."""
    at = np.array([closed.place(beam_at(u)) for u in units])
    told = closed.spline(at, points) @ c
    by_mode = [told[:, [i for i, (m, _) in enumerate(COLUMNS) if m == mode]].max(axis=1) for mode in MODES]
    return np.expm1(np.stack(by_mode, axis=1) - values.max(axis=2))


def climbed(unit: Array, mode: int, points: Array, c: Array, rng: np.random.Generator) -> float:
    """Largest error found by small steps from there."""

    def error(at: Array) -> float:
        return float(abs(errors(at[None], measured(at)[None], points, c)[0, mode]))

    best, size = error(unit), 0.15
    for _ in range(CLIMB):
        near = np.clip(unit + size * rng.normal(size=4), 0.0, 1.0)
        found = error(near)
        unit, best, size = (near, found, size) if found > best else (unit, best, 0.9 * size)
    return best


def written(folder: Path, train: Array, values: Array, held: Array, told: Array, climb: bool) -> None:
    """The table of the solved beams, and the errors."""
    beams = [beam_at(u) for u in train]
    rows = np.array([[b.width, 1.0 / b.thickness, b.fillet / b.width, b.poisson] for b in beams])
    _, first = np.unique(np.round(rows, 6), axis=0, return_index=True)
    first.sort()
    lines = [",".join(["w/s", "s/t", "r/w", "nu", *(" ".join(c) for c in COLUMNS)])]
    lines += [
        ",".join([f"{v:.6g}" for v in row] + [f"{v:.5f}" for v in of])
        for row, of in zip(rows[first], kept(values)[first])
    ]
    (folder / "beam-stress.csv").write_text("\n".join(lines) + "\n", "utf-8")
    points = np.array([closed.place(beams[i]) for i in first])
    c = closed.interpolated(points, np.round(kept(values)[first], 5))
    rest, rng, report = np.abs(errors(held, told, points, c)), np.random.default_rng(46), {}
    for i, mode in enumerate(MODES):
        worst = int(rest[:, i].argmax())
        most = climbed(held[worst], i, points, c, rng) if climb else float(rest[worst, i])
        report[mode] = {
            "rms": round(float(np.sqrt((rest[:, i] ** 2).mean())), 5),
            "held_out": round(float(rest[:, i].max()), 5),
            "climbed": round(most, 5),
        }
        print(mode, report[mode], flush=True)
    data = {
        "source": "python benchmarks/planar_stress.py, solid elements of order 4, density 2",
        "designs": {"solved": len(first), "held_out": len(held), "climb_steps": CLIMB},
        "errors": report,
    }
    (folder / "beam-stress.json").write_text(json.dumps(data, indent=1) + "\n", "utf-8")


def main(folder: Path, few: bool) -> None:
    share = 10 if few else 1
    train, held = places(400 // share, 44), places(80 // share, 45)
    values, told = (np.array([measured(u) for u in units]) for units in (train, held))
    written(folder, train, values, held, told, climb=not few)


if __name__ == "__main__":
    main(Path(sys.argv[1]), "--few" in sys.argv)
