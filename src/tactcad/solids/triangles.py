"""Triangle meshes of shapes."""

from __future__ import annotations

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape

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
    BRepTools.Clean_s(shape)
    BRepMesh_IncrementalMesh(shape, linear, False, angular, False)
    points, faces, offset = [], [], 0
    for face in subshapes(shape, TopAbs_FACE):
        where = TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(as_face(face), where)
        if mesh is None:
            raise ValueError("the kernel could not mesh a face")
        t = where.Transformation()
        points += [mesh.Node(i).Transformed(t).Coord() for i in range(1, mesh.NbNodes() + 1)]
        turned = face.Orientation() == TopAbs_REVERSED
        for i in range(1, mesh.NbTriangles() + 1):
            a, b, c = mesh.Triangle(i).Get()
            faces.append((a, c, b) if turned else (a, b, c))
            faces[-1] = tuple(v - 1 + offset for v in faces[-1])
        offset += mesh.NbNodes()
    return _merged(np.array(points), np.array(faces, dtype=np.int64))


def _merged(points: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Join vertices that are the same to 1e-7 mm, the kernel's own tolerance; drop triangles that
    collapse."""
    keys = np.round(points / 1e-7).astype(np.int64)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    faces = inverse.reshape(-1)[faces]
    distinct = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    return points[first], faces[distinct]
