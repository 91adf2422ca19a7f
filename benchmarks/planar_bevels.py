"""Solves planar cells' beams with and without beveled edges by solid elements, for what bevels change of
their stiffness beyond what sections say, and measures the stiffness on beveled beams not seen before.

    python benchmarks/planar_bevels.py src/tactcad/families/planar/data    ten minutes
    python benchmarks/planar_bevels.py DIR --few                           a tenth of it, to try

Range and places as for `planar_stress`; bevels of 0.2 thicknesses, as etching leaves them. `beam-bevel.csv`
holds logarithms of ratios: beveled over plain by elements, over the same by sections. Coarse elements do for
that: their errors cancel to 0.02 %. Then a climb from the worst beam of every mode pushes its error further.
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from foil_elements import solved
from numpy.typing import NDArray
from planar_beams import places
from planar_stress import beam_at

from tactcad.families.planar import beam as closed
from tactcad.families.planar.beam import BEVEL, MODES, FoilBeam

Array = NDArray[np.float64]
CLIMB = 12


def both(unit: Array) -> tuple[FoilBeam, FoilBeam]:
    """The plain beam at a place of the unit cube, and the beveled one."""
    plain = beam_at(unit)
    return plain, replace(plain, bevel=BEVEL * plain.thickness)


def measured(unit: Array) -> Array:
    """The table's columns of one place, by mode."""
    plain, beveled = ({m: v / closed.base(b)[m] for m, v in solved(b).items()} for b in both(unit))
    return np.log([beveled[m] / plain[m] for m in MODES])


def errors(unit: Array, modes: tuple[str, ...] = MODES) -> Array:
    """Of beveled beams' stiffness as the package tells it, relative, by mode."""
    beam = both(unit)[1]
    told, found = closed.stiffness(beam), solved(beam, 2, modes)
    return np.array([abs(told[m] / found[m] - 1.0) for m in modes])


def climbed(unit: Array, mode: str, rng: np.random.Generator) -> float:
    """Largest error found by small steps from there."""
    best, size = float(errors(unit, (mode,))[0]), 0.15
    for _ in range(CLIMB):
        near = np.clip(unit + size * rng.normal(size=4), 0.0, 1.0)
        found = float(errors(near, (mode,))[0])
        unit, best, size = (near, found, size) if found > best else (unit, best, 0.9 * size)
    return best


def written(folder: Path, units: Array) -> int:
    """The table of the solved beams; how many."""
    beams = [both(u)[0] for u in units]
    rows = np.array([[b.width, 1.0 / b.thickness, b.fillet / b.width, b.poisson] for b in beams])
    _, first = np.unique(np.round(rows, 6), axis=0, return_index=True)
    lines = [",".join(["w/s", "s/t", "r/w", "nu", *MODES])]
    for i in sorted(first):
        lines.append(",".join([f"{v:.6g}" for v in rows[i]] + [f"{v:.5f}" for v in measured(units[i])]))
    (folder / "beam-bevel.csv").write_text("\n".join(lines) + "\n", "utf-8")
    return len(first)


def main(folder: Path, few: bool) -> None:
    share = 10 if few else 1
    units = places(130 // share, 54)
    count, held = written(folder, units[::2]), units[-31 // share :: 2]
    rest, rng, report = np.array([errors(u) for u in held]), np.random.default_rng(56), {}
    for i, mode in enumerate(MODES):
        worst = int(rest[:, i].argmax())
        report[mode] = {
            "rms": round(float(np.sqrt((rest[:, i] ** 2).mean())), 5),
            "held_out": round(float(rest[:, i].max()), 5),
            "climbed": round(climbed(held[worst], mode, rng) if not few else float(rest[worst, i]), 5),
        }
        print(mode, report[mode], flush=True)
    data = {
        "source": "python benchmarks/planar_bevels.py, solid elements of order 4, density 2",
        "designs": {"solved": count, "held_out": len(held), "climb_steps": CLIMB},
        "errors": report,
    }
    (folder / "beam-bevel.json").write_text(json.dumps(data, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), "--few" in sys.argv)
