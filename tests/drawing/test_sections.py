"""Sections: where one is cut, by features alone; what it shows, held against the part's description and its
solid; its marks."""

from __future__ import annotations

import hashlib
import os
import pickle
import re
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from math import dist, hypot, isclose, sqrt
from pathlib import Path

import pytest
from built import shape_of
from variants import variant

import tactcad
from tactcad.contour import Arc as ArcSegment
from tactcad.contour import circle, rectangle
from tactcad.drawing.engine.ink import Fill, Hatch, Stroke, Text
from tactcad.drawing.engine.layout_check import layout_faults
from tactcad.drawing.engine.sheet_files import pdf_bytes, pdf_runs, svg_bytes
from tactcad.drawing.parts import compose
from tactcad.drawing.parts.measures import in_part
from tactcad.drawing.parts.part_sheet import MadeFrom, Order, part_sheet, written
from tactcad.drawing.parts.prism import prism_plan
from tactcad.parts.language.description import Extrusion, Hole, Material, Part, Pocket, drill_point_height
from tactcad.scenes import make_scene

pytestmark = pytest.mark.cad

DXF = MadeFrom("dxf/some_B.dxf", "f" * 64)
CUT = ("holder-body", "holder-lid", "cart-plate", "tip-flat", "tip-roller", "end-plate-head", "base")
ACROSS_Y = "bar"  # every plane across x through one of its holes would cut another off its axis
WHOLE = ("spacer", "stop-plate", "element-a8mm", "ballast")


# --- where ---


def block(*features, openings=(), name="BLOCK") -> Part:
    return Part(
        name,
        "Block",
        "milled",
        Material("6061-T6", 2700),
        Extrusion(rectangle(0, 0, 40, 30), 10.0, openings),
        features,
    )


def section(part: Part):
    plan = prism_plan(part, ())
    cut = [v.section for v in plan.views if v.section]
    assert len(cut) <= 1
    return cut[0] if cut else None


DOWN = (0.0, 0.0, -1.0)
THROUGH = Hole("through", (8.0, 8.0, 10.0), DOWN, 3.0, 10.0, True)
TAPPED = Hole("tapped", (32.0, 8.0, 10.0), DOWN, 3.3, 10.0, True, thread="M4", thread_depth=10.0)
BLIND = Hole("blind", (20.0, 15.0, 10.0), DOWN, 3.3, 6.0, False, drill_point=True)
BORED = Hole("bored", (12.0, 15.0, 10.0), DOWN, 3.4, 10.0, True, (6.0, 3.3))
POCKET = Pocket("pocket", (27.0, 15.0, 10.0), DOWN, (1.0, 0.0, 0.0), rectangle(-4, -5, 4, 5), 4.0)
GROOVE = Pocket(
    "groove", (20.0, 15.0, 10.0), DOWN, (1.0, 0.0, 0.0), circle((0, 0), 20), 2.0, (circle((0, 0), 16),)
)


@pytest.mark.parametrize(
    ("features", "at"),
    [
        ((), None),
        ((THROUGH, TAPPED), None),
        ((BLIND,), 20.0),
        ((BORED,), 12.0),
        ((POCKET,), 27.0),
        ((GROOVE,), 20.0),
        ((THROUGH, TAPPED, BLIND), 20.0),
        ((BLIND, BORED), 20.0),
        ((GROOVE, BLIND), 20.0),
    ],
)
def test_a_section_is_cut_through_what_is_sunk_and_through_nothing_else(features, at):
    found = section(block(*features))
    assert (found.at if found else None) == at
    # the name says nothing
    assert section(block(*features, name="macro-array-holder-body")) == found


def test_a_plate_with_openings_is_not_cut():
    assert section(block(openings=(circle((10, 10), 5), circle((30, 10), 5)))) is None


def test_the_plane_shows_most_kinds_then_the_deepest():
    in_line = replace(BORED, at=(12.0, 22.0, 10.0)), replace(BLIND, at=(12.0, 8.0, 10.0))
    assert section(block(replace(BLIND, at=(28.0, 15.0, 10.0), depth=7.0), *in_line)).at == 12.0
    deep = replace(BORED, at=(33.0, 15.0, 10.0), counterbore=(6.0, 7.0))
    assert section(block(BLIND, deep)).at == 33.0


