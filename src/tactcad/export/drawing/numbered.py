"""Views of a scene's parts with their item numbers: exploded, or side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from tactcad.design.messages import CheckFailure
from tactcad.export.bom import BomRow
from tactcad.export.guide import exploded
from tactcad.export.windows import Polyline
from tactcad.scenes.scene import Placement, Scene

from . import balloons, family, parts_list
from .ink import Item, Stroke, Text
from .page import EDGE, MARGIN, Page, edges, fewer
from .paper import A3, A3_UPRIGHT, Paper
from .scale import ASSEMBLIES, SERIES, factor, shown
from .title import HEIGHT, WIDTH, TitleBlock

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

    from tactcad.export.picture import View

RIM = 2 * balloons.RADIUS + 8.0  # around an exploded view, for its balloons
MOST_NUMBERED = 45  # items in one view; more would not find places around it

Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class Exploded:
    """An exploded view: visible lines (mm, picture plane) of every placement drawn, and the items that it numbers."""

    own: dict[int, list[Polyline]]
    lines: tuple[Polyline, ...]

    @property
    def box(self) -> Box:
        xs, ys = zip(*(p for line in self.lines for p in line))
        return (min(xs), min(ys), max(xs), max(ys))


def numbered_pages(
    scene: Scene, rows: Sequence[BomRow], shapes: Mapping[str, TopoDS_Shape], list_: parts_list.Laid | None, block: TitleBlock
) -> tuple[list[Page], bool]:
    """Views until every item that has a solid has its number in one, and whether the parts list stands beside one.

    The first is exploded and shows all parts, each further one those that none before it has numbered. Where an exploded
    view would be too large or too crowded the parts stand side by side instead.
    """
    from tactcad.export.picture import ABOVE

    item = {row.part_no: row.item for row in rows if row.has_solid}
    left = exploded(scene) if scene.steps else scene.placements
    pages: list[Page] = []
    listed = False
    while left:
        view = _exploded_view(fewer(left), item, shapes, ABOVE)
        label = f"{chr(ord('A') + len(pages))}: {'what the views before it do not number' if pages else 'exploded'}"
        made = _exploded_page(view, label, None if listed else list_) if view.own else None
        if made is None:
            return pages + _family_pages(left, item, shapes, block), listed
        pages.append(made[0])
        listed = listed or made[1]
        left = tuple(p for p in left if item[p.part.part_no] not in view.own)
    return pages, listed


def _family_pages(
    left: Sequence[Placement], item: Mapping[str, int], shapes: Mapping[str, TopoDS_Shape], block: TitleBlock
) -> list[Page]:
    """One of each part, at the largest scale at which they fit one page, or else the smallest at which the largest part does."""
    from tactcad.export.picture import ABOVE, drawing
    from tactcad.solids.place import placed_shape

    first = {item[p.part.part_no]: p for p in reversed(left)}
    own = {
        n: drawing([placed_shape(shapes[p.part.part_no], p.origin, p.rotation)], ABOVE).sharp for n, p in sorted(first.items())
    }
    x0, y0, x1, y1 = (v + m for v, m in zip(_room(A3, False), (MARGIN, MARGIN, -MARGIN, -MARGIN - 8.0)))
    laid = [(scale, made) for scale in ASSEMBLIES if (made := family.pages(own, factor(scale), (x0, y0, x1, y1)))]
    if not laid:
        raise CheckFailure(f"drawings: {block.number}: a part does not fit A3 at {shown(ASSEMBLIES[-1])}; no drawing was written")
    scale, made = next((pair for pair in laid if len(pair[1]) == 1), laid[-1])
    title = Text((x0, y1 + 3.0), "One of each part, in the order of item numbers", 3.5)
    return [
        Page(A3, shown(scale), (title, *(Stroke(line, EDGE) for s in page for line in s.lines), *family.drawn(page)), "Assembly drawing")
        for page in made
    ]


def _exploded_view(
    placements: Sequence[Placement], item: Mapping[str, int], shapes: Mapping[str, TopoDS_Shape], eye: View
) -> Exploded:
    from tactcad.solids.place import placed_shape

    from .assembly_lines import seen_of_each

    lines = seen_of_each([placed_shape(shapes[p.part.part_no], p.origin, p.rotation) for p in placements], eye)
    own: dict[int, list[Polyline]] = {}
    for p, some in zip(placements, lines):
        if some:
            own.setdefault(item[p.part.part_no], []).extend(some)
    numbered = dict(sorted(own.items())[:MOST_NUMBERED])
    return Exploded(numbered, tuple(sorted({line for some in lines for line in some})))


def _exploded_page(view: Exploded, label: str, list_: parts_list.Laid | None) -> tuple[Page, bool] | None:
    """The view at the largest scale at which its balloons find places, and whether the parts list stands beside it, which
    it does where that costs no scale. None where the balloons find no place."""
    bx0, by0, bx1, by1 = view.box
    choices = [(A3, True), (A3, False), (A3_UPRIGHT, False)] if list_ else [(A3, False), (A3_UPRIGHT, False)]
    for scale in SERIES:
        f = factor(scale)
        for paper, with_list in choices:
            area = _room(paper, with_list)
            if (bx1 - bx0) * f + 2 * RIM > area[2] - area[0] or (by1 - by0) * f + 2 * RIM > area[3] - area[1]:
                continue
            shift = ((area[0] + area[2] - (bx0 + bx1) * f) / 2, (area[1] + area[3] - (by0 + by1) * f) / 2)
            drawn = edges(view.lines, f, shift)
            own = {n: [e.points for e in edges(lines, f, shift)] for n, lines in view.own.items()}
            found = balloons.place(own, [e.points for e in drawn], area)
            if not found:
                continue
            items: list[Item] = [*drawn, *balloons.drawn(found)]
            items.append(Text((area[0] + MARGIN, area[3] - MARGIN - 3.5), label, 3.5))
            if with_list:
                items += parts_list.drawn(list_, range(len(list_.cells)), (paper.area[2] - WIDTH, paper.area[3]))[0]
            kind = "Assembly drawing, parts list" if with_list else "Assembly drawing"
            return Page(paper, shown(scale), tuple(items), kind), with_list
    return None


def _room(paper: Paper, with_list: bool) -> Box:
    """Where an exploded view may stand: left of the list, else left of or over the title block, whichever is larger."""
    x0, y0, x1, y1 = paper.area
    beside, over = (x0, y0, x1 - WIDTH, y1), (x0, y0 + HEIGHT, x1, y1)
    if with_list or (beside[2] - beside[0]) * (beside[3] - beside[1]) > (over[2] - over[0]) * (over[3] - over[1]):
        return beside
    return over
