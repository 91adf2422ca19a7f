"""Tables of standard sizes, CSV in the folder `data` next to the module that reads them; lines that start
with # name the standards.
"""

from __future__ import annotations

from pathlib import Path

from tactcad.design.text_values import data_rows


def rows(module: str, name: str) -> list[dict[str, str]]:
    """The rows of data/NAME.csv beside a module (its `__file__`), in its order."""
    return data_rows(Path(module).with_name("data") / f"{name}.csv")


def number(text: str) -> float:
    """A cell's number, in mm unless its table says otherwise; an integer stays an integer, as in part
    numbers.
    """
    return float(text) if "." in text else int(text)
