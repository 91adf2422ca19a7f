"""Triangle meshes of shapes, of a viewer's kind too (face by face with normals and edges), and a closed mesh
as a shape."""

from __future__ import annotations

from dataclasses import dataclass

import manifold3d
import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeVertex,
    BRepBuilderAPI_MakeWire,
)
from OCP.BRepLib import BRepLib_ToolTriangulatedShape
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.gp import gp_Pnt
from OCP.IMeshTools import IMeshTools_MeshAlgoType, IMeshTools_Parameters
from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_REVERSED, TopAbs_VERTEX
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Compound, TopoDS_Edge, TopoDS_Face, TopoDS_Shape, TopoDS_Shell, TopoDS_Solid

from .occt import as_edge, as_face, as_vertex, subshapes

# From so many faces on by the kernel's other method, which joins the same points on the edges: its usual one
# takes time with the square of a face's edges, 10 s for a foil of 36 cells instead of 0.8 s.
MANY_FACES = 200


def triangles(
    shape: TopoDS_Shape, linear: float, angular: float, many: int = MANY_FACES
) -> tuple[np.ndarray, np.ndarray]:
    """A triangle mesh of a shape, facing outwards.

    Parameters
    ----------
    shape
        Any shape of the kernel.
    linear
        Largest chord error, mm.
    angular
        Largest turn between facets, radians, which usually governs.
    many
        From so many faces on by the kernel's other method.

    Returns
    -------
    points : ndarray, shape (n, 3)
        Vertices, mm; those that faces share are merged: they are the kernel's own edge points.
    faces : ndarray, shape (m, 3)
        Indices of each triangle's vertices.

    Raises
    ------
    ValueError
        If the kernel cannot mesh a face.
    """
    meshed = [face_triangles(face) for face in tessellated(shape, linear, angular, many)]
    starts = np.cumsum([0, *(len(points) for points, _ in meshed)])
    faces = [corners + start for (_, corners), start in zip(meshed, starts)]
    return _merged(np.concatenate([points for points, _ in meshed]), np.concatenate(faces))


def tessellated(
    shape: TopoDS_Shape, linear: float, angular: float, many: int = MANY_FACES
) -> list[TopoDS_Face]:
    """The faces of a shape, meshed anew within these errors, as of `triangles`."""
    BRepTools.Clean_s(shape)
    faces = [as_face(face) for face in subshapes(shape, TopAbs_FACE)]
    if len(faces) < many:
        BRepMesh_IncrementalMesh(shape, linear, False, angular, False)
    else:
        asked = IMeshTools_Parameters()
        asked.Deflection, asked.Angle = linear, angular
        asked.MeshAlgo = IMeshTools_MeshAlgoType.IMeshTools_MeshAlgoType_Delabella
        BRepMesh_IncrementalMesh(shape, asked)
    return faces


def face_triangles(face: TopoDS_Face) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) in mm of a meshed face, and corners (m, 3) of its triangles, facing outwards.

    Raises ValueError if the kernel could not mesh it.
    """
    where = TopLoc_Location()
    mesh = BRep_Tool.Triangulation_s(face, where)
    if mesh is None:
        raise ValueError("the kernel could not mesh a face")
    t = where.Transformation()
    points = np.array([mesh.Node(i).Transformed(t).Coord() for i in range(1, mesh.NbNodes() + 1)])
    corners = np.array([mesh.Triangle(i).Get() for i in range(1, mesh.NbTriangles() + 1)], np.int64) - 1
    return points, corners[:, [0, 2, 1]] if face.Orientation() == TopAbs_REVERSED else corners


def _merged(points: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Join vertices that are the same to 1e-7 mm, the kernel's own tolerance; drop triangles that
    collapse."""
    keys = np.round(points / 1e-7).astype(np.int64)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    faces = inverse.reshape(-1)[faces]
    distinct = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    return points[first], faces[distinct]


def polyhedra(mesh: manifold3d.Manifold) -> TopoDS_Shape:
    """A solid of each piece of a mesh that hangs together; triangles in one plane are one face.

    Raises
    ------
    ValueError
        If a triangle has no area.
    """
    build, compound = BRep_Builder(), TopoDS_Compound()
    build.MakeCompound(compound)
    for piece in mesh.decompose():
        joined = ShapeUpgrade_UnifySameDomain(_polyhedron(piece), True, True, False)
        joined.Build()
        build.Add(compound, joined.Shape())
    return compound


def _polyhedron(mesh: manifold3d.Manifold) -> TopoDS_Solid:
    arrays = mesh.to_mesh64()
    points = arrays.vert_properties[:, :3].tolist()
    corners = [BRepBuilderAPI_MakeVertex(gp_Pnt(*point)).Vertex() for point in points]
    edges: dict[tuple[int, int], TopoDS_Edge] = {}

    def edge(start: int, end: int) -> TopoDS_Edge:
        """The edge between two corners, in the direction of travel."""
        low, high = min(start, end), max(start, end)
        if (low, high) not in edges:
            edges[low, high] = BRepBuilderAPI_MakeEdge(corners[low], corners[high]).Edge()
        one = edges[low, high]
        return one if start == low else as_edge(one.Reversed())

    build, shell, solid = BRep_Builder(), TopoDS_Shell(), TopoDS_Solid()
    build.MakeShell(shell)
    for a, b, c in arrays.tri_verts.tolist():
        around = BRepBuilderAPI_MakeWire(edge(a, b), edge(b, c), edge(c, a))
        face = BRepBuilderAPI_MakeFace(around.Wire(), True)
        if not face.IsDone():
            raise ValueError("a triangle without area")
        build.Add(shell, face.Face())
    shell.Closed(True)
    build.MakeSolid(solid)
    build.Add(solid, shell)
    return solid


Floats = NDArray[np.float32]
Indices = NDArray[np.uint32]


@dataclass(frozen=True)
class Facets:
    """A shape's facets and edges for drawing.

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
        If the kernel cannot mesh a face.
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
    """Floats for the graphics card; one zero only, so that equal shapes give equal bytes."""
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
    """The straight pieces (s, 2, 3) of an edge in the mesh of a face; none for a seam or a pole."""
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
