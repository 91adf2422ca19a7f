"""Solves planar cells' beams with and without beveled edges by solid elements, for what bevels change of
their stiffness and stress beyond what sections say, and measures both on beveled beams not seen before.

    python benchmarks/planar_bevels.py src/tactcad/families/planar/data    forty minutes
    python benchmarks/planar_bevels.py DIR --few                           a tenth of it, to try

After `planar_beams` and `planar_stress`, whose data stand in the package; range and places as for the
latter. `beam-bevel.csv` holds logarithms of ratios for bevels of 0.2 thicknesses, as etching leaves them:
beveled over plain by elements, over the same by sections. Beams not seen before have lesser bevels too.
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from foil_elements import solved, stresses
from numpy.typing import NDArray
from planar_beams import CLIMB, STARTS, corners, places, pushed
from planar_stress import COLUMNS, beam_at, kept, ratios, table

from tactcad.families.planar import beam as closed
from tactcad.families.planar.beam import BEVEL, MODES, FoilBeam

Array = NDArray[np.float64]


def beveled(beam: FoilBeam, share: float = 1.0) -> FoilBeam:
    return replace(beam, bevel=share * BEVEL * beam.thickness)


def row(beam: FoilBeam) -> list[float]:
    """The table's columns of one beam: stiffness by mode, then stress."""
    (k, stress), (k_plain, plain) = ratios(beveled(beam)), ratios(beam)
    return [k[m] - k_plain[m] for m in MODES] + list(np.subtract(kept(stress), kept(plain)))


def of_stiffness(unit: Array, *modes: str) -> list[float]:
    """Relative errors of the stiffness as the package tells it, by mode."""
    beam = beveled(beam_at(unit[:4]), unit[4])
    told, found = closed.stiffness(beam), solved(beam, modes=modes)
    return [abs(told[m] / found[m] - 1.0) for m in modes]


def of_stress(unit: Array, *modes: str) -> list[float]:
    """The same of each mode's largest stress on the whole surface."""
    beam = beveled(beam_at(unit[:4]), unit[4])
    told, found = closed.stress(beam), stresses(beam, modes=modes)[1]
    return [abs(told[m] / found[m].max() - 1.0) for m in modes]


def main(folder: Path, few: bool) -> None:
    share = 10 if few else 1
    train, held = np.concatenate([places(64 // share, 54), corners()]), places(40 // share, 55, 5)
    names = [*MODES, *(" ".join(column) for column in COLUMNS)]
    data = {
        "source": "python benchmarks/planar_bevels.py, solid elements of order 4, density 2",
        "designs": {
            "solved": len(table(folder / "beam-bevel.csv", names, train, row)),
            "held_out": len(held),
            "climb_steps": CLIMB,
            "climbs": STARTS,
        },
        "errors": {},
    }
    for name, errors in (("stiffness", of_stiffness), ("stress", of_stress)):
        rest = np.array([errors(u, *MODES) for u in held])
        climb = None if few else lambda unit, i, errors=errors: errors(unit, MODES[i])[0]
        data["errors"][name] = pushed(held, rest, len(held), climb, 56)
    (folder / "beam-bevel.json").write_text(json.dumps(data, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), "--few" in sys.argv)
