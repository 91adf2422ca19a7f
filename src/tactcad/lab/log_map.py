"""The mapping file of a log: which column is which element, in what unit, and which rows are which step.

Lengths in mm, forces in N, volts, seconds, once the units of the file are applied.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tactcad.design.fields import Number, Numbers, OneOf, TextLine, Whole, given
from tactcad.design.files import read_text
from tactcad.design.load import MOST_BYTES, read_table, unknown_field
from tactcad.design.messages import InputError
from tactcad.design.text_values import parse_toml
from tactcad.lab.column_units import UNITS, VOLTAGES

SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0}
NEEDED = {"calibration": ("element", "run", "displacement", "force"), "grasp": ("load",)}
OPTIONAL = {"calibration": (), "grasp": ("run", "sample")}
_NAME = r"[^\x00-\x1f]{1,200}"
_MOST = 1e12


def _column(meaning: str) -> TextLine:
    return TextLine(_NAME, "a column's name", meaning)


class Spans:
    """A list of [from, to], s, in their order."""

    unit, meaning = "s", "by times: from and to of every step"
    legal = "a list of [from, to], each behind the one before"

    def read(self, value: Any, where: str) -> tuple[tuple[float, ...], ...]:
        pair = Numbers(Number("s", -_MOST, _MOST, "time"), 2, 2, "from, to")
        if not isinstance(value, list):
            raise InputError(where, "not a list", value=value, legal=self.legal)
        spans = tuple(pair.read(v, f"{where}[{i}]") for i, v in enumerate(value))
        for i, (start, end) in enumerate(spans):
            if end <= start or (i and start < spans[i - 1][1]):
                raise InputError(f"{where}[{i}]", "not in order", value=[start, end], legal=self.legal)
        return spans


@dataclass(frozen=True)
class LogTable:
    """[log]: what the log is of, and its time."""

    kind: str = given(OneOf(tuple(NEEDED), "what was read"))
    time: str | None = given(_column("column of time, or of date and time"), None, "the file's own time")
    time_unit: str = given(OneOf(tuple(SECONDS), "of that column"), "s")
    rate: float | None = given(
        Number("Hz", 1e-6, 1e9, "rows a second, of a log without time"), None, "not used"
    )
    mains: float | None = given(
        Number("Hz", 1, 1000, "of the mains: the mean is over whole periods"), None, "over all samples"
    )


@dataclass(frozen=True)
class SignalTable:
    """[signal]: of all channels."""

    unit: str = given(OneOf(tuple(VOLTAGES), "of the channels' columns"), "V")
    factor: float = given(Number("", -_MOST, _MOST, "by which volts are multiplied, as 1/100 of a gain"), 1.0)
    least: float | None = given(Number("V", -1e3, 1e3, "that the converter gives"), None, "not known")
    most: float | None = given(Number("V", -1e3, 1e3, "that the converter gives"), None, "not known")


@dataclass(frozen=True)
class StepsTable:
    """[steps]: which rows belong to one step."""

    by: str = given(OneOf(("plateau", "marks", "times"), "how they are told"))
    column: str | None = given(_column("that steps, or holds the marks"), None, "needed but by times")
    apart: float | None = given(
        Number("", 0, _MOST, "least step of that column, in its own unit"), None, "needed by plateau"
    )
    hold: float = given(Number("s", 0, 1e6, "shortest plateau that counts"), 1.0)
    settle: float = given(Number("s", 0, 1e6, "left out at the beginning of every step"), 0.0)
    times: tuple[tuple[float, ...], ...] = field(default=(), metadata={"spec": Spans()})


@dataclass(frozen=True)
class Channel:
    """A channel's element, and how its volts become the signal: factor times, plus offset (V)."""

    element: int = given(Whole(1, 100_000, "number of the element"))
    factor: float = given(Number("", -_MOST, _MOST, "besides that of [signal]"), 1.0)
    offset: float = given(Number("V", -1e3, 1e3, "added at last"), 0.0)


