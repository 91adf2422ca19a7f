"""What is seen of placed parts in a view: all visible edges, and which of them belong to which placement."""

from __future__ import annotations

from collections.abc import Sequence

from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.HLRAlgo import HLRAlgo_Projector
from OCP.HLRBRep import HLRBRep_Algo, HLRBRep_HLRToShape
from OCP.TopoDS import TopoDS_Shape

from .picture import Viewpoint, polylines
from .windows import Polyline


def seen_of_each(shapes: Sequence[TopoDS_Shape], view: Viewpoint) -> list[list[Polyline]]:
    """Visible sharp edges of each shape in the picture plane (mm), by exact hidden-line removal.

    The lines are those of picture.drawing, in the same order in every process. The kernel hides shapes
    that are to be told apart pair by pair: 112 shapes take 3.7 s, as one compound 1.0 s.
    """
    algorithm = HLRBRep_Algo()
    for shape in shapes:
        algorithm.Add(shape)
    algorithm.Projector(HLRAlgo_Projector(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(*view.eye), gp_Dir(*view.right))))
    algorithm.Update()
    algorithm.Hide()
    result = HLRBRep_HLRToShape(algorithm)
    return [
        sorted(set(polylines(result.VCompound(s)) + polylines(result.OutLineVCompound(s)))) for s in shapes
    ]
