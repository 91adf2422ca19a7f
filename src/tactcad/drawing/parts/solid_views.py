"""Views of a part's solid from the kernel: visible and hidden edges by exact hidden-line removal, as lines
and arcs; and the solid cut by the plane of a section.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, degrees, dist, hypot

from OCP.Bnd import Bnd_Box
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.BRepTools import BRepTools_WireExplorer
from OCP.GeomAbs import GeomAbs_Circle, GeomAbs_Plane
from OCP.gp import gp_Pnt
from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED, TopAbs_WIRE
from OCP.TopoDS import TopoDS_Shape, TopoDS_Wire

from tactcad.design.messages import CheckFailure
from tactcad.parts.language.description import Vector
from tactcad.solids.occt import as_face, as_wire, subshapes

from ..engine.ink import HIDDEN, VISIBLE, DrawnArc, Hatch, LineType, Point, Role, Stroke
from ..engine.picture import compound, curves_of, exact, on_curve, projector
from .sheet_plan import SectionPlane, View, seen

CHORD = 0.001  # mm of the part: other curves than lines and circles are drawn as chords this close
SAME = 1e-4  # mm: edges nearer than this are one
BEYOND = 1.0  # mm: overhang of the kept box beyond the part
KERNEL_TOLERANCE = 1e-7  # mm: the kernel's own tolerance


def projected(
    shape: TopoDS_Shape, eye: Vector, right: Vector, hidden: bool = True
) -> list[Stroke | DrawnArc]:
    """Edges in the view's plane (mm of the part), sorted: visible ones, then, if asked for, hidden ones that
    no visible one covers.

    Edges between tangent faces are left out, as ISO 128-3 allows.
    """
    result = exact([compound([shape])], projector(eye, right))
    seen = _curves((result.VCompound(), result.OutLineVCompound()), VISIBLE, "outline")
    if not hidden:
        return seen
    behind = _curves((result.HCompound(), result.OutLineHCompound()), HIDDEN, "hidden")
    return seen + [piece for curve in behind for piece in _uncovered(curve, seen)]


def _curves(compounds: Sequence[TopoDS_Shape | None], line: LineType, role: Role) -> list[Stroke | DrawnArc]:
    """Each curve once, in canonical order."""
    drawn = {_curve(curve, line, role) for compound in compounds for curve in curves_of(compound)}
    return sorted(filter(None, drawn), key=lambda c: (isinstance(c, DrawnArc), repr(c)))


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
    (ax, ay), (bx, by) = points[0], points[-1]
    size = hypot(bx - ax, by - ay) or 1.0
    if all(abs((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / size < SAME for x, y in points):
        points = [points[0], points[-1]]
    kept = tuple(p for i, p in enumerate(points) if i == 0 or p != points[i - 1])
    if len(kept) < 2 or dist(kept[0], kept[-1]) < SAME and len(kept) < 4:
        return None
    return Stroke(min(kept, kept[::-1]), line, role)


def _point(p: gp_Pnt) -> Point:
    return (round(p.X(), 6) + 0.0, round(p.Y(), 6) + 0.0)


def _angle(centre: Point, p: Point) -> float:
    return round(degrees(atan2(p[1] - centre[1], p[0] - centre[0])) % 360.0, 6)


def _uncovered(curve: Stroke | DrawnArc, seen: Sequence[Stroke | DrawnArc]) -> list[Stroke | DrawnArc]:
    """The pieces of a hidden curve that no visible one covers."""
    if isinstance(curve, DrawnArc):
        arcs = [s for s in seen if isinstance(s, DrawnArc) and dist(s.centre, curve.centre) < SAME]
        same = [s for s in arcs if abs(s.radius - curve.radius) < SAME]
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


def cut(shape: TopoDS_Shape, view: View, section: SectionPlane) -> tuple[TopoDS_Shape, Hatch]:
    """The part behind the plane of a section, and its cut face in the view's plane (mm of the part).

    Raises CheckFailure if the plane misses the part.
    """
    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box)
    low, high = ([p.X(), p.Y(), p.Z()] for p in (box.CornerMin(), box.CornerMax()))
    low, high = [v - BEYOND for v in low], [v + BEYOND for v in high]
    k, at = section.axis, section.at
    (low if view.eye[k] < 0 else high)[k] = at
    kept = BRepPrimAPI_MakeBox(gp_Pnt(*low), gp_Pnt(*high)).Shape()
    half = BRepAlgoAPI_Common(shape, kept).Shape()
    loops = []
    for face in map(as_face, subshapes(half, TopAbs_FACE)):
        surface = BRepAdaptor_Surface(face)
        if surface.GetType() != GeomAbs_Plane:
            continue
        plane = surface.Plane()
        # OCC counts coordinates from 1
        off, turn = (p.Coord(k + 1) for p in (plane.Location(), plane.Axis().Direction()))
        if max(abs(off - at), abs(abs(turn) - 1.0)) < KERNEL_TOLERANCE:
            loops += [_loop(as_wire(wire), view) for wire in subshapes(face, TopAbs_WIRE)]
    if not loops:
        where = f"{'xy'[k]} = {at:g} mm"
        raise CheckFailure(f"drawings: the section at {where} cuts nothing; no drawing was written")
    return half, Hatch(tuple(sorted(loops)))


def _loop(wire: TopoDS_Wire, view: View) -> tuple[Point, ...]:
    """The wire as a polygon in the view; curved edges as chords."""
    points: list[Point] = []
    explorer = BRepTools_WireExplorer(wire)
    while explorer.More():
        edge = explorer.Current()
        run = on_curve(BRepAdaptor_Curve(edge), CHORD)
        if edge.Orientation() == TopAbs_REVERSED:
            run.reverse()
        flat = [seen(view, (p.X(), p.Y(), p.Z())) for p in run[:-1]]
        points += [(round(u, 6) + 0.0, round(v, 6) + 0.0) for u, v in flat]
        explorer.Next()
    start = points.index(min(points))
    return tuple(points[start:] + points[:start])
