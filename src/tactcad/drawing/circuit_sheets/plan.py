"""The leads' way, to scale."""

from __future__ import annotations

from collections.abc import Callable

from tactcad.parts.array.layout import ElementPlace, Layout
from tactcad.parts.array.leads import boards, lead_routes, leads
from tactcad.parts.array.supplies import wire_metres

from ..engine.ink import (
    LETTERS,
    THIN,
    VISIBLE,
    DrawnArc,
    Item,
    LineType,
    Point,
    Text,
    rectangle,
    segment,
    width,
)
from ..engine.paper import A3, HEIGHT, MARGIN, Page, notes

Place = Callable[[float, float], Point]  # mm of the array to mm of the paper
LEAD = LineType("lead", 0.35)
SCALES = (5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)  # ISO 5455
ONWARDS = 16.0  # mm of paper that a bundle is drawn beyond its tie
MARKS = 12.0  # mm of paper above the array for its marks


def plan_page(layout: Layout, says: list[str]) -> Page:
    """The page; `says` are its notes. The array lies with its rows' middle line upright."""
    d = layout.design
    half_x = layout.rear_end + d.wiring.gather
    half_y = layout.stack / 2
    x0, y0, x1, y1 = A3.area
    wide, high = x1 - x0 - 2 * MARGIN - 2 * (ONWARDS + 20.0), y1 - y0 - HEIGHT - 2 * MARGIN - MARKS
    f = next((s for s in SCALES if 2 * half_x * s <= wide and 2 * half_y * s <= high), SCALES[-1])
    middle = ((x0 + x1) / 2, y1 - MARGIN - MARKS - half_y * f)

    def on(x: float, y: float) -> tuple[float, float]:
        return (middle[0] + x * f, middle[1] - y * f)  # y runs down, as seen from below

    items: list[Item] = []
    ends = {p.number for p in (layout.elements[0], layout.elements[-1])}
    for route in lead_routes(layout):
        place = route.place
        items += _element(layout, place, on, d.array.pitch * f > LETTERS + 2 or place.number in ends)
        flat = [on(x, y) for x, y, _ in route.points[:3]]
        items += [segment(a, b, LEAD, "leader") for a, b in zip(flat, flat[1:]) if a != b]
        items.append(DrawnArc(flat[0], 0.6, line=VISIBLE, role="leader"))
    named: dict[float, float] = {}
    for board in boards(layout):
        side = 1.0 if board.places[0].row == 1 else -1.0
        tie = on(side * half_x, (board.places[0].y + board.places[-1].y) / 2)
        end = (tie[0] + side * ONWARDS, tie[1])
        items += [
            DrawnArc(tie, 1.2, line=VISIBLE, role="leader"),
            segment((tie[0] + side * 1.2, tie[1]), end, VISIBLE, "leader"),
        ]
        if abs(tie[1] - named.get(side, 1e9)) < 2 * LETTERS:
            continue  # a long row: those between are named in the list
        named[side] = tie[1]
        name = f"A{board.number}-J2"
        start = end[0] + side * 1.5 - (width(name, LETTERS) if side < 0 else 0.0)
        items.append(Text((start, tie[1] - LETTERS / 2), name, LETTERS))
    items += _marks(layout, on)
    scale = f"{f:g}:1" if f >= 1 else f"1:{1 / f:g}"
    said, _ = notes((x0 + MARGIN, y0 + HEIGHT), says, x1 - x0 - 180.0 - 3 * MARGIN)
    return Page(A3, scale, (*items, *said), "Wiring plan")


def plan_notes(layout: Layout) -> list[str]:
    w, count = layout.design.wiring, leads(layout)
    return [
        "Seen on the gauges' side",
        f"{count} leads an element, {w.wire}, {wire_metres(layout):g} m of each colour; cut lengths in the "
        f"wiring list, slack of {w.slack:.0%} in them",
        "Terminals lie in the recess, behind its wall (a), leads from there to the rear end (c); "
        "bonded from b to c, "
        f"{w.bonded:g} mm: strain relief",
        f"Tied {w.gather:g} mm behind (d), a bundle a board; from there {w.to_board:g} mm to the board, by "
        "the clamp on its plate (scene wiring)",
        "Number both ends of every lead; colours after IEC 60757",
    ]


def _element(layout: Layout, place: ElementPlace, on: Place, named: bool) -> list[Item]:
    side, sheet = (1.0 if place.row == 1 else -1.0), layout.design.sheet.thickness
    a = on(side * layout.pad_inner, place.y + sheet / 2)
    b = on(side * layout.rear_end, place.y - sheet / 2)
    hinge = on(side * place.hinge_x, place.y)[0]
    low, high = min(a[0], b[0]), max(a[0], b[0])
    items: list[Item] = [
        rectangle(low, a[1], high - low, b[1] - a[1], THIN, "outline"),
        segment((hinge, a[1]), (hinge, b[1]), THIN, "outline"),
    ]
    name = f"E{place.number}"
    room = abs(hinge - a[0])
    if named and room > width(name, LETTERS) + 1.0 and b[1] - a[1] > LETTERS + 1.0:
        items.append(Text(((hinge + a[0]) / 2, (a[1] + b[1]) / 2 - LETTERS / 2), name, LETTERS, "middle"))
    return items


def _marks(layout: Layout, on: Place) -> list[Item]:
    """Letters over the first row: recess, strain relief, rear end, tie."""
    rear, wiring = layout.rear_end, layout.design.wiring
    items: list[Item] = []
    last = 0.0
    for letter, x in zip("abcd", (layout.recess_start, rear - wiring.bonded, rear, rear + wiring.gather)):
        px, top = on(x, -layout.stack / 2)
        if px - last > 4.0:
            items.append(segment((px, top + 1.0), (px, top + 6.0), THIN, "leader"))
            items.append(Text((px, top + 7.0), letter, LETTERS, "middle"))
            last = px
    return items
