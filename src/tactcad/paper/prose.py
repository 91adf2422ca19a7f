"""The report's words, from data/pages.toml, joined with what was computed.

A blank in them names a value and how it is written: `{g.scatter:percent}`. Which sentence is said, and which
cell is marked, the figures decide: that is beside what they are computed by, ../*.py.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from string import Formatter
from typing import TYPE_CHECKING, Any

from tactcad.report import figures, plots
from tactcad.report.figures import listed
from tactcad.report.report import Cell, Marked, Picture, ReportSection, ReportTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

# How a value is written, with the number of digits behind it ("sig4"); a span is a pair.
WRITTEN: dict[str, Callable[..., str]] = {
    "sig": figures.sig,
    "percent": figures.percent,
    "signed": figures.signed_percent,
    "whole": lambda ratio: f"{ratio * 100:+.0f} %",
    "exact": figures.exact,
    "span": lambda pair, *digits: figures.interval(*pair, *digits),
    "listed": listed,
    "nos": lambda numbers: listed(f"no. {n}" for n in numbers),
}


class _Blanks(Formatter):
    def format_field(self, value: Any, spec: str) -> str:
        name = spec.rstrip("0123456789")
        if name not in WRITTEN:
            return format(value, spec)
        return WRITTEN[name](value, *map(int, spec[len(name) :]))


write = _Blanks().format


@cache
def _pages() -> dict[str, Any]:
    return tomllib.loads((Path(__file__).parent / "data" / "pages.toml").read_text("utf-8"))


def saying(section: str, **known: object) -> Callable[..., str]:
    """A function from a finding's name to its sentence, given what its blanks need besides `known`."""

    def say(name: str, /, **said: object) -> str:
        return write(_pages()["finding"][section][name], **known, **said)

    return say


def section(
    key: str,
    findings: tuple[str, ...],
    tables: tuple[ReportTable, ...],
    pictures: tuple[Picture, ...],
    values: object,
    headline: tuple[str, ...] = (),
    **said: object,
) -> ReportSection:
    """The section of that key; `said` fills the blanks of its title and question, as below."""
    title, question = (write(_pages()["section"][key][part], **said) for part in ("title", "question"))
    return ReportSection(key, title, question, findings, tables, pictures, values, headline)


def table(name: str, *columns: Iterable[Any], **said: object) -> ReportTable:
    """The table of that name from its columns' cells; headings, units and digits are in the document."""
    heads = _pages()["table"][name]["columns"]
    cells = [[_cell(c, *how) for c in column] for column, (_, _, *how) in zip(columns, heads, strict=True)]
    return grid(name, ((write(h, **said), write(u, **said)) for h, u, *_ in heads), zip(*cells), **said)


def grid(
    name: str, columns: Iterable[tuple[str, str]], rows: Iterable[tuple[Cell, ...]], **said: object
) -> ReportTable:
    """The table of that name, with columns that are computed."""
    text = _pages()["table"][name]
    return ReportTable(
        write(text["title"], **said), tuple(columns), tuple(rows), write(text.get("note", ""), **said)
    )


def marked(cells: Iterable[Any], mask: Iterable[bool]) -> list[Any]:
    """Cells, Marked where the mask is true."""
    return [Marked(c) if mark else c for c, mark in zip(cells, mask)]


def _cell(cell: Any, how: str = "") -> Any:
    if not how:
        return cell
    if isinstance(cell, Marked):
        return Marked(_cell(cell.value, how))
    return write(f"{{:{how}}}", cell).replace("-", "−")


def drawn(figure: Canvas, name: str, **said: object) -> Picture:
    return plots.drawn(figure, name, write(_pages()["caption"][name], **said))


def effect_text(key: str, **said: object) -> tuple[str, str, str]:
    """Texts of an effect of the uncertainty budget: its name, the origin of its size, and its remedy."""
    text = _pages()["effect"][key]
    return text["name"], text["how"].format(**said), text["remedy"].format(**said)
