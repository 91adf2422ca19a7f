"""From a TOML file to a Design, field by field, or to one clear message."""

from __future__ import annotations

import dataclasses
import math
import re
import typing
from functools import cache
from json import dumps
from pathlib import Path
from typing import Any

from .family import all_families, family_with
from .fields import Number, shown_text
from .files import read_text
from .materials import completed
from .messages import InputError, nearest, one_of
from .text_values import as_number, parse_toml
from .tree import NO_TABLES, CommonTables, Element, Hinge, Identity, Issue, SheetMaterial, Stop

# A design is a page of text; a larger file is a mistake or an attack, and is refused without parsing.
MOST_BYTES = 1_000_000

DEFAULT_DESIGN = "macro-array"
# how the origins begin that `tactcad design` writes
OF_A_SEARCH = ("synthesised", "chosen: the target's", "chosen: of the target's stock")


def read(source: str | Path) -> CommonTables:
    """The design in a file, or the one of that name in hardware/, checked field by field.

    Rules between fields are tried by `tactcad.parts.rules.load`, which is what commands call. Raises
    InputError if the file is missing or not a design, or a value is not legal.
    """
    path = find(source)
    return parse(read_text(path, MOST_BYTES, "a design file (TOML)"), str(path))


def find(source: str | Path) -> Path:
    """The design file that `source` names: a path (it has a '/' or ends in .toml), or a named design."""
    text = str(source)
    if isinstance(source, Path) or "/" in text or text.endswith(".toml"):
        return Path(text)
    known = names()
    for folder in _hardware_folders() if text in known else ():
        if (folder / f"{text}.toml").exists():
            return folder / f"{text}.toml"
    raise InputError(
        "DESIGN",
        "no design of that name in hardware/",
        value=text,
        legal=f"a path ending in .toml, or {one_of(text, known)}" if known else "a path ending in .toml",
    )


def names() -> list[str]:
    """Names of the designs in ./hardware and of the installed ones, sorted."""
    return sorted({p.stem for folder in _hardware_folders() for p in folder.glob("*.toml")})


def _hardware_folders() -> list[Path]:
    """./hardware, then the installed designs.

    Those are the checkout's hardware/: `named` is a link to it there, and a folder of its files in a wheel.
    """
    here, own = Path("hardware"), Path(__file__).with_name("named").resolve()
    return [here] if here.is_dir() and here.samefile(own) else [here, own]


def parse(text: str, where: str) -> CommonTables:
    """Read a design from TOML text; rules between fields are not tried.

    `where` names the text in messages. Raises InputError as `read` does.
    """
    return from_table(parse_toml(text, where))


def from_table(table: dict[str, Any]) -> CommonTables:
    """Read a design from the nested dict that TOML gives."""
    family = family_with(table)
    for name, value in table.items():
        if name not in (*family.tables, "origin"):
            if name in OTHER_FILES:
                raise InputError(name, "is a table of no design file", legal=f"a design; {OTHER_FILES[name]}")
            if of := [f.name for f in all_families().values() if name in f.tables]:
                raise InputError(name, f"is a table of {' and '.join(of)}; the others are of {family.name}")
            raise unknown_field(name, [*family.tables, "origin"])
        if not isinstance(value, dict):
            raise InputError(name, "not a table", value=value, legal=f"a table [{name}]")
    values = {}
    for section in dataclasses.fields(family.spec):
        name = section.name
        if name in NO_TABLES:
            continue
        if name not in table and section.default is dataclasses.MISSING:
            raise InputError(name, "missing table", legal=f"a table [{name}]")
        if name not in table and section.default is None:
            continue  # a rig that this design does not have
        values[name] = read_table(family.tables[name], table.get(name, {}), name)
    values["material"] = _material(values["material"])
    design = family.spec(**family.spec.completed(values), origin={})
    design = dataclasses.replace(design, origin=_origins(table.get("origin", {}), design))
    _ = design.differences  # refuses values that are not those of the material's name
    return typing.cast(CommonTables, design)


SCHEMA = "tactcad schema"  # prints every field
OTHER_FILES = {"target": "a target is for `tactcad design`", "study": "a study is for `tactcad sweep`"}


def read_table(kind: type, table: dict[str, Any], path: str) -> Any:
    """One table of a file as its dataclass, field by field; `path` is the table's name. Raises InputError."""
    fields = {f.name: f for f in dataclasses.fields(kind)}
    for name in table:
        if name not in fields:
            raise unknown_field(f"{path}.{name}", [f"{path}.{n}" for n in fields])
    values: dict[str, Any] = {}
    for name, f in fields.items():
        where = f"{path}.{name}"
        if name not in table:
            if f.default is dataclasses.MISSING and f.default_factory is dataclasses.MISSING:
                raise InputError(where, "missing", legal=f.metadata["spec"].legal)
        elif kind is Element and name == "override":
            values[name] = _overrides(table[name], where)
        elif kind is Stop and name == "gaps":
            values[name] = _gaps(table[name], where, f.metadata["spec"])
        elif kind is Identity and name == "unchanged":
            values[name] = _unchanged(table[name], where, values)
        else:
            values[name] = f.metadata["spec"].read(table[name], where)
    return kind(**values)


def _overrides(table: Any, where: str) -> dict[int, Hinge]:
    if not isinstance(table, dict):
        raise InputError(where, "not a table", value=table, legal=f"tables [{where}.N], N an element number")
    overrides = {}
    for key, value in table.items():
        if not re.fullmatch("[1-9][0-9]{0,3}", key):
            raise InputError(f"{where}.{key}", "not an element number", legal="1 and up")
        if not isinstance(value, dict):
            raise InputError(f"{where}.{key}", "not a table", value=value)
        overrides[int(key)] = read_table(Hinge, value, f"{where}.{key}")
    return dict(sorted(overrides.items()))


