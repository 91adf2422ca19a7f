"""Tables: as plain data, as Markdown and CSV, in the documents; which rows are efficient; growth with
size.

A table is {"title", "columns": [{"key", "heading", "unit", "scale"}], "rows": [{key: value}], "note"}. Values
are in s, mm, bytes and ratios; a column's scale converts them to the unit in which it is shown. None means
not measured. In a document a table lies between `<!-- table NAME -->` and `<!-- end -->`.
"""

from __future__ import annotations

import argparse
import csv
import io
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import log, sqrt
from pathlib import Path

import numpy as np
from scipy.special import stdtrit

from tactcad.report.figures import sig

# How a value is shown by its unit: the value is in s, mm, rad, bytes, or a ratio.
SCALES = {"": 1.0, "s": 1.0, "ms": 1e3, "us": 1e6, "kB": 1e-3, "MB": 1e-6, "%": 100.0, "ppm": 1e6}
SCALES |= {"mm": 1.0, "rad": 1.0}


def table(columns: str, rows: list[dict], note: str = "", title: str = "") -> dict:
    """A table as data.

    Parameters
    ----------
    columns : "key", "key [unit]", "key: heading" or "key: heading [unit]" of each, a semicolon between two;
        without a heading the key is shown; units are those of SCALES.
    rows : a value by key for each row.
    title : if none is given, its benchmark's.
    """
    described = [_column(text.strip()) for text in columns.split(";")]
    return {"title": title, "columns": described, "rows": rows, "note": note}


def _column(text: str) -> dict:
    name, _, unit = text.removesuffix("]").partition(" [")
    key, _, heading = name.partition(": ")
    return {"key": key, "heading": heading or key, "unit": unit, "scale": SCALES[unit]}


def cell(column: dict, row: dict) -> str:
    """A value as shown: three digits, integers whole, nothing if it was not measured."""
    value = row.get(column["key"])
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, str):
        return value
    return str(value) if isinstance(value, int) and column["scale"] == 1.0 else sig(value * column["scale"])


def markdown(data: dict) -> str:
    """Without title and note."""
    heads = [c["heading"] + (f", {c['unit']}" if c["unit"] else "") for c in data["columns"]]
    rows = [[cell(c, row) for c in data["columns"]] for row in data["rows"]]
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


# --- in documents ---


def lines(heads: str, rows: Sequence[Sequence[object]]) -> str:
    """A Markdown table of rows of texts under heads that a bar divides."""
    shown = [f"| {heads} |", "|" + "---|" * (heads.count(" | ") + 1)]
    return "\n".join([*shown, *(f"| {' | '.join(map(str, row))} |" for row in rows)])


def filled(text: str, name: str, new: str) -> str:
    """The document with this table between the marks of that name, if it has them."""
    block = re.compile(rf"(<!-- table {re.escape(name)} -->\n).*?(<!-- end -->)", re.DOTALL)
    return block.sub(lambda m: f"{m[1]}{new}\n{m[2]}", text)


def renewed(text: str, tables: Mapping[str, Callable[[], str]]) -> str:
    """The document with those of the tables that it has made anew."""
    for name, make in tables.items():
        if f"<!-- table {name} -->" in text:
            text = filled(text, name, make())
    return text


def write_tables(doc: str | None, tables: Mapping[str, Callable[[], str]]) -> int:
    """The command of a script that writes its tables, or those named, into the document given."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("document", type=Path, help="Markdown file that has the tables' places")
    parser.add_argument("names", nargs="*", help=f"of {', '.join(tables)} (default: all)")
    asked = parser.parse_args()
    chosen = {name: make for name, make in tables.items() if name in (asked.names or tables)}
    asked.document.write_text(renewed(asked.document.read_text("utf-8"), chosen), "utf-8")
    return 0


# --- efficient choices: no other one is both as quick and as accurate ---


def efficient(points: Sequence[tuple[float, float]]) -> list[int]:
    """Indices of the (cost, error) pairs that no other one dominates, by growing cost.

    One dominates another if it is no worse in both and better in one. Of equal pairs all stay.
    """
    front: list[int] = []
    for i in sorted(range(len(points)), key=lambda i: points[i]):
        if not front or points[i][1] < points[front[-1]][1] or points[i] == points[front[-1]]:
            front.append(i)
    return front


def dominators(points: Sequence[tuple[float, float]]) -> dict[int, int]:
    """For every index that is not on the front the most accurate one that costs no more: the better
    choice."""
    front = efficient(points)
    beaten = [i for i in range(len(points)) if i not in front]
    return {
        i: min((j for j in front if points[j][0] <= points[i][0]), key=lambda j: points[j][1]) for i in beaten
    }


def told(names: Sequence[str], points: Sequence[tuple[float, float]]) -> str:
    """One sentence: the front, and the dominated ones."""
    front = ", ".join(names[i] for i in efficient(points))
    beaten = "; ".join(f"{names[i]} by {names[j]}" for i, j in dominators(points).items())
    return f"On the efficient front, quickest first: {front}." + (f" Dominated: {beaten}." if beaten else "")


def goal(name: str, reached: bool) -> str:
    return f"{'met' if reached else 'MISSED'}: {name}"


# --- how cost grows with size: cost = a size^p, by least squares of the logarithms ---


@dataclass(frozen=True)
class Exponent:
    """p with its 95 % interval (infinite with two points), and p between the two largest sizes alone."""

    value: float
    low: float
    high: float
    last: float


def exponent(sizes: Sequence[float], costs: Sequence[float]) -> Exponent:
    """Slope of log cost over log size, with Student's interval. Raises ValueError below two sizes.

    A fixed cost hides growth at small sizes: `last` is the slope between the two largest ones.
    """
    x, y = np.log(np.asarray(sizes, dtype=float)), np.log(np.asarray(costs, dtype=float))
    if len(np.unique(x)) < 2:
        raise ValueError("an exponent needs two sizes")
    dx = x - x.mean()
    slope = float(dx @ y / (dx @ dx))
    free, half = len(x) - 2, np.inf
    if free > 0:
        residual = y - y.mean() - slope * dx
        half = float(stdtrit(free, 0.975) * sqrt(residual @ residual / free / (dx @ dx)))
    order = np.argsort(x)[-2:]
    last = float(y[order[1]] - y[order[0]]) / log(sizes[order[1]] / sizes[order[0]])
    return Exponent(slope, slope - half, slope + half, last)
