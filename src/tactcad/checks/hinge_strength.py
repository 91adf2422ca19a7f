"""The overload stop: no hinge passes its rated deflection or stress when the whole load acts on one
element.
"""

from __future__ import annotations

from tactcad.design.tree import Design
from tactcad.parts.element import element_number
from tactcad.parts.finding import Finding
from tactcad.parts.layout import Layout
from tactcad.parts.overload import Overload, overloads

# Relative excess that is still rounding, for a hinge exactly at its limit.
ROUNDING = 1e-9


def check_strength(design: Design) -> list[Finding]:
    """Findings on the elements of a design, by the estimator; no kernel."""
    layout = Layout(design)
    return [finding for state in overloads(layout) for finding in _about(layout, state)]


def _about(layout: Layout, state: Overload) -> list[Finding]:
    design, place = layout.design, state.place
    who = f"{place.designator} ({element_number(design, place)})"
    at_hinge = (place.hinge_x, place.hinge.t / 2)
    if state.refused:
        return [
            Finding(
                "strength",
                "flag",
                who,
                at_hinge,
                0,
                0,
                f"the estimator cannot tell its strength: {state.refused}",
            )
        ]
    closed = (
        f"when {design.rating.overload_force:g} N have closed the stop at {state.gap:g} mm, "
        "tolerance included"
    )
    stress = design.material.yield_strength / design.rating.deflection_factor
    findings = []
    if state.deflection > state.rated_deflection * (1 + ROUNDING):
        findings.append(
            Finding(
                "overload",
                "fail",
                who,
                at_hinge,
                state.deflection,
                state.rated_deflection,
                f"the hinge gives way by {state.deflection:.4g} mm {closed}; it is rated for "
                f"{state.rated_deflection:.4g}",
            )
        )
    if state.stress > stress * (1 + ROUNDING):
        findings.append(
            Finding(
                "overload",
                "fail",
                who,
                at_hinge,
                state.stress,
                stress,
                f"the fillet bears {state.stress:.4g} MPa {closed}; at its rated deflection it bears "
                f"{stress:.4g}",
            )
        )
    if state.closing_force < state.rated_force * (1 - ROUNDING):
        findings.append(
            Finding(
                "stop-below-rated",
                "flag",
                who,
                at_hinge,
                state.closing_force,
                state.rated_force,
                f"the stop closes at {state.closing_force:.3g} N at most, its gap {state.gap:g} mm with its "
                f"tolerance: the hinge never bends as at the {state.rated_force:.3g} N that it is rated for",
            )
        )
    if state.rated_force < design.rating.force:
        findings.append(
            Finding(
                "rated-force",
                "flag",
                who,
                at_hinge,
                state.rated_force,
                design.rating.force,
                f"rated at {state.rated_force:.3g} N, not at the {design.rating.force:g} N asked for: there "
                f"the fillet would have less than its safety of {design.rating.yield_factor:g} against yield",
            )
        )
    return findings
