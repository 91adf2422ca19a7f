"""A target file is read field by field; what contradicts itself is refused with field, value and legal."""

from __future__ import annotations

import json
from dataclasses import fields, replace
from pathlib import Path

import pytest

from tactcad.cli.main import main
from tactcad.design.design_text import design_text
from tactcad.design.load import names, parse, read
from tactcad.design.messages import InputError
from tactcad.synthesis.target import TABLES, parse_target, read_target

SHIPPED = Path(__file__).parents[2] / "hardware" / "targets" / "better-array.toml"
LEAST = """
[target]
name = "mine"
[object]
stiffness = [2, 10]
[grasp]
force = 10
overload = 12
"""


def test_a_target_needs_an_object_and_forces_only():
    target = parse_target(LEAST, "t")
    assert target.stiffness_range == (2.0, 10.0) and target.target.half_width is None
    assert target.stock.sheets == (3.0,) and target.stock.alloys == ("7075-T6",)  # the base design's


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("[object]\nstiffness = [2, 10]\n", "", "object: missing table"),
        ("[target]", "[sheet]", "sheet: unknown field; legal: see `tactcad schema target`"),
        ("stiffness = [2, 10]", "", "needs one of stiffness and modulus"),
        (
            "stiffness = [2, 10]",
            "stiffness = [2, 10]\nmodulus = [1, 2]",
            "needs one of stiffness and modulus",
        ),
        (
            "stiffness = [2, 10]",
            "stiffness = [10, 2]",
            "object.stiffness: its first value is above its second",
        ),
        ("stiffness = [2, 10]", "stiffness = [2, nan]", "object.stiffness[1]: not a finite number"),
        ("stiffness = [2, 10]", "stiffness = [2]", "object.stiffness: a list of 1"),
        ("stiffness = [2, 10]", "modulus = [1, 2]\nthickness = 0.5", "object.thickness: too thin"),
        ("force = 10", "force = -1", "grasp.force: out of range"),
        ("force = 10", "forse = 10", "grasp.forse: unknown field"),
        ('name = "mine"', 'name = "con"', "target.name: not usable text"),
        ('name = "mine"', 'name = "mine"\nbase = "none"', "no design of that name"),
        ('name = "mine"', 'name = "mine"\nleast = "price"', "target.least: unknown choice"),
        ("[grasp]", "[stock]\nalloys = ['unobtainium']\n[grasp]", "stock.alloys[0]: unknown alloy"),
        ("[grasp]", "[stock]\nalloys = ['stainless']\n[grasp]", "17-4PH-H900 or 1.4310-C1300 or 1.4034-"),
        ("[grasp]", "[stock]\nalloys = ['7075-T6', '7075-T6']\n[grasp]", "not a list of different words"),
        ("[grasp]", "[stock]\nsheets = [3, 3.0]\n[grasp]", "stock.sheets: not a list of different numbers"),
        ("[grasp]", "[stock]\nhinge_tolerances = [0.01, 0.01]\n[grasp]", "tolerances: not a list of diff"),
        ("[grasp]", "[elements]\nof_a_kind = 6\n[grasp]", "elements.of_a_kind: two kinds of so many"),
        ("[grasp]", "[elements]\narms = [8, 4]\n[grasp]", "elements.arms: its first value"),
        ("[grasp]", "[grips]\nx = 1\n[grasp]", "grips: unknown field"),
        ("[grasp]", "[origin]\n'grasp.farce' = 'x'\n[grasp]", "origin.grasp.farce: unknown field"),
        ("[target]", "target = 1\n[targets]", "target"),
    ],
)
def test_what_is_wrong_is_named(old, new, says):
    assert old in LEAST
    with pytest.raises(InputError) as caught:
        parse_target(LEAST.replace(old, new, 1), "t")
    assert says in str(caught.value)


def test_an_array_without_a_calibration_rig_cannot_be_calibrated(tmp_path):
    design = read("macro-array")
    origin = {k: v for k, v in design.origin.items() if not k.startswith("calibration.")}
    bare = design_text(replace(design, calibration=None, origin=origin))
    (tmp_path / "bare.toml").write_text(bare)
    text = LEAST.replace('name = "mine"', f'name = "mine"\nbase = "{tmp_path}/bare.toml"')
    with pytest.raises(InputError, match=r"known.how: design macro-array has no \[calibration\]"):
        parse_target(text, "t")
    assert parse_target(text + '[known]\nhow = "drawn"\n', "t").known.how == "drawn"


def test_schemas_have_every_field(capsys):
    assert main(["schema", "--target"]) == 0
    text = capsys.readouterr().out
    assert main(["schema", "--target", "--json"]) == 0
    schema = json.loads(capsys.readouterr().out)
    for name, kind in TABLES.items():
        wanted = {f.name for f in fields(kind)}
        assert set(schema["else"]["properties"][name]["properties"]) == wanted
        part = text.split(f"[{name}]")[1].split("\n\n")[0]
        assert all(f"\n  {field} " in part for field in wanted)


def test_the_shipped_target_says_where_its_values_are_from():
    target = read_target(SHIPPED)
    assert target.origin["object.stiffness"].startswith("paper")
    assert target.stiffness_range == (2.34, 10.01)


def test_a_modulus_is_a_stiffness_under_one_pad():
    """Of a rigid pad, 2 x 3 mm: 14 x 18 graded patches of other code gave 4.98 N/mm for 1 MPa on 6 mm and
    3.73 on a half-space, nu 0.49, some 0.4 % too little."""
    for thickness, stiffness in (("thickness = 6", 4.98), ("", 3.73)):
        target = parse_target(LEAST.replace("stiffness = [2, 10]", f"modulus = [1, 2]\n{thickness}"), "t")
        low, high = target.stiffness_range
        assert high == pytest.approx(2 * low) and low == pytest.approx(stiffness * 1.004, rel=3e-3)


@pytest.mark.parametrize("name", names())
def test_a_designs_text_is_read_back_as_the_same_design(name):
    design = read(name)
    assert parse(design_text(design, "first\nsecond"), name) == design
