"""The designs on which the ladder's constants are fitted, and their finite-element results."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Sequence
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tactcad.design.files import read_text, write_whole
from tactcad.design.messages import InputError
from tactcad.fem.convergence import converged_plane, converged_solid
from tactcad.fem.face_strain import face_strain, readings, solid_readings
from tactcad.fem.shape import reference_shape
from tactcad.mechanics.section import HingeSection

MOST_BYTES = 20_000_000  # the shipped samples take a quarter of one
Columns = dict[str, NDArray[np.float64]]

# The box over which the closed forms promise their error (mm; Poisson's ratio).
BOX = {
    "hinge_thickness": (0.15, 0.4),
    "hinge_length": (0.3, 1.5),
    "fillet_radius": (0.1, 0.3),
    "load_arm": (3.0, 7.0),
    "arm_height": (1.5, 3.0),
    "body_height": (3.0, 8.0),
    "body_length": (2.0, 6.0),
    "poisson": (0.2, 0.4),
    "width": (1.5, 8.0),
}
# Beyond the box, for small versions and short or deeply rounded slots; drawn by logarithm.
WIDE = {
    "hinge_thickness": (0.05, 0.4),
    "hinge_length": (0.1, 2.0),
    "fillet_radius": (0.03, 0.6),
    "load_arm": (2.0, 9.0),
    "arm_height": (1.2, 4.0),
    "body_height": (2.0, 10.0),
    "body_length": (1.0, 8.0),
    "poisson": (0.15, 0.45),
    "width": (1.0, 10.0),
}
LEAST_HEIGHT = 1.25  # height of arm and body over t + n r: below it there is no block behind the root
FILLET_RATIO = (0.15, 6.0)  # r/t
FULL_ROUND_SHARE = 0.1  # of the samples have r = l/2, so that lc = 0 is inside the fit
WIDE_SHARE = 0.4
EDGE_SHARE = 0.65  # of the parameters of a design on the box's edges stand at an end of their range

EDGE_PART = 3  # for so many designs inside the box one more stands on its edges
SEEDS = {"fitted": 20261121, "held out": 31415}
FILES = {
    "fitted": "ladder-samples.csv",
    "held out": "ladder-heldout.csv",
    "range": "ladder-range.csv",
    "corners": "ladder-corners.csv",
    "corners held out": "ladder-corners-heldout.csv",
    "narrow held out": "ladder-narrow-heldout.csv",
}

GRIDS = (0.25, 0.5, 0.75, 1.0, 1.5, 2.0)  # gauge grid lengths sampled, in slot lengths


def draw(count: int, seed: int) -> Columns:
    """Designs inside the promised box and beyond it.

    Parameters
    ----------
    count
        How many; every second one is two-sided.
    seed
        Of the random numbers.

    Returns
    -------
    Columns
        Parameters by name, arrays of shape (count,), mm; E is 1 MPa.
    """
    rng = np.random.default_rng(seed)
    rows: list[dict[str, float]] = []
    while len(rows) < count:
        wide = rng.random() < WIDE_SHARE
        row = {
            k: _log_uniform(rng, *v) if wide else rng.uniform(*v) for k, v in (WIDE if wide else BOX).items()
        }
        if rng.random() < FULL_ROUND_SHARE:
            row["hinge_length"] = 2.0 * row["fillet_radius"]
        row["two_sided"] = float(len(rows) % 2)
        if _possible(row):
            rows.append(row)
    return as_written(rows)


def draw_box(count: int, seed: int) -> Columns:
    """Designs inside the promised box only, uniformly drawn, for checks; as `draw`."""
    rng = np.random.default_rng(seed)
    rows: list[dict[str, float]] = []
    while len(rows) < count:
        row = {k: rng.uniform(*v) for k, v in BOX.items()} | {"two_sided": float(len(rows) % 2)}
        if _possible(row):
            rows.append(row)
    return as_written(rows)


def draw_edges(count: int, seed: int) -> Columns:
    """Designs on the promised box's edges and corners: each parameter at an end of its range, or inside;
    as `draw`.
    """
    rng = np.random.default_rng(seed)
    rows: list[dict[str, float]] = []
    while len(rows) < count:
        row = {
            k: v[rng.integers(2)] if rng.random() < EDGE_SHARE else rng.uniform(*v) for k, v in BOX.items()
        }
        row |= {"two_sided": float(len(rows) % 2)}
        row["fillet_radius"] = min(row["fillet_radius"], row["hinge_length"] / 2.0)
        if _possible(row):
            rows.append(row)
    return as_written(rows)


def designs(kind: str, count: int) -> tuple[Columns, Columns]:
    """Designs to be solved, inside the promised box and on its edges.

    Parameters
    ----------
    kind
        "fitted", which also has designs beyond the box, or "held out".
    count
        Inside the box; a third as many are on its edges.

    Returns
    -------
    tuple of Columns
        Those inside, and those on the edges.
    """
    inside = draw if kind == "fitted" else draw_box
    return inside(count, SEEDS[kind]), draw_edges(count // EDGE_PART, SEEDS[kind] + 1)


def joined(tables: Sequence[Columns]) -> Columns:
    """The rows of several tables as one; a result that one of them lacks is NaN there."""
    names = list(dict.fromkeys(name for table in tables for name in table))
    return {
        name: np.concatenate([t.get(name, np.full(len(t["two_sided"]), math.nan)) for t in tables])
        for name in names
    }


def section(columns: Columns) -> HingeSection:
    """The designs as one section of unit Young's modulus (stiffness is proportional to it)."""
    names = set(BOX) | {"two_sided"}
    return HingeSection.of(youngs_modulus=1.0, **{k: v for k, v in columns.items() if k in names})


