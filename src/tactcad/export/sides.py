"""The two sides of `tactcad diff`: a design, an export's folder, a golden file or a revision, as a record of
geometry."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Literal

from tactcad.design.files import read_json, read_text
from tactcad.design.load import MOST_BYTES as MOST_TEXT
from tactcad.design.load import find, from_table
from tactcad.design.messages import InputError
from tactcad.design.text_values import parse_toml
from tactcad.parts.rules import refuse_broken
from tactcad.scenes.scene import Scene

from .difference import Change, differences
from .dxf import read_dxf
from .geometry import Record, all_scenes, bill_line, contour_record, geometry
from .golden_file import MOST_BYTES, read_golden
from .inputs import flattened, inputs_from_json, nested
from .manifest import Manifest, PartRecord, read_export

# A part's data in an export's files: its record in the manifest but for number and section, and its
# contours; holes, placements and stiffness are in none of them.
IN_EXPORTS = (*[f.name for f in fields(PartRecord)][1:-1], "contours")
FROM_SHAPE = ("area_mm2", "centre_mm", "box_mm")


@dataclass(frozen=True)
class Side:
    """One side: its name, kind and record.

    values    the design's fields by path, None if the side does not tell them (a golden file)
    pictures  an export's pictures by path, None if the side is no export
    table     the design as TOML gives it, None if the side does not tell it
    own_code  the record is by the code of a revision, not by the present one
    of_other  what that code makes of the design on the other side; None if it was not asked, or refuses it
    untold    what could not be compared on this side's account, one clause each
    scenes    of the design, if the present code made them
    """

    source: str
    kind: Literal["design", "export", "golden", "revision"]
    design: str
    revision: str
    record: Record
    values: dict[str, Any] | None = None
    pictures: Mapping[str, bytes] | None = None
    table: dict[str, Any] | None = None
    own_code: bool = False
    of_other: Record | None = None
    untold: tuple[str, ...] = ()
    scenes: Sequence[Scene] = ()


def named(source: str) -> Path:
    """The file or folder that `source` names. Raises InputError if it is no path, and no design of that
    name."""
    path = Path(source)
    return path if os.path.isdir(path) or path.suffix == ".json" else find(source)


def read_side(source: str) -> Side:
    """One side of a comparison: a folder with a manifest, a golden file (*.json), else a design.

    Raises InputError if `source` is none of them, or damaged.
    """
    path = Path(source)
    if os.path.isdir(path):  # False also for texts that are not paths
        return _export(source, path.resolve())
    if path.suffix == ".json":
        record = read_golden(path)
        sections = {name: record[name] for name in ("parts", "scenes", "elements")}
        return Side(source, "golden", record["design"], record["revision"], sections)
    path = find(source)
    return design_side(source, "design", parse_toml(read_text(path, MOST_TEXT, "a design file"), str(path)))


def design_side(
    source: str, kind: Literal["design", "revision"], table: dict[str, Any], untold: tuple[str, ...] = ()
) -> Side:
    """The side of a design, given as TOML gives it, by the present code. Raises InputError if it is none,
    or breaks a rule."""
    design = from_table(table)
    refuse_broken(design)
    identity, scenes = design.design, all_scenes(design)
    return Side(
        source,
        kind,
        identity.name,
        identity.revision,
        geometry(design, scenes),
        design_values(flattened(design)),
        table=table,
        untold=untold,
        scenes=scenes,
    )


def _export(source: str, folder: Path) -> Side:
    manifest = read_export(source, folder)
    inputs = inputs_from_json(manifest.inputs)
    # an export records its design as "design", with the scenes it was asked for
    values = (
        {k.removeprefix("design."): v for k, v in inputs.values.items() if k.startswith("design.")}
        if inputs
        else None
    )
    try:
        scenes = {}
        for file in manifest.files:
            if file.kind == "bom" and file.path.endswith(".json"):
                bill = read_json(folder / file.path, MOST_BYTES, "a bill of materials")
                if not all(
                    isinstance(name, str) for name in (bill["scene"], *(r["part_no"] for r in bill["rows"]))
                ):
                    raise ValueError(f"{file.path}: a scene or part number is no text")
                scenes[bill["scene"]] = {"bom": {row["part_no"]: bill_line(row) for row in bill["rows"]}}
        record = {"parts": _exported_parts(folder, manifest), "scenes": scenes}
        table = values and nested(values)
        pictures = {f.path: (folder / f.path).read_bytes() for f in manifest.files if f.kind == "picture"}
    except (OSError, ValueError, LookupError, TypeError, AttributeError) as error:
        raise InputError(source, f"not a sound export: {error}") from None
    return Side(
        source,
        "export",
        manifest.design,
        manifest.revision,
        record,
        values and design_values(values),
        pictures,
        table,
    )


def design_values(fields: dict[str, Any]) -> dict[str, Any]:
    """A design's fields without those in the head of every side."""
    return {path: v for path, v in fields.items() if path not in ("design.name", "design.revision")}


