"""The overload stop: no hinge passes its rated deflection or stress when the whole load acts on one element,
and pressed arms stay clear of their own body, the stop plate and the opposite row.

Clearance is exact on the contours, no kernel. A pressed arm is turned rigidly about the hinge's centre: to
its stop's gap and tolerance at the tip, or by the deflection at the end of the calibration's travel, if
there is no stop plate. The rules on pressed arms (`parts/rules/pressed_rules.py`) give in closed form which
corner meets which wall first. This check tests every piece of the contour, and so covers shapes of arm,
fillet or land outside those formulas. Of thousands of designs that keep the rules none has had a finding
here. The space at an arm's sides, and the room of gauges and leads, are covered by the rules only: no contour
describes them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cache
from math import asin

from tactcad.checks.check import Check
from tactcad.contour import Arc, Contour, Segment
from tactcad.contour.nearest import distance
from tactcad.contour.segment import turned
from tactcad.design.tree import Design
from tactcad.parts.array.element import element_number, outline
from tactcad.parts.array.layout import ElementPlace, Layout
from tactcad.parts.array.stop_gap import Overload, endurance, overloads, stop_gap
from tactcad.parts.language.finding import Finding, Severity
from tactcad.parts.rules.pressed_rules import hinge_centre, turns

# Relative excess that is still rounding, for a hinge exactly at its limit.
ROUNDING = 1e-9


def check_strength(design: Design) -> list[Finding]:
    """Findings on the elements of a design, by the estimator; no kernel."""
    layout = Layout(design)
    return [finding for state in overloads(layout) for finding in _about(layout, state)]


def _about(layout: Layout, state: Overload) -> list[Finding]:
    design, place = layout.design, state.place
    number, at_hinge = element_number(design, place), (place.hinge_x, place.hinge.t / 2)
    findings: list[Finding] = []

    def _finding(check: str, severity: Severity, value: float, limit: float, message: str) -> None:
        findings.append(Finding(check, severity, place.designator, at_hinge, value, limit, message, number))

    if state.refused:
        _finding("strength", "flag", 0, 0, f"the estimator cannot tell its strength: {state.refused}")
        return findings
    closed = (
        f"when {design.rating.overload_force:g} N have closed the stop at {state.gap:g} mm, "
        "tolerance included"
    )
    stress = design.material.yield_strength / design.rating.deflection_factor
    if state.deflection > state.rated_deflection * (1 + ROUNDING):
        message = (
            f"the hinge gives way by {state.deflection:.4g} mm {closed}; it is rated for "
            f"{state.rated_deflection:.4g}"
        )
        _finding("overload", "fail", state.deflection, state.rated_deflection, message)
    if state.stress > stress * (1 + ROUNDING):
        message = (
            f"the fillet bears {state.stress:.4g} MPa {closed}; at its rated deflection it bears {stress:.4g}"
        )
        _finding("overload", "fail", state.stress, stress, message)
    if state.closing_force < state.rated_force * (1 - ROUNDING):
        message = (
            f"the stop closes at {state.closing_force:.3g} N at most, its gap {state.gap:g} mm with its "
            f"tolerance: the hinge never bends as at the {state.rated_force:.3g} N that it is rated for"
        )
        _finding("stop-below-rated", "flag", state.closing_force, state.rated_force, message)
    if state.rated_force < design.rating.force:
        message = (
            f"rated at {state.rated_force:.3g} N, not at the {design.rating.force:g} N asked for: there "
            f"the fillet would have less than its safety of {design.rating.yield_factor:g} against yield"
        )
        _finding("rated-force", "flag", state.rated_force, design.rating.force, message)
    return findings


def check_fatigue(design: Design) -> Iterator[Finding]:
    """A flag if elements bear their rated force for a finite life only."""
    layout = Layout(design)
    states = [state for state in overloads(layout) if not state.refused]
    if said := endurance(layout, states):
        worst = min(states, key=lambda state: state.endured / state.rated_force)
        who, number = worst.place.designator, element_number(design, worst.place)
        yield Finding("fatigue", "flag", who, (), worst.endured, worst.rated_force, said, number)


def check_clearance(design: Design) -> list[Finding]:
    """Findings on every pressed element: its own body, the stop plate, the opposite arms.

    Nearer than the design's tolerances is too near: two pad edges may each be off by [tolerance] load_arm.
    """
    layout = Layout(design)
    arms = _Arms(layout)
    return [*_own_body(layout, arms), *_stop_plate(layout, arms), *_opposite(layout, arms)]


class _Arms:
    """Arms of the layout's elements, each shape cut off and turned once."""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self.turns = turns(layout)
        self.contour = cache(lambda arm, hinge, gap: outline(layout, arm, hinge, gap))

    def of(self, place: ElementPlace, turn: float) -> tuple[Segment, ...]:
        """Every segment that moves with the arm, turned by that angle, in (x, z) of row one."""
        arm = _left_of(self.contour(place.arm, place.hinge, stop_gap(self.layout, place)), place.hinge_x)
        centre = (place.hinge_x, hinge_centre(self.layout, place))
        return tuple(turned(s, centre, -turn) for s in arm)  # an arm that points towards - x goes up

    def most(self, place: ElementPlace) -> float:
        """Angle by which the arm turns at most."""
        return self.turns[place.number - 1]

    def body(self, place: ElementPlace) -> list[Segment]:
        contour = self.contour(place.arm, place.hinge, stop_gap(self.layout, place))
        return [
            s for s in contour if s.name in ("slot_body_wall", "ledge", "front_slot_body_wall", "clamp_edge")
        ]


