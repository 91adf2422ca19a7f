"""Reads an inspection sheet that was filled in. Every refusal names file, line and column.

Rows and columns may be in any order, and there may be further columns. A design is issued again from its
measured elements: spacers as thick as pitch less measured sheet, and a place for each of the equal elements,
so that the stop plate lies level on both rows' ledges.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from itertools import permutations, product
from math import factorial, isclose, isfinite, prod
from pathlib import Path
from typing import Any

from tactcad.design.csv_table import Table, decimal_commas, number, read_table, require_columns
from tactcad.design.messages import InputError
from tactcad.design.tree import Design
from tactcad.export.inspection import COLUMNS, UNIT
from tactcad.parts.array.element import LEDGE, MEASURED, element_number
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.measurements import Measurement, measurements

NEEDED = tuple(c for c in COLUMNS if c not in ("key", "where", "how"))
LIMITS = ("nominal", "lower", "upper")
FACTOR = 5.0  # a value further from its nominal, up or down, is in another unit or mistyped
SLIP = "the decimal point slipped"
UNITS_TAKEN = (
    (1e3, "in micrometres"),
    (1e-3, "in metres"),
    (1 / 25.4, "in inches"),
    (10.0, SLIP),
    (0.1, SLIP),
)
WIDEST = 5.0  # an uncertainty of more tolerances than this is in another unit or mistyped


@dataclass(frozen=True)
class Reading:
    """One row of the sheet: a dimension of an element. None if the cell is blank."""

    number: int  # of the element
    dimension: Measurement
    measured: float | None  # mm
    uncertainty: float | None  # mm, expanded, k = 2
    line: int  # of the sheet

    @property
    def verdict(self) -> str:
        """ "blank"; "outside" or "inside" the tolerance; "undecided" where the uncertainty reaches across a
        limit."""
        if self.measured is None:
            return "blank"
        u, d = self.uncertainty or 0.0, self.dimension
        slack = 1e-9  # 0.245 + 0.01 is no binary fraction
        if self.measured + u < d.lower - slack or self.measured - u > d.upper + slack:
            return "outside"
        if d.lower - slack <= self.measured - u and self.measured + u <= d.upper + slack:
            return "inside"
        return "undecided" if u else "outside"


def read_sheet(path: str | Path, layout: Layout) -> list[Reading]:
    """Every row of an inspection sheet.

    Parameters
    ----------
    path : str or Path
    layout : Layout
        Of the design that the sheet was exported with.

    Returns
    -------
    list of Reading
        By element number, and for each element in the order of its dimensions.

    Raises
    ------
    InputError
        The file is not this design's sheet with every row, has something changed that was not to be filled
        in, or holds a measured value or an uncertainty that cannot be one.
    """
    table = read_table(path, "an inspection sheet (CSV)", comments=False)
    require_columns(table, NEEDED)
    rows = [_Row(table, line, cells) for line, cells in table.records]
    preset = (row[name] for row in rows for name in LIMITS)
    commas = table.delimiter != "," and decimal_commas(preset)
    known = {
        (p.designator, m.name): (p.number, part_no, m) for p, part_no, ms in measurements(layout) for m in ms
    }
    readings: dict[tuple[str, str], Reading] = {}
    for row in rows:
        key = _identified(row, layout, known)
        if key in readings:
            raise row.refusal("characteristic", f"is already on line {readings[key].line}", legal="each once")
        number, part_no, dimension = known[key]
        _check_unchanged(row, part_no, dimension, commas)
        readings[key] = _reading(row, number, dimension, commas)
    for designator, name in known:
        if (designator, name) not in readings:
            what = f"the row {name!r} of element {designator} is missing"
            legal = "every row of the sheet, in any order; leave cells blank where nothing was measured"
            raise InputError(f"{table.path}:{rows[-1].line + 1}:1", what, legal=legal)
    return [readings[key] for key in known]


@dataclass(frozen=True)
class _Row:
    table: Table
    line: int
    cells: list[str]

    def __getitem__(self, name: str) -> str:
        return self.cells[self.table.header.index(name)]

    def refusal(self, name: str, what: str, legal: str = "") -> InputError:
        return InputError(self.table.where(self.line, name), f"{name}: {what}", value=self[name], legal=legal)


def _identified(row: _Row, layout: Layout, known: dict) -> tuple[str, str]:
    design = layout.design
    if row["design"] != design.name:
        raise row.refusal("design", "a sheet of another design", legal=design.name)
    key = (row["element"], row["characteristic"])
    of = design.design.of_part(known[key][1]) if key in known else None
    if of and row["revision"] != of.revision:
        raise row.refusal("revision", "a sheet of another revision", legal=of.revision)
    last = layout.elements[-1].designator
    if row["element"] not in {designator for designator, _ in known}:
        raise row.refusal("element", "no such element", legal="E1" if last == "E1" else f"E1 to {last}")
    if key not in known:
        raise row.refusal(
            "characteristic",
            f"element {key[0]} has no such dimension",
            legal=", ".join(name for designator, name in known if designator == key[0]),
        )
    return key


def _check_unchanged(row: _Row, part_no: str, dimension: Measurement, commas: bool) -> None:
    """Raise InputError if the row's preset cells differ from the exported sheet's."""
    for name, meant in (("part_no", part_no), ("unit", UNIT)):
        if row[name] != meant:
            raise row.refusal(name, "not what the sheet came with", legal=meant)
    for name in LIMITS:
        meant = getattr(dimension, name)
        if not isclose(_number(row, name, commas), meant, rel_tol=0, abs_tol=1e-6):
            raise row.refusal(name, "not what the sheet came with", legal=f"{meant!r} {UNIT}")


def _reading(row: _Row, number: int, dimension: Measurement, commas: bool) -> Reading:
    measured = _number(row, "measured", commas) if row["measured"] else None
    uncertainty = _number(row, "uncertainty_k2", commas) if row["uncertainty_k2"] else None
    if measured is not None and not dimension.nominal / FACTOR < measured < dimension.nominal * FACTOR:
        raise row.refusal(
            "measured",
            f"cannot be the {dimension.name}{_guess(measured / dimension.nominal)}",
            legal=f"{UNIT}; nominal {dimension.nominal!r}",
        )
    if uncertainty is not None:
        if measured is None:
            raise row.refusal("uncertainty_k2", "belongs to no measured value")
        most = WIDEST * (dimension.upper - dimension.lower) / 2
        if not 0.0 <= uncertainty <= most:
            raise row.refusal(
                "uncertainty_k2", "cannot be its uncertainty", legal=f"0 to {most:.3g} {UNIT} (k = 2)"
            )
    return Reading(number, dimension, measured, uncertainty, row.line)


def _guess(ratio: float) -> str:
    """The likely mistake in a value that is `ratio` times its nominal, in brackets; "" if none fits."""
    likely = [text for factor, text in UNITS_TAKEN if 0.8 < ratio / factor < 1.25]
    return f" ({likely[0]}?)" if likely else ""


def _number(row: _Row, name: str, commas: bool) -> float:
    text = row[name]
    if commas and "." in text:
        raise row.refusal(name, "not a number with a decimal comma, as this sheet has them")
    value = number(text.replace(",", ".") if commas else text)
    if not isfinite(value):
        raise row.refusal(name, "not a number", legal="digits with a decimal point, as 0.25")
    return value


STEP = 0.001  # mm, rounding of a spacer's ordered thickness; its tolerance is separate
MOST_WAYS = 50_000  # orders of equal elements that are all tried; beyond, neighbours are exchanged


@dataclass(frozen=True)
class Reissued:
    """The design that follows from the readings.

    design      with sheet and spacer as measured, its revision followed by M
    sheet       mean thickness of the elements, mm, and their number
    elements    by place, the number of the measured element there
    lean        mean height of one row's ledges above the other's, mm; None if none was measured
    """

    design: Design
    sheet: float
    count: int
    elements: dict[int, int]
    lean: float | None

    @property
    def lines(self) -> list[str]:
        """The report's lines."""
        d = self.design
        moved = [f"E{m} at E{n}" for n, m in self.elements.items() if m != n]
        lean = "" if self.lean is None else f"; rows' ledges then differ by {abs(self.lean) * 1e3:.1f} um"
        return [
            f"{d.name} revision {d.design.revision}: sheet {self.sheet:.3f} mm (mean of {self.count}), so "
            f"spacers of "
            f"{Layout(d).spacer:.3f} mm",
            f"elements as measured: {', '.join(moved) if moved else 'each at its own number'}{lean}",
        ]

    @property
    def record(self) -> dict[str, Any]:
        return {
            "revision": self.design.design.revision,
            "sheet_mm": self.sheet,
            "of_elements": self.count,
            "spacer_mm": Layout(self.design).spacer,
            "elements": {f"E{place}": f"E{which}" for place, which in self.elements.items()},
            "ledges_lean_mm": self.lean,
        }


