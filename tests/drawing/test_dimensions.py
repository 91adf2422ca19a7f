"""Dimensions determine the part: none missing, none given twice; what the sheets say is enough to make it.

Two ways, neither of them the program's own account: the rank of the Jacobian over all coordinates, from
singular values; and a reconstruction: coordinates are shaken, then solved for from the texts of the
dimensions and the conventions.
"""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from variants import IN_SLOT, variant

from tactcad.contour import circle, rectangle
from tactcad.design.messages import CheckFailure
from tactcad.drawing.parts.measures import (
    OUTER,
    PLACES,
    THICKNESS,
    Owner,
    Quantity,
    Slope,
    Span,
    Spot,
    level,
    radius_of,
    variables,
)
from tactcad.drawing.parts.part_sheet import MadeFrom, part_plan
from tactcad.drawing.parts.prism import prism_plan
from tactcad.drawing.parts.sheet_plan import Dimension, number
from tactcad.families.facing_rows import FAMILY
from tactcad.parts.language.description import Extrusion, Hole, Material, Part
from tactcad.parts.language.limits import FACES, Characteristic
from tactcad.parts.rules import refuse_broken
from tactcad.scenes import make_scene, scene_names

FILE = MadeFrom("dxf/x.dxf", "0" * 64)
DESIGNS = {
    "as shipped": {},
    "slot from both sides": {**IN_SLOT, "element.sides": "two"},
    "body thicker than the arm": {
        **IN_SLOT,
        "element.sides": "two",
        "element.body_height": 4.0,
        "element.pad_height": 2.5,
    },
    "one row, with blanks": {"array.row_arms": [[4, 7]]},
    "full round": {"element.hinge_length": 0.6, "element.fillet_radius": 0.3, "array.row_arms": [[5], [6]]},
    "another hinge for one element": {
        "array.row_arms": [[4, 7], [8, 5]],
        "element.override": {"2": {"hinge_thickness": 0.3, "hinge_length": 1.0}},
    },
    "odd numbers": {
        "element.hinge_thickness": 0.2345,
        "element.pad_height": 1.987,
        "array.row_arms": [[5.125, 6.375]],
    },
    "long arms": {"array.row_arms": [[40, 20], [6, 8]]},
    "longer than any screw": {"array.row_arms": [[4] * 12, [8] * 12]},
}
LONG = {"array.row_arms": [[4] * 100, [8] * 100]}


def plans(changes, base="macro-array", shortened=False):
    """Of every part made here; of a changed array without its rigs. Or the broken views of those that are
    long enough."""
    design = variant(changes, base)
    refuse_broken(design)
    names = ("array",) if changes else scene_names(design)
    parts = {p.part_no: p for name in names for p in make_scene(design, name).parts}
    made = [p for p in parts.values() if p.process not in ("bought", "reference")]
    return [plan for p in made if (plan := part_plan(p, (FILE,), FAMILY.plans, shortened=shortened))]


def stated(plan):
    """The dimensions that count: those in parentheses follow from others."""
    return [d for d in plan.dimensions if not d.auxiliary]


@pytest.fixture(
    scope="module", params=[*DESIGNS, "long, broken", "soft-tissue", "double-sample", "smallest-bearing"]
)
def some_plans(request):
    name = request.param
    if name == "long, broken":
        broken = plans(LONG, shortened=True)
        assert {p.part.name for p in broken} == {"Carrier", "Stop plate"}
        return broken
    return plans(DESIGNS[name]) if name in DESIGNS else plans({}, name)


def jacobian(plan, rows) -> np.ndarray:
    """Derivatives of the rows by every variable, by differences of fourth order."""
    column = {name: j for j, name in enumerate(plan.values)}
    result = np.zeros((len(rows), len(column)))
    values, h = dict(plan.values), 1e-4
    for i, row in enumerate(rows):
        for name in set(row.names):
            at, f = values[name], []
            for k in (-2, -1, 1, 2):
                values[name] = at + k * h
                f.append(row.of(values))
            values[name] = at
            result[i, column[name]] = (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * h)
    return result


def rank(matrix: np.ndarray) -> int:
    return (
        int(np.linalg.matrix_rank(matrix / np.linalg.norm(matrix, axis=1, keepdims=True), tol=1e-7))
        if len(matrix)
        else 0
    )


