"""Material common to two solids, and of only one of them: by the kernel's booleans, or by those of meshes if
they fail."""

from __future__ import annotations

from dataclasses import dataclass
from math import isclose
from typing import Literal

import manifold3d
import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_BooleanOperation, BRepAlgoAPI_Common, BRepAlgoAPI_Cut
from OCP.Standard import Standard_Failure
from OCP.TopAbs import TopAbs_SOLID
from OCP.TopoDS import TopoDS_Shape

from .measure import measure, volume
from .occt import subshapes
from .triangles import polyhedra, triangles

AGREES = 1e-6  # share of a volume by which the pieces may miss the whole, as volumes elsewhere
SLIVER = 1e-6  # mm3: less is the rounding of touching faces, as in checks/interference
# Of the meshes: chord error, mm, and turn between facets. Chosen: a fifth of the least change that a review
# is to show, 5 um of hinge.
CHORD, TURN = 1e-3, 0.3


@dataclass(frozen=True)
class ChangedMaterial:
    """Pieces of material, None if there is none, and the method: the kernel; meshes, whose curved faces miss
    by up to CHORD; or nothing: `removed` and `added` are the old and the new solid."""

    kept: TopoDS_Shape | None
    removed: TopoDS_Shape | None
    added: TopoDS_Shape | None
    by: Literal["kernel", "meshes", "nothing"]


def changed(old: TopoDS_Shape, new: TopoDS_Shape) -> ChangedMaterial:
    """Changes of the old solid's material, both in one frame; the volumes must add up."""
    for method in (_by_kernel, _by_meshes):
        try:
            return method(old, new)
        except (ValueError, Standard_Failure):
            continue
    return ChangedMaterial(None, old, new, "nothing")


def _by_kernel(old: TopoDS_Shape, new: TopoDS_Shape) -> ChangedMaterial:
    """Raises ValueError, or the kernel's own error, if a boolean fails."""
    operations = BRepAlgoAPI_Common(old, new), BRepAlgoAPI_Cut(old, new), BRepAlgoAPI_Cut(new, old)
    kept, removed, added = (_pieces(done) for done in operations)
    v_kept, v_removed, v_added = (volume(s) if s is not None else 0.0 for s in (kept, removed, added))
    sound = all(done.IsDone() for done in operations)
    for side, other in ((old, v_removed), (new, v_added)):
        sound = sound and isclose(v_kept + other, volume(side), rel_tol=AGREES, abs_tol=SLIVER)
    if not sound:
        raise ValueError("the pieces are not the whole")
    return ChangedMaterial(kept, removed, added, "kernel")


def _pieces(done: BRepAlgoAPI_BooleanOperation) -> TopoDS_Shape | None:
    shape = done.Shape()
    held = bool(subshapes(shape, TopAbs_SOLID)) and volume(shape) > SLIVER
    return shape if held else None


def _by_meshes(old: TopoDS_Shape, new: TopoDS_Shape) -> ChangedMaterial:
    """Raises ValueError if a mesh is not closed, or the pieces miss the whole by more than its chords."""
    a, b = (closed(triangles(shape, CHORD, TURN)) for shape in (old, new))
    kept, removed, added = (_without_films(m) for m in (a ^ b, a - b, b - a))
    for side, other in ((old, removed), (new, added)):
        exact = measure(side)
        if abs(kept.volume() + other.volume() - exact["volume"]) > CHORD * exact["area"]:
            raise ValueError("the pieces are not the whole")
    stayed, went, came = (None if m.is_empty() else polyhedra(m) for m in (kept, removed, added))
    return ChangedMaterial(stayed, went, came, "meshes")


def _without_films(mesh: manifold3d.Manifold) -> manifold3d.Manifold:
    """Without pieces thinner than the chords' error: one curved face, meshed twice."""
    thick = [m for m in mesh.decompose() if 2.0 * m.volume() > CHORD * m.surface_area()]
    return manifold3d.Manifold.compose(thick)


def closed(mesh: tuple[np.ndarray, np.ndarray]) -> manifold3d.Manifold:
    """A mesh (vertices, mm; triangles) as a closed surface. Raises ValueError if it is not closed."""
    made = manifold3d.Manifold(
        manifold3d.Mesh64(np.ascontiguousarray(mesh[0]), np.ascontiguousarray(mesh[1], dtype=np.uint64))
    )
    if made.status() != manifold3d.Error.NoError:
        raise ValueError(f"not a closed mesh: {made.status()}")
    return made
