"""The documentation's labelled drawings, read back: every length of [element] and [array] in its place."""

from __future__ import annotations

import dataclasses
import re
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tactcad.contour import Arc
from tactcad.design.load import read
from tactcad.design.tree import Array, Element
from tactcad.drawing.engine.layout_check import layout_faults
from tactcad.drawing.engine.sheet_files import svg_bytes
from tactcad.parts.array.element import outline
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.stop_gap import stop_gap

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "packaging"))
import coloured  # noqa: E402
import labelled  # noqa: E402

DESIGN = read(ROOT / "hardware" / "macro-array.toml")
LAYOUT = Layout(DESIGN)
PLACE = max(LAYOUT.elements, key=lambda p: p.arm)
EDGES = {s.name: s for s in outline(LAYOUT, PLACE.arm, PLACE.hinge, stop_gap(LAYOUT, PLACE))}
SIDE, HINGE = labelled.SIDE, labelled.HINGE
# field: view, axis, the edges of the contour that it lies between
BETWEEN = {
    "hinge_thickness": (HINGE, 1, "flat_face", "slot_floor"),
    "hinge_length": (HINGE, 0, "slot_arm_wall", "slot_body_wall"),
    "arm_height": (HINGE, 1, "flat_face", "arm_back"),
    "body_height": (HINGE, 1, "flat_face", "ledge"),
    "pad_length": (SIDE, 0, "tip", "pad_side"),
    "pad_height": (SIDE, 1, "pad_face", "flat_face"),
    "seat_length": (SIDE, 0, "slot_body_wall", "clamp_edge"),
    "rear_length": (SIDE, 0, "clamp_edge", "rear_end"),
    "rear_height": (SIDE, 1, "flat_face", "rear_top"),
    "recess_offset": (SIDE, 0, "clamp_edge", "recess_wall"),
    "recess_depth": (SIDE, 1, "flat_face", "recess_face"),
}
RADII = {
    "fillet_radius": (HINGE, "slot_body_fillet"),
    "pad_root_radius": (SIDE, "pad_root"),
    "corner_radius": (SIDE, "recess_root"),
}
NEAR = 0.002  # mm of paper; files have a micrometre


@dataclasses.dataclass(frozen=True)
class Label:
    """A text of the file, its place, and the tips of the arrows drawn since the text before it, mm, y up."""

    text: str
    at: tuple[float, float]
    upright: bool
    tips: tuple[tuple[float, float], ...]


def labels(name: str) -> dict[str, Label]:
    """By their first word, without the table's name before the dot."""
    tree = ElementTree.parse(ROOT / "docs" / "images" / f"labelled-{name}.svg").getroot()
    height = float(tree.get("viewBox").split()[3])
    found: dict[str, Label] = {}
    tips: list[tuple[float, float]] = []
    for item in tree.iter():
        if item.tag.endswith("path") and item.get("fill") == "#000000":
            x, y = map(float, re.match(r"M(-?[\d.]+),(-?[\d.]+)", item.get("d")).groups())
            tips.append((x, height - y))
        elif item.tag.endswith("text"):
            place = (float(item.get("x")), height - float(item.get("y")))
            name = item.text.split(" ")[0].split(".")[-1]
            found.setdefault(name, Label(item.text, place, item.get("transform") is not None, tuple(tips)))
            tips = []
    return found


def lengths(kind: type) -> set[str]:
    """Fields of a table that are lengths."""
    return {f.name for f in dataclasses.fields(kind) if getattr(f.metadata.get("spec"), "unit", "") == "mm"}


def on_paper(view, k: int, value: float) -> float:
    return view[0][k] + value * view[1]


def level(edge: str, k: int) -> float:
    segment = EDGES[edge]
    ends = {round(p[k], 9) for p in (segment.start, segment.end)}
    assert len(ends) == 1, f"{edge} is not level"
    return ends.pop()


def test_every_length_of_the_contour_and_of_the_array_stands_on_one_of_them():
    asked = lengths(Element) | lengths(Array) | {"row_arms", "thickness"}
    assert lengths(Element) == set(BETWEEN) | set(RADII)
    assert asked <= set(labels("element")) | set(labels("array"))


@pytest.mark.parametrize("field", BETWEEN)
def test_a_dimension_of_the_element_lies_between_its_edges_and_beside_its_name(field):
    view, k, a, b = BETWEEN[field]
    label = labels("element")[field]
    assert len(label.tips) == 2 and label.upright == (k == 1)
    meant = sorted(on_paper(view, k, level(edge, k)) for edge in (a, b))
    assert sorted(tip[k] for tip in label.tips) == pytest.approx(meant, abs=NEAR)
    size = abs(label.tips[0][k] - label.tips[1][k]) / view[1]
    assert size == pytest.approx(getattr(DESIGN.element, field), abs=NEAR)
    across = 1 - k  # the name stands beside the line, not beside another
    assert all(0.8 < abs(tip[across] - label.at[across]) < 2.5 for tip in label.tips)


