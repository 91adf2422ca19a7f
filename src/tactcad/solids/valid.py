"""Whether the kernel holds a solid valid, in time that grows with the solid.

The kernel compares every two wires of a face, and does so four times in a check: a foil of 144 cells takes
half a minute each time. Of a prism (a plane area moved along z), read off its faces and edges, a plane test
shows that no two edges meet and that openings lie in the outline, side by side; the kernel then looks at one
wire at a time.
"""

from __future__ import annotations

from math import dist, hypot

from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepCheck import BRepCheck_Analyzer, BRepCheck_NoError, BRepCheck_Shell
from OCP.BRepTools import BRepTools
from OCP.GeomAbs import GeomAbs_Circle, GeomAbs_Cylinder, GeomAbs_Line, GeomAbs_Plane
from OCP.gp import gp_Dir
from OCP.ShapeAnalysis import ShapeAnalysis_ShapeTolerance
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_FORWARD, TopAbs_SHELL, TopAbs_VERTEX, TopAbs_WIRE
from OCP.TopExp import TopExp
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Compound, TopoDS_Edge, TopoDS_Face, TopoDS_Shape

from tactcad.contour import Arc, Line, Point, Segment
from tactcad.contour.inside import bound_one_area, keep_clear

from .occt import TopTools_IndexedMapOfShape, as_edge, as_face, as_shell, as_vertex, subshapes

# Beyond the shape's own tolerances, between edges that the kernel need not compare; chosen: ten of its least.
CLEAR_MM = 1e-6


def is_clear_prism(shape: TopoDS_Shape) -> bool:
    """Whether it is a prism along z whose edges keep clear of each other, and so passes nowhere through
    itself, and whose openings lie side by side in its outline; a plane test shows it in a hundredth of the
    kernel's time for a foil of thousands of edges."""
    edges = prism_edges(shape)
    if edges is None:
        return False
    room = CLEAR_MM + 2.0 * ShapeAnalysis_ShapeTolerance().Tolerance(shape, 1)
    return keep_clear(edges, room) and bound_one_area(edges)


def is_valid(shape: TopoDS_Shape, clear_prism: bool) -> bool:
    """Whether the kernel calls a solid valid.

    Of a clear prism it is asked for the shell, for every wall, and for every wire of the two ends as a face
    of its own.
    """
    if not clear_prism:
        return BRepCheck_Analyzer(shape).IsValid()
    for shell in subshapes(shape, TopAbs_SHELL):
        check = BRepCheck_Shell(as_shell(shell))
        if {check.Closed(), check.Orientation()} != {BRepCheck_NoError.BRepCheck_NoError}:
            return False
    pieces, make = TopoDS_Compound(), BRep_Builder()
    make.MakeCompound(pieces)
    for face in map(as_face, subshapes(shape, TopAbs_FACE)):
        for piece in _by_wire(face):
            make.Add(pieces, piece)
    return BRepCheck_Analyzer(pieces).IsValid()


def _by_wire(face: TopoDS_Face) -> list[TopoDS_Face]:
    """A plane face of several wires as one face a wire, that of an opening turned over so that it bounds what
    it surrounds."""
    forward = as_face(face.Oriented(TopAbs_FORWARD))
    wires = subshapes(forward, TopAbs_WIRE)
    if len(wires) == 1:
        return [face]
    outer = BRepTools.OuterWire_s(forward)
    place, make, pieces = TopLoc_Location(), BRep_Builder(), []
    surface = BRep_Tool.Surface_s(face, place)
    for wire in wires:
        alone = TopoDS_Face()
        make.MakeFace(alone, surface, place, BRep_Tool.Tolerance_s(face))
        make.Add(alone, wire if wire.IsSame(outer) else wire.Reversed())
        pieces.append(alone)
    return pieces


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
