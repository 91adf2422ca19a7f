"""Rules on the overload stop's plate, and on the arms that [stop.gaps] names."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, floor

from .layout import Layout
from .stop_gap import stop_limit
from .stop_plate import SHARE, shortest_pitch, stop_plate_beams

Finding = tuple[str, str, object, str]


def gaps_name_an_arm(layout: Layout) -> Iterator[Finding]:
    arms = sorted({p.arm for p in layout.elements})
    for arm, gap in (layout.design.stop.gaps or {}).items():
        if arm not in arms:
            yield (
                f"stop.gaps.{arm:g}",
                "no element has an arm of this length",
                gap,
                f"a gap for arms of {', '.join(f'{a:g}' for a in arms)} mm",
            )


def stop_plate_stays(layout: Layout) -> Iterator[Finding]:
    """Under an arm that the overload force presses on it the stop plate gives way by SHARE of the gap at most.

    The gap is that of a stop that gives no way: what it protects does not depend on the plate.
    """
    d, give = layout.design, layout.stop_give
    for p in layout.elements:
        force = d.rating.overload_force * p.load_arm / p.arm
        allowed = SHARE * stop_limit(layout, p, give=0.0).gap / force
        if not 0 < allowed < give:
            continue  # where the gap is nothing, other rules say why
        what = (
            f"the stop plate gives way by {give * force:.3g} mm under element {p.number} and "
            f"{d.rating.overload_force:g} N, more than a tenth of its gap"
        )
        yield _what_helps(layout, what, allowed)
        return


def _what_helps(layout: Layout, what: str, allowed: float) -> Finding:
    """The field that brings the plate's compliance (mm/N) down to what is allowed: the pitch if it is given and
    enough, else a thicker plate, else less force."""
    d, c = layout.design, layout.design.clamp
    if c.hold_down_pitch is not None:
        pitch = _largest_pitch(layout, allowed)
        if pitch is not None:
            return ("clamp.hold_down_pitch", what, c.hold_down_pitch, f"at most {pitch:g} mm")
    for tenths in range(ceil(10 * c.stop_plate_thickness), 201):
        if stop_plate_beams(layout, thickness=tenths / 10).one <= allowed:
            return (
                "clamp.stop_plate_thickness",
                what,
                c.stop_plate_thickness,
                f"at least {tenths / 10:g} mm",
            )
    most = d.rating.overload_force * allowed / layout.stop_give
    return ("rating.overload_force", what, d.rating.overload_force, f"at most {most:.2g} N")


def _largest_pitch(layout: Layout, allowed: float) -> float | None:
    """Largest pitch (mm, by halves) of set screws that is allowed; None where none is."""
    pitch = floor(2 * layout.hold_down_pitch) / 2
    least = max(shortest_pitch(layout), 2 * layout.beyond_screws)
    while pitch >= least:
        if stop_plate_beams(layout, pitch=pitch).one <= allowed:
            return pitch
        pitch -= 0.5
    return None
