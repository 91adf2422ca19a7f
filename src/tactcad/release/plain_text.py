"""Paragraphs, lists and tables of a plain text, 96 columns."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import wrap

WIDTH = 96


def paragraph(text: str, indent: str = "", first: str | None = None) -> list[str]:
    """The text in lines, and an empty one after it; `first` begins the first line where not `indent`."""
    start = indent if first is None else first
    return [*wrap(text, WIDTH, initial_indent=start, subsequent_indent=indent, break_on_hyphens=False), ""]


def numbered(texts: Sequence[str]) -> list[str]:
    lines: list[str] = []
    for n, text in enumerate(texts, start=1):
        lines += paragraph(text, "    ", f"{n:2}. ")[:-1]
    return [*lines, ""]


def heading(text: str, line: str = "-") -> list[str]:
    return [text, line * len(text)]


def table(heads: Sequence[str], groups: Sequence[tuple[str, Sequence[Sequence[str]]]]) -> list[str]:
    """Rows below their heads, group by group, each with its title; the last column is wrapped."""
    rows = [row for _, group in groups for row in group]
    widths = [max(len(row[i]) for row in (heads, *rows)) for i in range(len(heads) - 1)]
    left = "  " + " " * sum(w + 2 for w in widths)

    def line(row: Sequence[str]) -> list[str]:
        start = "  " + "".join(cell.ljust(w + 2) for cell, w in zip(row, widths))
        last = wrap(row[-1], max(WIDTH - len(start), 24)) or [""]
        return [(start + last[0]).rstrip(), *(left + more for more in last[1:])]

    lines = line(heads)
    for title, group in groups:
        lines += ["", f"{title}:"] if title else []
        for row in group:
            lines += line(row)
    return [*lines, ""]


def as_bytes(lines: Sequence[str]) -> bytes:
    """UTF-8 with line ends that every editor shows."""
    return ("\r\n".join(lines).rstrip() + "\r\n").encode()
