"""A design's geometry record: parts, placements, bills of materials and stiffness, without a CAD kernel.

The record is plain data (dicts, lists, numbers, text) for golden files and for comparing designs. Lengths in
mm, rounded to a picometre so that equal designs give equal text on every machine.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from tactcad.contour import Arc, Contour, Line, Segment
from tactcad.design.family import family_of
from tactcad.design.tree import CommonTables
from tactcad.drawing.parts.part_sheet import notes_of
from tactcad.parts.language.description import NOT_MADE, Extrusion, Hole, ModelFile, Part, section
from tactcad.parts.language.stock import cut_section
from tactcad.parts.language.surface import surface_area
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.bom import bom_rows
from tactcad.scenes.scene import Scene

Record = dict[str, Any]

DIGITS = 9  # decimals; tolerances of the comparison start at the sixth
# Columns of a bill that are not compared: they name files and their order, or repeat the design's revision.
NOT_COMPARED = ("item", "part_no", "rev", "file", "sha256")


def all_scenes(design: CommonTables) -> list[Scene]:
    return [make_scene(design, name) for name in scene_names(design)]


def geometry(design: CommonTables, scenes: Sequence[Scene] | None = None) -> Record:
    """The record of a design that keeps its rules; `scenes`: all of its scenes, if already made.

    {parts: {part_no: ...}, scenes: {name: {placed, bom}}, elements: {E1: ...}}
    """
    scenes = all_scenes(design) if scenes is None else scenes
    parts = {part.part_no: part for scene in scenes for part in scene.parts}
    return {
        "parts": {
            no: part_record(part, max(s.count(part) for s in scenes)) for no, part in sorted(parts.items())
        },
        "scenes": {s.name: {"placed": _placed(s), "bom": bill(s)} for s in scenes},
        "elements": _rounded(family_of(design).estimate.golden(design)),
    }


def part_record(part: Part, qty: int) -> Record:
    """One part in its own frame: its numbers as in a manifest, its holes, pockets and contours."""
    file, cut = isinstance(part.body, ModelFile), cut_section(part)
    record = {
        "name": part.name,
        "process": part.process,
        "qty": qty,
        "volume_mm3": part.volume,
        "area_mm2": surface_area(part),
        "mass_g": part.mass,
        "centre_mm": None if file else part.centre,
        "box_mm": None if file else part.body.box,
        "cut_length_mm": cut.cut_length if cut else None,
        "holes": _numbered([_hole(f) for f in part.features if isinstance(f, Hole)] + _round_openings(part)),
        "pockets": _numbered(
            [
                {
                    "name": f.name,
                    "at_mm": f.at,
                    "axis": f.axis,
                    "area_mm2": f.volume / f.depth,
                    "depth_mm": f.depth,
                }
                for f in part.features
                if not isinstance(f, Hole)
            ]
        ),
        "limits": {
            c.name: {"nominal_mm": c.nominal, "upper_mm": c.upper, "lower_mm": c.lower, "key": c.key}
            for c in part.characteristics
        },
        "contours": [contour_record(c) for c in contours(part)],
    }
    return _rounded(record if part.process in NOT_MADE else record | {"sheet": _sheet(part)})


def _sheet(part: Part) -> Record:
    """What its sheet says besides shape and limits."""
    return {
        "material": str(part.material),
        "finish": part.finish,
        "notes": notes_of(part, ()),
        "features": [(c.name, c.between, c.remark) for c in part.characteristics],
        "datums": [(d.letter, d.feature) for d in part.datums],
        "zones": [(g.name, g.symbol, g.zone, g.round, g.features, g.datums) for g in part.geometric],
    }


def contours(part: Part) -> tuple[Contour, ...]:
    """Outline and openings of an extruded part in (x, y), the profile of a turned one in (radius, z)."""
    if isinstance(part.body, ModelFile):
        return ()
    if isinstance(part.body, Extrusion):
        outer, openings = section(part)
        return (outer, *openings)
    return (part.body.profile,)


def contour_record(contour: Contour) -> list[list[float]]:
    """A contour as rows: a line is x0, y0, x1, y1; an arc has its centre and +1 (ccw) or -1 after them."""
    rows = []
    for s in contour:
        row = [*s.start, *s.end]
        if isinstance(s, Arc):
            row += [*s.centre, 1.0 if s.ccw else -1.0]
        rows.append(row)
    return _rounded(rows)


def contour_of(rows: list[list[float]]) -> Contour:
    """The contour from such rows. Raises ValueError or TypeError if they are none."""

    def segment(row: list[float]) -> Segment:
        x0, y0, x1, y1, *arc = row
        if not arc:
            return Line((x0, y0), (x1, y1))
        x, y, turn = arc
        return Arc((x0, y0), (x1, y1), (x, y), turn > 0)

    return Contour(tuple(segment(row) for row in rows))


def bill(scene: Scene) -> Record:
    """The scene's bill of materials by part number, without files and digests."""
    rows = bom_rows(scene, None, {})
    return {row.part_no: _rounded(bill_line(asdict(row))) for row in rows}


def bill_line(row: Record) -> Record:
    """Without the designators of supplies: a circuit's are its netlist's, which only an export writes."""
    line = {name: value for name, value in row.items() if name not in NOT_COMPARED}
    return line if row.get("has_solid") else line | {"designators": ""}


def _placed(scene: Scene) -> Record:
    return {
        p.designator: _rounded({"part_no": p.part.part_no, "origin_mm": p.origin, "rotation": p.rotation})
        for p in scene.placements
    }


def _hole(hole: Hole) -> Record:
    return {
        "name": hole.name,
        "at_mm": hole.at,
        "axis": hole.axis,
        "diameter_mm": hole.diameter,
        "depth_mm": hole.depth,
        "through": hole.through,
        "counterbore_mm": hole.counterbore,
        "thread": hole.thread,
        "thread_depth_mm": hole.thread_depth,
        "drill_point": hole.drill_point,
        "tolerance": hole.tolerance,
    }


def _round_openings(part: Part) -> list[Record]:
    if not isinstance(part.body, Extrusion):
        return []
    round_ones = []
    for opening in part.body.openings:
        circle = opening.as_circle()
        if circle:
            (x, y), radius = circle
            name = opening.segments[0].name or "opening"
            round_ones.append(
                {"name": name, "at_mm": (x, y, 0.0), "diameter_mm": 2 * radius, "through": True}
            )
    return round_ones


def _numbered(features: list[Record]) -> Record:
    """Entries by name and a count over equal names: "screw_hole 2"."""
    seen: dict[str, int] = {}
    named = {}
    for feature in features:
        name = feature.pop("name")
        seen[name] = seen.get(name, 0) + 1
        named[f"{name} {seen[name]}"] = feature
    return named


def _rounded(value: Any) -> Any:
    """Plain data with numbers rounded; tuples as lists, as JSON gives them back."""
    if isinstance(value, dict):
        return {k: _rounded(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(v) for v in value]
    if isinstance(value, float):
        return round(value, DIGITS) + 0.0  # no negative zero
    return value
