"""A planar cell's stiffness, stress and linear range, against solid elements, beam theory and symmetry."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from foil_elements import SITES, solved, stresses
from skfem import Basis, ElementQuad2, MeshQuad, condense, solve
from skfem.models.poisson import laplace, unit_load

from tactcad.families.planar import beam
from tactcad.families.planar.beam import MODES, FoilBeam
from tactcad.families.planar.cell import Cell, roots, wrench

SOFT = FoilBeam(4.0, 0.4, 0.08, 0.1, 179_000.0, 0.30)
STIFF = FoilBeam(2.2, 0.9, 0.08, 0.2, 179_000.0, 0.30)
PINWHEEL = Cell(SOFT, roots("pinwheel", 2.2, -1.1 + 0.8, 1.1 + 0.35 + 0.2))
STRAIGHT = Cell(STIFF, roots("straight", 3.0, 0.0, 0.0))


SILICON = FoilBeam(0.1, 0.012, 0.002, 0.004, 160_000.0, 0.22)  # polysilicon


@pytest.mark.parametrize(
    "held_out",
    [
        SOFT,
        STIFF,
        FoilBeam(3.0, 1.2, 0.1, 0.35, 127_000.0, 0.34),
        replace(SOFT, bevel=0.016),
        replace(STIFF, bevel=0.016),
        pytest.param(SILICON, marks=pytest.mark.nightly),
    ],
)
def test_closed_form_is_within_its_stated_error_of_solid_elements(held_out):
    stiffness = solved(held_out)
    stated = beam.bevel_errors()["stiffness"] if held_out.bevel else beam.fit()["errors"]
    for mode in MODES:
        assert beam.stiffness(held_out)[mode] == pytest.approx(stiffness[mode], rel=stated[mode]["climbed"])


@pytest.mark.parametrize(
    "held_out",
    [
        STIFF,
        pytest.param(SOFT, marks=pytest.mark.nightly),
        replace(SOFT, bevel=0.016),
        pytest.param(replace(STIFF, bevel=0.008), marks=pytest.mark.nightly),
    ],
)
def test_stress_is_within_its_stated_error_of_solid_elements(held_out):
    """Everywhere on faces and sides, not at the sites alone that are interpolated."""
    _, found = stresses(held_out)
    stated = beam.bevel_errors()["stress"] if held_out.bevel else beam.stress_errors()
    for mode in MODES:
        assert beam.stress(held_out)[mode] == pytest.approx(found[mode].max(), rel=stated[mode]["climbed"])


def test_half_a_bevel_changes_half_as_much():
    """Of stiffness, by solid elements: between plain beams and the bevel that was solved."""
    half = replace(SOFT, bevel=0.008)
    stiffness = solved(half)
    for mode, stated in beam.bevel_errors()["stiffness"].items():
        assert beam.stiffness(half)[mode] == pytest.approx(stiffness[mode], rel=stated["climbed"])
    assert beam.out_of_range(half) == "" and beam.out_of_range(replace(SOFT, bevel=0.02)).startswith("c/t")


def test_a_plain_beam_in_its_plane_is_stressed_most_on_its_side():
    """At half the thickness more than on the face; bent out of its plane, most on the face."""
    _, found = stresses(FoilBeam(1.0, 0.5, 1 / 15, 0.05, 1.0, 0.4), 1)
    side, face = SITES.index("root side"), SITES.index("root edge")
    assert all(1.05 < found[m][side] / found[m][face] < 1.14 for m in ("axial", "bend_in", "shear_in"))
    assert not SITES[found["bend_out"].argmax()].endswith(" side")


@pytest.mark.nightly
def test_stiffness_converges_through_the_foil():
    """Twist of a narrow beveled beam, by two elements of order 4 through half the thickness."""
    b = FoilBeam(1.0, 0.1, 1 / 17, 0.05, 1.0, 0.3, 0.2 / 17)
    (k,) = solved(b, 3, ["twist"], (2, 4)).values()
    assert solved(b, modes=["twist"])["twist"] == pytest.approx(k, rel=7e-4)


@pytest.mark.nightly
def test_stresses_converge():
    """One more element each way moves no mode's largest stress by a hundredth."""
    for b in (STIFF, FoilBeam(3.0, 1.2, 0.1, 0.15, 127_000.0, 0.34)):
        coarse, fine = (stresses(b, density)[1] for density in (2, 3))
        for mode in MODES:
            assert coarse[mode].max() == pytest.approx(fine[mode].max(), rel=0.01), mode


