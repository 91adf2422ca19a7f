"""Names of the kernel's binding that differ between OCP 7.9 and OCP 8; all code imports them from here."""

from __future__ import annotations

from OCP.TopoDS import TopoDS

try:
    from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as TopTools_IndexedMapOfShape
    from OCP.collections import Sequence_TDF_Label as TDF_LabelSequence
except ImportError:  # OCP 7.9
    from OCP.TDF import TDF_LabelSequence
    from OCP.TopTools import TopTools_IndexedMapOfShape

__all__ = ["TDF_LabelSequence", "TopTools_IndexedMapOfShape", "as_edge", "as_face", "as_vertex", "as_wire"]

# OCP 7.9 marks static functions by _s where OCP 8 does not.
as_edge, as_face, as_vertex, as_wire = (
    getattr(TopoDS, f"{kind}_s", None) or getattr(TopoDS, kind) for kind in ("Edge", "Face", "Vertex", "Wire")
)
