"""The hinge that a contour encloses, read from the contour's own segments and verified by drawing it again.

A contour in the side plane (x along the arm, z across it), cut at clamp edge and load line, is a hinge
between two rectangles. `read` finds it, and refuses any contour of another shape.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Literal

from tactcad.contour import Arc, Contour, Corner, Line, rounded_polygon
from tactcad.contour.cut import ON_LINE_MM, between, crossings, cut
from tactcad.design.messages import CheckFailure
from tactcad.design.text_values import filling_radius
from tactcad.mechanics.section import HingeSection

ANGLE = 1e-7  # rad: tangents closer than this to an axis count as parallel to it
SAME_AREA = 1e-9  # relative, for areas: the effect of rounded coordinates
# mm, for lengths: where a cut touches a fillet's end at its wall, rounding of 1e-14 mm moves that end along
# the wall by the root of 2 r times that
SAME_LENGTH = 1e-6


@dataclass(frozen=True)
class Fillet:
    """A rounded slot corner: the wall's x and the radius, mm."""

    wall: float
    radius: float


@dataclass(frozen=True)
class Block:
    """Body or arm as a rectangle: its outer end in x, lower and upper face in z, slot corners, mm."""

    end: float
    low: float
    high: float
    low_fillet: Fillet | None  # None if the hinge's lower face is the block's
    high_fillet: Fillet | None

    def slot_corner(self, upper: bool) -> Fillet:
        """The fillet at the slot above or below the hinge, which must be there."""
        fillet = self.high_fillet if upper else self.low_fillet
        if fillet is None:
            raise ValueError("the hinge has no slot on that side")
        return fillet


@dataclass(frozen=True)
class ElementShape:
    """Hinge between z = low and high, and the blocks that it joins (mm)."""

    low: float
    high: float
    arm: Block
    body: Block

    @property
    def hinge_thickness(self) -> float:
        return self.high - self.low

    @property
    def two_sided(self) -> bool:
        return self.arm.low_fillet is not None


def outline(shape: ElementShape) -> Contour:
    """The contour of the shape, counter-clockwise; slot corners and walls are named."""
    left, right = sorted((shape.arm, shape.body), key=lambda block: block.end)
    names = {id(shape.arm): "arm", id(shape.body): "body"}

    def corners(block: Block, face: float, floor: float, fillet: Fillet | None, side: str) -> list[Corner]:
        """From the block's outer end to the hinge's floor."""
        name = names[id(block)]
        if fillet is None:
            return [Corner((block.end, face), 0.0, f"{name}-{side}")]
        return [
            Corner((block.end, face), 0.0, f"{name}-{side}"),
            Corner((fillet.wall, face), 0.0, f"{name}-{side}-wall"),
            Corner((fillet.wall, floor), fillet.radius, f"hinge-{side}", f"{name}-{side}-fillet"),
        ]

    low = [
        *corners(left, left.low, shape.low, left.low_fillet, "low"),
        *reversed(corners(right, right.low, shape.low, right.low_fillet, "low")),
    ]
    high = [
        *corners(right, right.high, shape.high, right.high_fillet, "high"),
        *reversed(corners(left, left.high, shape.high, left.high_fillet, "high")),
    ]
    return rounded_polygon(_renamed(low + high))


def _renamed(corners: list[Corner]) -> list[Corner]:
    """Each corner names the edge that leaves it; for reversed runs that is the next corner's own name."""
    count = len(corners)
    named = []
    for i, corner in enumerate(corners):
        after = corners[(i + 1) % count]
        vertical = corner.at[0] == after.at[0]
        walls = [c.edge for c in (corner, after) if c.edge.endswith("wall")]
        hinge = corner.fillet and after.fillet
        if vertical and walls:
            edge = walls[0]
        elif vertical:
            edge = corner.edge.split("-")[0] + "-end"
        elif hinge:
            edge = corner.edge
        else:
            edge = next((c.edge for c in (corner, after) if not c.fillet and not c.edge.endswith("wall")), "")
        named.append(Corner(corner.at, corner.radius, edge, corner.fillet))
    return named