def reissued(design: Design, path: str | Path) -> Reissued:
    """The design, as the filled inspection sheet of its elements makes it.

    Raises
    ------
    InputError
        If the sheet is not this design's, cannot be read, or holds no sheet thickness.
    """
    layout = Layout(design)
    readings = read_sheet(path, layout)
    sheets = [
        r.measured for r in readings if r.dimension.name == "sheet thickness" and r.measured is not None
    ]
    if not sheets:
        legal = "at least one element's row `sheet thickness`, mm"
        raise InputError(str(path), "no sheet thickness is measured", legal=legal)
    sheet = round(sum(sheets) / len(sheets), 6)
    spacer = round(design.array.pitch - round(sheet / STEP) * STEP, 6)
    said = (
        f"{MEASURED} {Path(path).name}, SHA-256 {sha256(Path(path).read_bytes()).hexdigest()[:16]}, "
        f"sheet {sheet:.3f} mm (mean of {len(sheets)})"
    )
    made = replace(
        design,
        design=replace(design.design, revision=f"{design.design.revision}M", unchanged={}),
        sheet=replace(design.sheet, thickness=round(sheet / STEP) * STEP),
        array=replace(design.array, spacer=spacer),
        origin={**design.origin, "array.spacer": said, "sheet.thickness": said},
    )
    elements, lean = _paired(layout, readings)
    return Reissued(made, sheet, len(sheets), elements, lean)


