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

from collections.abc import Mapping, Sequence
from math import ceil
from typing import Any, cast

from tactcad.contour import Contour, Corner, circle, rectangle, rounded_polygon
from tactcad.parts.array.clamp import PRESS_FIT, pressed
from tactcad.parts.array.element import sheet_material
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

from .cell_layout import Kind, PlanarLayout
from .cell_tables import FoilProcess

SCREW, DOWEL = "M2", "2"
LARGEST_STEP = 20.0  # mm between screws along an edge; chosen: what keeps 1 mm of base flat under them
POST_LENGTH, POST_TOLERANCE = "length over the shoulder", 0.01  # mm, plus and minus; chosen: a small lathe's
PAD, WELL = "pad side diameter", "well diameter"
PAD_FIELD = 0.02  # mm by which a pad may be smaller than drawn; chosen: a cap slips over it
SPIGOT = 0.01  # mm by which a post's spigot may be thinner than drawn; chosen, likewise
MAGNET_LIMIT = (
    0.02  # mm, plus and minus, of a magnet's diameter and height; chosen: ground, or picked by micrometer
)
SPIGOT_SHORT = 0.02  # mm that a spigot ends inside the foil; chosen
FOOT_THICKNESS = 0.02  # mm, plus and minus; chosen: precision strip
DOWEL_HOLE = "dowel hole diameter"
# Zone of dowel holes and flatness of the stop face, mm: chosen, achievable by a jig borer and a fine mill in
# one clamping; field of a reamed hole: ISO 286, H8 of 1 to 3 mm; depth of the sunk lands, plus and minus:
# chosen.
PLATE_ZONE, STOP_FLAT, REAMED, LAND_DEPTH = 0.02, 0.01, 0.014, 0.01
BORED = 0.05  # mm by which wells and posts' openings may be wider than drawn; chosen: a drill
FOOT_INSET = 0.03  # mm of island around its foot plate; chosen: the etching's tolerance
WEB = 0.8  # mm of base left over the chips' pocket, at least: checks/data/shop.toml's floor of a pocket
FRAME_CORNER = 0.5  # mm; chosen: a cutter of 1 mm, and room for the outer chips
COPPER = 1.4, 0.6  # mm of tracks and vias beyond the outer chips along x and y: cell_board.CLOSE
CHIP_ROOM = 0.2  # mm above and around a chip; chosen: soldered boards' usual tolerance
SPRING_STEEL = Material("1.4310", 7900, "+C1300", "EN 10151")
NEODYMIUM = Material("NdFeB, nickel plated", 7500)
STAINLESS_BAR = Material("X8CrNiS18-9 (1.4305)", 7900, standard="EN 10088-3", magnetic="no")


def screw_places(layout: PlanarLayout) -> tuple[tuple[float, float], ...]:
    """Along the border, corners included, at most LARGEST_STEP apart; none for bonded layers."""
    if not layout.screwed:
        return ()
    x, y = (h - border / 2.0 for h, border in zip(layout.half, layout.borders))
    nx, ny = (max(1, ceil(2.0 * h / LARGEST_STEP)) for h in (x, y))
    along = [(-x + 2.0 * x * i / nx, s * y) for i in range(nx + 1) for s in (-1.0, 1.0)]
    up = [(s * x, -y + 2.0 * y * j / ny) for j in range(1, ny) for s in (-1.0, 1.0)]
    return tuple((round(u, 2), round(v, 2)) for u, v in along + up)


def dowel_places(layout: PlanarLayout) -> tuple[tuple[float, float], ...]:
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


def dowel_length(layout: PlanarLayout) -> float | None:
    """The longest ISO 8734 length between the base's lower and the cover's upper face."""
    room = base_plate(layout) + layout.cover_z - layout.base_z + layout.design.housing.cover_thickness
    return max((n for n in dowel_lengths(DOWEL) if n <= room), default=None)


def land_diameter(layout: PlanarLayout) -> float:
    """Diameter of the sunk lands under the kind of cell with the longer travel, mm: WEB stays between
    neighbours."""
    return round(layout.design.planar.pitch - WEB, 9)


def _outline(layout: PlanarLayout) -> Contour:
    x, y = layout.half
    return rectangle(-x, -y, x, y)


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


