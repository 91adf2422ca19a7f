"""The parts of a planar array: foil, foot plates and posts, magnets, spacers, base, cover, board with its
chips.

   pad  __        __
 ______|  |______|  |______   cover, the screws' threads
|____  |  |  __  |  |  ____|  upper spacer
|____[foot]_|  |_[foot]____|  foil
|____  (m)  |__|  (m)  ____|  lower spacer, base with wells
|____|_____________________|
|______[chip]____[chip]____|  board
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from math import ceil
from typing import Any, Literal, cast

from tactcad.contour import Contour, Corner, circle, rectangle, rounded_polygon
from tactcad.parts.array.clamp import PRESS_FIT, pressed
from tactcad.parts.array.element import sheet_material
from tactcad.parts.array.measurements import MICROSCOPE, Measurement
from tactcad.parts.bought.screws import CAP_SCREW_LENGTHS
from tactcad.parts.bought.standard_parts import LEAST_PLAY, dowel_diameter, dowel_lengths, dowel_limits
from tactcad.parts.language.description import (
    Extrusion,
    Feature,
    Hole,
    Material,
    Part,
    Process,
    Purchase,
    Revolution,
)
from tactcad.parts.language.limits import FACES, Characteristic, Geometric, within
from tactcad.parts.language.metric import METRIC, tapped_through
from tactcad.parts.language.stock import ANODISED, BREAK_EDGES, FRAME, FRAME_DATUMS, PLACE, plate

from .cell_layout import CellPlace, Kind, PlanarLayout
from .cell_tables import FoilProcess

SCREW, DOWEL = "M2", "2"
LARGEST_STEP = 20.0  # mm between screws along an edge; chosen: what keeps 1 mm of base flat under them
POST_LENGTH, POST_TOLERANCE = "length over the shoulder", 0.01  # mm, plus and minus; chosen: a small lathe's
PAD = "pad side diameter"
PAD_FIELD = 0.02  # mm by which a pad may be smaller than drawn; chosen: a cap slips over it
SPIGOT = 0.01  # mm by which a post's spigot may be thinner than drawn; chosen, likewise
MAGNET_LIMIT = 0.02  # mm, plus and minus, of a magnet's sizes; chosen: ground, or picked by micrometer
SPIGOT_SHORT = 0.02  # mm that a spigot ends inside the foil; chosen
FOOT_THICKNESS = 0.02  # mm, plus and minus; chosen: precision strip
DOWEL_HOLE, PRESSED = "dowel hole diameter", f"{PRESS_FIT}, the pin pressed in"
# Zone of dowel holes and flatness of the stop face, mm: chosen, achievable by a jig borer and a fine mill in
# one clamping; field of a reamed hole: ISO 286, H8 of 1 to 3 mm; depth of the sunk lands, plus and minus:
# chosen.
PLATE_ZONE, STOP_FLAT, REAMED, LAND_DEPTH = 0.02, 0.01, 0.014, 0.01
EDGE = 0.01  # mm of straight edge between a foil's rounded corners; chosen: what its sheet can dimension
BORED = 0.05  # mm by which wells and posts' openings may be wider than drawn; chosen: a drill
FOOT_INSET = 0.03  # mm of island around its foot plate; chosen: the etching's tolerance
WEB = 0.8  # mm of base left over the chips' pocket, at least: checks/data/shop.toml's floor of a pocket
FRAME_CORNER = 0.5  # mm; chosen: a cutter of 1 mm, and room for the outer chips
COPPER = 1.4, 0.6  # mm of tracks and vias beyond the outer chips along x and y: cell_board.CLOSE
CHIP_ROOM = 0.2  # mm above and around a chip; chosen: soldered boards' usual tolerance
TABS = " on the upper and right edges, dressed flush"  # the others are datums, and lie on pins
SPRING_STEEL = Material("1.4310", 7900, "+C1300", "EN 10151")
NEODYMIUM = Material("NdFeB, nickel plated", 7500)
STAINLESS_BAR = Material("X8CrNiS18-9 (1.4305)", 7900, standard="EN 10088-3", magnetic="no")


Places = tuple[tuple[float, float], ...]


def screw_places(layout: PlanarLayout) -> Places:
    """Along the border, corners included, at most LARGEST_STEP apart; none for bonded layers."""
    if not layout.screwed:
        return ()
    x, y = (h - border / 2.0 for h, border in zip(layout.half, layout.borders))
    nx, ny = (max(1, ceil(2.0 * h / LARGEST_STEP)) for h in (x, y))
    along = [(-x + 2.0 * x * i / nx, s * y) for i in range(nx + 1) for s in (-1.0, 1.0)]
    up = [(s * x, -y + 2.0 * y * j / ny) for j in range(1, ny) for s in (-1.0, 1.0)]
    return tuple((round(u, 2), round(v, 2)) for u, v in along + up)


def dowel_places(layout: PlanarLayout) -> Places:
    """Two, midway between a corner's screw and the next one along x, at opposite corners; none for bonded
    layers."""
    if not layout.screwed:
        return ()
    x, y = (h - border / 2.0 for h, border in zip(layout.half, layout.borders))
    beside = x / max(1, ceil(2.0 * x / LARGEST_STEP))
    u, v = round(x - beside, 2), round(y, 2)
    return ((-u, -v), (u, v))


def stack_height(layout: PlanarLayout) -> float:
    """From the screws' heads to the cover, mm."""
    return layout.design.hall.board + layout.cover_z - layout.board_z


