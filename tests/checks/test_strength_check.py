"""The overload stop's check sees the hinge that passes its rated deflection, and passes what ships."""

from __future__ import annotations

import numpy as np
import pytest
from variants import FACING_ROWS, variant

from tactcad.checks.facing_rows.overload_stop import check_fatigue, check_strength
from tactcad.design.materials import ALLOYS
from tactcad.lab.array_estimate import estimate
from tactcad.mechanics import ladder
from tactcad.paper import published
from tactcad.parts.array.hinge_section import hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.stop_gap import land_room, overloads, seat, stop_gap
from tactcad.parts.rules import broken_rules, load


@pytest.mark.parametrize("name", FACING_ROWS)
def test_what_ships_holds(name):
    assert [f for f in check_strength(load(name)) if f.severity == "fail"] == []


@pytest.mark.parametrize("name", FACING_ROWS)
@pytest.mark.parametrize("friction", [0.05, 0.3, 0.6])
def test_a_gap_that_was_derived_holds_with_friction_and_without_whatever_friction_there_is(name, friction):
    """K L/(L - mu H): an arm that rubs is stiffer, its rated deflection smaller, and so is its gap. What the
    design is rated for must hold on a slippery object too, at the gap that was cut."""
    rough = variant({"rating.friction": friction}, name)
    assert {b.part for b in broken_rules(rough)} <= {"calibration.travel"}  # another matter: it yields sooner
    assert [f for f in check_strength(rough) if f.severity == "fail"] == []
    layout = Layout(rough)
    cut = {f"{p.arm:g}": stop_gap(layout, p) for p in layout.elements}
    slippery = variant({"rating.friction": 0.0, "stop.gaps": cut}, name)
    assert [f for f in check_strength(slippery) if f.severity == "fail"] == []
    smooth = Layout(load(name))
    assert all(cut[f"{p.arm:g}"] <= stop_gap(smooth, p) for p in smooth.elements)


@pytest.mark.by_day(3, "a design each")
@pytest.mark.parametrize("name", FACING_ROWS)
def test_a_stop_one_step_wider_passes_the_rated_deflection(name):
    """Gaps are no narrower than they must be, and the check and the rule see the next wider one, at every
    arm but those whose gap ends where no land would be left."""
    layout = Layout(load(name))
    states = [
        s for s in overloads(layout) if stop_gap(layout, s.place) + 0.005 <= land_room(layout, s.place.hinge)
    ]
    assert states
    for state in states:
        arm, gap = f"{state.place.arm:g}", state.gap - layout.design.stop.tolerance - seat(layout)
        wider = variant({"stop.gaps": {arm: round(gap + 0.005, 6)}}, name)
        failed = {f.part for f in check_strength(wider) if f.severity == "fail"}
        assert failed == {p.designator for p in layout.elements if p.arm == state.place.arm}
        assert {b.part for b in broken_rules(wider)} == {f"stop.gaps.{arm}"}
        assert broken_rules(variant({"stop.gaps": {arm: round(gap, 6)}}, name)) == []


def test_a_gap_that_closes_too_late_is_seen_at_its_element():
    findings = check_strength(variant({"stop.gaps": {"4": 0.2}}))
    failed = [f for f in findings if f.severity == "fail"]
    assert {f.part for f in failed} == {"E1", "E8"}
    assert all(f.check == "overload" and f.value > f.limit for f in failed)
    assert failed[0].place[0] == 5.0  # pads begin 1 mm from the middle, and the arm is 4 mm long


def test_a_stop_that_closes_below_the_rated_force_is_flagged_at_its_elements():
    """Of what ships the soft element of tissue-array alone; in series K d of the widest gap is what the pad
    bears, less the arm's own bending beyond the load line."""
    early = {
        (name, f.part)
        for name in FACING_ROWS
        for f in check_strength(load(name))
        if f.check == "stop-below-rated"
    }
    assert early == {("tissue-array", "E8")}
    design = variant({"stop.gaps": {"8": 0.03}})
    found = [f for f in check_strength(design) if f.check == "stop-below-rated"]
    assert {f.part for f in found} == {"E4", "E6"} and {f.severity for f in found} == {"flag"}
    K = float(ladder.stiffness(hinge_section(Layout(design), Layout(design).elements))[3])
    gap = 0.03 + design.stop.tolerance + seat(Layout(design))
    for f in found:
        assert f.value == pytest.approx(K * gap * 7 / 8, rel=0.06) and f.value < f.limit
        assert f.limit == pytest.approx(1.207, rel=1e-3)


def test_the_rated_deflection_is_that_at_yield_over_its_factor():
    """Force and deflection at yield as `tactcad estimate` gives them."""
    from tactcad.lab.array_estimate import estimate

    design = variant({"rating.deflection_factor": 1.3})
    for state, row in zip(overloads(Layout(design)), estimate(Layout(design), "solid")):
        assert state.rated_deflection == pytest.approx(row.yield_deflection / 1.3)
        assert state.stress * state.yield_factor == pytest.approx(505)


