"""Everything that a page shows, as plain data, with the block of arrays that it points into."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from tactcad import __version__
from tactcad.design.family import family_of
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import CommonTables
from tactcad.export.shapes import Shapes
from tactcad.scenes import make_scene, overall_size, stated_size

from .facts import element_facts, finding_facts, part_facts, scene_facts
from .mesh_pack import MeshPack, mesh_pack

SCHEMA = "tactcad-review-1"
IDENTITY = ("name", "title", "revision", "date", "author", "organisation")


def review_record(
    design: CommonTables,
    scene_names: Sequence[str],
    shapes: Shapes,
    say: Callable[[int, int, str], None],
    sheets: Mapping[str, str],
) -> tuple[dict[str, Any], bytes]:
    """The record and the block, equal for equal input.

    Parameters
    ----------
    design
        Must keep its rules.
    scene_names
        The scenes to show, the first one first.
    shapes
        Makes solids, or takes them from its cache.
    say
        Receives (done, total, text) as the work goes on.
    sheets
        Drawing sheets (SVG) by part number.
    """
    scenes = tuple(make_scene(design, name) for name in scene_names)
    parts = list({part.part_no: part for scene in scenes for part in scene.parts}.values())
    total = len(parts) + 2
    say(0, total, "estimates and virtual builds")
    elements, made, lines = element_facts(design, scenes)
    done = iter(range(1, total))
    pack = mesh_pack(parts, shapes, lambda part_no: say(next(done), total, part_no))
    say(total - 1, total, "checks")
    findings = finding_facts(design, scenes, shapes, lambda *_: None)
    strains, block = _strains(design, pack)
    head = record_head(design)
    head["design"]["size"] = stated_size(overall_size(design))
    record = head | {
        "parts": [
            asdict(part_facts(part, made.variables, lines))
            | {"mesh": pack.table[part.part_no], "box": pack.boxes[part.part_no]}
            for part in parts
        ],
        "scenes": [asdict(scene_facts(design, scene)) for scene in scenes],
        "array": asdict(elements),
        "strains": strains,
        "findings": [asdict(f) for f in findings],
        "sheets": dict(sheets),
    }
    say(total, total, "done")
    return record, block


def record_head(design: CommonTables) -> dict[str, Any]:
    """The head of every record."""
    identity = {name: getattr(design.design, name) or "" for name in IDENTITY}
    return {"schema": SCHEMA, "tactcad": __version__, "design": identity}


def _strains(design: CommonTables, pack: MeshPack) -> tuple[dict[str, Any], bytes]:
    """The strain field's arrays by element part number, appended to the block."""
    family, block = family_of(design), pack.block
    layout, strain_field = family.layout(design), family.estimate.strain
    table: dict[str, Any] = {}
    if strain_field is None:
        return table, block
    for place, number, _ in family.parts(layout):
        if number in table:
            continue
        try:
            field = strain_field(layout, place)
        except CheckFailure as error:
            table[number] = {"why_not": str(error)}
            continue
        table[number] = {"load_arm": place.load_arm, "hinge_x": place.hinge_x, "hinge": place.hinge.t}
        for name, kind in (("points", "<f4"), ("moved", "<f4"), ("strain", "<f4"), ("quads", "<u4")):
            array = np.ascontiguousarray(getattr(field, name), kind)
            table[number][name] = (len(block), int(array.size))
            block += array.tobytes()
    return table, block
