"""Does every hinge stay elastic: at its rated force, and with the overload force on its closed stop?"""

from __future__ import annotations

from tactcad.design.tree import Design
from tactcad.parts.element import element_number
from tactcad.parts.layout import Layout
from tactcad.parts.overload import Overload, overloads

from .finding import Finding


def check_strength(design: Design) -> list[Finding]:
    """Findings on the elements of a design, by the estimator; no kernel."""
    layout = Layout(design)
    return [finding for state in overloads(layout) for finding in _about(layout, state)]


def _about(layout: Layout, state: Overload) -> list[Finding]:
    design, place = layout.design, state.place
    who = f"{place.designator} ({element_number(design, place)})"
    at_hinge = (place.hinge_x, place.hinge.t / 2)
    if state.refused:
        return [Finding("strength", "flag", who, at_hinge, 0, 0, f"the estimator cannot tell its strength: {state.refused}")]
    limit = design.material.yield_strength
    found = []
    if state.yield_factor < 1.0:
        found.append(Finding(
            "overload", "fail", who, at_hinge, state.stress, limit,
            f"the fillet bears {state.stress:.4g} MPa of {limit:g} when {design.rating.overload_force:g} N have closed "
            f"the stop at {state.gap:g} mm, tolerance included: it yields",
        ))  # fmt: skip
    if state.rated_force < design.rating.force:
        found.append(Finding(
            "rated-force", "flag", who, at_hinge, state.rated_force, design.rating.force,
            f"rated at {state.rated_force:.3g} N, not at the {design.rating.force:g} N asked for: there the fillet "
            f"would have less than its safety of {design.rating.yield_factor:g} against yield",
        ))  # fmt: skip
    return found