def test_no_plane_cuts_another_hole_off_its_axis_or_runs_along_a_wall():
    beside, over = (replace(THROUGH, at=at) for at in ((21.4, 5.0, 10.0), (8.0, 16.4, 10.0)))
    assert section(block(BLIND, beside, over)) is None
    assert section(block(BLIND, replace(beside, at=(21.6, 5.0, 10.0)), over)).at == 20.0
    across = section(block(BLIND, beside, replace(over, at=(8.0, 16.6, 10.0))))
    assert (across.axis, across.at) == (1, 15.0)
    wall = replace(POCKET, contour=rectangle(-7.0, -14.0, 7.0, -9.0))
    assert section(block(BLIND, wall)).at == 27.0  # x = 20 is the pocket's side


# --- what it shows ---


@pytest.fixture(scope="module")
def orders():
    from tactcad.solids.step import to_bytes

    design = variant()
    scenes = [make_scene(design, name) for name in ("array", "calibration", "sample-stiffness", "grasping")]
    parts = {p.part_no.removeprefix("macro-array-"): p for s in scenes for p in s.parts}
    return {
        n: Order(design, parts[n], to_bytes(shape_of(parts[n])), (DXF,)) for n in (*CUT, ACROSS_Y, *WHOLE)
    }


@pytest.fixture(scope="module")
def sheets(orders):
    return {n: part_sheet(order) for n, order in orders.items()}


def face_of(sheet) -> Hatch | None:
    faces = [i for i in sheet.items if isinstance(i, Hatch)]
    assert len(faces) <= 1
    return faces[0] if faces else None


def scale_of(sheet) -> float:
    up, down = next(t.text for t in sheet.texts if re.fullmatch(r"\d+:\d+", t.text)).split(":")
    return int(up) / int(down)


def plane_of(order: Order) -> float:
    cut = section(order.part)
    assert cut.axis == (order.part.part_no.endswith(ACROSS_Y))
    return cut.at


def test_plain_parts_have_none(sheets):
    for number in WHOLE:
        assert face_of(sheets[number]) is None
        assert not [t for t in sheets[number].texts if t.text in ("S", "S-S")], number


def polygon(contour) -> list[tuple[float, float]]:
    return [
        s.at(i / n) for s in contour for n in (4000 if isinstance(s, ArcSegment) else 1,) for i in range(n)
    ]


def length_at(contour, k: int, x: float) -> float:
    """How much of the line at x (k = 0) or y (k = 1) lies inside a contour: by its corners, none of which is
    on the line."""
    x += 1.234e-10
    points = [(p[k], p[1 - k]) for p in polygon(contour)]
    sides = zip(points, points[1:] + points[:1])
    ys = sorted(
        a[1] + (x - a[0]) * (b[1] - a[1]) / (b[0] - a[0]) for a, b in sides if (a[0] < x) != (b[0] < x)
    )
    return sum(high - low for low, high in zip(ys[::2], ys[1::2]))


def area_at(part: Part, k: int, x: float) -> float:
    """Of the part cut across axis k at x, mm2: the stock's rectangle less what pockets and the holes on the
    plane take off."""
    body = part.body
    area = (length_at(body.outer, k, x) - sum(length_at(c, k, x) for c in body.openings)) * body.thickness
    for f in part.features:
        if isinstance(f, Pocket):
            lengths = [length_at(in_part(f, c), k, x) for c in (f.contour, *f.island)]
            area -= (lengths[0] - sum(lengths[1:])) * f.depth
        elif not f.axis[k] and isclose(f.at[k], x, abs_tol=1e-9):
            wide, deep = f.counterbore or (f.diameter, 0.0)
            cone = drill_point_height(f.diameter) if f.drill_point else 0.0
            area -= f.diameter * (f.depth + cone / 2) + (wide - f.diameter) * deep
    return area


def svg_hatching(sheet) -> list[tuple[float, float, float, float]]:
    """Hatching lines of the written SVG, y upwards."""
    text = svg_bytes(sheet).decode()
    path = re.search(r'<path class="hatch" [^>]*stroke-width="0.25" d="([^"]*)"', text)[1]
    lines = [tuple(map(float, re.findall(r"[\d.]+", piece))) for piece in path.split("M")[1:]]
    return [(x0, sheet.size[1] - y0, x1, sheet.size[1] - y1) for x0, y0, x1, y1 in lines]