def torsion_by_elements(w, t, c):
    """Twice the integral of Prandtl's function, of a quarter on quadratic quadrilaterals."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 1, int(16 * w / t) + 1), np.linspace(0, 1, 17))
    across, up = mesh.p
    basis = Basis(MeshQuad(np.stack([across * (w / 2 - c * up), up * t / 2]), mesh.t), ElementQuad2())
    on_surface = basis.get_dofs(
        lambda x: np.isclose(x[0], w / 2 - 2 * c * x[1] / t) | np.isclose(x[1], t / 2)
    )
    load = unit_load.assemble(basis)
    return 8 * load @ solve(*condense(laplace.assemble(basis), 2 * load, D=on_surface))


@pytest.mark.parametrize("wide", [1.5, 5.0, 11.0])
@pytest.mark.parametrize("bevel", [0.0, 0.2, 0.3])
def test_section_of_a_beveled_beam(wide, bevel):
    """Slices of the hexagon, and Poisson's equation."""
    t, (u, weight) = 0.08, np.polynomial.legendre.leggauss(8)
    z, dz = (u + 1) * t / 4, 2 * weight * t / 4  # both halves
    slices = wide * t - 4 * bevel * z
    by_slices = [(slices * dz).sum(), (slices * z**2 * dz).sum(), (slices**3 / 12 * dz).sum()]
    b = FoilBeam(40 * t, wide * t, t, t, 1.0, 0.3, bevel * t)
    assert beam.section(b, b.width) == pytest.approx(by_slices)
    by_elements = torsion_by_elements(wide, 1.0, bevel) * t**4
    most = 0.005 if wide < 2 else 0.001
    assert beam.torsion_constant(b.width, t, b.bevel) == pytest.approx(by_elements, rel=most)


def test_long_narrow_beams_are_beam_theory():
    """Euler and Saint-Venant, of a beam at the slender end of the range with small fillets."""
    b = FoilBeam(10.0, 1.0, 0.2, 0.1, 200_000.0, 0.3)
    k, I, s = beam.stiffness(b), 1.0 * 0.2**3 / 12.0, 10.0 - 0.02  # the fillets' sections, nearly
    assert k["axial"] == pytest.approx(200_000.0 * 0.2 / s, rel=0.01)
    assert k["bend_out"] == pytest.approx(200_000.0 * I / s, rel=0.02)
    assert k["shear_out"] == pytest.approx(12.0 * 200_000.0 * I / s**3, rel=0.03)
    shear = 2.4 * 1.3 * (1.0 / s) ** 2  # Timoshenko's 12 E I/(kappa G A s^2)
    assert k["shear_in"] == pytest.approx(12.0 * 200_000.0 * (0.2 / 12.0) / s**3 / (1 + shear), rel=0.03)


@pytest.mark.parametrize("cell", [PINWHEEL, STRAIGHT])
def test_a_cell_is_square_symmetric_reciprocal_and_scales(cell):
    K = cell.stiffness
    assert np.allclose(K, K.T) and np.linalg.eigvalsh(K).min() > 0
    turn = np.zeros((6, 6))
    turn[:3, :3] = turn[3:, 3:] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    assert np.allclose(turn @ K @ turn.T, K, rtol=1e-9, atol=1e-9 * K.max())
    b = cell.beam
    twice = Cell(
        replace(b, length=2 * b.length, width=2 * b.width, thickness=2 * b.thickness, fillet=2 * b.fillet),
        tuple(replace(r, at=(2 * r.at[0], 2 * r.at[1])) for r in cell.roots),
    )
    assert twice.stiffness[2, 2] == pytest.approx(2 * K[2, 2]) and twice.stiffness[3, 3] == pytest.approx(
        8 * K[3, 3]
    )


def test_sink_is_four_guided_beams():
    assert PINWHEEL.stiffness[2, 2] == pytest.approx(4 * beam.stiffness(SOFT)["shear_out"])
    assert PINWHEEL.stiffness[2, 2] == pytest.approx(4 * 179_000 * 0.4 * 0.08**3 / 4.0**3, rel=0.05)