def spigot_bore(layout: PlanarLayout, process: FoilProcess, thickness: float) -> Characteristic:
    """Limits of the hole for a post's spigot in a sheet: the thickest spigot passes the least hole."""
    cut = process.tolerance(thickness)
    nominal = _up(layout.design.post.spigot + LEAST_PLAY + cut)
    return within("spigot diameter", nominal, cut, between=("spigot",))


def _up(size: float) -> float:
    """To the next 0.005 mm."""
    return ceil(200.0 * size - 1e-6) / 200.0


def _through(
    layout: PlanarLayout, thickness: float, bore: Characteristic, tapped: bool = False
) -> list[Feature]:
    """The screws' and dowels' holes of a layer, along +z from its lower face; a press-fit hole is modelled as
    wide as the pin."""
    m = METRIC[SCREW]
    holes: list[Feature] = []
    for x, y in screw_places(layout):
        if tapped:
            holes.append(tapped_through("screw", SCREW, (x, y, 0.0), (0, 0, 1), thickness))
        else:
            holes.append(Hole("screw", (x, y, 0.0), (0, 0, 1), m.clearance, thickness, True))
    pressed_in = bore.upper < bore.nominal
    wide = dowel_diameter(DOWEL) if pressed_in else round((bore.lower + bore.upper) / 2.0, 6)
    fit = f"{PRESS_FIT}, the pin pressed in" if pressed_in else ""
    for x, y in dowel_places(layout):
        holes.append(Hole("dowel_hole", (x, y, 0.0), (0, 0, 1), wide, thickness, True, tolerance=fit))
    return holes


def _stated(layout: PlanarLayout, *bores: Characteristic) -> tuple[Characteristic, ...]:
    """Limits of holes; none for dowels if no layer has them."""
    return tuple(c for c in bores if c.name != DOWEL_HOLE or layout.screwed)


def contour_note(process: FoilProcess, thickness: float) -> str:
    cut = process.tolerance(thickness)
    return f"{process.name}; contour within ±{cut:.3g} of the DXF's unless a limit is given"


def _placed(features: Sequence[Feature], zones: Mapping[str, float]) -> dict[str, Any]:
    """Geometric tolerances of holes by their names, and their datums; empty if there are no holes."""
    there = {f.name for f in features}
    places = tuple(
        Geometric(f"{name.replace('_', ' ')} holes", "position", zone, (name,), FRAME, True)
        for name, zone in zones.items()
        if name in there
    )
    return {"geometric": places, "datums": FRAME_DATUMS if places else ()}


def _round_holes(layout: PlanarLayout, name: str, diameter: float, thickness: float) -> list[Feature]:
    return [Hole(name, (e.x, e.y, 0.0), (0, 0, 1), diameter, thickness, True) for e in layout.elements]


def foil(layout: PlanarLayout) -> Part:
    """The foil: every cell's four slots, spigot, screw and dowel holes."""
    d, t = layout.design, layout.design.planar.thickness
    slots = tuple(s for e in layout.elements for s in e.kind.slots(layout.corner, (e.x, e.y)))
    cut, zone = layout.process.tolerance(t), foil_zone(layout, layout.process)
    bore, spigot = dowel_bore(layout, layout.process, t), spigot_bore(layout, layout.process, t)
    features = (*_round_holes(layout, "spigot", spigot.nominal, t), *_through(layout, t, bore))
    beams = [
        c
        for kind in layout.used
        for c in (
            within(
                f"beam width, {kind.name}", kind.table.beam_width, cut, True, kind.named("beam a", "beam b")
            ),
            within(f"beam length, {kind.name}", kind.beam_length, cut, between=kind.named("root", "frame")),
        )
    ]
    return Part(
        part_no=f"{d.name}-foil",
        name="Foil",
        process=cast(Process, layout.design.planar.process),
        material=sheet_material(d),
        body=Extrusion(_outline(layout), t, slots),
        features=features,
        colour="#c9ccd1",
        notes=(contour_note(layout.process, t), "do not bend, do not tumble; packed flat between cards"),
        characteristics=(
            within("thickness", t, d.foil_tolerance, True, between=FACES),
            *beams,
            spigot,
            *_stated(layout, bore),
        ),
        kind="element",
        **_placed(features, {"spigot": zone, "dowel_hole": zone, "screw": PLACE}),
    )


