"""The assembly drawing of a scene: general arrangement, exploded views with item numbers, and the parts list."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.export.bom import BomRow
from tactcad.export.extent import projected_box
from tactcad.export.guide import exploded
from tactcad.export.windows import Polyline
from tactcad.scenes.scene import Placement, Scene

from . import balloons, parts_list
from .assembly_notes import notes_of
from .dimension_lines import stacked
from .ink import Item, LineType, Sheet, Stroke, Text, moved, preliminary
from .layout import layout_faults
from .measure import Span, level
from .paper import A3, A3_UPRIGHT, A4, Paper, frame
from .plan import Dimension, Linear
from .scale import SERIES, factor, largest_fitting, shown
from .title import HEIGHT, WIDTH, TitleBlock, notes, title_block

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

    from tactcad.export.picture import View

EDGE = LineType("edge", 0.35)  # visible edges of an assembly: the thinner line group of ISO 128-2
MARGIN = 5.0  # from the frame to anything
APART = 14.0  # between views
AROUND = 20.0  # left of and over the views, for overall dimensions
RIM = 2 * balloons.RADIUS + 8.0  # around an exploded view, for its balloons
# of repeated parts no more are drawn than keep an exploded view under this many: the kernel compares them pair by pair
MOST_DRAWN = 150
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


def assembly_sheets(
    design: Design, scene: Scene, rows: Sequence[BomRow], shapes: Mapping[str, TopoDS_Shape], draft: bool = False
) -> list[Sheet]:
    """All sheets of the scene, their layout clean. `shapes` by part number, `rows` the scene's bill of materials.

    Raises CheckFailure where the scene is larger than the sheet at 1:10, or a view leaves no clean layout.
    """
    block = _title(design, scene, draft)
    arranged = _arrangement(design, scene, shapes, block)
    views = _exploded_views(scene, rows, shapes)
    list_ = next((p for p in (parts_list.laid(rows, size) for size in parts_list.SIZES) if _fits_beside(p)), None)
    list_ = list_ or parts_list.laid(rows, parts_list.SIZES[-1])
    pages = [arranged]
    listed = False
    for n, view in enumerate(views):
        label = f"{chr(ord('A') + n)}: {'exploded' if n == 0 else 'what the views before it do not number'}"
        with_list = list_ if not listed and _fits_beside(list_) else None
        page = _exploded_page(view, label, with_list, block)
        listed = listed or page[1]
        pages.append(page[0])
    if not listed:
        pages += _list_pages(list_)
    sheets = [_sheet(block, page, n + 1, len(pages)) for n, page in enumerate(pages)]
    for sheet in sheets:
        wrong = layout_faults(sheet)
        if wrong:
            raise CheckFailure(f"drawings: {block.number}: {'; '.join(wrong[:3])}; no drawing was written")
    return [preliminary(sheet) for sheet in sheets] if draft else sheets


@dataclass(frozen=True)
class _Page:
    """What a page has inside its frame, its scale as text, and what it is."""

    paper: Paper
    scale: str
    items: tuple[Item, ...]
    document_type: str


def _sheet(block: TitleBlock, page: _Page, number: int, count: int) -> Sheet:
    own = replace(block, scale=page.scale, sheet=number, sheets=count, document_type=page.document_type)
    items = (*frame(page.paper), *title_block(page.paper, own), *page.items)
    return Sheet(block.number, f"{block.title}, sheet {number} of {count}", page.paper.size, items)


def _title(design: Design, scene: Scene, draft: bool) -> TitleBlock:
    d = design.design
    return TitleBlock(
        legal_owner=d.organisation, number=f"{design.name}-{scene.name}", revision=d.revision, date=d.date,
        title=f"Assembly: {scene.name.replace('-', ' ')}", supplementary=d.title, creator=d.author, document_type="",
        status="draft" if draft else "for manufacture", scale="", material="see parts list", mass=sum(p.part.mass for p in scene.placements),
    )  # fmt: skip


# --- general arrangement: three views in first angle, overall dimensions, notes ---


def _arrangement(design: Design, scene: Scene, shapes: Mapping[str, TopoDS_Shape], block: TitleBlock) -> _Page:
    """Front, plan below it, view from the left to its right, at the largest scale that lying or upright A3 allows."""
    from tactcad.export.picture import View, drawing
    from tactcad.solids.place import placed_shape

    views = {
        "front": View("front", (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
        "plan": View("plan", (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
        "left": View("left", (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    }
    boxes = {name: projected_box(scene.placements, v.right, v.eye) for name, v in views.items()}
    size = {name: (b[2] - b[0], b[3] - b[1]) for name, b in boxes.items()}
    wide, high = size["front"][0] + size["left"][0], size["front"][1] + size["plan"][1]
    spare = APART + AROUND
    choices = [_with_notes(paper, notes_of(design, scene), block) for paper in (A3, A3_UPRIGHT)]
    scales = [
        largest_fitting(wide, high, (x1 - x0 - spare, y1 - y0 - spare), block.number) for _, _, (x0, y0, x1, y1) in choices
    ]
    best = max(range(len(choices)), key=lambda n: (factor(scales[n]), -n))
    paper, items, (x0, y0, x1, y1) = choices[best]
    f = factor(scales[best])
    west, south = (x0 + x1 - f * wide - spare) / 2 + AROUND, (y0 + y1 - f * high - spare) / 2
    north = south + f * size["plan"][1] + APART
    places = {"plan": (west, south), "front": (west, north), "left": (west + f * size["front"][0] + APART, north)}
    placed = [placed_shape(shapes[p.part.part_no], p.origin, p.rotation) for p in scene.placements]
    for name, view in views.items():
        (bx, by), (px, py) = boxes[name][:2], places[name]
        items += _edges(drawing(placed, view).sharp, f, (px - f * bx, py - f * by))
    for name, sides in (("front", ("top", "left")), ("plan", ("left",))):
        items += [moved(i, *places[name]) for i in _overall(size[name], f, sides)]
    return _Page(paper, shown(scales[best]), tuple(items), "Assembly drawing")


def _with_notes(paper: Paper, lines: Sequence[str], block: TitleBlock) -> tuple[Paper, list[Item], Box]:
    """The notes, on a lying sheet over the title block, on an upright one over its whole width; and where views may stand."""
    x0, y0, x1, y1 = paper.area
    lying = paper.width > paper.height
    room = (WIDTH if lying else x1 - x0) - 2 * MARGIN
    texts, high = notes((0.0, 0.0), lines, room)
    if high > y1 - y0 - HEIGHT - 2 * MARGIN:
        raise CheckFailure(f"drawings: {block.number}: the notes are higher than the sheet; no drawing was written")
    at = (x1 - WIDTH + MARGIN, y1 - MARGIN) if lying else (x0 + MARGIN, y0 + HEIGHT + MARGIN + high)
    left = (x0, y0, x1 - WIDTH, y1) if lying else (x0, at[1], x1, y1)
    return paper, [moved(t, *at) for t in texts], tuple(v + m for v, m in zip(left, (MARGIN, MARGIN, -MARGIN, -MARGIN)))


def _overall(size: tuple[float, float], f: float, sides: Sequence[str]) -> list[Item]:
    """Overall sizes of a view whose lower left corner is (0, 0), as auxiliary dimensions in parentheses."""
    w, h = size
    values = {"w": w, "h": h}
    items: list[Item] = []
    for side in sides:
        name, p, q = ("w", (0.0, h), (w, h)) if side in ("top", "bottom") else ("h", (0.0, 0.0), (0.0, h))
        dimension = Dimension(f"overall {name}", (Span(level("zero"), level(name)),), sign="(", unit=")")
        items += stacked(
            [Linear(dimension, side, p, q)], side, (0.0, 0.0, w * f, h * f), f, {**values, "zero": 0.0}, 10.0
        )
    return items


def _edges(lines: Sequence[Polyline], f: float, shift: tuple[float, float]) -> list[Stroke]:
    return [Stroke(tuple((x * f + shift[0], y * f + shift[1]) for x, y in line), EDGE) for line in lines]


# --- exploded views with item numbers ---


def _exploded_views(scene: Scene, rows: Sequence[BomRow], shapes: Mapping[str, TopoDS_Shape]) -> list[Exploded]:
    """Views until every item that has a solid has its number in one: the first shows all parts, each further one those
    that no earlier one has numbered."""
    from tactcad.export.picture import ABOVE

    item = {row.part_no: row.item for row in rows if row.has_solid}
    left = exploded(scene) if scene.steps else scene.placements
    views: list[Exploded] = []
    while left:
        view = _exploded_view(_fewer(left), item, shapes, ABOVE)
        if not view.own:
            raise CheckFailure(f"drawings: {scene.name}: {left[0].designator} is seen from nowhere; no drawing was written")
        views.append(view)
        left = tuple(p for p in left if item[p.part.part_no] not in view.own)
    return views


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


def _fewer(placements: Sequence[Placement]) -> tuple[Placement, ...]:
    """All of them, or where they are too many the first few of every part."""
    most = len(placements)
    while True:
        count: dict[str, int] = {}
        kept = []
        for p in placements:
            count[p.part.part_no] = count.get(p.part.part_no, 0) + 1
            if count[p.part.part_no] <= most:
                kept.append(p)
        if len(kept) <= MOST_DRAWN or most == 1:
            return tuple(kept)
        most = max(1, most // 2)


def _exploded_page(view: Exploded, label: str, list_: parts_list.Laid | None, block: TitleBlock) -> tuple[_Page, bool]:
    """The view at the largest scale at which its balloons find places; beside the parts list where that costs no scale.

    Also whether the list stands on it.
    """
    bx0, by0, bx1, by1 = view.box
    choices = [(A3, True), (A3, False), (A3_UPRIGHT, False)] if list_ else [(A3, False), (A3_UPRIGHT, False)]
    for scale in SERIES:
        f = factor(scale)
        for paper, with_list in choices:
            area = _room(paper, with_list)
            if (bx1 - bx0) * f + 2 * RIM > area[2] - area[0] or (by1 - by0) * f + 2 * RIM > area[3] - area[1]:
                continue
            shift = ((area[0] + area[2] - (bx0 + bx1) * f) / 2, (area[1] + area[3] - (by0 + by1) * f) / 2)
            edges = _edges(view.lines, f, shift)
            own = {n: [e.points for e in _edges(lines, f, shift)] for n, lines in view.own.items()}
            found = balloons.place(own, [e.points for e in edges], area)
            if not found:
                continue
            items: list[Item] = [*edges, *balloons.drawn(found)]
            items.append(Text((area[0] + MARGIN, area[3] - MARGIN - 3.5), label, 3.5))
            if with_list:
                items += parts_list.drawn(list_, range(len(list_.cells)), (paper.area[2] - WIDTH, paper.area[3]))[0]
            kind = "Assembly drawing, parts list" if with_list else "Assembly drawing"
            return _Page(paper, shown(scale), tuple(items), kind), with_list
    w, h = bx1 - bx0, by1 - by0
    raise CheckFailure(
        f"drawings: {block.number}: an exploded view of {w:.0f} x {h:.0f} mm with {len(view.own)} item numbers finds no place "
        f"on {A3.name} at {shown(SERIES[0])} to {shown(SERIES[-1])}; no drawing was written"
    )


def _room(paper: Paper, with_list: bool) -> Box:
    """Where an exploded view may stand: left of the list, else left of or over the title block, whichever is larger."""
    x0, y0, x1, y1 = paper.area
    beside, over = (x0, y0, x1 - WIDTH, y1), (x0, y0 + HEIGHT, x1, y1)
    if with_list or (beside[2] - beside[0]) * (beside[3] - beside[1]) > (over[2] - over[0]) * (over[3] - over[1]):
        return beside
    return over


# --- the parts list ---


def _fits_beside(list_: parts_list.Laid) -> bool:
    """Whether the whole list stands over the title block of an A3 sheet."""
    _, y0, _, y1 = A3.area
    return list_.total + parts_list.heading(list_.size) <= y1 - y0 - HEIGHT


def _list_pages(list_: parts_list.Laid) -> list[_Page]:
    """On A4 where one page is enough, else on upright A3."""
    room = {paper: paper.area[3] - paper.area[1] - HEIGHT for paper in (A4, A3_UPRIGHT)}
    paper = next((p for p in room if len(parts_list.pages(list_, room[p])) == 1), A3_UPRIGHT)
    at = (paper.area[2] - WIDTH, paper.area[3])
    return [
        _Page(paper, "", tuple(parts_list.drawn(list_, rows, at)[0]), "Parts list")
        for rows in parts_list.pages(list_, room[paper])
    ]