def test_tilt_of_a_straight_cell_by_hand():
    """Two beams bend at the island's half width, two twist: 2 (k_b + k_s (a/2 + s/2)^2) + 2 k_t + ... of
    the others' sink, none."""
    k = beam.stiffness(STIFF)
    by_hand = 2 * (k["bend_out"] + k["shear_out"] * (1.5 + 1.1) ** 2) + 2 * k["twist"]
    assert STRAIGHT.stiffness[3, 3] == pytest.approx(by_hand)


def test_a_straight_cell_stiffens_as_a_string_of_guided_beams():
    """F/(K z) - 1 = 0.72 (z/t)^2 of plain beams (A = w t, I = w t^3/12); a pinwheel gives nearly all of it
    back."""
    assert STRAIGHT.held == pytest.approx(1.0)
    assert STRAIGHT.stiffening * STIFF.thickness**2 == pytest.approx(0.72, rel=0.05)
    assert PINWHEEL.held < 0.05
    z = STRAIGHT.linear_range(0.05)
    assert STRAIGHT.stiffening * z**2 == pytest.approx(0.05)


def test_stiffening_against_the_beam_s_own_nonlinear_energy():
    """The stretch of a guided beam by quadrature of half its slope's square."""
    s, t = 2.2, 0.08
    u, weight = np.polynomial.legendre.leggauss(20)
    x, dx = (u + 1) * s / 2, weight * s / 2
    slope = 6 * x / s**2 - 6 * x**2 / s**3
    stretch = 0.5 * (slope**2 * dx).sum()
    assert stretch == pytest.approx(3 / (5 * s))
    k = beam.stiffness(STIFF)
    cubic = 2 * k["axial"] * stretch**2 / k["shear_out"]  # U = k z^2/2 + k_a (stretch z^2)^2/2
    assert STRAIGHT.stiffening == pytest.approx(cubic)
    assert cubic * t**2 == pytest.approx(0.72, rel=0.05)


def test_stress_of_a_sink_by_hand():
    """A guided beam's root: 3 E t z/s^2, lowered by the fillet, raised by the clamp."""
    by_hand = 3 * 179_000 * 0.08 / 4.0**2
    per_mm = PINWHEEL.stress(wrench(np.array([0.0, 0.0, -1.0]), 3.0)) * PINWHEEL.stiffness[2, 2]
    assert 0.9 * by_hand < per_mm < 1.3 * by_hand


def test_shear_tips_the_cell_by_its_lever():
    load = wrench(np.array([0.1, 0.0, 0.0]), 4.0)
    motion = PINWHEEL.compliance @ load
    assert motion[4] == pytest.approx(0.4 / PINWHEEL.stiffness[4, 4])
    assert load.tolist() == pytest.approx([0.1, 0, 0, 0, 0.4, 0])


def test_the_fit_s_report_keeps_what_is_promised():
    for errors, most in (
        (beam.fit()["errors"], 0.005),
        (beam.bevel_errors()["stiffness"], 0.005),
        (beam.stress_errors(), 0.03),
        (beam.bevel_errors()["stress"], 0.03),
    ):
        assert max(e["climbed"] for e in errors.values()) < most
        assert all(e["held_out"] <= e["climbed"] for e in errors.values())


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"width": 2.2}, "w/s = 0.55"),
        ({"thickness": 0.3}, "s/t = 13.3"),
        ({"poisson": 0.45}, "nu = 0.45"),
        ({"width": 2.0, "fillet": 1.9}, "r/s = 0.475; legal: r/s from 0 to 0.45"),
    ],
)
def test_out_of_range_is_said(change, said):
    assert beam.out_of_range(SOFT) == ""
    assert beam.out_of_range(replace(SOFT, **change)).startswith(said)


def test_what_the_page_says_of_polysilicon():
    """docs/architecture.md: K, and the force at 1 GPa, of cells at a pitch of 0.2 mm; pads 0.04 mm high."""
    short = FoilBeam(0.05, 0.02, 0.002, 0.006, 160_000.0, 0.22)
    for b, form, said, most in (
        (SILICON, roots("pinwheel", 0.05, -0.005, 0.039), 0.063, 0.55),
        (short, roots("straight", 0.08, 0.0, 0.0), 0.87, 2.15),
    ):
        assert beam.out_of_range(b) == ""
        cell = Cell(b, form)
        assert 1 / cell.compliance[2, 2] == pytest.approx(said, rel=0.01)
        stress = cell.stress(wrench(np.array([0.0, 0.0, -1e-3]), 0.04))
        assert 1000 / stress == pytest.approx(most, rel=0.02)