def reference_shape(s: HingeSection) -> ElementShape:
    """One reference element (scalars): arm cut off at the load line, hinge centre at x = 0, arm to +x."""
    t, half = float(s.hinge_thickness), float(s.hinge_length) / 2.0
    r = filling_radius(float(s.fillet_radius), 2.0 * half)
    h, Hb = float(s.arm_height), float(s.body_height)
    if bool(s.two_sided):
        low, high = -t / 2.0, t / 2.0
        faces = ((-h / 2.0, h / 2.0), (-Hb / 2.0, Hb / 2.0))
    else:
        low, high = 0.0, t
        faces = ((0.0, h), (0.0, Hb))

    def block(end: float, wall: float, face: tuple[float, float]) -> Block:
        fillet = Fillet(wall, r)
        return Block(end, *face, fillet if bool(s.two_sided) else None, fillet)

    arm = block(float(s.load_arm), half, faces[0])
    return ElementShape(low, high, arm, block(-half - float(s.body_length), -half, faces[1]))


def cut_element(contour: Contour, clamp_x: float, load_x: float) -> ElementShape:
    """The hinge shape of a part between clamp edge and load line.

    Pad, stop land and the rear body's corner fillet are left out, as in the reference designs.

    Parameters
    ----------
    contour
        The part's, in the side plane, mm.
    clamp_x, load_x
        Where it is cut, mm.

    Raises
    ------
    CheckFailure
        If the hinge model does not describe the part; with the reason.
    """
    try:
        piece = between(contour, min(clamp_x, load_x), max(clamp_x, load_x), ("end", "end"))
    except ValueError as error:
        raise CheckFailure(f"the element cannot be cut at clamp edge and load line: {error}") from None
    return read(piece, load_x)


def read(contour: Contour, load_x: float) -> ElementShape:
    """The hinge shape enclosed by a contour that ends at the load line x = load_x (mm).

    Raises CheckFailure if the contour is not one hinge between two rectangles.
    """
    outer = contour if contour.ccw else contour.reversed()
    x0, _, x1, _ = outer.box
    arm_at_right = abs(load_x - x1) < abs(load_x - x0)
    corners = [
        c
        for i, s in enumerate(outer.segments)
        if isinstance(s, Arc) and not s.ccw
        for c in _slot_corners(outer, s, i)
    ]
    if not corners:
        raise CheckFailure("the contour has no slot with rounded corners between clamp edge and load line")
    thinnest = min(c.high - c.low for c in corners)
    fillets = [c for c in corners if c.high - c.low <= thinnest * (1.0 + 1e-9)]
    floor_low, floor_high = fillets[0].low, fillets[0].high
    by_place: dict[tuple[bool, bool], _SlotCorner] = {}
    for corner in fillets:
        key = (corner.at_right == arm_at_right, corner.on_top)
        if key in by_place:
            raise CheckFailure("the contour has more than one hinge of the same thickness")
        by_place[key] = corner
    sides = {on_top for _, on_top in by_place}
    if len(by_place) != 2 * len(sides):
        raise CheckFailure("a slot of the hinge does not have two rounded corners")

    def block(arm: bool) -> Block:
        low, high = by_place.get((arm, False)), by_place.get((arm, True))
        return Block(
            (x1 if arm == arm_at_right else x0),
            low.face if low else floor_low,
            high.face if high else floor_high,
            Fillet(low.wall, low.radius) if low else None,
            Fillet(high.wall, high.radius) if high else None,
        )

    shape = ElementShape(floor_low, floor_high, block(True), block(False))
    _require_same(outer, shape)
    return shape


@dataclass(frozen=True)
class _SlotCorner:
    """A concave fillet, and the hinge that its floor would make."""

    wall: float
    radius: float
    at_right: bool  # of its slot
    on_top: bool  # slot above the hinge
    low: float
    high: float
    face: float  # z where the slot's wall ends


