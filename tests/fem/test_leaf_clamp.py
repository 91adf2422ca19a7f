"""The leaf under the clamp by elements, against statics and beam theory."""

from __future__ import annotations

import numpy as np
import pytest
from variants import variant

from tactcad.fem import bonded_leaf
from tactcad.fem.bonded_leaf import clamped
from tactcad.fem.mapped_mesh import plane_mesh
from tactcad.fem.shape import reference_shape
from tactcad.fem.space import PlaneSpace
from tactcad.mechanics import strain
from tactcad.parts.array.hinge_section import hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.parts.rigs.bonding_fixture import bonding_rigs

RUBBER, WIDTH, GRID = (1.2, 2.8), 1.5, 0.5


def leaf(element=0, changes=None):
    layout = Layout(variant(changes))
    return hinge_section(layout, layout.elements).rows(element)


def lying(changes=None):
    """An element whose body ends on the fixture's rest, and the flat of the tongue under it."""
    (rig,) = bonding_rigs(variant(changes))
    s = leaf(0, changes).with_(body_length=rig.rear_ends[0] - rig.hinge.l / 2)
    return s, rig.tongue - 2 * rig.tongue_radius, rig.rear_ends[0]


def test_the_pressure_is_all_there_and_where_it_is():
    mesh = plane_mesh(reference_shape(leaf()), 2, whole=True, order=3)
    space = PlaneSpace.of(mesh)
    f = bonded_leaf.pressed(space, mesh, (1.2, 1.5))
    assert f.sum() == pytest.approx(2.7, rel=5e-3)
    assert f @ space.nodes[0] / f.sum() == pytest.approx((1.2 - 1.5) / 2, abs=0.01)


@pytest.mark.parametrize("element", [0, 3])
@pytest.mark.parametrize("to_arm", [0.9, 1.2, 1.7])
def test_an_unbacked_leaf_bends_by_the_pressure_ahead_of_it(element, to_arm):
    """M = p w a^2/2 at the hinge's middle, and its strain by the fitted mean under the grid: the moment falls
    as a square there, which a load at lever a/2 stands for to a few per cent."""
    s = leaf(element)
    one = clamped(s, (to_arm, 1.5), WIDTH, GRID)
    moment = WIDTH * to_arm**2 / 2
    nominal = 6 * moment / (float(s.width) * float(s.hinge_thickness) ** 2 * float(s.youngs_modulus))
    factor = float(strain.grid_factor(s.with_(load_arm=to_arm / 2), GRID))
    assert one.gauge_strain == pytest.approx(nominal * factor, rel=0.06)
    assert one.on_tongue == 0.0


@pytest.mark.parametrize("changes", [{}, {"element.fillet_radius": 0.44}, {"element.hinge_length": 1.5}])
def test_a_backed_element_rests_on_tongue_and_rear_rest(changes):
    """Moments about the rest: the tongue takes P (x_rest - x_p)/x_rest of the clamp's force P at x_p."""
    s, tongue, rest = lying(changes)
    one = clamped(s, RUBBER, WIDTH, GRID, tongue)
    force, at = WIDTH * sum(RUBBER), (RUBBER[1] - RUBBER[0]) / 2
    assert one.on_tongue == pytest.approx(force * (rest - at) / rest, rel=0.02)


def test_the_tongue_takes_most_of_the_stress_off_the_leaf():
    s, tongue, _ = lying()
    backed, free = clamped(s, RUBBER, WIDTH, GRID, tongue), clamped(leaf(), RUBBER, WIDTH, GRID)
    assert backed.stress < 0.6 * free.stress
    # a finger's 20 N right over the hinge: all of it beside an unbacked leaf, next to none of it on a tongue
    middle = (0.3, 0.3)
    over = clamped(s, middle, WIDTH, GRID, tongue).stress / clamped(leaf(), middle, WIDTH, GRID).stress
    assert over < 0.6


@pytest.mark.parametrize("tongue", [False, True])
def test_finer_meshes_agree(tongue, monkeypatch):
    s, flat, _ = lying()
    s, flat = (s, flat) if tongue else (leaf(), None)
    coarse = clamped(s, RUBBER, WIDTH, GRID, flat)
    monkeypatch.setattr(bonded_leaf, "DENSITY", 4)
    fine = clamped(s, RUBBER, WIDTH, GRID, flat)
    assert coarse.stress == pytest.approx(fine.stress, rel=0.04)
    assert coarse.gauge_strain == pytest.approx(fine.gauge_strain, rel=0.04)


def test_stress_goes_with_the_square_of_the_leafs_thickness():
    thin, thick = (
        clamped(leaf().with_(hinge_thickness=t, hinge_length=3.0), RUBBER, WIDTH, GRID).gauge_strain
        for t in (0.15, 0.3)
    )
    assert np.log2(thin / thick) == pytest.approx(2.0, abs=0.06)
