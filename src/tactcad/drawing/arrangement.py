"""General arrangement of a scene: three views in first angle, overall dimensions, notes; of the array also
its sensing face, and how it is mounted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.parts.layout import Layout
from tactcad.scenes.scene import Scene

from . import sensing_face
from .assembly_notes import notes_of
from .boxes import Box, grown
from .extent import projected_box
from .information import Given, for_information
from .ink import Item, moved
from .page import MARGIN, Page, edges, fewer
from .paper import A0, A1, A2, A3, A3_UPRIGHT, Paper
from .scale import ASSEMBLIES, Scale, factor, largest_fitting, shown
from .sensing_face import array_of
from .sheet_plan import Side
from .title import HEIGHT, WIDTH, TitleBlock, notes

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

APART = 11.0  # between views
LEAST = 1 / 50  # scale: larger paper before a smaller scale
AROUND = 20.0  # left of and above the views, for overall dimensions
OVER_FACE, UNDER_PLAN = 14.0, 20.0  # for the dimensions of the sensing face, and two below each other


def arrangement(design: Design, scene: Scene, shapes: Mapping[str, TopoDS_Shape], block: TitleBlock) -> Page:
    """Front, plan below it, view from the left to its right; of the array the sensing face, seen from below,
    over the front."""
    from tactcad.solids.place import placed_shape

    from .picture import EXACT_UP_TO, Viewpoint, drawing

    views = {
        "front": Viewpoint("front", (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
        "plan": Viewpoint("plan", (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
        "left": Viewpoint("left", (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    }
    face = array_of(scene) is scene
    if face:
        views["below"] = Viewpoint("below", sensing_face.EYE, sensing_face.UP)
    boxes = {name: projected_box(scene.placements, v.right, v.eye) for name, v in views.items()}
    extents = {name: (b[2] - b[0], b[3] - b[1]) for name, b in boxes.items()}
    wide = extents["front"][0] + extents["left"][0]
    high = sum(extents[name][1] for name in views if name != "left")
    spare = APART + AROUND, 2 * APART + OVER_FACE + UNDER_PLAN if face else APART + AROUND
    scale, paper, items, (x0, y0, x1, y1) = _largest(wide, high, spare, notes_of(design, scene), block)
    f = factor(scale)
    west, south = (x0 + x1 - f * wide - spare[0]) / 2 + AROUND, (y0 + y1 - f * high - spare[1]) / 2
    if face:
        south += UNDER_PLAN
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
    # on three sides that face nothing: texts of short dimensions stand beside them
    dimensioned: dict[str, tuple[Side, ...]] = (
        {"front": ("left",), "plan": ("bottom", "right")}
        if face
        else {"front": ("top", "left"), "plan": ("right",)}
    )
    inner = {"plan": mounting(Layout(design), boxes["plan"])} if face else {}
    for name, sides in dimensioned.items():
        own = _dimensioned(extents[name], f, sides, inner.get(name, ()))
        items += [moved(i, *places[name]) for i in own]
    if face:
        items += [moved(i, *places["below"]) for i in sensing_face.dimensioned(scene, boxes["below"], f)]
    return Page(paper, shown(scale), tuple(items), "Assembly drawing")


def mounting(layout: Layout, plan: Box) -> tuple[Given, Given]:
    """The pattern of the carrier's threads for its holder, in the plan whose box that is."""
    x, y = layout.mount_x, layout.design.clamp.mount_pitch_y / 2
    x0, y0 = plan[:2]
    return (
        Given("bottom", 2 * x, (-x - x0, -y - y0), (x - x0, -y - y0)),
        Given("right", 2 * y, (x - x0, -y - y0), (x - x0, y - y0)),
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

    On a landscape sheet they stand over the title block, on a portrait one over its whole width.
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


def _dimensioned(
    extent: tuple[float, float], f: float, sides: Sequence[Side], inner: Sequence[Given]
) -> list[Item]:
    """Overall sizes of a view whose lower left corner is (0, 0), to 0.1 mm, and the `inner` dimensions."""
    w, h = extent
    overall: dict[Side, Given] = {
        "top": Given("top", w, (0.0, h), (w, h)),
        "bottom": Given("bottom", w, (0.0, 0.0), (w, 0.0)),
        "left": Given("left", h, (0.0, 0.0), (0.0, h)),
        "right": Given("right", h, (w, 0.0), (w, h)),
    }
    given = [*inner, *(replace(overall[side], value=round(overall[side].value, 1)) for side in sides)]
    return for_information(given, (0.0, 0.0, w * f, h * f), f)