@pytest.mark.parametrize("number", [*CUT, ACROSS_Y])
def test_the_hatching_has_the_area_of_the_cut_part(number, orders, sheets):
    """Of the written file: lines at 45 degrees, equally spaced, whose length times their spacing is the
    face's area as the description gives it; and the face's polygons have that area to the last digits."""
    sheet, f = sheets[number], scale_of(sheets[number])
    meant = area_at(orders[number].part, number == ACROSS_Y, plane_of(orders[number]))
    loops = face_of(sheet).loops
    enclosed = [
        abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in pairwise([*loop, loop[0]]))) / 2 for loop in loops
    ]
    inner = [any(Hatch((other,)).holds(loop[0]) for other in loops if other is not loop) for loop in loops]
    assert sum(-a if i else a for a, i in zip(enclosed, inner)) / f**2 == pytest.approx(meant, rel=1e-5)
    lines = svg_hatching(sheet)
    offsets = sorted({round((y0 - x0) / sqrt(2), 2) for x0, y0, _, _ in lines})
    spacing = min(b - a for a, b in pairwise(offsets) if b - a > 0.1)
    assert spacing >= 0.7  # ISO 128-2
    for x0, y0, x1, y1 in lines:
        assert y1 - y0 == pytest.approx(x1 - x0, abs=2.1e-3)  # written to a thousandth
        steps = ((y0 - x0) / sqrt(2) - offsets[0]) / spacing
        assert abs(steps - round(steps)) < 0.15
    hatched = sum(hypot(x1 - x0, y1 - y0) for x0, y0, x1, y1 in lines) * face_of(sheet).spacing
    assert hatched / f**2 == pytest.approx(meant, rel=0.02)


def test_the_hatching_lies_in_the_material_everywhere(orders, sheets):
    """Points along the lines, taken back into the part, against the kernel's solid: inside the material,
    every one."""
    from OCP.BRepClass3d import BRepClass3d_SolidClassifier
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_IN

    from tactcad.solids.step import from_bytes

    for number in ("holder-body", "cart-plate", "tip-flat"):
        order, sheet, f = orders[number], sheets[number], scale_of(sheets[number])
        classifier = BRepClass3d_SolidClassifier(from_bytes(order.shape))
        view = next(v for v in prism_plan(order.part, ()).views if v.section)
        (u0, v0, _, v1), loops = view.box, face_of(sheet).loops
        us, vs = zip(*(p for loop in loops for p in loop))
        # the cut face spans the part in the view's upright direction, and begins at its left
        assert max(vs) - min(vs) == pytest.approx((v1 - v0) * f)
        tried = 0
        for (ax, ay), (bx, by) in face_of(sheet).chords():
            for share in (0.02, 0.3, 0.7, 0.98):
                u = (ax + share * (bx - ax) - min(us)) / f + u0
                v = (ay + share * (by - ay) - min(vs)) / f + v0
                at = [view.right[i] * u + view.up[i] * v for i in range(3)]
                at[0] = view.section.at
                classifier.Perform(gp_Pnt(*at), 1e-6)
                assert classifier.State() == TopAbs_IN, (number, at)
                tried += 1
        assert tried > 100


def test_a_cut_thread_is_drawn_as_iso_6410_says(sheets):
    """M6, 10 deep, in the roller's tip at 5:1: thin lines 15 mm from the axis on hatched ground, 50 mm long;
    a thick line across at their end; hatching up to the drilled hole, 12.5 mm from the axis."""
    sheet = sheets["tip-roller"]
    label = next(t for t in sheet.texts if t.text == "S-S")
    axis = label.at[0]
    strokes = [i for i in sheet.items if isinstance(i, Stroke) and i.role == "outline"]
    thin = [s.points for s in strokes if s.line.width == 0.25 and len(s.points) == 2]
    upright = [(a, b) for a, b in thin if isclose(a[0], b[0], abs_tol=1e-6) and abs(a[0] - axis) < 20.0]
    assert sorted(round(a[0] - axis, 3) for a, _ in upright) == [-15.0, 15.0]
    assert all(dist(a, b) == pytest.approx(50.0) for a, b in upright)
    end = min(p[1] for line in upright for p in line)
    thick = [
        s.points
        for s in strokes
        if s.line.width == 0.5 and all(isclose(p[1], end, abs_tol=1e-6) for p in s.points)
    ]
    assert [sorted(round(p[0] - axis, 3) for p in line) for line in thick] == [[-15.0, 15.0]]
    beside = [abs(x - axis) for chord in face_of(sheet).chords() for x, y in chord if y > end]
    assert min(beside) == pytest.approx(12.5, abs=1e-3)


