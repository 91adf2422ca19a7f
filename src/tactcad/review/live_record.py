"""The page's record while a design is being written: what a second allows, and which numbers changed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from tactcad.design.tree import Design
from tactcad.export.inputs import flattened
from tactcad.export.shapes import Shapes
from tactcad.scenes import make_scene

from .element_facts import estimate_facts
from .mesh_pack import mesh_pack
from .part_facts import part_facts
from .review_record import record_head
from .scene_facts import scene_facts

# Of each element, as the page's panel calls them.
NUMBERS = (("stiffness", "K, N/mm"), ("rated_force", "rated, N"), ("yield_force", "yields at, N"))
LEFT_OUT = "Left out while live; `tactcad review` has it."


@dataclass(frozen=True)
class NumberChange:
    """A number of the model before and after, None where there is none; `about` names the designators."""

    about: str
    what: str
    before: Any
    after: Any


def live_record(design: Design, scene_name: str, shapes: Shapes) -> tuple[dict[str, Any], bytes]:
    """As `review_record` of one scene, without what takes seconds: checks, virtual builds and with them each
    requirement's variance, pictures of strain.

    Parameters
    ----------
    design
        Must keep its rules.
    scene_name
        The scene.
    shapes
        Makes solids, or takes them from its cache: parts that did not change are not meshed again.
    """
    scene = make_scene(design, scene_name)
    parts = list({part.part_no: part for part in scene.parts}.values())
    pack = mesh_pack(parts, shapes)
    array = estimate_facts(design)
    elements = {p.part.part_no for p in scene.placements if p.designator in array.elements}
    record = record_head(design) | {
        "parts": [
            asdict(part_facts(part, {}, []))
            | {"mesh": pack.table[part.part_no], "box": pack.boxes[part.part_no]}
            for part in parts
        ],
        "scenes": [asdict(scene_facts(design, scene))],
        "array": asdict(array),
        "strains": {number: {"why_not": LEFT_OUT} for number in sorted(elements)},
        "findings": [],
        "sheets": {},
    }
    return record, pack.block


def number_changes(
    old: tuple[Design, Mapping[str, Any]], new: tuple[Design, Mapping[str, Any]]
) -> list[NumberChange]:
    """What differs between two designs and their records: fields first, then the elements' estimates, equal
    changes of several elements as one, then masses."""
    before, after = (flattened(design) for design, _ in (old, new))
    fields = [
        NumberChange("", path, before.get(path), after.get(path))
        for path in (*after, *(p for p in before if p not in after))
        if before.get(path) != after.get(path)
    ]
    return [*fields, *_estimates(old[1], new[1]), *_masses(old[1], new[1])]


def _estimates(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[NumberChange]:
    before, after = (record["array"]["elements"] for record in (old, new))
    for name, shown in NUMBERS:
        same: dict[tuple[Any, Any], list[str]] = {}
        for designator in (*after, *(d for d in before if d not in after)):
            pair = (_number(before, designator, name), _number(after, designator, name))
            if pair[0] != pair[1]:
                same.setdefault(pair, []).append(designator)
        yield from (NumberChange(" ".join(who), shown, *pair) for pair, who in same.items())


def _number(elements: Mapping[str, Any], designator: str, name: str) -> float | None:
    estimate = elements.get(designator, {}).get("estimate")
    return estimate[name] if estimate else None


def _masses(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[NumberChange]:
    before, after = (_mass(record) for record in (old, new))
    if before != after:
        yield NumberChange(new["scenes"][0]["name"], "mass, g", before, after)


def _mass(record: Mapping[str, Any]) -> float:
    """Of all parts of the scene, g, to a milligram: the sum's last digits depend on the order."""
    mass = {part["part_no"]: part["mass_g"] for part in record["parts"]}
    return round(sum(mass[p["part_no"]] for p in record["scenes"][0]["placed"]), 3)
