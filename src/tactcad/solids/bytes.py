"""Shapes as bytes and back, for caches: the kernel's own text format (BREP).

The text drops the sign of zero, so a shape that went through it may give other bytes in a STEP file than the
one just built: for equal files both must be taken from the text.
"""

from __future__ import annotations

from io import BytesIO

from OCP.BRep import BRep_Builder
from OCP.BRepTools import BRepTools
from OCP.TopoDS import TopoDS_Shape


def to_bytes(shape: TopoDS_Shape) -> bytes:
    """The shape without triangulation."""
    stream = BytesIO()
    BRepTools.Clean_s(shape)
    BRepTools.Write_s(shape, stream)
    return stream.getvalue()


def from_bytes(data: bytes) -> TopoDS_Shape:
    """The shape that `to_bytes` wrote. Raises ValueError where the bytes hold none."""
    shape = TopoDS_Shape()
    BRepTools.Read_s(shape, BytesIO(data), BRep_Builder())
    if shape.IsNull():
        raise ValueError("not a shape")
    return shape
