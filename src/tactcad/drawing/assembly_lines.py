"""What is seen of placed parts in a view: all visible edges, and which of them belong to which placement."""

from __future__ import annotations

from collections.abc import Sequence

from OCP.TopoDS import TopoDS_Shape

from .boxes import Polyline
from .picture import Viewpoint, exact, polylines, projector


def seen_of_each(shapes: Sequence[TopoDS_Shape], view: Viewpoint) -> list[list[Polyline]]:
    """Visible sharp edges of each shape in the picture plane (mm), by exact hidden-line removal.

    The lines are those of picture.drawing, in the same order in every process.
    """
    result = exact(shapes, projector(view.eye, view.right))
    return [
        sorted(set(polylines(result.VCompound(s)) + polylines(result.OutLineVCompound(s)))) for s in shapes
    ]
