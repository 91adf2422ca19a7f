"""A closed triangle mesh as a shape of the kernel, faces flat."""

from __future__ import annotations

import manifold3d
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeVertex,
    BRepBuilderAPI_MakeWire,
)
from OCP.gp import gp_Pnt
from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain
from OCP.TopoDS import TopoDS_Compound, TopoDS_Edge, TopoDS_Shape, TopoDS_Shell, TopoDS_Solid

from .occt import as_edge


def polyhedra(mesh: manifold3d.Manifold) -> TopoDS_Shape:
    """A solid of each piece of a mesh that hangs together; triangles in one plane are one face.

    Raises
    ------
    ValueError
        Where a triangle has no area.
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
        """The one edge of two corners, as it is gone along."""
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
