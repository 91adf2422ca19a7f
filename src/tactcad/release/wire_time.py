"""Estimated time on the wire-cutting machine."""

from __future__ import annotations

from dataclasses import dataclass

from tactcad.checks.shop import Feed
from tactcad.parts.cut_section import cut_section
from tactcad.parts.description import Part
from tactcad.parts.wire_passes import least_passes

PASSES = {"one pass": 1, "three passes": 3, "four passes": 4}


@dataclass(frozen=True)
class WireTime:
    """Of one piece: length of all contours mm, height mm, contours, passes, minutes."""

    length: float
    height: float
    contours: int
    passes: int
    minutes: float


def wire_time(part: Part, feed: Feed) -> WireTime:
    """The time of one piece, cut by itself.

    Every contour is cut in as many passes as the part's closest limit asks for; the main cut advances by
    feed.area over the height, at most feed.most, further passes by feed.skim; every contour is threaded once.
    """
    section = cut_section(part)
    if section is None:
        raise TypeError(f"{part.part_no} is not wire-cut")
    passes = PASSES[least_passes(min((c.upper - c.lower for c in part.characteristics), default=2.0) / 2)]
    length, height, contours = section.cut_length, section.thickness, 1 + len(section.openings)
    main = length / min(feed.area / height, feed.most)
    minutes = main + (passes - 1) * length / feed.skim + contours * feed.threading
    return WireTime(length, height, contours, passes, minutes)
