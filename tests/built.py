"""The kernel's shapes, every part built once a session. Tests only read them."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

    from tactcad.parts.language.description import Part
    from tactcad.scenes.scene import Scene


@cache
def shape_of(part: Part) -> TopoDS_Shape:
    """In the part's own frame."""
    from tactcad.solids.build import build

    return build(part)


def shapes_of(scene: Scene) -> dict[str, TopoDS_Shape]:
    """By part number."""
    return {part.part_no: shape_of(part) for part in scene.parts}
