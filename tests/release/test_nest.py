"""Nests of an order: read from their DXF files by ezdxf, and measured with shapely."""

from __future__ import annotations

import io
from collections import defaultdict
from itertools import combinations

import ezdxf
import ezdxf.path
import pytest
from shapely import LineString, Point, Polygon
from shapely.ops import polygonize

from tactcad.checks.shop import load_shop
from tactcad.parts.language.stock import cut_section
from tactcad.parts.rules import load
from tactcad.release.packages import nest_files, order_nests, wire_time
from tactcad.release.release_contents import ReleaseContents
from tactcad.scenes import make_scene, scene_names

FLAT = 1e-3  # mm that arcs are off when they are taken as chords
SHOP = load_shop()


@pytest.fixture(scope="module", params=["macro-array", "double-sample"])
def contents(request) -> ReleaseContents:
    design = load(request.param)
    return ReleaseContents(design, [make_scene(design, n) for n in scene_names(design)], (), (), False, True)


def layers(data: bytes) -> dict[str, list]:
    found = defaultdict(list)
    for entity in ezdxf.read(io.StringIO(data.decode())).modelspace():
        way = [(p.x, p.y) for p in ezdxf.path.make_path(entity).flattening(FLAT)]
        found[entity.dxf.layer].append((entity, LineString([(round(x, 6), round(y, 6)) for x, y in way])))
    return found


def test_every_piece_lies_whole_on_its_sheet_apart_from_all_others(contents):
    files, found = nest_files(contents, SHOP), order_nests(contents, SHOP)
    parts = {line.row.part_no: line.part for line in contents.lines}
    for stem, nest in found.items():
        drawn = layers(files[f"{stem}.dxf"])
        (sheet,) = polygonize([line for _, line in drawn["SHEET"]])
        rings = sorted(polygonize([line for _, line in drawn["CUT"]]), key=lambda p: -p.area)
        whole = [Polygon(r.exterior) for r in rings]
        inner = [p for p in whole if any(q.area > p.area and q.contains(p.centroid) for q in whole)]
        outlines = [p for p in whole if not any(p is q for q in inner)]
        assert len(outlines) == len(nest.pieces)
        for a, b in combinations(outlines, 2):
            assert a.distance(b) >= 5.0 - 2 * FLAT
        assert all(sheet.buffer(-10.0 + FLAT).contains(p) for p in outlines)
        material = sum(cut_section(parts[p.part_no]).section_area for p in nest.pieces)
        assert nest.scrap == pytest.approx(1.0 - material / sheet.area, abs=1e-9)
        # the wire starts in waste: inside an opening or in the web
        for entity, _ in drawn["START"]:
            at = Point(entity.dxf.center.x, entity.dxf.center.y)
            in_hole = any(h.buffer(-0.5).contains(at) for h in inner)
            assert in_hole or all(p.distance(at) >= 0.5 for p in outlines)
            assert sheet.contains(at.buffer(0.5))
        assert len(drawn["START"]) == len(outlines) + len(inner)
        for _, line in drawn["TAB"]:
            assert line.length == pytest.approx(2.0, abs=1e-6)
            assert any(p.exterior.buffer(1e-6).contains(line) for p in outlines)


def test_what_is_ordered_is_nested_once(contents):
    nested = defaultdict(int)
    for nest in order_nests(contents, SHOP).values():
        for piece in nest.pieces:
            nested[piece.part_no] += nest.high
    for line in contents.lines:
        if line.part is not None and not line.part.bought and cut_section(line.part) is not None:
            assert line.order <= nested[line.row.part_no] < line.order + 12, line.row.part_no


def test_no_element_is_turned_in_its_sheet(contents):
    """The sheet is rolled along the arms."""
    wired = [n for n in order_nests(contents, SHOP).values() if n.wire]
    assert wired and not any(p.quarter for n in wired for p in n.pieces)


def test_spacers_are_cut_as_a_pack_in_one_pass(contents):
    line = next(x for x in contents.lines if x.row.part_no.endswith("-spacer"))
    alone, pack = wire_time(line.part, SHOP.feed), wire_time(line.part, SHOP.feed, round(line.order))
    assert pack.passes == 1 and pack.at_once == line.order
    assert pack.height == line.order * line.part.extrusion.thickness
    # by hand: one contour after the other, 60 mm2 a minute, and 1.5 minutes a start, once for the pack
    section = cut_section(line.part)
    minutes = section.cut_length * pack.height / 60 + 1.5 * (1 + len(section.openings))
    assert pack.minutes * line.order == pytest.approx(minutes)
    assert alone.minutes * line.order > 5 * minutes


def test_elements_are_cut_one_by_one(contents):
    for line in contents.lines:
        if "element" in line.row.part_no:
            assert wire_time(line.part, SHOP.feed, 15).at_once == 1
