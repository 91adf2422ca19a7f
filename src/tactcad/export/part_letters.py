"""The letters of parts: one that has not changed since an earlier revision keeps that one's letter and date.

The design's file says which ([design.unchanged]). Golden files know since when a part is as it is, and so
refuse a letter that is not true. The circuit boards, which are equal, have one letter, as a part has.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from tactcad.design.design_text import issues, unchanged_lines
from tactcad.design.tree import Identity
from tactcad.parts.language.description import NOT_MADE

from .difference import differences
from .geometry import Record

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
