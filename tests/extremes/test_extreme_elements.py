"""Finite elements on extreme hinges: angles, condition, rounding, no locking, scaling, and refusals by
name."""

from __future__ import annotations

import warnings

import fem_extremes
import numpy as np
import pytest
from fem_extremes import corner_angles, plane_health
from hinges import scaled
from samples import draw_range, section

from tactcad.design.messages import CheckFailure
from tactcad.fem import fem_ladder as elements
from tactcad.fem.fem_ladder import converged_plane, converged_solid
from tactcad.fem.mapped_mesh import plane_mesh
from tactcad.fem.shape import reference_shape
from tactcad.mechanics import ladder
from tactcad.mechanics.section import REFERENCE

BOTH = pytest.mark.parametrize("two", [True, False], ids=["two", "one"])
EPS = np.finfo(float).eps


@pytest.fixture(autouse=True)
def loud():
    with warnings.catch_warnings(), np.errstate(over="raise", divide="raise", invalid="raise"):
        warnings.simplefilter("error")
        yield


def material(s):
    return float(s.youngs_modulus), float(s.poisson), float(s.width)


NIGHTLY = pytest.mark.nightly


@pytest.mark.by_day(2, "a mesh each")
@BOTH
@pytest.mark.parametrize(
    "t,density",
    [
        (0.02, 1),
        (0.05, 3),
        (0.2, 2),  # quadratic elements a fifth of the leaf long miss 2.5 % of the roots, which is no locking
        *(pytest.param(t, d, marks=NIGHTLY) for t in (0.01, 0.02) for d in (2, 3)),
    ],
)
def test_thin_leaves_do_not_lock(t, two, density):
    """What two roots add to beam theory's leaf is a length in thicknesses, the same for every thin leaf.

    At 0.02 mm a mesh that locks by one in ten thousand would take 1 % of a thickness away.
    """
    thick = fem_extremes.thin(0.1, two, 6).added_length
    assert fem_extremes.thin(t, two, density).added_length == pytest.approx(thick, rel=0.02)


@BOTH
def test_condition_grows_as_beam_theory_says_and_rounding_stays_below_it(two):
    """Of quadrilaterals of the leaf's own thickness the condition goes with (l/t)^3 and the number of
    elements."""
    rows = [fem_extremes.thin(t, two, 1) for t in (0.01, 0.02, 0.05, 0.1)]
    slopes = np.diff(np.log([r.condition for r in rows])) / np.diff(np.log([r.thickness for r in rows]))
    assert np.all((-4.3 < slopes) & (slopes < -3.0))
    for r in rows:
        assert r.rounding < EPS * r.condition
    assert next(r for r in rows if r.thickness == 0.02).rounding < 2e-6


@BOTH
def test_refinement_meets_no_rounding_floor_at_any_density_in_use(two):
    rows = fem_extremes.refined(two, (1, 2, 3, 6, 8))
    assert [r.error for r in rows] == sorted((r.error for r in rows), reverse=True)
    for r in rows:
        assert r.rounding < min(1e-8, EPS * r.condition)
    # Richardson on densities 3 and 6 takes differences of 1e-4: their rounding is far below what it corrects
    assert rows[3].rounding < 1e-3 * rows[3].error


def test_angles_stay_open_over_the_whole_range():
    """No element is nearly a triangle, whatever the hinge: drawn over every group's range, fillets of 6 t
    included."""
    s = section(draw_range(80, seed=99))
    for i in range(80):
        smallest, largest = corner_angles(plane_mesh(reference_shape(s.rows(i)), 2))
        assert smallest > 20.0 and largest < 160.0


@pytest.mark.by_day(2, "a mesh each")
@BOTH
@pytest.mark.parametrize("ratio", [2.0, 5.9, 12.0])
def test_fillets_many_times_the_thickness_do_not_fold_the_mesh(ratio, two):
    """Beside angles: the coarse mesh meets the limit, and the thin notch's own exact limit is near."""
    t = 0.05
    s = REFERENCE.with_(
        two_sided=two,
        hinge_thickness=t,
        fillet_radius=ratio * t,
        hinge_length=2 * ratio * t + 0.3,
        arm_height=4.0,
        body_height=6.0,
    )
    shape = reference_shape(s)
    smallest, largest = corner_angles(plane_mesh(shape, 3))
    assert smallest > 20.0 and largest < 160.0
    found = plane_health(shape, *material(s), 3).compliance
    fine = plane_health(shape, *material(s), 6).compliance
    assert found == pytest.approx(fine, rel=3e-4)
    # beyond the fit section theory holds more and more: the notch bends like its sections
    assert 1.0 / fine == pytest.approx(float(ladder.stiffness(s, "section")), rel=0.35 / ratio**0.5)


