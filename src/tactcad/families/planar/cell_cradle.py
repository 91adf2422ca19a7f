"""The calibration rig: a cradle that stands on three of its faces, and what hangs weights on one pad.

      +--------------------------------+      array's frame: x to the right, y upwards
      |  heel, clamp |  o         o    |  pins on the array's +y side
      |   (o) [======|======array====| |
      |   (o) [======|===============| o  pin on its +x side
      +--------------------------------+
        stands on a table: beyond its edge

On its lower face, its +x and its +y face the same weight pulls along z, x and y. A cap slips over one pad:
the hanger's nib stands in its dimple, the link hangs in its groove, level with the pad.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, hypot, sqrt

import numpy as np

from tactcad.contour import Corner, circle, rectangle, rounded_polygon
from tactcad.design.fields import present
from tactcad.design.materials import ALLOYS
from tactcad.parts.bought.screws import CAP_SCREW_LENGTHS
from tactcad.parts.bought.standard_parts import dowel_diameter, dowel_lengths
from tactcad.parts.language.description import Extrusion, Hole, Part, Pocket, Revolution
from tactcad.parts.language.limits import FACES, Characteristic, Geometric, within
from tactcad.parts.language.metric import METRIC, tapped_blind
from tactcad.parts.language.stock import PLACE, STAINLESS, bar_material, plate_material

from . import cell_board, parts
from .cell_layout import PlanarLayout
from .parts import SCREW, Places, bored, milled, screw_places

PIN, CLAMP_SCREW = "3", "M3"
THICK = 25.0  # mm, cradle: it stands on its sides
BESIDE, OVER_HEADS = 6.0, 3.0  # mm of cradle beyond the array at the pins, and on the other side of it
LEAST_LENGTH = 60.0  # mm, cradle; chosen: two fingers hold it down
HEEL, BAR = 10.0, 4.0  # mm: heel's width, clamp's thickness
SCREW_OFF = 5.5  # mm from the array's edge to the clamp's screws
HEEL_LOWER = 0.1  # mm by which the heel is lower than the array, so that the clamp presses the array
HEAD_ROOM, HEAD_DEPTH = 0.8, 3.0  # mm around and below the heads of the array's screws
PIN_SHORT = 0.5  # mm that the pins end below the cover
PIN_ZONE = 0.02  # mm, of their holes; chosen: as a jig borer places the array's own
BORE_PLAY, BORE_FIELD = 0.005, 0.01  # mm: cap on the largest pad, field of its bore
# mm: wall at the groove; top over the pad; dimple's depth and radius; cap over the cover
CAP_WALL, CAP_TOP, DIMPLE, CAP_OFF = 0.35, 1.2, 0.5, 0.2
SHEET = 0.5  # mm, aluminium of link and hanger; chosen: flat in the hand, and sold
LEG, RAIL, NIB = 1.0, 3.0, 0.15  # mm: link's legs, hanger's rails, radius of the nib
INSIDE = 0.3  # mm, inside corners of sheets; chosen: twice what the wire leaves
PASSES = 0.2  # mm by which the link's window is wider than the cap, all round
EYE, TAIL = 1.5, 5.0  # mm: hole for the pan's hook, tail that carries it
CLEAR = 3.0  # mm that hangers keep from what they pass
LIFTED = 1.0  # mm that the hanger is lifted while it passes the cap
PLUG = (15.0, 6.0)  # mm over the board, along y: pin header with its plug; chosen: usual ones


def clear_of(layout: PlanarLayout, at: tuple[float, float]) -> bool:
    """Whether a pin there leaves a wall to the rooms of the array's screw heads."""
    room = (METRIC[SCREW].head + HEAD_ROOM + float(PIN)) / 2.0 + 0.8
    return all(hypot(at[0] - x, at[1] - y) >= room for x, y in screw_places(layout))


