"""A field of the design file: unit, legal range, default, meaning; and reading one value."""

from __future__ import annotations

import dataclasses
import datetime
import re
from dataclasses import dataclass
from math import isfinite
from typing import Any, TypeVar

from .messages import InputError, did_you_mean, hidden, in_brackets, visible

REQUIRED = object()
T = TypeVar("T")


@dataclass(frozen=True)
class Number:
    """A number in `unit`, from low to high, both legal."""

    unit: str
    low: float
    high: float
    meaning: str

    @property
    def legal(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        return f"from {self.low:g} to {self.high:g}{unit}"

    def read(self, value: Any, where: str) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise InputError(where, "not a number", value=value, legal=self.legal)
        if isinstance(value, float) and not isfinite(value):
            raise InputError(where, "not a finite number", value=value, legal=self.legal)
        if not self.low <= value <= self.high:
            raise InputError(where, "out of range", value=value, legal=self.legal)
        return float(value)

    def schema(self) -> dict:
        return {"type": "number", "minimum": self.low, "maximum": self.high}


@dataclass(frozen=True)
class Whole:
    """A whole number, how many or which, from low to high, both legal; a TOML float without a fraction is one
    too."""

    low: int
    high: int
    meaning: str
    unit: str = ""

    @property
    def legal(self) -> str:
        return f"a whole number from {self.low:g} to {self.high:g}"

    def read(self, value: Any, where: str) -> int:
        number = Number(self.unit, self.low, self.high, self.meaning).read(value, where)
        if not number.is_integer():
            raise InputError(where, "not a whole number", value=value, legal=self.legal)
        return int(number)

    def schema(self) -> dict:
        return {"type": "integer", "minimum": self.low, "maximum": self.high}


@dataclass(frozen=True)
class OneOf:
    """One of a few words."""

    options: tuple[str, ...]
    meaning: str
    unit: str = ""

    @property
    def legal(self) -> str:
        return "one of " + ", ".join(repr(o) for o in self.options)

    def read(self, value: Any, where: str) -> str:
        if not isinstance(value, str) or value not in self.options:
            legal = self.legal + in_brackets(did_you_mean(str(value), self.options))
            raise InputError(where, "unknown choice", value=value, legal=legal)
        return value

    def schema(self) -> dict:
        return {"type": "string", "enum": list(self.options)}


@dataclass(frozen=True)
class TextLine:
    """One line of text that matches `pattern` whole."""

    pattern: str
    legal: str
    meaning: str
    unit: str = ""

    def read(self, value: Any, where: str) -> str:
        if not isinstance(value, str) or not re.fullmatch(self.pattern, value) or not visible(value):
            raise InputError(where, "not usable text", value=value, legal=self.legal)
        return shown_text(value, where, self.legal)

    def schema(self) -> dict:
        return {"type": "string", "pattern": f"^(?:{self.pattern})$"}


def shown_text(value: Any, where: str, legal: str) -> str:
    """Text of any length that shows as it is read. Raises InputError if it is empty or holds hidden
    characters."""
    if not isinstance(value, str) or not visible(value):
        raise InputError(where, "not text", value=value, legal=legal)
    if fault := hidden(value):
        raise InputError(where, f"not usable text: it holds {fault}", value=value, legal=legal)
    return value


@dataclass(frozen=True)
class Day:
    """A day of the calendar, as text or as TOML's own date; read as YYYY-MM-DD."""

    meaning: str
    legal: str = "a day as YYYY-MM-DD"
    unit: str = ""

    def read(self, value: Any, where: str) -> str:
        if isinstance(value, datetime.date) and not isinstance(value, datetime.datetime):
            return value.isoformat()
        try:
            if isinstance(value, str) and datetime.date.fromisoformat(value).isoformat() == value:
                return value
        except ValueError:
            pass
        raise InputError(where, "not a day", value=value, legal=self.legal)

    def schema(self) -> dict:
        return {"type": "string", "format": "date", "pattern": "^[0-9]{4}-[0-9]{2}-[0-9]{2}$"}


@dataclass(frozen=True)
class Numbers:
    """A list of numbers, each as `item`, `least` to `most` of them."""

    item: Number | Whole
    least: int
    most: int
    meaning: str

    @property
    def unit(self) -> str:
        return self.item.unit

    @property
    def legal(self) -> str:
        count = self.least if self.least == self.most else f"{self.least} to {self.most}"
        return f"a list of {count} numbers, each {self.item.legal}"

    def read(self, value: Any, where: str) -> tuple[float, ...]:
        if not isinstance(value, list):
            raise InputError(where, "not a list", value=value, legal=self.legal)
        if not self.least <= len(value) <= self.most:
            raise InputError(where, f"a list of {len(value)}", legal=self.legal)
        return tuple(self.item.read(v, f"{where}[{i}]") for i, v in enumerate(value))

    def schema(self) -> dict:
        return {"type": "array", "items": self.item.schema(), "minItems": self.least, "maxItems": self.most}


@dataclass(frozen=True)
class SomeOf:
    """A list of one or more of a few words, each once."""

    options: tuple[str, ...]
    meaning: str
    unit: str = ""

    @property
    def legal(self) -> str:
        return "a list of one or more of " + ", ".join(repr(o) for o in self.options)

    def read(self, value: Any, where: str) -> tuple[str, ...]:
        if not isinstance(value, list) or not value or len(set(map(str, value))) < len(value):
            raise InputError(where, "not a list of different words", value=value, legal=self.legal)
        return tuple(OneOf(self.options, self.meaning).read(v, f"{where}[{i}]") for i, v in enumerate(value))

    def schema(self) -> dict:
        items = {"type": "string", "enum": list(self.options)}
        return {"type": "array", "items": items, "minItems": 1, "uniqueItems": True}


@dataclass(frozen=True)
class TextLines:
    """A list of one or more different texts, each as `item`."""

    item: TextLine
    meaning: str
    unit: str = ""

    @property
    def legal(self) -> str:
        return f"a list of one or more different texts, each {self.item.legal}"

    def read(self, value: Any, where: str) -> tuple[str, ...]:
        if not isinstance(value, list) or not value or len(set(map(str, value))) < len(value):
            raise InputError(where, "not a list of different texts", value=value, legal=self.legal)
        return tuple(self.item.read(v, f"{where}[{i}]") for i, v in enumerate(value))

    def schema(self) -> dict:
        return {"type": "array", "items": self.item.schema(), "minItems": 1}


@dataclass(frozen=True)
class NumberRows:
    """One or two rows of numbers; a third row is refused with the reason."""

    row: Numbers
    meaning: str

    @property
    def unit(self) -> str:
        return self.row.unit

    @property
    def legal(self) -> str:
        return f"one or two rows, each {self.row.legal}"

    def read(self, value: Any, where: str) -> tuple[tuple[float, ...], ...]:
        if not isinstance(value, list) or not value:
            raise InputError(where, "not a list of rows", value=value, legal=self.legal)
        if len(value) > 2:
            raise InputError(
                where,
                f"{len(value)} rows cannot lie in one plane: the pads of a third row would lie "
                "inside the arms of the second",
                legal=self.legal,
            )
        return tuple(self.row.read(v, f"{where}[{i}]") for i, v in enumerate(value))

    def schema(self) -> dict:
        return {"type": "array", "items": self.row.schema(), "minItems": 1, "maxItems": 2}


@dataclass(frozen=True)
class Values:
    """A list of values of a field named elsewhere, whose spec reads each."""

    meaning: str
    unit: str = ""

    @property
    def legal(self) -> str:
        return "a list of one or more of the field's values"

    def read(self, value: Any, where: str) -> tuple[Any, ...]:
        if not isinstance(value, list) or not value:
            raise InputError(where, "not a list of values", value=value, legal=self.legal)
        return tuple(value)

    def schema(self) -> dict:
        return {"type": "array", "minItems": 1}


Spec = Number | Whole | OneOf | TextLine | Day | Numbers | SomeOf | TextLines | NumberRows | Values


def given(spec: Spec, default: Any = REQUIRED, derived: str = "") -> Any:
    """A dataclass field read by `spec`. `derived` describes how a default of None is filled in."""
    metadata = {"spec": spec, "derived": derived}
    if default is REQUIRED:
        return dataclasses.field(metadata=metadata)
    return dataclasses.field(default=default, metadata=metadata)


def spec_of(kind: type, name: str) -> Any:
    """The spec of a table's field of that name."""
    return kind.__dataclass_fields__[name].metadata["spec"]  # type: ignore[attr-defined]


def with_value(tables: T, path: str, value: Any) -> T:
    """A copy of a file's tables with another value of one field, "grasp.force", unchecked."""
    table, name = path.split(".")
    changed = dataclasses.replace(getattr(tables, table), **{name: value})
    return dataclasses.replace(tables, **{table: changed})  # type: ignore[type-var]


def present(value: T | None) -> T:
    """An optional table or value of a design that earlier code has ensured to be there: for the type checker,
    not for input.

    Raises
    ------
    TypeError : it is not there.
    """
    if value is None:
        raise TypeError("the design lacks a value that is needed here")
    return value