@pytest.mark.parametrize("field", RADII)
def test_a_radius_of_the_element_points_at_an_arc_of_that_radius(field):
    view, name = RADII[field]
    arc, (tip,) = EDGES[name], labels("element")[field].tips
    assert isinstance(arc, Arc) and arc.radius == pytest.approx(getattr(DESIGN.element, field))
    centre = [on_paper(view, k, arc.centre[k]) for k in (0, 1)]
    off = ((tip[0] - centre[0]) ** 2 + (tip[1] - centre[1]) ** 2) ** 0.5
    assert off == pytest.approx(arc.radius * view[1], abs=2 * NEAR)


def test_the_contour_drawn_is_the_part_s():
    """Every edge's ends are in the file, at the place that the dimensions are compared with."""
    text = (ROOT / "docs" / "images" / "labelled-element.svg").read_text()
    height = float(re.search(r'viewBox="0 0 [\d.]+ ([\d.]+)"', text)[1])
    points = {(float(x), height - float(y)) for x, y in re.findall(r"[ML](-?[\d.]+),(-?[\d.]+)", text)}
    for segment in EDGES.values():
        x, y = (on_paper(SIDE, k, segment.start[k]) for k in (0, 1))
        assert any(abs(x - px) < NEAR and abs(y - py) < NEAR for px, py in points), segment.name


def test_arm_and_load_arm_end_at_the_hinge_s_middle():
    found = labels("element")
    middle = (level("slot_arm_wall", 0) + level("slot_body_wall", 0)) / 2
    pad = (level("tip", 0) + level("pad_side", 0)) / 2
    for name, start in (("row_arms", level("tip", 0)), ("load", pad)):
        meant = [on_paper(SIDE, 0, x) for x in (start, middle)]
        assert sorted(tip[0] for tip in found[name].tips) == pytest.approx(meant, abs=NEAR)
    assert middle - level("tip", 0) == pytest.approx(PLACE.arm)


def test_the_array_s_dimensions_are_where_the_elements_are():
    found, (origin, scale) = labels("array"), labelled.PLAN
    first, second = DESIGN.array.row_arms[0][:2], LAYOUT.elements[:2]
    y = [origin[1] - e.y * scale for e in second]
    assert sorted(t[1] for t in found["pitch"].tips) == pytest.approx(sorted(y), abs=NEAR)
    assert abs(y[0] - y[1]) == pytest.approx(DESIGN.array.pitch * scale)
    half = DESIGN.array.row_pitch / 2 * scale
    assert sorted(t[0] - origin[0] for t in found["row_pitch"].tips) == pytest.approx([-half, half], abs=NEAR)
    spacer = sorted(origin[1] - t[1] for t in found["spacer"].tips)
    third = LAYOUT.elements[2].y + DESIGN.sheet.thickness / 2
    fourth = LAYOUT.elements[3].y - DESIGN.sheet.thickness / 2
    assert spacer == pytest.approx([third * scale, fourth * scale], abs=NEAR)
    tips = sorted(t[0] for t in found["row_arms"].tips)
    assert (tips[1] - tips[0]) / scale == pytest.approx(first[0], abs=NEAR)


@pytest.mark.parametrize("sheet", [labelled.element_sheet(DESIGN), labelled.array_sheet(DESIGN)])
def test_the_files_are_those_drawn_now_and_no_text_lies_over_another_or_over_a_line(sheet):
    committed = ROOT / "docs" / "images" / f"labelled-{sheet.number}.svg"
    assert committed.read_bytes() == svg_bytes(sheet), "python packaging/labelled.py docs/images"
    faults = [f for f in layout_faults(sheet) if f.startswith("text") and "outside" not in f]
    assert not faults
    for text in sheet.texts:  # on the paper
        assert all(0 < x < sheet.size[0] and 0 < y < sheet.size[1] for x, y in text.corners()), text.text


def test_readme_s_picture_is_painted_in_the_colours_of_the_estimate():
    """Every element's own cap is on it once, in the colour between softest and stiffest that its K gives."""
    text = (ROOT / "docs" / "images" / "coloured-array.svg").read_text("utf-8")
    assert text == coloured.picture(LAYOUT), "python packaging/coloured.py docs/images"
    fills = re.findall(r'<polygon points="[^"]*" fill="(#[0-9a-f]{6})"', text)
    assert fills.count("#fde725") == fills.count("#482475") == 2  # arms of 8 and of 4 mm
    assert fills.count("#{:02x}{:02x}{:02x}".format(*coloured.GAUGE)) == len(LAYOUT.elements)
    for word in ("pad", "strain gauge", "element E4", "10 mm", "stiffness K, N/mm", "7.18", "38"):
        assert f">{word}</text>" in text
