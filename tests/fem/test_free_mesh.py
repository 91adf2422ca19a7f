"""Triangles in any contour: areas, and the same stiffness as the mapped mesh; the uncut part."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementTriP2

from tactcad.contour import circle, rectangle
from tactcad.fem import elasticity
from tactcad.fem.elements import fixed_unknowns, parabola
from tactcad.fem.fem_ladder import converged_plane
from tactcad.fem.free_mesh import Fine, triangle_mesh
from tactcad.fem.mapped_mesh import plane_mesh
from tactcad.fem.shape import outline, reference_shape
from tactcad.fem.space import line_load
from tactcad.lab.array_estimate import compare_uncut
from tactcad.mechanics.section import REFERENCE
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import load


def test_area_of_a_plate_with_holes_is_exact_but_for_the_arcs_parabolas():
    holes = (circle((2.0, 2.0), 1.0), circle((5.0, 2.5), 2.0))
    mesh = triangle_mesh(rectangle(0, 0, 8, 4), holes, (), 0.5)
    area = Basis(mesh, ElementTriP2(), intorder=4).dx.sum()
    assert area == pytest.approx(32.0 - np.pi / 4 - np.pi, rel=2e-5)


@pytest.mark.parametrize("two", [True, False], ids=["two", "one"])
def test_free_mesh_and_mapped_mesh_agree_on_the_reference_design(two):
    s = REFERENCE.with_(two_sided=two)
    shape = reference_shape(s)
    fine = tuple(Fine((x, (shape.low + shape.high) / 2), 0.06) for x in np.linspace(-0.375, 0.375, 9))
    basis = Basis(triangle_mesh(outline(reference_shape(s)), (), fine, 0.6), ElementTriP2(), intorder=4)
    mapped = plane_mesh(shape, 1, whole=True)
    A = elasticity.stiffness_matrix(basis, *elasticity.lame(69000.0, 0.33, plane_stress=True)) * 3.0
    f = np.zeros(A.shape[0])
    x, z = basis.doflocs
    end = np.flatnonzero(np.abs(x - mapped.load_x) < 1e-9)
    end = end[np.argsort(z[end])]
    f[2 * end + 1] = line_load(z[end], lambda z: parabola(z, mapped), 2)
    u = elasticity.solve(A, f, fixed_unknowns(basis.doflocs, mapped, 2))
    assert 1.0 / (f @ u) == pytest.approx(converged_plane(shape, 69000.0, 0.33, 3.0).stiffness, rel=2e-3)


def test_uncut_element_of_the_array_is_within_a_per_cent_of_its_model():
    found = compare_uncut(Layout(load("macro-array")))
    assert found.number == 1
    assert found.uncut == pytest.approx(found.model, rel=0.01)
    assert found.uncut != found.model