@dataclass(frozen=True)
class CradleLayout:
    """Places in the array's frame, mm."""

    layout: PlanarLayout

    @property
    def seat(self) -> float:
        """z of the array's lower face."""
        return round(self.layout.board_z - self.layout.design.hall.board, 9)

    @property
    def cover_top(self) -> float:
        return round(self.layout.cover_z + self.layout.design.housing.cover_thickness, 9)

    @property
    def height(self) -> float:
        """Of the array at its clamp."""
        return round(self.cover_top - self.seat, 9)

    @property
    def tongue(self) -> float:
        return cell_board.tongue(self.layout)

    @property
    def zone(self) -> float:
        """Of the cradle's feet and seat, mm."""
        return present(self.layout.design.calibration).squareness

    @property
    def screw_y(self) -> float:
        return max(round(self.layout.half[1] - 5.0, 3), 5.0)

    @cached_property
    def box(self) -> tuple[float, float, float, float]:
        """Cradle: least x and y, largest x and y."""
        (hx, hy), wide = self.layout.half, self.screw_y + 4.0
        x1 = hx + BESIDE
        return (
            round(x1 - max(LEAST_LENGTH, ceil(4.0 * hx + 16.0)), 9),
            round(-max(hy + OVER_HEADS, wide), 9),
            round(x1, 9),
            round(max(hy + BESIDE, wide), 9),
        )

    @cached_property
    def pins(self) -> Places:
        """Middles of the pins: two as far apart as can be on the +y side, one near the middle of +x."""
        (hx, hy), r = self.layout.half, float(PIN) / 2.0 + 0.01  # its largest radius is less
        along = [x for x in np.arange(hx - 3.0, 0.0, -0.5) if clear_of(self.layout, (x, hy + r))]
        up = [s * y for y in np.arange(0.0, hy, 0.5) for s in (1.0, -1.0)]
        x = round(float(along[0]), 3) if along else 0.0
        y = next((round(float(y), 3) for y in up if clear_of(self.layout, (hx + r, y))), 0.0)
        return (-x, hy + r), (x, hy + r), (hx + r, y)

    @property
    def pin_length(self) -> float:
        """At least twice its diameter in the cradle."""
        least = self.height - PIN_SHORT + 2.0 * float(PIN)
        return next(n for n in dowel_lengths(PIN) if n >= least)

    @property
    def pin_depth(self) -> float:
        return round(self.pin_length - self.height + PIN_SHORT, 9)

    @property
    def clamp_screw(self) -> float:
        """Length: engages one diameter at least."""
        least = self.height - HEEL_LOWER + BAR + METRIC[CLAMP_SCREW].d
        return next(n for n in CAP_SCREW_LENGTHS[CLAMP_SCREW] if n >= least)

    @property
    def lip(self) -> float:
        """Of the clamp on the cover, clear of a link on the cells beside it."""
        room = self.layout.half[0] + self.layout.elements[0].x - self.arc - LEG - 0.2
        return float(round(min(2.0, room), 3))

    # --- cap, link, hanger ---

    @property
    def bore(self) -> Characteristic:
        low = round(self.layout.design.post.pad + BORE_PLAY, 6)
        return Characteristic("bore diameter", low, round(low + BORE_FIELD, 6), low, between=("bore",))

    @property
    def groove(self) -> float:
        """Radius of the groove's bottom."""
        return round(self.bore.nominal / 2.0 + CAP_WALL, 9)

    @property
    def cap(self) -> float:
        """Radius of the cap: flanks at 45 degrees, as deep as half the link is thick and 0.1 mm."""
        return round(self.groove + SHEET / 2.0 + 0.1, 9)

    @property
    def hung(self) -> float:
        """Radius at which the link's edges lie on the groove's flanks."""
        return round(self.groove + SHEET / 2.0, 9)

    @property
    def arc(self) -> float:
        """Inner radius of the link, half of its window's width: it passes the cap."""
        return round(self.cap + PASSES, 9)

    @property
    def sunk(self) -> float:
        """From the cap's axis down to the middle of the link's arc."""
        return round(self.arc - self.hung, 9)

    @property
    def tip(self) -> float:
        """z of the hanger's nib: its edge of SHEET's length touches the dimple with both ends."""
        return round(self.layout.pad_z + CAP_TOP - DIMPLE + SHEET / 2.0, 9)


def array(rig: CradleLayout) -> Part:
    """The finished array as it lies in the cradle: its housing and pads; z = 0 their faces, down."""
    layout, (hx, hy) = rig.layout, rig.layout.half
    d, outline = layout.design, rectangle(-hx, -hy, hx, hy)
    pads = tuple(circle((e.x, e.y), d.post.pad) for e in layout.elements)  # their pattern is even in y
    body = Extrusion(outline, round(layout.pad_z - rig.seat, 9))
    around = (Pocket("pads", (0, 0, 0), (0, 0, 1), (1, 0, 0), outline, d.post.stand_out, pads),)
    name, made_of = f"{d.name}-finished", plate_material(d)
    return Part(name, "Array, finished", "reference", made_of, body, around, "#7c8794")


