"""Golden geometry: what each design in hardware/ means, committed, and compared at every check.

The golden file of hardware/NAME.toml is exports/golden/<design>.json beside that hardware/; a design
elsewhere has none. A file's form is checked first on reading: sections, kinds of values, contours that close.

A part that has not changed since an earlier revision keeps that one's letter and date; the design's file
says which ([design.unchanged]). Golden files know since when a part is as it is, and so refuse a letter that
is not true. The circuit boards, which are equal, have one letter, as a part has.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from tactcad.design.design_text import issues, unchanged_lines
from tactcad.design.files import absolute, make_folder, read_json, write_whole
from tactcad.design.messages import CheckFailure, InputError
from tactcad.design.tree import CommonTables, Identity
from tactcad.parts.language.description import NOT_MADE
from tactcad.parts.language.finding import Finding

from .board_files import board_record
from .difference import Change, differences, is_number
from .geometry import Record, contour_of, geometry

Severity = Literal["fail", "flag"]

SCHEMA = "tactcad-golden-1"
UNPROVEN = (
    "parts keep letters ([design.unchanged]), and no golden file shows that they did not change: leave the "
    "table out, or record each revision in a folder hardware/ with `tactcad golden`"
)
MOST_BYTES = 50_000_000  # the largest array, 2 x 500, takes under one


def golden_path(design_file: Path, design: CommonTables) -> Path | None:
    """Place of a design file's golden file; None if the design is in no hardware/, neither by the given name
    nor by its links' target."""
    for folder in (absolute(design_file).parent, design_file.resolve().parent):
        if folder.name == "hardware":
            return folder.parent / "exports" / "golden" / f"{design.name}.json"
    return None


def golden_record(design: CommonTables) -> Record:
    """The record that a golden file holds.

    `kept`: letters of parts that keep an earlier one; `unchanged`: those that could, as far as known, of
    which `accept` knows more.
    """
    identity, told, boards = design.design, geometry(design), board_record(design)
    kept = kept_letters(identity, [*with_letters({**told, "boards": boards})])
    head: Record = {"schema": SCHEMA, "design": design.name, "revision": identity.revision}
    head |= {"date": identity.date, "title": identity.title, "kept": kept, "unchanged": kept}
    return {**head, **told, "boards": boards}


def golden_bytes(record: Record) -> bytes:
    """The record as JSON with a value a line and a list of numbers on one, so that a reviewer reads git's
    diff."""
    return (_lines(record, "") + "\n").encode()


def _lines(value: Any, indent: str) -> str:
    deeper = indent + " "
    if isinstance(value, dict) and value:
        rows = [f"{deeper}{json.dumps(k, ensure_ascii=False)}: {_lines(v, deeper)}" for k, v in value.items()]
        return "{\n" + ",\n".join(rows) + f"\n{indent}}}"
    if isinstance(value, list) and any(isinstance(v, list) for v in value):
        return "[\n" + ",\n".join(deeper + _lines(v, deeper) for v in value) + f"\n{indent}]"
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def read_golden(path: Path) -> Record:
    """The record of a golden file. Raises InputError if it is absent, damaged or of another schema."""
    record = read_json(path, MOST_BYTES, "a golden file")
    wrong = faults(record, SCHEMA)
    if wrong:
        raise InputError(str(path), f"not a golden file: {wrong}", legal="what `make golden` writes")
    return record


def doubts(design: CommonTables, path: Path | None) -> list[str]:
    """Why letters that parts keep are not true, or not known to be."""
    if not design.design.unchanged:
        return []
    if path is None or not path.exists():
        return [UNPROVEN]
    return wrong_letters(read_golden(path), golden_record(design))


def check_golden(design: CommonTables, path: Path | None) -> list[Finding]:
    """Hold a design against its golden file.

    Parameters
    ----------
    design
        A design that keeps its rules.
    path
        Of the golden file, which may be absent; None: the design can have none.

    Returns
    -------
    list of Finding
        Content that the golden file's revision does not have fails, and a letter kept by a part that changed;
        under a new revision, and if there is no golden file yet, what `make golden` would take up is flagged.
    """
    if path is None:
        return [_finding("flag", design, doubt) for doubt in doubts(design, path)]
    if not path.exists():
        return [
            _finding("flag", design, f"there is no {path.name} in exports/golden: `make golden` writes it")
        ]
    try:
        old = read_golden(path)
    except ValueError as error:
        return [_finding("fail", design, f"the golden file cannot be used: {error}")]
    return judge(old, golden_record(design))


def changes_of(old: Record, new: Record) -> list[Change]:
    """Differences from a golden file; of one that holds no sheets and letters yet, of the geometry."""
    old, new = ({k: v for k, v in record.items() if k != "unchanged"} for record in (old, new))
    if "kept" not in old:
        parts = {n: {k: v for k, v in p.items() if k != "sheet"} for n, p in new["parts"].items()}
        new = {name: new[name] for name in old} | {"parts": parts}
    return differences(old, new)


