"""A scene before and after a change, in pieces: material that stayed, came, and went."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from tactcad.design.messages import CheckFailure
from tactcad.design.tree import CommonTables
from tactcad.export.shapes import Shapes
from tactcad.parts.language.description import Part, Vector, vector
from tactcad.scenes import chosen_scenes, make_scene
from tactcad.scenes.scene import Placement, Rotation, Scene, rotation

from .effect import same_elements

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

PieceKind = Literal["same", "kept", "added", "removed"]
# sRGB and transparency, %: green came and red went, as in text differences; first what matters most
LOOKS: dict[PieceKind, tuple[str, int]] = {
    "added": ("#2ca02c", 0),
    "removed": ("#d62728", 0),
    "kept": ("#b0b4ba", 60),
    "same": ("#c8ccd0", 85),
}
# Remarks on pieces that the kernel could not separate, by the method used.
REMARKS = {
    "kernel": "",
    "meshes": "by meshes, for the kernel's boolean failed: curved faces are within 0.001 mm",
    "nothing": "whole part: neither kernel nor meshes could tell kept from changed material",
}
CLOSE = 1e-9  # mm, and of directions: places that agree so far are one


@dataclass(frozen=True)
class ScenePiece:
    """Material of one placed part: all of it if it is the `same`, else the kept, added or removed material.

    `shape` is in the frame that `origin` (mm) and `rotation` place. `remark`, of REMARKS, marks places where
    the kernel could not separate kept from changed material.
    """

    designator: str
    part_no: str
    kind: PieceKind
    shape: TopoDS_Shape
    origin: Vector
    rotation: Rotation
    remark: str = ""

    def row(self, label: str, part_no: str) -> dict[str, Any]:
        """Its place, as records of scenes have it: it takes no part in steps."""
        return {
            "designator": label,
            "part_no": part_no,
            "origin": self.origin,
            "rotation": self.rotation,
            "way": (0.0, 0.0, 0.0),
            "step": 0,
            "under": (self.kind,),
        }


def changed_scenes(
    designs: tuple[CommonTables, CommonTables],
    shapes: tuple[Shapes, Shapes],
    say: Callable[[int, int, str], None],
) -> dict[str, list[ScenePiece]]:
    """Every scene that both designs have, in pieces; loads the kernel.

    Parameters
    ----------
    designs, shapes
        As in `changed_scene`; both designs must keep their rules.
    say
        Receives (done, total, text) as the work goes on.

    Raises
    ------
    CheckFailure
        If the designs have no scene in common.
    """
    before, after = (chosen_scenes(design, None) for design in designs)
    names = [name for name in after if name in before]
    if not names:
        raise CheckFailure("the designs have no scene in common: nothing was written")
    scenes: dict[str, list[ScenePiece]] = {}
    for n, name in enumerate(names):
        say(n, len(names), f"{name}: material that changed")
        a, b = (make_scene(design, name) for design in designs)
        scenes[name] = changed_scene(designs, (a, b), shapes)
    return scenes


def changed_scene(
    designs: tuple[CommonTables, CommonTables], scenes: tuple[Scene, Scene], shapes: tuple[Shapes, Shapes]
) -> list[ScenePiece]:
    """Every piece of the scene, before and after; loads the kernel.

    Parameters
    ----------
    designs, scenes, shapes
        Each of before and after. The shapes' makers must be two: equal numbers may mean other parts.
    """
    from tactcad.solids.changed import ChangedMaterial, changed
    from tactcad.solids.occt import placed_shape

    known: dict[tuple[object, ...], ChangedMaterial] = {}

    def pieces(a: Placement | None, b: Placement | None) -> Iterator[ScenePiece]:
        if a and b and _solid(a.part) == _solid(b.part) and _same_place(a, b):
            yield _piece(b, "same", shapes[1].of(b.part))
        elif a and b:
            origin, turn = _relative(a, b)
            key = (_solid(a.part), _solid(b.part), origin, turn)
            if key not in known:
                moved = placed_shape(shapes[0].of(a.part), origin, turn)
                known[key] = changed(moved, shapes[1].of(b.part))
            m = known[key]
            kinds: tuple[tuple[PieceKind, TopoDS_Shape | None], ...] = (
                ("kept", m.kept),
                ("removed", m.removed),
                ("added", m.added),
            )
            yield from (_piece(b, kind, shape, REMARKS[m.by]) for kind, shape in kinds if shape is not None)
        elif a:
            yield _piece(a, "removed", shapes[0].of(a.part))
        elif b:
            yield _piece(b, "added", shapes[1].of(b.part))

    return [piece for a, b in _pairs(designs, scenes) for piece in pieces(a, b)]


def _piece(p: Placement, kind: PieceKind, shape: TopoDS_Shape, remark: str = "") -> ScenePiece:
    return ScenePiece(p.designator, p.part.part_no, kind, shape, p.origin, p.rotation, remark)


def _solid(part: Part) -> tuple[object, ...]:
    """The data that determine its shape."""
    return (part.body, part.features)


def _pairs(
    designs: tuple[CommonTables, CommonTables], scenes: tuple[Scene, Scene]
) -> list[tuple[Placement | None, Placement | None]]:
    """Pairs of old and new placements: elements by their order in their row, then unchanged parts under any
    designator, the rest by designator."""
    before, after = ({p.designator: p for p in scene.placements} for scene in scenes)
    pairs: list[tuple[Placement | None, Placement | None]] = []

    def take(a: str | None, b: str | None) -> None:
        pairs.append((before.pop(a) if a else None, after.pop(b) if b else None))

    for a, b in same_elements(*designs):
        if (a is None or a in before) and (b is None or b in after):
            take(a, b)
    for a in list(before):
        same = [b for b in after if _solid(before[a].part) == _solid(after[b].part)]
        if found := next((b for b in same if _same_place(before[a], after[b])), None):
            take(a, found)
    for name in list(before):
        take(name, name if name in after else None)
    for name in list(after):
        take(None, name)
    return pairs


def _same_place(a: Placement, b: Placement) -> bool:
    return bool(
        np.allclose(a.origin, b.origin, rtol=0.0, atol=CLOSE)
        and np.allclose(a.rotation, b.rotation, rtol=0.0, atol=CLOSE)
    )


def _relative(a: Placement, b: Placement) -> tuple[Vector, Rotation]:
    """Place of a in b's frame; to a millionth of a millimetre, so that equal places are equal."""
    turn = np.asarray(b.rotation, float).T
    at = turn @ (np.asarray(a.origin, float) - np.asarray(b.origin, float))
    turned = turn @ np.asarray(a.rotation, float)
    return _rounded(at), rotation([_rounded(row) for row in turned])


def _rounded(values: Sequence[float] | np.ndarray) -> Vector:
    return vector(round(float(v), 6) + 0.0 for v in values)
