"""A fault of a design, a part or a scene: one record for rules between fields and for checks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Literal

# Two lengths in decimals that differ by less are equal (mm).
SAME = 1e-9

Severity = Literal["fail", "flag"]


@dataclass(frozen=True)
class Finding:
    """One finding.

    check     name of the rule or the check
    severity  `fail` blocks the release; `flag` informs whoever quotes or reviews
    part      what it is about: a part's number, a designator, a design; of a rule, the path of the field to
              look at
    place     where on the part, mm in its own frame; empty for the whole part
    value     in the unit that the message names
    limit     likewise; of a rule, the legal range in words
    message   the fault
    part_no   of an element that `part` names by its designator, its number
    """

    check: str
    severity: Severity
    part: str
    place: tuple[float, ...]
    value: object
    limit: object
    message: str
    part_no: str = ""

    @property
    def about(self) -> str:
        """Its subject, in a reader's words."""
        return f"{self.part} ({self.part_no})" if self.part_no else self.part

    @property
    def text(self) -> str:
        """All but the severity."""
        at = " at (" + ", ".join(f"{v:.3f}" for v in self.place) + ")" if self.place else ""
        return f"{self.about}: {self.check}{at}: {self.message}"

    @property
    def broken(self) -> str:
        """Message of a broken rule: field, fault, value found, legal range."""
        return f"{self.part}: {self.message}; found {self.value}; legal: {self.limit}"

    def __str__(self) -> str:
        return f"{self.severity}: {self.text}"

    def as_record(self) -> dict[str, Any]:
        """Plain data for JSON."""
        record = {**vars(self), "part": self.about}
        del record["part_no"]
        return record


def grouped(findings: Iterable[Finding]) -> list[str]:
    """The messages; equal ones on several parts are joined."""
    alike: dict[tuple[str, str], list[Finding]] = {}
    for finding in findings:
        alike.setdefault((finding.check, finding.message), []).append(finding)
    lines = []
    for first, *others in alike.values():
        about = list(dict.fromkeys(f.about for f in others if f.about != first.about))
        more = f" (and of {', '.join(about[:3])}{f' and {len(about) - 3} more' if len(about) > 3 else ''})"
        lines.append(first.text + (more if about else ""))
    return lines


def at_least(
    check: str, part: str, value: float, least: float, message: str, place: tuple[float, ...] = ()
) -> Iterator[Finding]:
    """A failure where a value is too small.

    Parameters
    ----------
    check, part, message, place
        Of the finding, see `Finding`.
    value, least
        In the unit that the message names; a shortfall of up to SAME is rounding.
    """
    if value < least - SAME:
        yield Finding(check, "fail", part, place, value, least, message)


def at_most(
    check: str, part: str, value: float, most: float, message: str, place: tuple[float, ...] = ()
) -> Iterator[Finding]:
    """A failure where a value is too large; as `at_least`."""
    if value > most + SAME:
        yield Finding(check, "fail", part, place, value, most, message)
