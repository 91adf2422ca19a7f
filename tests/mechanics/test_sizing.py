"""Sizing is the estimate turned round."""

from __future__ import annotations

import numpy as np
import pytest

from tactcad.design.messages import CheckFailure
from tactcad.mechanics import ladder
from tactcad.mechanics.ladder import size
from tactcad.mechanics.section import REFERENCE


@pytest.mark.parametrize("rung", ladder.CLOSED_FORMS)
@pytest.mark.parametrize("parameter", ["hinge_thickness", "hinge_length"])
@pytest.mark.parametrize("two", [True, False])
def test_found_hinge_has_the_stiffness(rung, parameter, two):
    s = REFERENCE.with_(two_sided=two)
    wanted = 1.3 * float(ladder.stiffness(s, rung))
    found = size(s, wanted, parameter, rung)
    assert float(ladder.stiffness(s.with_(**{parameter: found}), rung)) == pytest.approx(wanted, rel=1e-12)


def test_known_design_is_found_again():
    assert size(REFERENCE, float(ladder.stiffness(REFERENCE)), "hinge_thickness") == pytest.approx(
        0.25, rel=1e-12
    )


@pytest.mark.parametrize("wanted", [1e-9, 1e9])
def test_stiffness_out_of_reach_names_what_can_be_had(wanted):
    with pytest.raises(CheckFailure, match="out of reach.*stiffness goes from"):
        size(REFERENCE, wanted, "hinge_thickness")


def test_impossible_element_is_refused_whatever_the_hinge():
    with pytest.raises(CheckFailure, match="poisson"):
        size(REFERENCE.with_(poisson=0.6), 5.0, "hinge_thickness")


def test_stiffness_is_monotone_over_the_searched_range():
    for two in (True, False):
        s = REFERENCE.with_(two_sided=two)
        for parameter, sign in (("hinge_thickness", 1), ("hinge_length", -1)):
            result = ladder.evaluate(s.with_(**{parameter: np.geomspace(0.01, 5.0, 2001)}))
            assert np.all(sign * np.diff(result.stiffness[result.valid]) > 0)
