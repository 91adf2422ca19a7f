"""Whether a JSON value is a golden file's record: sections, kinds of values, contours that close."""

from __future__ import annotations

from typing import Any

from .geometry import contour_of

# What stands in a part's record besides plain values.
TABLES = ("holes", "pockets", "limits")


def faults(record: Any, schema: str) -> str:
    """The first fault, "" where there is none."""
    if not isinstance(record, dict) or record.get("schema") != schema:
        return f"its schema is not {schema}"
    if not all(isinstance(record.get(k), str) for k in ("design", "revision")):
        return "it has no design or no revision"
    for section in ("parts", "scenes", "elements"):
        if not _is_table_of(record.get(section), dict):
            return f"{section} is no table of tables"
    if unknown := set(record) - {"schema", "design", "revision", "parts", "scenes", "elements"}:
        return f"{sorted(unknown)[0]!r} is not known"
    for number, part in record["parts"].items():
        if wrong := _part_fault(part):
            return f"part {number}: {wrong}"
    for name, scene in record["scenes"].items():
        if set(scene) != {"placed", "bom"} or not all(_is_table_of(t, dict) for t in scene.values()):
            return f"scene {name}: has other tables than placed and bom"
        if not all(_is_flat(row) for table in scene.values() for row in table.values()):
            return f"scene {name}: a row holds more than plain values"
    deep = next((name for name, row in record["elements"].items() if not _is_flat(row)), None)
    return "" if deep is None else f"element {deep}: holds more than plain values"


def _part_fault(part: dict[str, Any]) -> str:
    if not isinstance(part.get("process"), str):
        return "it has no process"
    for name in TABLES:
        if not _is_table_of(part.get(name), dict) or not all(map(_is_flat, part[name].values())):
            return f"{name} is no table of plain rows"
    contours = part.get("contours")
    if not isinstance(contours, list):
        return "it has no contours"
    for rows in contours:
        lists = isinstance(rows, list) and rows and all(isinstance(row, list) for row in rows)
        if not lists or not all(_is_number(value) for row in rows for value in row):
            return "a contour is no list of rows of numbers"
        try:
            contour_of(rows)
        except ValueError as error:
            return f"a contour cannot be read: {error}"
    rest = {k: v for k, v in part.items() if k not in (*TABLES, "contours")}
    return "" if _is_flat(rest) else "it holds more than plain values"


def _is_table_of(value: Any, kind: type) -> bool:
    return isinstance(value, dict) and all(isinstance(v, kind) for v in value.values())


def _is_flat(row: dict[str, Any]) -> bool:
    return all(_is_plain(value) for value in row.values())


def _is_plain(value: Any) -> bool:
    """A number, text, truth value or null, or a list of such, or a list of lists of numbers."""
    if isinstance(value, list):
        return all(_is_plain(v) for v in value)
    return value is None or isinstance(value, str | bool) or _is_number(value)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