@pytest.mark.by_day(5, "every sheet of a design each")
def test_no_dimension_is_missing_and_none_is_given_twice(some_plans):
    for plan in some_plans:
        rows = [row for d in stated(plan) for row in d.rows]
        said, drawn = jacobian(plan, rows), jacobian(plan, plan.conventions)
        whole = rank(np.vstack([drawn, said]))
        # two motions along the paper are free; the directions of level lines hold the turn
        free = (
            2 if any(isinstance(r, Span) for r in plan.conventions) or plan.part.body.outer.as_circle() else 3
        )
        assert whole == len(plan.values) - free, (plan.part.part_no, "missing")
        assert whole == rank(drawn) + len(rows), (plan.part.part_no, "given twice")


def test_conventions_hold_on_the_part_itself(some_plans):
    """What the drawing takes for level, tangent, in line or equal is so in the description."""
    for plan in some_plans:
        for row in plan.conventions:
            if not isinstance(row, Slope):
                assert abs(row.of(plan.values)) < 1e-6, (plan.part.part_no, row)


def told(text: str) -> float:
    """The number that a dimension's text states, the middle of its limits (of 3 mm, H7 is +0.010/0 and D10
    +0.060/+0.020, ISO 286).
    A pressed pin's hole is modelled as the pin, m6 of 3 mm (+0.008/+0.002) or of 5 mm (+0.012/+0.004)."""
    text, envelope = text.removesuffix(" Ⓔ"), text.endswith(" Ⓔ")
    assert not envelope or "⌀" in text
    match = re.fullmatch(
        r"(?:\d+× )?[⌀R↧]?(-?[\d.]+)°?(?: ±[\d.]+)?(?: ([+-][\d.]+)/([+-][\d.]+|0))?( H7| D10| N7)?", text
    )
    assert match, text
    if not match[2]:
        assert not match[4] or match[1] == "3"
        return float(match[1]) + {None: 0.0, " H7": 0.005, " D10": 0.04, " N7": 0.005}[match[4]]
    size, upper, lower = map(float, match.groups()[:3])
    if lower > 0:  # limits off the nominal size, at which the model stands: its sheet says so
        return size
    return size + ((0.005 if size <= 3 else 0.008) if upper < 0 else (upper + lower) / 2)


@pytest.mark.by_day(5, "a third of a second each")
def test_the_part_can_be_made_from_what_its_sheet_says(some_plans):
    """Gauss and Newton from shaken coordinates: texts and conventions lead back to the part, wherever it
    lies."""
    rng = np.random.default_rng(7)
    for plan in some_plans:
        names = list(plan.values)
        rows = [(row, told(d.text(plan.values))) for d in stated(plan) for row in d.rows]
        rows += [(row, row.of(plan.values) if isinstance(row, Slope) else 0.0) for row in plan.conventions]
        values = {n: v + rng.uniform(-0.002, 0.002) for n, v in plan.values.items()}
        for _ in range(5):
            residual = np.array([row.of(values) - wanted for row, wanted in rows])
            matrix = jacobian(replace(plan, values=values), [row for row, _ in rows])
            step = np.linalg.lstsq(matrix, -residual, rcond=1e-9)[0]
            values = {n: values[n] + s for n, s in zip(names, step)}
        assert max(abs(row.of(values) - wanted) for row, wanted in rows) < 2e-3
        shift = {
            a: np.median([values[n] - plan.values[n] for n in names if _axis(n) == a] or [0.0]) for a in "xy"
        }
        off = {n: values[n] - plan.values[n] - shift.get(_axis(n), 0.0) for n in names}
        worst = max(off, key=lambda n: abs(off[n]))
        # numbers are rounded to a micrometre; a corner may carry a few of them
        assert abs(off[worst]) < 5e-3, (plan.part.part_no, worst, off[worst])


def _axis(variable) -> str:
    """ "x" or "y" of what moves with the part, "" of a size."""
    return str(variable.quantity) if variable.quantity in PLACES[:2] else ""


def test_the_rank_sees_a_missing_and_a_repeated_dimension():
    plan = plans({"array.row_arms": [[5], [6]]})[1]
    assert "element" in plan.part.part_no
    rows = [row for d in stated(plan) for row in d.rows]
    drawn = jacobian(plan, plan.conventions)
    full = rank(np.vstack([drawn, jacobian(plan, rows)]))
    for i in range(len(rows)):
        assert rank(np.vstack([drawn, jacobian(plan, rows[:i] + rows[i + 1 :])])) == full - 1
    chain = Span(rows[0].a, rows[0].b)
    assert rank(np.vstack([drawn, jacobian(plan, [*rows, chain])])) == full


def test_values_are_the_descriptions(some_plans):
    """Each text is the measure of the description that it names; equal features are counted."""
    for plan in some_plans:
        for d in stated(plan):
            measured = [row.of(plan.values) for row in d.rows]
            assert told(d.text(plan.values)) == pytest.approx(measured[0], abs=5.1e-4)
            count = re.match(r"(\d+)× ", d.text(plan.values))
            assert not count or int(count[1]) == len(d.rows)


