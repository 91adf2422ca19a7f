"""Metric threads and the holes of their screws: ISO 4762, ISO 4026, ISO 4032, DIN 976-1 (mm)."""

from __future__ import annotations

from dataclasses import dataclass, fields

from tactcad.design.text_values import data_rows, number

from .description import Hole, Vector, drill_point_height


@dataclass(frozen=True)
class Metric:
    """Sizes of one coarse thread, its screws and nut (mm); data/screws.csv names the standard of each."""

    d: float
    pitch: float
    tap_drill: float
    clearance: float  # hole
    head: float
    head_height: float
    key: float
    key_depth: float
    set_key: float
    set_key_depth: float
    set_point: float
    nut: float  # across flats
    nut_height: float
    torque: float  # N m
    tap_shank: float
    tap_reach: float  # length of the tap before its shank


ROWS = data_rows(__file__, "screws")
METRIC = {row["thread"]: Metric(**{f.name: number(row[f.name]) for f in fields(Metric)}) for row in ROWS}
# Threads in aluminium: engaged 1.5 d (common practice for aluminium against steel's 1 d).
ENGAGED = 1.5
# Full thread in diameters, and drilled depth in diameters, that taps and drills reach (usual advice).
TAP_REACH = 3.0
DRILL_REACH = 10.0
# A socket is wider than its nut's corners by twice its wall, mm; chosen: thin-walled 1/4 inch sockets.
SOCKET_WALL = 1.25


def engagement(thread: str) -> float:
    """Least length of engaged thread in aluminium, mm."""
    return ENGAGED * METRIC[thread].d


def tapped_depth(thread: str) -> float:
    """Drilled depth below the face, cone included, of a blind hole with 1.5 d + 1.5 mm of full thread.

    Two pitches of run-out below the full thread are left for the tap's lead.
    """
    m = METRIC[thread]
    return blind_thread(thread) + 2 * m.pitch + drill_point_height(m.tap_drill)


def blind_thread(thread: str) -> float:
    """Full thread of a blind hole, mm: the engaged length, and 1.5 mm so that the screw's end stays free for
    any length by js15 (0.29 mm of an M3x8) and the thinnest plate under its head."""
    return engagement(thread) + 1.5


def counterbore_diameter(thread: str) -> float:
    """Counterbore for an ISO 4762 head, mm: head and 0.25 around it."""
    return METRIC[thread].head + 0.5


# Full thread deeper than this many diameters only breaks taps; chosen: usual advice is 2 to 3.
DEEPEST_THREAD = 2.5


# mm that a head stays below the face that it is sunk under: chosen, twice what general tolerances leave a
# counterbore 3 to 6 mm deep.
SUNK = 0.2


def corners(x: float, y: float) -> tuple[tuple[float, float], ...]:
    """The corners of a rectangle 2 x by 2 y around the middle, for a plate's screws."""
    return tuple((sx * x, sy * y) for sx in (-1, 1) for sy in (-1, 1))


def sunk(name: str, thread: str, at: Vector, axis: Vector, thickness: float, under_head: float) -> Hole:
    """Clearance hole through a plate, counterbored from `at` until `under_head` is left under the head."""
    deep = round(thickness - under_head, 9)
    counterbore = (counterbore_diameter(thread), deep) if deep > 0 else None
    return Hole(name, at, axis, METRIC[thread].clearance, thickness, True, counterbore=counterbore)


def tapped(name: str, thread: str, at: Vector, axis: Vector, thickness: float, engaged: float = 0.0) -> Hole:
    """Drilled through, or blind if the plate is thicker than a drill reaches.

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
