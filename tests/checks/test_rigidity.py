"""What is taken as rigid: the table's loads and lines by hand, what fails where something is thin, and
docs/rigs.md."""

from __future__ import annotations

import re
from dataclasses import replace
from math import isclose, pi
from operator import attrgetter
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_designs import raw_table
from variants import FACING_ROWS, variant

from tactcad.checks.check_report import Report, as_record
from tactcad.checks.described.goes_together import check_rigidity, deflections
from tactcad.design.load import from_table
from tactcad.design.messages import InputError
from tactcad.design.tree import Design
from tactcad.parts.array import seating
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.seating import carrier_beam, carrier_opens
from tactcad.parts.bought.screws import seating_force
from tactcad.parts.rigs.stiffness import calibration_loads
from tactcad.parts.rules import broken_rules, load
from tactcad.parts.rules.rule import remedy
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.rig import all_rigs

DOCUMENT = Path(__file__).parents[2] / "docs" / "rigs.md"
RIGS = ("array", "calibration", "sample-stiffness", "grasping", "bonding")
LONG = {"array.row_arms": [[4, 7, 6, 8, 6] * 10, [8, 5, 4, 5, 7] * 10]}


def found(changes, scenes=RIGS):
    return {(f.part, f.severity) for f in check_rigidity(variant(changes), scenes, [])}


@pytest.mark.parametrize("name", FACING_ROWS)
def test_nothing_that_ships_bends_more_than_it_may(name):
    design, table = load(name), []
    assert check_rigidity(design, scene_names(design), table) == []
    assert {line.scene for line in table} == {*scene_names(design)} - {"setting", "wiring"}
    record = as_record(Report(name, "A", [], table))
    assert [line["part"] for line in record["deflections"]] == [line.part for line in table]


@pytest.mark.parametrize(
    "changes, wrong",
    [
        ({"holder.lid_thickness": 2.0}, {("holder's lid", "fail")}),
        ({"cart.thickness": 3.0}, {("cart plate", "fail")}),
        ({"clamp.end_plate_thickness": 2.0, "tolerance.pad_height": 0.002}, {("end plate", "flag")}),
        ({"grasping.weights": 40}, {("bar", "fail"), ("base plate", "fail")}),
        ({"calibration.step": 0.01}, {("post", "fail")}),
        (
            {"calibration.load_cell_range": 50.0, "calibration.travel": 0.6},
            {("base plate", "fail"), ("post", "fail")},
        ),
        ({"clamp.stop_plate_thickness": 0.5}, {("stop plate", "fail")}),
        (LONG, {("stack of elements", "flag"), ("carrier", "flag")}),
    ],
)
def test_what_is_thin_or_loaded_is_found(changes, wrong):
    scenes = ("array",) if changes is LONG else RIGS
    assert wrong <= found(changes, scenes)
    assert not {part for part, _ in wrong} & {part for part, _ in found({})}


@pytest.mark.parametrize(
    "changes, scene, path, words",
    [
        ({"tolerance.pad_height": 0.001}, "array", "clamp.end_plate_thickness", "at least"),
        (LONG, "array", "clamp.carrier_thickness", "at least"),
        ({"calibration.step": 0.01}, "calibration", "calibration.step", "at least"),
        ({"cart.thickness": 3.0}, "grasping", "cart.thickness", "at least"),
        ({"grasping.weights": 40}, "grasping", "grasping.weights", "at most"),
        ({"tolerance.tilt": 0.0}, "grasping", "tolerance.tilt", "at least"),
    ],
)
def test_what_is_said_to_help_helps_and_less_does_not(changes, scene, path, words):
    line = next(s for s in deflections(variant(changes), [scene]) if s.too_much)
    named, value, legal = remedy(variant(changes), line, all_rigs(Design)[scene].deflections)
    assert (named, value) == (path, attrgetter(path)(variant(changes)))
    said = re.fullmatch(rf"{words} ([\d.]+)( mm| degree)?", legal)
    enough = type(value)(said[1])
    less = enough + 1 if isinstance(value, int) else enough * 0.998
    for tried, bends in ((enough, False), (less, True)):
        assert line_of(scene, line.part, line.model, {**changes, path: tried}).too_much is bends


def test_what_no_field_helps_says_so():
    line = next(s for s in deflections(load("macro-array"), ["array"]) if s.part == "end plate")
    stuck = replace(line, fields=("clamp.carrier_margin",), gives=line.allowed * 2)
    assert remedy(variant({"tolerance.pad_height": 0.0001}), stuck, all_rigs(Design)["array"].deflections)[
        2
    ].startswith("no value alone")