def judge(old: Record, new: Record) -> list[Finding]:
    """Judgement of the differences between golden file and design."""
    changes = [c for c in changes_of(old, new) if c.path[0] != "revision"]
    same_revision, name = old["revision"] == new["revision"], new["design"]
    wrong = [Finding("golden", "fail", name, (), 0, 0, said) for said in wrong_letters(old, new)]
    if not changes and same_revision:
        return wrong
    content, count = [*filter(asks_for_letter, changes)], len(changes)
    letter = new["revision"]
    if not same_revision:
        said = f"revision {old['revision']} -> {letter} with {count} differences: `make golden` takes it up"
    elif content:
        count = len(content)
        said = (
            f"revision {letter} has other content than its golden file, {count} differences: "
            "give the design a new revision letter"
        )
    else:
        said = "the content is the same, but the models give other figures, or [design] other dates or "
        said += f"letters, {count} differences: `make golden` takes them up"
    severity: Severity = "fail" if same_revision else "flag"
    head = Finding("golden", severity, name, (), count, 0, said)
    return [head, *wrong, *(_about(severity, c) for c in changes)]


def asks_for_letter(change: Change) -> bool:
    """Whether parts, boards, scenes or bills differ, and not figures of the mechanics or fields of
    [design]."""
    figure = change.path[-1] in ("stiffness_n_per_mm", "yield_force_n")
    return not (change.path[0] in ("date", "title", "kept") or (change.path[0] == "elements" and figure))


def _about(severity: Severity, change: Change) -> Finding:
    number = lambda v: float(v) if isinstance(v, int | float) else 0.0  # noqa: E731
    about = change.path[1] if len(change.path) > 1 else change.path[0]
    return Finding("golden", severity, about, (), number(change.new), number(change.old), str(change))


def _finding(severity: Severity, design: CommonTables, message: str) -> Finding:
    return Finding("golden", severity, design.name, (), 0, 0, message)


def compared(path: Path, design: CommonTables) -> tuple[Record | None, Record]:
    """The golden file's record, None if there is no file yet, and the design's.

    Raises CheckFailure if the file there cannot be read, or refutes a letter that the design keeps.
    """
    new = golden_record(design)
    if not path.exists():
        return None, new
    try:
        old = read_golden(path)
    except ValueError as error:
        raise CheckFailure(f"{error}; remove it or take it back from git") from None
    if wrong := wrong_letters(old, new):
        raise CheckFailure(f"{design.name}: {'; '.join(wrong)}; {path.name} is left as it was")
    return old, new


def accept(design: CommonTables, path: Path, failures: Sequence[Finding]) -> list[str]:
    """Write the golden file where anything changed.

    Parameters
    ----------
    design, path
        The design, and the path of its golden file.
    failures
        Failures found by the design's checks.

    Returns
    -------
    list of str
        Lines by which parts that did not change keep their letters; none if the letter stays, or it has them.

    Raises
    ------
    CheckFailure
        If a check failed, or the golden file's own revision has other content; nothing is then written. Also
        as `compared`.
    InputError
        If the file cannot be written.
    """
    left = f"{path.name} is left as it was"
    if failures:
        raise CheckFailure(f"{design.name}: {len(failures)} of the checks failed; {left}")
    old, new = compared(path, design)
    changes = changes_of(old, new) if old else []
    risen = old is not None and old["revision"] != new["revision"]
    if not risen and any(map(asks_for_letter, changes)):
        letter = design.design.revision
        raise CheckFailure(
            f"{design.name}: revision {letter} has other content than its golden file; "
            f"give the design a new revision letter; {left}"
        )
    unchanged = new["kept"] | (since(old, new) if old else {})
    if old is None or changes or "kept" not in old:
        make_folder(path.parent)
        write_whole(path, golden_bytes(new | {"unchanged": unchanged}))
    return to_paste(unchanged, design.design) if risen else []


# Entries of a part's record that are no plain values.
TABLES = ("holes", "pockets", "limits")
# What golden files hold since parts have letters of their own.
LETTERS = ("date", "title", "kept", "unchanged", "boards")


def faults(record: Any, schema: str) -> str:
    """The first fault, "" if there is none."""
    if not isinstance(record, dict) or record.get("schema") != schema:
        return f"its schema is not {schema}"
    if not all(isinstance(record.get(k), str) for k in ("design", "revision")):
        return "it has no design or no revision"
    for section in ("parts", "scenes", "elements", *({"boards"} & {*record})):
        if not _is_table_of(record.get(section), dict):
            return f"{section} is no table of tables"
    if unknown := set(record) - {"schema", "design", "revision", "parts", "scenes", "elements", *LETTERS}:
        return f"{sorted(unknown)[0]!r} is not known"
    if any(name in record for name in LETTERS) and (wrong := _letters_fault(record)):
        return wrong
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


