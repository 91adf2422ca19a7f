"""What a gauge reads off its hinge's middle: against plane elements, and by hand."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from variants import variant

from tactcad.design.messages import CheckFailure
from tactcad.fem.elements import solve_plane
from tactcad.fem.face_strain import face_strain
from tactcad.fem.shape import reference_shape
from tactcad.mechanics import gauge_signal
from tactcad.mechanics.section import REFERENCE
from tactcad.parts.array.hinge_section import hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.measurements import allowed_places

GRID = 0.5


def sections(changes=None):
    layout = Layout(variant(changes))
    return hinge_section(layout, layout.elements)


@pytest.mark.parametrize(
    "changes", [{}, {"element.hinge_length": 1.5}, {"element.fillet_radius": 0.44}, {"sheet.thickness": 1.5}]
)
@pytest.mark.parametrize("element", [0, 3])
def test_readings_beside_the_middle_are_those_of_elements(changes, element):
    """The strain of plane elements along the flat face, integrated over the moved grid."""
    s = sections(changes).rows(element)
    material = float(s.youngs_modulus), float(s.poisson), float(s.width)
    face = face_strain(solve_plane(reference_shape(s), *material, density=2, order=3), "flat")
    integral = CubicSpline(face.x, face.strain).antiderivative()

    def mean(shift):
        return float(integral(shift + GRID / 2) - integral(shift - GRID / 2))

    for shift in (-0.1, -0.05, 0.05, 0.1):  # x of face_strain runs towards the pad, as shifts do
        own = float(gauge_signal.reading(s, GRID, shift))
        # worst where the notch is one round (0.0065); the fitted profile's own error is largest there
        assert own == pytest.approx(mean(shift) / mean(0.0), abs=0.007)


def test_on_a_leaf_that_is_long_and_thin_only_the_moment_changes():
    """Far from both roots the profile is flat: 1 - x/L."""
    s = sections({"element.hinge_length": 3.0}).rows(3).with_(hinge_thickness=0.05)
    for shift in (-0.2, 0.1, 0.3):
        assert float(gauge_signal.reading(s, 0.2, shift)) == pytest.approx(
            1 - shift / float(s.load_arm), abs=2e-4
        )


def test_the_allowed_place_costs_just_the_share():
    s = sections()
    for share in (0.01, 0.03, 0.1):
        place = gauge_signal.allowed(s, GRID, share)
        assert gauge_signal.error(s, GRID, place) == pytest.approx(np.full(s.shape, share), rel=1e-6)
    assert np.all(np.diff([gauge_signal.allowed(s, GRID, q) for q in (0.01, 0.03, 0.1)], axis=0) > 0)


def test_a_grid_in_a_slot_may_not_climb_its_fillets():
    s = REFERENCE  # two-sided, l 0.75, r 0.15: flat and one fillet are 0.6 long
    assert float(gauge_signal.allowed(s, 0.5, 0.5)) == pytest.approx(0.05)
    with pytest.raises(CheckFailure, match="longer than the flat part"):
        gauge_signal.allowed(s, 0.7, 0.5)


def test_the_tenth_of_a_millimetre_that_was_asked_for_cost_six_percent_of_the_shortest_arm():
    s = sections()
    worst = gauge_signal.error(s, GRID, 0.1)
    assert worst.max() == pytest.approx(0.061, abs=0.001)
    layout = Layout(variant())
    assert allowed_places(layout).min() == pytest.approx(0.061, abs=0.001)
