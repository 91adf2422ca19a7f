"""Whether a part is shown in section, and where: decided by its features, not by its name.

A section is cut where a depth would otherwise be seen in hidden lines only: a pocket, a groove, a blind
hole, a counterbore. Its plane stands upright on the front view's paper, through axes of such features: x =
constant, seen from the left, so that it stands to the right of the front view (first angle); or, where no
such plane is possible, y = constant, seen from the side whose place above or below the front view is free.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isclose

from tactcad.contour import Arc, Line
from tactcad.parts.description import Feature, Hole, Part, Pocket, Vector, drill_point_height, vector

from .boxes import Point
from .contours import axis_of, contours, in_part
from .holes import Round, widest
from .sheet_plan import Bore, SectionPlane, View, opposite, seen
from .sketch import view_of

LETTER = "S"  # neither a datum's (A, B, C) nor a detail's (X, Z)
SAME = 1e-6  # mm: a plane nearer to an axis than this goes through it


def section_of(part: Part, holes: Sequence[Round], front: View, below: Vector | None) -> SectionPlane | None:
    """The plane that shows most kinds of sunk features, then the deepest, then most of them, then nearest to
    the middle.

    None where no feature is sunk, or every plane through an axis would cut another hole off its axis or run
    along a wall. `below` is the eye of a view onto a y face, whose place on the sheet is taken.
    """
    sunk = [f for f in part.features if is_sunk(f)]
    for k in (0, 1):
        at = _best(part, sunk, holes, k, (front.right, front.up)[k][k])
        if at is None:
            continue
        bare = View("", *_sight(front, below, k), (0, 0, 0, 0))
        bores = [_bore(bare, r.hole) for r in holes if not r.hole.axis[k] and abs(r.at[k] - at) < SAME]
        return SectionPlane(LETTER, k, at, tuple(bores))
    return None


def section_view(part: Part, front: View, below: Vector | None, section: SectionPlane) -> View:
    """The bare view of a section, where first-angle projection puts it."""
    eye, up = _sight(front, below, section.axis)
    name = "right" if section.axis == 0 else "below" if eye == front.up else "above"
    return replace(view_of(part, name, eye, up), hidden=False, section=section)


def _sight(front: View, below: Vector | None, k: int) -> tuple[Vector, Vector]:
    """Eye and up of a section across axis k."""
    if k == 0:
        return opposite(front.right), front.up
    if below is None or below != front.up:
        return front.up, opposite(front.eye)
    return opposite(front.up), front.eye


def _best(part: Part, sunk: Sequence[Feature], holes: Sequence[Round], k: int, way: float) -> float | None:
    box = part.extrusion.outer.box
    low, high = box[k], box[k + 2]
    planes = sorted(
        {round(v, 9) for f in sunk if (v := _middle(f, k)) is not None and low + SAME < v < high - SAME}
    )

    def worth(v: float) -> tuple[int, float, int, float, float]:
        shown = [f for f in sunk if _through(f, k, v)]
        return (
            len({_kind(f) for f in shown}),
            max(map(_depth, shown)),
            len(shown),
            -round(abs(v - (low + high) / 2), 6),
            -way * v,
        )

    clean = [v for v in planes if not _cuts_off_axis(holes, k, v) and not _runs_along(part, k, v)]
    return max(clean, key=worth, default=None)


def is_sunk(f: Feature) -> bool:
    """Whether a feature ends or changes inside the part."""
    return isinstance(f, Pocket) or not f.through or bool(f.counterbore)


def _middle(f: Feature, k: int) -> float | None:
    """Coordinate k of a hole's axis or of a pocket's middle; None for a hole along k."""
    if isinstance(f, Hole):
        return None if f.axis[k] else f.at[k]
    box = in_part(f, f.contour).box
    return (box[k] + box[k + 2]) / 2


def _through(f: Feature, k: int, at: float) -> bool:
    middle = _middle(f, k)
    return middle is not None and abs(middle - at) < SAME


def _kind(f: Feature) -> tuple:
    if isinstance(f, Pocket):
        return (f.name,)
    return (axis_of(f), f.diameter, f.depth, f.counterbore, f.thread, f.thread_depth)


def _depth(f: Feature) -> float:
    """Depth of the floor that hidden lines would show, mm."""
    return f.counterbore[1] if isinstance(f, Hole) and f.through and f.counterbore else f.depth


def _cuts_off_axis(holes: Sequence[Round], k: int, at: float) -> bool:
    """Whether the plane would show a hole narrower than it is."""
    return any(
        SAME < abs(r.at[k] - at) < max(widest(r.hole), r.hole.thread_diameter) / 2 + SAME
        for r in holes
        if not r.hole.axis[k]
    )


def _runs_along(part: Part, k: int, at: float) -> bool:
    """Whether a wall of the part lies in the plane, or touches it."""
    return any(
        abs(place - at) < SAME for _, contour in contours(part) for s in contour for place in _walls(s, k)
    )


def _walls(s: Line | Arc, k: int) -> Iterator[float]:
    if isinstance(s, Arc):
        yield s.centre[k] - s.radius
        yield s.centre[k] + s.radius
    elif abs(s.start[k] - s.end[k]) < SAME:
        yield s.start[k]


def _bore(view: View, h: Hole) -> Bore:
    """A hole's axis and thread as the section shows them."""
    counterbore = h.counterbore[1] if h.counterbore else 0.0
    cone = drill_point_height(h.diameter) if h.drill_point else 0.0

    def at(depth: float) -> Point:
        return seen(view, vector(p + depth * a for p, a in zip(h.at, h.axis)))

    full = min(counterbore + h.thread_depth, h.depth) if h.thread else 0.0
    ends_inside = not (h.through and isclose(full, h.depth))
    return Bore(at(0.0), at(h.depth + cone), h.thread_diameter, (at(counterbore), at(full)), ends_inside)
