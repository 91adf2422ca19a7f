"""Bill of materials of a scene: parts made, parts bought, supplies used up.

Placing a part adds its line: rows are derived from the scene's placements, never written by hand, and the
number of solids in the scene is the sum of `qty` over the rows with `has_solid`.
"""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any

from tactcad.design.files import as_csv
from tactcad.design.text_values import as_number, as_whole
from tactcad.design.tree import Identity
from tactcad.parts.bought.electronic_parts import Supply
from tactcad.parts.bought.standard_parts import example
from tactcad.parts.language.description import Part, Purchase
from tactcad.scenes.scene import Scene

SCHEMA = "tactcad-bom-1"
# Designations that are incomplete for an order: the standard, and what has to follow.
ORDERABLE = {
    "ISO 4762": (
        re.compile(r"\b(A[1-5]-\d{2,3}|\d{1,2}\.9|8\.8)\b"),
        "a property class such as A2-70 or 8.8",
    ),
    "ISO 4026": (re.compile(r"\b(A[1-5]-\d{2,3}H?|\d{2}H)\b"), "a hardness class such as 45H or A2-21H"),
    "ISO 15": (re.compile(r"\b\d{3,5}-?(2?Z|2?RS\w*|ZZ|open)\b"), "a seal code such as 623-2Z"),
}


@dataclass(frozen=True)
class BomRow:
    """One line. `qty` counts what the scene holds (spares come on top); `mass_g` is of one piece, None
    unknown."""

    item: int
    part_no: str
    rev: str
    qty: float
    unit: str
    description: str
    make_buy: str
    material: str
    process: str
    finish: str
    standard_designation: str
    manufacturer: str
    mpn: str
    supplier: str
    alternates: str
    spares: float
    consumable: bool
    file: str
    sha256: str
    mass_g: float | None
    source_verified: bool
    designators: str
    has_solid: bool


COLUMNS = tuple(f.name for f in fields(BomRow))


def bom_rows(
    scene: Scene, identity: Identity | None, files: Mapping[str, tuple[str, str]]
) -> tuple[BomRow, ...]:
    """The lines of a scene: made parts, then bought ones, then supplies; each in order of first placement.

    Parameters
    ----------
    scene
        Its placements and supplies.
    identity
        Of the design, which knows the letters of made parts; None: without letters.
    files
        By part number: path and SHA-256 of the file that the part is made from.
    """
    parts = sorted(scene.parts, key=lambda part: part.bought)
    letter = lambda p: identity.of_part(p.part_no).revision if identity and not p.bought else ""  # noqa: E731
    rows = [
        _part_row(item, part, scene, letter(part), *files.get(part.part_no, ("", "")))
        for item, part in enumerate(parts, start=1)
    ]
    return (*rows, *(_supply_row(len(rows) + n, supply) for n, supply in enumerate(scene.supplies, start=1)))


def _part_row(item: int, part: Part, scene: Scene, revision: str, file: str, sha256: str) -> BomRow:
    order = part.purchase or Purchase("")
    placed = [p.designator for p in scene.placements if p.part.part_no == part.part_no]
    return _filled(
        order,
        part,
        item=item,
        rev=revision,
        qty=len(placed),
        unit="pcs",
        description=part.name,
        make_buy="buy" if part.bought else "make",
        material=str(part.material),
        standard_designation=order.designation,
        alternates="; ".join(filter(None, (example(part), order.alternates))),
        consumable=False,
        file=file,
        sha256=sha256,
        mass_g=round(part.mass, 6),
        designators=" ".join(placed),
        has_solid=True,
    )


def _supply_row(item: int, supply: Supply) -> BomRow:
    own = {"standard_designation": supply.designation, "source_verified": supply.verified}
    return _filled(supply, **own, item=item, make_buy="buy", mass_g=None, has_solid=False)


def _filled(*records: object, **told: object) -> BomRow:
    """The records' values under the columns' names, then those of `told`; empty if neither has one."""
    said = {name: value for r in records for name, value in vars(r).items() if name in COLUMNS}
    values: Any = dict.fromkeys(COLUMNS, "") | said | told
    return BomRow(**values)


