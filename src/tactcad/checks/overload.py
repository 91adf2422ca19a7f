"""The overload stop: does every hinge stay below yield when the whole load comes down on its pad."""

from __future__ import annotations

from tactcad.design.tree import Design
from tactcad.mechanics import ladder
from tactcad.mechanics.rigs import Stopped, stopped
from tactcad.parts.element import element_number
from tactcad.parts.hinge_section import hinge_section
from tactcad.parts.layout import ElementPlace, Layout
from tactcad.parts.stop_gap import stop_gap

from .finding import Finding


def check_stops(design: Design) -> list[Finding]:
    """Fail where the nominal stress passes yield at the gap as drawn; flag where it does at the gap's upper limit."""
    layout, found = Layout(design), []
    kinds = {element_number(design, place): place for place in layout.elements}
    for number, place in kinds.items():
        for extra, severity in ((0.0, "fail"), (design.stop.tolerance, "flag")):
            s = at_overload(layout, place, extra)
            stress, limit = s.bending + s.shear, design.material.yield_strength
            if stress > limit:
                message = (
                    f"{design.rating.overload_force:g} N on its pad: nominal stress {stress:.0f} MPa in the hinge when the stop "
                    f"has closed, yield {limit:g}" + (f", with the gap {extra:g} mm over" if extra else "")
                )
                found.append(Finding("overload", severity, number, (), stress, limit, message))
                break
    return found


def at_overload(layout: Layout, place: ElementPlace, extra: float = 0.0) -> Stopped:
    """The element under rating.overload_force, its gap `extra` mm wider than drawn."""
    d = layout.design
    stiffness = float(ladder.stiffness(hinge_section(layout, [place]), "solid")[0])
    return stopped(
        stiffness, d.rating.overload_force, stop_gap(layout, place) + extra, place.load_arm, place.arm,
        d.sheet.thickness, place.hinge.t, place.hinge.l,
    )
