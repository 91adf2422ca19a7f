"""What other designs are told: the field that helps, all properties at once, equal flags once."""

from __future__ import annotations

import pytest

from tactcad.design.load import parse
from tactcad.design.messages import InputError
from tactcad.design.tree import MOVING
from tactcad.parts.language.finding import Finding, grouped
from tactcad.parts.rules import load, refuse_broken
from tactcad.scenes import make_scene

TEXT = open("hardware/macro-array.toml").read()


def refused(text: str) -> str:
    with pytest.raises(InputError) as caught:
        refuse_broken(parse(text, "other"))
    return str(caught.value)


def test_a_thicker_sheet_asks_for_a_wider_pitch():
    said = refused(TEXT.replace("[sheet]\nthickness = 3.0", "[sheet]\nthickness = 5.0"))
    assert "array.pitch" in said and "at least sheet.thickness + array.spacer = 6 mm" in said
    assert "-1" not in said


def test_another_alloys_properties_are_refused_all_at_once():
    said = refused(TEXT.replace('alloy = "7075-T6"', 'alloy = "1.4310-C1300"'))
    for name in ("Young's modulus", "density", "yield strength", "fatigue strength"):
        assert name in said
    assert "left out" in said and said.count("\n") == 0


def of_spring_steel():
    lines = [
        line
        for line in TEXT.replace('alloy = "7075-T6"', 'alloy = "1.4310-C1300"').splitlines()
        if not line.startswith(("youngs_modulus", "poisson", "density", "yield_", "fatigue_", "tensile_"))
        and not line.startswith(('"material.', "conductivity", "magnetic"))
    ]
    return parse("\n".join(lines), "steel")


def test_gauges_are_ordered_for_the_grade_of_steel():
    """An austenitic one expands half as much again as others, and its gauges are other ones."""
    said = {
        of: next(s for s in make_scene(design, "array").supplies if s.part_no == "STRAIN-GAUGE").designation
        for of, design in (("7075", load("macro-array")), ("1.4310", of_spring_steel()))
    }
    assert "self-compensated for aluminium," in said["7075"]
    assert "self-compensated for steel 1.4310-C1300," in said["1.4310"]


def test_the_moving_weight_follows_the_density():
    usual = load("macro-array")
    assert usual.grasping.moving_weight == MOVING
    steel = of_spring_steel()
    # 290 mm2 of sheet, 21 mm of it, 5.09 g/cm3 heavier: 31 g
    assert steel.grasping.moving_weight == pytest.approx(MOVING + 0.31, abs=0.1)


def test_equal_flags_of_many_parts_are_one_line():
    flags = [Finding("hinge", "flag", f"E{n}", (), 0, 0, "thinner than any known") for n in range(1, 25)]
    assert grouped(flags) == ["E1: hinge: thinner than any known (and of E2, E3, E4 and 20 more)"]
    other = Finding("hinge", "flag", "E1", (), 0, 0, "something else")
    assert len(grouped([*flags, other])) == 2
