"""Inspection sheet and strength summary: what stands in them, against the design, the contour and the closed
forms."""

from __future__ import annotations

import csv
import io
from collections import Counter

import pytest
from variants import FACING_ROWS, variant

from tactcad.export.inspection import COLUMNS, inspection_bytes
from tactcad.export.strength_table import strength_bytes
from tactcad.parts.array.element import element
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import load


def table(data: bytes) -> list[dict[str, str]]:
    text = data.decode("ascii")  # opens alike in every spreadsheet, whatever it takes the encoding for
    assert all(line.endswith("\r") for line in text.split("\n")[:-1])
    return list(csv.DictReader(io.StringIO(text, newline=""), strict=True))


@pytest.mark.parametrize("name", FACING_ROWS)
def test_every_dimension_of_every_element_stands_once_blank_and_with_its_limits(name):
    layout = Layout(load(name))
    d = layout.design
    rows = table(inspection_bytes(layout))
    assert tuple(rows[0]) == COLUMNS
    count = Counter((r["element"], r["characteristic"]) for r in rows)
    assert set(count.values()) == {1}
    elements = {f"E{n}" for n in range(1, sum(map(len, d.array.row_arms)) + 1)}
    assert {e for e, _ in count} == elements
    assert {(r["design"], r["revision"], r["unit"], r["measured"], r["uncertainty_k2"]) for r in rows} == {
        (d.name, d.design.of_part(r["part_no"]).revision, "mm", "", "") for r in rows
    }
    assert all(r["where"] and r["how"] for r in rows)
    assert not [r for r in rows if r["where"].startswith("as dimensioned")]  # each says how by itself
    # nominal and limits as the design file gives them
    arms = [arm for row in d.array.row_arms for arm in row]
    for n, arm in enumerate(arms, 1):
        own = {r["characteristic"]: r for r in rows if r["element"] == f"E{n}"}
        of = lambda name: tuple(float(own[name][k]) for k in ("nominal", "lower", "upper"))  # noqa: E731
        t, L = layout.hinge_of(n).t, arm - d.element.pad_length / 2
        assert of("hinge thickness") == pytest.approx(
            (t, t - d.tolerance.hinge_thickness, t + d.tolerance.hinge_thickness)
        )
        assert of("load arm") == pytest.approx((L, L - d.tolerance.load_arm, L + d.tolerance.load_arm))
        assert of("sheet thickness")[0] == d.sheet.thickness
        keys = {name for name, r in own.items() if r["key"] == "yes"}
        place = layout.elements[n - 1]
        assert (
            keys == {c.name for c in element(layout, place).characteristics if c.key} >= {"hinge thickness"}
        )


def test_nominals_are_what_the_contour_has(macro):
    """Slot, hinge, arm and stop gap measured on the outline's own points, as a shop would on the part."""
    layout = Layout(macro)
    rows = table(inspection_bytes(layout))
    for place in layout.elements:
        nominal = {r["characteristic"]: float(r["nominal"]) for r in rows if r["element"] == place.designator}
        body = element(layout, place).body
        x = lambda name: body.outer.named(name).at(0.5)[0]  # noqa: E731
        z = lambda name: body.outer.named(name).at(0.5)[1]  # noqa: E731
        slot = x("slot_body_wall") - x("slot_arm_wall")
        assert nominal["slot length"] == pytest.approx(slot)
        assert nominal["hinge thickness"] == pytest.approx(z("slot_floor"))
        assert nominal["arm height"] == pytest.approx(z("arm_back"))
        assert nominal["stop gap"] == pytest.approx(z("ledge") - z("stop_land"))
        pad = [
            p
            for s in body.outer
            for p in (s.start, s.end)
            if p[1] == pytest.approx(-macro.element.pad_height)
        ]
        middle = (min(p[0] for p in pad) + max(p[0] for p in pad)) / 2
        assert nominal["load arm"] == pytest.approx((x("slot_body_wall") + x("slot_arm_wall")) / 2 - middle)
        hole = next(c for c in body.openings if c.as_circle() and abs(2 * c.as_circle()[1] - 3.015) < 1e-9)
        assert nominal["pad height over the dowel hole's centre"] == pytest.approx(
            hole.centroid[1] - pad[0][1]
        )


def test_strength_summary_against_its_own_definitions():
    layout = Layout(load("macro-array"))
    d = layout.design
    rows = table(strength_bytes(layout))
    assert [r["element"] for r in rows] == [p.designator for p in layout.elements]
    for r, place in zip(rows, layout.elements):
        # the paper's 69 GPa, and 7075-T6's 72 (docs/mechanics.md)
        both = float(r["stiffness_with_tables_modulus_N_per_mm"]) / float(r["stiffness_N_per_mm"])
        assert both == pytest.approx(72 / 69, rel=1e-3)
        yields, rated = float(r["yield_force_N"]), float(r["rated_force_N"])
        assert rated == pytest.approx(min(d.rating.force, yields / d.rating.yield_factor), rel=1e-3)
        assert float(r["yield_factor_at_rated"]) == pytest.approx(yields / rated, rel=1e-3)
        # the force that closes the gap at the tip of a rigid arm on a rigid body; where the body gives way
        # the tip moves less, by 0.5 % at the shortest arm (tests/mechanics/test_stop.py has it exactly)
        closing = (
            float(r["stiffness_N_per_mm"]) * float(r["largest_stop_gap_mm"]) * place.load_arm / place.arm
        )
        assert closing * 0.998 < float(r["stop_closes_at_N"]) < closing * 1.007
        stress = float(r["fillet_stress_at_overload_MPa"])
        assert float(r["yield_factor_at_overload"]) == pytest.approx(
            d.material.yield_strength / stress, rel=1e-3
        )
        assert closing < d.rating.overload_force and r["not_known_because"] == ""


def test_where_the_estimator_does_not_reach_the_figures_are_blank_and_the_reason_stands():
    layout = Layout(variant({"element.hinge_length": 0.62, "element.arm_height": 0.7}))
    for r in table(strength_bytes(layout)):
        assert r["stiffness_N_per_mm"] == r["rated_force_N"] == r["yield_factor_at_overload"] == ""
        assert len(r["not_known_because"]) > 10
