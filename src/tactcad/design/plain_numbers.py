"""Numbers as people write them: Python's own readers also take 4_0 as 40, and digits of every script."""

from __future__ import annotations

import re

NINE_DIGITS = (
    1e-8  # numbers that agree to nine digits differ by less, relatively, however the last was rounded
)

_WHOLE = re.compile(r"[+-]?[0-9]+")
_NUMBER = re.compile(r"[+-]?(([0-9]+\.?[0-9]*|\.[0-9]+)(e[+-]?[0-9]+)?|nan|inf(inity)?)", re.IGNORECASE)


def as_number(text: str) -> float:
    """The number that is written there, with or without blanks around it. Raises ValueError where there is
    none."""
    plain = text.strip(" \t")
    if not _NUMBER.fullmatch(plain):
        raise ValueError(f"not a number: {text!r}")
    return float(plain)


def as_whole(text: str) -> int:
    """The whole number that is written there, likewise."""
    plain = text.strip(" \t")
    if not _WHOLE.fullmatch(plain):
        raise ValueError(f"not a whole number: {text!r}")
    return int(plain)


def filling_radius(radius: float, length: float) -> float:
    """The radius of two fillets in a slot: half its length where they fill it to nine digits (a full
    round)."""
    return length / 2 if abs(2 * radius - length) <= NINE_DIGITS * length else radius
