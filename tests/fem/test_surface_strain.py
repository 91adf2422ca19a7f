"""Strain on the hinge's faces: equilibrium, published notch factors, and the closed forms for them."""

from __future__ import annotations

import numpy as np
import pytest
from samples import draw_box, section

from tactcad.fem.elements import solve_plane, solve_solid
from tactcad.fem.face_strain import face_strain
from tactcad.fem.shape import reference_shape
from tactcad.mechanics import strain
from tactcad.mechanics.section import REFERENCE

E, NU, B = 69000.0, 0.33, 3.0


def solved(s, density=2):
    material = float(s.youngs_modulus), float(s.poisson), float(s.width)
    return solve_plane(reference_shape(s), *material, density=density, order=4)


@pytest.mark.parametrize("two", [True, False], ids=["two", "one"])
def test_leaf_centre_of_a_long_hinge_carries_beam_theorys_strain(two):
    s = REFERENCE.with_(two_sided=two, hinge_length=1.3)
    nominal = float(strain.nominal(s, 1.0))
    assert face_strain(solved(s), "flat").centre == pytest.approx(nominal, rel=3e-3)


@pytest.mark.parametrize("rho,factor", [(0.25, 0.900), (0.6, 0.935), (1.0, 0.954), (2.0, 0.973)])
def test_flat_face_behind_a_round_notch_by_three_codes(rho, factor):
    r = rho * 0.25
    s = REFERENCE.with_(two_sided=False, fillet_radius=r, hinge_length=2 * r)
    centre = face_strain(solved(s), "flat").centre / float(strain.nominal(s, 1.0))
    assert centre == pytest.approx(factor, abs=2e-3)


@pytest.mark.parametrize("rho,factor", [(0.25, 1.49), (0.6, 1.23), (1.0, 1.15), (2.0, 1.08)])
def test_fillet_peak_over_the_leaf_by_three_codes(rho, factor):
    """On a long arm, where the moment hardly grows along the hinge."""
    s = REFERENCE.with_(fillet_radius=rho * 0.25, hinge_length=2 * rho * 0.25 + 0.75, load_arm=60.0)
    peak = face_strain(solved(s), "slot").peak / float(strain.nominal(s, 1.0))
    assert peak == pytest.approx(factor, rel=0.012)


def test_gauge_reads_the_mean_strain_that_its_ends_move_apart():
    """On the flat face the mean strain is the ends' displacement over the grid's length."""
    s = REFERENCE.with_(two_sided=False)
    solution = solved(s)
    nodes, u = solution.space.nodes, solution.displacement
    bottom = np.flatnonzero(np.abs(nodes[1]) < 1e-9)
    bottom = bottom[np.argsort(nodes[0, bottom])]
    for grid in (0.3, 0.5, 1.0):
        ends = np.interp([-grid / 2, grid / 2], nodes[0, bottom], u[0, bottom])
        assert face_strain(solution, "flat").mean(grid) == pytest.approx(np.diff(ends)[0] / grid, rel=3e-3)


@pytest.mark.parametrize("two,expected", [(True, 1.028), (False, 0.995)], ids=["two", "one"])
def test_half_millimetre_grid_on_the_reference_design(two, expected):
    s = REFERENCE.with_(two_sided=two)
    nominal = float(strain.nominal(s, 1.0))
    assert face_strain(solved(s), "flat").mean(0.5) / nominal == pytest.approx(expected, abs=3e-3)
    assert float(strain.gauge(s, 1.0, 0.5, "plane")) / nominal == pytest.approx(expected, abs=0.03)


def test_strain_per_newton_falls_in_three_dimensions_as_the_stiffness_grows():
    plane, solid = (
        solved(REFERENCE, 1),
        solve_solid(reference_shape(REFERENCE), E, NU, B, density=1, order=4, order_across=2),
    )
    ratio = face_strain(solid, "flat").mean(0.5) / face_strain(plane, "flat").mean(0.5)
    assert 0.900 < ratio < 0.915
    assert ratio * solid.stiffness / plane.stiffness == pytest.approx(1.0, abs=5e-3)


def test_closed_forms_of_strain_meet_the_elements_on_fresh_designs():
    s = section(draw_box(20, 1618))
    for i in range(20):
        one = s.rows(i)
        solution = solved(one)
        nominal = float(strain.nominal(one, 1.0))
        assert float(strain.fillet_factor(one)) == pytest.approx(
            face_strain(solution, "slot").peak / nominal, rel=0.02
        )
        flat = face_strain(solution, "flat")
        if not bool(one.two_sided):
            assert float(strain.face_factor(one)) == pytest.approx(flat.peak / nominal, rel=0.02)
        grid = 0.5 * float(one.hinge_length)
        if not (bool(one.two_sided) and grid > float(one.straight_length) + float(one.fillet_radius)):
            assert float(strain.grid_factor(one, grid)) == pytest.approx(flat.mean(grid) / nominal, rel=0.04)
