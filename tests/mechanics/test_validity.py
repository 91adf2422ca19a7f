"""Each rung refuses what it cannot answer, by a named rule that a design made for it breaks."""

from __future__ import annotations

import re

import numpy as np
import pytest

from tactcad.design.messages import CheckFailure
from tactcad.mechanics import ladder, strain, validity
from tactcad.mechanics.section import OPTIONAL, REFERENCE, REQUIRED, friction_factor

BREAKS = {
    "a value is not a finite number": dict(load_arm=np.nan),
    "a length, width or modulus is not positive": dict(hinge_thickness=0.0),
    "a length or width is outside 1e-06 to 1e+06 mm": dict(body_length=1.01e6),
    "youngs_modulus is outside 1e-06 to 1e+12 MPa": dict(youngs_modulus=0.99e-6),
    "fillet_radius is negative": dict(fillet_radius=-0.1),
    "poisson is outside 0 to 0.5": dict(poisson=0.5),
    "fillets longer than the slot: 2 r > l": dict(fillet_radius=0.376),
    "load inside the slot: L <= l/2": dict(load_arm=0.375),
    "fillets higher than the arm": dict(arm_height=0.54),
    "fillets higher than the body": dict(body_height=0.54),
    "pad_height or friction is negative": dict(friction=-0.1),
    "friction locks the arm: mu (pad_height + t/2) >= L": dict(friction=0.7, pad_height=10.0),
}
FITTED_BREAKS = {
    "arm too low for the fit": dict(arm_height=0.68),
    "body too low for the fit": dict(body_height=0.68),
    "r/t is outside": dict(fillet_radius=0.02),
    "body too short for the fit": dict(body_length=0.6),
    "l/t is outside": dict(hinge_length=40.0, load_arm=60.0),
    "h/t is outside": dict(arm_height=40.0, load_arm=60.0),
    "Hb/t is outside": dict(body_height=60.0),
    "(L - l/2)/h is outside": dict(load_arm=1.0),
    "L/Hb is outside": dict(load_arm=30.0, arm_height=10.0),
    "Lb/Hb is outside": dict(body_length=0.5),
    "poisson is outside the fit": dict(poisson=0.47),
    "b/t is outside": dict(width=0.4),
    "b/l is outside": dict(width=0.3),
}


@pytest.mark.parametrize("name", BREAKS)
@pytest.mark.parametrize("rung", ladder.RUNGS)
def test_impossible_designs_are_refused_by_every_rung(rung, name):
    s = REFERENCE.with_(**BREAKS[name])
    assert name in validity.broken_rules(s, rung)
    with pytest.raises(CheckFailure, match="rung"):
        ladder.require_range(s, rung)


def test_every_rule_of_geometry_has_a_design_that_breaks_it():
    assert set(BREAKS) == {rule.name for rule in validity.GEOMETRY}


@pytest.mark.parametrize("start", FITTED_BREAKS)
def test_designs_beyond_the_fit_are_refused_by_the_fitted_rungs_alone(start):
    s = REFERENCE.with_(**FITTED_BREAKS[start])
    assert any(name.startswith(start) for name in validity.broken_rules(s, "solid"))
    assert not validity.broken_rules(s, "beam")
    assert np.isfinite(ladder.stiffness(s, "beam"))


def test_evaluate_gives_reasons_instead_of_numbers():
    s = REFERENCE.with_(load_arm=[6.0, 0.1, 6.0], poisson=[0.33, 0.33, -1.0])
    result = ladder.evaluate(s, "solid")
    assert result.valid.tolist() == [True, False, False]
    assert np.isnan(result.stiffness[1:]).all() and result.stiffness[0] == ladder.stiffness(REFERENCE)
    assert result.reason[0] == "" and "load inside" in result.reason[1] and "poisson" in result.reason[2]


