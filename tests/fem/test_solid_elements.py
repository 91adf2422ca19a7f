"""Solid elements: the value three codes agree on, limits in the width, convergence."""

from __future__ import annotations

import pytest

from tactcad.fem.elements import solve_plane, solve_solid
from tactcad.fem.fem_ladder import converged_solid
from tactcad.fem.shape import reference_shape
from tactcad.mechanics.section import REFERENCE

E, NU, B = 69000.0, 0.33, 3.0
TWO = reference_shape(REFERENCE)
ONE = reference_shape(REFERENCE.with_(two_sided=False))
THREE_CODES = 10.7246  # N/mm, agreed within 7e-4


def test_reference_design_meets_three_codes():
    found = converged_solid(TWO, E, NU, B)
    assert found.stiffness == pytest.approx(THREE_CODES, rel=1e-3)
    assert found.error < 1e-3


@pytest.mark.slow  # three meshes of solid elements
def test_refinement_comes_nearer_by_more_than_second_order():
    limit = converged_solid(TWO, E, NU, B).stiffness
    errors = [solve_solid(TWO, E, NU, B, density=d).stiffness / limit - 1 for d in (1, 2)]
    assert errors[0] > errors[1] > 0  # stiffer than the limit, as Galerkin's solutions are
    assert errors[0] / errors[1] > 2**2.3
    assert errors[1] < 1e-3


@pytest.mark.by_day(1, "solid elements each")
@pytest.mark.parametrize("shape", [TWO, ONE], ids=["two", "one"])
def test_narrow_strip_is_in_plane_stress_and_a_wide_plate_in_plane_strain(shape):
    stress, strain = (
        solve_plane(shape, E, NU, 1.0, density=1, plane_strain=p).stiffness for p in (False, True)
    )
    # on one mesh the two problems differ by what a quadratic u_y can follow of the plane's strain
    finer = solve_plane(shape, E, NU, 1.0, density=3).stiffness
    narrow = solve_solid(shape, E, NU, 0.01, density=3, across=1).stiffness / 0.01
    wide = solve_solid(shape, E, NU, 500.0, density=1).stiffness / 500.0
    assert narrow == pytest.approx(finer, rel=5e-5)
    assert wide == pytest.approx(strain, rel=1e-3)
    assert stress < solve_solid(shape, E, NU, B, density=1).stiffness / B < strain


def test_without_poisson_effect_the_width_does_not_matter():
    plane = solve_plane(ONE, E, 0.0, B, density=1).stiffness
    assert solve_solid(ONE, E, 0.0, B, density=1).stiffness == pytest.approx(plane, rel=1e-7)


def test_half_mesh_by_symmetry_is_the_whole():
    from dataclasses import replace

    # a body taller by a micrometre on one side is not symmetric any more and gets the whole mesh
    whole = replace(TWO, body=replace(TWO.body, high=TWO.body.high + 1e-6))
    half, all_of_it = (solve_solid(shape, E, NU, B, density=1).stiffness for shape in (TWO, whole))
    assert all_of_it == pytest.approx(half, rel=1e-4)
