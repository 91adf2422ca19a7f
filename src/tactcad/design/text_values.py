"""Text as people write it, to plain values: numbers, TOML from untrusted sources, and the tables that ship.

Python's own readers also take 4_0 as 40, and digits of every script; its parser of TOML may take minutes.
"""

from __future__ import annotations

import csv
import re
import tomllib
import typing
from collections.abc import Iterator
from math import isinf
from pathlib import Path
from typing import Any, TypeVar

from .messages import InputError

T = TypeVar("T")
# relative difference below which two numbers agree to nine digits, however the last was rounded
NINE_DIGITS = 1e-8
_WHOLE = re.compile(r"[+-]?[0-9]+")
_NUMBER = re.compile(r"[+-]?(([0-9]+\.?[0-9]*|\.[0-9]+)(e[+-]?[0-9]+)?|nan|inf(inity)?)", re.IGNORECASE)


def as_number(text: str) -> float:
    """The number in a text, with or without blanks around it. Raises ValueError if it is none."""
    plain = text.strip(" \t")
    if not _NUMBER.fullmatch(plain):
        raise ValueError(f"not a number: {text!r}")
    if isinf(value := float(plain)) and "n" not in plain.lower():  # 1e400: infinity is not meant
        raise ValueError(f"beyond all numbers: {text!r}")
    return value


def as_whole(text: str) -> int:
    """The whole number in a text; as `as_number`."""
    plain = text.strip(" \t")
    if not _WHOLE.fullmatch(plain):
        raise ValueError(f"not a whole number: {text!r}")
    return int(plain)


def with_limits(text: str) -> tuple[float, float | None]:
    """The number and the half-width of its limits, None without, in "6", "6+-0.3" or "6+-5%"; as
    `as_number`."""
    value, given, limits = text.strip().replace("\N{PLUS-MINUS SIGN}", "+-").partition("+-")
    middle = as_number(value)
    if not given:
        return middle, None
    half = as_number(limits.removesuffix("%"))
    return middle, half * middle / 100 if limits.endswith("%") else half


def filling_radius(radius: float, length: float) -> float:
    """The fillet radius in a slot, mm, of numbers or arrays: exactly half its length where two fillets fill
    it to nine digits (a full round).
    """
    full = abs(2 * radius - length) <= NINE_DIGITS * length
    return full * (length / 2) + (1 - full) * radius


def data_rows(module: str, name: str) -> list[dict[str, str]]:
    """The rows of data/NAME.csv beside a module (its `__file__`), in its order; lines that start with # name
    the standards.
    """
    lines = Path(module).with_name("data").joinpath(f"{name}.csv").read_text("utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


SI = {"nV": 1e-9, "uV": 1e-6, "pF": 1e-12}  # units behind a column's name


def data_records(module: str, name: str, kind: type[T]) -> dict[str, T]:
    """`data_rows` as records of that kind by name, each cell by its field's type; columns of no field are
    left out, and those with a unit behind the field's name are brought to SI."""
    hints = typing.get_type_hints(kind)

    def fields(row: dict[str, str]) -> Iterator[tuple[str, Any]]:
        for column, text in row.items():
            field, _, unit = column.rpartition("_")
            if unit in SI:
                yield field, float(text) * SI[unit]
            elif column in hints:
                yield column, _cell(text, hints[column])

    return {row["name"]: kind(**dict(fields(row))) for row in data_rows(module, name)}


def _cell(text: str, kind: Any) -> Any:
    """A cell's value: "true", "1 2 4" for a tuple, "gate=1 source=2" for a dict."""
    of = typing.get_args(kind)
    if kind is bool:
        return {"true": True, "false": False}[text]
    if typing.get_origin(kind) is dict:
        return {name: of[1](value) for name, value in (pair.split("=") for pair in text.split())}
    return tuple(map(of[0], text.split())) if typing.get_origin(kind) is tuple else (of or (kind,))[0](text)


# Keys of our files have at most four names (element.override.N.hinge_thickness). Python's parser takes
# minutes for keys of many thousand names, so keys of more than 16 are refused before it sees them. Comments
# and strings are skipped: they may hold anything. The quantifiers are possessive, so the search is linear in
# the length of the text.
_LONG_KEY = re.compile(
    r"""
    \#[^\n]*+
    | "{3} (?:[^"\\] | \\. | "{1,2}(?!"))*+ (?:"{3} | \\?\Z)
    | '{3} (?:[^'] | '{1,2}(?!'))*+ (?:'{3} | \Z)
    | (?P<long> (?<![\w-]) (?:(?:[\w-]++ | "(?:[^"\\\n]|\\.)*+" | '[^'\n]*+') [ \t]*+ \. [ \t]*+){16})
    | "(?:[^"\\\n] | \\.)*+"?
    | '[^'\n]*+'?
    """,
    re.VERBOSE | re.DOTALL,
)


def parse_toml(text: str, where: str) -> dict[str, Any]:
    """The table that TOML text holds; `where` names the text in messages. Raises InputError if it is
    not TOML.
    """
    text = text.replace("\r\n", "\n")
    long = next((token for token in _LONG_KEY.finditer(text) if token["long"]), None)
    if long:
        line = text.count("\n", 0, long.start()) + 1
        legal = "names joined by at most 3 dots"
        raise InputError(f"{where}:{line}", "a key of too many names", value=long["long"], legal=legal)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(where, f"is not TOML: {error}") from None
    except RecursionError:
        raise InputError(where, "nested too deeply", legal="tables at most 3 deep") from None
    except ValueError as error:  # an impossible date, or an integer of thousands of digits
        raise InputError(where, f"is not TOML: {error}") from None


def number(text: str) -> float:
    """A cell's number, in mm unless its table says otherwise; an integer stays an integer, as in part
    numbers.
    """
    return float(text) if "." in text else int(text)
