"""What is wrong with a design, a part or a scene: one record for rules between fields and for checks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

# Below this, two lengths written in decimals are the same length (mm).
SAME = 1e-9

Severity = Literal["fail", "flag"]


@dataclass(frozen=True)
class Finding:
    """One finding.

    check     name of the rule or the check
    severity  `fail` must not leave the house; `flag` is for whoever quotes or reviews
    part      what it is about: a part's number, a designator, a design; of a rule, the path of the field to
              look at
    place     where on the part, mm in its own frame; empty for the whole part
    value     in the unit that the message names
    limit     likewise; of a rule, in words what is legal
    message   what is wrong
    """

    check: str
    severity: Severity
    part: str
    place: tuple[float, ...]
    value: object
    limit: object
    message: str

    def __str__(self) -> str:
        at = " at (" + ", ".join(f"{v:.3f}" for v in self.place) + ")" if self.place else ""
        return f"{self.severity}: {self.part}: {self.check}{at}: {self.message}"


def at_least(
    check: str, part: str, value: float, least: float, message: str, place: tuple[float, ...] = ()
) -> Iterator[Finding]:
    """A failure where the value is under what it must be at least."""
    if value < least - SAME:
        yield Finding(check, "fail", part, place, value, least, message)


def at_most(
    check: str, part: str, value: float, most: float, message: str, place: tuple[float, ...] = ()
) -> Iterator[Finding]:
    """A failure where the value is over what it may be at most."""
    if value > most + SAME:
        yield Finding(check, "fail", part, place, value, most, message)
