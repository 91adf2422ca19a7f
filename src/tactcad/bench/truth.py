"""Converged finite elements, finer than any rung: the reference for errors.

Plane stress: Richardson's limit from densities 6 and 12, where the rung takes 3 and 6. Three dimensions: that
limit times K3D/K2D on one plane mesh (both have the same relative error at the fillets), by Richardson's
limit from densities 2 and 3, with the change that a second layer across the width makes.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from tactcad.fem.convergence import RATE, richardson
from tactcad.fem.plane_elements import solve_plane
from tactcad.fem.shape import ElementShape, reference_shape
from tactcad.fem.solid_elements import solve_solid
from tactcad.fit.fit_samples import BOX, Columns, draw_box, draw_edges, joined, load, section, write
from tactcad.mechanics.section import REFERENCE, HingeSection

from .run_plan import RunPlan

DENSITIES = (6, 12)
SOLID_DENSITIES = (2, 3)
FACTOR_ORDER = (
    2.5  # of K3D/K2D: seen on densities 2, 3 and 4 of the thickest and shortest hinge of the envelope
)
ORDERS_SEEN = (2.0, 4.0)  # over the envelope, on densities 1, 2 and 3; the other differences are far smaller
EDGES = 4  # one design of so many stands on the envelope's edges
SHIPPED = "bench-truth.csv"
FULL_DESIGNS, FULL_SOLIDS = 120, 40  # random designs of a full run, and how many of all are solved as solids


def designs(count: int, seed: int) -> Columns:
    """The two reference elements, and `count` random ones of the envelope, some of them on its edges."""
    edges = count // EDGES
    tables = [_reference(), draw_box(count - edges, seed), *([draw_edges(edges, seed + 1)] if edges else [])]
    mixed = joined(tables)
    order = np.concatenate([[0, 1], 2 + np.random.default_rng(seed).permutation(count)])
    return {name: values[order] for name, values in mixed.items()}


def _reference() -> Columns:
    both = {k: np.full(2, float(getattr(REFERENCE, k))) for k in BOX}
    return both | {"two_sided": np.array([1.0, 0.0])}


def compute(columns: Columns, solids: int, say: Callable[[str], None]) -> Columns:
    """Stiffness of unit width and modulus, and K3D/K2D for the first `solids` designs, NaN for others; each
    with its estimated relative error.
    """
    s, count = section(columns), len(columns["two_sided"])
    rows = []
    for i in range(count):
        say(f"converged elements, design {i + 1} of {count}{' (solid)' if i < solids else ''}")
        one = s.rows(i)
        shape, nu, b = reference_shape(one), float(one.poisson), float(one.width)
        row = dict(zip(("plane_stiffness", "plane_error"), plane(shape, nu)))
        solid = width_factor(shape, nu, b) if i < solids else (math.nan, math.nan)
        rows.append(row | dict(zip(("width_factor", "width_error"), solid)))
    return columns | {name: np.array([row[name] for row in rows]) for name in rows[0]}


def plane(shape: ElementShape, nu: float) -> tuple[float, float]:
    """Stiffness (unit width and modulus), and the share by which the limit differs from the finer mesh."""
    coarse, fine = (solve_plane(shape, 1.0, nu, 1.0, density=d).compliance for d in DENSITIES)
    limit = richardson((coarse, fine), DENSITIES, RATE)
    return 1.0 / limit, abs(limit / fine - 1.0)


def width_factor(shape: ElementShape, nu: float, width: float) -> tuple[float, float]:
    """K3D/K2D, and its estimated relative error: half of what the choice of the order may change."""

    def factor(density: int, across: int) -> float:
        flat = solve_plane(shape, 1.0, nu, width, density=density).compliance
        return flat / solve_solid(shape, 1.0, nu, width, density=density, across=across).compliance

    pair = (factor(SOLID_DENSITIES[0], 1), factor(SOLID_DENSITIES[1], 1))
    layers = factor(SOLID_DENSITIES[0], 2) - pair[0]
    value = richardson(pair, SOLID_DENSITIES, FACTOR_ORDER) + layers
    least, most = (richardson(pair, SOLID_DENSITIES, p) for p in ORDERS_SEEN)
    return value, abs(least - most) / 2.0 / value


def shipped() -> Columns:
    """The designs and results of the run behind the published figures."""
    from importlib import resources

    return load(resources.files("tactcad.bench") / "data" / SHIPPED)


def of_run(plan: RunPlan) -> Columns:
    """Designs and results for a run: in mode full solved anew, once, on designs of this run's seed; else the
    shipped ones.
    """
    if plan.mode != "full":
        return shipped()
    path = plan.folder / SHIPPED
    if not path.is_file():
        write(compute(designs(FULL_DESIGNS, plan.seed), FULL_SOLIDS, plan.say), path)
    return load(path)


def solid_stiffness(columns: Columns) -> np.ndarray:
    """Of unit modulus, at the design's width; NaN where no solid was solved."""
    return columns["plane_stiffness"] * columns["width"] * columns["width_factor"]


def sections(columns: Columns) -> list[HingeSection]:
    """The designs one by one, of unit modulus."""
    s = section(columns)
    return [s.rows(i) for i in range(len(columns["two_sided"]))]
