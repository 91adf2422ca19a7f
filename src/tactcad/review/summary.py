"""Consequences in words: a list for the terminal, Markdown for a pull request, a table for the page."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from html import escape
from typing import Any

from tactcad.export.difference import Change
from tactcad.export.sides import Side, not_compared
from tactcad.scenes import stated_size

from .consequences import Consequence, Meaning
from .effect import FIGURES, ChangedFigure, SensorEffect

# Of each list in a Markdown summary; together at most MOST_LINES.
MOST_LINES, MOST_CAUSES, MOST_TURNED, MOST_NOTES, MOST_NAMES = 60, 24, 8, 4, 8
MOST_TEXT = 160  # characters of a cause in a table
PLAIN = str.maketrans({"`": "'", "|": "\u00a6", "<": "\u2039"})  # similar characters that are no markup
COLUMNS = (*FIGURES.values(), "yield", "mass", "cut length")


def cause_lines(c: Consequence) -> list[str]:
    """A cause's consequences, in lines."""
    return [*_how(c), *effect_lines(c.effect, title=c.kind == "title block")]


def lines(meaning: Meaning) -> Iterator[str]:
    """For the terminal: each cause, largest consequence first, with its consequences below."""
    if meaning.consequences:
        yield "causes, largest consequence first:"
    for c in meaning.consequences:
        yield f"  {c.what}"
        yield from (f"      {line}" for line in cause_lines(c))
    if meaning.together and len([c for c in meaning.consequences if c.kind == "value"]) != 1:
        yield "  all together"
        yield from (f"      {line}" for line in effect_lines(meaning.together))
    yield from (f"  not the sum: {line}" for line in meaning.interactions)
    yield from meaning.unchanged


def as_record(meaning: Meaning) -> dict[str, Any]:
    """Plain data for JSON: relative changes with old and new values."""
    record = asdict(meaning)
    effects = [c["effect"] for c in record["consequences"]] + [record["together"] or {}]
    for effect in effects:
        figures = [effect.get(name) for name in ("mass", "cut_length", "yield_share")]
        figures += [element[name] for element in effect.get("elements", ()) for name in FIGURES]
        for figure in figures:
            if figure is not None:
                figure["relative"] = ChangedFigure(**figure).change
    return record


def markdown(old: Side, new: Side, changes: Sequence[Change], meaning: Meaning) -> str:
    """A summary for a pull request, at most MOST_LINES lines; omitted lines are counted. Texts of the designs
    are quoted as code, so that they are never markup, links or mentions."""
    told = [f"### {_code(new.design)} {_code(old.source)} → {_code(new.source)}", ""]
    told += [f"Revision {_code(old.revision)} → {_code(new.revision)}; {len(changes)} differences.", ""]
    if meaning.consequences:
        told += [f"| cause, by its consequence | {' | '.join(COLUMNS)} |", "|---" * (len(COLUMNS) + 1) + "|"]
        for c in meaning.consequences[:MOST_CAUSES]:
            told.append(f"| {_code(c.what)}{_aside(c)} | {' | '.join(_cells(c.effect))} |")
        if meaning.together and len(meaning.consequences) > 1:
            told.append(f"| **together** | {' | '.join(_cells(meaning.together))} |")
        if more := len(meaning.consequences) - MOST_CAUSES:
            told += ["", f"… and {more} more causes."] if more > 0 else []
        told.append("")
    told += _some([f"- Not the sum: {line}." for line in meaning.interactions], MOST_NOTES, "elements")
    for effect in meaning.effects:
        lists = [(title, [*map(_code, names)]) for title, names in _lists(effect) if names]
        told += [f"- {title}: {_shortened(names)}." for title, names in lists]
        turned = [f"- **now** {_code(text)}" for text in effect.now]
        turned += [f"- no longer {_code(text)}" for text in effect.no_longer]
        told += _some(turned, MOST_TURNED, "findings that turned")
    untold = [*not_compared(old, new), *meaning.untold]
    told += _some([f"- Not compared: {_code(text)}." for text in untold], MOST_NOTES, "not compared")
    if not changes and not meaning.consequences:
        told.append("No difference.")
    while told and not told[-1]:
        told.pop()
    if len(told) > MOST_LINES:
        told[MOST_LINES - 1 :] = [f"- … and {len(told) - MOST_LINES + 1} more lines."]
    return "\n".join(told) + "\n"


def rows(meaning: Meaning) -> list[tuple[str, ...]]:
    """The consequences as a table: a heading, then a row for each cause."""
    told = [
        (c.what, *_cells(c.effect), "; ".join(_words(c.effect, c.kind == "title block")))
        for c in meaning.consequences
    ]
    return [("cause, by its consequence", *COLUMNS, "besides"), *told]


