"""An output's inputs, as digests that are the same in every process, and the reasons for a rebuild, in words.

An output depends on values (the design, a part's description), on the source of the rooms that make it, and
on the libraries they use. All three go into the key: a key of values alone would serve stale geometry after a
change of the code.
"""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from tactcad.parts.language.description import Part

PACKAGE = Path(__file__).parents[1]

ABSENT = "(absent)"


def digest(value: object) -> str:
    """SHA-256 of a value made of frozen dataclasses, tuples, lists, dicts, sets, text, numbers, bools, None.

    Equal for equal values in any process: floats go in by repr, which is exact, sets and dicts in sorted
    order; types count, so that 1, 1.0 and True differ. Raises TypeError for anything else.
    """
    return hashlib.sha256(_canonical(value)).hexdigest()


def _canonical(value: object) -> bytes:
    """Unambiguous encoding: a tag, and lengths before contents.

    A part keeps its digest, so that one placed a thousand times is encoded once.
    """
    match value:
        case None | bool() | int() | float():
            return f"{type(value).__name__} {value!r}".encode()
        case str():
            return b"str " + _framed([value.encode()])
        case bytes():
            return b"bytes " + _framed([value])
        case tuple() | list():
            return b"list " + _framed(_canonical(v) for v in value)
        case set() | frozenset():
            return b"set " + _framed(sorted(_canonical(v) for v in value))
        case Mapping():
            pairs = ((_canonical(k), _canonical(v)) for k, v in value.items())
            return b"map " + _framed(part for pair in sorted(pairs) for part in pair)
    if is_dataclass(value) and not isinstance(value, type):
        kept = vars(value) if isinstance(value, Part) else {}
        if "_digest" not in kept:
            name = f"{type(value).__module__}.{type(value).__qualname__}".encode()
            rest = [(f.name.encode(), _canonical(getattr(value, f.name))) for f in fields(value)]
            whole = _framed([name, *(part for pair in rest for part in pair)])
            kept["_digest"] = b"data " + hashlib.sha256(whole).digest()
        return kept["_digest"]
    raise TypeError(f"no stable digest of a {type(value).__name__}")


def _framed(parts: Iterable[bytes]) -> bytes:
    return b"".join(b"%d:%s" % (len(part), part) for part in parts)


def source_digest(room: str) -> str:
    """SHA-256 of every file of a room (`src/tactcad/<room>`), names included; "" for the package's own files.

    Raises FileNotFoundError if there is no such room.
    """
    folder = PACKAGE / room
    files = sorted(p for p in (folder.rglob("*") if room else folder.glob("*.py")) if _is_source(p))
    if not files:
        raise FileNotFoundError(f"no source in {folder}")
    named = ((p.relative_to(folder).as_posix().encode(), p.read_bytes()) for p in files)
    return hashlib.sha256(_framed(part for pair in named for part in pair)).hexdigest()


NAMED_DESIGNS = PACKAGE / "design" / "named"  # the part of hardware/ in a wheel: values, not code


def _is_source(path: Path) -> bool:
    if NAMED_DESIGNS in path.parents:
        return False
    return path.is_file() and path.suffix != ".pyc" and not path.name.startswith(".")


def first_installed(*names: str) -> str:
    """The first installed one of alternative libraries; the first of all if none is."""
    return next((name for name in names if _version(name) != ABSENT), names[0])


def library_versions(names: Iterable[str]) -> dict[str, str]:
    """Installed version of each library, and Python's own; an absent library has the version "(absent)"."""
    versions = {"python": "{}.{}.{}".format(*sys.version_info)}
    return versions | {name: _version(name) for name in sorted(names)}


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return ABSENT


def flattened(value: object, path: str = "") -> dict[str, Any]:
    """Every number, text and truth value of a tree of dataclasses, dicts and tuples by its path.

    {"element.hinge_thickness": 0.25, "array.row_arms[0][1]": 7.0, ...}
    """
    if is_dataclass(value) and not isinstance(value, type):
        children = {f.name: getattr(value, f.name) for f in fields(value)}
    elif isinstance(value, Mapping):
        children = {str(k): value[k] for k in sorted(value, key=str)}
    elif isinstance(value, tuple | list):
        return {k: v for i, child in enumerate(value) for k, v in flattened(child, f"{path}[{i}]").items()}
    else:
        return {path: value}
    join = f"{path}." if path else ""
    return {k: v for name, child in children.items() for k, v in flattened(child, join + name).items()}


def nested(values: Mapping[str, Any]) -> dict[str, Any]:
    """The tables that TOML would give for `flattened` values of a design, without values of None."""
    tables: dict[str, Any] = {}
    for path, value in values.items():
        if value is None:
            continue
        # a source's name has dots, and so have arm lengths
        dots = 1 if path.startswith("origin.") else 2 if path.startswith("stop.gaps.") else -1
        head, *above, last = path.split(".", dots)
        node = tables.setdefault(head, {})
        for name in above:
            node = node.setdefault(name, {})
        name, *places = last.replace("]", "").split("[") if dots < 0 else (last,)
        if not places:
            node[name] = value
            continue
        row = node.setdefault(name, [])
        for _ in places[1:]:
            if int(places[0]) == len(row):
                row.append([])
            row = row[-1]
        row.append(value)
    return tables


@dataclass(frozen=True)
class Inputs:
    """Inputs of one export: values by path, source digests by room, versions by library."""

    values: Mapping[str, Any]
    sources: Mapping[str, str]
    libraries: Mapping[str, str]

    @property
    def key(self) -> str:
        return digest(self)

    def as_json(self) -> dict[str, Any]:
        return {"values": dict(self.values), "sources": dict(self.sources), "libraries": dict(self.libraries)}


def inputs_of(design: object, rooms: Iterable[str], libraries: Iterable[str]) -> Inputs:
    """Today's inputs for a design (a tree of frozen dataclasses) that these rooms and libraries work on."""
    return Inputs(
        flattened(design), {room: source_digest(room) for room in rooms}, library_versions(libraries)
    )


def inputs_from_json(record: Any) -> Inputs | None:
    """The inputs that an earlier export recorded (`Inputs.as_json`), None if they cannot be understood."""
    try:
        groups = [record["values"], record["sources"], record["libraries"]]
    except (KeyError, TypeError):
        return None
    return Inputs(*groups) if all(isinstance(group, dict) for group in groups) else None


def reasons(before: Inputs | None, now: Inputs) -> list[str]:
    """Why an output made from `before` has to be made again from `now`, one line each; empty if nothing
    changed.

    Raises nothing: an unreadable record (None) is also a reason.
    """
    if before is None:
        return ["there is no record of an earlier export"]
    values = [
        f"{path} changed {_shown(before.values, path)} -> {_shown(now.values, path)}"
        for path in _changed(before.values, now.values)
    ]
    sources = [
        f"source of tactcad{'.' if room else ''}{room} changed"
        for room in _changed(before.sources, now.sources)
    ]
    libraries = [
        f"{name} {before.libraries.get(name, ABSENT)} -> {now.libraries.get(name, ABSENT)}"
        for name in _changed(before.libraries, now.libraries)
    ]
    return values + sources + libraries


def _changed(before: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """Keys whose values differ, in the order of `now`, then the missing ones."""
    keys = [*now, *(key for key in before if key not in now)]
    return [key for key in keys if _shown(before, key) != _shown(now, key)]


def _shown(values: Mapping[str, Any], path: str) -> str:
    """A value as JSON would keep it, so that a record read back compares equal to what was written."""
    return json.dumps(values[path], ensure_ascii=False) if path in values else ABSENT