def head(rig: CradleLayout) -> Part:
    """The head of one of the array's screws, z = 0 its end."""
    m, name = METRIC[SCREW], rig.layout.design.name
    body = Extrusion(circle((0.0, 0.0), m.head), m.head_height)
    return Part(f"{name}-screw-head", "Head of a screw of the array", "reference", STAINLESS, body)


def tongue(rig: CradleLayout) -> Part:
    """The board beyond the housing."""
    (hx, hy), d = rig.layout.half, rig.layout.design
    body, made_of = Extrusion(rectangle(-hx, -hy - rig.tongue, hx, -hy), d.hall.board), cell_board.GLASS_EPOXY
    return Part(f"{d.name}-tongue", "Board's tongue", "reference", made_of, body, colour="#3f6b4b")


def plug(rig: CradleLayout) -> Part:
    """The header with its plug, z = 0 on the board."""
    wide, deep = cell_board.PIN * (2 * rig.layout.design.hall.buses + 2) / 2.0, PLUG[1] / 2.0
    body = Extrusion(rectangle(-wide, -deep, wide, deep), PLUG[0])
    name = f"{rig.layout.design.name}-plug"
    return Part(name, "Plug on the header", "reference", cell_board.PACKAGE, body, colour="#2b2d31")


def cradle(rig: CradleLayout) -> Part:
    """The block; its frame is the array's, turned half around z: lower and left edge are its feet.

    z = 0 is its lower face, the foot for loads along z; the array lies on the upper one.
    """
    x0, y0, x1, y1 = rig.box
    layout, square = rig.layout, rig.zone
    wide, deep, fit = dowel_diameter(PIN), round(rig.pin_depth + 1.0, 9), parts.PRESSED
    pin = Hole("pin_hole", (0, 0, 0), (0, 0, -1), wide, deep, False, drill_point=True, tolerance=fit)
    head = Hole("head", (0, 0, 0), (0, 0, -1), METRIC[SCREW].head + HEAD_ROOM, HEAD_DEPTH, False)
    full = round(rig.clamp_screw - rig.height + HEEL_LOWER - BAR + 1.0, 9)
    thread = tapped_blind("clamp", CLAMP_SCREW, (0, 0, 0), (0, 0, -1), full)
    places = ((pin, rig.pins), (head, screw_places(layout)), (thread, clamp_screws(rig)))
    holes = [replace(hole, at=(-x, -y, THICK)) for hole, some in places for x, y in some]
    zones = {"pin_hole": PIN_ZONE, "head": 2.0 * PLACE, "clamp": PLACE}
    notes = (
        "feet: lower face, left edge and lower edge; engrave z, x and y on the faces opposite",
        "pin holes masked when anodising",
    )
    flat = (
        Geometric("seat", "parallelism", square, (FACES[1],), ("A",)),
        Geometric("foot x", "perpendicularity", square, ("left edge",), ("A",)),
        Geometric("foot y", "perpendicularity", square, ("lower edge",), ("A", "B")),
    )
    body, bores = Extrusion(rectangle(-x1, -y1, -x0, -y0), THICK), (parts.pin_bore(PIN),)
    return milled(layout, "cradle", "Calibration cradle", body, holes, zones, notes, bores, flat)


def clamp_screws(rig: CradleLayout) -> Places:
    x = round(-rig.layout.half[0] - SCREW_OFF, 9)
    return ((x, -rig.screw_y), (x, rig.screw_y))


def _bar(rig: CradleLayout, number: str, name: str, x1: float, thickness: float) -> Part:
    """A bar over the clamp's screws, x from the array's edge."""
    y, places = round(rig.screw_y + 4.0, 9), [(-SCREW_OFF, s * rig.screw_y) for s in (-1, 1)]
    holes = bored("screw", places, METRIC[CLAMP_SCREW].clearance, thickness)
    body = Extrusion(rectangle(-HEEL - 0.5, -y, x1, y), thickness)
    return milled(rig.layout, number, name, body, holes, {"screw": PLACE})


def heel(rig: CradleLayout) -> Part:
    """Under the clamp, lower than the array by HEEL_LOWER."""
    return _bar(rig, "clamp-heel", "Clamp's heel", -0.5, round(rig.height - HEEL_LOWER, 9))


def clamp(rig: CradleLayout) -> Part:
    """On the cover's border."""
    return _bar(rig, "clamp", "Calibration clamp", rig.lip, BAR)


