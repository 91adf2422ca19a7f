"""What a check has to say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Finding:
    """One finding. `fail` must not leave the house; `flag` is for whoever quotes or reviews.

    place   where on the part, mm in its own frame; empty for the whole part
    value, limit   in the unit that the message names
    """

    check: str
    severity: Literal["fail", "flag"]
    part: str
    place: tuple[float, ...]
    value: float
    limit: float
    message: str

    def __str__(self) -> str:
        at = " at (" + ", ".join(f"{v:.3f}" for v in self.place) + ")" if self.place else ""
        return f"{self.severity}: {self.part}: {self.check}{at}: {self.message}"