# --- how it is marked ---


def test_letters_stand_once_at_each_end_and_once_over_the_section(orders, sheets):
    for number in (*CUT, ACROSS_Y):
        (runs,) = pdf_runs(pdf_bytes([sheets[number]], "t", "a", "2026-11-21"))
        assert runs.count("S") == 2 and runs.count("S-S") == 1, number
        assert layout_faults(sheets[number]) == []
    for number in WHOLE:
        (runs,) = pdf_runs(pdf_bytes([sheets[number]], "t", "a", "2026-11-21"))
        assert "S" not in runs and "S-S" not in runs


def test_the_plane_is_marked_where_the_part_is_cut(orders, sheets):
    """Thick ends outside the front view's outline at the plane, arrows to the right: what is seen from the
    left stands there."""
    for number in CUT:
        order, sheet, f = orders[number], sheets[number], scale_of(sheets[number])
        ends = [
            i for i in sheet.items if isinstance(i, Stroke) and i.role == "cutting" and i.line.width == 0.5
        ]
        heads = [i for i in sheet.items if isinstance(i, Fill) and i.role == "cutting"]
        assert len(ends) == len(heads) == 2
        (x,) = {round(p[0], 6) for end in ends for p in end.points}
        x0, y0, x1, y1 = order.part.body.outer.box
        way = prism_plan(order.part, ()).views[0].right[0]
        left = x - f * (plane_of(order) - x0 if way > 0 else x1 - plane_of(order))
        low, high = sorted(p[1] for end in ends for p in end.points)[1:3]
        assert high - low == pytest.approx((y1 - y0) * f + 3.0)  # a millimetre and a half off the outline
        # the front view's outline is where the plane says that it is
        edges = [c for i in sheet.items if isinstance(i, Stroke) and i.role == "outline" for c in i.chords()]
        if order.part.body.outer.as_circle() is None:
            assert [
                1 for a, b in edges if isclose(a[0], left, abs_tol=1e-6) and isclose(b[0], left, abs_tol=1e-6)
            ], number
        for head in heads:
            tip, *back = head.points
            assert all(p[0] < tip[0] for p in back) and tip[0] == pytest.approx(x, abs=0.3)
        letters = [t for t in sheet.texts if t.text == "S"]
        assert all(t.at[0] < x for t in letters)
        assert min(p[0] for loop in face_of(sheet).loops for p in loop) > left + f * (x1 - x0)


def test_a_plane_across_y_is_seen_from_the_free_side(orders, sheets):
    """The bar has its end view below the front view: the section is seen from below, so it stands above
    (first angle)."""
    sheet, f = sheets[ACROSS_Y], scale_of(sheets[ACROSS_Y])
    ends = [
        i.points for i in sheet.items if isinstance(i, Stroke) and i.role == "cutting" and i.line.width == 0.5
    ]
    heads = [i.points for i in sheet.items if isinstance(i, Fill) and i.role == "cutting"]
    (y,) = {round(p[1], 6) for end in ends for p in end}
    x0, y0, x1, y1 = orders[ACROSS_Y].part.body.outer.box
    left, right = sorted(p[0] for end in ends for p in end)[1:3]
    assert right - left == pytest.approx((x1 - x0) * f + 3.0)
    assert len(heads) == 2 and all(
        tip[1] > p[1] and tip[1] == pytest.approx(y, abs=0.3) for tip, *back in heads for p in back
    )
    xs, ys = zip(*(p for loop in face_of(sheet).loops for p in loop))
    assert (min(xs), max(xs)) == pytest.approx((left + 1.5, right - 1.5))  # in line with the front view
    assert min(ys) > y + f * (y1 - plane_of(orders[ACROSS_Y]))


