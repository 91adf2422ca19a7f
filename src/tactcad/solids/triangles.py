"""Triangle meshes of shapes."""

from __future__ import annotations

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape

from .explore import subshapes
from .occt import as_face


def triangles(shape: TopoDS_Shape, linear: float, angular: float) -> tuple[np.ndarray, np.ndarray]:
    """A triangle mesh of a shape, facing outwards.

    Parameters
    ----------
    shape
        Any shape of the kernel.
    linear
        Largest chord error, mm.
    angular
        Largest turn between facets, radians, which usually governs.

    Returns
    -------
    points : ndarray, shape (n, 3)
        Vertices, mm; those that faces share are merged: they are the kernel's own edge points.
    faces : ndarray, shape (m, 3)
        Indices of each triangle's vertices.

    Raises
    ------
    ValueError
        Where the kernel cannot mesh a face.
    """
    meshed = [face_triangles(face) for face in tessellated(shape, linear, angular)]
    starts = np.cumsum([0, *(len(points) for points, _ in meshed)])
    faces = [corners + start for (_, corners), start in zip(meshed, starts)]
    return _merged(np.concatenate([points for points, _ in meshed]), np.concatenate(faces))


def tessellated(shape: TopoDS_Shape, linear: float, angular: float) -> list[TopoDS_Face]:
    """The faces of a shape, meshed anew within these errors, as of `triangles`."""
    BRepTools.Clean_s(shape)
    BRepMesh_IncrementalMesh(shape, linear, False, angular, False)
    return [as_face(face) for face in subshapes(shape, TopAbs_FACE)]


def face_triangles(face: TopoDS_Face) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) in mm of a meshed face, and corners (m, 3) of its triangles, facing outwards.

    Raises ValueError where the kernel could not mesh it.
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
