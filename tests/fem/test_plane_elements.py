"""Plane elements: the value three codes agree on, rates, patch test, and exact relations between problems."""

from __future__ import annotations

import numpy as np
import pytest

from tactcad.fem import elasticity
from tactcad.fem.elements import end_load, solve_plane
from tactcad.fem.fem_ladder import RATE, converged_plane, richardson
from tactcad.fem.mapped_mesh import plane_mesh
from tactcad.fem.shape import outline, reference_shape
from tactcad.fem.space import PlaneSpace
from tactcad.mechanics.section import REFERENCE

E, NU, B = 69000.0, 0.33, 3.0
TWO = reference_shape(REFERENCE)
ONE = reference_shape(REFERENCE.with_(two_sided=False))
THREE_CODES = 9.75423  # N/mm, plane stress, agreed within 7e-5


def test_reference_design_meets_three_codes():
    found = converged_plane(TWO, E, NU, B)
    assert found.stiffness == pytest.approx(THREE_CODES, rel=1e-4)
    assert found.error < 1e-4


@pytest.mark.parametrize("shape,least", [(TWO, 3.4), (ONE, 3.0)], ids=["two", "one"])
def test_energy_converges_with_fourth_order(shape, least):
    coarse, middle, fine = (solve_plane(shape, E, NU, B, density=d).compliance for d in (2, 4, 8))
    assert coarse < middle < fine  # Galerkin: from below
    order = np.log2((middle - coarse) / (fine - middle))
    assert least < order < 4.6
    assert fine < richardson((middle, fine), (4, 8), RATE) < fine * (1 + 2e-5)


def test_richardson_from_coarse_meshes_meets_a_fine_one():
    fine = solve_plane(ONE, E, NU, B, density=10).compliance
    assert converged_plane(ONE, E, NU, B).compliance == pytest.approx(fine, rel=3e-5)


def test_half_mesh_of_the_symmetric_shape_is_the_whole():
    half, whole = (solve_plane(TWO, E, NU, B, density=2, whole=w) for w in (False, True))
    assert whole.stiffness == pytest.approx(half.stiffness, rel=1e-9)
    assert half.unknowns < 0.6 * whole.unknowns


@pytest.mark.parametrize("shape", [TWO, ONE], ids=["two", "one"])
def test_mesh_area_is_the_contours(shape):
    mesh = plane_mesh(shape, 3)
    area = PlaneSpace.of(mesh).area * (2 if mesh.half else 1)
    assert area == pytest.approx(outline(shape).area, rel=1e-6)  # arcs are parabolas of high order


@pytest.mark.parametrize("order", [2, 4, 6])
def test_linear_displacement_is_in_equilibrium_inside(order):
    """Patch test: any linear field strains uniformly, so no inner node feels a force."""
    space = PlaneSpace.of(plane_mesh(ONE, 2, order=order))
    x, z = space.nodes
    u = np.stack([0.3 * x - 0.2 * z + 1.0, 0.5 * x + 0.7 * z], axis=1).ravel()
    force = np.abs((space.stiffness(*elasticity.lame(1.0, 0.3, plane_stress=True)) @ u).reshape(-1, 2))
    sides, times = np.unique(np.sort(space.edges[:, [0, -1]]), axis=0, return_counts=True)
    outer = {tuple(side) for side in sides[times == 1]}  # of one element only
    on_edge = [edge for edge in space.edges if tuple(np.sort(edge[[0, -1]])) in outer]
    inner = np.setdiff1d(np.arange(len(x)), np.concatenate(on_edge))
    assert force[inner].max() < 1e-11
    assert force.max() > 1e-3


def test_rigid_turn_needs_no_force():
    space = PlaneSpace.of(plane_mesh(TWO, 1))
    x, z = space.nodes
    A = space.stiffness(*elasticity.lame(1.0, 0.3))
    assert np.abs(A @ np.stack([-z, x], axis=1).ravel()).max() < 1e-11
    assert abs(A - A.T).max() < 1e-12


def test_plane_strain_is_plane_stress_of_another_material():
    strain = solve_plane(TWO, E, NU, B, density=2, plane_strain=True).stiffness
    stress = solve_plane(TWO, E / (1 - NU**2), NU / (1 - NU), B, density=2).stiffness
    assert strain == pytest.approx(stress, rel=1e-9)


def test_stiffness_is_proportional_to_modulus_and_width_and_free_of_size():
    base = solve_plane(ONE, E, NU, B, density=1).stiffness
    assert solve_plane(ONE, 2 * E, NU, 5 * B, density=1).stiffness == pytest.approx(10 * base, rel=1e-9)
    lengths = (
        "hinge_thickness",
        "hinge_length",
        "fillet_radius",
        "load_arm",
        "arm_height",
        "body_height",
        "body_length",
    )
    s = REFERENCE.with_(two_sided=False)
    small = reference_shape(s.with_(**{n: getattr(s, n) / 25 for n in lengths}))
    assert solve_plane(small, E, NU, B, density=1).stiffness == pytest.approx(base, rel=1e-9)


@pytest.mark.parametrize("order", [2, 4])
def test_unit_force_is_applied(order):
    mesh = plane_mesh(ONE, 2, order=order)
    space = PlaneSpace.of(mesh)
    end, f = end_load(space, mesh)
    assert f.sum() == pytest.approx(1.0, rel=1e-12)
    assert f @ space.nodes[1, end] == pytest.approx((ONE.arm.low + ONE.arm.high) / 2, rel=1e-12)  # no couple


def test_nodes_where_fillets_meet_are_no_slivers():
    """A slot that rounding leaves a billionth of a millimetre longer than its fillets."""
    exact = REFERENCE.with_(hinge_length=0.5, fillet_radius=0.25)
    rounded = REFERENCE.with_(hinge_length=0.5, fillet_radius=0.25 - 1e-9)
    a, b = (solve_plane(reference_shape(s), E, NU, B, density=2).stiffness for s in (exact, rounded))
    assert a == pytest.approx(b, rel=1e-6)


def test_no_mesh_is_torn_whatever_the_designs_decimals():
    """Euler's formula is checked on every mesh; decimals put nodes on the lines of any decimal grid."""
    rng = np.random.default_rng(11)
    for i in range(60):
        step = (0.1, 0.05, 0.01)[i % 3]
        rounded = lambda low, high: round(round(rng.uniform(low, high) / step) * step, 9)  # noqa: E731, B023
        radius = max(rounded(0.1, 0.3), step)
        s = REFERENCE.with_(
            fillet_radius=radius,
            hinge_length=2 * radius + rounded(0.0, 1.0),
            hinge_thickness=max(rounded(0.15, 0.4), step),
            load_arm=rounded(3, 7),
            arm_height=rounded(1.5, 3),
            body_height=rounded(3, 8),
            body_length=rounded(2, 6),
            two_sided=bool(i % 2),
        )
        PlaneSpace.of(plane_mesh(reference_shape(s), 3))