def _left_of(contour: Contour, x: float) -> Iterable[Segment]:
    """Segments wholly on the arm's side; the bending hinge itself is left out."""
    hinge = ("slot_floor", "hinge_face", "slot_arm_fillet", "front_slot_arm_fillet")
    return (s for s in contour if s.start[0] < x and s.end[0] < x and s.name not in hinge)


def _mirrored(s: Segment) -> Segment:
    """Row two as row one sees it: x to the other side."""
    flip = lambda p: (-p[0], p[1])  # noqa: E731
    if isinstance(s, Arc):
        return Arc(flip(s.start), flip(s.end), flip(s.centre), not s.ccw, s.name)
    return replace(s, start=flip(s.start), end=flip(s.end))


def _nearest(some: Iterable[Segment], others: Iterable[Segment]) -> float:
    others = tuple(others)
    return min(distance(a, b) for a in some for b in others)


def _own_body(layout: Layout, arms: _Arms) -> Iterator[Finding]:
    seen: dict[tuple, float] = {}
    for place in layout.elements:
        key = (place.arm, place.hinge)
        if key not in seen:
            seen[key] = _nearest(arms.of(place, arms.most(place)), arms.body(place))
        limit = layout.design.tolerance.hinge_length
        if seen[key] <= limit:
            yield _pressed(
                "slot-clearance",
                place,
                seen[key],
                limit,
                "its own body: the slot closes before the stop does",
            )


# Pieces of the contour that meet the stop plate, or lead up to it.
LAND = frozenset({"stop_land", "tip", "land_ramp", "land_root"})


def _stop_plate(layout: Layout, arms: _Arms) -> Iterator[Finding]:
    """On its closed stop the land touches the plate; no other piece of the arm reaches that height."""
    seen: dict[tuple, float] = {}
    for place in layout.elements:
        key = (place.arm, place.hinge)
        if key not in seen:
            closed = asin(min(1.0, stop_gap(layout, place) / place.arm))
            rest = [s for s in arms.of(place, closed) if s.name not in LAND]
            seen[key] = layout.ledge - max(s.at(u)[1] for s in rest for u in (0.0, 0.5, 1.0))
        limit = layout.design.tolerance.arm_height
        if seen[key] <= limit:
            yield _pressed("stop-clearance", place, seen[key], limit, "the stop plate beside its land")


def _opposite(layout: Layout, arms: _Arms) -> Iterator[Finding]:
    limit = 2 * layout.design.tolerance.load_arm
    seen: dict[tuple, float] = {}
    first, second = ([p for p in layout.elements if p.row == row] for row in (1, 2))
    thickness = layout.design.sheet.thickness
    for a in first:
        for b in (b for b in second if abs(a.y - b.y) < thickness):
            key = (a.arm, a.hinge, b.arm, b.hinge)
            if key not in seen:
                seen[key] = min(
                    _nearest(arms.of(a, one), map(_mirrored, arms.of(b, other)))
                    for one in (0.0, arms.most(a))
                    for other in (0.0, arms.most(b))
                )
            if seen[key] <= limit:
                yield _pressed(
                    "opposite-clearance", a, seen[key], limit, f"the opposite arm of {b.designator}"
                )


def _pressed(check: str, place: ElementPlace, value: float, limit: float, what: str) -> Finding:
    message = (
        f"pressed as far as it goes the arm comes within {value:.3f} mm of {what}; tolerances take "
        f"{limit:.3f} mm"
    )
    at = (place.hinge_x - place.arm, 0.0)
    return Finding(check, "fail", place.designator, at, value, limit, message)


CHECKS = (
    Check("strength", "design", lambda design, _: check_strength(design), place=10, quick=True),
    Check("fatigue", "design", lambda design, _: check_fatigue(design), place=15, quick=True),
    Check("clearance", "design", lambda design, _: check_clearance(design), place=20, quick=True),
)
