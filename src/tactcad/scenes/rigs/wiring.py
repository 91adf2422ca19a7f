"""Wiring: the array on its back, a board on its plate next to each row, and the leads between; the socket on
the leads is plugged last and pulled off the same way."""

from __future__ import annotations

from tactcad.design.tree import Design
from tactcad.parts.array.board_plate import (
    BOARD_OUTLINE,
    BOARD_SCREW,
    CLAMP,
    CLAMP_AHEAD,
    CLAMP_SCREW,
    CLAMP_SCREW_X,
    FLATS,
    INSULATOR,
    PLATE,
    STAND_OFF,
    STUD,
    THREAD,
    UNPLUGGED,
    board_plate,
    channels_of,
    fitted_board,
    lead_clamp,
    lead_pins,
    lead_socket,
    stand_off,
)
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import BoardStand, boards, carrier_top, leads, stands
from tactcad.parts.array.supplies import supplies, wiring_supplies
from tactcad.parts.language.description import Vector, vector
from tactcad.parts.rules.bonding_rules import FITS as BONDING_FITS
from tactcad.parts.rules.rule import misfit

from ..builder import Builder, telling
from ..moves import APPROACH
from ..rig import plain_rig
from ..scene import DOWN, REST, STILL, Move, Need, Pose, Rotation, Scene
from .array import array, is_calibrated

said = telling(__file__)