def screw_length(layout: PlanarLayout) -> float | None:
    """The longest ISO 4762 length that ends inside the cover; None if none engages one diameter."""
    cover, under = layout.design.housing.cover_thickness, stack_height(layout)
    fits = [n for n in CAP_SCREW_LENGTHS[SCREW] if METRIC[SCREW].d <= n - under <= cover]
    return max(fits, default=None)


def mounting(layout: PlanarLayout) -> tuple[float, float]:
    """The array's screws hold it on a machine too: the next length that is sold, mm, and how thick a plate
    it takes under the board; 0 if none is longer."""
    own = screw_length(layout) or 0.0
    longer = min((n for n in CAP_SCREW_LENGTHS[SCREW] if n > own), default=own)
    return longer, round(longer - own, 9)


def dowel_length(layout: PlanarLayout) -> float | None:
    """The longest ISO 8734 length between the base's lower and the cover's upper face."""
    room = base_plate(layout) + layout.cover_z - layout.base_z + layout.design.housing.cover_thickness
    return max((n for n in dowel_lengths(DOWEL) if n <= room), default=None)


def _plain(layout: PlanarLayout, thickness: float, openings: tuple[Contour, ...] = ()) -> Extrusion:
    """A layer as long and wide as the array."""
    x, y = layout.half
    return Extrusion(rectangle(-x, -y, x, y), thickness, openings)


def foil_zone(layout: PlanarLayout, process: FoilProcess) -> float:
    """Zone of the holes of a steel sheet as large as the foil, mm."""
    return process.place(2.0 * max(layout.half))


def dowel_bore(layout: PlanarLayout, process: FoilProcess | None, thickness: float) -> Characteristic:
    """Limits of the dowels' holes in a steel sheet of that process, None in a milled plate: the pair passes
    over the pins at the worst of its own and the base's positions."""
    zone = PLATE_ZONE if process is None else foil_zone(layout, process)
    least = dowel_limits(DOWEL)[1] + LEAST_PLAY + PLATE_ZONE + zone
    if process is None:
        low = _up(least)
        return Characteristic(DOWEL_HOLE, low, round(low + REAMED, 6), low, between=("dowel_hole",))
    cut = process.tolerance(thickness)
    return within(DOWEL_HOLE, _up(least + cut), cut, between=("dowel_hole",))


def pin_bore(pin: str) -> Characteristic:
    """Limits of a jig's holes that its pins are pressed into."""
    return replace(pressed(float(pin)), name="pin hole diameter", between=("pin_hole",))


def spigot_bore(layout: PlanarLayout, process: FoilProcess, thickness: float) -> Characteristic:
    """Limits of the hole for a post's spigot in a sheet: the thickest spigot passes the least hole."""
    cut = process.tolerance(thickness)
    nominal = _up(layout.design.post.spigot + LEAST_PLAY + cut)
    return within("spigot diameter", nominal, cut, between=("spigot",))


