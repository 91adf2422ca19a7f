"""Faces of a built solid, found by the pieces of surface that the part's description names."""

from __future__ import annotations

from OCP.BOPTools import BOPTools_AlgoTools3D
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.gp import gp_Pnt, gp_Pnt2d
from OCP.IntTools import IntTools_Context
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape

from tactcad.parts.description import Vector
from tactcad.parts.surface_pieces import Piece

from .explore import subshapes
from .occt import as_edge, as_face


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