def test_without_a_place_for_it_the_sheet_goes_without(orders, monkeypatch):
    order = orders["holder-lid"]
    monkeypatch.setattr(compose, "mark_plane", lambda *_: False)
    plain = part_sheet(order)
    assert face_of(plain) is None and layout_faults(plain) == []
    assert not [t for t in plain.texts if t.text in ("S", "S-S")]
    assert [i for i in plain.items if isinstance(i, Stroke) and i.role == "hidden"]
    assert part_sheet(order) == plain


@pytest.mark.slow  # processes; by day test_sheet_writers.py
def test_equal_bytes_in_other_processes(orders, tmp_path):
    some = [orders[n] for n in ("holder-body", "tip-flat")]
    here = [hashlib.sha256(w.pdf + w.svg).hexdigest() for w in map(written, some)]
    (tmp_path / "orders").write_bytes(pickle.dumps(some))
    script = (
        "import hashlib, pickle, sys\nfrom tactcad.drawing.parts.part_sheet import written\n"
        "done = [written(o) for o in pickle.load(open(sys.argv[1], 'rb'))]\n"
        "print(*(hashlib.sha256(d.pdf + d.svg).hexdigest() for d in done))"
    )
    environment = {**os.environ, "PYTHONHASHSEED": "5", "PYTHONPATH": str(Path(tactcad.__file__).parents[1])}
    run = subprocess.run(
        [sys.executable, "-c", script, tmp_path / "orders"],
        capture_output=True,
        text=True,
        check=True,
        env=environment,
    )
    assert run.stdout.split() == here


# --- leaders ---


def leaders_of(sheet) -> dict[str, list[tuple]]:
    """Leader lines by their callout's first text, tip first: an arrow, an inclined line, a shelf, the
    texts."""
    found, lines = {}, []
    for item in sheet.items:
        if isinstance(item, Stroke) and item.role == "leader" and len(item.points) == 2:
            lines.append(item.points)
        elif isinstance(item, Text) and lines:
            found[item.text] = lines[-2:]
            lines = []
    return found


def test_a_radius_is_called_out_from_its_own_side(orders, sheets):
    """The plenum's corners: the leader does not run through the plenum."""
    (tip, elbow), _ = leaders_of(sheets["holder-body"])["8× R5"]
    f, order = scale_of(sheets["holder-body"]), orders["holder-body"]
    plenum = next(c for c in order.part.features if c.name == "plenum")
    ends = sorted(
        p
        for i in sheets["holder-body"].items
        if isinstance(i, Stroke) and i.role == "cutting" and i.line.width == 0.5
        for p in i.points
    )
    (x, low), (_, high) = ends[
        1:3
    ]  # the plane goes through the plenum's middle, and stands out as far above as below
    middle = (x, (low + high) / 2)
    hole = Hatch((tuple((middle[0] + f * x, middle[1] + f * y) for x, y in polygon(plenum.contour)),))
    assert not [
        k
        for k in range(2, 100)
        if hole.holds((tip[0] + (elbow[0] - tip[0]) * k / 100, tip[1] + (elbow[1] - tip[1]) * k / 100))
    ]
    assert min(dist(tip, side[0]) for side in hole.outlines()) < 0.1


def test_no_leader_runs_along_another_line(sheets):
    for number, sheet in sheets.items():
        others = [
            c
            for i in sheet.items
            if isinstance(i, Stroke) and i.role in ("centre", "extension", "outline", "dimension")
            for c in i.chords()
        ]
        for text, lines in leaders_of(sheet).items():
            for (ax, ay), (bx, by) in lines[:1]:
                length = hypot(bx - ax, by - ay)
                for p, q in others:
                    off = [abs((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / length for x, y in (p, q)]
                    along = sorted(((bx - ax) * (x - ax) + (by - ay) * (y - ay)) / length for x, y in (p, q))
                    shared = min(along[1], length) - max(along[0], 0.0)
                    assert max(off) > 0.2 or shared < 1.0, (number, text)
