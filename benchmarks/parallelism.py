"""What an inclination between array and object costs: a table of docs/targets.md.

python benchmarks/parallelism.py docs/targets.md    some seconds
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from measuring import ROOT
from tables import lines, write_tables

from tactcad.design.load import read
from tactcad.synthesis.made_arrays import MadeSensor
from tactcad.synthesis.on_layer import AROUND, Poses
from tactcad.synthesis.target import Known, read_target

TARGET = ROOT / "hardware" / "targets" / "tissue-array.toml"
ARRAYS = (  # K_obj, N/mm, and the force on the whole array, N
    ("macro-array", (2.49, 9.97), 5.0),
    ("better-array", (2.49, 9.97), 5.0),
    ("tissue-array", (5.0,), 3.4),
)
ANGLES = (0.0, 0.1, 0.5, 1.0, 2.0)  # degrees


def parallelism() -> str:
    turn = 2.0 * np.pi * np.arange(AROUND) / AROUND
    around = np.stack([np.cos(turn), np.sin(turn)], -1)
    rows = []
    for name, stiffness, force in ARRAYS:
        # three runs of the published scatter
        target = replace(read_target(TARGET).with_("grasp.force", force), known=Known())
        made = MadeSensor(target, read(name)).on_body
        for x in stiffness:
            modulus, cells = np.full(AROUND, x / target.unit(made.design)), []
            for angle in ANGLES:
                at = Poses(modulus, np.tan(np.radians(angle)) * around)
                got = made.expected(at)
                cells.append(f"{100 * made.half_width(at, got).max():.1f} %, {got.force.max():.2f} N")
            rows.append((name, x, *cells))
    heads = " | ".join(["level", "0.1 degree", *(f"{angle:g}" for angle in ANGLES[2:])])
    return lines(f"array | K_obj, N/mm | {heads}", rows)


if __name__ == "__main__":
    raise SystemExit(write_tables(__doc__, {"parallelism": parallelism}))