def foot(layout: PlanarLayout, kind: Kind) -> Part:
    """The plate that keeps an island rigid: its outline, a little inside, with the spigot's hole."""
    d = layout.design
    t = d.post.foot
    process = layout.sheet_process(t)
    bore = spigot_bore(layout, process, t)
    return Part(
        part_no=f"{d.name}-foot-{kind.name}",
        name=f"Foot plate, {kind.name} cell",
        process=cast(Process, process.name),
        material=SPRING_STEEL,
        body=Extrusion(kind.island_outline(layout.sheet_corner(t), FOOT_INSET), t),
        features=(Hole("spigot", (0, 0, 0), (0, 0, 1), bore.nominal, t, True),),
        colour="#8f9aa8" if kind.name == "measuring" else "#5b6673",
        notes=(contour_note(process, t), "plates of both kinds from one strip: the posts stand on them"),
        characteristics=(within("thickness", t, FOOT_THICKNESS, between=FACES), bore),
    )


def post(layout: PlanarLayout) -> Part:
    """A turned post: spigot through foot plate and foil, shoulder on the foot plate, pad on top; z = 0 its
    shoulder."""
    d = layout.design
    shoulder = layout.design.planar.thickness + d.post.foot
    up, down = round(layout.pad_z - shoulder, 9), round(-shoulder + SPIGOT_SHORT, 9)
    r, s = d.post.pad / 2.0, d.post.spigot / 2.0
    points = [(0.0, down), (s, down), (s, 0.0), (r, 0.0), (r, up), (0.0, up)]
    names = ("end", "spigot", "shoulder", "pad side", "pad", "axis")
    return Part(
        part_no=f"{d.name}-post",
        name="Post",
        process="turned",
        material=STAINLESS_BAR,
        body=Revolution(_polygon(points, names)),
        colour="#d8d3c4",
        notes=(BREAK_EDGES.replace("0.2", "0.05"), "pad's edge 0.1 round", "turned in one clamping"),
        characteristics=(
            within(POST_LENGTH, up, POST_TOLERANCE, between=("shoulder", "pad")),
            Characteristic(
                PAD, d.post.pad, d.post.pad, round(d.post.pad - PAD_FIELD, 6), between=("pad side",)
            ),
            Characteristic(
                "spigot diameter", d.post.spigot, d.post.spigot, d.post.spigot - SPIGOT, between=("spigot",)
            ),
        ),
    )


def _polygon(points: list[tuple[float, float]], names: tuple[str, ...]) -> Contour:
    return rounded_polygon([Corner(p, 0.0, n) for p, n in zip(points, names)])