def csv_bytes(rows: Sequence[BomRow]) -> bytes:
    """The rows as CSV (RFC 4180, UTF-8), numbers by repr, truth values as true and false; what nobody read in
    a maker's own sheet as unread."""
    told = (asdict(row) | {"source_verified": read_in_sheet(row)} for row in rows)
    return as_csv([COLUMNS, *(map(_cell, row.values()) for row in told)])


def read_in_sheet(row: BomRow) -> bool | str:
    """The bill's words on whether a bought line's figures were read in the maker's own sheet."""
    return row.source_verified if row.source_verified or row.make_buy == "make" else "unread"


def _cell(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return "" if value is None else str(value)


def rows_from_csv(data: bytes) -> tuple[BomRow, ...]:
    """The rows of a written CSV. Raises ValueError if it is not one of ours."""
    lines = list(csv.reader(io.StringIO(data.decode(), newline=""), strict=True))
    if not lines or tuple(lines[0]) != COLUMNS:
        raise ValueError("the columns are not those of a bill of materials")
    return tuple(_row(line) for line in lines[1:])


def _row(line: list[str]) -> BomRow:
    values: Any = (_parsed(column, cell) for column, cell in zip(fields(BomRow), line, strict=True))
    return BomRow(*values)


def _parsed(column: Any, cell: str) -> object:
    match column.type:
        case "bool":
            return {"true": True, "false": False, "unread": False}[cell]
        case "int":
            return as_whole(cell)
        case "float":
            return as_number(cell)
        case "float | None":
            return as_number(cell) if cell else None
    return cell


def json_bytes(rows: Sequence[BomRow], design: str, revision: str, scene: str) -> bytes:
    """The rows as JSON.

    Parameters
    ----------
    rows
        As `bom_rows` gives them.
    design, revision, scene
        That they belong to.
    """
    record = {
        "schema": SCHEMA,
        "design": design,
        "revision": revision,
        "scene": scene,
        "rows": [asdict(row) for row in rows],
    }
    return (json.dumps(record, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()


def rows_from_json(data: bytes) -> tuple[BomRow, ...]:
    """The rows of a written JSON. Raises ValueError, TypeError or KeyError if it is not one of ours."""
    record = json.loads(data)
    if record["schema"] != SCHEMA:
        raise ValueError(f"schema {record['schema']!r} instead of {SCHEMA!r}")
    return tuple(BomRow(**row) for row in record["rows"])


def check_bom(scene: Scene, as_csv: bytes, as_json: bytes) -> list[str]:
    """Differences between the written bills and the scene, one line for each; empty if they agree."""
    try:
        rows, same = rows_from_json(as_json), rows_from_csv(as_csv)
    except (ValueError, TypeError, KeyError) as error:
        return [f"not readable as a bill of materials: {error}"]
    wrong = [] if rows == same else ["CSV and JSON differ"]
    placed = sorted(p.designator for p in scene.placements)
    if sorted(d for row in rows if row.has_solid for d in row.designators.split()) != placed:
        wrong.append("the designators are not those of the scene")
    wrong += [
        f"{row.part_no}: quantity {row.qty} with designators {row.designators!r}"
        for row in rows
        if (row.has_solid or row.designators) and row.qty != len(row.designators.split())
    ]
    solids = sum(row.qty for row in rows if row.has_solid)
    if solids != len(scene.placements):
        wrong.append(f"{solids} solids instead of {len(scene.placements)}")
    numbers = [row.part_no for row in rows]
    wrong += [f"{n} is on two lines" for n in sorted(set(numbers)) if numbers.count(n) > 1]
    return wrong + [text for row in rows for text in incomplete(row)]


def incomplete(row: BomRow) -> list[str]:
    """Data missing from a line that a buyer needs to order."""
    if row.make_buy == "make":
        return [f"{row.part_no}: no {name}" for name in ("material", "rev") if not getattr(row, name)]
    if not row.standard_designation and not row.mpn:
        return [f"{row.part_no}: neither a standard designation nor a maker's number"]
    return [
        f"{row.part_no}: {row.standard_designation!r} lacks {lacking}"
        for standard, (rule, lacking) in ORDERABLE.items()
        if re.match(rf"{standard}\b", row.standard_designation)
        and not rule.search(row.standard_designation.removeprefix(standard))
    ]
