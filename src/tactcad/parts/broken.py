"""A rule that a design breaks."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Broken:
    """A rule that a design breaks: the field to look at, what is wrong, its value, what is legal."""

    rule: str
    path: str
    what: str
    value: object
    legal: str
