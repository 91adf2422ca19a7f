"""The overload stop by finite elements on the whole contour of every shipped element: load on the pad, tip
held by a rigid stop plate once its gap is closed; stresses are the largest of the width, by solid elements.
What holds uses only the ratio of two stiffnesses of the estimator; nothing of mechanics/strength.py, nor of
the strain forms."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import pytest
from skfem import Basis, ElementTriP2
from variants import FACING_ROWS

from tactcad.fem import elasticity, fem_ladder
from tactcad.fem.free_mesh import Fine, triangle_mesh
from tactcad.fem.space import line_load
from tactcad.mechanics import ladder, strain
from tactcad.parts.array.element import element
from tactcad.parts.array.hinge_section import hinge_section
from tactcad.parts.array.layout import ElementPlace, Layout
from tactcad.parts.array.stop_gap import land_room, overloads, seat
from tactcad.parts.rules import load

# every different element of the shipped designs, under its design's overload force
KINDS = sorted(
    {
        (element(layout, p).body, layout.design.rating): (name, p.arm)
        for name in FACING_ROWS
        for layout in [Layout(load(name))]
        for p in layout.elements
    }.values()
)


@dataclass(frozen=True)
class Answer:
    """Of one load case, per newton: deflection at the load line and rise of the tip (mm), stress in the
    fillets (MPa)."""

    deflection: float
    tip: float
    stress: np.ndarray

    def and_(self, other: Answer, force: float, reaction: float) -> Answer:
        pairs = ((self.deflection, other.deflection), (self.tip, other.tip), (self.stress, other.stress))
        return Answer(*(force * a - reaction * b for a, b in pairs))


def solved(layout: Layout, place: ElementPlace, modulus: float) -> tuple[Answer, Answer, Answer]:
    """1 N spread over the pad, 1 N up at the land's tip edge, 1 N up at the pad's outer edge; plane stress,
    held between its spacers. Deflection is always the pad's mean."""
    d = layout.design
    outer, holes = element(layout, place).extrusion.outer, element(layout, place).extrusion.openings
    t, l, r = place.hinge.t, place.hinge.l, place.hinge.r
    fine = tuple(Fine((x, t), t / 8) for x in place.hinge_x + np.linspace(-l / 2, l / 2, 15))
    land = (layout.pad_inner, layout.ledge - gap_of(layout, place))
    mesh = triangle_mesh(outer, holes, (*fine, Fine(land, 0.1)), 0.6)
    basis = Basis(mesh, ElementTriP2(), intorder=4)
    x, z = basis.doflocs
    A = (
        elasticity.stiffness_matrix(basis, *elasticity.lame(modulus, d.material.poisson, plane_stress=True))
        * d.sheet.thickness
    )
    low, high = layout.spacer_z
    held = np.flatnonzero((x > layout.clamp_edge - 1e-9) & (z > low - 1e-9) & (z < high + 1e-9))
    x0, x1, face = layout.pad_inner, layout.pad_outer, -d.element.pad_height
    pad = np.flatnonzero((np.abs(z - face) < 1e-9) & (x > x0 - 1e-9) & (x < x1 + 1e-9))
    pad = pad[np.argsort(x[pad])]
    (tip,) = np.flatnonzero((np.abs(x - land[0]) < 1e-9) & (np.abs(z - land[1]) < 1e-9))
    press = np.zeros(A.shape[0])
    press[2 * pad + 1] = line_load(x[pad], lambda q: np.full_like(q, 1.0 / (x1 - x0)), 2)
    push = np.zeros(A.shape[0])
    push[2 * tip + 1] = 1.0
    edge = np.zeros(A.shape[0])
    edge[2 * pad[-1] + 1] = 1.0
    free = np.setdiff1d(np.arange(A.shape[0]), np.concatenate([2 * held, 2 * held + 1]))
    factors = elasticity.factorised(A[free][:, free].tocsc())
    sides, direction = fillet_sides(mesh, basis, place, t, l, r)

    def answer(load: np.ndarray) -> Answer:
        u = np.zeros_like(load)
        u[free] = factors.solve(load[free])
        # at a free surface the stress along it is E times the strain along it; at the mid-side node of each
        # side
        (xa, za), (xb, zb) = direction
        du = np.stack([u[2 * sides[1]] - u[2 * sides[0]], u[2 * sides[1] + 1] - u[2 * sides[0] + 1]])
        dx = np.stack([xb - xa, zb - za])
        return Answer(float(press @ u), float(u[2 * tip + 1]), modulus * (du * dx).sum(0) / (dx**2).sum(0))

    return answer(press), answer(push), answer(edge)


