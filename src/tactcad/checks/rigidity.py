"""Whether every part of the array and its rigs that is taken as rigid bends as little as it may.

Rigs' rules (parts/stiffness_remedy.py) use the same lines and leave the scene out that fails here; so only
flags remain.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from tactcad.design.tree import Design
from tactcad.parts.finding import Finding
from tactcad.parts.stiffness_remedy import remedy
from tactcad.parts.stiffness_table import Deflection
from tactcad.scenes.rig import all_rigs
from tactcad.scenes.scene import Scene

from .check_report import Report


def deflections(design: Design, scenes: Collection[str]) -> tuple[Deflection, ...]:
    """The stiffness table of a design: the lines of these scenes, all of which it must have."""
    return tuple(
        line for name, rig in all_rigs().items() if name in scenes for line in rig.deflections(design)
    )


def check_rigidity(design: Design, scenes: Collection[str], table: list[Deflection]) -> list[Finding]:
    """Findings on the lines that give way by more than is allowed; all lines into `table`."""
    table += deflections(design, scenes)
    return [
        Finding("deflection", line.severity, line.part, (), line.gives, line.allowed, _message(design, line))
        for line in table
        if line.too_much
    ]


def _message(design: Design, line: Deflection) -> str:
    path, value, legal = remedy(design, line, all_rigs()[line.scene].deflections)
    return f"{line} ({path} = {value:g}; legal: {legal})"


def check_rigs(report: Report, design: Design, scenes: Sequence[Scene]) -> None:
    """The checks that the rigs of these scenes declare."""
    for scene in scenes:
        for name, check in all_rigs()[scene.name].checks:
            report.run(name, check, design, scene)
