"""What may be left out of a design, and is there."""

from __future__ import annotations

from typing import TypeVar

T = TypeVar("T")


def present(value: T | None) -> T:
    """A table or value of a design that what runs before has seen to be there: a type, no check of input.

    Raises
    ------
    TypeError : it is not there.
    """
    if value is None:
        raise TypeError("a value of the design that is needed here was left out of it")
    return value
