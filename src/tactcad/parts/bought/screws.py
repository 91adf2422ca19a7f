"""Metric screws, nuts and rods: ISO 4762, ISO 4026, ISO 4032, DIN 976-1 (mm).

Screws are modelled at nominal diameter without thread; head and socket are true. Local frame: axis z,
the bearing face at z = 0, the screw pointing along +z.
"""

from __future__ import annotations

import re
from dataclasses import replace
from math import cos, pi, sin

from tactcad.contour import Contour, chain, circle
from tactcad.design.text_values import number

from ..language.description import Extrusion, Hole, Material, ModelFile, Part, Pocket, Purchase, Revolution
from ..language.metric import METRIC, ROWS

STAINLESS = Material("stainless steel A2-70", 7900)
STAINLESS_SET = Material("stainless steel A2-21H", 7900)


# Preferred lengths of ISO 4762 and ISO 4026, of which each size has those between its shortest and longest.
_SERIES = (2, 2.5, 3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 30, 35, 40, 45, 50)


def _lengths(kind: str) -> dict[str, tuple[float, ...]]:
    ends = {row["thread"]: (number(row[f"{kind}_shortest"]), number(row[f"{kind}_longest"])) for row in ROWS}
    return {
        thread: tuple(float(n) for n in _SERIES if low <= n <= high) for thread, (low, high) in ends.items()
    }


CAP_SCREW_LENGTHS = _lengths("cap")
SET_SCREW_LENGTHS = _lengths("set")


def seating_torque(thread: str) -> float:
    """N m for a set screw that holds a plate down: a third of the cap screw's, to one digit; chosen: thread
    lacquer keeps it, so that it need not clamp."""
    return float(f"{METRIC[thread].torque / 3:.1g}")


def seating_force(thread: str) -> float:
    """N of a set screw at its seating torque, after VDI 2230 with the friction of data/screws.csv's torques,
    0.12: thread's lead, thread's friction at d2 = d - 0.6495 P, and that of its flat point."""
    m, friction = METRIC[thread], 0.12
    lever = m.pitch / (2 * pi) + friction * ((m.d - 0.6495 * m.pitch) / 2 / cos(pi / 6) + m.set_point / 3)
    return 1e3 * seating_torque(thread) / lever


def cap_screw(thread: str, length: float) -> Part:
    """ISO 4762 socket head cap screw.

    Parameters
    ----------
    thread
        Such as "M3".
    length
        mm, a length of the standard.

    Raises
    ------
    KeyError
        If the table has no such thread.
    ValueError
        If the standard has no such length.
    """
    m = METRIC[thread]
    if length not in CAP_SCREW_LENGTHS[thread]:
        raise ValueError(f"ISO 4762 {thread} has no length {length:g}; it has {CAP_SCREW_LENGTHS[thread]}")
    body = _revolved(
        [
            (0, -m.head_height),
            (m.head / 2, -m.head_height),
            (m.head / 2, 0),
            (m.d / 2, 0),
            (m.d / 2, length),
            (0, length),
        ]
    )
    designation = f"ISO 4762 {thread}x{length:g} A2-70"
    return Part(
        part_no=f"ISO4762-{thread}x{length:g}-A2-70-screw",
        name=f"Socket head cap screw {thread}x{length:g}",
        process="bought",
        material=STAINLESS,
        body=body,
        features=(_socket(m.key, m.key_depth, -m.head_height),),
        colour="#8a8d91",
        purchase=Purchase(designation, alternates=f"DIN 912 {thread}x{length:g} A2-70"),
        spares=2,
        kind="cap screw",
        thread=thread,
    )


def set_screw(thread: str, length: float) -> Part:
    """ISO 4026 set screw with flat point: z = 0 is the driven end, the point at z = length (mm).

    Raises KeyError for a thread and ValueError for a length that the standard does not have.
    """
    m = METRIC[thread]
    if length not in SET_SCREW_LENGTHS[thread]:
        raise ValueError(f"ISO 4026 {thread} has no length {length:g}; it has {SET_SCREW_LENGTHS[thread]}")
    chamfer = (m.d - m.set_point) / 2
    body = _revolved(
        [(0, 0), (m.d / 2, 0), (m.d / 2, length - chamfer), (m.set_point / 2, length), (0, length)]
    )
    return Part(
        part_no=f"ISO4026-{thread}x{length:g}-A2-21H",
        name=f"Set screw {thread}x{length:g}, flat point",
        process="bought",
        material=STAINLESS_SET,
        body=body,
        features=(_socket(m.set_key, min(m.set_key_depth, length / 2), 0.0),),
        colour="#5c6066",
        purchase=Purchase(
            f"ISO 4026 {thread}x{length:g} A2-21H", alternates=f"DIN 913 {thread}x{length:g} A2"
        ),
        spares=2,
        kind="set screw",
        thread=thread,
    )