def _gaps(table: Any, where: str, spec: Number) -> dict[float, float]:
    if not isinstance(table, dict):
        raise InputError(where, "not a table", value=table, legal=spec.meaning)
    gaps = {}
    for key, value in table.items():
        try:
            arm = as_number(key)
        except ValueError:
            arm = math.nan
        if not (math.isfinite(arm) and arm > 0):
            raise InputError(f"{where}.{key}", "not an arm length", value=key, legal="arm lengths in mm")
        if arm in gaps:
            raise InputError(
                f"{where}.{key}", "this arm length is given twice", legal="one gap in mm for each"
            )
        gaps[arm] = spec.read(value, f"{where}.{key}")
    return dict(sorted(gaps.items()))


def _unchanged(table: Any, where: str, design: dict[str, Any]) -> dict[str, Issue]:
    """[design.unchanged]; `design`: the fields before it."""
    if not isinstance(table, dict):
        raise InputError(where, "not a table", value=table, legal=f"tables [{where}.LETTER]")
    kept: dict[str, Issue] = {}
    for letter, value in table.items():
        at, own = f"{where}.{letter}", design["revision"]
        _ = Identity.__dataclass_fields__["revision"].metadata["spec"].read(letter, at)
        if (len(letter), letter) >= (len(own), own):
            raise InputError(at, "not before the design's revision", value=letter, legal=f"before {own}")
        if not isinstance(value, dict):
            raise InputError(at, "not a table", value=value, legal=f"a table [{at}]")
        issue = read_table(Issue, value, at)
        if issue.date > design["date"]:
            legal = f"no day after design.date, {design['date']}"
            raise InputError(f"{at}.date", "later than the design", value=issue.date, legal=legal)
        if twice := [p for p in issue.parts if any(p in other.parts for other in kept.values())]:
            raise InputError(
                f"{at}.parts", "has another letter too", value=twice[0], legal="one letter a part"
            )
        kept[letter] = issue
    return kept


def _material(given: SheetMaterial) -> SheetMaterial:
    """[material], completed from the table of materials."""
    return SheetMaterial(**completed(given.alloy, vars(given)))


def _origins(table: dict[str, Any], design: CommonTables) -> dict[str, str]:
    """[origin]: the source of a value by its path, as "element.pad_length" or nested tables."""
    flat: dict[str, str] = {}
    stack = [("", table)]
    while stack:
        prefix, node = stack.pop()
        for key, value in node.items():
            path = f"{prefix}{key}"
            if isinstance(value, dict):
                stack.append((f"{path}.", value))
            else:
                flat[path] = shown_text(value, f"origin.{path}", "the value's source")
    known = paths(design)
    for path in flat:
        if path not in known:
            raise unknown_field(f"origin.{path}", [f"origin.{p}" for p in known])
    return dict(sorted(flat.items()))


def paths(design: CommonTables) -> dict[str, Any]:
    """Every value of a design by its dotted path, as in messages and in [origin]."""
    flat: dict[str, Any] = {}

    def add(prefix: str, value: Any) -> None:
        if dataclasses.is_dataclass(value):
            for f in dataclasses.fields(value):
                add(f"{prefix}.{f.name}", getattr(value, f.name))
        elif isinstance(value, dict):
            for key, item in value.items():
                add(f"{prefix}.{key:g}" if isinstance(key, float) else f"{prefix}.{key}", item)
        else:
            flat[prefix] = value

    for f in dataclasses.fields(design):
        if f.name not in NO_TABLES:
            add(f.name, getattr(design, f.name))
    return flat


@cache
def _shipped() -> tuple[CommonTables, ...]:
    """The designs that came with tactcad."""
    files = sorted(_hardware_folders()[-1].glob("*.toml"))
    return tuple(parse(read_text(file, MOST_BYTES, "a design file (TOML)"), str(file)) for file in files)


def stale_origins(design: CommonTables) -> list[str]:
    """Origins that a shipped design gives, word for word, to another value: the value was changed since the
    design was started from that one. Origins written by a search or its target are exempt."""
    values, told = paths(design), []
    for path, text in design.origin.items():
        if text.startswith(OF_A_SEARCH):
            continue
        of = [paths(other)[path] for other in _shipped() if other.origin.get(path) == text]
        if of and values[path] not in of and not path.startswith("design."):
            told.append(
                f"origin.{path}: stale, it was written for {dumps(of[0])} and the value is "
                f"{dumps(values[path])}: state its source"
            )
    return told


def unknown_field(path: str, known: list[str], schema: str = SCHEMA) -> InputError:
    """The refusal of a name that is no field of the file; `known` are those of its table, and `schema` prints
    all."""
    table, _, name = path.rpartition(".")
    own = {k.removeprefix(f"{table}."): k for k in known}  # compare names without the common table's
    begins = next((k for word, k in own.items() if word.startswith(f"{name}_")), "")
    if schema == SCHEMA and not begins and ".override." not in path:
        begins = _elsewhere(name, known)
    likely = begins or own.get(nearest(name, own), "")
    return InputError(path, "unknown field", legal=f"did you mean {likely}?" if likely else f"see `{schema}`")


def _elsewhere(name: str, known: list[str]) -> str:
    """The first field of another table with this name or beginning, in families with all known fields'
    tables; "" if there is none."""
    heads = {path.partition(".")[0] for path in known} - {"origin"}
    kinds = [f.tables for f in all_families().values() if heads <= {*f.tables}]
    every = ((t, f.name) for tables in kinds for t, kind in tables.items() for f in dataclasses.fields(kind))
    return next((f"{t}.{n}" for t, n in every if f"{n}_".startswith(f"{name}_")), "")