def _paired(layout: Layout, readings: Sequence[Reading]) -> tuple[dict[int, int], float | None]:
    """The measured element for each place: equal ones are exchanged until the mean heights of the rows'
    ledges differ least; of equal ways the first. And that difference, mm."""
    ledge = {r.number: r.measured for r in readings if r.dimension.name == LEDGE and r.measured is not None}
    places = [p.number for p in layout.elements]
    row = {p.number: p.row for p in layout.elements}
    as_numbered = dict(zip(places, places))
    if len(ledge) < len(places) or len(set(row.values())) < 2:
        return as_numbered, None
    kinds: defaultdict[str, list[int]] = defaultdict(list)
    for p in layout.elements:
        kinds[element_number(layout.design, p)].append(p.number)

    def apart(way: dict[int, int]) -> float:
        means = [[ledge[way[n]] for n in places if row[n] == r] for r in sorted(set(row.values()))]
        first, second = (sum(v) / len(v) for v in means)
        return first - second

    groups = [*kinds.values()]
    if prod(factorial(len(g)) for g in groups) > MOST_WAYS:
        return _exchanged(as_numbered, groups, apart)
    ways = (
        as_numbered | {n: m for group, order in zip(groups, orders) for n, m in zip(group, order)}
        for orders in product(*(permutations(g) for g in groups))
    )
    best = min(ways, key=lambda way: round(abs(apart(way)), 9))
    return best, round(apart(best), 6)


def _exchanged(way: dict[int, int], groups: Sequence[list[int]], apart: Any) -> tuple[dict[int, int], float]:
    """Two equal elements after the other are exchanged while that levels the ledges."""
    better = True
    while better:
        better = False
        for group in groups:
            for i, a in enumerate(group):
                for b in group[i + 1 :]:
                    other = way | {a: way[b], b: way[a]}
                    if abs(apart(other)) < abs(apart(way)) - 1e-9:
                        way, better = other, True
    return way, round(apart(way), 6)
