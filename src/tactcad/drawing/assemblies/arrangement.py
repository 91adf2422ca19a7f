"""General arrangement of a scene: three views in first angle, overall dimensions for information, notes; of
the array also its sensing face, and how it is mounted.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from tactcad.design.family import family_of
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import CommonTables
from tactcad.parts.array import seating
from tactcad.parts.array.layout import Layout
from tactcad.parts.language.description import Kind
from tactcad.scenes.rig import ARRAY
from tactcad.scenes.scene import Scene

from ..engine.boxes import Box, Point, grown, projected_box
from ..engine.ink import LETTERS, Item, Text, moved
from ..engine.paper import (
    A0,
    A1,
    A2,
    A3,
    A3_UPRIGHT,
    ASSEMBLIES,
    HEIGHT,
    MARGIN,
    WIDTH,
    Page,
    Paper,
    Scale,
    TitleBlock,
    edges,
    factor,
    fewer,
    largest_fitting,
    notes,
    shown,
)
from ..guide import BESIDE, FACE_EYE, FACE_UP, array_of, axes, in_stack, numbers, pad, page_path, torque
from ..parts.dimension_lines import stacked
from ..parts.measures import Given
from ..parts.sheet_plan import OUTWARDS, Dimension, Linear, Side

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

APART = 11.0  # between views
LEAST = 1 / 50  # scale: larger paper before a smaller scale
AROUND = 20.0  # left of and above the views, for overall dimensions
OVER_FACE, UNDER_PLAN = 14.0, 20.0  # for the dimensions of the sensing face, and two below each other
LONGEST_ROW = 24  # elements named on the sheet: three lines of a note


def arrangement(
    design: CommonTables, scene: Scene, shapes: Mapping[str, TopoDS_Shape], block: TitleBlock
) -> Page:
    """Front, plan below it, view from the left to its right; of the array its sensing face over the front."""
    from tactcad.solids.occt import placed_shape

    from ..engine.picture import EXACT_UP_TO, Viewpoint, drawing

    views = {
        "front": Viewpoint("front", (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
        "plan": Viewpoint("plan", (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
        "left": Viewpoint("left", (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    }
    array = array_of(scene) is scene
    face = array and bool(in_stack(scene))  # two rows that it numbers
    if face:
        views["below"] = Viewpoint("below", FACE_EYE, FACE_UP)
    boxes = {name: projected_box(scene.placements, v.right, v.eye) for name, v in views.items()}
    extents = {name: (b[2] - b[0], b[3] - b[1]) for name, b in boxes.items()}
    wide = extents["front"][0] + extents["left"][0]
    high = sum(extents[name][1] for name in views if name != "left")
    family = family_of(design)
    own_plan = family.plans.get(ARRAY) if array else None
    under = UNDER_PLAN if own_plan else 0.0
    spare = APART + AROUND, under + (2 * APART + OVER_FACE if face else APART + AROUND)
    scale, paper, items, (x0, y0, x1, y1) = _largest(wide, high, spare, notes_of(design, scene), block)
    f = factor(scale)
    west, south = (x0 + x1 - f * wide - spare[0]) / 2 + AROUND, (y0 + y1 - f * high - spare[1]) / 2
    south += under
    north = south + f * extents["plan"][1] + APART
    places = {
        "plan": (west, south),
        "front": (west, north),
        "left": (west + f * extents["front"][0] + APART, north),
        "below": (west, north + f * extents["front"][1] + APART),
    }
    for name, view in views.items():
        # from the front and from above the outermost parts hide the long rows behind them
        whole = name == "left" or len(scene.placements) <= EXACT_UP_TO
        some = scene.placements if whole else fewer(scene.placements)
        placed = [placed_shape(shapes[p.part.part_no], p.origin, p.rotation) for p in some]
        (bx, by), (px, py) = boxes[name][:2], places[name]
        items += edges(drawing(placed, view).sharp, f, (px - f * bx, py - f * by))
    # on the three free sides: texts of short dimensions are next to them
    dimensioned: dict[str, tuple[Side, ...]] = (
        {"front": ("left",), "plan": ("bottom", "right")}
        if face
        else {"front": ("top", "left"), "plan": ("right",)}
    )
    inner = {"plan": own_plan(family.layout(design), boxes["plan"])} if own_plan else {}
    for name, sides in dimensioned.items():
        w, h = extents[name]
        overall = {
            "top": given("top", round(w, 1), (0.0, h), (w, h)),
            "bottom": given("bottom", round(w, 1), (0.0, 0.0), (w, 0.0)),
            "left": given("left", round(h, 1), (0.0, 0.0), (0.0, h)),
            "right": given("right", round(h, 1), (w, 0.0), (w, h)),
        }
        own = [*inner.get(name, ()), *(overall[side] for side in sides)]
        items += [moved(i, *places[name]) for i in _lines(own, (0.0, 0.0, w * f, h * f), f)]
    if face:
        items += [moved(i, *places["below"]) for i in _sensing_face(scene, boxes["below"], f)]
    return Page(paper, shown(scale), tuple(items), "Assembly drawing")


def mounting(layout: Layout, plan: Box) -> tuple[Linear, Linear]:
    """The pattern of the carrier's threads for its holder, in the plan whose box that is."""
    x, y = layout.mount_x, layout.design.clamp.mount_pitch_y / 2
    x0, y0 = plan[:2]
    return (
        given("bottom", 2 * x, (-x - x0, -y - y0), (x - x0, -y - y0)),
        given("right", 2 * y, (x - x0, -y - y0), (x - x0, y - y0)),
    )


