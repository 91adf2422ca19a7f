"""Tables of standard sizes beside this file: CSV, lines that start with # name the standards."""

from __future__ import annotations

import csv
from pathlib import Path


def rows(name: str) -> list[dict[str, str]]:
    """The rows of data/NAME.csv, in its order."""
    text = (Path(__file__).parent / "data" / f"{name}.csv").read_text(encoding="utf-8")
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))


def number(text: str) -> float:
    """A cell's number, in mm unless its table says otherwise; an integer stays an integer, as in part
    numbers.
    """
    return float(text) if "." in text else int(text)
