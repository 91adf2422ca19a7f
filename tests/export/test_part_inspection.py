"""The sheet of what to measure on parts other than elements, against the parts and the stack."""

import csv
import io
import re

import pytest

from tactcad.export.inspection import PART_COLUMNS, part_inspection_bytes
from tactcad.parts.rules import load
from tactcad.scenes import make_scene, scene_names
from tactcad.stacks.virtual_build import sensor


@pytest.fixture(scope="module", params=["macro-array", "soft-tissue"])
def made(request):
    return sheet_of(request.param)


def sheet_of(name):
    design = load(name)
    scenes = [make_scene(design, name) for name in scene_names(design)]
    built = sensor(design, scenes)
    lines = built.stack()
    parts = {p.part_no: p for scene in scenes for p in scene.parts}
    data = part_inspection_bytes(design, parts.values(), built.variables, lines)
    return design, parts, lines, list(csv.DictReader(io.StringIO(data.decode("ascii"), newline="")))


@pytest.mark.by_day(1, "a design's parts each")
def test_rows_are_the_parts_own_limits_each_once(made):
    design, parts, _, rows = made
    assert tuple(rows[0]) == PART_COLUMNS
    assert len({(r["part_no"], r["characteristic"]) for r in rows}) == len(rows)
    for r in rows:
        part = parts[r["part_no"]]
        sizes = {c.name: (c.lower, c.upper) for c in part.characteristics}
        zones = {g.name: (0.0, g.zone) for g in part.geometric}
        limits = (float(r["lower"]), float(r["upper"]))
        assert limits == pytest.approx((sizes | zones)[r["characteristic"]])
        assert (r["design"], r["revision"], r["unit"], r["measured"]) == (
            design.name,
            design.design.of_part(r["part_no"]).revision,
            "mm",
            "",
        )
        assert r["where"] and not part.bought and "-element-" not in part.part_no


def test_the_order_is_the_stacks(made):
    """A row's share is that of a contributor of the requirement that it names, and none has more above it."""
    _, _, lines, rows = made
    shares = [float(r["share"]) for r in rows]
    assert shares == sorted(shares, reverse=True) and 0.0 <= shares[-1] and shares[0] <= 1.0
    own = {line.requirement.name: {f"{c.share:.3f}" for c in line.contributors} for line in lines}
    assert all(r["share"] in own[r["requirement"]] for r in rows)


def test_a_shop_can_read_where_and_with_what(made):
    """No feature names of the model; every row has an instrument that reads to a tenth of the limits, or
    gauges at both limits."""
    _, _, _, rows = made
    for r in rows:
        assert not re.search(r"z=|_|face z", r["where"] + r["how"])
        lower, upper = float(r["lower"]), float(r["upper"])
        if r["how"].startswith("plug gauges"):
            assert re.findall(r"\d\.\d+|\d+", r["how"]) == [f"{lower:g}", f"{upper:g}"]
        else:
            reads = float(re.search(r", ([\d.]+) or better", r["how"])[1])
            assert reads <= (upper - lower) / 10 + 1e-9 or reads == 0.0005
    (spacer,) = [r for r in rows if r["part_no"].endswith("-spacer") and r["characteristic"] == "thickness"]
    assert "less what the elements' sheet measures, +-0.01" in spacer["where"]


def test_the_spacers_row_says_what_its_sheet_and_the_guide_say(made):
    design, parts, _, rows = made
    said = f"{design.array.pitch:g} less what the elements' sheet measures, +-0.01"
    assert sum(said in note for note in parts[f"{design.name}-spacer"].notes) == 1
    (text,) = [s.text for s in make_scene(design, "array").steps if s.title == "Stack"]
    assert f"each is {design.array.pitch:g} mm less what the elements' sheet measures, +-0.01" in text


def test_every_part_on_which_the_array_depends_is_in_it(made):
    design, _, _, rows = made
    listed = {r["part_no"].removeprefix(f"{design.name}-") for r in rows}
    assert {"end-plate-head", "end-plate-tapped", "carrier", "stop-plate", "spacer"} <= listed


def test_a_turned_post_is_no_hole():
    """Plug gauges for bores and holes, a micrometer across pad and spigot; the posts' length is listed."""
    *_, rows = sheet_of("jaw-array")
    how = {
        (r["part_no"].removeprefix("jaw-array-"), r["characteristic"]): r["how"].split(",")[0] for r in rows
    }
    inside = {name for name, told in how.items() if told == "plug gauges"}
    assert {("cap", "bore diameter"), ("foil", "spigot diameter")} <= inside
    assert how["post", "pad side diameter"] == how["post", "spigot diameter"] == "micrometer"
    assert ("post", "length over the shoulder") in how
