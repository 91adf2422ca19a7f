"""Screw holes of plates."""

from __future__ import annotations

from .description import Hole, Vector
from .library.screws import DRILL_REACH, METRIC, TAP_REACH, blind_thread, counterbore_diameter

# Full thread deeper than this many diameters only breaks taps; chosen: usual advice is 2 to 3.
DEEPEST_THREAD = 2.5


def corners(x: float, y: float) -> tuple[tuple[float, float], ...]:
    """The corners of a rectangle 2 x by 2 y around the middle, as screws stand in a plate."""
    return tuple((sx * x, sy * y) for sx in (-1, 1) for sy in (-1, 1))


def sunk(name: str, thread: str, at: Vector, axis: Vector, thickness: float, under_head: float) -> Hole:
    """Clearance hole through a plate, counterbored from `at` until `under_head` is left under the head."""
    deep = round(thickness - under_head, 9)
    counterbore = (counterbore_diameter(thread), deep) if deep > 0 else None
    return Hole(name, at, axis, METRIC[thread].clearance, thickness, True, counterbore=counterbore)


def tapped(name: str, thread: str, at: Vector, axis: Vector, thickness: float, engaged: float = 0.0) -> Hole:
    """Drilled through, or blind where the plate is thicker than a drill reaches.

    Threaded from `at` as deep as is useful, and at least to the end of the screw, which is `engaged` mm in.
    """
    m = METRIC[thread]
    full = min(thickness, max(DEEPEST_THREAD * m.d, engaged))
    if thickness > DRILL_REACH * m.tap_drill:
        return tapped_blind(name, thread, at, axis, full)
    return Hole(name, at, axis, m.tap_drill, thickness, True, thread=thread, thread_depth=full)


def tapped_through(name: str, thread: str, at: Vector, axis: Vector, depth: float) -> Hole:
    """Drilled through `depth` mm, and tapped from `at` as deep as a tap reaches."""
    full = min(depth, TAP_REACH * METRIC[thread].d)
    return Hole(name, at, axis, METRIC[thread].tap_drill, depth, True, thread=thread, thread_depth=full)


def tapped_blind(name: str, thread: str, at: Vector, axis: Vector, full: float | None = None) -> Hole:
    """Blind thread of 1.5 d and 1.5 mm, or of `full`, with two pitches of run-out and the drill's cone."""
    m = METRIC[thread]
    full = blind_thread(thread) if full is None else full
    return Hole(
        name,
        at,
        axis,
        m.tap_drill,
        round(full + 2 * m.pitch, 9),
        False,
        thread=thread,
        thread_depth=full,
        drill_point=True,
    )
