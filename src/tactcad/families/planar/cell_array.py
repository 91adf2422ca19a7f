"""The array of cells: placements, steps, and what must hold of its limits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from tactcad.parts.array.supplies import supplies as bill_lines
from tactcad.parts.bought.standard_parts import dowel, dowel_diameter, dowel_limits
from tactcad.parts.language.description import Part
from tactcad.parts.language.limits import Characteristic
from tactcad.parts.language.stock import PLACE
from tactcad.scenes import scene_names
from tactcad.scenes.builder import Builder, telling
from tactcad.scenes.moves import CLAMP, PRESS
from tactcad.scenes.requirement import LEAST_PRESS, Deviations, DimensionLimits, Requirement, summed, variable
from tactcad.scenes.rig import ARRAY, plain_rig, rig_of
from tactcad.scenes.scene import Scene

from . import cell_board, parts
from .cell_layout import Kind, PlanarLayout
from .cell_tables import PlanarDesign
from .sensor import rows, stop_stress

said = telling(__file__)


def scene(design: PlanarDesign, _pose: object = None) -> Scene:
    """Base down; posts and magnets are bonded to the foil before the foil goes in."""
    b, layout = Builder(), PlanarLayout(design)
    t = design.planar.thickness
    board = b.place("PCB", cell_board.board(layout), (0, 0, layout.board_z - design.hall.board))
    b.step("Board", (0, 0, -45), "Lay the board down, its pads for the chips up.")
    orders = [cell_board.order_of(layout, e.number) for e in layout.elements]
    chips = {order: cell_board.chip(layout, order) for order in orders}
    for e, order in zip(layout.elements, orders, strict=True):
        b.place("U", chips[order], (e.x, e.y, layout.board_z), on=board)
    soldered = "The board comes from its maker with the chips soldered."
    if not cell_board.why_none(layout):
        soldered = said("board")
    b.step("Chips", (0, 0, -35), soldered, sets=("chips on the board: all, by solder",))
    frame = b.place("FR", parts.frame(layout), (0, 0, layout.board_z), on=board)
    b.step("Frame", (0, 0, -25), "Lay the frame on the board, around the chips.")
    floor = round(layout.board_z + parts.chip_room(layout), 9)
    base = b.place("B", parts.base(layout), (0, 0, floor), on=frame)
    pins = []
    for x, y in parts.dowel_places(layout):
        pins.append(b.place("DP", dowel(parts.DOWEL, parts.dowel_length(layout) or 0.0), (x, y, floor)))
        b.meet(pins[-1], base, "press")
        b.meet(pins[-1], frame)
    if layout.screwed:
        b.step(
            "Dowels",
            (0, 0, -15),
            "On the bench: press the two dowels into the base, flush with its lower face.",
            bench=True,
            tools=(PRESS, "a flat plate under the base as stop"),
            sets=tuple(f"{pin} in {base}: all" for pin in pins),
        )
        text = "Lay the base on the frame, dowels up."
        b.step("Base", (0, 0, -15), text, order=[()], sets=(f"{base} on {frame}: along z",))
    else:
        out = ", the board's tongue past one of them" if cell_board.tongue(layout) else ""
        first = f"Bond every layer on the one below, flush at its edges between two straight edges{out}."
        b.step("Base", (0, 0, -15), first, tools=("two straight edges",), sets=_laid(layout, base, frame))
    lower = b.place("SP", parts.lower_spacer(layout), (0, 0, layout.base_z), on=base)
    b.step(
        "Lower spacer",
        (0, 0, -6),
        "Lay the lower spacer on the base: its thickness is the islands' travel.",
        sets=_laid(layout, lower, base),
    )
    foil = b.place("F", parts.foil(layout), (0, 0, 0), on=lower)
    feet = {kind.name: parts.foot(layout, kind) for kind in layout.used}
    post, magnet = parts.post(layout), parts.magnet(layout)
    bonded = [foil]
    for e in layout.elements:
        plate = b.place("FP", feet[e.kind.name], (e.x, e.y, t), on=foil)
        top = b.place("P", post, (e.x, e.y, t + design.post.foot), on=plate)
        bonded += [plate, top, b.place("M", magnet, (e.x, e.y, -design.magnet.height), on=foil)]
    b.step(
        "Foil with posts and magnets",
        (0, 0, 8),
        "Take the foil with its foot plates, posts and magnets from the bonding jig (scene bonding).",
        bench=True,
        order=[bonded],
        sets=("foil, foot plates, posts and magnets: all, bonded in the jig",),
    )
    upper = b.place("SP", parts.upper_spacer(layout), (0, 0, t), on=foil)
    b.step(
        "Foil and upper spacer",
        (0, 0, 14),
        f"Lay the foil {'over the dowels' if layout.screwed else 'on the lower spacer'}, magnets down into "
        "their wells, and the upper spacer on it.",
        sets=(*_laid(layout, foil, lower), *_laid(layout, upper, foil)),
    )
    cover = b.place("C", parts.cover(layout), (0, 0, layout.cover_z), on=upper)
    over = "dowels and posts" if layout.screwed else "the posts"
    jaw = "" if layout.screwed else f" {said('jaw')}"
    b.step("Cover", (0, 0, 26), f"Lower the cover over {over}.{jaw}", sets=_laid(layout, cover, upper))
    if layout.screwed:
        length = parts.screw_length(layout) or 0.0
        for x, y in parts.screw_places(layout):
            b.screw(parts.SCREW, length, (x, y, layout.board_z - design.hall.board), (0, 0, 1), board, cover)
        longer, thick = parts.mounting(layout)
        mount = f" {said('mount', plate=thick, screw=f'{parts.SCREW}x{longer:g}')}" if thick else ""
        b.step("Screws", (0, 0, -45), said("Screws") + mount, tools=(CLAMP,))
    else:
        b.supplies += bill_lines("cells adhesive", {})
    b.supplies += cell_board.supplies(layout)
    return b.scene(ARRAY, cover=(cover,))


def _laid(layout: PlanarLayout, name: str, on: str) -> tuple[str, ...]:
    """What fixes a layer on the one below."""
    if not layout.screwed:
        return (f"{name} on {on}: all, by adhesive, its edges flush",)
    return (f"{name} on {on}: along z", f"{name} by DP1 DP2: along x and y, turn about z")


SPIGOT, PLACES = "spigot diameter", "places of dowel holes"
FOIL, GROWN, SPACER = "foil: thickness", "foil: growth of beams", "lower spacer: thickness"
LAND, WELL = "base: depth of lands", "base: diameter of wells"
PLANE = 2.0 * parts.POST_TOLERANCE  # mm: facing rows ask for as much
MAGNET_PLACE, MAGNET_BOND = "magnet's place along ", "magnet: adhesive over it"
POST_LENGTH = f"post: {parts.POST_LENGTH}"


@dataclass(frozen=True)
class Stacked:
    """Arrays as made."""

    layout: PlanarLayout
    made: Deviations

    def with_new(self, variable: DimensionLimits, deviations: np.ndarray) -> Stacked:
        """The same arrays with one variable drawn anew."""
        return Stacked(self.layout, {**self.made, variable.name: deviations})


def figures(arrays: Stacked) -> dict[str, np.ndarray]:
    """Stiffness of every cell as built, N/mm; and the distance of its pad below the highest, um."""
    of = zip(rows(arrays.layout, "", None), arrays.layout.elements)
    at = [row.stiffness * stiffer(arrays, place.kind) for row, place in of]
    return {"stiffness": np.hstack(at), "pad_height_um": 1e3 * _below(arrays)}


def _below(arrays: Stacked) -> np.ndarray:
    """Every pad below the highest, mm."""
    post = arrays.made[POST_LENGTH]
    return np.asarray(post.max(axis=1, keepdims=True) - post)


def stiffer(arrays: Stacked, kind: Kind) -> np.ndarray:
    """K of a kind of cells as made over the drawn one, (arrays, 1): as (w - 1.5 bevel) t^3/s^3; a beam that
    is cut wider is as much shorter, and a bevel grows with the foil."""
    t, s, bevel = kind.thickness, kind.beam_length, 1.5 * kind.bevel
    foil, grown = arrays.made[FOIL], arrays.made[GROWN]
    wide = kind.table.beam_width - bevel * t
    wider = 1.0 + (grown - bevel * foil) / wide
    return np.asarray((1.0 + foil / t) ** 3 * wider / (1.0 - grown / s) ** 3)


def limits(
    layout: PlanarLayout, scenes: Sequence[Scene]
) -> tuple[dict[str, DimensionLimits], list[Requirement]]:
    """Variables of the layers, magnets, chips and rigs, and their requirements."""
    d, tol, n = layout.design, layout.design.tolerance, len(layout.elements)
    t = d.planar.thickness
    known = {v.name: v for v in _fits(layout)}
    made: tuple[tuple[str, float, str, list[str]], ...] = (
        (FOIL, d.foil_tolerance, "foil", ["thickness"]),
        (GROWN, layout.process.tolerance(t), "foil", [f"beam width, {k.name}" for k in layout.used]),
        (LAND, parts.LAND_DEPTH, "base", []),
        (SPACER, tol.stop_gap / 2.0, "lower-spacer", ["thickness"]),
        ("upper spacer: thickness", 0.03, "upper-spacer", ["thickness"]),
        ("cover: thickness", 0.02, "cover", ["thickness"]),
        ("base: thickness", 0.02, "base", ["thickness"]),
        (POST_LENGTH, parts.POST_TOLERANCE, "post", [parts.POST_LENGTH]),
    )
    for who, most, part, names in made:
        stated = tuple((f"{d.name}-{part}", limit) for limit in names)
        known[who] = variable(who, -most, most, n if who == POST_LENGTH else 1, stated)

    def stiffness(a: Stacked) -> np.ndarray:
        return np.hstack([stiffer(a, kind) for kind in layout.used]) - 1.0

    def stress(a: Stacked) -> np.ndarray:
        """On the stop over yield: goes with the foil's thickness, and with the island's way."""
        on_stop = []
        for k in layout.used:
            way = k.table.stop_gap + a.made[SPACER] + parts.sunk(layout, k) * a.made[LAND]
            on_stop.append(stop_stress(layout, k, way))
        return (1.0 + a.made[FOIL] / t) * np.hstack(on_stop) / d.material.yield_strength

    of_rigs: dict[str, Requirement] = {}
    for scene in scenes:
        of_rigs |= {r.name: r for r in rig_of(d, scene.name).requirements(layout, known)}
    if MAGNET_BOND not in known and "bonding" in scene_names(d):  # judged by its jig without being asked for
        rig_of(d, "bonding").requirements(layout, known)
    asked = variable("", -tol.magnet_place, tol.magnet_place, n)  # of a design that the jig does not take
    along = (MAGNET_PLACE + axis for axis in "xy")
    places = [[v for v in known if v.startswith(name)] or [name] for name in along]
    known |= {v: replace(asked, name=v) for (v, *_) in places if v not in known}
    wells = tuple((f"{d.name}-base", f"well {k.name} diameter") for k in layout.used)
    known[WELL] = variable(WELL, 0.0, parts.BORED, n, wells)
    for terms, axis in zip(places, "xy"):
        stated = tuple((f"{d.name}-base", f"well {k.name} holes") for k in layout.used)
        at = variable(f"base: places of wells along {axis}", -PLACE / 2.0, PLACE / 2.0, n, stated)
        known[at.name] = at
        terms.append(at.name)

    tips = (t / 2.0 + d.magnet.height) / (layout.pad_height - d.post.stand_out)  # to a post's way

    def well(a: Stacked) -> np.ndarray:
        x, y = (sum((a.made[v] for v in terms), np.zeros(n)) for terms in places)
        return d.housing.well + a.made[WELL] / 2.0 - tips * d.housing.side_gap - np.hypot(x, y)

    down, gap = -layout.base_z, d.hall.gap
    bond = ((v, -1.0) for v in known if v == MAGNET_BOND)
    apart = (("base: thickness", 1.0), (SPACER, 1.0), *bond)
    return known, [
        *_slips(layout),
        Requirement("pads in one plane", "mm", -inf, PLANE, _below, fields=("post.stand_out",)),
        Requirement("K as drawn", "", -0.2, 0.2, stiffness, fields=("tolerance.thickness",)),
        Requirement("stop keeps the beams from yielding, as made", "", -inf, 1.0, stress),
        Requirement("magnets clear of their wells", "mm", 0.02, inf, well, fields=("housing.well",)),
        summed("feet clear of the cover", 0.05, inf, d.housing.lift, (("upper spacer: thickness", 1.0),)),
        summed("island's way down", 0.7 * down, 1.3 * down, down, ((SPACER, 1.0),)),
        summed("magnet to chip", 0.9 * gap, 1.1 * gap, gap, apart),
        *of_rigs.values(),
    ]


def _limit(part: Part, name: str) -> Characteristic:
    return next(c for c in part.characteristics if c.name == name)


def _deviations(part: Part, limit: str, who: str, pieces: int = 1) -> DimensionLimits:
    """The variable of a part's limit."""
    c = _limit(part, limit)
    lower, upper = c.lower - c.nominal, c.upper - c.nominal
    return variable(f"{who}: {limit}", lower, upper, pieces, ((part.part_no, limit),))


