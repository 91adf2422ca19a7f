"""Whether every part of the array and its rigs that is taken as rigid bends as little as it may.

Rules (parts/rules/stiffness_rules.py) use the same lines: they refuse a design that fails here, or leave the
scene out. For a design that keeps them only flags remain.
"""

from __future__ import annotations

from collections.abc import Collection

from tactcad.design.tree import Design
from tactcad.parts.finding import Finding
from tactcad.parts.stiffness_remedy import remedy
from tactcad.parts.stiffness_table import Deflection, deflections


def check_rigidity(design: Design, scenes: Collection[str], table: list[Deflection]) -> list[Finding]:
    """Findings on the lines that give way by more than is allowed; all lines into `table`."""
    table += deflections(design, scenes)
    return [
        Finding("deflection", line.severity, line.part, (), line.gives, line.allowed, _message(design, line))
        for line in table
        if line.too_much
    ]


def _message(design: Design, line: Deflection) -> str:
    path, value, legal = remedy(design, line)
    return f"{line} ({path} = {value:g}; legal: {legal})"
