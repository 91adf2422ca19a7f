"""Optional values that are known to be there."""

from __future__ import annotations

from typing import TypeVar

T = TypeVar("T")


def present(value: T | None) -> T:
    """An optional table or value of a design that earlier code has ensured to be there: for the type checker,
    not for input.

    Raises
    ------
    TypeError : it is not there.
    """
    if value is None:
        raise TypeError("a value of the design that is needed here was left out of it")
    return value