def _sheets(layout: PlanarLayout) -> dict[str, Part]:
    """What posts' spigots enter, by the names of their variables."""
    feet = {f"foot, {kind.name}": parts.foot(layout, kind) for kind in layout.used}
    return {"foil": parts.foil(layout)} | feet


def _layers(layout: PlanarLayout) -> dict[str, Part]:
    """Layers that slip over the dowels, by the names of their variables; none if bonded."""
    if not layout.screwed:
        return {}
    made = (parts.foil, parts.lower_spacer, parts.upper_spacer, parts.cover)
    return dict(zip(("foil", "lower spacer", "upper spacer", "cover"), (make(layout) for make in made)))


def _fits(layout: PlanarLayout) -> Iterator[DimensionLimits]:
    """Fits of holes and spigots, and of holes and dowels; the error of distance between a layer's two dowel
    holes."""
    foil, *feet = _sheets(layout).items()
    for who, part in (foil, ("post", parts.post(layout)), *feet):
        yield _deviations(part, SPIGOT, who, len(layout.elements))
    layers = _layers(layout)
    if layers:
        low, high = (limit - dowel_diameter(parts.DOWEL) for limit in dowel_limits(parts.DOWEL))
        yield variable("dowel: diameter", low, high)
        layers["base"] = parts.base(layout)
    for who, part in layers.items():
        yield _deviations(part, parts.DOWEL_HOLE, who)
        place = next(g for g in part.geometric if g.features == ("dowel_hole",))
        stated = ((part.part_no, place.name),)
        yield variable(f"{who}: {PLACES}", -place.zone / 2.0, place.zone / 2.0, 2, stated)