@BOTH
@pytest.mark.parametrize("factor", [1 / 25, 1e-3, 1e3])
def test_stiffness_goes_with_size_and_strain_does_not(two, factor):
    s, small = REFERENCE.with_(two_sided=two), REFERENCE.with_(two_sided=two, **scaled(factor))
    large, little = (elements.solve(x, "fem-plane", 0.5 * k) for x, k in ((s, 1.0), (small, factor)))
    assert little.stiffness == pytest.approx(factor * large.stiffness, rel=1e-8)
    # strain per newton goes with 1/size^2: at a force that goes with size^2 it stays
    assert little.readings.gauge * factor**2 == pytest.approx(large.readings.gauge, rel=1e-6)
    assert little.readings.fillet_strain * factor**2 == pytest.approx(large.readings.fillet_strain, rel=1e-6)


@pytest.mark.slow  # solid elements twice
def test_jaw_sized_solid_is_the_large_one_over_25():
    large, jaw = REFERENCE.with_(two_sided=False), REFERENCE.with_(two_sided=False, **scaled(1 / 25))
    K, k = (converged_solid(reference_shape(s), *material(s)).stiffness for s in (large, jaw))
    assert k == pytest.approx(K / 25, rel=1e-8)


@pytest.mark.parametrize("rung", ["fem-plane", "fem-solid"])
@pytest.mark.parametrize(
    "change,reason",
    [
        (dict(hinge_length=0.0, fillet_radius=0.0), "not positive"),
        (dict(fillet_radius=0.0), "needs rounded slot corners"),
        (dict(hinge_length=12.0), "load inside the slot"),
        (dict(hinge_length=0.5, fillet_radius=0.25 + 1e-6), "fillets longer than the slot"),
        (dict(hinge_thickness=2.0), "fillets higher than the arm"),
        (dict(poisson=0.5), "poisson is outside"),
        (dict(hinge_thickness=np.nan), "not a finite number"),
    ],
    ids=["no slot", "sharp", "slot of twice the arm", "over-round", "no arm", "incompressible", "nan"],
)
def test_what_elements_cannot_solve_they_refuse_by_name(change, reason, rung):
    with pytest.raises(CheckFailure, match=reason):
        elements.stiffness(REFERENCE.with_(**change), rung)


@NIGHTLY
def test_a_leaf_of_half_a_micrometre_has_too_few_digits_and_is_refused():
    thin = REFERENCE.with_(hinge_thickness=5e-4, fillet_radius=0.01, hinge_length=2.0)
    with pytest.raises(CheckFailure, match="rounding moves the compliance.*too long and thin"):
        elements.stiffness(thin, "fem-plane")


@BOTH
def test_full_round_is_the_limit_of_a_short_straight_part(two):
    exact = REFERENCE.with_(two_sided=two, hinge_length=0.5, fillet_radius=0.25)
    near = exact.with_(hinge_length=0.5 + 1e-3)
    K = [converged_plane(reference_shape(s), *material(s)).stiffness for s in (exact, near)]
    slope = float(ladder.stiffness(near, "plane") / ladder.stiffness(exact, "plane"))
    assert K[1] / K[0] == pytest.approx(slope, abs=2e-4)


@BOTH
@pytest.mark.parametrize(
    "change",
    [
        dict(
            load_arm=0.5,
            hinge_length=0.2,
            fillet_radius=0.05,
            hinge_thickness=0.05,
            arm_height=0.4,
            body_height=0.8,
            body_length=0.8,
        ),
        dict(
            load_arm=100.0,
            hinge_length=15.0,
            fillet_radius=3.0,
            hinge_thickness=5.0,
            arm_height=40.0,
            body_height=80.0,
            body_length=80.0,
        ),
        dict(
            hinge_thickness=2.0,
            hinge_length=6.0,
            fillet_radius=1.0,
            load_arm=40.0,
            arm_height=12.0,
            body_height=24.0,
            body_length=24.0,
        ),
        dict(hinge_thickness=0.02, fillet_radius=0.1, hinge_length=0.5, arm_height=1.4, body_height=3.0),
    ],
    ids=["arm 0.5 mm", "arm 100 mm", "hinge 2 mm", "hinge 0.02 mm"],
)
def test_extreme_hinges_by_elements_and_by_the_closed_form(change, two):
    s = REFERENCE.with_(two_sided=two, **change)
    found = converged_plane(reference_shape(s), *material(s))
    assert found.error < 1e-3
    assert found.stiffness == pytest.approx(float(ladder.stiffness(s, "plane")), rel=6e-3)


@pytest.mark.slow  # four panels of plots
def test_picture_has_its_four_panels():
    few = fem_extremes.Extremes(
        tuple(
            fem_extremes.thin(t, two, d)
            for two in (True, False)
            for d in fem_extremes.DENSITIES
            for t in (0.2, 0.5)
        ),
        tuple(fem_extremes.refined(True, (1, 2)) + fem_extremes.refined(False, (1, 2))),
        tuple(fem_extremes.angles(2, 1)),
    )
    text = fem_extremes.picture(few)
    assert (
        text == fem_extremes.picture(few)
        and text.startswith("<svg")
        and text.count('<g id="fem-extremes-axes_') == 4
    )