def test_whole_promised_box_is_inside_the_range():
    rng = np.random.default_rng(2)
    n = 200_000
    t, l, r = rng.uniform(0.15, 0.4, n), rng.uniform(0.3, 1.5, n), rng.uniform(0.1, 0.3, n)  # noqa: E741
    r = np.minimum(r, l / 2)
    u = lambda low, high: rng.uniform(low, high, n)  # noqa: E731
    s = REFERENCE.with_(
        hinge_thickness=t,
        hinge_length=l,
        fillet_radius=r,
        load_arm=u(3, 7),
        arm_height=u(1.5, 3),
        body_height=u(3, 8),
        body_length=u(2, 6),
        poisson=u(0.2, 0.4),
        width=u(1.5, 8),
        two_sided=rng.random(n) < 0.5,
    )
    assert validity.broken_rules(s, "solid") == {}


def test_friction_stiffens_by_the_lever_of_the_pad():
    s = REFERENCE.with_(load_arm=3.0, pad_height=2.0, friction=0.2)
    assert friction_factor(s) == pytest.approx(3.0 / (3.0 - 0.2 * 2.125))
    assert ladder.stiffness(s) == pytest.approx(ladder.stiffness(REFERENCE.with_(load_arm=3.0)) * 3.0 / 2.575)


def test_moments_about_the_hinge_give_the_friction_formula():
    """Virtual work: F d + mu F (H d/L) against the arm's own K d: K_apparent (1 - mu H/L) = K."""
    s = REFERENCE.with_(pad_height=2.0, friction=0.15)
    K, H, L = float(ladder.stiffness(REFERENCE)), 2.0 + 0.125, 6.0
    apparent = float(ladder.stiffness(s))
    assert apparent * (1 - 0.15 * H / L) == pytest.approx(K, rel=1e-12)


def test_friction_takes_as_much_of_the_signal_as_it_adds_to_the_stiffness():
    """Moments about the hinge: F L - mu F H bends it, so its strain stays what its turn is; the stress that
    strength is taken from is a slippery object's."""
    rough, smooth = (REFERENCE.with_(pad_height=2.0, friction=mu) for mu in (0.15, 0.0))
    bent = [float(strain.gauge(s, 1.0, 0.3)) for s in (rough, smooth)]
    assert bent[0] / bent[1] == pytest.approx(1 - 0.15 * 2.125 / 6.0, rel=1e-12)
    turned = [b * float(ladder.stiffness(s)) for b, s in zip(bent, (rough, smooth))]
    assert turned[0] == pytest.approx(turned[1], rel=1e-12)
    assert strain.peak_stress(rough, 1.0) == strain.peak_stress(smooth, 1.0)


@pytest.mark.parametrize("start", [*BREAKS, *FITTED_BREAKS])
def test_a_reason_names_the_fields_to_look_at(start):
    """Changed back to what it was, one of the fields named mends it."""
    changes = (BREAKS | FITTED_BREAKS)[start]
    s = REFERENCE.with_(**changes)
    reason = str(validity.reasons(s, "solid"))
    fields = re.search(r"\((\w+(?:, \w+)*)\)$", reason)[1].split(", ")
    assert set(fields) <= {*REQUIRED, *OPTIONAL}
    mended = s.with_(**{name: getattr(REFERENCE, name) for name in fields})
    assert str(validity.reasons(mended, "solid")) != reason and set(fields) & set(changes)


def test_of_a_rule_for_each_field_the_reason_names_the_one_that_breaks_it():
    s = REFERENCE.with_(width=[3.0, -1.0, 3.0], hinge_length=[0.75, 0.75, 0.0])
    assert [r.rpartition(" ")[2] for r in validity.reasons(s, "beam")] == ["", "(width)", "(hinge_length)"]
    with pytest.raises(CheckFailure, match=r"not positive \(width\) \(design 2 of 3\)$"):
        ladder.require_range(s, "beam")


def test_every_group_has_its_fields():
    assert set(validity.FIELDS) == {*validity.PLANE_GROUPS, *validity.WIDTH_GROUPS, *validity.LEAST}
    for name, value in (validity.PLANE_GROUPS | validity.WIDTH_GROUPS).items():
        for field in REQUIRED:  # a group changes with its fields and with no other
            moved = REFERENCE.with_(**{field: getattr(REFERENCE, field) * 1.01})
            assert (value(moved) != value(REFERENCE)).any() == (field in validity.FIELDS[name]), (name, field)
