"""Whether a part is shown cut, and where: by what is sunk into it, not by what it is called.

A section is cut where a depth would otherwise be seen in hidden lines alone: a pocket, a groove, a blind hole, a counterbore. Its plane stands upright in the front view, x = constant, through axes of such features, and the cut
part is seen from the left, so that it stands to the right of the front view (first angle).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isclose

from tactcad.contour import Arc, Line
from tactcad.parts.description import Feature, Hole, Part, Pocket, drill_point_height

from .contours import contours
from .holes import Round
from .measure import axis_of, in_part
from .plan import Bore, Section, View, seen

LETTER = "S"  # neither a datum's (A, B, C) nor a detail's (X, Z)
SAME = 1e-6  # mm: a plane nearer to an axis than this goes through it


def section_of(part: Part, found: Sequence[Round], front: View) -> Section | None:
    """The plane that shows most kinds of sunk features, then the deepest, then most of them, then nearest to the middle; None
    where nothing is sunk, or every plane through an axis would cut another hole off its axis or run along a wall."""
    sunk = [f for f in part.features if is_sunk(f)]
    x0, _, x1, _ = part.body.outer.box
    planes = sorted({round(x, 9) for f in sunk if (x := _middle(f)) is not None and x0 + SAME < x < x1 - SAME})
    clean = [x for x in planes if not _cuts_off_axis(found, x) and not _runs_along(part, x)]
    if not clean:
        return None
    way = front.right[0]

    def worth(x: float) -> tuple[int, float, int, float, float]:
        shown = [f for f in sunk if _through(f, x)]
        return (len({_kind(f) for f in shown}), max(map(_depth, shown)), len(shown), -round(abs(x - (x0 + x1) / 2), 6), -way * x)

    best = max(clean, key=worth)
    view = View("", tuple(-r for r in front.right), front.up, (0, 0, 0, 0))
    bores = [_bore(view, r.hole) for r in found if not r.hole.axis[0] and abs(r.at[0] - best) < SAME]
    return Section(LETTER, best, tuple(bores))


def is_sunk(f: Feature) -> bool:
    """Whether a feature ends inside the part, or changes there."""
    return isinstance(f, Pocket) or not f.through or bool(f.counterbore)


def _middle(f: Feature) -> float | None:
    """x of a hole's axis or of a pocket's middle; None for a hole along x."""
    if isinstance(f, Hole):
        return None if f.axis[0] else f.at[0]
    x0, _, x1, _ = in_part(f, f.contour).box
    return (x0 + x1) / 2


def _through(f: Feature, x: float) -> bool:
    middle = _middle(f)
    return middle is not None and abs(middle - x) < SAME


def _kind(f: Feature) -> tuple:
    if isinstance(f, Pocket):
        return (f.name,)
    return (axis_of(f), f.diameter, f.depth, f.counterbore, f.thread, f.thread_depth)


def _depth(f: Feature) -> float:
    """Depth of the floor that hidden lines would show, mm."""
    return f.depth if isinstance(f, Pocket) or not f.through else f.counterbore[1]


def _cuts_off_axis(found: Sequence[Round], x: float) -> bool:
    """Whether the plane would show a hole narrower than it is."""
    return any(SAME < abs(r.at[0] - x) < _widest(r.hole) / 2 + SAME for r in found if not r.hole.axis[0])


def _widest(h: Hole) -> float:
    return max(h.diameter, h.counterbore[0] if h.counterbore else 0.0, nominal(h.thread) if h.thread else 0.0)


def nominal(thread: str) -> float:
    """Nominal diameter of a metric thread, mm."""
    return float(thread.removeprefix("M"))


def _runs_along(part: Part, x: float) -> bool:
    """Whether a wall of the part lies in the plane, or touches it."""
    return any(abs(place - x) < SAME for _, contour in contours(part) for s in contour for place in _walls(s))


def _walls(s: Line | Arc) -> Iterator[float]:
    if isinstance(s, Arc):
        yield s.centre[0] - s.radius
        yield s.centre[0] + s.radius
    elif abs(s.start[0] - s.end[0]) < SAME:
        yield s.start[0]


def _bore(view: View, h: Hole) -> Bore:
    """A hole's axis and thread as the section shows them."""
    counterbore = h.counterbore[1] if h.counterbore else 0.0
    cone = drill_point_height(h.diameter) if h.drill_point else 0.0

    def at(depth: float) -> tuple[float, float]:
        return seen(view, tuple(p + depth * a for p, a in zip(h.at, h.axis)))

    full = min(counterbore + h.thread_depth, h.depth) if h.thread else 0.0
    ends_inside = not (h.through and isclose(full, h.depth))
    return Bore(at(0.0), at(h.depth + cone), nominal(h.thread) if h.thread else 0.0, (at(counterbore), at(full)), ends_inside)
