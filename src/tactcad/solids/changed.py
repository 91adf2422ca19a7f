"""Which material two solids share, and which only one of them has, by the kernel's booleans."""

from __future__ import annotations

from dataclasses import dataclass
from math import isclose

from OCP.BRepAlgoAPI import BRepAlgoAPI_BooleanOperation, BRepAlgoAPI_Common, BRepAlgoAPI_Cut
from OCP.TopAbs import TopAbs_SOLID
from OCP.TopoDS import TopoDS_Shape

from .explore import subshapes
from .measure import volume

AGREES = 1e-6  # share of a volume by which the pieces may miss the whole, as volumes elsewhere
SLIVER = 1e-6  # mm3: less is the rounding of touching faces, as in checks/interference


@dataclass(frozen=True)
class ChangedMaterial:
    """Pieces of material, None where there is none; `whole` where the booleans failed and `removed` and
    `added` are the old and the new solid as they are."""

    kept: TopoDS_Shape | None
    removed: TopoDS_Shape | None
    added: TopoDS_Shape | None
    whole: bool = False


def changed(old: TopoDS_Shape, new: TopoDS_Shape) -> ChangedMaterial:
    """What became of the old solid's material, both in one frame; volumes are held against the whole ones."""
    operations = BRepAlgoAPI_Common(old, new), BRepAlgoAPI_Cut(old, new), BRepAlgoAPI_Cut(new, old)
    kept, removed, added = (_pieces(done) for done in operations)
    v_kept, v_removed, v_added = (volume(s) if s is not None else 0.0 for s in (kept, removed, added))
    sound = all(done.IsDone() for done in operations)
    for side, other in ((old, v_removed), (new, v_added)):
        sound = sound and isclose(v_kept + other, volume(side), rel_tol=AGREES, abs_tol=SLIVER)
    return ChangedMaterial(kept, removed, added) if sound else ChangedMaterial(None, old, new, whole=True)


def _pieces(done: BRepAlgoAPI_BooleanOperation) -> TopoDS_Shape | None:
    shape = done.Shape()
    held = bool(subshapes(shape, TopAbs_SOLID)) and volume(shape) > SLIVER
    return shape if held else None
