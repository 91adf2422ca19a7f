"""Designs that fill the whole range of the closed forms, and their stiffness by refined elements.

The fit's own samples are dense where sensors are made; the range that their groups span is larger. Here every
group is drawn over its whole range, so that the largest errors are measured in its corners too.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np

from tactcad.fem.convergence import converged_plane, converged_solid
from tactcad.fem.mapped_mesh import plane_mesh
from tactcad.fem.shape import reference_shape
from tactcad.mechanics import validity
from tactcad.mechanics.constants import ladder_data
from tactcad.mechanics.section import HingeSection

from .fit_samples import FULL_ROUND_SHARE, Columns, as_written, draw_edges, section

SEED = 1618
SOLID_PART, REFINED_PART = 8, 16  # two designs in so many are solved by solid elements, and by refined ones
REFINED_EDGES = 12
REFINED_LENGTH = 5.0  # hinge thicknesses
THICKNESS = 0.25  # mm; all other lengths are multiples of it, and K/(E b) does not depend on size
LONGEST_BODY = 141.0  # thicknesses: of the fit's samples; a longer one is a beam and only costs elements
# Largest number of elements in the plane, on its coarsest mesh, for which meshes 3 and 4 are still
# affordable. Where there are more the hinge is long and thin, and mesh 2 is more accurate.
MOST_CELLS = {2: 1000, 3: 80, 4: 45}


def draw_range(count: int, seed: int = SEED) -> Columns:
    """Designs over the whole range of rung solid, every group drawn uniformly in its logarithm.

    Parameters
    ----------
    count
        How many; every second one is two-sided.
    seed
        Of the random numbers.

    Returns
    -------
    Columns
        Parameters by name, arrays of shape (count,), mm.
    """
    rng = np.random.default_rng(seed)
    groups = ladder_data()["range"]["groups"]
    rows: list[dict[str, float]] = []
    while len(rows) < count:
        g = {k: math.exp(rng.uniform(math.log(low), math.log(high))) for k, (low, high) in groups.items()}
        row = design(g, full_round=rng.random() < FULL_ROUND_SHARE) | {"two_sided": float(len(rows) % 2)}
        written = as_written([row])
        too_long = row["body_length"] > LONGEST_BODY * THICKNESS
        if not too_long and not validity.broken_rules(section(written), "solid"):
            rows.append(row)
    return as_written(rows)


def draw_refined(count: int = REFINED_EDGES, seed: int = SEED + 1) -> Columns:
    """`count` designs on the promised box's edges whose hinges are short enough to be refined to mesh 4."""
    drawn = draw_edges(6 * count, seed)
    s = section(drawn)
    small = np.flatnonzero(s.hinge_length < REFINED_LENGTH * s.hinge_thickness)
    return {name: values[small[:count]] for name, values in drawn.items()}


def design(g: dict[str, float], full_round: bool) -> dict[str, float]:
    t = THICKNESS
    length, height, body = g["l/t"] * t, g["h/t"] * t, g["Hb/t"] * t
    return {
        "hinge_thickness": t,
        "hinge_length": length,
        "fillet_radius": length / 2.0 if full_round else g["r/t"] * t,
        "load_arm": g["(L - l/2)/h"] * height + length / 2.0,
        "arm_height": height,
        "body_height": body,
        "body_length": g["Lb/Hb"] * body,
        "poisson": g["poisson"],
        "width": g["b/t"] * t,
    }


def compute_range(
    columns: Columns, report: Callable[[str], None], meshes: Callable[[int], tuple[int, ...]]
) -> Columns:
    """Stiffness (unit modulus) of every design by plane and by solid elements, with the processor seconds of
    each.

    Parameters
    ----------
    columns
        Designs.
    report
        Receives lines of progress.
    meshes
        For the i-th design the meshes of fem-solid: 2 is the rung itself, 3 and 4 refine it.

    Returns
    -------
    Columns
        The designs' with `plane_stiffness`, `solid_mesh_2` to `solid_mesh_4` and the seconds; NaN where not
        computed.
    """
    s, count = section(columns), len(columns["two_sided"])
    names = ("plane_stiffness", "solid_mesh_2", "solid_mesh_3", "solid_mesh_4", *SECONDS.values())
    computed = {name: np.full(count, math.nan) for name in names}
    for i in range(count):
        for name, value in results(s.rows(i), meshes(i)).items():
            computed[name][i] = value
        if (i + 1) % 20 == 0:
            report(f"{i + 1} of {count} designs")
    return columns | computed


def with_width_factor(columns: Columns) -> Columns:
    """The columns with K3D/K2D by the finest solid mesh on which each design was solved."""
    stiffness = np.full(len(columns["width"]), math.nan)
    for name in ("solid_mesh_2", "solid_mesh_3", "solid_mesh_4"):
        stiffness = np.where(np.isfinite(columns[name]), columns[name], stiffness)
    return columns | {"width_factor": stiffness / (columns["plane_stiffness"] * columns["width"])}


SECONDS = {
    "fem-plane": "seconds_plane",
    "fem-solid, mesh 2": "seconds_mesh_2",
    "fem-solid, mesh 3": "seconds_mesh_3",
}


def meshes_of(i: int) -> tuple[int, ...]:
    """fem-solid's meshes for the i-th design; designs of both notch forms in turn."""
    pair = i // 2
    return () if pair % (SOLID_PART // 2) else (2,) if pair % (REFINED_PART // 2) else (2, 3, 4)


def results(s: HingeSection, meshes: tuple[int, ...]) -> dict[str, float]:
    """One design (scalars) by plane elements and by fem-solid on these meshes, with the seconds they took."""
    shape, nu, b = reference_shape(s), float(s.poisson), float(s.width)
    start = time.process_time()
    result = {"plane_stiffness": converged_plane(shape, 1.0, nu, 1.0).stiffness}
    result["seconds_plane"] = time.process_time() - start
    cells = len(plane_mesh(shape, 1).cells)
    for mesh in (m for m in meshes if cells <= MOST_CELLS[m]):
        start = time.process_time()
        result[f"solid_mesh_{mesh}"] = converged_solid(shape, 1.0, nu, b, mesh=mesh).stiffness
        if mesh < 4:
            result[f"seconds_mesh_{mesh}"] = time.process_time() - start
    return result
