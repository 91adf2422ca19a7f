"""One value of a design file by its path, as messages name it: "element.hinge_thickness",
"element.override.3.arm_height", "array.row_arms[0][2]"."""

from __future__ import annotations

import dataclasses
import re
from dataclasses import replace
from typing import Any

from tactcad.design.family import family_of
from tactcad.design.fields import NumberRows, Numbers, Spec
from tactcad.design.load import paths
from tactcad.design.tree import CommonTables, Hinge

_PLACE = re.compile(r"(?P<field>[^\[\]]+)(?P<places>(?:\[(?:0|[1-9][0-9]{0,3})\])*)")
_OVERRIDE = re.compile(r"override\.(?P<number>[1-9][0-9]{0,3})\.(?P<name>\w+)")


def spec_at(design: CommonTables, path: str) -> Spec | None:
    """Spec of the field at that path; None if there is no such field, or no such place in its list."""
    found = _PLACE.fullmatch(path)
    if not found:
        return None
    field, places = found["field"], _places(path)
    spec = _spec(design, field)
    value: Any = paths(design).get(field) if places else None
    for place in places:
        if not isinstance(spec, (NumberRows, Numbers)) or value is None or place >= len(value):
            return None
        spec, value = spec.row if isinstance(spec, NumberRows) else spec.item, value[place]
    return spec


def value_at(design: CommonTables, path: str) -> Any:
    """The design's own value there, None if it gives none."""
    field = path.partition("[")[0]
    known = paths(design)
    if field not in known and field.startswith("element.override."):
        field = f"element.{field.rpartition('.')[2]}"  # what an override leaves out is [element]'s
    value: Any = known.get(field)
    for place in _places(path):
        value = value[place]
    return value


def placed(table: dict[str, Any], design: CommonTables, path: str, value: Any) -> dict[str, Any]:
    """A copy of a design's table with that value at the path; the rest is shared with the original.

    Parameters
    ----------
    table
        As TOML gives it.
    design
        The design read from it, for lists that it leaves to their default.
    path, value
        As `spec_at` knows it.
    """
    field, places = path.partition("[")[0], _places(path)
    head, *names = field.split(".", 2 if field.startswith("stop.gaps.") else -1)
    out = dict(table)
    node = out[head] = dict(out.get(head, {}))
    for name in names[:-1]:
        node[name] = dict(node.get(name, {}))
        node = node[name]
    whole = node.get(names[-1], paths(design).get(field)) if places else None
    node[names[-1]] = _replaced(whole, places, value) if places else value
    return out


def with_value(design: CommonTables, path: str, value: Any) -> CommonTables:
    """A copy of a design with that value at the path, unchecked: for arithmetic it may be an array, and then
    it is many designs. The stop's own gaps stay as they are."""
    section, _, name = path.partition(".")
    field, places, table = name.partition("[")[0], _places(path), getattr(design, section)
    if own := _OVERRIDE.fullmatch(field):
        number = int(own["number"])
        changed = replace(table.override.get(number, Hinge()), **{own["name"]: value})
        return replace(design, **{section: replace(table, override=table.override | {number: changed})})
    if "." in field:
        return design
    new = _replaced(getattr(table, field), places, value) if places else value
    return replace(design, **{section: replace(table, **{field: new})})


def _spec(design: CommonTables, field: str) -> Spec | None:
    section, _, name = field.partition(".")
    kind = family_of(design).tables.get(section)
    if kind is None:
        return None
    if section == "element" and (override := _OVERRIDE.fullmatch(name)):
        kind, name = Hinge, override["name"]
    if section == "stop" and re.fullmatch(r"gaps\.[0-9.]+", name):
        name = "gaps"
    elif (section, name) == ("stop", "gaps"):
        return None
    known = {f.name: f for f in dataclasses.fields(kind)}.get(name)
    return known.metadata.get("spec") if known else None


def _places(path: str) -> list[int]:
    return [int(place) for place in re.findall(r"\[([0-9]+)\]", path)]


def _replaced(whole: Any, places: list[int], value: Any) -> list:
    """A copy of a list, or of a list of lists, with the value at its place."""
    out = list(whole)
    first, *rest = places
    out[first] = _replaced(out[first], rest, value) if rest else value
    return out
