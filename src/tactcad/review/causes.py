"""Changes in a design's text: the least edits that can be made one at a time.

The user's own text is compared, not the design that is read from it: omitted values follow from stated ones,
and are consequences. Texts of the same design have no differences.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from tactcad.design.family import all_families, family_with, optional_tables
from tactcad.design.load import from_table
from tactcad.design.messages import InputError
from tactcad.design.tree import CommonTables
from tactcad.export.difference import shown

FieldPath = tuple[str, ...]
Table = dict[str, Any]
CauseKind = Literal["value", "title block", "note"]

ABSENT: Any = None  # of a field that the text does not state; TOML has no null
IDENTITY = ("revision", "date", "title", "author", "organisation")  # of [design]: in title blocks only


@dataclass(frozen=True)
class Edit:
    """One field of the text before and after, ABSENT if it is not stated."""

    path: FieldPath
    old: Any
    new: Any

    def __str__(self) -> str:
        name = ".".join(self.path)
        if len(self.path) == 1:
            return f"[{name}] {'added' if self.old is ABSENT else 'removed'}"
        if self.path == ("array", "row_arms") and self.old is not ABSENT and self.new is not ABSENT:
            return f"{name}: {_arms(self.old, self.new)}"
        return f"{name}: {_stated(self.old)} -> {_stated(self.new)}"


@dataclass(frozen=True)
class Cause:
    """Edits that mean something only together, as an alloy with its values.

    kind   `value`; `title block` of fields only in every sheet's title block; `note` of a
           source under [origin]
    """

    kind: CauseKind
    edits: tuple[Edit, ...]

    def __str__(self) -> str:
        return "; ".join(map(str, self.edits))

    def applied(self, table: Table) -> Table:
        """A design's table with these edits made."""
        return _with(table, [(e.path, e.new) for e in self.edits])

    def reverted(self, table: Table) -> Table:
        """A design's table with these edits taken back."""
        return _with(table, [(e.path, e.old) for e in self.edits])


def causes(old: Table, new: Table) -> list[Cause]:
    """Every cause between two designs' tables, as TOML gives them, in the order of the text.

    An edit that does not change the design, such as a default now written out, is none. Raises InputError if
    a table is no design.
    """
    before = from_table(old)
    if before == from_table(new):
        return []
    return [cause for cause in _causes(list(_edits(old, new))) if _matters(cause, old, before)]


def _matters(cause: Cause, old: Table, before: CommonTables) -> bool:
    try:
        return from_table(cause.applied(old)) != before
    except InputError:
        return True  # it means something, though not alone


def _causes(edits: Sequence[Edit]) -> Iterator[Cause]:
    """The edits as causes. A new alloy goes with all of [material], and a value of [material] with its
    source, without which it is refused."""
    sources = {e.path[1]: e for e in edits if e.path[0] == "origin"}
    materials = [e for e in edits if e.path[0] == "material"]
    if any(e.path[1] == "alloy" for e in materials):
        materials.sort(key=lambda e: e.path[1] != "alloy")
        groups = [materials]
    else:
        groups = [[e] for e in materials]
    for group in groups:
        group += [sources.pop(name) for e in group if (name := ".".join(e.path)) in sources]
        yield Cause("value", tuple(group))
    for edit in edits:
        if edit.path[0] not in ("material", "origin"):
            in_titles = edit.path[0] == "design" and edit.path[-1] in IDENTITY
            yield Cause("title block" if in_titles else "value", (edit,))
    yield from (Cause("note", (edit,)) for edit in sources.values())


def _edits(old: Table, new: Table) -> Iterator[Edit]:
    """Fields that differ; a rig that only one text has is one edit."""
    rigs = optional_tables(family_with(new).spec)
    for rig in rigs:
        if (rig in old) != (rig in new):
            yield Edit((rig,), old.get(rig, ABSENT), new.get(rig, ABSENT))
    before, after = (
        dict(_fields({k: v for k, v in table.items() if k not in rigs or (k in old and k in new)}))
        for table in (old, new)
    )
    for path in [*before, *(p for p in after if p not in before)]:
        edit = Edit(path, before.get(path, ABSENT), after.get(path, ABSENT))
        if edit.old != edit.new:
            yield edit


def _fields(table: Mapping[str, Any], path: FieldPath = ()) -> Iterator[tuple[FieldPath, Any]]:
    """Every field by its path; one under [origin] has two names, the second with dots."""
    for name, value in table.items():
        here = (*path, name) if path[:1] != ("origin",) or len(path) < 2 else ("origin", f"{path[1]}.{name}")
        if isinstance(value, dict):
            yield from _fields(value, here)
        else:
            yield here, value


def _with(table: Table, fields: Sequence[tuple[FieldPath, Any]]) -> Table:
    """A copy of the table with these fields set, or taken out where ABSENT."""
    made = copy.deepcopy(table)
    if "origin" in made:
        made["origin"] = {path[1]: text for path, text in _fields({"origin": made["origin"]})}
    for path, value in fields:
        *above, name = path
        if value is ABSENT:
            _take_out(made, path)
            continue
        node = made
        for key in above:
            node = node.setdefault(key, {})
        node[name] = copy.deepcopy(value)
    return made


def _take_out(table: Table, path: FieldPath) -> None:
    """Remove a field, and what tables within its section it leaves empty."""
    first, *rest = path
    if not rest:
        table.pop(first, None)
    elif first in table:
        _take_out(table[first], tuple(rest))
        known = {"origin", *(name for family in all_families().values() for name in family.tables)}
        if not table[first] and first not in known:
            del table[first]


def _stated(value: Any) -> str:
    return "(not stated)" if value is ABSENT else shown(value)


def _arms(old: Any, new: Any) -> str:
    """Elements whose arms changed, if the rows have their former lengths; else both lists."""
    if [len(row) for row in old] != [len(row) for row in new]:
        return f"{shown(old)} -> {shown(new)}"
    pairs = zip([a for row in old for a in row], [a for row in new for a in row])
    return ", ".join(f"E{n} {shown(a)} -> {shown(b)}" for n, (a, b) in enumerate(pairs, 1) if a != b)