def test_the_paper_s_grasps_stay_clear_of_the_stop_and_within_the_rated_force():
    """13.04 N on all pads, each in series with its share of a rubber sample of Table 2: d_i = D K_s/(K_s +
    K_i). A pad may stand 10 um proud of all others. No stop may close, at its gap's lower limit, and no rated
    force be passed."""
    design = load("macro-array")
    layout = Layout(design)
    states = overloads(layout)
    K = ladder.stiffness(hinge_section(layout, layout.elements))
    samples = np.unique(published.load().table2.object_stiffness.value)
    assert len(samples) == 8
    for sample in samples:
        pair = 1.0 / (1.0 / K + 1.0 / sample)
        even = design.rating.overload_force * pair / pair.sum()
        proud = even + pair * design.tolerance.pad_height * (1.0 - pair / pair.sum())
        assert all(f < s.earliest for f, s in zip(proud, states)), sample
        assert all(f < s.rated_force for f, s in zip(even, states)), sample


def test_a_stiff_stop_counts_though_its_gap_does_not_close_the_hinge():
    """With a force that the hinge bears without its stop, the stress is the free hinge's."""
    design = variant({"rating.overload_force": 1.0, "rating.force": 1.0})
    for state in overloads(Layout(design)):
        assert state.closing_force == 1.0 and state.stop_force == 0.0
    # twice the force on a stop that does not close: twice the stress
    half = overloads(Layout(variant({"rating.overload_force": 0.5, "rating.force": 0.5})))
    for one, other in zip(overloads(Layout(design)), half):
        assert one.stress == pytest.approx(2 * other.stress)


def test_moments_about_the_hinge_balance():
    """The load about the hinge is held by the hinge's moment K L d and by the stop at the arm's end. Short
    arms' bodies tilt back: that help is not counted, so their hinges are said to bear a little more.
    """
    layout = Layout(load("macro-array"))
    K = ladder.stiffness(hinge_section(layout, layout.elements))
    for k, state in zip(K, overloads(layout)):
        p = state.place
        moment = layout.design.rating.overload_force * p.load_arm
        held = k * p.load_arm * state.deflection + state.stop_force * p.arm
        assert held == pytest.approx(moment, rel=1e-9) if p.arm > 6 else 1.0 < held / moment < 1.003


def test_a_rating_beyond_yield_is_flagged_with_what_it_bears():
    flags = {f.part: f for f in check_strength(load("macro-array")) if f.check == "rated-force"}
    assert set(flags) == {"E2", "E3", "E4", "E5", "E6", "E10"}  # arms of 6 mm and more
    assert all(f.severity == "flag" and f.value < 2.0 for f in flags.values())
    eased = check_strength(variant({"rating.force": 1.0}))
    assert [f for f in eased if f.check == "rated-force"] == []


def test_the_gap_follows_the_overload_force():
    """The gap is made for it: a larger force gets a narrower gap, and no hinge passes its rated
    deflection."""
    gaps = [
        overloads(Layout(variant({"rating.overload_force": force})))[0].gap for force in (2.0, 13.0, 40.0)
    ]
    assert gaps[0] > gaps[1] > gaps[2]
    for force in (5.0, 20.0, 40.0):
        design = variant({"rating.overload_force": force})
        assert [f for f in check_strength(design) if f.severity == "fail"] == []


def test_a_force_that_no_gap_can_save_the_hinge_from_is_refused_with_the_one_that_it_can():
    thick = {"clamp.stop_plate_thickness": 7.0}
    (found,) = broken_rules(variant({**thick, "rating.overload_force": 200.0}))
    assert found.part == "rating.overload_force"
    most = float(found.limit.split()[2])
    assert broken_rules(variant({**thick, "rating.overload_force": 0.99 * most})) == []
    assert most > 0.8 * 200  # and it is near what it cannot


def test_out_of_the_estimator_s_range_is_said():
    design = variant(
        {
            "element.hinge_length": 3.0,
            "element.hinge_thickness": 0.02,
            "stop.gaps": {"4": 0.1, "5": 0.1, "6": 0.1, "7": 0.1, "8": 0.1},
        }
    )
    findings = check_strength(design)
    assert {f.severity for f in findings} == {"flag"} and "cannot tell" in findings[0].message


@pytest.mark.parametrize("name", ["macro-array", "soft-tissue"])
def test_the_force_that_is_endured_has_goodman_s_factor_one(name):
    """By the estimate's own stress at that force, and Goodman's line as on paper."""
    design = load(name)
    layout, row = Layout(design), ALLOYS[design.material.alloy]
    for state in overloads(layout):
        (one,) = estimate(layout, "solid", state.endured, numbers=(state.place.number,))
        half, surface = one.stress / 2, min(1.0, 4.51 * row.tensile_strength**-0.265)
        fatigue = design.material.fatigue_strength * surface
        assert half / fatigue + half / row.tensile_strength == pytest.approx(1.0)
        assert state.measurable <= state.rated_force


def test_a_finite_life_is_flagged_and_gone_at_a_force_that_is_endured():
    (flag,) = check_fatigue(variant())
    assert "5e8 cycles are borne up to" in flag.message and flag.severity == "flag"
    least = min(state.endured for state in overloads(Layout(variant())))
    assert not [*check_fatigue(variant({"rating.force": 0.99 * least}))]
    assert [*check_fatigue(variant({"rating.force": 1.01 * least}))]
