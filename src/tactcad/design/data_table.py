"""Tables of data that ship with the program: CSV, lines that start with # say where the figures are from."""

from __future__ import annotations

import csv
from pathlib import Path


def data_rows(path: Path) -> list[dict[str, str]]:
    """The rows of a table, in its order."""
    lines = path.read_text("utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))