def _largest(
    wide: float, high: float, spare: tuple[float, float], lines: Sequence[str], block: TitleBlock
) -> tuple[Scale, Paper, list[Item], Box]:
    """The largest scale on A3, or the smallest larger paper on which the scale is at least LEAST.

    Returns scale, paper, the notes on it, and the area for the views, whose size in all is given (mm of the
    assembly, and `spare` mm of paper).
    """
    best: tuple[Scale, Paper, list[Item], Box] | None = None
    for papers in ((A3, A3_UPRIGHT), (A2,), (A1,), (A0,)):
        for paper in papers:
            items, area = _with_notes(paper, lines, block)
            x0, y0, x1, y1 = area
            scale = largest_fitting(wide, high, (x1 - x0 - spare[0], y1 - y0 - spare[1]))
            if scale and (best is None or factor(scale) > factor(best[0])):
                best = scale, paper, items, area
        if best and factor(best[0]) >= LEAST:
            return best
    if best is None:
        raise CheckFailure(
            f"drawings: {block.number}: three views of {wide:.0f} x {high:.0f} mm in all do not fit A0 at "
            f"{shown(ASSEMBLIES[-1])}; no drawing was written"
        )
    return best


def _with_notes(paper: Paper, lines: Sequence[str], block: TitleBlock) -> tuple[list[Item], Box]:
    """The notes, and the area that they leave for the views.

    On a landscape sheet they are over the title block, on a portrait one over its whole width.
    """
    x0, y0, x1, y1 = paper.area
    lying = paper.width > paper.height
    room = (WIDTH if lying else x1 - x0) - 2 * MARGIN
    texts, high = notes((0.0, 0.0), lines, room)
    if high > y1 - y0 - HEIGHT - 2 * MARGIN:
        raise CheckFailure(
            f"drawings: {block.number}: the notes are higher than the sheet; no drawing was written"
        )
    at = (x1 - WIDTH + MARGIN, y1 - MARGIN) if lying else (x0 + MARGIN, y0 + HEIGHT + MARGIN + high)
    left = (x0, y0, x1 - WIDTH, y1) if lying else (x0, at[1], x1, y1)
    return [moved(t, *at) for t in texts], grown(left, -MARGIN)


def given(side: Side, value: float, p: Point, q: Point) -> Linear:
    """A value (mm) in parentheses on a side of a view, between two points of it (mm of the assembly)."""
    return Linear(Dimension("given", (Given(value),), auxiliary=True), side, p, q)