def _up(size: float) -> float:
    """To the next 0.005 mm."""
    return ceil(200.0 * size - 1e-6) / 200.0


def bored(
    name: str, places: Iterable[tuple[float, float]], diameter: float, depth: float, fit: str = ""
) -> list[Hole]:
    """Holes through a layer, along +z from its lower face."""
    return [Hole(name, (x, y, 0.0), (0, 0, 1), diameter, depth, True, tolerance=fit) for x, y in places]


def _through(layout: PlanarLayout, t: float, bore: Characteristic, tapped: bool = False) -> list[Feature]:
    """The screws' and dowels' holes of a layer, t thick; a press-fit hole is modelled as wide as the pin."""
    screws = bored("screw", screw_places(layout), METRIC[SCREW].clearance, t)
    if tapped:
        screws = [tapped_through("screw", SCREW, hole.at, (0, 0, 1), t) for hole in screws]
    wide, fit = round((bore.lower + bore.upper) / 2.0, 6), ""
    if bore.upper < bore.nominal:
        wide, fit = dowel_diameter(DOWEL), PRESSED
    return [*screws, *bored("dowel_hole", dowel_places(layout), wide, t, fit)]


def _stated(layout: PlanarLayout, *bores: Characteristic) -> tuple[Characteristic, ...]:
    """Limits of holes; none for dowels if no layer has them."""
    return tuple(c for c in bores if c.name != DOWEL_HOLE or layout.screwed)


def _placed(features: Sequence[Feature], zones: Mapping[str, float]) -> dict[str, Any]:
    """Geometric tolerances of holes by their names, and their datums; empty if there are no holes."""
    there = {f.name for f in features}
    places = tuple(
        Geometric(f"{name.replace('_', ' ')} holes", "position", zone, (name,), FRAME, True)
        for name, zone in zones.items()
        if name in there
    )
    return {"geometric": places, "datums": FRAME_DATUMS if places else ()}


def _sheet(
    layout: PlanarLayout,
    number: str,
    name: str,
    body: Extrusion,
    features: Sequence[Feature],
    limits: tuple[Characteristic, ...],
    colour: str,
    note: tuple[str, ...] = (),
    kind: Literal["", "element", "cells"] = "",
    material: Material = SPRING_STEEL,
) -> Part:
    """A part that is cut from a sheet by its contour; of a kind of all cells, its holes have their places."""
    process, t = layout.sheet_process(body.thickness), body.thickness
    cut, zone = process.tolerance(t), foil_zone(layout, process)
    low, high = (t / 2.0 / factor if factor else 0.0 for factor in reversed(process.etch_factor))
    return Part(
        part_no=f"{layout.design.name}-{number}",
        name=name,
        process=cast(Process, process.name),
        material=material,
        body=body,
        features=tuple(features),
        colour=colour,
        notes=(
            f"{process.name}; contour within ±{cut:.3g} of the DXF's unless a limit is given",
            *([f"expected undercut {low:.2g} to {high:.2g} a side"] if high else ()),
            *([f"{'tabs' if t < process.loose_from else 'tabs, if any,'}{TABS}"] if kind else ()),
            *note,
        ),
        characteristics=_stated(layout, *limits),
        kind=kind,
        **_placed(features if kind else (), {"spigot": zone, "dowel_hole": zone, "screw": PLACE}),
    )


def foil(layout: PlanarLayout) -> Part:
    """The foil: every cell's four slots, spigot, screw and dowel holes."""
    d, t, process = layout.design, layout.design.planar.thickness, layout.process
    slots = tuple(s for e in layout.elements for s in e.kind.slots(layout.corner, (e.x, e.y)))
    cut, bore, spigot = process.tolerance(t), dowel_bore(layout, process, t), spigot_bore(layout, process, t)
    holes = [*bored("spigot", layout.places, spigot.nominal, t), *_through(layout, t, bore)]
    limits = [within("thickness", t, d.foil_tolerance, True, between=FACES)]
    for k in layout.used:
        sides, ends = k.named("beam a", "beam b"), k.named("root", "frame")
        limits.append(within(f"beam width, {k.name}", k.table.beam_width, cut, True, sides))
        limits.append(within(f"beam length, {k.name}", k.beam_length, cut, between=ends))
    own, body = (*limits, spigot, bore), _plain(layout, t, slots)
    over = ("widths measured over the bevel",) if process.bevel else ()
    note = (*over, "do not bend, do not tumble; packed flat between cards")
    return _sheet(layout, "foil", "Foil", body, holes, own, "#c9ccd1", note, "element", sheet_material(d))


