"""The sensing face as the object sees it: which element stands where, which end plate is which, the axes.

Seen from below: x runs to the right, y down. Drawn from descriptions, without a kernel.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from tactcad.parts.description import Vector
from tactcad.scenes.scene import Placement, Scene

from .boxes import Box, bounds, corners
from .extent import placed, projected_box
from .ink import THIN, DrawnSheet, Fill, Item, Point, Stroke, Text, arrow, bounds_of_items, moved, segment

EYE: Vector = (0.0, 0.0, -1.0)
UP: Vector = (0.0, -1.0, 0.0)
RIGHT: Vector = (1.0, 0.0, 0.0)
LARGEST = (130.0, 110.0)  # of the map's outlines, mm of paper
LINE = 3.6  # least distance of labels below each other, mm of paper
HEIGHT = 2.5
_STACKED = re.compile(r"(E|BL)\d+")


def array_of(scene: Scene) -> Scene | None:
    """The array that stands in a scene, in its own axes; None where none does."""
    return next((s for s in (scene, *scene.ready) if s.name == "array"), None)


def stacked(scene: Scene) -> list[Placement]:
    """Elements and blanks, from -y to +y: from the top of the view down."""
    own = [p for p in scene.placements if _STACKED.fullmatch(p.designator)]
    return sorted(own, key=lambda p: round(middle(p)[1], 6), reverse=True)


def seen_box(p: Placement) -> Box:
    return projected_box([p], RIGHT, EYE)


def middle(p: Placement) -> Point:
    """Of the part's box in the view, mm."""
    x0, y0, x1, y1 = seen_box(p)
    return (x0 + x1) / 2, (y0 + y1) / 2


def pad(p: Placement) -> Box | None:
    """The element's contact pad in the view, mm; None of a blank."""
    faces = [s for s in p.part.extrusion.outer if s.name == "pad_face"]
    ends = [
        placed(p, (*end, z))
        for s in faces
        for end in (s.start, s.end)
        for z in (0.0, p.part.extrusion.thickness)
    ]
    return bounds((x, -y) for x, y, _ in ends) if ends else None


def numbers(scene: Scene, f: float, half: float, arms: bool = False) -> list[Text]:
    """Designators beside the two rows, `half` mm of paper from the middle line, at the scale f.

    Where they would stand closer than LINE some are left out, never the first and the last of a row.
    """
    texts = []
    for sign in (1.0, -1.0):
        row = [p for p in stacked(scene) if p.rotation[0][0] * sign > 0]
        for p in _spaced(row, f):
            y = middle(p)[1] * f - HEIGHT / 2
            name = f"{p.designator}{_arm(p)}" if arms else p.designator
            texts.append(Text((sign * (half + 1.5), y), name, HEIGHT, "start" if sign > 0 else "end"))
    return texts


def _arm(p: Placement) -> str:
    return f", {p.part.name.rpartition(', ')[2]}" if pad(p) else " (blank)"


def _spaced(row: Sequence[Placement], f: float) -> list[Placement]:
    kept: list[Placement] = list(row[:1])
    for p in row[1:]:
        if abs(middle(p)[1] - middle(kept[-1])[1]) * f >= LINE:
            kept.append(p)
    if row and kept[-1] is not row[-1]:
        kept[max(1, len(kept) - 1) :] = [row[-1]]
    return kept


def axes(at: Point, length: float = 8.0) -> list[Item]:
    """x to the right and y down from a corner, named."""
    x, y = at
    right, down = (x + length, y), (x, y - length)
    return [
        segment(at, right, THIN, "symbol"),
        segment(at, down, THIN, "symbol"),
        arrow(right, at, role="symbol"),
        arrow(down, at, role="symbol"),
        Text((x + length + 1.0, y - HEIGHT / 2), "+x", HEIGHT),
        Text((x, y - length - HEIGHT - 1.0), "+y", HEIGHT, "middle"),
    ]


def face_map(array: Scene, name: str) -> DrawnSheet:
    """The map of an array: outlines of elements, blanks and end plates, pads filled, numbers and arms beside
    them."""
    plates = [p for p in array.placements if p.designator in ("EP1", "EP2")]
    x0, y0, x1, y1 = projected_box([*plates, *stacked(array)], RIGHT, EYE)
    f = min(LARGEST[0] / (x1 - x0), LARGEST[1] / (y1 - y0))

    def outline(box: Box) -> tuple[Point, ...]:
        return tuple((x * f, y * f) for x, y in corners(box))

    items: list[Item] = [Stroke(outline(seen_box(p)), THIN, closed=True) for p in [*plates, *stacked(array)]]
    items += [Fill(outline(box), "symbol") for p in stacked(array) if (box := pad(p))]
    items += numbers(array, f, x1 * f, arms=True)
    for plate in plates:
        y, far = middle(plate)[1], seen_box(plate)
        edge = far[3] * f + 1.5 if y > 0 else far[1] * f - 1.5 - HEIGHT
        items.append(Text((0.0, edge), f"{plate.designator}: {plate.part.name.lower()}", HEIGHT, "middle"))
    items += [
        Text((x1 * f, y1 * f + 1.5), "row 1", HEIGHT, "end"),
        Text((x0 * f, y1 * f + 1.5), "row 2", HEIGHT),
    ]
    items += axes((x0 * f, y0 * f - 3.0))
    bx0, by0, bx1, by1 = bounds_of_items(items)
    title = "Sensing face, pads towards you"
    return DrawnSheet(
        name,
        title,
        (round(bx1 - bx0 + 4.0, 3), round(by1 - by0 + 4.0, 3)),
        tuple(moved(i, 2.0 - bx0, 2.0 - by0) for i in items),
    )