def fillet_sides(mesh, basis, place, t, l, r):
    """Corner nodes of the mesh's sides on the slot's floor and fillets, and where they are."""
    facets = mesh.boundary_facets()
    corners = mesh.facets[:, facets]
    p = mesh.p[:, corners]  # component, end, side
    on = np.ones(p.shape[2], dtype=bool)
    for end in range(2):
        x, z = p[0, end] - place.hinge_x, p[1, end]
        floor = (np.abs(z - t) < 1e-6) & (np.abs(x) < l / 2)
        arcs = (
            (np.abs(np.hypot(np.abs(x) - (l / 2 - r), z - t - r) - r) < 1e-6)
            & (z < t + r + 1e-6)
            & (np.abs(x) > l / 2 - r - 1e-6)
        )
        on &= floor | arcs
    assert on.sum() > 20
    ends = basis.nodal_dofs[0, corners[:, on]]
    return ends, (basis.doflocs[:, ends[0]], basis.doflocs[:, ends[1]])


def gap_of(layout: Layout, place: ElementPlace) -> float:
    """As it is cut: on the part's characteristic."""
    return next(c.nominal for c in element(layout, place).characteristics if c.name == "stop gap")


@lru_cache
def width_share(name: str) -> float:
    """Largest stress at mid-width over the width's mean in a design's fillets, which hardly depends on the
    arm's length: by solid elements."""
    layout = Layout(load(name))
    result = fem_ladder.solve(hinge_section(layout, layout.elements[:1]).rows(0), "fem-solid", 0.5)
    return result.readings.fillet_stress / result.flat.fillet_stress


@pytest.mark.by_day(2, "elements each")
@pytest.mark.parametrize(("name", "arm"), KINDS)
def test_no_hinge_passes_its_rated_deflection_under_the_whole_load(name, arm):
    """Plane stress, with the modulus that makes the plane arm as stiff as its width makes it: the factor
    between the two rungs, which test_ladder_against_elements.py holds against solid elements."""
    design = load(name)
    layout, rating = Layout(design), design.rating
    place = next(p for p in layout.elements if p.arm == arm)
    section = hinge_section(layout, [place])
    wide = float((ladder.stiffness(section, "solid") / ladder.stiffness(section, "plane"))[0])
    press, push, edge = solved(layout, place, design.material.youngs_modulus * wide)

    def stopped(gap: float, load: Answer = press) -> tuple[Answer, float]:
        reaction = max(0.0, (rating.overload_force * load.tip - gap) / push.tip)
        return load.and_(push, rating.overload_force, reaction), reaction

    # of the mean over the width, which plane stress gives
    limit = design.material.yield_strength / rating.deflection_factor / width_share(name)
    rated_deflection = limit / np.abs(press.stress).max() * press.deflection
    widest = gap_of(layout, place) + design.stop.tolerance + seat(layout)
    state, reaction = stopped(widest)
    assert state.tip == pytest.approx(widest) and 0 < reaction < rating.overload_force
    assert state.deflection <= rated_deflection
    assert np.abs(state.stress).max() <= limit
    # nor does it yield where the weight stands on the pad's edge, nearer to the hinge
    assert np.abs(stopped(widest, edge)[0].stress).max() < limit * rating.deflection_factor
    # the estimator says the same, and a gap a fifth wider would not do
    (estimated,) = (o for o in overloads(layout) if o.place is place)
    mean = estimated.stress / float(strain.peak_share(section)[0])
    assert np.abs(state.stress).max() == pytest.approx(mean, rel=0.02)
    assert width_share(name) < estimated.stress / mean < 1.02 * width_share(name)
    if gap_of(layout, place) + 0.005 <= land_room(layout, place.hinge):  # else the land's room ends it first
        assert np.abs(stopped(1.2 * widest)[0].stress).max() > limit
