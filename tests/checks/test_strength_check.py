"""Strength checks see the part that yields, and pass what ships."""

from __future__ import annotations

import pytest
from variants import variant

from tactcad.checks.strength import check_strength
from tactcad.design.load import names
from tactcad.parts.designs import load
from tactcad.parts.layout import Layout
from tactcad.parts.overload import overloads


@pytest.mark.parametrize("name", names())
def test_what_ships_holds(name):
    assert [f for f in check_strength(load(name)) if f.severity == "fail"] == []


def test_a_gap_that_closes_too_late_is_seen_at_its_element():
    findings = check_strength(variant({"stop.gaps": {"4": 0.2}}))
    failed = [f for f in findings if f.severity == "fail"]
    assert [f.part.split()[0] for f in failed] == ["E1", "E8"]
    assert all(f.check == "overload" and f.value > f.limit == 505 for f in failed)
    assert failed[0].place[0] == 5.0  # pads begin 1 mm from the middle, and the arm is 4 mm long


def test_a_stiff_stop_counts_though_its_gap_does_not_close_the_hinge():
    """With a force that the hinge bears without its stop, the stress is the free hinge's."""
    design = variant({"rating.overload_force": 1.0, "rating.force": 1.0})
    for state in overloads(Layout(design)):
        assert state.closing_force == 1.0
    # twice the force on a stop that does not close: twice the stress
    half = overloads(Layout(variant({"rating.overload_force": 0.5, "rating.force": 0.5})))
    for one, other in zip(overloads(Layout(design)), half):
        assert one.stress == pytest.approx(2 * other.stress)


def test_a_rating_beyond_yield_is_flagged_with_what_it_bears():
    flags = {f.part.split()[0]: f for f in check_strength(load("macro-array")) if f.check == "rated-force"}
    assert set(flags) == {"E2", "E3", "E4", "E5", "E6", "E10"}  # arms of 6 mm and more
    assert all(f.severity == "flag" and f.value < 2.0 for f in flags.values())
    eased = check_strength(variant({"rating.force": 1.0}))
    assert [f for f in eased if f.check == "rated-force"] == []


def test_the_gap_follows_the_overload_force():
    """The gap is made for it: a larger force gets a narrower gap, and the fillet stays below yield."""
    gaps = [overloads(Layout(variant({"rating.overload_force": force})))[0].gap for force in (2.0, 13.0, 40.0)]
    assert gaps[0] > gaps[1] > gaps[2]
    for force in (5.0, 20.0, 40.0):
        design = variant({"rating.overload_force": force})
        assert [f for f in check_strength(design) if f.severity == "fail"] == []


def test_a_force_that_no_gap_can_save_the_hinge_from_is_seen():
    failed = [f for f in check_strength(variant({"rating.overload_force": 500.0})) if f.severity == "fail"]
    assert {"E1", "E8"} <= {f.part.split()[0] for f in failed}  # the shortest arms


def test_out_of_the_estimator_s_range_is_said():
    design = variant({"element.hinge_length": 3.0, "element.hinge_thickness": 0.02, "stop.gaps": {"4": 0.1, "5": 0.1, "6": 0.1, "7": 0.1, "8": 0.1}})
    findings = check_strength(design)
    assert {f.severity for f in findings} == {"flag"} and "cannot tell" in findings[0].message
