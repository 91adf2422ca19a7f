"""What is taken as rigid: does every part of the array and its rigs bend as little as it may?"""

from __future__ import annotations

from collections.abc import Collection

from tactcad.design.tree import Design
from tactcad.parts.finding import Finding
from tactcad.parts.stiffness_table import Deflection, deflections


def check_rigidity(design: Design, scenes: Collection[str], table: list[Deflection]) -> list[Finding]:
    """Findings on the lines that give way by more than is allowed; all lines into `table`."""
    table += deflections(design, scenes)
    return [
        Finding("deflection", line.severity, line.part, (), line.gives, line.allowed, _message(line))
        for line in table
        if line.gives > line.allowed
    ]


def _message(line: Deflection) -> str:
    return (
        f"{line.scene}: gives way by {line.gives:.3g} um under {line.load:.3g} N ({line.origin}), "
        f"{line.model}; allowed are {line.allowed:.3g} um, {line.why}"
    )
