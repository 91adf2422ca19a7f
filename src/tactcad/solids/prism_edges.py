"""Solids that are a plane area moved along z, as the kernel holds them: read off their faces and edges."""

from __future__ import annotations

from math import dist, hypot

from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.GeomAbs import GeomAbs_Circle, GeomAbs_Cylinder, GeomAbs_Line, GeomAbs_Plane
from OCP.gp import gp_Dir
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_VERTEX
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shape

from tactcad.contour import Arc, Line, Point, Segment

from .occt import TopTools_IndexedMapOfShape, as_edge, as_face, as_vertex, subshapes

KERNEL_MM = 1e-7  # the kernel's own tolerance: points nearer than this are one
PARALLEL = 1e-6  # radians within which a direction is along z, or across it; chosen: 0.1 um in 100 mm


def prism_edges(shape: TopoDS_Shape) -> list[Segment] | None:
    """The edges of a prism's lower face, mm; None for any other solid.

    A prism has two faces at right angles to z, and a plane or round wall along z from every edge of the lower
    one to the same edge of the upper one. It passes through itself only where these edges do.
    """
    heights = [BRep_Tool.Pnt_s(as_vertex(v)).Z() for v in subshapes(shape, TopAbs_VERTEX)]
    if not heights or max(heights) - min(heights) < 1e3 * KERNEL_MM:
        return None
    ends = min(heights), max(heights)
    all_edges = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, TopAbs_EDGE, all_edges)
    level: tuple[dict[int, Segment], dict[int, Segment]] = ({}, {})  # of lower and upper face
    for i in range(1, all_edges.Extent() + 1):
        edge = as_edge(all_edges.FindKey(i))
        at = [k for k, z in enumerate(ends) if all(abs(p[2] - z) <= KERNEL_MM for p in _vertices(edge))]
        trace = _trace(edge) if at else None
        if trace is not None:
            level[at[0]][i] = trace
        elif at or not _upright(edge):
            return None
    caps = 0
    walls: list[tuple[Segment, Segment]] = []
    for face_shape in subshapes(shape, TopAbs_FACE):
        face = as_face(face_shape)
        edges = [all_edges.FindIndex(e) for e in subshapes(face, TopAbs_EDGE)]
        lower, upper = ([side[e] for e in edges if e in side] for side in level)
        if _is_wall(face) and len(lower) == len(upper) == 1:
            walls.append((lower[0], upper[0]))
        elif _is_cap(face) and sorted((len(lower), len(upper))) == [0, len(edges)]:
            caps += 1
        else:
            return None
    whole = caps == 2 and len(walls) == len(level[0]) == len(level[1])
    return list(level[0].values()) if whole and all(_same_curve(*wall) for wall in walls) else None


def _vertices(edge: TopoDS_Edge) -> list[tuple[float, float, float]]:
    return [BRep_Tool.Pnt_s(as_vertex(v)).Coord() for v in subshapes(edge, TopAbs_VERTEX)]


def _upright(edge: TopoDS_Edge) -> bool:
    curve = BRepAdaptor_Curve(edge)
    return curve.GetType() == GeomAbs_Line and _along_z(curve.Line().Direction())


def _trace(edge: TopoDS_Edge) -> Segment | None:
    """A level edge seen along z: its ends are those of its vertices, so that neighbours share them."""
    curve, points = BRepAdaptor_Curve(edge), _vertices(edge)
    first: Point = points[0][:2]
    last: Point = points[-1][:2]
    if curve.GetType() == GeomAbs_Line:
        return Line(first, last)
    if curve.GetType() != GeomAbs_Circle:
        return None
    circle, start = curve.Circle(), curve.Value(curve.FirstParameter()).Coord()
    if not _along_z(circle.Axis().Direction()):
        return None
    if dist(start[:2], first) > dist(start[:2], last):
        first, last = last, first
    centre = circle.Location()
    return Arc(first, last, (centre.X(), centre.Y()), circle.Axis().Direction().Z() > 0)


def _along_z(direction: gp_Dir) -> bool:
    return hypot(direction.X(), direction.Y()) <= PARALLEL


def _is_wall(face: TopoDS_Face) -> bool:
    surface = BRepAdaptor_Surface(face)
    if surface.GetType() == GeomAbs_Plane:
        return abs(surface.Plane().Axis().Direction().Z()) <= PARALLEL
    return surface.GetType() == GeomAbs_Cylinder and _along_z(surface.Cylinder().Axis().Direction())


def _is_cap(face: TopoDS_Face) -> bool:
    surface = BRepAdaptor_Surface(face)
    return surface.GetType() == GeomAbs_Plane and _along_z(surface.Plane().Axis().Direction())


def _same_curve(one: Segment, other: Segment) -> bool:
    """Whether two traces are the same curve, whichever way they run."""
    a, b = (sorted((s.start, s.end)) for s in (one, other))
    points = [*zip(a, b), (one.at(0.5), other.at(0.5))]
    return all(max(abs(p[0] - q[0]), abs(p[1] - q[1])) <= KERNEL_MM for p, q in points)
