"""Tables of a run as plain data, and how they are shown: text, Markdown, CSV.

A table is {"title", "columns": [{"key", "heading", "unit", "scale"}], "rows": [{key: value}], "note"}. Values
are in s, mm, bytes and ratios; a column's scale converts them to the unit in which it is shown. None means
not measured.
"""

from __future__ import annotations

import csv
import io

from tactcad.paper.report import sig

# How a value is shown by its unit: the value is in s, mm, rad, bytes, or a ratio.
SCALES = {"": 1.0, "s": 1.0, "ms": 1e3, "us": 1e6, "kB": 1e-3, "MB": 1e-6, "%": 100.0, "ppm": 1e6}
SCALES |= {"mm": 1.0, "rad": 1.0}


def table(title: str, columns: str, rows: list[dict], note: str = "") -> dict:
    """A table as data.

    Parameters
    ----------
    columns : "key", "key [unit]", "key: heading" or "key: heading [unit]" of each, a semicolon between two;
        without heading the key stands above; units are those of SCALES.
    rows : a value by key for each row.
    """
    described = [_column(text.strip()) for text in columns.split(";")]
    return {"title": title, "columns": described, "rows": rows, "note": note}


def _column(text: str) -> dict:
    name, _, unit = text.removesuffix("]").partition(" [")
    key, _, heading = name.partition(": ")
    return {"key": key, "heading": heading or key, "unit": unit, "scale": SCALES[unit]}


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