def magnet(layout: PlanarLayout) -> Part:
    """A disc magnet, its upper face at z = 0."""
    m = layout.design.magnet
    name = f"MAGNET-{m.diameter:g}x{m.height:g}"
    return Part(
        part_no=name,
        name=f"Disc magnet {m.diameter:g}x{m.height:g}",
        process="bought",
        material=NEODYMIUM,
        body=Extrusion(circle((0, 0), m.diameter), m.height),
        colour="#9aa0a8",
        purchase=Purchase(
            f"disc magnet {m.diameter:g} x {m.height:g} mm, "
            f"each ±{MAGNET_LIMIT:g}, axial, remanence {m.remanence:g} T"
        ),
        spares=max(1, len(layout.elements) // 10),
    )


def _spacer(layout: PlanarLayout, where: str, thickness: float, limit: float, key: bool) -> Part:
    """A frame with the openings of the foil's cells, which clamps the foil's webs."""
    d, half = layout.design, layout.kinds["measuring"].opening / 2.0
    openings = tuple(
        rounded_polygon(
            [
                Corner((round(e.x + sx * half, 9), round(e.y + sy * half, 9)), layout.sheet_corner(thickness))
                for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))
            ]
        )
        for e in layout.elements
    )
    process = layout.sheet_process(thickness)
    bore, zone = dowel_bore(layout, process, thickness), foil_zone(layout, process)
    features = tuple(_through(layout, thickness, bore))
    return Part(
        part_no=f"{d.name}-{where}-spacer",
        name=f"{where.capitalize()} spacer",
        process=cast(Process, process.name),
        material=SPRING_STEEL,
        body=Extrusion(_outline(layout), thickness, openings),
        features=features,
        colour="#aab2bd",
        notes=(contour_note(process, thickness), "flat, free of burrs"),
        characteristics=(within("thickness", thickness, limit, key, between=FACES), *_stated(layout, bore)),
        kind="cells",
        **_placed(features, {"dowel_hole": zone, "screw": PLACE}),
    )


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
    wells: list[Feature] = []
    for e in layout.elements:
        lower = round(e.kind.table.stop_gap + layout.base_z, 9)
        land = (land_diameter(layout), lower) if sunk(layout, e.kind) else None
        name = f"well_{e.kind.name}"
        wells.append(Hole(name, (e.x, e.y, t), (0, 0, -1), layout.well, t, True, counterbore=land))
    bore = pressed(float(DOWEL))
    names = [f"well_{kind.name}" for kind in layout.used]
    bores = [_bored(f"{WELL}, {name.removeprefix('well_')}", name, layout.well) for name in names]
    deep = max((kind.table.stop_gap for kind in layout.used), default=0.0) + layout.base_z
    lands = f"counterbores {deep:.3g} ±{LAND_DEPTH:g} deep, milled in one setting with the upper face"
    return milled(
        layout,
        "base",
        "Base",
        Extrusion(_outline(layout), t),
        [*_through(layout, t, bore), *wells],
        {"dowel_hole": PLATE_ZONE, "screw": PLACE, **dict.fromkeys(names, PLACE)},
        (lands,) if deep > 0.0 else (),
        (bore, *bores),
        (Geometric("stop face", "flatness", STOP_FLAT, (FACES[1],)),),
    )


def copper_room(layout: PlanarLayout) -> tuple[float, float]:
    """Half sides of the room of the chips' copper if they lie close, mm."""
    last = layout.elements[-1]
    return last.x + layout.chip.length / 2.0 + COPPER[0], last.y + layout.chip.width / 2.0 + COPPER[1]


def frame_room(layout: PlanarLayout) -> tuple[float, float]:
    """Half sides of the frame's opening, mm: the cells', or as much more as the chips' copper needs and the
    walls bear."""
    hole = METRIC[SCREW].clearance / 2.0
    walls = (WEB + (border / 2.0 + hole if layout.screwed else 0.0) for border in layout.borders)
    x, y = (
        round(max(field, min(copper, half - wall)), 9)
        for field, copper, half, wall in zip(layout.field_half, copper_room(layout), layout.half, walls)
    )
    return x, y


def frame(layout: PlanarLayout) -> Part:
    """Keeps the board off the base by the chips' height."""
    t = chip_room(layout)
    x, y = frame_room(layout)
    room = rounded_polygon(
        [Corner((sx * x, sy * y), FRAME_CORNER) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    )
    holes = [h for h in _through(layout, t, dowel_bore(layout, None, t)) if h.name == "screw"]
    body = Extrusion(_outline(layout), t, (room,))
    return milled(layout, "frame", "Board frame", body, holes, {"screw": PLACE})


def _bored(name: str, feature: str, least: float) -> Characteristic:
    return Characteristic(name, least, round(least + BORED, 9), least, between=(feature,))


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
    bore, room = dowel_bore(layout, None, t), _bored("opening diameter", "post_opening", opening)
    return milled(
        layout,
        "cover",
        "Cover",
        Extrusion(_outline(layout), t),
        [*_through(layout, t, bore, tapped=True), *_round_holes(layout, "post_opening", opening, t)],
        {"dowel_hole": PLATE_ZONE, "screw": PLACE, "post_opening": PLACE},
        bores=(bore, room),
    )


def about(layout: PlanarLayout) -> str:
    p = layout.design.planar
    return (
        f"{p.rows} x {p.columns} cells in a plane, pitch {p.pitch:g} mm, in one foil of {p.thickness:g} "
        f"mm: each an island on "
        "four beams, of two stiffnesses in turn, with a magnet over a three-axis Hall chip."
    )
