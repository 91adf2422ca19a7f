"""A design as the text of a design file: what `load.parse` reads back as the same design, and that of another
one under a new name, to start from.
"""

from __future__ import annotations

import dataclasses
import json
import os
import re
from collections.abc import Mapping, Sequence
from datetime import date
from pathlib import Path
from textwrap import wrap
from typing import Any

from .fields import spec_of
from .files import read_text
from .load import MOST_BYTES, find, names, parse
from .messages import InputError
from .text_values import parse_toml
from .tree import NO_TABLES, CommonTables, Identity, Issue


def design_text(design: CommonTables, heading: str = "") -> str:
    """TOML text of a design: every table with every value that is not derived, then their origins.

    Parameters
    ----------
    design
        As read or made.
    heading
        Lines of comment before the first table.
    """
    lines = [f"# {line}".rstrip() for line in heading.splitlines()]
    for f in dataclasses.fields(design):
        table = getattr(design, f.name)
        if f.name in NO_TABLES or table is None:
            continue
        lines += ["", f"[{f.name}]", *_values(table)]
        for number, hinge in getattr(table, "override", {}).items():
            lines += ["", f"[{f.name}.override.{number}]", *_values(hinge)]
        if getattr(table, "gaps", None):
            lines += ["", f"[{f.name}.gaps]", *(f'"{arm!r}" = {gap!r}' for arm, gap in table.gaps.items())]
        lines += unchanged_lines(getattr(table, "unchanged", {}))
    if design.origin:
        lines += ["", "[origin]", *(f"{json.dumps(path)} = {_text(v)}" for path, v in design.origin.items())]
    return "\n".join(lines).lstrip("\n") + "\n"


def unchanged_lines(unchanged: Mapping[str, Issue]) -> list[str]:
    """[design.unchanged] as lines of a design file, an empty one before each table."""
    lines = []
    for letter, issue in sorted(unchanged.items()):
        names = wrap(", ".join(map(_text, issue.parts)), 100, break_on_hyphens=False)
        rows = [f"    {row}" for row in names]
        lines += ["", f"[design.unchanged.{letter}]", f'date = "{issue.date}"', "parts = [", *rows, "]"]
    return lines


def issues(letters: Mapping[str, Sequence[str]], name: str) -> dict[str, Issue]:
    """[design.unchanged] of a design of that name, from letter and date by part number."""
    found: dict[str, Issue] = {}
    for number, (letter, day) in letters.items():
        others = found[letter].parts if letter in found else ()
        found[letter] = Issue(day, (*others, number.removeprefix(f"{name}-")))
    return found


def _values(table: Any) -> list[str]:
    return [
        f"{f.name} = {_text(getattr(table, f.name))}"
        for f in dataclasses.fields(table)
        if "spec" in f.metadata and f.name != "gaps" and getattr(table, f.name) is not None
    ]


def _text(value: Any) -> str:
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, tuple):
        return "[" + ", ".join(_text(v) for v in value) + "]"
    return repr(value)


def name_of(path: Path) -> str:
    """The name of the design that a new file `path` is to hold: the file's own, without .toml.

    Raises InputError if the file is there, is no .toml, or its name is not a design's or is taken.
    """
    if os.path.lexists(path):
        raise InputError(str(path), "is there already; nothing was changed", legal="the name of a new file")
    if path.suffix != ".toml":
        raise InputError(str(path), "not a design file's name", legal="NAME.toml")
    name = spec_of(Identity, "name").read(path.stem, str(path))
    if name in names():
        raise InputError(
            str(path),
            "there is a named design of this name, and exports and part numbers start with it",
            value=name,
            legal=f"a name other than {', '.join(names())}",
        )
    return name


def started(source: str, name: str, today: date) -> str:
    """The text of a design under another name, its comments and origins kept; its title is left out, so that
    it follows the array, which is about to be another.

    Parameters
    ----------
    source
        The design to start from: a path, or a name in hardware/.
    name
        Of the new design.
    today
        Its date; its revision is A.

    Raises
    ------
    InputError
        If the source is no design, or its [design] is not written with one value a line.
    """
    text = read_text(find(source), MOST_BYTES, "a design file (TOML)").replace("\r\n", "\n")
    old, revision = parse_toml(text, source), parse(text, source).design.revision
    values = {"name": name, "revision": "A", "date": today.isoformat()}
    origins = {key: f"chosen: tactcad new, from {source} revision {revision}" for key in values}
    origins = {f"design.{k}": v for k, v in origins.items() if f"design.{k}" in old.get("origin", {})}
    new = _with_values(_without(text, "design", "title", "unchanged"), "design", values)
    new = _with_values(_without(new, "origin", "design.title"), "origin", origins)
    new = f"# {name}: started from {source}, revision {revision}, by `tactcad new`.\n{new}"
    wanted = old | {"design": {k: v for k, v in old["design"].items() if k not in ("title", "unchanged")}}
    wanted["design"] |= values
    if "origin" in old:
        wanted["origin"] = {k: v for k, v in old["origin"].items() if k != "design.title"} | origins
    if parse_toml(new, source) != wanted:  # inline tables, dotted keys: legal, but nothing to edit by lines
        raise InputError(
            source, "[design] cannot be renamed", legal='lines like `name = "..."` below [design]'
        )
    return new


def _without(text: str, table: str, name: str, inner: str = "") -> str:
    """TOML text without a key on a line of its own below [table], and without tables [table.inner...]."""
    here, lines = "", []
    for line in text.split("\n"):
        if header := re.match(r"\s*\[\s*([^\[\]]+?)\s*\]", line):
            here = header[1]
        key = re.match(r'\s*"?([\w.-]+)"?\s*=', line)
        below = bool(inner) and f"{here}.".startswith(f"{table}.{inner}.")
        if not below and not (here == table and key and key[1] == name):
            lines.append(line)
    return "\n".join(lines)


def _with_values(text: str, table: str, values: dict[str, str]) -> str:
    """TOML text with other values of keys, one a line, below [table]."""
    here, lines = "", []
    for line in text.split("\n"):
        if header := re.match(r"\s*\[\s*([^\[\]]+?)\s*\]", line):
            here = header[1]
        key = re.match(r'\s*"?([\w.-]+)"?\s*=\s*', line)
        if here == table and key and key[1] in values:
            comment = re.search(r"\"\s*(#.*)$", line)
            line = f"{key[0]}{json.dumps(values[key[1]])}" + (f"  {comment[1]}" if comment else "")
        lines.append(line)
    return "\n".join(lines)