def plane_results(s: HingeSection) -> dict[str, float]:
    """One design (scalars): plane-stress stiffness of unit width and modulus, face strains over nominal."""
    shape, nu, L, t = reference_shape(s), float(s.poisson), float(s.load_arm), float(s.hinge_thickness)
    plane = converged_plane(shape, 1.0, nu, 1.0)
    nominal = 6.0 * L / (t * t)
    slot, flat = face_strain(plane.plane, "slot"), face_strain(plane.plane, "flat")
    result = {
        "plane_stiffness": plane.stiffness,
        "slot_peak": slot.peak / nominal,
        "flat_peak": flat.peak / nominal,
        "flat_centre": flat.centre / nominal,
    }
    for grid in GRIDS:
        inside = grid * float(s.hinge_length)
        fits = not bool(s.two_sided) or grid <= 1.0
        result[f"grid_{grid:g}"] = float(flat.mean(inside)) / nominal if fits else math.nan
    return result


def solid_results(s: HingeSection) -> dict[str, float]:
    """One design (scalars): K3D/K2D of rung fem-solid, and mid-width over plane strain, per newton."""
    shape, nu, b = reference_shape(s), float(s.poisson), float(s.width)
    solid = converged_solid(shape, 1.0, nu, b)
    grid = 0.5 * float(s.hinge_length)
    over_plane = solid_readings(solid.plane, solid.solids, grid) / readings(solid.plane, grid)
    return {
        "width_factor": solid.stiffness / converged_plane(shape, 1.0, nu, b).stiffness,
        "mid_grid_ratio": float(over_plane.gauge),
        "mid_peak_ratio": over_plane.fillet_strain,
    }


def as_written(rows: list[dict[str, float]]) -> Columns:
    """Columns rounded to the digits that `write` keeps, so that elements are solved for the designs in the
    file.
    """
    return {k: np.array([float(f"{row[k]:.8g}") for row in rows]) for k in rows[0]}


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def _possible(row: dict[str, float]) -> bool:
    depth = row["hinge_thickness"] + (1.0 + row["two_sided"]) * row["fillet_radius"]
    reach = row["load_arm"] - row["hinge_length"] / 2.0
    return (
        2.0 * row["fillet_radius"] <= row["hinge_length"]
        and min(row["arm_height"], row["body_height"]) >= LEAST_HEIGHT * depth
        and FILLET_RATIO[0] <= row["fillet_radius"] / row["hinge_thickness"] <= FILLET_RATIO[1]
        and reach >= row["arm_height"] / 2.0
        and row["body_length"] >= 0.2 * row["body_height"]
    )


def compute(columns: Columns, solids: int, report: Callable[[str], None]) -> Columns:
    """Finite-element results of every design beside its parameters.

    Parameters
    ----------
    columns
        Designs, as `draw` gives them.
    solids
        How many of the first are solved as solids too; the others' results are NaN.
    report
        Receives lines of progress.
    """
    s, count = section(columns), len(columns["two_sided"])
    rows: list[dict[str, float]] = []
    for i in range(count):
        one = s.rows(i)
        rows.append(plane_results(one) | (solid_results(one) if i < solids else {}))
        if (i + 1) % 50 == 0:
            report(f"{i + 1} of {count} designs")
    names = list(dict.fromkeys(name for row in rows for name in row))
    return columns | {name: np.array([row.get(name, math.nan) for row in rows]) for name in names}


def write(columns: Columns, path: Path) -> None:
    """Write columns as CSV, one line a design, eight digits."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    for row in zip(*columns.values()):
        writer.writerow("" if math.isnan(v) else f"{v:.8g}" for v in row)
    write_whole(path, text.getvalue().encode())


def load(path: Path | Traversable) -> Columns:
    """The columns that `write` wrote. Raises InputError where the file is something else."""
    rows = list(
        csv.DictReader(
            read_text(str(path), MOST_BYTES, "samples that `tactcad fit` wrote (CSV)").splitlines()
        )
    )
    try:
        return {name: np.array([float(row[name] or "nan") for row in rows]) for name in rows[0]}
    except (IndexError, TypeError, ValueError) as error:
        raise InputError(
            str(path), f"not the samples of an earlier fit: {error}", legal="what `tactcad fit` wrote"
        ) from None


def shipped_table(kind: str) -> Columns:
    """A sample that comes with the program, by its name in FILES."""
    return load(resources.files(__package__) / "data" / FILES[kind])


def shipped() -> dict[str, Columns]:
    """All samples that come with the program: those "held out" are kept out of the fit."""
    return {kind: shipped_table(kind) for kind in FILES}
