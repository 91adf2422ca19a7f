"""The report's prose that no figure changes, from data/pages.toml, joined with what was computed."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from tactcad.report import plots, report
from tactcad.report.report import Cell, Picture, ReportSection, ReportTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

T = TypeVar("T")


@cache
def _pages() -> dict[str, Any]:
    return tomllib.loads((Path(__file__).parent / "data" / "pages.toml").read_text("utf-8"))


def section(
    key: str,
    findings: tuple[str, ...],
    tables: tuple[ReportTable, ...],
    figures: tuple[Picture, ...],
    values: object,
    headline: tuple[str, ...] = (),
    **said: object,
) -> ReportSection:
    """The section of that key; `said` fills the blanks of its title and question, as below."""
    title, question = (_pages()["section"][key][part].format(**said) for part in ("title", "question"))
    return ReportSection(key, title, question, findings, tables, figures, values, headline)


def table(
    name: str, columns: tuple[tuple[str, str], ...], rows: tuple[tuple, ...], **said: object
) -> ReportTable:
    text = _pages()["table"][name]
    return ReportTable(text["title"].format(**said), columns, rows, text.get("note", "").format(**said))


def tabulated(
    name: str, items: Iterable[T], *columns: tuple[str, str, Callable[[T], Cell]], **said: object
) -> ReportTable:
    text = _pages()["table"][name]
    note = text.get("note", "").format(**said)
    return report.tabulated(text["title"].format(**said), items, *columns, note=note)


def drawn(figure: Canvas, name: str, **said: object) -> Picture:
    return plots.drawn(figure, name, _pages()["caption"][name].format(**said))


def effect_text(key: str, **said: object) -> tuple[str, str, str]:
    """Texts of an effect of the uncertainty budget: its name, the origin of its size, and its remedy."""
    text = _pages()["effect"][key]
    return text["name"], text["how"].format(**said), text["remedy"].format(**said)