def test_key_characteristics_stand_once_each_with_their_limits(some_plans):
    for plan in some_plans:
        keys = [c for c in plan.part.characteristics if c.key]
        numbered = {d.key: d for d in plan.dimensions if d.key}
        assert sorted(numbered) == list(range(1, len(keys) + 1))
        for n, c in enumerate(keys, start=1):
            d = numbered[n]
            assert d.value(plan.values) == pytest.approx(c.nominal, abs=1e-9)
            assert [d.value(plan.values) + v for v in d.limits] == pytest.approx([c.upper, c.lower], abs=1e-9)


def test_a_changed_part_changes_its_sheet_by_itself():
    thin, thick = (
        next(
            d
            for d in plans({"element.hinge_thickness": t, "array.row_arms": [[5], [6]]})[1].dimensions
            if d.key == 1
        )
        for t in (0.2, 0.3)
    )
    assert thin.name == thick.name == "hinge thickness"
    texts = [
        next(d.text(p.values) for d in p.dimensions if d.key == 1)
        for p in (plans({"element.hinge_thickness": t, "array.row_arms": [[5], [6]]})[1] for t in (0.2, 0.3))
    ]
    assert texts == ["0.2 ±0.005", "0.3 ±0.005"]


def block(*features, characteristics=(), outer=None) -> Part:
    outer = outer or rectangle(0, 0, 40, 30)
    return Part(
        "BLOCK",
        "Block",
        "milled",
        Material("6061-T6", 2700),
        Extrusion(outer, 10.0),
        features,
        characteristics=characteristics,
    )


def test_a_characteristic_without_a_dimension_is_refused():
    odd = Characteristic("length of nothing", 3.0, 3.1, 2.9, key=True, between=FACES)
    with pytest.raises(CheckFailure, match="length of nothing"):
        prism_plan(block(characteristics=(odd,)), ())


def test_a_plain_block_needs_three_dimensions():
    plan = prism_plan(block(), ())
    assert sorted(d.text(plan.values) for d in plan.dimensions) == ["10", "30", "40"]


def test_holes_of_one_row_share_their_extension_line():
    holes = [Hole("row", (x, 8.0, 10.0), (0, 0, -1), 3.0, 10.0, True) for x in (5.0, 15.0, 25.0)]
    plan = prism_plan(block(*holes), ())
    texts = [d.text(plan.values) for d in plan.dimensions]
    assert texts.count("8") == 1 and "3× ⌀3" in texts


def test_features_shown_as_equal_have_to_be_equal():
    part = block(
        *(Hole("h", (x, 8.0, 10.0), (0, 0, -1), d, 10.0, True) for x, d in ((5.0, 3.0), (15.0, 3.1)))
    )
    values = variables(part)
    wrong = Dimension(
        "both", tuple(Span(level(THICKNESS), level(Owner("hole", k).size(Quantity.DIAMETER))) for k in (0, 1))
    )
    with pytest.raises(ValueError, match="shown as equal"):
        wrong.text(values)


def test_a_disc_has_its_diameters_and_its_thickness():
    ring = Part(
        "RING",
        "Ring",
        "turned",
        Material("steel", 7850),
        Extrusion(circle((0, 0), 20), 3.0, (circle((0, 0), 8.2),)),
    )
    plan = prism_plan(ring, ())
    assert sorted(d.text(plan.values) for d in plan.dimensions) == ["3", "⌀20", "⌀8.2"]


@pytest.mark.parametrize(
    ("value", "exact", "text"),
    [
        (3.0, False, "3"),
        (0.88, False, "0.88"),
        (34.392305, False, "34.392"),
        (1.0025, False, "1.0025"),
        (0.12345, True, "0.12345"),
        (11.999999999, False, "12"),
        (-0.0, False, "0"),
    ],
)
def test_numbers_are_as_short_as_they_can_be(value, exact, text):
    assert number(value, exact) == text


def test_radius_and_slope_measure_what_they_say():
    start, centre, end = Spot(OUTER, 0), Spot(OUTER, 0, centre=True), Spot(OUTER, 1)
    at = {start: (3.0, 4.0), centre: (0.0, 0.0), end: (4.0, 5.0)}
    values = {point.place(k): xy[k] for point, xy in at.items() for k in (0, 1)}
    assert radius_of(OUTER, 0).of(values) == 5.0
    assert Slope(start, end).of(values) == pytest.approx(45.0)
    assert str(centre.place(1)) == "outer.0.cy"
