"""The part of the kernel's binding that all code imports from here: names that differ between OCP 7.9 and OCP
8, sub-shapes, places, and faces found by the pieces of surface that a part's description names.
"""

from __future__ import annotations

from OCP.BOPTools import BOPTools_AlgoTools3D
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.gp import gp_Pnt, gp_Pnt2d, gp_Trsf
from OCP.IntTools import IntTools_Context
from OCP.OSD import OSD_ThreadPool
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_ShapeEnum
from OCP.TopExp import TopExp
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Face, TopoDS_Shape

from tactcad.parts.language.description import Vector
from tactcad.parts.language.surface import Piece
from tactcad.scenes.scene import Rotation

try:
    from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as TopTools_IndexedMapOfShape
    from OCP.collections import List_TopoDS_Shape as TopTools_ListOfShape
    from OCP.collections import Sequence_TDF_Label as TDF_LabelSequence
except ImportError:  # OCP 7.9
    from OCP.TDF import TDF_LabelSequence
    from OCP.TopTools import TopTools_IndexedMapOfShape, TopTools_ListOfShape

__all__ = [
    "TDF_LabelSequence",
    "TopTools_IndexedMapOfShape",
    "TopTools_ListOfShape",
    "as_edge",
    "as_face",
    "as_shell",
    "as_vertex",
    "as_wire",
]

# OCP 7.9 marks static functions by _s where OCP 8 does not.
as_edge, as_face, as_shell, as_vertex, as_wire = (
    getattr(TopoDS, f"{kind}_s", None) or getattr(TopoDS, kind)
    for kind in ("Edge", "Face", "Shell", "Vertex", "Wire")
)


def end_threads() -> None:
    """End the threads that the kernel started for booleans, and let it start no more.

    A forked process has none of these threads, and its first boolean would wait for them for ever.
    """
    pool = getattr(OSD_ThreadPool, "DefaultPool_s", None) or OSD_ThreadPool.DefaultPool
    pool().Init(1)


def subshapes(shape: TopoDS_Shape, kind: TopAbs_ShapeEnum) -> list[TopoDS_Shape]:
    """Every distinct sub-shape of that kind, in the kernel's order."""
    distinct = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, kind, distinct)
    return [distinct.FindKey(i) for i in range(1, distinct.Extent() + 1)]


def location(origin: Vector, rotation: Rotation) -> TopLoc_Location:
    """The kernel's location: scene point = rotation x local point + origin (mm)."""
    (a, b, c), (x, y, z) = rotation, origin
    t = gp_Trsf()
    t.SetValues(*a, x, *b, y, *c, z)
    return TopLoc_Location(t)


def placed_shape(shape: TopoDS_Shape, origin: Vector, rotation: Rotation) -> TopoDS_Shape:
    """The same shape, shared, at a place in the scene.

    Parameters
    ----------
    shape
        In its own frame, mm.
    origin
        Of that frame in the scene, mm.
    rotation
        Rows of the matrix that turns local into scene directions.
    """
    return shape.Located(location(origin, rotation))


class FaceFinder:
    """The faces of a solid, each with points all over it: one inside, and three on every edge."""

    def __init__(self, solid: TopoDS_Shape) -> None:
        self._points = [(as_face(f), _points(as_face(f))) for f in subshapes(solid, TopAbs_FACE)]

    def on(self, piece: Piece) -> list[TopoDS_Face]:
        """The faces that lie wholly on a piece of surface; features cut into it may have left several."""
        return [face for face, points in self._points if all(map(piece.holds, points))]


def _points(face: TopoDS_Face) -> list[Vector]:
    inside = gp_Pnt()
    BOPTools_AlgoTools3D.PointInFace_s(face, inside, gp_Pnt2d(), IntTools_Context())
    points = [inside]
    for edge in subshapes(face, TopAbs_EDGE):
        curve = BRepAdaptor_Curve(as_edge(edge))
        first, last = curve.FirstParameter(), curve.LastParameter()
        points += [curve.Value(u) for u in (first, (first + last) / 2, last)]
    return [(p.X(), p.Y(), p.Z()) for p in points]
