"""The kernel's shapes of parts, and pictures of them. The kernel is loaded on the first shape."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from .cache import Cache
from .inputs import digest

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

    from tactcad.drawing.engine.picture import Viewpoint
    from tactcad.parts.language.description import Part
    from tactcad.scenes.scene import Placement


class Shapes:
    """The kernel's shapes of parts, each built at most once: from memory, from the cache, or anew."""

    def __init__(self, cache: Cache, made_by: str) -> None:
        self.cache, self.made_by = cache, made_by
        self.built: list[str] = []
        self._known: dict[str, TopoDS_Shape] = {}

    def of(self, part: Part) -> TopoDS_Shape:
        """The part's shape in its own frame."""
        if part.part_no not in self._known:
            from tactcad.solids.step import from_bytes

            # always through the text, so that a shape from the cache and one just built give equal files
            self._known[part.part_no] = from_bytes(self.text_of(part))
        return self._known[part.part_no]

    def drawn(self, part: Part) -> TopoDS_Shape:
        """The part's shape for pictures of several parts."""
        from tactcad.parts.bought.screws import for_pictures

        return self.of(for_pictures(part))

    def text_of(self, part: Part) -> bytes:
        """The part's shape as the kernel's own text (BREP)."""

        def make() -> bytes:
            from tactcad.solids.build import build
            from tactcad.solids.step import to_bytes

            self.built.append(part.part_no)
            return to_bytes(build(part))

        return self.cache.get_or_make(f"shape {self.made_by} {digest(part)}", make)


def picture_bytes(
    placements: Sequence[Placement],
    view: str,
    shapes: Shapes,
    title: str,
    description: str,
    marked: Sequence[Placement] = (),
) -> bytes:
    """The placements in hidden lines, seen from `view`, as SVG; read back. `marked` are drawn in bold."""
    from tactcad.drawing.engine import picture
    from tactcad.parts.bought.screws import for_pictures
    from tactcad.solids.occt import placed_shape

    eye: Viewpoint = picture.VIEWS[view]

    def drawn(some: Sequence[Placement]) -> picture.Drawing:
        return picture.drawing(
            [
                placed_shape(
                    shapes.drawn(p.part) if len(some) > 1 else shapes.of(p.part), p.origin, p.rotation
                )
                for p in some
            ],
            eye,
        )

    data = picture.svg(drawn(placements), title, description, drawn(marked) if marked else None)
    # a screw that is drawn thinner may be what the picture's edge is at
    shown = [replace(p, part=for_pictures(p.part)) for p in placements] if len(placements) > 1 else placements
    picture.check_picture(data, shown, eye)
    return data