def _letters_fault(record: Record) -> str:
    if lacking := [name for name in LETTERS if name not in record]:
        return f"it has no {lacking[0]}"
    if not all(isinstance(record[name], str) for name in ("date", "title")):
        return "its date or title is no text"
    for name in ("kept", "unchanged"):
        table = record[name]
        if not _is_table_of(table, list) or not all(
            [*map(type, row)] == [str, str] for row in table.values()
        ):
            return f"{name} is no table of letters and dates"
    whole = (_is_table_of(boards, dict) for boards in record["boards"].values())
    tables = (t for boards in record["boards"].values() for board in boards.values() for t in board.items())
    plain = (_is_flat(t) if isinstance(t, dict) else _is_flat({name: t}) for name, t in tables)
    return "" if all(whole) and all(plain) else "a board holds more than plain values"


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
        if not lists or not all(is_number(value) for row in rows for value in row):
            return "a contour is no list of rows of numbers"
        try:
            contour_of(rows)
        except ValueError as error:
            return f"a contour cannot be read: {error}"
    if not isinstance(part.get("sheet", {}), dict) or not _is_flat(part.get("sheet", {})):
        return "sheet is no plain row"
    rest = {k: v for k, v in part.items() if k not in (*TABLES, "contours", "sheet")}
    return "" if _is_flat(rest) else "it holds more than plain values"


def _is_table_of(value: Any, kind: type) -> bool:
    return isinstance(value, dict) and all(isinstance(v, kind) for v in value.values())


def _is_flat(row: dict[str, Any]) -> bool:
    return "contours" not in row and all(_is_plain(value) for value in row.values())


def _is_plain(value: Any) -> bool:
    """A number, text, truth value or null, or a list of such, or a list of lists of numbers."""
    if isinstance(value, list):
        return all(_is_plain(v) for v in value)
    return value is None or isinstance(value, str | bool) or is_number(value)


# --- letters of parts ---

Letters = Mapping[str, Sequence[str]]  # by part number: letter, date of issue


def kept_letters(identity: Identity, numbers: Sequence[str]) -> dict[str, list[str]]:
    """Those of the parts that keep an earlier letter."""
    issued = {number: identity.of_part(number) for number in numbers}
    return {n: [i.revision, i.date] for n, i in issued.items() if i.revision != identity.revision}


def with_letters(record: Record) -> Record:
    """All of a record that has a letter, by number: parts that are made, without their count, and boards."""
    made = {n: part for n, part in record["parts"].items() if part["process"] not in NOT_MADE}
    parts = {n: {k: v for k, v in part.items() if k != "qty"} for n, part in made.items()}
    return parts | record.get("boards", {})


def since(old: Record, new: Record) -> dict[str, Sequence[str]]:
    """Letter and date of the revision since which content is as it is, by what golden file `old` knows;
    without what changed or is new."""
    if "kept" not in old or old["title"] != new["title"]:  # the title is on every sheet
        return {}
    if old["revision"] == new["revision"]:
        letters = old["unchanged"]
    else:  # what was issued then, whatever could have been
        now = [old["revision"], old["date"]]
        letters = {number: old["kept"].get(number, now) for number in with_letters(old)}
    return _same(letters, old, new)


def _same(letters: Letters, old: Record, new: Record) -> dict[str, Sequence[str]]:
    """Those letters of parts whose content is the same in both records."""
    before, after = with_letters(old), with_letters(new)
    both = [number for number in after if number in before and number in letters]
    return {number: letters[number] for number in both if not differences(before[number], after[number])}


def wrong_letters(old: Record, new: Record) -> list[str]:
    """Reasons why parts of `new` cannot keep their letters, by what golden file `old` knows."""
    true, wrong = since(old, new), dict[str, list[str]]()
    for number, (letter, date) in new["kept"].items() if "kept" in old else ():
        if number not in true:
            why = f"changed since revision {letter}: take out of [design.unchanged.{letter}]"
        elif true[number] != [letter, date]:
            own, day = true[number]
            why = f"not as in revision {letter} of {date}, but {own} of {day}"
        else:
            continue
        wrong.setdefault(why, []).append(number)
    return [f"{', '.join(numbers)}: {why}" for why, numbers in wrong.items()]


def lines_since(old: Record, issued: Identity, new: Record, identity: Identity) -> list[str]:
    """As `to_paste`, from the old and new design's records, where there is no golden file."""
    issues = {n: issued.of_part(n) for n in with_letters(old)}
    return to_paste(_same({n: (i.revision, i.date) for n, i in issues.items()}, old, new), identity)


def to_paste(letters: Letters, identity: Identity) -> list[str]:
    """Lines for the design's file by which these parts keep these letters; none if it has them."""
    wanted = issues(letters, identity.name)
    as_sets = [{k: (i.date, {*i.parts}) for k, i in u.items()} for u in (wanted, identity.unchanged)]
    if as_sets[0] == as_sets[1]:
        return []
    said = "to keep the letters of parts that did not change, [design.unchanged] is all of this:"
    return [said, *unchanged_lines(wanted)]