def html(meaning: Meaning) -> Iterator[str]:
    """The consequences as a section of the page of differences."""
    if not meaning.consequences and not meaning.together:
        return
    yield "<h2>What it means</h2>"
    head = "".join(f"<th>{escape(name)}</th>" for name in COLUMNS)
    yield f'<table class="meaning"><tr><th class="cause">cause, by its consequence</th>{head}</tr>'
    rows = [(c.what, [*_how(c)], c.effect, c.kind == "title block") for c in meaning.consequences]
    if meaning.together:
        rows.append(("all together", [], meaning.together, False))
    for what, how, effect, title in rows:
        cells = "".join(f"<td>{escape(cell)}</td>" for cell in _cells(effect))
        yield f"<tr><td>{escape(what)}</td>{cells}</tr>"
        if said := [*how, *_words(effect, title)]:
            text = "<br>".join(map(escape, said))
            yield f'<tr class="said"><td colspan="{len(COLUMNS) + 1}">{text}</td></tr>'
    yield "</table>"
    yield from (f'<p class="note">Not the sum: {escape(line)}.</p>' for line in meaning.interactions)
    yield from (f'<p class="note">Not compared: {escape(text)}.</p>' for text in meaning.untold)


def _how(c: Consequence) -> Iterator[str]:
    if c.how == "taken back":
        yield f"as the last of all changes; first of all it is refused: {c.why}"
    if c.how == "together only":
        yield f"only together with others; alone it is refused: {c.why}"


def _aside(c: Consequence) -> str:
    asides = {"taken back": " (as the last change)", "together only": " (**only together with others**)"}
    return asides.get(c.how, "")


def effect_lines(effect: SensorEffect, title: bool = False) -> Iterator[str]:
    """An effect in lines: figures on one, then what they do not say."""
    figures = [f"{name} {cell}" for name, cell in zip(COLUMNS, _cells(effect)) if cell]
    if figures:
        yield ", ".join(figures) + _whose(effect)
    yield from _words(effect, title)


def _words(effect: SensorEffect, title: bool) -> Iterator[str]:
    """The effects without a column."""
    if title:
        yield f"title blocks of {len(effect.sheets)} sheets"
        return
    if effect.size and len({*map(stated_size, effect.size)}) > 1:
        yield "overall size: " + " -> ".join(map(stated_size, effect.size))
    yield from (f"now {text}" for text in effect.now)
    yield from (f"no longer {text}" for text in effect.no_longer)
    yield from (f"{name}: {_shortened(names)}" for name, names in _lists(effect) if names)


def _lists(effect: SensorEffect) -> Iterator[tuple[str, Sequence[str]]]:
    yield "elements added", effect.elements_added
    yield "elements removed", effect.elements_removed
    yield "scenes added", effect.scenes_added
    yield "scenes removed", effect.scenes_removed
    yield "new parts", effect.parts_added
    yield "parts no longer made", effect.parts_removed
    yield "same number, other content: revision must change", effect.same_letter
    yield "sheets to issue anew", effect.sheets
    yield "bill", [f"{number} {a:g} -> {b:g}" for number, (a, b) in effect.bill.items()]


def _cells(effect: SensorEffect) -> list[str]:
    """A cell of each of COLUMNS, empty if nothing changes."""
    cells = [_range([e.figures[n].change for e in effect.elements if n in e.figures]) for n in FIGURES]
    share, mass, cut = effect.yield_share, effect.mass, effect.cut_length
    cells.append(f"{100 * share.old:.4g} -> {100 * share.new:.4g} %" if share else "")
    cells.append(f"{mass.new - mass.old:+.3g} g" if mass else "")
    cells.append(f"{cut.new - cut.old:+.4g} mm" if cut else "")
    return cells


def _range(changes: Sequence[float]) -> str:
    """Relative changes in per cent, from the least to the largest."""
    if not changes:
        return ""
    low, high = 100 * min(changes), 100 * max(changes)
    if f"{low:.2g}" == f"{high:.2g}":
        return f"{high:+.2g} %"
    return f"{low:+.3g} to {high:+.3g} %"


def _whose(effect: SensorEffect) -> str:
    """Elements by their designators now; three and more that follow each other as a range."""
    runs: list[list[str]] = []
    for e in effect.elements:
        name = e.new if e.new == e.old else f"{e.new} (was {e.old})"
        if runs and name == _next(runs[-1][-1]):
            runs[-1].append(name)
        else:
            runs.append([name])
    names = [n for run in runs for n in ([f"{run[0]} to {run[-1]}"] if len(run) > 2 else run)]
    return f"; {_shortened(names)}" if names else ""


def _next(name: str) -> str:
    """The designator after this one; "" of what is none."""
    return f"E{int(name[1:]) + 1}" if re.fullmatch("E[0-9]{1,4}", name) else ""


def _shortened(names: Sequence[str]) -> str:
    some = ", ".join(names[:MOST_NAMES])
    return some if len(names) <= MOST_NAMES else f"{some} and {len(names) - MOST_NAMES} more"


def _some(told: Sequence[str], most: int, what: str) -> list[str]:
    return [*told[:most]] + ([f"- … and {len(told) - most} more {what}."] if len(told) > most else [])


def _code(text: str) -> str:
    """A span of code in a table: on one line, without characters that would end span or cell, or be a tag or
    link to readers without spans."""
    plain = " ".join(text.split()).translate(PLAIN).replace("](", "] (")
    plain = plain.encode(errors="backslashreplace").decode()
    return f"`{plain if len(plain) <= MOST_TEXT else plain[: MOST_TEXT - 1] + '…'}`"
