"""Stock as bought: what a sheet's thickness may differ by where the design does not say."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from .data_table import data_rows
from .materials import family

# mm, plus and minus, of sheet that EN 485-4 does not hold for; chosen: measure it.
OTHER_SHEET = 0.1


def sheet_tolerance(thickness: float, density: float) -> float:
    """Plus and minus mm of a rolled sheet (mm) of that density (kg/m3): EN 485-4 where that is aluminium."""
    if family(density) != "aluminium":
        return OTHER_SHEET
    return next(tolerance for to, tolerance in _rows() if thickness <= to)


@cache
def _rows() -> tuple[tuple[float, float], ...]:
    rows = data_rows(Path(__file__).parent / "data" / "sheet_thickness.csv")
    return tuple((float(row["to"]), float(row["tolerance"])) for row in rows)
