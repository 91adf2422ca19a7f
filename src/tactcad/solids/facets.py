"""A shape as a viewer draws it: triangles face by face with normals, and the edges of its boundary."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepLib import BRepLib_ToolTriangulatedShape
from OCP.TopAbs import TopAbs_EDGE, TopAbs_REVERSED, TopAbs_VERTEX
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shape

from .explore import subshapes
from .occt import as_edge, as_vertex
from .triangles import face_triangles, tessellated

Floats = NDArray[np.float32]
Indices = NDArray[np.uint32]


@dataclass(frozen=True)
class Facets:
    """What is drawn of a shape.

    vertices, normals   (n, 3) points in mm and unit vectors; faces share none, so that edges stay sharp
    triangles           (m, 3) indices, facing outwards, face after face
    per_face            how many triangles each face has
    edges               (s, 2, 3) straight pieces in mm, edge after edge; seams and poles left out
    per_edge            how many pieces each edge has
    corners             (k, 3) ends of the edges, mm
    face_kinds          the kernel's number of each face's surface: 0 plane, 1 cylinder, ...
    edge_kinds          likewise of each edge's curve: 0 line, 1 circle, ...
    """

    vertices: Floats
    normals: Floats
    triangles: Indices
    per_face: Indices
    edges: Floats
    per_edge: Indices
    corners: Floats
    face_kinds: Indices
    edge_kinds: Indices


def facets(shape: TopoDS_Shape, linear: float, angular: float) -> Facets:
    """Tessellate a shape for a viewer.

    Parameters
    ----------
    shape
        Any shape of the kernel.
    linear
        Largest chord error, mm.
    angular
        Largest turn between facets, radians.

    Raises
    ------
    ValueError
        Where the kernel cannot mesh a face.
    """
    faces = tessellated(shape, linear, angular)
    meshed = [_face(face) for face in faces]
    starts = np.cumsum([0, *(len(points) for points, _, _ in meshed)])
    drawn = [(as_edge(e), lines) for e in subshapes(shape, TopAbs_EDGE) if len(lines := _edge(e, faces))]
    corners = [BRep_Tool.Pnt_s(as_vertex(v)).Coord() for v in subshapes(shape, TopAbs_VERTEX)]
    return Facets(
        _floats([points for points, _, _ in meshed]),
        _floats([normals for _, normals, _ in meshed]),
        np.concatenate([t + s for (_, _, t), s in zip(meshed, starts)]).astype(np.uint32),
        np.array([len(t) for _, _, t in meshed], np.uint32),
        _floats([lines for _, lines in drawn]).reshape(-1, 2, 3),
        np.array([len(lines) for _, lines in drawn], np.uint32),
        np.array(corners, np.float32).reshape(-1, 3),
        np.array([int(BRepAdaptor_Surface(f).GetType()) for f in faces], np.uint32),
        np.array([int(BRepAdaptor_Curve(e).GetType()) for e, _ in drawn], np.uint32),
    )


def _floats(arrays: list[np.ndarray]) -> Floats:
    """As the graphics card takes them; one zero only, so that equal shapes give equal bytes."""
    return (np.concatenate(arrays) if arrays else np.zeros((0, 3))).astype(np.float32) + np.float32(0.0)


def _face(face: TopoDS_Face) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, normals and triangles of one face."""
    points, corners = face_triangles(face)
    where = TopLoc_Location()
    mesh = BRep_Tool.Triangulation_s(face, where)
    BRepLib_ToolTriangulatedShape.ComputeNormals_s(face, mesh)
    t = where.Transformation()
    outwards = -1.0 if face.Orientation() == TopAbs_REVERSED else 1.0
    normals = outwards * np.array([mesh.Normal(i).Transformed(t).Coord() for i in range(1, len(points) + 1)])
    return points, normals, corners


def _edge(shape: TopoDS_Shape, faces: list[TopoDS_Face]) -> np.ndarray:
    """The straight pieces (s, 2, 3) of an edge as the mesh of a face has them; none of a seam or a pole."""
    edge: TopoDS_Edge = as_edge(shape)
    if BRep_Tool.Degenerated_s(edge):
        return np.zeros((0, 2, 3))
    for face in faces:
        where = TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(face, where)
        polygon = BRep_Tool.PolygonOnTriangulation_s(edge, mesh, where)
        if polygon is not None:
            if BRep_Tool.IsClosed_s(edge, face):
                break
            t = where.Transformation()
            nodes = [polygon.Node(i) for i in range(1, polygon.NbNodes() + 1)]
            points = np.array([mesh.Node(n).Transformed(t).Coord() for n in nodes])
            return np.stack([points[:-1], points[1:]], axis=1)
    return np.zeros((0, 2, 3))