# A board's frame, and its clamp's: the edge with the leads towards the array.
BOARD: dict[float, Rotation] = {
    1.0: ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
    -1.0: ((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
}
BAR: dict[float, Rotation] = {
    1.0: ((0, 0, 1), (1, 0, 0), (0, 1, 0)),
    -1.0: ((0, 0, -1), (-1, 0, 0), (0, 1, 0)),
}
# mm before its header a socket lies on the plate while its leads are soldered: clear of the clamp
PARKED = 14.0
LIFTED = 40.0  # mm that what comes from above starts over its place; chosen: fingers
SPANNER = f"spanner {FLATS:g} mm"
SOLDERING = "soldering iron with a 0.4 mm tip, temperature controlled"


def wiring(design: Design, pose: Pose = REST) -> Scene:
    """Scene `wiring`, on the bench at z = 0; it has no pose but rest."""
    layout, whole = Layout(design), array(design)
    outline, pins = BOARD_OUTLINE, lead_pins(layout)
    stood = stands(layout)
    b = Builder()
    b.supplies += wiring_supplies(layout)
    if design.bonding is None or misfit(layout, BONDING_FITS):
        b.supplies += (s for s in supplies("bonding", {}) if s.part_no in ("SOLDER", "FLUX"))
    level = PLATE + STAND_OFF

    def at(stand: BoardStand, x: float, y: float, z: float) -> Vector:
        """A place on a board, from its lead connector: x along that, y towards the array."""
        return vector((stand.side * (stand.x - y), -stand.y + stand.side * x, z))

    def corner(stand: BoardStand, z: float) -> Vector:
        return at(stand, -outline.connector[0], -outline.connector[1], z)

    plates = [b.place("BH", board_plate(design, outline), corner(s, 0.0), BOARD[s.side]) for s in stood]
    b.step(
        "Board plates",
        (0, 0, 0),
        said("Board plates", order=_in_order(layout)),
        sets=("board plates on the bench: along z, turn about x and y",),
        leaves=("board plates: along x and y, turn about z",),
    )
    screws: list[tuple[BoardStand, str, Vector]] = []
    for stand, plate in zip(stood, plates):
        for x, y, _ in outline.holes:
            where = at(stand, x - outline.connector[0], y - outline.connector[1], PLATE)
            name = b.place("BS", stand_off(), where)
            b.meet(name, plate, "thread")
            screws.append((stand, name, where))
    b.step(
        "Stand-offs",
        (0, 0, 30),
        said("Stand-offs", flats=FLATS),
        order=[Move((name,), (0.0, 0.0, APPROACH + STUD), (STILL,), SPANNER) for _, name, _ in screws],
        tools=(SPANNER,),
        sets=("stand-offs in their plates: all, by their studs",),
    )
    fitted = [b.place("A", fitted_board(design, outline), corner(s, level), BOARD[s.side]) for s in stood]
    names = dict(zip(stood, fitted))
    for stand, name, where in screws:
        b.meet(names[stand], name)
        under = vector((*where[:2], level + outline.thickness))
        b.screw(THREAD, BOARD_SCREW, under, (0, 0, -1), names[stand], name)
    b.step("Boards", (0, 0, 60), said("Boards", fitted=_fitted(layout)))
    uncalibrated = (
        "An array still to be calibrated has no stop plate and set screws yet. "
        if is_calibrated(layout)
        else ""
    )
    b.subassembly(whole, DOWN, (0, 0, carrier_top(layout)))
    b.step(
        "Array on its back",
        (0, 0, 60),
        said("Array on its back", uncalibrated=uncalibrated),
        order=[Move(tuple(p.designator for p in whole.placements), (0.0, 0.0, LIFTED), (STILL,))],
        sets=("array on the bench: along z, turn about x and y",),
        leaves=("array: along x and y, turn about z, by the leads' slack",),
    )
    plug = level + outline.thickness + INSULATOR
    sockets = {s: b.place("XS", lead_socket(pins), at(s, 0, 0, plug), BOARD[s.side]) for s in stood}
    parked = {s: vector((-s.side * PARKED, 0.0, PLATE - plug)) for s in stood}
    over = {s: vector((*parked[s][:2], UNPLUGGED)) for s in stood}
    b.step(
        "Leads to their socket",
        (0, 0, 90),
        said("Leads to their socket", design=design),
        order=[Move((name,), vector((*parked[s][:2], LIFTED)), (parked[s],)) for s, name in sockets.items()],
        tools=(
            SOLDERING,
            "solder and flux, as for the gauges",
            "scraper",
            "hot-air gun",
            "ohmmeter, four wires, 0.01 ohm",
        ),
        sets=("leads in their socket: all, by solder",),
        leaves=("sockets: lie loose on their plates",),
        needs=(Need((*fitted,), "leads are as long as the way to their board"),),
    )
    for stand, plate in zip(stood, plates):
        middle = at(stand, 0.0, CLAMP_AHEAD + CLAMP[1] / 2, PLATE)
        origin = vector((middle[0], middle[1], PLATE))
        made = lead_clamp(design, channels_of(layout) * leads(layout))
        bar = b.place("LC", made, origin, BAR[stand.side], on=plate)
        for side in (-1, 1):
            under = at(stand, side * CLAMP_SCREW_X, CLAMP_AHEAD, PLATE + CLAMP[2])
            b.screw(THREAD, CLAMP_SCREW, under, (0, 0, -1), bar, plate)
    b.step(
        "Lead clamps",
        (0, 0, 60),
        said("Lead clamps"),
        needs=(Need(tuple(sockets.values()), "joints are soldered before the bundle is held"),),
    )
    plugging: list[Move | tuple[str, ...]] = []
    for s, name in sockets.items():
        up = vector((0.0, 0.0, UNPLUGGED))
        plugging += [
            Move((name,), parked[s], (over[s], up, STILL)),
            Move((name,), STILL, (up,)),
            Move((name,), up, (STILL,)),
        ]
    b.step(
        "Plug the leads",
        (0, 0, 0),
        said("Plug the leads", unplugged=UNPLUGGED),
        order=plugging,
        sets=("sockets on J2: all, by the header's pins",),
        leaves=("sockets: up, by hand",),
        needs=(
            Need(tuple(p.designator for p in b.placements if p.designator.startswith("LC")), "no pull on J2"),
        ),
    )
    return b.scene("wiring", cover=[p.designator for p in whole.placements if p.designator in whole.cover])


def _in_order(layout: Layout) -> str:
    """Where the boards of a row that has several stand."""
    rows = [[b for b in boards(layout) if b.places[0].row == row] for row in (1, 2)]
    told = [
        f"A{own[0].number} beside {own[0].places[0].designator} to A{own[-1].number} beside "
        f"{own[-1].places[-1].designator}"
        for own in rows
        if len(own) > 1
    ]
    return f" A row's boards stand in the order of their elements: {', '.join(told)}." if told else ""


def _fitted(layout: Layout) -> str:
    """Which board has how many channels fitted, where they differ: its files are named by that."""
    fitted: dict[int, list[str]] = {}
    for b in boards(layout):
        fitted.setdefault(len(b.places), []).append(f"A{b.number}")
    told = [f"{' '.join(names)} of board-{used}" for used, names in fitted.items()]
    return f" Parts are fitted as in the files {', '.join(told)}." if len(told) > 1 else ""


RIG = plain_rig("wiring", wiring)  # no requirements but its screws