def _slot_corners(outer: Contour, arc: Arc, index: int) -> list[_SlotCorner]:
    """The slot corners that a clockwise arc, the segment `index`, makes: one for a quarter turn, two for a
    full round."""
    count = len(outer)
    (cx, cz), r = arc.centre, arc.radius
    turn = -arc.sweep
    if abs(turn - pi) < ANGLE and abs(arc.start[1] - cz) < ANGLE * r:
        ends = [(arc.start, -1), (arc.end, 1)]
    elif abs(turn - pi / 2) < ANGLE:
        # a quarter turn has one end level with its centre (at the wall) and one above or below (at the floor)
        ends = [(arc.start, -1)] if abs(arc.start[1] - cz) < ANGLE * r else [(arc.end, 1)]
        if abs(ends[0][0][1] - cz) > ANGLE * r:
            return []
    else:
        return []
    floor = min((arc.start, arc.end), key=lambda p: abs(p[0] - cx))[1] if turn < 2.0 else None
    slots = []
    for point, step in ends:
        at_right = point[0] > cx
        wall = outer.segments[(index + step) % count]
        along = isinstance(wall, Line) and wall.start[0] == wall.end[0]
        face = (wall.start if step < 0 else wall.end)[1] if along else point[1]
        # an arc that bulges down into the material has its slot above it
        on_top = face > cz if along else arc.at(0.5)[1] < arc.centre[1]
        z = floor if floor is not None else cz + (-r if on_top else r)
        zs = crossings(outer, "x", cx + (1e-7 if at_right else -1e-7) * r)
        other = [q for q in zs if (q < z - ON_LINE_MM if on_top else q > z + ON_LINE_MM)]
        if not other:
            continue
        low, high = (max(other), z) if on_top else (z, min(other))
        slots.append(_SlotCorner(point[0], r, at_right, on_top, low, high, face))
    return slots


def _require_same(outer: Contour, shape: ElementShape) -> None:
    """Refuse a contour that is not the shape's outline, apart from what protrudes from its faces at a cut.

    Those are pad and stop land at the load line, and the fillet of the rear body's corner at the clamp edge.
    """
    middle = shape.arm.slot_corner(upper=shape.arm.high_fillet is not None).wall
    pieces = {"arm": shape.arm, "body": shape.body}
    x0, _, x1, _ = outer.box
    drawn = outline(shape)
    for name, block in pieces.items():
        span = (min(middle, block.end), max(middle, block.end))
        if name == "body":
            span = (x0, middle) if shape.arm.end > middle else (middle, x1)
        try:
            real = between(outer, *span)
        except ValueError:
            raise CheckFailure(f"the {name} of the element is not one piece") from None
        real = _without_pad(real, block.low, "above", block.end, name)
        real = _without_pad(real, block.high, "below", block.end, name)
        if (
            abs(real.area - between(drawn, *span).area) > SAME_AREA * drawn.area
            or abs(real.length - between(drawn, *span).length) > SAME_LENGTH
        ):
            raise CheckFailure(
                f"the {name} is not a plain rectangle between slot and "
                f"{'load line' if name == 'arm' else 'clamp edge'}; the hinge model cannot follow it"
            )


def _without_pad(
    contour: Contour, face: float, keep: Literal["below", "above"], end_x: float, name: str
) -> Contour:
    """The outline within the block's face; beyond it only what protrudes at the cut itself may be left
    out.
    """
    beyond = cut(contour, "y", face, "below" if keep == "above" else "above")
    if any(min(abs(c.box[0] - end_x), abs(c.box[2] - end_x)) > ON_LINE_MM for c in beyond):
        raise CheckFailure(f"something protrudes from the {name} between slot and cut")
    parts = cut(contour, "y", face, keep)
    if len(parts) != 1:
        raise CheckFailure(f"the {name} is not one piece")
    return parts[0]