@pytest.mark.slow  # rigidity of a whole scene again and again
def test_what_helps_is_looked_for_where_no_stop_would_help_too():
    """A row of 500: the whole range of the overload force is tried, up to where no gap protects the hinge."""
    design = variant({"array.row_arms": [[4] * 500] * 2})
    said = [
        remedy(design, line, all_rigs(Design)["array"].deflections)
        for line in deflections(design, ["array"])
        if line.too_much
    ]
    assert said and all(
        path.split(".")[0] in ("clamp", "rating", "element", "tolerance") for path, _, _ in said
    )


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(0, 2**48))
def test_what_the_rules_accept_passes_the_check(number):
    """Designs over the whole legal range, sound ones and others: what the rules take, with the scenes that
    they leave it."""
    try:
        design = from_table(raw_table(number, (1, 2, 3, 8), rigs=0.7))
    except InputError:
        return
    if not broken_rules(design):
        assert [f for f in check_rigidity(design, scene_names(design), []) if f.severity == "fail"] == []


def test_every_part_that_is_taken_as_rigid_stands_in_the_table():
    parts = {line.part for line in deflections(load("macro-array"), RIGS)}
    named = "stop plate, carrier, end plate, stack of elements, base plate, post, gauge plate, axis plate, "
    named += "array mount, roller, all of these, cart plate, cart's axles, holder's lid, bar, foot, "
    named += "platform, weight pin, tongue of the nest"
    assert parts == set(named.split(", "))


def line_of(scene, part, model="", changes=None):
    lines = deflections(variant(changes), RIGS)
    return next(s for s in lines if (s.scene, s.part) == (scene, part) and model in s.model)


def test_loads_are_what_the_design_says():
    assert line_of("grasping", "bar").load == pytest.approx(3.235 + 10 * 0.980665)
    assert line_of("calibration", "post").load == 5.0
    soft = {"calibration.load_cell_stiffness": 10.0}
    assert line_of("calibration", "post", changes=soft).load == pytest.approx(1.5)
    assert line_of("sample-stiffness", "post").load == pytest.approx(3.85 * 0.3)
    vacuum = line_of("grasping", "holder's lid", "evenly")
    assert vacuum.load > 0.1 * pi * 13.0**2
    assert line_of("array", "end plate").load == 13.04


@pytest.mark.parametrize(
    "scene, part, by_hand",
    [
        # the bar, 23 x 8, held 30 mm over its foot: 13.04 N at 20 mm turn it; over 16 mm of a row
        ("grasping", "bar", 13.04 * 20 * 30 / (69e3 * 23 * 8**3 / 12) * 16e3),
        # the platform, 46 x 8: 13.04 N at 20 mm
        ("grasping", "platform", 13.04 * 20**2 / (2 * 69e3 * 46 * 8**3 / 12) * 16e3),
        # the pin, 8 round, 80 high under one disc's weight
        ("grasping", "weight pin", 0.980665 * 80**3 / (3 * 69e3 * pi / 64 * 8**4) * 1e3),
        # cart plate 50 x 10 on axles 50 mm apart
        ("grasping", "cart plate", 13.04 * 50**3 / (48 * 69e3 * 50 * 10**3 / 12) * 1e3),
        # base plate under the 60 mm of the post: 5 N at 68 mm
        ("calibration", "base plate", 5 * 68**3 / (3 * 69e3 * 60 * 12**3 / 12) * 1e3),
    ],
)
def test_lines_are_their_formulas_by_hand(scene, part, by_hand):
    """Without shear, which takes 15 % at most of these."""
    gives = line_of(scene, part).gives
    assert by_hand * 0.999 <= gives <= 1.15 * by_hand


def test_twice_as_thick_is_an_eighth():
    """Of bending; shear, in which a cart plate of 20 mm gives way by a third as much as by bending, is a
    half."""
    for scene, part, model, field in (
        ("grasping", "cart plate", "", "cart.thickness"),
        ("grasping", "holder's lid", "evenly", "holder.lid_thickness"),
    ):
        thick = load("macro-array").cart.thickness if "cart" in field else 6.0
        ratio = line_of(scene, part, model).gives / line_of(scene, part, model, {field: 2 * thick}).gives
        assert 5.9 < ratio < 8.001


