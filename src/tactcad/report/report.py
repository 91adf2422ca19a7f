"""A report as data: sections of findings, tables and figures; written as one offline HTML page and as
JSON.
"""

from __future__ import annotations

import dataclasses
import html
import json
import re
from dataclasses import dataclass
from importlib.resources import files
from math import isfinite
from typing import TypeVar

import numpy as np

from .figures import sig

# Metadata of a field that only pictures are drawn from: it is left out of the JSON.
UNREPORTED = {"unreported": True}


def plain(value: object) -> object:
    """Dataclasses, arrays and NumPy numbers as dicts, lists and numbers; 'nan', 'inf', '-inf' as text, which
    JSON has no numbers for."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {
            f.name: plain(getattr(value, f.name))
            for f in dataclasses.fields(value)
            if not f.metadata.get("unreported")
        }
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float) and not isfinite(value):
        return str(value)
    return value


SCHEMA = "tactcad-validation-1"
T = TypeVar("T")


@dataclass(frozen=True)
class Marked:
    """A highlighted cell."""

    value: str | float


Cell = str | float | Marked  # numbers of numpy too


@dataclass(frozen=True)
class ReportTable:
    """Columns are (name, unit); cells are text, numbers, or Marked numbers that the text points at."""

    title: str
    columns: tuple[tuple[str, str], ...]
    rows: tuple[tuple, ...]
    note: str = ""


@dataclass(frozen=True)
class Picture:
    """An SVG picture as text; name is the file's without its ending."""

    name: str
    svg: str
    caption: str


@dataclass(frozen=True)
class ReportSection:
    key: str
    title: str
    question: str
    findings: tuple[str, ...]
    tables: tuple[ReportTable, ...] = ()
    figures: tuple[Picture, ...] = ()
    values: object = None  # the study's dataclass, for JSON
    headline: tuple[str, ...] = ()  # the findings that are also at the top of the report


@dataclass(frozen=True)
class ValidationReport:
    title: str
    subtitle: str
    summary: tuple[str, ...]
    sections: tuple[ReportSection, ...]
    colophon: str


def to_json(report: ValidationReport) -> str:
    """Findings, tables' numbers and every study's values; figures by name. NaN and infinities become text."""
    data = {
        "schema": SCHEMA,
        "title": report.title,
        "subtitle": report.subtitle,
        "summary": list(report.summary),
        "sections": {
            s.key: {
                "title": s.title,
                "findings": list(s.findings),
                "figures": [f.name for f in s.figures],
                "values": plain(s.values),
            }
            for s in report.sections
        },
    }
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def to_text(report: ValidationReport) -> str:
    """The findings for a terminal."""
    lines = [report.title, ""]
    for i, s in enumerate(report.sections, 1):
        lines += [f"{i}. {s.title}", *(f"   - {f}" for f in s.findings), ""]
    return "\n".join(lines).rstrip()


def standalone(figure: Picture) -> str:
    """The picture as a file of its own, on white."""
    start = figure.svg.index(">") + 1
    return (
        '<?xml version="1.0" encoding="utf-8"?>\n'
        + figure.svg[:start]
        + '<rect width="100%" height="100%" fill="#ffffff"/>'
        + figure.svg[start:]
    )


def to_html(report: ValidationReport) -> str:
    """One page with everything inside: style, pictures, tables."""
    e = html.escape
    style = (files("tactcad.report") / "data" / "report.css").read_text("utf-8")
    contents = "".join(f'<li><a href="#{s.key}">{e(s.title)}</a></li>' for s in report.sections)
    body = "".join(_section(i, s) for i, s in enumerate(report.sections, 1))
    head = (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{e(report.title)}</title>\n'
        '<meta name="viewport" content="width=device-width,initial-scale=1">\n'
        f"<style>\n{style}</style></head>\n<body>"
    )
    top = (
        f"<header><h1>{e(report.title)}</h1><p class=lead>{e(report.subtitle)}</p><h3>What stands "
        f"out</h3>{_list(report.summary)}<nav><h3>Contents</h3><ol>{contents}</ol></nav></header>\n"
    )
    return f"{head}{top}<main>{body}</main>\n<footer>{e(report.colophon)}</footer></body></html>\n"


def _section(number: int, s: ReportSection) -> str:
    e = html.escape
    return (
        f'\n<section id="{s.key}"><h2>{number}. {e(s.title)}</h2>'
        f"<p class=lead>{e(s.question)}</p>{_list(s.findings)}"
        + "".join(
            f'<figure id="{f.name}">{f.svg}<figcaption>{e(f.caption)}</figcaption></figure>'
            for f in s.figures
        )
        + "".join(_table(t) for t in s.tables)
        + "</section>"
    )


def _list(items: tuple[str, ...]) -> str:
    return "<ul class=findings>" + "".join(f"<li>{html.escape(i)}</li>" for i in items) + "</ul>"


def _table(t: ReportTable) -> str:
    e = html.escape
    text = [any(_wordy(row[i]) for row in t.rows) for i in range(len(t.columns))]
    head = "".join(
        f"<th{' class=text' if text[i] else ''}>{e(name)}{f'<small>{e(unit)}</small>' if unit else ''}</th>"
        for i, (name, unit) in enumerate(t.columns)
    )
    rows = "".join("<tr>" + "".join(_cell(c, text[i]) for i, c in enumerate(row)) + "</tr>" for row in t.rows)
    note = f"<p class=note>{e(t.note)}</p>" if t.note else ""
    return (
        f"<h3>{e(t.title)}</h3><div "
        f"class=scroll><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>{note}"
    )


def _wordy(cell: Cell) -> bool:
    """Whether a cell is words, not a number with its sign, unit or interval."""
    value = cell.value if isinstance(cell, Marked) else cell
    return isinstance(value, str) and bool(value) and not re.match(r"[+−±–×∞ \d.]", value)


def _cell(cell: Cell, text: bool) -> str:
    value = cell.value if isinstance(cell, Marked) else cell
    whole = isinstance(value, (str, int, np.integer))
    shown = str(value) if whole else sig(float(value))
    kinds = " ".join(k for k, on in (("text", text), ("mark", isinstance(cell, Marked))) if on)
    attribute = f' class="{kinds}"' if kinds else ""
    return f"<td{attribute}>{html.escape(shown)}</td>"
