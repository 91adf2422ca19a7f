"""How much a run does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeVar

Mode = Literal["smoke", "short", "full"]
T = TypeVar("T")


@dataclass(frozen=True)
class RunPlan:
    """Plan of a run: mode; seed of everything random; a scratch folder; `say` receives what is being
    measured.

    smoke: does everything run? Its figures mean nothing. short: four minutes on two quiet cores. full: for
    publication, some 40 minutes.
    """

    mode: Mode
    seed: int
    folder: Path
    say: Callable[[str], None] = lambda text: None

    def of(self, smoke: T, short: T, full: T) -> T:
        """The one for this mode."""
        return {"smoke": smoke, "short": short, "full": full}[self.mode]
