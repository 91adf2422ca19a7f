"""A planar array's calibration: its figures, as text, JSON and CSV, and read back."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tactcad.design.csv_table import Field, read, refuse_duplicates
from tactcad.design.messages import InputError
from tactcad.lab.readings import ELEMENT
from tactcad.report.report import plain

from .beam import Array, Whole

AXES = "xyz"
GRID = tuple(f"{i}{j}" for i in AXES for j in AXES)
PAIRS = ([0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2])  # rows and columns of a covariance's entries
# Columns of the file, by what of `CellMatrix` they hold.
COLUMNS = {
    "matrix": tuple(Field(f"m_{ij}", "mT/N", -1e6, 1e6) for ij in GRID),
    "bow": tuple(Field(f"c_{ij}", "mT/N2", -1e9, 1e9) for ij in GRID),
    "bow_variance": tuple(Field(f"cv_{ij}", "mT2/N4", 0.0, 1e12) for ij in GRID),
    "full": tuple(Field(f"full_{a}", "N", -1000.0, 1000.0) for a in AXES),
    "spread": tuple(
        Field(f"v{k}_{AXES[i]}{AXES[j]}", "mT2/N2", -1e12, 1e12) for k in AXES for i, j in zip(*PAIRS)
    ),
    "dof": tuple(Field(f"dof_{a}", "1", 0.0, 1e9, above=True) for a in AXES),
    "stiffness": (Field("stiffness", "N/mm", 0.0, 1e6, above=True),),
    "stiffness_se": (Field("stiffness_se", "N/mm", 0.0, 1e6),),
    "stiffness_limit": (Field("stiffness_limit", "1", 0.0, 0.9),),
}
FIELDS = tuple(f for some in COLUMNS.values() for f in some)


@dataclass(frozen=True)
class CellMatrix:
    """A cell's calibration.

    matrix           field (mT) by force (N): x, y, and z down on the pad, [3, 3], what bends taken off
    bow, full        c (mT/N^2, [3, 3]) and q_full (N, [3]) of each column
    bow_variance     of each c, by the readings' scatter about their lines, [3, 3]
    half_width       of each entry's interval, mT/N
    spread           covariance of each column's estimate, [axis, 3, 3], (mT/N)^2
    dof              of each column's spread, [axis]
    crosstalk        largest entry off the diagonal over its column's own, relative
    nonlinearity     largest deviation from a run's straight line over its full scale, relative
    stiffness        N/mm, straight down: measured where sinks are given, else the design's
    stiffness_se     its standard error by the sinks where measured, N/mm; weights in error come on top
    stiffness_limit  where it is the design's: half its tolerance, relative, one cause for all cells
    """

    element: int
    kind: str
    readings: int
    runs: int
    matrix: Array
    bow: Array
    bow_variance: Array
    full: Array
    half_width: Array
    spread: Array
    dof: Array
    crosstalk: float
    nonlinearity: float
    stiffness: float
    stiffness_se: float
    stiffness_limit: float


def to_text(cells: Sequence[CellMatrix], level: float) -> str:
    """A line a cell for the terminal."""
    lines = ["cell  kind     M_xx mT/N     M_yy      M_zz         +-  crosstalk  nonlinear  K N/mm"]
    for c in cells:
        wide = float((np.diag(c.half_width) / np.abs(np.diag(c.matrix))).max())
        own = "".join(f"{v:10.4g}" for v in np.diag(c.matrix))
        shares = "".join(f"{100 * v:9.2g} %" for v in (wide, c.crosstalk, c.nonlinearity))
        lines.append(f"{c.element:4d}  {c.kind:9s}{own}{shares}  {c.stiffness:.4g}")
    worst = max(float(np.abs(c.half_width / np.diag(c.matrix)).max()) for c in cells)
    lines += [
        "",
        f"+-: {100 * level:.10g} % interval by the scatter from set-up to set-up; of entries off the "
        f"diagonal within {100 * worst:.2g} % of their column's own. What all set-ups share (weights, the "
        "block's angle) comes on top",
        "crosstalk: largest entry off the diagonal over its column's own, which the matrix takes off",
        "nonlinear: off a straight line, over full scale, which the design's law takes off",
    ]
    if cells[0].stiffness_limit:
        lines.append(
            f"K is the design's, known within {100 * cells[0].stiffness_limit:.2g} % by the foil's "
            "thickness and cut; a column `sink` (mm) measures it"
        )
    return "\n".join(lines) + "\n"


def to_json(cells: Sequence[CellMatrix], level: float) -> str:
    data = {"schema": "tactcad-planar-calibration-1", "level": level, "units": "N, mT, mm", "elements": cells}
    return json.dumps(plain(data), indent=1, allow_nan=False) + "\n"


def to_csv(cells: Sequence[CellMatrix]) -> str:
    """Matrices with the covariances of their columns, which `read_matrices` reads back."""
    lines = [
        "# calibration of cells by tactcad calibrate; mT/N, N/mm",
        ",".join(["element", *(f.name for f in FIELDS)]),
    ]
    for c in cells:
        held = {name: getattr(c, name) for name in COLUMNS} | {"spread": c.spread[:, PAIRS[0], PAIRS[1]]}
        values = [f"{v:.9g}" for some in held.values() for v in np.ravel(some)]
        lines.append(",".join([str(c.element), *values]))
    return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class Matrices:
    """Matrices of calibrated cells; arrays, [cell]: see `CellMatrix`."""

    element: Whole
    matrix: Array
    bow: Array
    bow_variance: Array
    full: Array
    spread: Array
    dof: Array
    stiffness: Array
    stiffness_se: Array
    stiffness_limit: Array


def read_matrices(path: str) -> Matrices:
    """A calibration from the CSV of `to_csv`. Raises InputError if it is not one."""
    rows = read(path, (ELEMENT, *FIELDS))
    refuse_duplicates(rows, ("element",))
    number = rows.values("element").astype(int)
    shapes: dict[int, tuple[int, ...]] = {1: (), 3: (3,), 9: (3, 3), 18: (3, 6)}
    held = {
        name: np.stack([rows.values(f.name) for f in some], axis=1).reshape(-1, *shapes[len(some)])
        for name, some in COLUMNS.items()
    }
    for i in np.flatnonzero(np.linalg.cond(held["matrix"]) > 1e6)[:1]:
        raise InputError(rows.where(int(i), FIELDS[0].name), "the matrix tells no three forces apart")
    spread = np.empty((len(number), 3, 3, 3))
    spread[:, :, PAIRS[0], PAIRS[1]] = spread[:, :, PAIRS[1], PAIRS[0]] = held["spread"]
    return Matrices(number, **(held | {"spread": spread}))