def foot(layout: PlanarLayout, kind: Kind) -> Part:
    """The plate that keeps an island rigid: its outline, a little inside, with the spigot's hole."""
    t = layout.design.post.foot
    bore = spigot_bore(layout, layout.sheet_process(t), t)
    body = Extrusion(kind.island_outline(layout.sheet_corner(t), FOOT_INSET), t)
    hole = bored("spigot", [(0.0, 0.0)], bore.nominal, t)
    own = (within("thickness", t, FOOT_THICKNESS, between=FACES), bore)
    name, colour = f"Foot plate, {kind.name} cell", "#8f9aa8" if kind.name == "measuring" else "#5b6673"
    note = ("plates of both kinds from one strip: the posts stand on them",)
    return _sheet(layout, f"foot-{kind.name}", name, body, hole, own, colour, note)


def post(layout: PlanarLayout) -> Part:
    """A turned post: spigot through foot plate and foil, shoulder on the foot plate, pad on top; z = 0 its
    shoulder."""
    d = layout.design
    shoulder = d.planar.thickness + d.post.foot
    up, down = round(layout.pad_z - shoulder, 9), round(-shoulder + SPIGOT_SHORT, 9)
    pad, spigot = d.post.pad, d.post.spigot
    r, s = pad / 2.0, spigot / 2.0
    points = [(0.0, down), (s, down), (s, 0.0), (r, 0.0), (r, up), (0.0, up)]
    names = ("end", "spigot", "shoulder", "pad side", "pad", "axis")
    return Part(
        part_no=f"{d.name}-post",
        name="Post",
        process="turned",
        material=STAINLESS_BAR,
        body=Revolution(rounded_polygon([Corner(p, 0.0, n) for p, n in zip(points, names)])),
        colour="#d8d3c4",
        notes=(BREAK_EDGES.replace("0.2", "0.05"), "pad's edge 0.1 round", "turned in one clamping"),
        characteristics=(
            within(POST_LENGTH, up, POST_TOLERANCE, between=("shoulder", "pad")),
            Characteristic(PAD, pad, pad, round(pad - PAD_FIELD, 6), between=("pad side",)),
            Characteristic("spigot diameter", spigot, spigot, spigot - SPIGOT, between=("spigot",)),
        ),
    )