@dataclass(frozen=True)
class MappedQuantity:
    """[element], [run], [sample], [displacement], [force], [load]: a value a step, from a column or a
    list."""

    column: str | None = given(_column("whose mean over the step it is"), None, "from values")
    unit: str | None = given(_column("of the column or the values"), None, "mm, N or none")
    factor: float = given(Number("", -_MOST, _MOST, "by which it is multiplied"), 1.0)
    offset: float = given(Number("", -_MOST, _MOST, "added before the factor, in its own unit"), 0.0)
    values: tuple[float, ...] | None = given(
        Numbers(
            Number("", -_MOST, _MOST, ""), 1, 100_000, "of the steps in their order, again from the first"
        ),
        None,
        "from the column",
    )
    each: int = given(Whole(1, 100_000, "steps in a row that share one of the values"), 1)
    least: float = given(Number("", 0, _MOST, "size below which it is zero, in its own unit"), 0.0)

    def scale(self, name: str, path: str) -> float:
        """Factor to mm, N or the plain number. Raises InputError for a unit that is not known."""
        known = UNITS.get(name, {})
        if self.unit is not None and self.unit not in known:
            legal = "one of " + ", ".join(known) if known else "no unit"
            raise InputError(f"{path}: {name}.unit", "unknown unit", value=self.unit, legal=legal)
        return self.factor * (known[self.unit] if self.unit else 1.0)


@dataclass(frozen=True)
class LogMap:
    """A whole mapping file."""

    path: str
    log: LogTable
    signal: SignalTable
    steps: StepsTable
    channels: Mapping[str, Channel]
    quantities: Mapping[str, MappedQuantity]


TABLES = {"log": LogTable, "signal": SignalTable, "steps": StepsTable}
QUANTITIES = ("element", "run", "sample", "displacement", "force", "load")


def read_map(path: str | Path) -> LogMap:
    """A mapping file, field by field.

    Raises
    ------
    InputError
        The file is missing or no map, a value is not legal, or two contradict each other.
    """
    where = str(path)
    table = parse_toml(read_text(path, MOST_BYTES, "a mapping file (TOML)"), where)
    for name, value in table.items():
        if name not in (*TABLES, "channels", *QUANTITIES):
            raise unknown_field(name, [*TABLES, "channels", *QUANTITIES], "tactcad readings --help")
        if not isinstance(value, dict):
            raise InputError(f"{where}: {name}", "not a table", value=value, legal=f"a table [{name}]")
    values: dict[str, Any] = {}
    for name, kind in TABLES.items():
        if name not in table and name != "signal":
            raise InputError(f"{where}: {name}", "missing table", legal=f"a table [{name}]")
        values[name] = read_table(kind, table.get(name, {}), name)
    kind = values["log"].kind
    for name in NEEDED[kind]:
        if name not in table:
            raise InputError(f"{where}: {name}", "missing table", legal=f"a table [{name}], for a {kind}")
    for name in set(QUANTITIES) & set(table):
        if name not in (*NEEDED[kind], *OPTIONAL[kind]):
            legal = ", ".join((*NEEDED[kind], *OPTIONAL[kind]))
            raise InputError(f"{where}: {name}", f"is nothing that a {kind} has", legal=legal)
    quantities = {n: read_table(MappedQuantity, table[n], n) for n in QUANTITIES if n in table}
    for name, q in quantities.items():
        if (q.column is None) == (q.values is None):
            raise InputError(f"{where}: {name}", "is to come from one of two", legal="column, or values")
        q.scale(name, where)
    _require(values["steps"], where)
    channels = _channels(table.get("channels", {}), where)
    return LogMap(where, values["log"], values["signal"], values["steps"], channels, quantities)


def _require(steps: StepsTable, where: str) -> None:
    """Raise InputError if a field that the way of telling steps needs is left out."""
    for needed, name, legal in (
        (steps.by == "times" and not steps.times, "times", Spans.legal),
        (steps.by != "times" and steps.column is None, "column", "the column that tells the steps"),
        (steps.by == "plateau" and not steps.apart, "apart", "least step of that column, above 0"),
    ):
        if needed:
            raise InputError(f"{where}: steps.{name}", "missing", legal=legal)


def _channels(table: dict[str, Any], where: str) -> dict[str, Channel]:
    if not table:
        raise InputError(f"{where}: channels", "no channel", legal='a table [channels]: "column" = element')
    found: dict[str, Channel] = {}
    for name, value in table.items():
        own = value if isinstance(value, dict) else {"element": value}
        found[name] = read_table(Channel, own, f"channels.{name}")
        others = [n for n, c in found.items() if c.element == found[name].element and n != name]
        if others:
            what = f"element {found[name].element} has two channels, {others[0]} and {name}"
            raise InputError(f"{where}: channels", what, legal="one each")
    return found
