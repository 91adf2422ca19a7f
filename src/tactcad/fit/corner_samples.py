"""Designs in the corners and on the edges of the default rung's whole range, and their K by refined elements.

The range is a polytope in the logarithms of its groups: each parameter is drawn in turn from the interval
that those before it leave, and is as often at an end of that interval as inside.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tactcad.fem.convergence import converged_plane, converged_solid
from tactcad.fem.mapped_mesh import plane_mesh
from tactcad.fem.shape import reference_shape
from tactcad.mechanics import validity
from tactcad.mechanics.constants import ladder_data
from tactcad.mechanics.section import HingeSection

from .accuracy_samples import LONGEST_BODY, THICKNESS
from .fit_samples import Columns, as_written, joined, section

# b/l under which a leaf, much longer than wide, curls over all of its width, and r/t from which fillets do.
# From the second b/l on it does so no more, whatever its fillets.
NARROW, LESS_NARROW, DEEP = 0.7, 1.5, 2.0
THICK = 6.0  # b/t under which the hinge is a bar, no leaf


def _all(s: HingeSection) -> np.ndarray:
    return np.full(s.shape, True)


def _narrow(s: HingeSection) -> np.ndarray:
    return s.width < NARROW * s.hinge_length


def _narrow_and_deep(s: HingeSection) -> np.ndarray:
    return _narrow(s) & s.two_sided & (s.fillet_radius >= DEEP * s.hinge_thickness)


def _wider_and_deep(s: HingeSection) -> np.ndarray:
    narrow = (s.width >= NARROW * s.hinge_length) & (s.width < LESS_NARROW * s.hinge_length)
    return narrow & s.two_sided & (s.fillet_radius >= DEEP * s.hinge_thickness)


def _narrow_and_thick(s: HingeSection) -> np.ndarray:
    return _narrow(s) & (s.width < THICK * s.hinge_thickness)


@dataclass(frozen=True)
class Draw:
    """How many designs are drawn, how many of the first are solved as solids at any cost, the seed, and which
    are kept."""

    count: int
    solids: int
    seed: int
    kept: Callable[[HingeSection], np.ndarray] = _all


# Few designs in the corners are narrow: those on which errors are measured have draws of their own.
DRAWS = {
    "corners": (Draw(240, 60, 271828), Draw(100, 0, 141421), Draw(66, 0, 577215)),
    "corners held out": (Draw(38, 0, 161803),),
    "narrow held out": (
        Draw(40, 40, 662607, _narrow),
        Draw(32, 32, 693147, _narrow_and_deep),
        Draw(600, 600, 173205, _narrow_and_thick),
        Draw(500, 500, 141592, _wider_and_deep),
    ),
}
# Shares of the parameters at the low and at the high end of their intervals. For the slot's length the shares
# are smaller: the longest need the most elements, the shortest the finest. Widths are mostly the smallest,
# where the sheet is neither in plane stress nor in plane strain.
ENDS, SLOT_ENDS, WIDTH_ENDS = (0.25, 0.25), (0.1, 0.1), (0.5, 0.1)
# Shortest body, in hinge thicknesses: that of the fit before these designs entered it (2.75 since).
LEAST_BODY = 2.76
INWARD = 1e-6  # relative: a written corner is still inside
FEW = 150  # quadratic elements, layers that grow by 1.8 from half a thickness: some seconds a design


def draw_corners(count: int, seed: int) -> Columns:
    """Up to `count` designs (mm), every second one two-sided, in corners, on edges and inside of solid's
    range.

    `count` are drawn from the groups' intervals; those that another rule refuses are dropped.
    """
    rng = np.random.default_rng(seed)
    rows: list[dict[str, float]] = []
    while len(rows) < count:
        two_sided = len(rows) % 2
        row = _drawn(rng, 1 + two_sided) | {"two_sided": float(two_sided)}
        if all(map(math.isfinite, row.values())):
            rows.append(row)
    drawn = as_written(rows)
    kept = validity.reasons(section(drawn), "solid") == ""
    return {name: values[kept] for name, values in drawn.items()}


def _drawn(rng: np.random.Generator, notch_sides: int) -> dict[str, float]:
    """One design; it holds NaN where the first parameters leave no interval for the rest."""
    sampled = ladder_data()["range"]
    g, low_block = sampled["groups"], sampled["least_height"]

    def pick(*bounds: tuple[float, float], ends: tuple[float, float] = ENDS) -> float:
        low = max(b[0] for b in bounds) * (1.0 + INWARD)
        high = min(b[1] for b in bounds) * (1.0 - INWARD)
        at, inside = rng.random(2)
        if not low <= high:
            return math.nan
        if at < sum(ends):
            return low if at < ends[0] else high
        return low * (high / low) ** inside

    def times(name: str, size: float, less: float = 0.0) -> tuple[float, float]:
        return g[name][0] * size - less, g[name][1] * size - less

    # in hinge thicknesses
    length = pick(times("l/t", 1.0), ends=SLOT_ENDS)
    radius = pick(times("r/t", 1.0), (0.0, length / 2.0))
    block = (low_block * (1.0 + notch_sides * radius), math.inf)
    arm_height = pick(times("h/t", 1.0), block)
    body_height = pick(times("Hb/t", 1.0), block)
    reach = pick(times("(L - l/2)/h", arm_height), times("L/Hb", body_height, length / 2.0))
    body_length = pick(times("Lb/Hb", body_height), (LEAST_BODY, LONGEST_BODY))
    poisson = pick(times("poisson", 1.0))
    sizes = {"b/t": 1.0, "b/l": length, "b/h": arm_height, "b/Hb": body_height}
    width = pick(*(times(name, size) for name, size in sizes.items()), ends=WIDTH_ENDS)
    return {
        "hinge_thickness": THICKNESS,
        "hinge_length": length * THICKNESS,
        "fillet_radius": radius * THICKNESS,
        "load_arm": (reach + length / 2.0) * THICKNESS,
        "arm_height": arm_height * THICKNESS,
        "body_height": body_height * THICKNESS,
        "body_length": body_length * THICKNESS,
        "poisson": poisson,
        "width": width * THICKNESS,
    }


def draw_all(kind: str) -> Columns:
    """The designs of a sample."""
    return joined([_designs(draw) for draw in DRAWS[kind]])


def compute_all(kind: str, most: int, report: Callable[[str], None]) -> Columns:
    """A sample with its results.

    Parameters
    ----------
    kind
        Of `DRAWS`.
    most
        Designs of each draw at most.
    report
        Receives lines of progress.
    """
    return joined([compute_corners(_designs(draw, most), draw.solids, report) for draw in DRAWS[kind]])


def _designs(draw: Draw, most: int | None = None) -> Columns:
    drawn = draw_corners(draw.count, draw.seed)
    kept = np.flatnonzero(draw.kept(section(drawn)))[:most]
    return {name: values[kept] for name, values in drawn.items()}


def compute_corners(columns: Columns, solids: int, report: Callable[[str], None]) -> Columns:
    """Stiffness by plane elements (unit modulus and width) and K3D/K2D by solid ones, beside each design.

    Solids for the first `solids`, and of the others for those of few elements; K3D/K2D is NaN else.
    """
    s, count = section(columns), len(columns["two_sided"])
    results = {"plane_stiffness": np.empty(count), "width_factor": np.full(count, math.nan)}
    for i in range(count):
        one = s.rows(i)
        plane = results["plane_stiffness"][i] = plane_stiffness(one)
        if i < solids or few_elements(one):
            results["width_factor"][i] = solid_stiffness(one) / (plane * float(one.width))
        if (i + 1) % 20 == 0:
            report(f"{i + 1} of {count} designs")
    return columns | results


def few_elements(s: HingeSection) -> bool:
    """Whether a design (scalars) is cheap by solid elements: narrow, and neither long nor deep."""
    layers = math.log1p(0.8 * float(s.width / s.hinge_thickness)) / math.log(1.8)
    return len(plane_mesh(reference_shape(s), 1).cells) * max(1, round(layers)) <= FEW


def plane_stiffness(s: HingeSection) -> float:
    """One design (scalars) by refined plane elements, of unit width and modulus."""
    return converged_plane(reference_shape(s), 1.0, float(s.poisson), 1.0).stiffness


def solid_stiffness(s: HingeSection) -> float:
    """One design (scalars) by refined solid elements, of unit modulus; short hinges by finer ones."""
    mesh = 3 if float(s.hinge_length) < float(s.hinge_thickness) else 2
    return converged_solid(reference_shape(s), 1.0, float(s.poisson), float(s.width), mesh=mesh).stiffness
