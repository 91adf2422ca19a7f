"""An independent code on the same mesh. Skipped, saying so, where CalculiX is not installed."""

from __future__ import annotations

import calculix
import pytest

from tactcad.contact import large_strain
from tactcad.contact.elastic_body import Body
from tactcad.fem.elements import solve_plane
from tactcad.fem.fem_ladder import converged_plane, converged_solid
from tactcad.fem.mapped_mesh import plane_mesh
from tactcad.fem.shape import reference_shape
from tactcad.mechanics.section import REFERENCE

pytestmark = pytest.mark.skipif(
    calculix.executable() is None, reason="CalculiX (ccx) is not installed: apt-get install calculix-ccx"
)

E, NU, B = 69000.0, 0.33, 3.0
SHAPES = {two: reference_shape(REFERENCE.with_(two_sided=two)) for two in (True, False)}


@pytest.mark.parametrize("two", [True, False], ids=["two", "one"])
def test_plane_stress_agrees_with_cps8_at_vanishing_width(two, tmp_path):
    K = calculix.plane_stiffness(plane_mesh(SHAPES[two], 4), E, NU, B, tmp_path)
    assert K == pytest.approx(converged_plane(SHAPES[two], E, NU, B).stiffness, rel=5e-4)


def test_cps8_at_full_width_is_not_plane_stress(tmp_path, monkeypatch):
    """The trap: expanded to solids of the real width the strip is held like plane strain."""
    monkeypatch.setattr(calculix, "THIN", B)
    K = calculix.plane_stiffness(plane_mesh(SHAPES[True], 2), E, NU, B, tmp_path)
    assert 1.06 < K / solve_plane(SHAPES[True], E, NU, B, density=2).stiffness < 1.0 / (1.0 - NU**2)


@pytest.mark.by_day(1, "a run of CalculiX each")
@pytest.mark.parametrize("two", [True, False], ids=["two", "one"])
def test_solid_agrees_with_twenty_node_bricks(two, tmp_path):
    K = calculix.solve_solid(plane_mesh(SHAPES[two], 2), E, NU, B, 1, tmp_path).stiffness
    limit = converged_solid(SHAPES[two], E, NU, B).stiffness
    assert K == pytest.approx(limit, rel=4e-3)  # the mesh's own error, see the plane's at density 2


@pytest.mark.slow  # starts CalculiX
@pytest.mark.parametrize("nu, h, depth", [(0.49, 2.0, 0.4), (0.45, 4.0, 0.4), (0.3, 1.0, 0.3)])
def test_a_deep_punch_agrees_with_hyperelastic_rings(nu, h, depth, tmp_path):
    """CAX8R on a mesh twice as fine; ours on the shipped one."""
    body = Body(1.0, nu, h)
    mesh = large_strain._Rings(body, 1.0).basis.mesh.refined()
    theirs = calculix.punch_force(mesh, body, 1.0, depth, tmp_path / "punch.inp")
    assert large_strain.punch(body, 1.0, depth)[1][-1] == pytest.approx(theirs, rel=0.02)
