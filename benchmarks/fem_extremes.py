"""How finite elements fare on hinges at the ends of what can be written, as a picture and as numbers.

`python benchmarks/fem_extremes.py docs/images/fem-extremes.svg [FILE.json]`
"""

from __future__ import annotations

import json
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from samples import draw_range, section
from scipy.sparse.linalg import LinearOperator, onenormest

from tactcad.fem import elasticity
from tactcad.fem.elements import end_load, fixed_unknowns, solve_plane
from tactcad.fem.fem_ladder import RATE, richardson
from tactcad.fem.mapped_mesh import PlaneMesh, plane_mesh
from tactcad.fem.shape import ElementShape, reference_shape
from tactcad.mechanics.rungs import beams
from tactcad.mechanics.section import REFERENCE, HingeSection

THICKNESSES = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5)  # mm: least that a file may hold to twice the usual
DENSITIES = (1, 2, 3)
REFINED = (1, 2, 3, 4, 6, 8, 12, 16)
SLOT = 2.0  # mm, of the hinges that grow thin
ANGLES_OF = 200  # designs over the whole range, for the angles


@dataclass(frozen=True)
class Health:
    """Quality of one plane mesh and of its system of equations. Angles in degrees, at the corners of the
    elements.

    condition: of the stiffness matrix without the fixed unknowns, in the 1-norm (by Hager's estimate, which
    is deterministic). rounding: relative change of the compliance by one step of iterative refinement, an
    estimate of its rounding error.
    """

    smallest_angle: float
    largest_angle: float
    condition: float
    rounding: float
    compliance: float  # mm/N
    unknowns: int


def plane_health(shape: ElementShape, E: float, nu: float, width: float, density: int) -> Health:
    """Of the plane-stress problem that `solve_plane` solves on that density."""
    solution = solve_plane(shape, E, nu, width, density=density)
    space, mesh = solution.space, solution.mesh
    A = space.stiffness(*elasticity.lame(E, nu, plane_stress=True)) * width
    end, load = end_load(space, mesh)
    f = np.zeros(A.shape[0])
    f[2 * end + 1] = load
    free = np.setdiff1d(np.arange(len(f)), fixed_unknowns(space.nodes, mesh, 2))
    reduced = A[free][:, free].tocsc()
    solve = elasticity.factorised(reduced).solve
    inverse = LinearOperator(reduced.shape, matvec=solve, rmatvec=solve, dtype=float)
    _, rounding = elasticity.refined(reduced, f[free])
    smallest, largest = corner_angles(mesh)
    return Health(
        smallest,
        largest,
        float(abs(reduced).sum(axis=0).max() * onenormest(inverse, t=1)),
        rounding,
        solution.compliance,
        solution.unknowns,
    )


def corner_angles(mesh: PlaneMesh) -> tuple[float, float]:
    """Smallest and largest angle between the two edges that meet at an element's corner, degrees.

    Edges are curved; the angle is that of the tangents of the parabola through an edge's corners and middle.
    """
    angles = []
    for u, v in ((0, 0), (0, 2), (2, 0), (2, 2)):
        corner = mesh.cells[:, u, v]
        along = 4.0 * mesh.cells[:, 1, v] - 3.0 * corner - mesh.cells[:, 2 - u, v]
        across = 4.0 * mesh.cells[:, u, 1] - 3.0 * corner - mesh.cells[:, u, 2 - v]
        cross = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]
        angles.append(np.degrees(np.arctan2(np.abs(cross), np.sum(along * across, axis=1))))
    return float(np.min(angles)), float(np.max(angles))


@dataclass(frozen=True)
class Thin:
    """One thin hinge on one density: condition, rounding, and the length that its two roots add, in
    thicknesses."""

    sides: str
    thickness: float
    density: int
    condition: float
    rounding: float
    added_length: float


@dataclass(frozen=True)
class Refined:
    """The reference hinge on one density: error of K against the limit, and what rounding did."""

    sides: str
    density: int
    unknowns: int
    error: float
    rounding: float
    condition: float


@dataclass(frozen=True)
class Extremes:
    thin: tuple[Thin, ...]
    refined: tuple[Refined, ...]
    angles: tuple[tuple[float, float, float, float], ...]  # r/t, l/t, smallest and largest angle in degrees


def thin_hinge(t: float, two_sided: bool) -> HingeSection:
    """A leaf of SLOT mm with fillets as large as it is thick, however thin."""
    return REFERENCE.with_(
        hinge_thickness=t, hinge_length=SLOT, fillet_radius=min(t, SLOT / 4), two_sided=two_sided
    )


def thin(t: float, two_sided: bool, density: int) -> Thin:
    """Locking would make the leaf stiffer the thinner it is, and so the added length smaller; it does not
    change.

    Added length: what the compliance is above beam theory's of the straight part, over the compliance that a
    thickness of leaf brings, 12 L^2 t/(E b t^3).
    """
    s = thin_hinge(t, two_sided)
    E, nu, b, L = (float(v) for v in (s.youngs_modulus, s.poisson, s.width, s.load_arm))
    found = plane_health(reference_shape(s), E, nu, b, density)
    straight = float(beams.beam(s.with_(hinge_length=s.straight_length)))
    added = (found.compliance - straight) / (12.0 * L * L / (E * b * t * t))
    return Thin(_sides(two_sided), t, density, found.condition, found.rounding, added)


