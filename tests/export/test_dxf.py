"""Cut files are read back as plain text, by ezdxf, and after damage that the gate must see."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from dataclasses import replace
from math import cos, dist, hypot, pi, radians, sin

import ezdxf
import pytest

from tactcad.contour import Arc, Contour, Corner, Line, circle, rectangle, rounded_polygon
from tactcad.export.dxf import CutFile, check_dxf, dxf_bytes, read_dxf
from tactcad.parts.language.description import Extrusion, Hole, Material, Part

ALUMINIUM = Material("7075", 2810.0)


def rounded(x0: float, y0: float, scale: float) -> Contour:
    """Slotted outline with convex and concave fillets, none of its coordinates a short decimal."""
    corners = [
        (0, 0, 0.3),
        (20 / 3, 0, 0),
        (20 / 3, 8, 0.7),
        (3, 8, 0),
        (3, 4, 0.5),
        (2, 4, 0.5),
        (2, 8, 0),
        (0, 8, 0.1),
    ]
    return rounded_polygon([Corner((x0 + x * scale, y0 + y * scale), r * scale) for x, y, r in corners])


def slanted() -> Contour:
    """Corners that are no right angles, so that arcs end at any angle."""
    corners = [(0, 0, 0.31), (11.3, 1.7, 0.77), (9.1, 6.3, 0.2), (4.4, 3.9, 1.1), (1.2, 7.7, 0.15)]
    return rounded_polygon([Corner((x, y), r) for x, y, r in corners])


def lens() -> Contour:
    """Two arcs that meet in two points."""
    a, b = (0.0, 0.0), (6.0, 0.0)
    return Contour((Arc(a, b, (3.0, 4.0), True), Arc(b, a, (3.0, -4.0), True)))


def half_moon() -> Contour:
    return Contour((Line((0.0, 0.0), (4.0, 0.0)), Arc((4.0, 0.0), (0.0, 0.0), (2.0, 0.0), True)))


OUTLINES = {
    "square": rectangle(0, 0, 30, 20),
    "rounded": rounded(0.1, 0.2, 1.0),
    "far away": rounded(1234.567, -987.654, 3.7),
    "clockwise": rounded(0.1, 0.2, 1.0).reversed(),
    "slanted": slanted(),
    "lens": lens(),
    "half moon": half_moon(),
    "disc": circle((1 / 3, 2 / 3), 10.1),
    "left of zero": rectangle(-3, -2, 0, 0),
}


def part(outer: Contour, openings: tuple[Contour, ...] = (), features: tuple = ()) -> Part:
    return Part("E-4", "element", "wire-cut", ALUMINIUM, Extrusion(outer, 3.0, openings), features)


@pytest.fixture(params=OUTLINES)
def outline(request) -> Contour:
    return OUTLINES[request.param]


def written(tmp_path, made: Part):
    path = tmp_path / "part.dxf"
    path.write_bytes(dxf_bytes(made))
    return path


def entities_of_text(data: bytes) -> list[dict[str, str]]:
    """Entities section by group codes alone; the first value of each code, as text."""
    lines = data.decode("ascii").split("\n")
    pairs = [(code.strip(), value) for code, value in zip(lines[::2], lines[1::2])]
    start = pairs.index(("2", "ENTITIES"))
    end = pairs.index(("0", "ENDSEC"), start)
    found: list[dict[str, str]] = []
    for code, value in pairs[start + 1 : end]:
        if code == "0":
            found.append({"type": value})
        else:
            found[-1].setdefault(code, value)
    return found


def ends(entity: dict[str, str]) -> list[tuple[float, float]]:
    """Start and end as any reader computes them from the text."""
    if entity["type"] == "LINE":
        return [(float(entity["10"]), float(entity["20"])), (float(entity["11"]), float(entity["21"]))]
    x, y, r = (float(entity[code]) for code in ("10", "20", "40"))
    return [
        (x + r * cos(radians(float(entity[c]))), y + r * sin(radians(float(entity[c])))) for c in ("50", "51")
    ]


def area(file: CutFile) -> float:
    return file.outer.area - sum(c.area for c in file.openings)


def test_what_is_written_is_read_back(tmp_path, outline):
    made = part(outline, (circle(outline.centroid, 0.01),))
    path = written(tmp_path, made)
    assert check_dxf(path, made) == []
    file = read_dxf(path)
    assert area(file) == pytest.approx(made.body.section_area, rel=1e-12)
    assert file.outer.length + sum(c.length for c in file.openings) == pytest.approx(
        made.body.cut_length, rel=1e-12
    )
    assert len(file.openings) == 1


def test_the_text_is_a_chain_head_to_tail(outline):
    entities = entities_of_text(dxf_bytes(part(outline)))
    assert {e["type"] for e in entities} <= {"LINE", "ARC", "CIRCLE"}
    assert {e["8"] for e in entities} == {"CUT"}
    assert all(float(e.get("30", 0)) == float(e.get("31", 0)) == 0.0 for e in entities)
    if entities[0]["type"] == "CIRCLE":
        return
    for a, b in zip(entities, entities[1:] + entities[:1]):
        if a["type"] == b["type"] == "LINE":
            assert (a["11"], a["21"]) == (b["10"], b["20"])  # the same text, so the same bits
        else:
            assert min(dist(p, q) for p in ends(a) for q in ends(b)) < 1e-9


def test_no_entity_is_written_twice_for_an_opening_inside_an_outline():
    made = part(rectangle(0, 0, 30, 20), (rectangle(1, 1, 5, 5), circle((20, 10), 3.4)))
    kinds = [e["type"] for e in entities_of_text(dxf_bytes(made))]
    assert kinds == ["LINE"] * 4 + ["CIRCLE"] + ["LINE"] * 4  # openings first: the outline frees the part


def test_through_holes_belong_to_the_section_and_others_do_not(tmp_path):
    up = (0.0, 0.0, 1.0)
    through = Hole("m3", (5.0, 5.0, 0.0), up, 3.4, 3.0, True)
    blind = Hole("blind", (15.0, 5.0, 0.0), up, 3.4, 2.0, False)
    across = Hole("across", (0.0, 5.0, 1.5), (1.0, 0.0, 0.0), 1.0, 30.0, True)
    made = part(rectangle(0, 0, 30, 20), (), (through, blind, across))
    assert check_dxf(written(tmp_path, made), made) == []
    assert area(read_dxf(written(tmp_path, made))) == pytest.approx(600 - pi * 1.7**2, rel=1e-14)


FRESH = """
import hashlib, sys
from test_dxf import OUTLINES, part
from tactcad.export.dxf import dxf_bytes
print(hashlib.sha256(dxf_bytes(part(OUTLINES["slanted"]))).hexdigest())
"""


def test_equal_bytes_in_fresh_processes(tmp_path):
    digests = {hashlib.sha256(dxf_bytes(part(OUTLINES["slanted"]))).hexdigest()}
    for seed, zone in (("0", "UTC"), ("123", "Asia/Tokyo")):
        home = tmp_path / seed
        home.mkdir()
        environment = {**os.environ, "PYTHONHASHSEED": seed, "TZ": zone, "HOME": str(home), "LC_ALL": "C"}
        environment.pop("XDG_CACHE_HOME", None)
        run = subprocess.run(
            [sys.executable, "-c", FRESH],
            cwd=os.path.dirname(__file__),
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        digests.add(run.stdout.strip())
    assert len(digests) == 1


def test_header_is_metric_and_ezdxf_finds_nothing_to_repair(tmp_path):
    drawing = ezdxf.readfile(written(tmp_path, part(OUTLINES["rounded"])))
    assert drawing.dxfversion == "AC1015"
    assert (drawing.header["$INSUNITS"], drawing.header["$MEASUREMENT"]) == (4, 1)
    audit = drawing.audit()
    assert not audit.errors
    assert not audit.fixes


# Damage that the gate must see: each takes the drawing of a part and spoils it.


def moved_end(space):
    space.query("LINE")[0].dxf.end += (0, 2e-6, 0)


def moved_within_closing(space):
    space.query("ARC")[0].dxf.radius += 1e-8


def doubled(space):
    copy = space.query("LINE")[0].copy()
    space.add_entity(copy)


def lifted(space):
    line = space.query("LINE")[0]
    line.dxf.start, line.dxf.end = line.dxf.start + (0, 0, 1), line.dxf.end + (0, 0, 1)


def text_added(space):
    space.add_text("E-4")


def other_layer(space):
    space.query("ARC")[0].dxf.layer = "0"


def swapped_order(space):
    a = space.query("LINE")[0]
    space.unlink_entity(a)
    space.add_entity(a)


def inches(space):
    space.doc.header["$INSUNITS"] = 1


def imperial(space):
    space.doc.header["$MEASUREMENT"] = 0


def hole_lost(space):
    space.delete_entity(space.query("CIRCLE")[0])


def hole_grown(space):
    space.query("CIRCLE")[0].dxf.radius += 1e-6


def everything_scaled(space):
    from ezdxf.math import Matrix44

    for entity in space:
        entity.transform(Matrix44.scale(1 + 1e-7))


def everything_shifted(space):
    for entity in space:
        entity.translate(1e-6, 0, 0)


def mirrored_extrusion(space):
    space.query("CIRCLE")[0].dxf.extrusion = (0, 0, -1)


def emptied(space):
    space.delete_all_entities()


def point_line(space):
    at = space.query("LINE")[0].dxf.start
    space.add_line(at, at, dxfattribs={"layer": "CUT"})


def doubled_hole(space):
    space.add_entity(space.query("CIRCLE")[0].copy())


def newer_version(space):
    space.doc.dxfversion = "AC1024"


def split_off(space):
    """The first line ends half a nanometre early, and another one goes the rest of the way."""
    first = next(e for e in space if e.dxftype() == "LINE")
    (x0, y0, _), (x1, y1, _) = first.dxf.start, first.dxf.end
    share = 5e-7 / hypot(x1 - x0, y1 - y0)
    between = (x1 - share * (x1 - x0), y1 - share * (y1 - y0))
    chain_order = [e for e in space if e.dxftype() != "CIRCLE"]
    n = chain_order.index(first)
    rest = chain_order[n + 1 :] + chain_order[:n]
    first.dxf.end = between
    space.add_line(between, (x1, y1), dxfattribs={"layer": "CUT"})
    for entity in rest:  # the file's order follows the chain
        space.unlink_entity(entity)
        space.add_entity(entity)


# what the gate says of each
DAMAGE = {
    moved_end: "the chain is open",
    moved_within_closing: "neighbours are 1e-08 mm apart",
    doubled: "is open",
    lifted: "something lies off Z=0",
    text_added: "is a TEXT",
    other_layer: "layers ['0', 'CUT'] instead of CUT alone",
    swapped_order: "the chain is open",
    inches: "$INSUNITS=1",
    imperial: "$MEASUREMENT=0",
    hole_lost: "0 openings instead of 1",
    hole_grown: "area of the opening 1",
    everything_scaled: "length of the outline",
    everything_shifted: "box of the outline",
    mirrored_extrusion: "something lies off Z=0",
    emptied: "the file is empty",
    point_line: "is open",
    doubled_hole: "two equal entities at",
    newer_version: "version AC1024 instead of AC1015",
    split_off: "entity without length at",
}


@pytest.mark.parametrize("damage", DAMAGE, ids=lambda f: f.__name__)
def test_damage_is_seen(tmp_path, damage):
    made = part(OUTLINES["rounded"], (circle((2.2, 2.2), 0.5),))
    path = written(tmp_path, made)
    drawing = ezdxf.readfile(path)
    damage(drawing.modelspace())
    drawing.saveas(path)
    assert any(DAMAGE[damage] in fault for fault in check_dxf(path, made))


def test_rewriting_without_damage_is_no_damage(tmp_path):
    made = part(OUTLINES["rounded"], (circle((2.2, 2.2), 0.5),))
    path = written(tmp_path, made)
    ezdxf.readfile(path).saveas(path)
    assert check_dxf(path, made) == []


def test_the_file_of_another_part_is_seen(tmp_path):
    made = part(OUTLINES["rounded"])
    other = replace(made, body=Extrusion(rounded(0.1, 0.2, 1.0 + 1e-6), 3.0))
    assert check_dxf(written(tmp_path, other), made)


@pytest.mark.parametrize("keep", [0.0, 0.3, 0.9])
def test_a_truncated_file_is_seen(tmp_path, keep):
    made = part(OUTLINES["rounded"])
    path = written(tmp_path, made)
    os.truncate(path, int(path.stat().st_size * keep))
    assert check_dxf(path, made)
