"""Designs over the whole range of the closed forms, and their strains and stresses at mid-width by
elements.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np

from tactcad.fem.convergence import ACROSS, ORDER
from tactcad.fem.face_strain import SurfaceReadings, readings
from tactcad.fem.mapped_mesh import layers, plane_mesh
from tactcad.fem.plane_elements import solve_plane
from tactcad.fem.shape import reference_shape
from tactcad.fem.solid_elements import solve_solid
from tactcad.mechanics import validity
from tactcad.mechanics.constants import ladder_data
from tactcad.mechanics.section import HingeSection

from .accuracy_samples import LONGEST_BODY, THICKNESS, design
from .corner_samples import draw_all
from .fit_samples import FULL_ROUND_SHARE, Columns, as_written, draw_edges, joined, section, write

SEED, COUNT = 20261122, 900
NARROW = "narrow held out"  # designs of corner_samples that errors are measured on, and nothing is fitted
FILES = {"fitted": "strain-samples.csv", NARROW: "strain-narrow-heldout.csv"}
END_SHARE = 0.5  # of a corner design's groups stand at an end of their range
# Grid lengths that are read, in lengths of the slot (one-sided) or of its flat part and one fillet (two-
# sided).
GRIDS = (0.1, 0.4, 0.7, 1.0, 1.4, 2.0, 3.0, 5.0)
PLANE_DENSITY = 2
MOST_UNKNOWNS = 40_000
SOLID_ORDER = 3  # an order less than fem-solid's: more designs in the same time
NAMES = ("face_strain", "face_stress", "fillet_strain", "fillet_stress")
COLUMNS = tuple(
    f"{model}_{name}"
    for model in ("plane", "solid")
    for name in (*NAMES, *(f"gauge_{grid:g}" for grid in GRIDS))
)


def draw(count: int = COUNT, seed: int = SEED) -> Columns:
    """`count` designs (mm), half of them two-sided.

    A quarter is on the box's edges, a quarter inside the range, and half has groups at the ends of their
    ranges; the kinds alternate, so that every first part of the sample is like the whole.
    """
    quarter = count // 4
    parts = [
        draw_edges(quarter, seed),
        _over_the_range(quarter, seed + 1, 0.0),
        _over_the_range(count - 2 * quarter, seed + 2, END_SHARE),
    ]
    places = np.concatenate([(np.arange(n) // 2 + 0.5) / n for n in (quarter, quarter, count - 2 * quarter)])
    order = np.argsort(places, kind="stable")
    return {name: values[order] for name, values in joined(parts).items()}


def _over_the_range(count: int, seed: int, end_share: float) -> Columns:
    rng = np.random.default_rng(seed)
    ranges = ladder_data()["range"]["groups"]
    rows: list[dict[str, float]] = []
    while len(rows) < count:
        groups = {
            name: float(
                rng.choice(ends) if rng.random() < end_share else math.exp(rng.uniform(*np.log(ends)))
            )
            for name, ends in ranges.items()
        }
        row = design(groups, full_round=rng.random() < FULL_ROUND_SHARE) | {"two_sided": float(len(rows) % 2)}
        too_long = row["body_length"] > LONGEST_BODY * THICKNESS
        if not too_long and not validity.broken_rules(section(as_written([row])), "solid"):
            rows.append(row)
    return as_written(rows)


def grid_lengths(s: HingeSection) -> np.ndarray:
    """mm, those of GRIDS that lie on the faces of one design (scalars)."""
    unit = float(s.straight_length + s.fillet_radius) if s.two_sided else float(s.hinge_length)
    room = 2.0 * min(float(s.body_length) + float(s.hinge_length) / 2.0, float(s.load_arm))
    lengths = unit * np.array(GRIDS)
    return lengths[lengths <= (unit * (1.0 + 1e-9) if s.two_sided else 0.9 * room)]


def results(s: HingeSection) -> dict[str, float]:
    """One design (scalars) per newton and unit modulus, by plane elements and by solid ones, if they are few
    enough."""
    shape, nu, b = reference_shape(s), float(s.poisson), float(s.width)
    lengths = grid_lengths(s)
    plane = solve_plane(shape, 1.0, nu, b, density=PLANE_DENSITY, order=ORDER)
    flat = _named("plane", readings(plane, lengths))
    mesh = plane_mesh(shape, 1, order=SOLID_ORDER)
    ends = layers(b / 2.0, float(s.hinge_thickness), 1)
    if 3 * len(mesh.cells) * SOLID_ORDER**2 * (ACROSS * (len(ends) - 1) + 1) > MOST_UNKNOWNS:
        return flat
    fine = solve_solid(shape, 1.0, nu, b, density=1, order=SOLID_ORDER, order_across=ACROSS)
    against = readings(fine, lengths) / readings(fine.flat(), lengths)
    return flat | _named("solid", readings(plane, lengths) * against)


def _named(model: str, strains: SurfaceReadings) -> dict[str, float]:
    gauges = {f"{model}_gauge_{grid:g}": float(value) for grid, value in zip(GRIDS, strains.gauge)}
    return {f"{model}_{name}": float(getattr(strains, name)) for name in NAMES} | gauges


def compute(columns: Columns) -> Columns:
    """Designs with elements' results beside their parameters, NaN where there is none."""
    s, count = section(columns), len(columns["two_sided"])
    computed = {name: np.full(count, math.nan) for name in COLUMNS}
    for i in range(count):
        for name, value in results(s.rows(i)).items():
            computed[name][i] = value
    return columns | computed


if __name__ == "__main__":
    folder, first = Path(sys.argv[1]), int(sys.argv[2])
    drawn = {"fitted": {name: values[:first] for name, values in draw().items()}, NARROW: draw_all(NARROW)}
    for kind, designs in drawn.items():
        write(compute(designs), folder / FILES[kind])