def _lines(some: Sequence[Linear], box: Box, f: float) -> list[Item]:
    """Lines and texts around a view of that box (mm of paper), at the scale f."""
    return [item for side in OUTWARDS for item in stacked(some, side, box, f, {}, 10.0)]


def notes_of(design: CommonTables, scene: Scene) -> tuple[str, ...]:
    """Numbered notes: order, torques, the pads' coplanarity, what the numbers mean."""
    lines = []
    if scene.steps:
        lines.append(
            f"Assemble in the {len(scene.steps)} steps of the assembly guide, {page_path(scene)} "
            "(tactcad export --guide)"
        )
    placed = {p.designator: p for p in scene.placements}
    layout = family_of(design).layout(design)
    for row, side in ((1, "+"), (2, "-")):  # of longer rows the designators in the bill alone say it
        own = [p for p in layout.elements if p.row == row and p.designator in placed]
        if 0 < len(own) <= LONGEST_ROW:
            ys = [placed[p.designator].origin[1] for p in own]
            way = "from +y to -y" if ys[0] > ys[-1] else "from -y to +y"
            order = ", ".join(f"{p.designator} arm {p.arm:g}" for p in own)
            lines.append(f"Row {row}, its bodies on the side of {side}x, {way}: {order}")
    if torques := _torques(design, scene, "cap screw"):
        lines.append(f"Tighten cap screws of property class A2-70, lubricated, to {torques}")
    if torques := _torques(design, scene, "nut"):
        lines.append(f"Tighten nuts of property class A2-70, lubricated, to {torques}")
    if any(part.kind == "set screw" for part in scene.parts):
        torques = _torques(design, scene, "set screw")
        how = f"to {torques}" if torques else seating.words(layout)
        lines.append(f"Turn set screws in {how}, locked with thread lacquer")
    for step in scene.steps:
        if step.limit:
            lines.append(f"{step.limit}. {step.text}")
    lines.append("Item numbers are those of the bill of materials; what has no solid has no balloon")
    lines.append(
        "Dimensions in parentheses are for information; "
        "in the front view x points to the right, y away from the viewer"
    )
    return tuple(lines)


def _torques(design: CommonTables, scene: Scene, kind: Kind) -> str:
    """ "M3 0.55 N·m, M4 1.2 N·m" of the screws or nuts of that kind."""
    torques = {part.thread: torque(part, design) or 0.0 for part in scene.parts if part.kind == kind}
    ascending = sorted(torques.items(), key=lambda pair: pair[1])
    return ", ".join(f"{thread} {tight:g} N·m" for thread, tight in ascending if tight)


def _sensing_face(array: Scene, view: Box, f: float) -> list[Item]:
    """Annotations of the array's view from below, with its lower left corner at (0, 0), at the scale f:
    element numbers, axes, pitch and gap between the rows.

    `view` is the view's box, mm.
    """
    x0, y0, x1, y1 = view
    half, high = x1 * f, (y1 - y0) * f
    names = numbers(array, f, half)
    wide = max(t.width for t in names) + 2 * BESIDE
    own = []
    left, right = (
        [box for p in in_stack(array) if (box := pad(p)) and p.rotation[0][0] * s > 0] for s in (-1.0, 1.0)
    )
    row = left if len(left) > 1 else right
    if len(row) > 1:
        # beyond the numbers, so that the extension lines pass none
        a, b = ((-wide / f, box[1] - y0) for box in row[:2])
        own.append(given("left", a[1] - b[1], a, b))
    if left and right:
        (*_, inner, top), (outer, *_) = left[0], right[0]
        own.append(given("top", outer - inner, (inner - x0, top - y0), (outer - x0, top - y0)))
    lines = _lines(own, (-wide, 0.0, (x1 - x0) * f, high), f)
    right_of_it = (x1 - x0) * f + wide + LETTERS
    name = Text((right_of_it, high - LETTERS), "Sensing face")
    texts = [moved(t, -x0 * f, -y0 * f) for t in names]
    return [*texts, *lines, name, *axes((right_of_it, high - 3 * LETTERS))]
