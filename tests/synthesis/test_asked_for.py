"""What a target asks for is what the design has: steps, pitch, kinds' forces, tolerances; and no more is said
than is so."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest
from small_target import SMALL
from variants import variant

from tactcad.checks.facing_rows.circuit import check_signals
from tactcad.circuit.element_signals import element_signals
from tactcad.design.design_text import design_text
from tactcad.design.load import parse
from tactcad.design.messages import InputError
from tactcad.mechanics.ladder import stiffness
from tactcad.parts.array.converter_figures import bridge_supply
from tactcad.parts.array.hinge_section import hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.parts.language.finding import Finding
from tactcad.parts.rules import broken_rules
from tactcad.synthesis.candidates import realised, stands
from tactcad.synthesis.search import refusals, search
from tactcad.synthesis.synthesise import Synthesis, attempt
from tactcad.synthesis.target import Target, parse_target
from tactcad.synthesis.target_report import answer, record


def small(*changes: tuple[str, str]) -> Target:
    text = SMALL
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return parse_target(text, "t")


def quick(target: Target, within: float = 0.2) -> Synthesis:
    return attempt(target, arrays=100, within=within)


def test_largest_forces_are_those_of_the_element_not_of_its_arm():
    """Springs between one approach and one object: K x/(K + x) over the sum of it, the most on the range."""
    got = quick(small(("arms = [5, 7]", "arms = [6, 6]")))
    layout = Layout(got.found.design)
    K = stiffness(hinge_section(layout, layout.elements))
    assert np.ptp(K) > 1.0  # both kinds have arms of 6 mm
    x = np.array([[3.0], [4.0], [6.0]])
    rate = K * x / (K + x)
    largest = (6.0 * rate / rate.sum(axis=1, keepdims=True)).max(axis=0)
    told = [e["largest_force"] for e in record(got)["elements"]]
    assert told == pytest.approx(largest.tolist(), rel=1e-3)


def test_rows_are_as_far_apart_as_pads_along_them():
    pitch = 8.0
    got = quick(small(("pitch = 4", "pitch = 8")))
    array = got.found.design.array
    assert array.row_pitch >= pitch and array.pitch >= pitch
    made = parse(design_text(got.design), "written")
    assert got.found.accepted and made.array == array and not broken_rules(made)


def test_a_pitch_that_no_design_file_can_say_is_refused_at_reading():
    with pytest.raises(InputError, match=r"room.pitch: .*spacers of 47 mm.*at most 33 mm"):
        small(("pitch = 4", "pitch = 50"))


@pytest.mark.slow  # a search
def test_a_design_that_its_own_reader_refuses_is_never_accepted():
    target = small()
    (stand,) = stands(target)
    wide = replace(stand, base=replace(stand.base, array=replace(stand.base.array, pitch=50.0, spacer=47.0)))
    assert list(refusals(wide.base)) == ["array.spacer"]
    best = quick(target, 0.5).found.row
    wide.__dict__["limits"] = (best, best + 1.0)
    got = search(wide, lambda c: c.half_width, within=0.05)
    assert not got.accepted and "array.spacer" in got.refused


def test_the_force_resolution_that_the_base_design_wishes_for_limits_the_search():
    def with_wish(wish: float | None) -> Synthesis:
        readout = replace(target.base.readout, force_resolution=wish)
        return quick(replace(target, base=replace(target.base, readout=readout)), 0.5)

    def told(got: Synthesis) -> float:
        return max(1e3 * signal.resolution for signal in element_signals(Layout(got.design)))

    target = small()
    finer = 0.9 * told(with_wish(None))
    got = with_wish(finer)
    assert got.met and told(got) <= finer and not list(check_signals(got.design))
    r = record(with_wish(1e-3))
    assert r["met"] is False and "misses readout.force_resolution" in answer(r)


@pytest.mark.slow  # searches on for every design that fails
def test_a_best_design_that_fails_a_slow_check_is_left_for_one_that_passes(monkeypatch):
    elements_of = lambda design: sum(map(len, design.array.row_arms))  # noqa: E731
    too_many = lambda design: [Finding("assembly", "fail", "", (), 0, 1, "")] * (elements_of(design) > 4)  # noqa: E731
    assert elements_of(quick(small(), 0.5).design) > 4
    monkeypatch.setattr("tactcad.synthesis.search.slow_failures", too_many)
    got = quick(small(), 0.5)
    assert got.met and elements_of(got.design) == 4 and "check assembly" in got.found.refused


def test_a_base_with_overrides_leaves_none_of_their_origins():
    target = small(('name = "small"', 'name = "small"\nbase = "better-array"'))
    (stand,) = stands(target)
    base = replace(
        stand.base, origin={**stand.base.origin, "element.override.9.hinge_thickness": "chosen: x"}
    )
    low, high = stand.limits
    made = realised(replace(stand, base=base).candidates(((low + high) / 2.0)[np.newaxis]))
    assert parse(design_text(made), "d") == made


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("arms = [5, 7]", "arms = [6.02, 6.08]", r"elements.arms: .*0.1 mm.*holds 6 or 6.1 mm"),
        ("hinges = [0.25, 0.4]", "hinges = [0.251, 0.254]", r"elements.hinges: .*0.005 mm.*0.25 or 0.255 mm"),
        ("elements = [4, 6]", "elements = [4.5, 6]", r"room.elements\[0\]: not a whole number"),
    ],
)
def test_a_range_between_two_steps_is_refused(old, new, says):
    with pytest.raises(InputError, match=says):
        small((old, new))


def test_ends_of_a_range_that_are_steps_are_used():
    for arm in (5.3, 6.9):
        (stand,) = stands(small(("arms = [5, 7]", f"arms = [{arm}, {arm}]")))
        assert stand.limits[0][0] == stand.limits[1][0] == round(10 * arm)


@pytest.mark.slow  # a search a tolerance
def test_the_loosest_tolerance_that_meets_the_target_is_found_also_where_a_looser_one_nearly_does():
    """At 20 um the design keeps it as drawn, but too few of the arrays made do."""
    least = ('name = "small"', 'name = "small"\nleast = "tolerance"')
    target = small(least, ("[elements]", '[known]\nhow = "drawn"\n[elements]'))
    loose = target.with_("stock.hinge_tolerances", (0.02,))
    wanted = 100.01 * quick(loose, 0.2).found.half_width
    both = target.with_("stock.hinge_tolerances", (0.002, 0.02)).with_("target.half_width", wanted)
    got = quick(both, 0.2)
    assert got.met and got.found.design.tolerance.hinge_thickness == 0.002


def test_an_exact_calibration_leaves_the_noise_of_the_readings():
    target = small()
    for name in ("run_scatter", "force_noise", "displacement_noise", "contact"):
        target = target.with_(f"known.{name}", 0.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        got = quick(target)
    assert got.met and got.found.half_width < got.wanted < 4.0 * got.found.half_width


@pytest.mark.slow  # several searches
def test_the_gauge_is_chosen_where_a_converter_is_to_tell_a_small_force():
    """Within small's room 120 ohm at 1.09 V tell 0.8 mN or more, 350 ohm at 1.84 V six tenths of that."""

    def offered(*gauges: float) -> Synthesis:
        readout = replace(target.base.readout, converter="AD7124-8", force_resolution=0.75)
        asked = replace(target, base=replace(target.base, readout=readout))
        return quick(asked.with_("stock.gauges", gauges), 0.5)

    target = small()
    assert not offered(120.0).met
    got = offered(120.0, 350.0)
    assert got.met and got.design.gauge.resistance == 350.0
    assert max(signal.resolution for signal in element_signals(Layout(got.design))) <= 0.75e-3
    assert got.design.origin["gauge.resistance"] == "chosen: of the target's stock"
    assert not list(check_signals(got.design)) and parse(design_text(got.design), "d") == got.design


