"""Views of a scene's parts with their item numbers: exploded, whole or sub-assembly by sub-assembly; as the
last resort, where an exploded view would be too large or too crowded, one of each side by side, at a scale of
its own that fills the sheet.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from string import ascii_uppercase
from typing import TYPE_CHECKING

from tactcad.design.messages import CheckFailure
from tactcad.scenes.bom import BomRow
from tactcad.scenes.scene import Placement, Scene

from ..engine.boxes import Box, Point, Polyline, bounds_of, box_of, grown
from ..engine.ink import Item, Stroke, Text
from ..engine.paper import (
    A3,
    ASSEMBLIES,
    EDGE,
    MARGIN,
    Page,
    Scale,
    TitleBlock,
    factor,
    fewer,
    largest_fitting,
    shown,
)
from ..guide import exploded
from . import balloons
from .apart import Piece, pieces_of, pulled_apart
from .balloons import RADIUS, SHORTEST, Balloon
from .exploded import (
    Exploded,
    UnitView,
    alike,
    exploded_page,
    exploded_view,
    lengths_alone,
    room,
    seen_of_pieces,
    total_length,
    unit_views,
)

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

GAP = 0.06  # least distance in an exploded view, as a share of the exploded assembly's largest extent
GAP_OF_UNITS = 0.2  # and if all of its pieces are sub-assemblies
SEEN = 0.5  # a part counts as seen where this share of its edges is
WELL = 0.8  # leaders go to parts that are seen nearly as well as the best-seen equal part
FARTHER = (2.0, 4.0, 8.0, 16.0)  # times that distance, for parts that are not seen
CELL_GAP = 6.0  # between cells, mm of paper
OVER = 2 * RADIUS + 2 * SHORTEST  # for a part's balloon
UNDER = 5.0  # for its scale
LARGEST_SIDES = tuple(range(150, 15, -5))  # tried for the larger side of every part, mm of paper


def numbered_pages(
    scene: Scene,
    rows: Sequence[BomRow],
    shapes: Mapping[str, TopoDS_Shape],
    list_: balloons.Laid | None,
    block: TitleBlock,
) -> tuple[list[Page], bool]:
    """Views in which every item that has a solid is numbered once, and whether the parts list is next to one.

    A scene of several sub-assemblies is taken apart one by one; others in one view. Items that these do not
    show follow in further views; if an exploded view would be too large or too crowded, the parts are drawn
    side by side.
    """
    from ..engine.picture import ABOVE

    item = {row.part_no: row.item for row in rows if row.has_solid}
    pages: list[Page] = []
    where: dict[int, str] = {}  # item -> the view that numbers it
    listed = False

    def add(view: Exploded, title: str, further: Sequence[str], letters: Sequence[str], small: bool) -> bool:
        """A page for the view, if it finds room: it numbers the items not numbered before."""
        nonlocal listed
        fresh = view.labelled(lambda label: label in letters or label not in where)
        before = [f"{n} (see {where[n]})" for n in view.own if isinstance(n, int) and n in where]
        heading = (title, *further, *([f"Also here: {', '.join(before)}"] if before else []))
        made = exploded_page(fresh, heading, None if listed else list_, small) if fresh.own else None
        if made:
            pages.append(made[0])
            listed = listed or made[1]
            letter = title.partition(":")[0]
            where.update({label: letter for label in fresh.own if isinstance(label, int)})
        return made is not None

    views = unit_views(scene)
    titles = {view.letter: view.title for view in views}
    for unit in views:
        letters = [piece.letter for piece in unit.pieces if piece.letter]
        add(
            _taken_apart(unit, item, shapes),
            f"{unit.letter}: {unit.title}, exploded",
            [f"{n}: {titles[n]}" for n in letters],
            letters,
            True,
        )
    left = scene.placements if views or not scene.steps else exploded(scene)
    letter = len(views)
    while left := tuple(p for p in left if item[p.part.part_no] not in where):
        pieces = pieces_of(scene, fewer(left)) if views else [Piece((p,)) for p in fewer(left)]
        if views:
            pieces = pulled_apart(scene, pieces, GAP * _extent(pieces), {})
        view = exploded_view(pieces, seen_of_pieces(pieces, shapes, ABOVE), item)
        what = "what the views before it do not number" if pages else "exploded"
        if not add(view, f"{ascii_uppercase[letter]}: {what}", (), (), bool(pages)):
            return pages + _family_pages(left, item, shapes, block), listed
        letter += 1
    return pages, listed


def _taken_apart(unit: UnitView, item: Mapping[str, int], shapes: Mapping[str, TopoDS_Shape]) -> Exploded:
    """The unit exploded; hardly visible parts are pulled out farther if that shows more of them."""
    from ..engine.picture import ABOVE

    if not unit.pieces:
        pieces = [Piece((p,)) for p in fewer(exploded(unit.scene))]
        return exploded_view(pieces, seen_of_pieces(pieces, shapes, ABOVE), item)
    drawn = {p.designator for p in fewer([p for piece in unit.pieces for p in piece.placements])}
    thinned = [
        replace(piece, placements=tuple(p for p in piece.placements if p.designator in drawn))
        for piece in unit.pieces
    ]
    pieces = [piece for piece in thinned if piece.placements]
    gap = (GAP_OF_UNITS if all(piece.letter for piece in pieces) else GAP) * _extent(pieces)
    alone = lengths_alone(pieces, shapes, ABOVE)
    more: dict[int, float] = {}
    tried = []
    for farther in FARTHER:
        moved = pulled_apart(unit.scene, pieces, gap, more)
        seen = seen_of_pieces(moved, shapes, ABOVE)
        shares = [total_length(some) / whole for some, whole in zip(seen, alone)]
        hidden = [n for n, best in enumerate(_best_of_alike(pieces, shares)) if best < SEEN]
        tried.append((len(hidden), moved, seen, shares))
        if not hidden:
            break
        more.update({n: farther * gap for n in hidden})
    _, moved, seen, shares = min(tried, key=lambda one: one[0])
    well = {n for n, best in enumerate(_best_of_alike(pieces, shares)) if shares[n] >= WELL * best}
    return exploded_view(moved, seen, item, well)


def _best_of_alike(pieces: Sequence[Piece], shares: Sequence[float]) -> list[float]:
    """For each piece the largest share of its edges that is seen of any equal piece."""
    best: dict[tuple, float] = {}
    for piece, share in zip(pieces, shares):
        best[alike(piece)] = max(best.get(alike(piece), 0.0), share)
    return [best[alike(piece)] for piece in pieces]


def _extent(pieces: Sequence[Piece]) -> float:
    """The largest of length, width and height of all, mm."""
    boxes = [box_of(p) for piece in pieces for p in piece.placements]
    return max(float(max(b[1, k] for b in boxes) - min(b[0, k] for b in boxes)) for k in range(3))


def _family_pages(
    left: Sequence[Placement], item: Mapping[str, int], shapes: Mapping[str, TopoDS_Shape], block: TitleBlock
) -> list[Page]:
    """One of each part; the title block has the commonest scale of a page, parts at others say so."""
    from tactcad.solids.occt import placed_shape

    from ..engine.picture import ABOVE, drawing

    first = {item[p.part.part_no]: p for p in reversed(left)}
    own = {
        n: drawing([placed_shape(shapes[p.part.part_no], p.origin, p.rotation)], ABOVE).sharp
        for n, p in sorted(first.items())
    }
    x0, y0, x1, y1 = grown(room(A3, False), -MARGIN)
    y1 -= 8.0  # for the title
    made = side_by_side(own, (x0, y0, x1, y1))
    if not made:
        raise CheckFailure(
            f"drawings: {block.number}: a part does not fit A3 at {shown(ASSEMBLIES[-1])}; "
            "no drawing was written"
        )
    title = Text(
        (x0, y1 + 3.0),
        "One of each part, in the order of item numbers; scales other than the title block's are given below",
        3.5,
    )
    pages = []
    for page in made:
        main = Counter(part.scale for part in page).most_common(1)[0][0]
        items: list[Item] = [title, *(Stroke(line, EDGE) for part in page for line in part.lines)]
        items += balloons.drawn([part.balloon for part in page])
        items += [Text(part.below, shown(part.scale), 2.5, "middle") for part in page if part.scale != main]
        pages.append(Page(A3, shown(main), tuple(items), "Assembly drawing"))
    return pages


@dataclass(frozen=True)
class Shown:
    """A part on the page: its lines (mm of paper), its balloon, its scale, and the middle below it."""

    lines: tuple[Polyline, ...]
    balloon: Balloon
    scale: Scale
    below: Point


def side_by_side(own: Mapping[int, Sequence[Polyline]], area: Box) -> list[list[Shown]] | None:
    """The parts by number, at a scale that fits one page, or on as many as they need; None if a part is too
    large for the smallest scale."""
    best = None
    for size in LARGEST_SIDES:
        scales = {}
        for item, lines in own.items():
            x0, y0, x1, y1 = bounds_of(lines)
            if scale := largest_fitting(x1 - x0, y1 - y0, (size, size)):
                scales[item] = scale
        if len(scales) == len(own) and (laid := _laid(own, scales, area)):
            best = laid
            if len(laid) == 1:
                break
    return best


def _laid(
    own: Mapping[int, Sequence[Polyline]], scales: Mapping[int, Scale], area: Box
) -> list[list[Shown]] | None:
    """The parts in rows from the left, below each other; None if one is too large for the area."""
    x0, y0, x1, y1 = area
    cells: dict[int, tuple[float, float]] = {}  # with its balloon, its scale and the gap
    for item, lines in own.items():
        (_, low, _, high), f = bounds_of(lines), factor(scales[item])
        left, right = _sides(lines, f)
        cells[item] = (right - left + CELL_GAP, (high - low) * f + OVER + UNDER + CELL_GAP)
    if any(w > x1 - x0 or h > y1 - y0 for w, h in cells.values()):
        return None
    rows: list[list[int]] = [[]]
    for item, (w, _) in cells.items():
        if rows[-1] and sum(cells[n][0] for n in rows[-1]) + w > x1 - x0:
            rows.append([])
        rows[-1].append(item)
    filled: list[list[Shown]] = [[]]
    top = y1
    for row in rows:
        high = max(cells[item][1] for item in row)
        if top - high < y0:
            filled.append([])
            top = y1
        x = x0
        for item in row:
            lines, f = own[item], factor(scales[item])
            left, right = _sides(lines, f)
            dx, dy = x + CELL_GAP / 2 - left, top - high + CELL_GAP / 2 + UNDER - f * bounds_of(lines)[1]
            placed = tuple(tuple((u * f + dx, v * f + dy) for u, v in line) for line in lines)
            tip = _topmost(placed)  # the leader goes straight down to it
            balloon = Balloon(item, (tip[0], tip[1] + RADIUS + SHORTEST), tip)
            below = ((left + right) / 2 + dx, top - high + CELL_GAP / 2)
            filled[-1].append(Shown(placed, balloon, scales[item], below))
            x += cells[item][0]
        top -= high
    return filled


def _sides(lines: Sequence[Polyline], f: float) -> tuple[float, float]:
    """Left and right side of the part at its scale and the balloon over its topmost point."""
    x0, _, x1, _ = bounds_of(lines)
    tip = _topmost(lines)[0] * f
    return min(x0 * f, tip - RADIUS), max(x1 * f, tip + RADIUS)


def _topmost(lines: Sequence[Polyline]) -> Point:
    return max((p for line in lines for p in line), key=lambda p: (round(p[1], 6), -p[0]))