def _slips(layout: PlanarLayout) -> Iterator[Requirement]:
    """Spigots enter foil and feet, layers slip over the dowels, the base holds them."""
    spigot = layout.design.post.spigot
    for who, part in _sheets(layout).items():
        play = _limit(part, SPIGOT).nominal - spigot

        def entered(a: Stacked, play: float = play, who: str = who) -> np.ndarray:
            return play + a.made[f"{who}: {SPIGOT}"] - a.made[f"post: {SPIGOT}"]

        yield Requirement(f"spigots enter the {who}", "mm", 0.0, inf, entered, fields=("post.spigot",))
    for who, part in _layers(layout).items():
        play = _limit(part, parts.DOWEL_HOLE).nominal - dowel_diameter(parts.DOWEL)
        terms = ((f"{who}: {parts.DOWEL_HOLE}", 1.0), ("dowel: diameter", -1.0))
        places = ((f"{who}: {PLACES}", 1.0), (f"base: {PLACES}", 1.0))
        yield summed(f"{who} slips over the dowels", 0.0, inf, play, (*terms, *places))
    if layout.screwed:
        terms = (("dowel: diameter", 1.0), (f"base: {parts.DOWEL_HOLE}", -1.0))
        pin = dowel_diameter(parts.DOWEL) - float(parts.DOWEL)
        yield summed("base holds the dowels", LEAST_PRESS, inf, pin, terms)


RIG = plain_rig(ARRAY, scene)
