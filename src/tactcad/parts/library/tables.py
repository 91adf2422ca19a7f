"""Tables of standard sizes beside this file: CSV, lines that start with # name the standards."""

from __future__ import annotations

from pathlib import Path

from tactcad.design.data_table import data_rows


def rows(name: str) -> list[dict[str, str]]:
    """The rows of data/NAME.csv, in its order."""
    return data_rows(Path(__file__).parent / "data" / f"{name}.csv")


def number(text: str) -> float:
    """A cell's number, in mm unless its table says otherwise; an integer stays an integer, as in part
    numbers.
    """
    return float(text) if "." in text else int(text)