def cap(rig: CradleLayout) -> Part:
    r"""A turned cap; z = 0 is the floor of its bore, which lies on the pad.

     __   __
    |  \ /  |    dimple for the hanger's nib
     >     <     groove for the link, level with the floor
    | |   | |    skirt around the pad
    """
    b, g, c = rig.bore.nominal / 2.0, rig.groove, rig.cap
    v, k = round(c - g, 9), round(rig.layout.design.post.stand_out - CAP_OFF, 9)  # flank, skirt
    points = [(0.0, 0.0), (b, 0.0), (b, -k), (c, -k), (c, -v), (g, 0.0), (c, v), (c, CAP_TOP)]
    points += [(DIMPLE, CAP_TOP), (0.0, round(CAP_TOP - DIMPLE, 9))]
    names = "floor, bore, skirt end, skirt, lower flank, upper flank, side, top, dimple, axis".split(", ")
    return Part(
        part_no=f"{rig.layout.design.name}-cap",
        name="Calibration cap",
        process="turned",
        material=bar_material(rig.layout.design),
        body=Revolution(rounded_polygon([Corner(p, 0.0, n) for p, n in zip(points, names)])),
        colour="#d8b45a",
        notes=(
            "turned in one clamping; dimple and groove run true to the bore within 0.02",
            "groove's middle level with the bore's floor within 0.02",
            "no burrs; a scratch on the skirt's side marks how it is turned",
        ),
        characteristics=(rig.bore, within("bore depth", k, 0.02, between=("skirt end", "floor"))),
        spares=1,
    )


def link(rig: CradleLayout) -> Part:
    """Hangs in the cap's groove and passes the posts below on both sides; the pan's hook goes into its eye.
    Origin: its arc's middle; y upwards."""
    (hx, hy), first, r = rig.layout.half, rig.layout.elements[0], rig.arc
    low = -ceil(max(hx - first.x, hy - first.y) + BESIDE + CLEAR)  # from any cell beyond the array
    o = round(r + LEG, 9)
    window = [Corner((r, r), r), Corner((-r, r), r), Corner((-r, low), INSIDE), Corner((r, low), INSIDE)]
    return _sheet(rig, "link", "Calibration link", (o, o, round(low - LEG, 9)), o, window)


def hanger(rig: CradleLayout) -> Part:
    """Stands with its nib in the cap's dimple, around array and cradle; the pan's hook goes into its eye.
    Origin: the nib's end; y upwards."""
    _, y0, _, y1 = rig.box
    plug = rig.layout.board_z + PLUG[0] if rig.tongue else 0.0
    up = round(max(2.5, plug + 1.0 - rig.tip), 3)  # the rail over the nib passes the board's plug
    # on any cell its legs pass cradle and tongue, its lower rail the cradle
    a = ceil(max(y1, -y0, rig.layout.half[1] + rig.tongue) - rig.layout.elements[0].y + CLEAR)
    low = -ceil(rig.tip - rig.seat + THICK + LIFTED + CLEAR)
    ends = (a + RAIL, round(up + RAIL, 9), round(low - RAIL, 9))
    blunt = NIB * (sqrt(5.0) - 1.0)  # the arc takes that off a wedge half as wide as high
    half = (up + blunt) / 2.0
    points = ((a, up), (half, up), (0.0, -blunt), (-half, up), (-a, up), (-a, low), (a, low))
    window = [Corner(p, INSIDE if p[0] else NIB) for p in points]
    return _sheet(rig, "hanger", "Calibration hanger", ends, 0.0, window)


def _sheet(
    rig: CradleLayout, number: str, name: str, ends: tuple[float, ...], radius: float, window: list[Corner]
) -> Part:
    """A sheet with a window, and an eye in the tail at its lower end; its half width, top and end, mm."""
    wide, top, end = ends
    tab, low = round(EYE / 2.0 + 1.0, 9), end - TAIL
    points = [(wide, top), (-wide, top), (-wide, end), (-tab, end), (-tab, low), (tab, low), (tab, end)]
    radii = (radius, radius, 0.0, INSIDE, 0.0, 0.0, INSIDE, 0.0)
    outer = rounded_polygon([Corner(p, r) for p, r in zip([*points, (wide, end)], radii)])
    d = rig.layout.design
    return Part(
        part_no=f"{d.name}-{number}",
        name=name,
        process="wire-cut",
        material=replace(bar_material(d), standard=ALLOYS[d.plate_alloy].standard),
        body=Extrusion(outer, SHEET, (rounded_polygon(window),)),
        features=tuple(bored("eye", [(0.0, round(low + 1.0 + EYE / 2.0, 9))], EYE, SHEET)),
        colour="#b8c4d0",
        notes=("flat, free of burrs", "even about its middle line within 0.1"),
        characteristics=(within("thickness", SHEET, 0.03, between=FACES),),
    )
