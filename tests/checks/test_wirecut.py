"""One deliberately bad part for every rule, each broken just below its limit and mended just above."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from parallel_curve import offset
from variants import TINY_TEXT

from tactcad.checks.described.wirecut import check_wirecut
from tactcad.checks.shop import DEFAULT, load_shop
from tactcad.cli.main import main
from tactcad.contour import Arc, Contour, Corner, Line, chain, circle, rectangle, rounded_polygon
from tactcad.design.messages import InputError
from tactcad.parts.language.description import Extrusion, Hole, Material, Part

SHOP = load_shop()
ALUMINIUM, STEEL = Material("7075-T6", 2810.0), Material("1.4301", 7900.0)


def part(outer: Contour, *openings: Contour, material: Material = ALUMINIUM) -> Part:
    return Part("X-1", "part", "wire-cut", material, Extrusion(outer, 3.0, openings))


def block(slot: float = 1.0, radius: float = 0.3, web: float = 2.5, kind: str = "notch") -> Contour:
    """20 x 8 with a slot from above to `web` over the lower face."""
    a, b = 10 + slot / 2, 10 - slot / 2
    return rounded_polygon(
        [
            Corner((0, 0)),
            Corner((20, 0)),
            Corner((20, 8)),
            Corner((a, 8)),
            Corner((a, web), radius, f"{kind}_floor", f"{kind}_body_fillet"),
            Corner((b, web), radius, fillet=f"{kind}_arm_fillet"),
            Corner((b, 8)),
            Corner((0, 8)),
        ]
    )


def keyhole(width: float) -> Contour:
    """20 x 8 with a wide chamber that opens upwards through a narrow throat between two lips."""
    half = width / 2
    points = [
        (0, 0, 0),
        (20, 0, 0),
        (20, 8, 0),
        (10 + half, 8, 0),
        (10 + half, 7, 0),
        (11, 6, 0.3),
        (11, 3, 0.3),
        (9, 3, 0.3),
        (9, 6, 0.3),
        (10 - half, 7, 0),
        (10 - half, 8, 0),
        (0, 8, 0),
    ]
    return rounded_polygon([Corner((x, y), r) for x, y, r in points])


def finned(thickness: float) -> Contour:
    """A free-standing wall on a base, its roots rounded."""
    a, b = 10 - thickness / 2, 10 + thickness / 2
    points = [(0, 0, 0), (20, 0, 0), (20, 3, 0), (b, 3, 0.3), (b, 9, 0), (a, 9, 0), (a, 3, 0.3), (0, 3, 0)]
    return rounded_polygon([Corner((x, y), r) for x, y, r in points])


def off_circle(miss: float) -> Contour:
    """An arc whose end lies `miss` off its own circle."""
    return Contour((Line((0.0, 0.0), (8.0, 0.0)), Arc((8.0, 0.0), (0.0, 0.0), (4.0 + miss, 0.0), True)))


BOW_TIE = chain([(0, 0), (9, 9), (9, 0), (0, 9)])
TOUCHING = chain([(0, 0), (9, 0), (9, 9), (4, 1e-7), (0, 9)])
NARROW_TRIANGLE = chain([(5, 2), (15, 2), (10, 2.4)])  # wide enough for the wire, not for its start hole

# rule, part that breaks it, the same part mended
CASES = {
    "closed chain": (part(off_circle(1e-6)), part(off_circle(0.0))),
    "simple contour": (part(BOW_TIE), part(rectangle(0, 0, 9, 9))),
    "simple contour, touching": (part(TOUCHING), part(chain([(0, 0), (9, 0), (9, 9), (0, 9)]))),
    "openings inside": (
        part(rectangle(0, 0, 20, 8), circle((1, 4), 2)),
        part(rectangle(0, 0, 20, 8), circle((2, 4), 2)),
    ),
    "openings inside, nested": (
        part(rectangle(0, 0, 20, 8), circle((9, 4), 4), circle((9, 4), 2)),
        part(rectangle(0, 0, 20, 8), circle((5, 4), 4), circle((15, 4), 2)),
    ),
    "inside corner": (part(block(radius=0.149)), part(block(radius=0.150))),
    "inside corner, sharp": (part(block(radius=0.0)), part(block())),
    "inside corner, opening": (part(rectangle(0, 0, 20, 8), rectangle(4, 3, 9, 5)), part(block())),
    "slot width": (part(keyhole(0.299)), part(keyhole(0.4))),
    "wall": (part(finned(0.799)), part(finned(0.8))),
    "wall, steel": (part(finned(0.499), material=STEEL), part(finned(0.5), material=STEEL)),
    "wall, web that is no hinge": (part(block(web=0.799)), part(block(web=0.8))),
    "wall, hole at the edge": (
        part(rectangle(0, 0, 20, 8), circle((10, 2.25), 3)),
        part(rectangle(0, 0, 20, 8), circle((10, 2.35), 3)),
    ),
    "start hole": (
        part(rectangle(0, 0, 20, 8), circle((5, 4), 0.499)),
        part(rectangle(0, 0, 20, 8), circle((5, 4), 0.5)),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_the_bad_part_fails_its_rule_and_the_mended_one_none(name):
    bad, good = CASES[name]
    findings = check_wirecut(bad, SHOP)
    assert {f.check for f in findings if f.severity == "fail"} == {name.split(",")[0]}
    assert all(f.part == "X-1" and f.message for f in findings)
    assert check_wirecut(good, SHOP) == []


def test_values_limits_and_places():
    (corner, other) = check_wirecut(part(block(radius=0.149)), SHOP)
    assert corner.value == pytest.approx(0.149)
    assert corner.limit == pytest.approx(0.150)
    assert {round(f.place[0]) for f in (corner, other)} == {10}
    assert "vendor" in corner.message
    (wall,) = check_wirecut(part(finned(0.7)), SHOP)
    assert (wall.value, wall.limit) == (pytest.approx(0.7), 0.8)
    assert "tongrencnc.com" in wall.message


@pytest.mark.parametrize("thickness", [0.25, 0.1])
def test_a_hinge_is_a_flag_for_the_quotation(thickness):
    (finding,) = check_wirecut(part(block(web=thickness, kind="slot")), SHOP)
    assert (finding.severity, finding.check) == ("flag", "hinge")
    assert finding.value == pytest.approx(thickness)
    for word in ("hinge", "passes", "order of cuts", "tab"):
        assert word in finding.message
    assert ("published" in finding.message) == (thickness < 0.117)


def test_a_slot_between_needed_and_advised_is_a_flag():
    findings = check_wirecut(part(block(slot=0.35, radius=0.175)), SHOP)
    assert {(f.severity, f.check) for f in findings} == {("flag", "slot width")}


def test_a_drilled_hole_counts_as_a_wall():
    drilled = Hole("pin", (10.0, 1.5, 0.0), (0.0, 0.0, 1.0), 2.0, 3.0, True)
    findings = check_wirecut(replace(part(rectangle(0, 0, 20, 8)), features=(drilled,)), SHOP)
    assert [(f.check, round(f.value, 9)) for f in findings] == [("wall", 0.5)]


@pytest.mark.parametrize(
    "slot, radius",
    [(s, r) for s in (0.25, 0.29, 0.31, 0.5, 0.8) for r in (0.05, 0.12, 0.14, 0.16) if 2 * r <= s],
)
def test_corner_and_slot_rules_are_what_the_wires_path_says(slot, radius):
    """The wire's centre runs on the parallel curve: cuttable means that this exists and keeps every
    fillet."""
    outer = block(slot=slot, radius=radius)
    failed = {f.check for f in check_wirecut(part(outer), SHOP) if f.severity == "fail"}
    try:
        path = offset(outer, SHOP.limits.corner_radius)
        kept = sum(s.name.endswith("fillet") for s in path) == sum(s.name.endswith("fillet") for s in outer)
    except ValueError:
        kept = False
    assert (not failed) == kept


def test_the_shipped_designs_can_be_cut():
    from tactcad.design.load import names
    from tactcad.parts.rules import load
    from tactcad.scenes import make_scene

    for name in names():
        for made in make_scene(load(name), "array").parts:
            if made.process == "wire-cut":
                assert [f for f in check_wirecut(made, SHOP) if f.severity == "fail"] == []


# the shop's own file


def shop_text(**changes: str) -> str:
    text = DEFAULT.read_text()
    for old, new in changes.values():
        assert old in text
        text = text.replace(old, new)
    return text


def test_a_shop_with_a_finer_wire_cuts_more(tmp_path):
    fine = tmp_path / "fine.toml"
    fine.write_text(shop_text(wire=("wire_diameter = 0.25\n", "wire_diameter = 0.1\n")))
    bad = part(block(radius=0.1, slot=0.5))
    assert check_wirecut(bad, SHOP)
    assert check_wirecut(bad, load_shop(fine)) == []


@pytest.mark.parametrize(
    "change, message",
    [
        (("wall = 0.5", "wall = 0.5\nwal = 0.5"), "limits.wal: unknown field"),
        (("spark_gap = 0.025\n", ""), "limits.spark_gap: missing field"),
        (("wall = 0.5", "wall = -0.5"), "limits.wall: is no size; found -0.5"),
        (("wall = 0.5", "wall = nan"), "limits.wall: is no size; found nan"),
        (("wall = 0.5", "wall = 1e300"), "limits.wall: is no size"),
        (("wall = 0.5", "wall = true"), "limits.wall: is no size; found True"),
        (("wall = 0.5", 'wall = "0.5"'), "limits.wall: is no size; found '0.5'"),
        (("wall = 0.5", "wall = "), "is not TOML"),
        (('name = "general practice"', "name = 3"), "name: not text"),
        (("[source]", "[sources]"), "sources: unknown field"),
        (('spark_gap = "', 'spark_gap = "" # "'), "source.spark_gap: not text"),
        (("wall = 0.8", "wal = 0.8"), "machining.wal: unknown field"),
        (("drill_reach = 10.0", "drill_reach = 0"), "machining.drill_reach: is no size; found 0"),
        (("[machining]", "[[machining]]"), "machining: is no table"),
        (('floor = "', 'floor = "" # "'), "machining_source.floor: not text"),
        (('ring = "', '# "'), "machining_source.ring: missing field"),
    ],
)
def test_a_shop_file_that_cannot_be_used(tmp_path, change, message):
    path = tmp_path / "shop.toml"
    path.write_text(shop_text(change=change))
    with pytest.raises(InputError) as refusal:
        load_shop(path)
    assert message in str(refusal.value)
    assert "shop.toml" in str(refusal.value)


def test_a_shop_may_say_only_in_what_its_machining_differs(tmp_path):
    path = tmp_path / "shop.toml"
    head = DEFAULT.read_text().split("# mills")[0]
    path.write_text(head)
    assert load_shop(path).machining == SHOP.machining
    path.write_text(head + '[machining]\nwall = 1.2\n[machining_source]\nwall = "our own mill"\n')
    own = load_shop(path)
    assert own.machining == replace(SHOP.machining, wall=1.2)
    assert own.machining_source == {**SHOP.machining_source, "wall": "our own mill"}


@pytest.mark.cad
def test_the_shop_s_machining_limits_reach_the_check(tmp_path, capsys):
    """A shop that wants 1 mm flags the end plate; one that wants no less than that fails it; a broken file
    ends with 2."""
    path, tiny = tmp_path / "shop.toml", tmp_path / "tiny.toml"
    tiny.write_text(TINY_TEXT, "utf-8")
    for least, status in (("0.5", 0), ("1.0", 1)):
        path.write_text(shop_text(wall=("wall = 0.8\nwall_least = 0.5", f"wall = 1.0\nwall_least = {least}")))
        assert main(["check", str(tiny), "--scene", "array", "--shop", str(path)]) == status
        assert "between screw_2 and dowel_hole" in capsys.readouterr().out
    path.write_text(path.read_text() + "drill = ")
    assert main(["check", str(tiny), "--shop", str(path)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_a_shop_file_that_is_not_there(tmp_path):
    for path in (tmp_path / "none.toml", tmp_path, Path(__file__).with_suffix(".pyc")):
        with pytest.raises(InputError, match="cannot be read|is not TOML"):
            load_shop(path)
