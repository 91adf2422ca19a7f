"""What a release is about: its scenes, what is ordered of them, and how far it holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from tactcad.design.tree import Design
from tactcad.parts.description import Part
from tactcad.parts.finding import Finding
from tactcad.scenes.scene import Scene

from .ordered import OrderLine, Sets, ordered

PROCESSES = {"wire-cut": "Wire-cut from sheet", "milled": "Milled", "turned": "Turned", "ground": "Ground"}


@dataclass(frozen=True)
class ReleaseContents:
    """Subject of a release: its scenes, what the checks flagged, why it is only a draft (empty where it is
    not), whether it is a sample without owner, and how many sets are ordered.
    """

    design: Design
    scenes: Sequence[Scene]
    flags: Sequence[Finding]
    failures: Sequence[str]
    draft: bool
    sample: bool = False
    sets: Sets = "one"

    @property
    def made(self) -> list[Part]:
        """Every part that a shop makes, once; grouped by process, in the order of first placement."""
        parts = {p.part_no: p for scene in self.scenes for p in scene.parts if p.process in PROCESSES}
        return sorted(parts.values(), key=lambda p: list(PROCESSES).index(p.process))

    @cached_property
    def lines(self) -> tuple[OrderLine, ...]:
        """What is ordered, made and bought."""
        return ordered(self.scenes, self.design.design.revision, self.sets)

    def quantity(self, part: Part) -> float:
        """How many of a made part the set-ups need; spares come on top."""
        return next(line.qty for line in self.lines if line.row.part_no == part.part_no)

    @property
    def stem(self) -> str:
        """Name of the whole zip, without ending."""
        marks = [*(["SAMPLE"] if self.sample else []), *(["PRELIMINARY"] if self.draft else [])]
        return "-".join([self.design.name, self.design.design.revision, *marks])