def test_duty_is_offered_where_noise_is_what_is_left():
    """Steady temperature and leads: 1.82 V once a period tell less than 1.09 V all the time do."""
    target = small(("[elements]", '[stock]\npowers = ["continuous", "duty"]\n[elements]'))
    base = variant({"readout.converter": "AD7124-8", "readout.temperature_span": 0.05})
    base = replace(base, tolerance=replace(base.tolerance, zero_drift=1e-8))
    one, two = stands(replace(target, base=base))
    told = [bridge_supply(Layout(s.base)) for s in (one, two)]
    assert (one.base.readout.power, two.base.readout.power) == ("continuous", "duty")
    assert two.smallest_output / told[1] < 0.75 * one.smallest_output / told[0] and told[1] > 1.6 * told[0]


@pytest.mark.slow  # several searches
def test_duty_is_chosen_where_it_alone_tells_the_force():
    """With steady temperature and leads 1.09 V tell 0.066 mN in small's room; a duty tells less."""

    def offered(*powers: str) -> Synthesis:
        own = {"converter": "AD7124-8", "temperature_span": 0.05, "force_resolution": 0.06}
        readout = replace(target.base.readout, **own)
        base = replace(
            target.base, readout=readout, tolerance=replace(target.base.tolerance, zero_drift=1e-8)
        )
        return quick(replace(target, base=base).with_("stock.powers", powers), 0.5)

    target = small()
    assert not offered("continuous").met
    got = offered("continuous", "duty")
    assert got.met and got.design.readout.power == "duty" and not list(check_signals(got.design))
    assert got.design.origin["readout.power"] == "chosen: of the target's stock"
    assert parse(design_text(got.design), "d") == got.design
