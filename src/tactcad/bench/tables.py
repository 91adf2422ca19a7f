"""Tables of a run as plain data, and how they are shown: text, Markdown, CSV.

A table is {"title", "columns": [{"key", "heading", "unit", "scale"}], "rows": [{key: value}], "note"}. Values
are in s, mm, bytes and ratios; a column's scale takes them to the unit in which it is shown. None is what was
not measured.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

from tactcad.paper.report import sig

PER_CENT = ("%", 100.0)
SECONDS, MILLI, MICRO = ("s", 1.0), ("ms", 1e3), ("us", 1e6)
KILO, MEGA = ("kB", 1e-3), ("MB", 1e-6)
PLAIN = ("", 1.0)


def table(
    title: str, columns: Sequence[tuple[str, str, tuple[str, float]]], rows: list[dict], note: str = ""
) -> dict:
    """columns: (key, heading, (unit, scale))."""
    described = [{"key": k, "heading": h, "unit": u, "scale": s} for k, h, (u, s) in columns]
    return {"title": title, "columns": described, "rows": rows, "note": note}


def cell(column: dict, row: dict) -> str:
    """A value as it is shown: three digits, integers whole, nothing where it was not measured."""
    value = row.get(column["key"])
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, str):
        return value
    scaled = value * column["scale"]
    return str(value) if isinstance(value, int) and column["scale"] == 1.0 else sig(scaled)


def _cells(data: dict, units_apart: bool) -> list[list[str]]:
    heads = [
        c["heading"] + (f", {c['unit']}" if c["unit"] and not units_apart else "") for c in data["columns"]
    ]
    units = [[c["unit"] for c in data["columns"]]] if units_apart else []
    return [heads, *units, *([cell(c, row) for c in data["columns"]] for row in data["rows"])]


def text(data: dict) -> str:
    """For a terminal: columns one below the other, words to the left."""
    lines = _cells(data, units_apart=True)
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    words = [any(isinstance(row.get(c["key"]), str) for row in data["rows"]) for c in data["columns"]]
    shown = [
        "  " + "  ".join(c.ljust(w) if t else c.rjust(w) for c, w, t in zip(line, widths, words)).rstrip()
        for line in lines
    ]
    return "\n".join([data["title"], *shown, *([f"  {data['note']}"] if data["note"] else [])])


def markdown(data: dict) -> str:
    """Without title and note."""
    heads, *rows = _cells(data, units_apart=False)
    lines = [[c.replace("|", "\\|") for c in line] for line in (heads, ["---"] * len(heads), *rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def as_csv(data: dict) -> str:
    """Every digit, in the units of the data: s, mm, bytes, ratios."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    keys = [c["key"] for c in data["columns"]]
    writer.writerow(keys)
    writer.writerows(["" if row.get(k) is None else row[k] for k in keys] for row in data["rows"])
    return out.getvalue()
