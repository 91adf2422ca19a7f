"""A record's figures, declared once: text, CSV and JSON are made from them.

A declaration that lacks something, that names what the record does not have, or that leaves out one of the
record's numbers is refused at import. Numbers in sentences are written by `sig` and its kin.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from math import floor, isfinite, isinf, isnan, log10
from typing import Any, TypeVar, get_args, get_type_hints

T = TypeVar("T")


@dataclass(frozen=True)
class Figure:
    """A number of a record, as people and programs read it.

    name     its field; a dot leads on into a record that the field holds ("stiffness.value")
    heading  its heading in a table
    unit     in which it is shown; "" of a count or a ratio
    scale    shown number per number of the record
    digits   its format, such as ".4g"
    column   its name in CSV; by default the field's with the unit ("rated_force_N", "stiffness_N_per_mm")
    """

    name: str
    heading: str
    unit: str
    scale: float
    digits: str
    column: str = ""

    def __post_init__(self) -> None:
        if lacking := [name for name in ("name", "heading", "digits") if not getattr(self, name)]:
            raise TypeError(f"figure {self.name!r} lacks its {' and '.join(lacking)}")
        if not (isfinite(self.scale) and self.scale):
            raise TypeError(f"figure {self.name!r}: a scale of {self.scale}")
        try:
            format(1 if self.digits == "d" else 1.0, self.digits)
        except ValueError as error:
            raise TypeError(f"figure {self.name!r}: digits {self.digits!r}: {error}") from None
        if not self.column:
            unit = self.unit.replace("/", "_per_")
            column = "_".join(filter(None, (self.name.removesuffix(".value").replace(".", "_"), unit)))
            object.__setattr__(self, "column", column)

    @property
    def title(self) -> str:
        """Heading and unit in one line."""
        return f"{self.heading} {self.unit}".rstrip()

    def of(self, record: Any) -> Any:
        """The value in the record, or in its JSON: not scaled."""
        for name in self.name.split("."):
            record = record[name] if isinstance(record, Mapping) else getattr(record, name)
        return record

    def value(self, record: Any) -> Any:
        """The number in its unit, None if the record has none."""
        value = self.of(record)
        return None if value is None else self._scaled(value)

    def text(self, record: Any, without: str = "") -> str:
        """The number with its digits; `without` if the record has none."""
        return self.written(self.of(record), without)

    def written(self, value: float | None, without: str = "") -> str:
        """A number in the record's unit as this figure is written."""
        return without if value is None else format(self._scaled(value), self.digits)

    def _scaled(self, value: Any) -> Any:
        return value if self.scale == 1.0 else value * self.scale

    def shown_as(self, **other: Any) -> Figure:
        """The same figure with another display."""
        return replace(self, **({"column": ""} | other))


class Figures(Mapping[str, Figure]):
    """All figures of one kind of record, by name.

    Parameters
    ----------
    record : type
        A dataclass.
    *figures : Figure
        In the order in which tables have them.
    without : sequence of str
        Fields with numbers that no table shows.

    Raises
    ------
    TypeError
        A figure is declared twice, or is not a field of the record; a number of the record has no figure.
    """

    def __init__(self, record: type, *figures: Figure, without: Sequence[str] = ()) -> None:
        self._by_name = {figure.name: figure for figure in figures}
        names = [figure.name for figure in figures]
        if twice := sorted({name for name in names if names.count(name) > 1}):
            raise TypeError(f"{record.__name__}: declared twice: {', '.join(twice)}")
        numbers = set(_numbers(record))
        if unknown := [name for name in (*names, *without) if name not in numbers]:
            raise TypeError(f"{record.__name__} has no number {', '.join(unknown)}")
        if missing := sorted(numbers - set(names) - set(without)):
            raise TypeError(f"{record.__name__}: no figure is declared for {', '.join(missing)}")
        _DECLARED[record] = self

    def __getitem__(self, name: str) -> Figure:
        return self._by_name[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._by_name)

    def __len__(self) -> int:
        return len(self._by_name)

    def some(self, *names: str) -> tuple[Figure, ...]:
        """These figures, in this order."""
        return tuple(self[name] for name in names)


_DECLARED: dict[type, Figures] = {}


def declared(record: type) -> list[Figure]:
    """The figures of a kind of record, in the order of tables; none if none are declared."""
    return [*_DECLARED.get(record, {}).values()]


def _numbers(record: type) -> Iterator[str]:
    """Names of a dataclass's numbers, with those of the dataclasses that it holds."""
    hints = get_type_hints(record)
    for f in fields(record):
        kinds = get_args(hints[f.name]) or (hints[f.name],)
        held = hints[f.name]
        if is_dataclass(held) and isinstance(held, type):
            yield from (f"{f.name}.{name}" for name in _numbers(held))
        elif set(kinds) & {int, float}:
            yield f.name


def aligned(lines: Sequence[Sequence[str]], left: int | None = None) -> list[str]:
    """Lines of cells as text, columns to the right of their width; column `left`, the last, to the left."""
    widths = [max(map(len, column)) for column in zip(*lines)]
    return [
        "  ".join(
            cell if i == left else cell.rjust(width) for i, (cell, width) in enumerate(zip(line, widths))
        ).rstrip()
        for line in lines
    ]


def text_table(
    figures: Sequence[Figure], records: Sequence[T], without: Callable[[T], str] = lambda _: "-"
) -> list[str]:
    """Headings, units, and a line for each record."""
    heads = [[f.heading for f in figures], [f.unit for f in figures]]
    return aligned([*heads, *([f.text(row, without(row)) for f in figures] for row in records)])


def csv_lines(figures: Sequence[Figure], records: Sequence[Any], digits: str = "") -> list[list[str]]:
    """Names of the columns, and a line of cells for each record, blank without a number. `digits`: other
    ones than people read, of all but counts."""
    if digits:
        figures = [f if f.digits == "d" else replace(f, digits=digits) for f in figures]
    return [[f.column for f in figures], *([f.text(row) for f in figures] for row in records)]


def sig(value: float, digits: int = 3) -> str:
    """A number as text without exponent between 1e-4 and 1e7.

    Parameters
    ----------
    value
        The number.
    digits
        Significant digits.
    """
    value = float(value)
    if isnan(value):
        return "–"
    if isinf(value):
        return "∞" if value > 0 else "−∞"
    if value == 0:
        return "0"
    if not 1e-4 <= abs(value) < 1e7:
        return f"{value:.{digits - 1}e}".replace("-", "−")
    rounded = float(f"{value:.{digits - 1}e}")
    decimals = max(digits - 1 - floor(log10(abs(rounded))), 0)
    return f"{rounded:.{decimals}f}".replace("-", "−")


def exact(value: float) -> str:
    """A number as printed, without trailing zeros."""
    return f"{value:g}".replace("-", "−")


def percent(value: float, digits: int = 2) -> str:
    """A ratio in per cent."""
    return f"{sig(value * 100, digits)} %"


def signed_percent(value: float) -> str:
    return ("+" if value > 0 else "") + percent(value)


def interval(low: float, high: float, digits: int = 3) -> str:
    return f"{sig(low, digits)} to {sig(high, digits)}"


def listed(items: Iterable[object]) -> str:
    """'a', 'a and b', 'a, b and c'."""
    words = [str(i) for i in items]
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1] if words else "none"
