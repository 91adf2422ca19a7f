"""Sub-shapes of a shape."""

from __future__ import annotations

from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS_Shape

from .occt import TopTools_IndexedMapOfShape


def subshapes(shape: TopoDS_Shape, kind: TopAbs_ShapeEnum) -> list[TopoDS_Shape]:
    """Every distinct sub-shape of that kind, in the kernel's order."""
    distinct = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, kind, distinct)
    return [distinct.FindKey(i) for i in range(1, distinct.Extent() + 1)]
