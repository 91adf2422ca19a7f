"""General arrangement of a scene: three views in first angle, overall dimensions, notes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.scenes.scene import Scene

from .assembly_notes import notes_of
from .boxes import Box, grown
from .dimension_lines import stacked
from .extent import projected_box
from .ink import Item, moved
from .keys import WHOLE
from .measures import size
from .page import MARGIN, Page, edges, fewer
from .paper import A0, A1, A2, A3, A3_UPRIGHT, Paper
from .scale import ASSEMBLIES, Scale, factor, largest_fitting, shown
from .sheet_plan import Dimension, Linear, Side
from .title import HEIGHT, WIDTH, TitleBlock, notes

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

APART = 14.0  # between views
LEAST = 1 / 50  # scale: larger paper before a smaller scale
AROUND = 20.0  # left of and above the views, for overall dimensions


def arrangement(design: Design, scene: Scene, shapes: Mapping[str, TopoDS_Shape], block: TitleBlock) -> Page:
    """Front, plan below it, view from the left to its right."""
    from tactcad.solids.place import placed_shape

    from .picture import EXACT_UP_TO, Viewpoint, drawing

    views = {
        "front": Viewpoint("front", (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
        "plan": Viewpoint("plan", (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
        "left": Viewpoint("left", (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    }
    boxes = {name: projected_box(scene.placements, v.right, v.eye) for name, v in views.items()}
    extents = {name: (b[2] - b[0], b[3] - b[1]) for name, b in boxes.items()}
    wide, high = extents["front"][0] + extents["left"][0], extents["front"][1] + extents["plan"][1]
    spare = APART + AROUND
    scale, paper, items, (x0, y0, x1, y1) = _largest(wide, high, spare, notes_of(design, scene), block)
    f = factor(scale)
    west, south = (x0 + x1 - f * wide - spare) / 2 + AROUND, (y0 + y1 - f * high - spare) / 2
    north = south + f * extents["plan"][1] + APART
    places = {
        "plan": (west, south),
        "front": (west, north),
        "left": (west + f * extents["front"][0] + APART, north),
    }
    for name, view in views.items():
        # from the front and from above the outermost parts hide the long rows behind them
        whole = name == "left" or len(scene.placements) <= EXACT_UP_TO
        some = scene.placements if whole else fewer(scene.placements)
        placed = [placed_shape(shapes[p.part.part_no], p.origin, p.rotation) for p in some]
        (bx, by), (px, py) = boxes[name][:2], places[name]
        items += edges(drawing(placed, view).sharp, f, (px - f * bx, py - f * by))
    # on three sides that face nothing: texts of short dimensions stand beside them
    dimensioned: dict[str, tuple[Side, ...]] = {"front": ("top", "left"), "plan": ("right",)}
    for name, sides in dimensioned.items():
        items += [moved(i, *places[name]) for i in _overall(extents[name], f, sides)]
    return Page(paper, shown(scale), tuple(items), "Assembly drawing")


def _largest(
    wide: float, high: float, spare: float, lines: Sequence[str], block: TitleBlock
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
            scale = largest_fitting(wide, high, (x1 - x0 - spare, y1 - y0 - spare))
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


def _overall(extent: tuple[float, float], f: float, sides: Sequence[Side]) -> list[Item]:
    """Overall sizes of a view whose lower left corner is (0, 0), to 0.1 mm, as auxiliary dimensions in
    parentheses."""
    w, h = extent
    wide, high = WHOLE.place(0), WHOLE.place(1)
    values = {wide: round(w, 1), high: round(h, 1)}
    items: list[Item] = []
    for side in sides:
        x = w if side == "right" else 0.0
        overall, p, q = (wide, (0.0, h), (w, h)) if side == "top" else (high, (x, 0.0), (x, h))
        dimension = Dimension(f"overall {overall}", (size(overall),), auxiliary=True)
        items += stacked([Linear(dimension, side, p, q)], side, (0.0, 0.0, w * f, h * f), f, values, 10.0)
    return items