def magnet(layout: PlanarLayout) -> Part:
    """A disc magnet, its upper face at z = 0."""
    m = layout.design.magnet
    what = f"disc magnet {m.diameter:g} x {m.height:g} mm, each ±{MAGNET_LIMIT:g}, axial"
    return Part(
        part_no=f"MAGNET-{m.diameter:g}x{m.height:g}",
        name=f"Disc magnet {m.diameter:g}x{m.height:g}",
        process="bought",
        material=NEODYMIUM,
        body=Extrusion(circle((0, 0), m.diameter), m.height),
        colour="#9aa0a8",
        purchase=Purchase(f"{what}, remanence {m.remanence:g} T"),
        spares=max(1, len(layout.elements) // 10),
    )


def _rounded(x: float, y: float, radius: float, at: tuple[float, float] = (0.0, 0.0)) -> Contour:
    """A rectangle 2 x by 2 y about a point, with rounded corners."""
    signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return rounded_polygon(
        [Corner((round(at[0] + sx * x, 9), round(at[1] + sy * y, 9)), radius) for sx, sy in signs]
    )


def _spacer(layout: PlanarLayout, where: str, t: float, limit: float, key: bool) -> Part:
    """A frame with the openings of the foil's cells, which clamps the foil's webs."""
    half, corner = layout.kinds["measuring"].opening / 2.0, layout.sheet_corner(t)
    openings = tuple(_rounded(half, half, corner, at) for at in layout.places)
    bore = dowel_bore(layout, layout.sheet_process(t), t)
    own = (within("thickness", t, limit, key, between=FACES), bore)
    body, holes = _plain(layout, t, openings), _through(layout, t, bore)
    number, name, note = f"{where}-spacer", f"{where.capitalize()} spacer", ("flat, free of burrs",)
    return _sheet(layout, number, name, body, holes, own, "#aab2bd", note, "cells")


def lower_spacer(layout: PlanarLayout) -> Part:
    """Its thickness is the way of every island down to its stop."""
    d = layout.design
    return _spacer(layout, "lower", -layout.base_z, d.tolerance.stop_gap / 2.0, True)


def upper_spacer(layout: PlanarLayout) -> Part:
    return _spacer(layout, "upper", layout.upper_spacer, 0.03, False)


def milled(
    layout: PlanarLayout,
    number: str,
    name: str,
    body: Extrusion,
    features: Sequence[Feature],
    zones: Mapping[str, float],
    notes: tuple[str, ...] = (),
    bores: tuple[Characteristic, ...] = (),
    flat: tuple[Geometric, ...] = (),
) -> Part:
    finish = ANODISED + ("; dowel holes masked" if layout.screwed else "")
    own = (within("thickness", body.thickness, 0.02, between=FACES), *_stated(layout, *bores))
    marks, said = _placed(features, zones), (BREAK_EDGES, *notes)
    places = (*marks["geometric"], *flat)
    return plate(layout.design, number, name, body, features, finish, "#7c8794", said, own, places)


def chip_room(layout: PlanarLayout) -> float:
    """Height of the frame around the chips, mm."""
    return round(layout.chip.height + CHIP_ROOM, 9)


def base_plate(layout: PlanarLayout) -> float:
    """Thickness of the base over the frame, mm."""
    return round(layout.base_thickness - chip_room(layout), 9)


def base(layout: PlanarLayout) -> Part:
    """The islands' stop, with a well around every magnet, sunk under the kind of cell with the longer way;
    z = 0 its lower face."""
    t = base_plate(layout)
    wide = round(layout.design.planar.pitch - WEB, 9)  # a sunk land: WEB stays between neighbours
    well = round(layout.design.magnet.diameter + 2.0 * layout.design.housing.well, 9)
    wells: list[Feature] = []
    for e in layout.elements:
        lower = round(e.kind.table.stop_gap + layout.base_z, 9)
        land = (wide, lower) if sunk(layout, e.kind) else None
        name = f"well_{e.kind.name}"
        wells.append(Hole(name, (e.x, e.y, t), (0, 0, -1), well, t, True, counterbore=land))
    bore = pressed(float(DOWEL))
    names = [f"well_{kind.name}" for kind in layout.used]
    bores = [_wider(name, well) for name in names]
    deep = max((kind.table.stop_gap for kind in layout.used), default=0.0) + layout.base_z
    lands = f"counterbores {deep:.3g} ±{LAND_DEPTH:g} deep, milled in one setting with the upper face"
    holes, notes = [*_through(layout, t, bore), *wells], (lands,) if deep > 0.0 else ()
    zones = {"dowel_hole": PLATE_ZONE, "screw": PLACE, **dict.fromkeys(names, PLACE)}
    flat, own = (Geometric("stop face", "flatness", STOP_FLAT, (FACES[1],)),), (bore, *bores)
    return milled(layout, "base", "Base", _plain(layout, t), holes, zones, notes, own, flat)


def copper_room(layout: PlanarLayout) -> tuple[float, float]:
    """Half sides of the room of the chips' copper if they lie close, mm."""
    last = layout.elements[-1]
    return last.x + layout.chip.length / 2.0 + COPPER[0], last.y + layout.chip.width / 2.0 + COPPER[1]


def frame_room(layout: PlanarLayout) -> tuple[float, float]:
    """Half sides of the frame's opening, mm: the cells', or as much more as the chips' copper needs and the
    walls bear."""
    hole = METRIC[SCREW].clearance / 2.0
    walls = (WEB + (border / 2.0 + hole if layout.screwed else 0.0) for border in layout.borders)
    rooms = zip(copper_room(layout), layout.half, layout.borders, walls)
    x, y = (round(max(round(h - b, 9), min(copper, h - wall)), 9) for copper, h, b, wall in rooms)
    return x, y


def frame(layout: PlanarLayout) -> Part:
    """Keeps the board off the base by the chips' height."""
    t = chip_room(layout)
    holes = bored("screw", screw_places(layout), METRIC[SCREW].clearance, t)
    body = _plain(layout, t, (_rounded(*frame_room(layout), FRAME_CORNER),))
    return milled(layout, "frame", "Board frame", body, holes, {"screw": PLACE})


def _wider(hole: str, least: float) -> Characteristic:
    name = f"{hole.replace('_', ' ')} diameter"
    return Characteristic(name, least, round(least + BORED, 9), least, between=(hole,))


def post_play(layout: PlanarLayout) -> float:
    """Most that a post is off its opening's middle, mm: places and plays in the foil and in the cover."""
    foil_, process = layout.design.planar.thickness, layout.process
    play = spigot_bore(layout, process, foil_).upper - layout.design.post.spigot + SPIGOT
    zone = foil_zone(layout, process)
    if layout.screwed:
        bores = dowel_bore(layout, process, foil_).upper + dowel_bore(layout, None, foil_).upper
        play += bores - 2.0 * dowel_limits(DOWEL)[0] + PLATE_ZONE + zone
    return (play + PLACE + zone) / 2.0


def travel_limit(layout: PlanarLayout, kind: Kind) -> float:
    """Most by which an island's way down differs from the drawn one, mm: spacer, and land if it is sunk."""
    return layout.design.tolerance.stop_gap / 2.0 + sunk(layout, kind) * LAND_DEPTH


def sunk(layout: PlanarLayout, kind: Kind) -> bool:
    """Whether its islands land below the base's upper face."""
    return kind.table.stop_gap + layout.base_z > 1e-9


def cover(layout: PlanarLayout) -> Part:
    """Round openings around the posts, the sideways stops; the screws' threads. z = 0 its lower face."""
    d = layout.design
    t = d.housing.cover_thickness
    opening = round(d.post.pad + 2.0 * d.housing.side_gap, 9)
    bore, room = dowel_bore(layout, None, t), _wider("post_opening", opening)
    holes = [*_through(layout, t, bore, tapped=True), *bored("post_opening", layout.places, opening, t)]
    zones, body = {"dowel_hole": PLATE_ZONE, "screw": PLACE, "post_opening": PLACE}, _plain(layout, t)
    return milled(layout, "cover", "Cover", body, holes, zones, bores=(bore, room))


def measured(layout: PlanarLayout) -> list[tuple[CellPlace, str, tuple[Measurement, ...]]]:
    """Measurements on every cell of a cut foil."""
    t = layout.design.planar.thickness
    cut, of_foil = layout.process.tolerance(t), layout.design.foil_tolerance
    edges, middle = "island's to frame's edge (mean of four)", "middle of each beam (mean of four)"

    def of(k: Kind) -> tuple[Measurement, ...]:
        sizes = (
            ("beam width", k.table.beam_width, cut, True, middle, MICROSCOPE),
            ("beam length", k.beam_length, cut, False, edges, MICROSCOPE),
            ("thickness", t, of_foil, True, "on the border, near the cell", "micrometer, 0.0005 or better"),
        )
        return tuple(Measurement(of, v, v - off, v + off, key, "", *how) for of, v, off, key, *how in sizes)

    return [(e, f"{layout.design.name}-foil", of(e.kind)) for e in layout.elements]


def about(layout: PlanarLayout) -> str:
    p = layout.design.planar
    return (
        f"{p.rows} x {p.columns} cells in a plane, pitch {p.pitch:g} mm, in one foil of {p.thickness:g} mm: "
        "each an island on four beams, of two stiffnesses in turn, with a magnet over a three-axis Hall chip."
    )
