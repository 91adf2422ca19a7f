"""Views of a part's solid from the kernel's exact hidden-line removal: visible and hidden edges as lines and
arcs."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, degrees, hypot

from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.GeomAbs import GeomAbs_Circle
from OCP.gp import gp_Pnt
from OCP.TopoDS import TopoDS_Shape

from tactcad.parts.description import Vector

from .ink import HIDDEN, VISIBLE, DrawnArc, LineType, Point, Role, Stroke
from .picture import compound, curves_of, exact, on_curve, projector

CHORD = 0.001  # mm of the part: other curves than lines and circles are drawn as chords this close
SAME = 1e-4  # mm: edges nearer than this are one


def projected(shape: TopoDS_Shape, eye: Vector, right: Vector) -> list[Stroke | DrawnArc]:
    """Edges in the view's plane (mm of the part), sorted: visible ones, then hidden ones that no visible one
    covers.

    Edges between tangent faces are left out, as ISO 128-3 allows.
    """
    result = exact([compound([shape])], projector(eye, right))
    seen = _once(_curves((result.VCompound(), result.OutLineVCompound()), VISIBLE, "outline"))
    behind = _once(_curves((result.HCompound(), result.OutLineHCompound()), HIDDEN, "hidden"))
    return seen + [piece for curve in behind for piece in _uncovered(curve, seen)]


def _curves(compounds: Sequence[TopoDS_Shape | None], line: LineType, role: Role) -> list[Stroke | DrawnArc]:
    drawn = (_curve(curve, line, role) for compound in compounds for curve in curves_of(compound))
    return [curve for curve in drawn if curve]


def _curve(curve: BRepAdaptor_Curve, line: LineType, role: Role) -> Stroke | DrawnArc | None:
    first, last = curve.FirstParameter(), curve.LastParameter()
    if curve.GetType() == GeomAbs_Circle:
        circle = curve.Circle()
        centre = _point(circle.Location())
        a, b = (_point(curve.Value(t)) for t in (first, last))
        if abs(last - first) >= 6.283185:
            return DrawnArc(centre, round(circle.Radius(), 6), 0.0, 360.0, line, role)
        if circle.Axis().Direction().Z() < 0:
            a, b = b, a
        return DrawnArc(centre, round(circle.Radius(), 6), _angle(centre, a), _angle(centre, b), line, role)
    points = [_point(p) for p in on_curve(curve, CHORD)]
    if _straight(points):
        points = [points[0], points[-1]]
    kept = tuple(p for i, p in enumerate(points) if i == 0 or p != points[i - 1])
    if len(kept) < 2 or hypot(kept[0][0] - kept[-1][0], kept[0][1] - kept[-1][1]) < SAME and len(kept) < 4:
        return None
    return Stroke(min(kept, kept[::-1]), line, role)


def _straight(points: Sequence[Point]) -> bool:
    (ax, ay), (bx, by) = points[0], points[-1]
    size = hypot(bx - ax, by - ay) or 1.0
    return all(abs((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / size < SAME for x, y in points)


def _point(p: gp_Pnt) -> Point:
    return (round(p.X(), 6) + 0.0, round(p.Y(), 6) + 0.0)


def _angle(centre: Point, p: Point) -> float:
    return round(degrees(atan2(p[1] - centre[1], p[0] - centre[0])) % 360.0, 6)


def _once(curves: Sequence[Stroke | DrawnArc]) -> list[Stroke | DrawnArc]:
    """Each curve once, in canonical order."""
    return sorted(set(curves), key=lambda c: (isinstance(c, DrawnArc), repr(c)))


def _uncovered(curve: Stroke | DrawnArc, seen: Sequence[Stroke | DrawnArc]) -> list[Stroke | DrawnArc]:
    """The pieces of a hidden curve that no visible one covers."""
    if isinstance(curve, DrawnArc):
        same = [
            s
            for s in seen
            if isinstance(s, DrawnArc)
            and _near(s.centre, curve.centre)
            and abs(s.radius - curve.radius) < SAME
        ]
        middle = curve.start + curve.sweep / 2
        return [] if any((middle - s.start) % 360.0 <= s.sweep + 1e-6 for s in same) else [curve]
    if len(curve.points) > 2:
        return [] if any(isinstance(s, Stroke) and s.points == curve.points for s in seen) else [curve]
    a, b = curve.points
    size = hypot(b[0] - a[0], b[1] - a[1])
    ux, uy = (b[0] - a[0]) / size, (b[1] - a[1]) / size
    open_parts = [(0.0, size)]
    for s in seen:
        if isinstance(s, DrawnArc) or len(s.points) > 2:
            continue
        if any(abs(ux * (y - a[1]) - uy * (x - a[0])) > SAME for x, y in s.points):
            continue
        low, high = sorted(ux * (x - a[0]) + uy * (y - a[1]) for x, y in s.points)
        open_parts = [
            part
            for p, q in open_parts
            for part in ((p, min(q, low)), (max(p, high), q))
            if part[1] - part[0] > SAME
        ]
    return [
        Stroke(tuple((a[0] + t * ux, a[1] + t * uy) for t in part), curve.line, curve.role)
        for part in open_parts
    ]


def _near(p: Point, q: Point) -> bool:
    return hypot(p[0] - q[0], p[1] - q[1]) < SAME