def for_pictures(part: Part) -> Part:
    """A screw or rod made slightly thinner than its tapped hole; any other part as it is.

    Hidden-line removal assumes that parts do not overlap: a thread that reaches into the material around its
    hole leaves marks on the faces that it pierces.
    """
    match = _THREADED.match(part.part_no)
    if not match or isinstance(part.body, ModelFile):
        return part
    m = METRIC[match[1]]
    thin = m.tap_drill / 2 - 0.02
    body: Extrusion | Revolution
    if isinstance(part.body, Extrusion):
        body = replace(part.body, outer=circle((0, 0), 2 * thin))
    else:
        points = (s.start for s in part.body.profile)
        body = _revolved([(r if r > m.d / 2 else min(r, thin), z) for r, z in points])
    return replace(part, part_no=f"{part.part_no}-drawn", body=body)


_THREADED = re.compile(r"(?:ISO4762|ISO4026|DIN976-1)-(M[\d.]+)x")


def nut(thread: str) -> Part:
    """ISO 4032 hexagon nut, bored at the tap drill's diameter; bearing face at z = 0, height along +z."""
    m = METRIC[thread]
    made = _nut("ISO 4032", f"Hexagon nut {thread}", thread, m.tap_drill, (m.nut, m.nut_height), "DIN 934")
    return replace(made, kind="nut", thread=thread)


# M6, of the force gauge's shaft: tap drill (ISO 2306), across flats and largest height of a thin nut (ISO
# 4035)
JAM_NUT = "M6", 5.0, (10.0, 3.2)


def jam_nut() -> Part:
    """ISO 4035 thin nut M6, as `nut`."""
    thread, drill, size = JAM_NUT
    return _nut("ISO 4035", f"Thin hexagon nut {thread}", thread, drill, size, "DIN 439")


def _nut(standard: str, name: str, thread: str, drill: float, size: tuple[float, float], other: str) -> Part:
    """A nut of that size: across flats and height, mm."""
    across, height = size
    return Part(
        part_no=f"{standard.replace(' ', '')}-{thread}-A2-70-nut",
        name=name,
        process="bought",
        material=STAINLESS,
        body=Extrusion(_hexagon(across), height),
        features=(
            Hole("thread", (0, 0, 0), (0, 0, 1), drill, height, True, thread=thread, thread_depth=height),
        ),
        colour="#8a8d91",
        purchase=Purchase(f"{standard} {thread} A2-70", alternates=f"{other} {thread} A2"),
        spares=2,
    )


def threaded_rod(thread: str, length: float) -> Part:
    """DIN 976-1 threaded rod cut to length (mm), along +z from 0."""
    m = METRIC[thread]
    return Part(
        part_no=f"DIN976-1-{thread}x{length:g}-A2-70-rod",
        name=f"Threaded rod {thread}, cut to {length:g}",
        process="bought",
        material=STAINLESS,
        body=Extrusion(circle((0, 0), m.d), length),
        colour="#8a8d91",
        purchase=Purchase(
            f"DIN 976-1 A {thread} A2-70, cut to {length:g} mm", alternates=f"DIN 975 {thread} A2"
        ),
    )


def _revolved(profile: list[tuple[float, float]]) -> Revolution:
    return Revolution(chain(profile))


def _socket(key: float, depth: float, z: float) -> Pocket:
    return Pocket("socket", (0, 0, z), (0, 0, 1), (1, 0, 0), _hexagon(key), depth)


def _hexagon(across_flats: float) -> Contour:
    r = across_flats / 2 / cos(pi / 6)
    return chain([(r * cos(k * pi / 3), r * sin(k * pi / 3)) for k in range(6)])
