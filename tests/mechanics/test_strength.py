"""Strength by hand calculation: yield, rated force, Goodman, and the paper's strains."""

from __future__ import annotations

import numpy as np
import pytest

from tactcad.design.materials import ALLOYS, Alloy, alloy
from tactcad.design.messages import InputError
from tactcad.mechanics import strain, strength
from tactcad.mechanics.section import REFERENCE

ARRAY = REFERENCE.with_(
    two_sided=False,
    hinge_length=0.88,
    fillet_radius=0.30,
    arm_height=2.6,
    body_height=3.0,
    load_arm=[3.0, 5.0, 7.0],
    body_length=[5.96, 3.96, 1.96],
)


def test_nominal_stress_is_moment_over_section_modulus():
    F, L, b, t, E = 2.0, 6.0, 3.0, 0.25, 69000.0
    assert float(strain.nominal(REFERENCE, F)) * E == pytest.approx(F * L / (b * t**2 / 6))


def test_yield_force_puts_the_fillet_at_the_yield_strength():
    for sheet in ALLOYS.values():
        force = strength.yield_force(ARRAY, sheet)
        np.testing.assert_allclose(strain.peak_stress(ARRAY, force), sheet.yield_strength, rtol=1e-12)


def test_fillet_yields_before_the_flat_face():
    assert np.all(strain.face_stress(ARRAY, 1.0) < strain.peak_stress(ARRAY, 1.0))


@pytest.mark.parametrize(
    "name,nominal",
    [("6061-T6", (2.86, 1.72, 1.23)), ("2024-T3", (3.59, 2.16, 1.54)), ("7075-T6", (5.26, 3.16, 2.25))],
)
def test_nominal_yield_forces_by_hand(name, nominal):
    """sigma b t^2/(6 L) at L = 3, 5, 7."""
    sheet = alloy(name)
    by_hand = sheet.yield_strength * 3.0 * 0.25**2 / (6 * np.array([3.0, 5.0, 7.0]))
    np.testing.assert_allclose(by_hand, nominal, rtol=3e-3)
    reduced = strength.yield_force(ARRAY, sheet) / by_hand
    assert np.all((reduced > 1 / 1.35) & (reduced < 1 / 1.15))  # the fillet's share


def test_elastic_says_no_above_yield():
    sheet = ALLOYS["6061-T6"]
    at_yield = strength.yield_force(ARRAY, sheet)
    assert strength.elastic(ARRAY, sheet, 0.999 * at_yield).all()
    assert not strength.elastic(ARRAY, sheet, 1.001 * at_yield).any()


def test_goodman_by_hand():
    sheet = Alloy("test", 70000.0, 0.33, 2700.0, 500.0, 150.0, "hand", 572.0)
    k = 4.51 * 572.0**-0.265
    stress = 200.0
    assert float(strength.goodman(sheet, stress)) == pytest.approx(1 / (100 / (k * 150) + 100 / 572.0))
    without = Alloy("test", 70000.0, 0.33, 2700.0, 500.0, 150.0, "hand")
    k = 4.51 * 500.0**-0.265  # Soderberg: yield stands in for the unknown tensile strength
    assert float(strength.goodman(without, stress)) == pytest.approx(1 / (100 / (k * 150) + 100 / 500.0))


def test_goodman_line_ends_at_the_tensile_strength_without_alternation_limit():
    sheet = Alloy("test", 70000.0, 0.33, 2700.0, 500.0, 1e12, "hand", 572.0)
    assert float(strength.goodman(sheet, 2 * 572.0)) == pytest.approx(1.0, rel=1e-6)


def test_papers_strains_stand_in_the_ratio_of_the_load_arms():
    """0.2711 % at a = 4 and 0.6316 % at a = 8 under 2 N: 7/3 = 2.333 for L = a - 1, 2.330 as printed."""
    nominal = [float(strain.nominal(REFERENCE.with_(load_arm=a - 1.0), 2.0)) for a in (4.0, 8.0)]
    assert nominal[1] / nominal[0] == pytest.approx(7 / 3)
    assert 0.006316 / 0.002711 == pytest.approx(7 / 3, rel=2e-3)
    assert [printed / own for printed, own in zip((0.002711, 0.006316), nominal)] == pytest.approx(
        [0.972, 0.972], abs=0.03
    )


def test_unknown_alloy_is_refused_with_the_legal_ones():
    with pytest.raises(InputError, match="6061-T6 .*, 2024-T3 .*, 7075-T6 "):
        alloy("adamantium")


def test_every_alloy_says_where_its_figures_are_from():
    for sheet in ALLOYS.values():
        assert sheet.source.startswith(("read: ", "after ", "estimated"))
        assert sheet.fatigue_strength < sheet.yield_strength < sheet.tensile_strength
