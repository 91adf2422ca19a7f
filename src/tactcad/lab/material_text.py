"""Properties of a design's material that differ from its alloy's in the table, and the stiffness that the
table's Young's modulus would give."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from tactcad.design.tree import Design


def lines(design: Design, stiffness: Sequence[float]) -> list[str]:
    """A line for each property that differs, with its source; for Young's modulus also the largest and the
    smallest stiffness (N/mm) with either modulus."""
    differing = [f"material: {d}" + (f" ({d.origin})" if d.origin else "") for d in design.differences]
    factor = design.stiffness_factor
    if factor is not None:
        most, least = max(stiffness), min(stiffness)
        differing.append(
            f"with {design.material.alloy}'s own modulus every K is {factor - 1:+.1%}: {most * factor:.4g} "
            f"instead of {most:.4g} N/mm"
            + (f", {least * factor:.4g} instead of {least:.4g}" if least != most else "")
        )
    return differing


def record(design: Design) -> dict[str, Any]:
    """The differences for JSON: `material_differences`, and `stiffness_factor` where the modulus differs."""
    differences = [
        {"property": d.name, "value": d.value, "table": d.table, "relative": d.relative, "origin": d.origin}
        for d in design.differences
    ]
    factor = design.stiffness_factor
    return {"material_differences": differences} | ({"stiffness_factor": factor} if factor else {})
