"""The sensing face as the object sees it: which element stands where, which end plate is which, the axes.

Seen from below: x runs to the right, y down. Drawn from descriptions, without a kernel.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from tactcad.parts.description import Vector
from tactcad.scenes.scene import Placement, Scene

from .boxes import Box, bounds, bounds_of, corners
from .extent import placed
from .information import Given, for_information
from .ink import THIN, DrawnSheet, Fill, Item, Point, Stroke, Text, arrow, bounds_of_items, moved, segment
from .joints import box_of

EYE: Vector = (0.0, 0.0, -1.0)
UP: Vector = (0.0, -1.0, 0.0)
LARGEST = (130.0, 110.0)  # of the map's outlines, mm of paper
HEIGHTS = (2.5, 1.8)  # of numbers, ISO 3098: the larger where all find room
HEIGHT = HEIGHTS[0]
WHITE = 0.8  # between numbers below each other, mm of paper
BESIDE = 1.5  # from what is drawn to a number, mm of paper
_STACKED = re.compile(r"(E|BL)\d+")


def array_of(scene: Scene) -> Scene | None:
    """The array that stands in a scene, in its own axes; None where none does."""
    return next((s for s in (scene, *scene.ready) if s.name == "array"), None)


def stacked(scene: Scene) -> list[Placement]:
    """Elements and blanks, from -y to +y: from the top of the view down."""
    own = [p for p in scene.placements if _STACKED.fullmatch(p.designator)]
    return sorted(own, key=lambda p: round(middle(p), 6), reverse=True)


def seen_box(p: Placement) -> Box:
    """The part's box in the view, mm."""
    (x0, y0, _), (x1, y1, _) = box_of(p).tolist()
    return x0, -y1, x1, -y0


def middle(p: Placement) -> float:
    """Where the middle of its sheet stands in the view, mm upwards."""
    return -(p.origin[1] + p.rotation[1][2] * p.part.extrusion.thickness / 2)


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

    Where they would stand too close some are left out, never the first and the last of a row.
    """
    rows = [[p for p in stacked(scene) if p.rotation[0][0] * sign > 0] for sign in (1.0, -1.0)]
    fitting = [h for h in HEIGHTS if all(_spaced(row, (h + WHITE) / f) == row for row in rows)]
    height = fitting[0] if fitting else HEIGHTS[-1]
    texts = []
    for row, sign in zip(rows, (1.0, -1.0)):
        for p in _spaced(row, (height + WHITE) / f):
            at = (sign * (half + BESIDE), middle(p) * f - height / 2)
            name = f"{p.designator}{_arm(p)}" if arms else p.designator
            texts.append(Text(at, name, height, "start" if sign > 0 else "end"))
    return texts


def _arm(p: Placement) -> str:
    return f", {p.part.name.rpartition(', ')[2]}" if pad(p) else " (blank)"


def _spaced(row: Sequence[Placement], least: float) -> list[Placement]:
    """First, last, and between them those that stand at least so far from the one kept before, mm."""
    kept = list(row[:1])
    for p in row[1:]:
        if abs(middle(p) - middle(kept[-1])) >= least - 1e-9:
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


def dimensioned(array: Scene, view: Box, f: float) -> list[Item]:
    """What is written on the array's view from below, whose lower left corner lies at (0, 0) at the scale f:
    element numbers, axes, pitch and gap between the rows.

    `view` is the view's box, mm.
    """
    x0, y0, x1, y1 = view
    half, high = x1 * f, (y1 - y0) * f
    names = numbers(array, f, half)
    wide = max(t.width for t in names) + 2 * BESIDE
    given = []
    left, right = (
        [box for p in stacked(array) if (box := pad(p)) and p.rotation[0][0] * s > 0] for s in (-1.0, 1.0)
    )
    row = left if len(left) > 1 else right
    if len(row) > 1:
        # beyond the numbers, so that the extension lines pass none
        a, b = ((-wide / f, box[1] - y0) for box in row[:2])
        given.append(Given("left", a[1] - b[1], a, b))
    if left and right:
        (*_, inner, top), (outer, *_) = left[0], right[0]
        given.append(Given("top", outer - inner, (inner - x0, top - y0), (outer - x0, top - y0)))
    box = (-wide, 0.0, (x1 - x0) * f, high)
    corner = ((x1 - x0) * f + wide, high)
    name = Text((corner[0] + HEIGHT, corner[1] - HEIGHT), "Sensing face", HEIGHT)
    texts = [moved(t, -x0 * f, -y0 * f) for t in names]
    return [
        *texts,
        *for_information(given, box, f),
        name,
        *axes((corner[0] + HEIGHT, corner[1] - 3 * HEIGHT)),
    ]


def face_map(array: Scene, name: str) -> DrawnSheet:
    """The map of an array: outlines of elements, blanks and end plates, pads filled, numbers and arms beside
    them."""
    plates = [p for p in array.placements if p.designator in ("EP1", "EP2")]
    x0, y0, x1, y1 = bounds_of(corners(seen_box(p)) for p in [*plates, *stacked(array)])
    f = min(LARGEST[0] / (x1 - x0), LARGEST[1] / (y1 - y0))

    def outline(box: Box) -> tuple[Point, ...]:
        return tuple((x * f, y * f) for x, y in corners(box))

    items: list[Item] = [Stroke(outline(seen_box(p)), THIN, closed=True) for p in [*plates, *stacked(array)]]
    items += [Fill(outline(box), "symbol") for p in stacked(array) if (box := pad(p))]
    items += numbers(array, f, x1 * f, arms=True)
    over, under = y1 * f + BESIDE, y0 * f - BESIDE - HEIGHT
    items += [
        Text((x1 * f + BESIDE, over), "row 1", HEIGHT),
        Text((x0 * f - BESIDE, over), "row 2", HEIGHT, "end"),
    ]
    for plate in plates:
        y = over + 2 * HEIGHT if middle(plate) > 0 else under
        items.append(Text((0.0, y), f"{plate.designator}: {plate.part.name.lower()}", HEIGHT, "middle"))
    items += axes((x0 * f, under - HEIGHT))
    bx0, by0, bx1, by1 = bounds_of_items(items)
    title = "Sensing face, pads towards you"
    return DrawnSheet(
        name,
        title,
        (round(bx1 - bx0 + 4.0, 3), round(by1 - by0 + 4.0, 3)),
        tuple(moved(i, 2.0 - bx0, 2.0 - by0) for i in items),
    )
