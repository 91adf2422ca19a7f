"""The design file's fields as text and as JSON Schema, read off the parameter tree."""

from __future__ import annotations

import dataclasses
import textwrap
from collections.abc import Iterator
from typing import Any

from .family import Family, all_families, optional_tables
from .fields import Spec
from .messages import InputError, one_of
from .tree import CommonTables, Element, Hinge, Identity, Issue

# Tables within tables: the name in texts, the class, and the names in the file.
INNER: dict[type, tuple[str, type, str]] = {
    Element: ("element.override.N", Hinge, "^[1-9][0-9]{0,3}$"),
    Identity: ("design.unchanged.LETTER", Issue, "^[A-Z]{1,2}$"),
}
TEXT_ORIGIN = (
    '[origin] holds the source of any value by its path, as "element.pad_length" = "paper: 2 x 3 mm2".'
)


def fields_of(kind: type) -> list[tuple[str, Spec, str]]:
    """Name, spec and default (as text) of every field of a table; override tables are left out."""
    specs = [f for f in dataclasses.fields(kind) if "spec" in f.metadata]
    return [(f.name, f.metadata["spec"], _default(f)) for f in specs]


def _default(f: dataclasses.Field) -> str:
    if f.default is dataclasses.MISSING:
        return "required"
    if f.default is None:
        return f"derived: {f.metadata['derived']}" if f.metadata["derived"] else "as in [element]"
    if isinstance(f.default, tuple):
        return str(list(f.default))
    return f"{f.default:g}" if isinstance(f.default, float) else str(f.default)


def _one(table: str) -> tuple[type, bool]:
    """Class of a table of any family, and whether it may be left out. Raises InputError."""
    known: dict[str, tuple[type, bool]] = {}
    for f in all_families().values():  # of tables of one name the first family's
        known |= {n: (kind, n in optional_tables(f.spec)) for n, kind in f.tables.items() if n not in known}
    known |= {name.rpartition(".")[0]: (kind, True) for name, kind, _ in INNER.values()}
    if table not in known:
        raise InputError("TABLE", "unknown", value=table, legal=one_of(table, (*known, "target", "study")))
    return known[table]


def text_schema(table: str | None = None) -> str:
    """Every table, or one, with its fields: name, default, legal values, meaning."""
    if table is not None:
        kind, spare = _one(table)
        return "\n".join(table_text(table, kind, spare)[:-1])
    lines = [
        "Lengths in mm, forces in N, stresses in MPa, density in kg/m3 unless a field says otherwise.",
        "",
    ]
    for family, tables in tables_by_family():
        if lines[2:]:
            lines += [f"Tables of {family.name}, besides those of every family:", ""]
        lines += [line for table in tables for line in table_text(*table)]
    return "\n".join([*lines, *textwrap.wrap(TEXT_ORIGIN, 100)])


def tables_by_family() -> Iterator[tuple[Family, list[tuple[str, type, bool]]]]:
    """Tables of the first family; of another those that only it has: name, class, whether it may be left
    out."""
    shared: set[str] = set()
    for family in all_families().values():
        optional, tables = optional_tables(family.spec), []
        for name, kind in family.tables.items():
            if name not in shared:
                tables.append((name, kind, name in optional))
                tables += [(*INNER[kind][:2], True)] if kind in INNER else []
        yield family, tables
        shared = {f.name for f in dataclasses.fields(CommonTables)}


def table_text(name: str, kind: type, optional: bool) -> list[str]:
    """One table of a file with its fields."""
    lines = [f"[{name}]" + (" (may be left out)" if optional else "")]
    for field, spec, default in fields_of(kind):
        lines.append(f"  {field:24} {spec.meaning}")
        lines.append(f"  {'':24}   {spec.legal}; default: {default}")
    return [*lines, ""]


def json_schema(table: str | None = None) -> dict[str, Any]:
    """JSON Schema (2020-12) of the design file, of whichever family, or of one table."""
    if table is not None:
        return {"$schema": "https://json-schema.org/draft/2020-12/schema", **table_schema(_one(table)[0])}
    files = [_file_schema(family) for family in all_families().values()]
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "tactcad design file",
        **(files[0] if len(files) == 1 else {"anyOf": files}),
    }


def _file_schema(family: Family) -> dict[str, Any]:
    tables = {name: table_schema(kind) for name, kind in family.tables.items()}
    for name, kind in family.tables.items():
        if kind in INNER:
            field, (_, inner, pattern) = INNER[kind][0].split(".")[1], INNER[kind]
            of = {"patternProperties": {pattern: table_schema(inner)}, "additionalProperties": False}
            tables[name]["properties"][field] = {"type": "object", **of}
    if family.tables.get("element") is Element:
        gaps = tables["stop"]["properties"]["gaps"]
        tables["stop"]["properties"]["gaps"] = {"type": "object", "additionalProperties": gaps}
    tables["origin"] = {"type": "object"}
    required = [
        f.name
        for f in dataclasses.fields(family.spec)
        if f.default is dataclasses.MISSING and f.default_factory is dataclasses.MISSING
    ]
    return {"type": "object", "properties": tables, "required": required, "additionalProperties": False}


def table_schema(kind: type) -> dict[str, Any]:
    """JSON Schema of one table."""
    properties, required = {}, []
    for f in dataclasses.fields(kind):
        if "spec" not in f.metadata:
            continue
        spec = f.metadata["spec"]
        described = f"{spec.meaning} ({spec.unit})" if spec.unit else spec.meaning
        properties[f.name] = {**spec.schema(), "description": described}
        if f.default is dataclasses.MISSING:
            required.append(f.name)
        elif f.default is not None:
            properties[f.name]["default"] = f.default
    return {"type": "object", "properties": properties, "required": required, "additionalProperties": False}