def refined(two_sided: bool, densities: tuple[int, ...] = REFINED) -> list[Refined]:
    """The reference hinge on ever finer meshes; the limit is Richardson's from the last two."""
    s = REFERENCE.with_(two_sided=two_sided)
    material = float(s.youngs_modulus), float(s.poisson), float(s.width)
    found = [plane_health(reference_shape(s), *material, density) for density in densities]
    limit = richardson((found[-2].compliance, found[-1].compliance), densities[-2:], RATE)
    return [
        Refined(_sides(two_sided), d, h.unknowns, abs(limit / h.compliance - 1.0), h.rounding, h.condition)
        for d, h in zip(densities, found)
    ]


def angles(count: int = ANGLES_OF, density: int = 2) -> list[tuple[float, float, float, float]]:
    """Of designs over the whole range of the closed forms."""
    s = section(draw_range(count))
    rows = []
    for i in range(count):
        one = s.rows(i)
        smallest, largest = corner_angles(plane_mesh(reference_shape(one), density))
        t = float(one.hinge_thickness)
        rows.append((float(one.fillet_radius) / t, float(one.hinge_length) / t, smallest, largest))
    return rows


def measure() -> Extremes:
    """All of the picture; about a minute."""
    both = (True, False)
    return Extremes(
        tuple(thin(t, two, d) for two in both for d in DENSITIES for t in THICKNESSES),
        tuple(row for two in both for row in refined(two)),
        tuple(angles()),
    )


def _sides(two_sided: bool) -> str:
    return "two" if two_sided else "one"


def picture(x: Extremes) -> str:
    """SVG text."""
    from tactcad.report import plots as d

    with d.panels(2, 2, size=(11.2, 8.4)) as (figure, axes):
        _condition(axes[0, 0], x, d)
        _locking(axes[0, 1], x, d)
        _rounding(axes[1, 0], x, d)
        _angles(axes[1, 1], x, d)
        return d.svg(figure, "fem-extremes")


def _condition(axis, x: Extremes, d) -> None:
    _against_thickness(axis, x, d, "condition")
    axis.set(xscale="log", yscale="log", xlabel="hinge thickness t, mm", title="Condition number, slot 2 mm")
    axis.legend()
    d.log_ticks(axis.xaxis, THICKNESSES)


def _locking(axis, x: Extremes, d) -> None:
    _against_thickness(axis, x, d, "added_length")
    axis.set(
        xscale="log", ylim=(0, 2.6), xlabel="hinge thickness t, mm", ylabel="length that the roots add, t"
    )
    axis.set_title("No locking: the roots add as much however thin the leaf")
    d.log_ticks(axis.xaxis, THICKNESSES)


def _against_thickness(axis, x: Extremes, d, figure: str) -> None:
    for sides, colour in (("two", d.BLUE), ("one", d.ORANGE)):
        for density, marker in zip(DENSITIES, d.MARKERS):
            rows = [r for r in x.thin if (r.sides, r.density) == (sides, density)]
            values, label = [getattr(r, figure) for r in rows], f"{sides}-sided, density {density}"
            axis.plot([r.thickness for r in rows], values, color=colour, marker=marker, label=label)


def _rounding(axis, x: Extremes, d) -> None:
    for sides, colour in (("two", d.BLUE), ("one", d.ORANGE)):
        rows = [r for r in x.refined if r.sides == sides]
        unknowns = [r.unknowns for r in rows]
        axis.plot(
            unknowns[:-1],
            [r.error for r in rows][:-1],
            color=colour,
            marker="o",
            label=f"{sides}-sided: error of K",
        )
        axis.plot(
            unknowns,
            [r.rounding for r in rows],
            color=colour,
            marker="x",
            ls=":",
            label=f"{sides}-sided: rounding",
        )
        floor = [np.finfo(float).eps * r.condition for r in rows]
        axis.plot(unknowns, floor, color=colour, ls="--", lw=1, label=f"{sides}-sided: 2.2e-16 x condition")
    axis.set(
        xscale="log",
        yscale="log",
        xlabel="unknowns",
        ylabel="relative",
        title="Refinement: error falls, rounding rises",
    )
    axis.set_ylim(1e-13, 1e4)  # room for the legend above the lines
    axis.legend(loc="upper right", ncols=2, fontsize=9)


def _angles(axis, x: Extremes, d) -> None:
    slender = np.array([row[1] for row in x.angles])
    for column, colour, name in ((2, d.GREEN, "smallest"), (3, d.RED, "largest")):
        axis.plot(
            slender,
            [row[column] for row in x.angles],
            ls="",
            marker=".",
            color=colour,
            label=f"{name} of a mesh",
        )
    axis.set(xscale="log", ylim=(0, 180), xlabel="slot length over thickness l/t", ylabel="degrees")
    axis.set_title(f"Angles at elements' corners, {len(x.angles)} designs over the range")
    axis.legend(loc="center right")
    d.log_ticks(axis.xaxis, (0.3, 1, 3, 10, 30))


if __name__ == "__main__":
    result = measure()
    Path(sys.argv[1]).write_text(picture(result), "utf-8")
    if len(sys.argv) > 2:
        Path(sys.argv[2]).write_text(json.dumps(asdict(result), indent=1) + "\n", "utf-8")
