"""Numbers as people write them: Python's own readers also take 4_0 as 40, and digits of every script."""

from __future__ import annotations

import re
from math import isinf

NINE_DIGITS = (
    1e-8  # relative difference below which two numbers agree to nine digits, however the last was rounded
)

_WHOLE = re.compile(r"[+-]?[0-9]+")
_NUMBER = re.compile(r"[+-]?(([0-9]+\.?[0-9]*|\.[0-9]+)(e[+-]?[0-9]+)?|nan|inf(inity)?)", re.IGNORECASE)


def as_number(text: str) -> float:
    """The number that a text stands for, with or without blanks around it. Raises ValueError where it is
    none.
    """
    plain = text.strip(" \t")
    if not _NUMBER.fullmatch(plain):
        raise ValueError(f"not a number: {text!r}")
    if isinf(value := float(plain)) and "n" not in plain.lower():  # 1e400: nobody asked for infinity
        raise ValueError(f"beyond all numbers: {text!r}")
    return value


def as_whole(text: str) -> int:
    """The whole number that a text stands for; as `as_number`."""
    plain = text.strip(" \t")
    if not _WHOLE.fullmatch(plain):
        raise ValueError(f"not a whole number: {text!r}")
    return int(plain)


def filling_radius(radius: float, length: float) -> float:
    """The fillet radius in a slot, mm: exactly half its length where two fillets fill it to nine digits (a
    full round).
    """
    return length / 2 if abs(2 * radius - length) <= NINE_DIGITS * length else radius