def _exported_parts(folder: Path, manifest: Manifest) -> Record:
    drawn = {f.part_no: f.path for f in manifest.files if f.kind == "dxf"}
    parts = {}
    for part in sorted(manifest.parts, key=lambda p: p.part_no):
        facts = {name: _plain(getattr(part, name)) for name in IN_EXPORTS if name != "contours"}
        if part.part_no in drawn:
            file = read_dxf(folder / drawn[part.part_no])
            facts["contours"] = [contour_record(c) for c in (file.outer, *file.openings)]
        parts[part.part_no] = facts
    return parts


def _plain(value: Any) -> Any:
    return [_plain(v) for v in value] if isinstance(value, tuple) else value


def compare_sides(old: Side, new: Side) -> list[Change]:
    """Changes, as far as both sides record them: names, the design's values, then the geometry."""
    records = []
    for side, record in zip((old, new), comparable(old, new)):
        head: Record = {"design": side.design, "revision": side.revision}
        if old.values is not None and new.values is not None:
            head["values"] = side.values
        records.append({**head, **record})
    return differences(*records)


def comparable(old: Side, new: Side) -> tuple[Record, Record]:
    """The sides' records as far as both tell the same of a part, a scene and an element."""
    before, after = (deepcopy(side.record) for side in (old, new))
    if "export" in (old.kind, new.kind):
        before, after = _as_exported(before), _as_exported(after)
    # another code may record more, or less, and an older golden file does
    if old.own_code or new.own_code or "golden" in (old.kind, new.kind):
        for tables in zip(_rows(before), _rows(after)):
            _drop_uncommon(*tables)
    # A part whose shape comes from a file is measured by the kernel only: unknown without an export.
    for number in set(before["parts"]) & set(after["parts"]):
        parts = [before["parts"][number], after["parts"][number]]
        for name in FROM_SHAPE:
            if any(part.get(name) is None for part in parts):
                for part in parts:
                    part.pop(name, None)
    return before, after


def not_compared(old: Side, new: Side) -> list[str]:
    """Data that could not be compared, because one of the sides does not record it, or is not asked for
    it."""
    missing = []
    if "golden" in (old.kind, new.kind):
        missing.append("a golden file holds no design values")
    if "export" in (old.kind, new.kind) and old.kind != new.kind:
        missing.append("an export holds no hole list, no placements and no stiffness")
    told = [*missing, *dict.fromkeys((*old.untold, *new.untold))]
    if old.own_code or new.own_code:
        # what checks print differs from revision to revision; the record of geometry has a schema
        told.append("checks and virtual builds by a revision's own code, which is asked for geometry alone")
    return told


def _as_exported(record: Record) -> Record:
    """Only the data in an export's files, which have contours for wire-cut parts."""
    parts = {}
    for number, part in record["parts"].items():
        known = IN_EXPORTS if part["process"] in ("wire-cut", "etched") else IN_EXPORTS[:-1]
        parts[number] = {name: part[name] for name in known if name in part}
    return {
        "parts": parts,
        "scenes": {name: {"bom": scene["bom"]} for name, scene in record["scenes"].items()},
    }


def _rows(record: Record) -> Iterator[dict[Any, Record]]:
    """Tables whose rows have the same fields: parts, elements, every scene's lists, a part's features."""
    parts, scenes = record["parts"].values(), record["scenes"].values()
    yield record["parts"]
    yield record.get("elements", {})
    for name in ("holes", "pockets", "limits"):
        yield {(n, row): part[name][row] for n, part in enumerate(parts) for row in part.get(name, {})}
    for name in ("placed", "bom"):
        yield {(n, row): scene[name][row] for n, scene in enumerate(scenes) for row in scene.get(name, {})}


def _drop_uncommon(old: dict[Any, Record], new: dict[Any, Record]) -> None:
    """Take out fields that no row of the other table has; a table without rows has no information on them."""
    known = [{name for row in table.values() for name in row} for table in (old, new)]
    if not all(known):
        return
    for table in (old, new):
        for row in table.values():
            for name in row.keys() - (known[0] & known[1]):
                del row[name]