@pytest.mark.parametrize("thickness", [3.0, 6.0, 20.0])
@pytest.mark.parametrize("rows", [1, 10])
def test_a_carrier_held_in_its_middle_opens_no_gap(thickness, rows):
    """By integration of the bent and sheared carrier, ledges straight between its two ends; at most 0.01 um
    at 13.04 N."""
    arms = [[4, 7, 6, 8, 6] * rows, [8, 5, 4, 5, 7] * rows]
    layout = Layout(variant({"array.row_arms": arms, "clamp.carrier_thickness": thickness}))
    h = layout.end_plate_y
    beam = carrier_beam(layout, h)
    x = layout.pad_inner + layout.design.stop.land_length
    for p in layout.elements[:: 1 + 4 * (rows > 1)]:
        at = np.linspace(0, h, 4001)
        moment = np.maximum(abs(p.y) - at, 0)
        step = at[1] - at[0]
        integral = lambda v: np.concatenate([[0], np.cumsum((v[1:] + v[:-1]) / 2 * step)])  # noqa: B023, E731
        raised = integral(
            integral(moment / beam.bending) + (at < abs(p.y)) * (1 / beam.shear + x * x / beam.torsion)
        )
        ledges = (1 + abs(p.y) / h) / 2 * raised[-1]
        opening = np.interp(abs(p.y), at, raised) - ledges
        assert isclose(carrier_opens(layout, p.y), opening, rel_tol=0.01, abs_tol=2e-9)
        assert 13.04e3 * carrier_opens(layout, p.y) < 0.01


def test_the_set_screws_seating_force_is_that_of_their_lead_and_friction():
    """0.2 N m on M3: work of a turn is lift times force and friction times way, on the flanks and on the
    point."""
    force = seating_force("M3")
    flank, point = 2.675 * pi * 0.12 / np.cos(np.pi / 6), 2 / 3 * 2.0 * pi * 0.12
    assert force * (0.5 + flank + point) == pytest.approx(2 * pi * 200, rel=1e-3)
    assert force == pytest.approx(579, rel=0.01)


@pytest.mark.parametrize(
    "rows, thickness, torque", [(1, 6.0, 0.2), (2, 6.0, 0.1), (1, 3.0, 0.05), (10, 6.0, 0.0)]
)
def test_set_screws_bow_neither_stack_nor_carrier(rows, thickness, torque):
    arms = [[4, 7, 6, 8, 6] * rows, [8, 5, 4, 5, 7] * rows]
    design = variant({"array.row_arms": arms, "clamp.carrier_thickness": thickness})
    assert seating.torque(Layout(design)) == torque
    pressed = [s for s in deflections(design, ["array"]) if "pressed" in s.model]
    assert len(pressed) == 2
    for line in pressed:
        assert line.gives <= line.allowed
        assert line.load == pytest.approx(
            torque / 0.2 * seating_force("M3") * 2 * len(Layout(design).hold_down_y)
        )


def test_what_stands_in_series_with_the_gauge_adds_up_and_is_told_in_guide_and_document():
    """By hand: base plate, post, gauge and axis plate, roller, mount and carrier, um/N of the table's lines
    at 5 N; the stiffest arm's own compliance is that of the estimator."""
    design = load("macro-array")
    lines = [s for s in deflections(design, ["calibration"]) if s.part != "all of these"]
    together = line_of("calibration", "all of these")
    assert len(lines) == 7 and together.gives == pytest.approx(sum(s.gives for s in lines))
    assert together.allowed == pytest.approx(0.1 * 5.0 / 57.04 * 1e3)
    K = min(design.array.row_arms[0] + design.array.row_arms[1])
    stiff = max(e.force / e.deflection for e in calibration_loads(design))
    c = together.gives / 5.0
    softer = 100 * (1 - 1 / (1 + c * stiff / 1e3))
    assert 0.6 < c < 0.75 and 2.0 < softer < 3.0
    guide = " ".join(step.text for step in make_scene(design, "calibration").steps)
    assert f"{c:.2g} um/N in series" in guide and f"arm of {K:g} mm would seem {softer:.2g} % softer" in guide
    document = " ".join(DOCUMENT.read_text("utf-8").split())
    assert f"together {c:.2g} um/N" in document and f"seems {softer:.2g} % softer" in document


def rows_of(design) -> list[str]:
    """Those that give way by a tenth of what is allowed, or more."""
    return [
        f"| {s.scene} | {s.part} | {s.model} | {s.load:.3g} | {s.gives:.2g} | {s.allowed:.3g} |"
        for s in deflections(design, RIGS)
        if s.gives >= s.allowed / 10
    ]


def test_the_document_has_the_table():
    """Where this fails, put the lines that it prints there."""
    text = re.search(
        r"<!-- deflections: .*?-->\n\|.*?\n\|.*?\n(.*?)<!-- end -->", DOCUMENT.read_text("utf-8"), re.DOTALL
    )
    rows = rows_of(load("macro-array"))
    print("\n".join(rows))
    assert text and text[1].splitlines() == rows
