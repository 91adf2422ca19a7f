"""Assemblies shared by several rigs: stand, cart with holder and sample, and the vertical axis with the force
gauge."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from tactcad.design.fields import present
from tactcad.parts import rigs
from tactcad.parts.array.board_plate import BOARD_OUTLINE, EDGE, PLATE_AHEAD, STAND_OFF
from tactcad.parts.array.board_plate import PLATE as BOARD_PLATE
from tactcad.parts.array.leads import BESIDE as BOARDS_OFF
from tactcad.parts.array.leads import Bench, stands
from tactcad.parts.array.supplies import supplies
from tactcad.parts.bought import screws, standard_parts
from tactcad.parts.bought.standard_parts import STAGES, bearing
from tactcad.parts.language.description import Vector, vector
from tactcad.parts.rigs.cart import LOOSE_WHEEL, CartLayout
from tactcad.parts.rigs.force_gauge import GAUGE_SCREW_X, GAUGE_SCREW_Z, GAUGE_THREADS, roller_length
from tactcad.parts.rigs.frame import (
    BASE,
    GAUGE_SHAFT,
    PLATE,
    PLATE_SCREW,
    POST,
    POST_Y,
    STAGE,
    STAGE_HOLE,
    STAGE_PLATE,
    TIP,
)
from tactcad.parts.rigs.stand import BASE_SCREW, BASE_UNDER_HEAD, POST_SCREWS, StandLayout

from .builder import Builder, telling
from .moves import APPROACH
from .scene import AGAINST_Y, ALONG_Y, STILL, Move, Need

said = telling(__file__)

CORNERS = tuple((sx, sy) for sx in (-1, 1) for sy in (-1, 1))
STAND = "BP1"  # the base plate
AXIS_LIFT = 200.0  # exploded views: the vertical axis over everything else
THREAD, LENGTH, UNDER = PLATE_SCREW
SQUARE = "precision square, 100 mm"
SHIMS = "shim foil, 0.01 and 0.02 mm, scissors"
BESIDE: Vector = (-300.0, 0.0, 2.0)  # of the cart during its assembly, mm from its place on the base plate
OVER: Vector = (0.0, 0.0, 2.0)
WHEELS_LOOSE = ("shims and bearings on their axles: along x and z; along y, between plate and head",)
WHEELS_RISE = ("axles: by their play in the bores, until they are tight", "bearings: turn about y")
WHEELS_TIGHT = ("axles in the cart plate: all, by their threads", *WHEELS_LOOSE)
WHEELS_TURN = ("outer rings: turn about y",)
RAISED = 6.0  # mm that the force axis is driven up while something is brought in under it
# of usual thickness none enters between tip and gauge
JAM_SPANNER = f"spanner {screws.JAM_NUT[2][0]:g} mm, 3 mm thick: the tip's jam nut"


def place_stand(b: Builder, rig: StandLayout, stages: bool) -> str:
    """Base plate (STAND) and post; returns the post's designator."""
    b.unit("stand")
    b.supplies += supplies("stand", {})
    base = b.place("BP", rigs.base_plate(rig), (0, 0, -BASE[1]))
    post = b.place("PO", rigs.post(rig), (0, POST_Y, 0), ALONG_Y)
    b.meet(base, post)
    for x, y in POST_SCREWS:
        at = (x, POST_Y + POST[1] / 2 + y, -BASE_UNDER_HEAD)
        b.screw("M5", BASE_SCREW, at, (0, 0, 1), base, post)
    b.step("Stand", (0, 0, 0) if stages else (0, 0, -60), said("Stand"), tools=(SQUARE, SHIMS))
    return post


def place_cart(b: Builder, rig: CartLayout, roll: float) -> str:
    """Cart with holder, assembled next to the base plate; returns the lid's designator."""
    b.group("cart")
    b.unit("cart with holder and sample")
    c, bear = rig.cart, rig.bearing
    plate = b.place("CT", rigs.cart_plate(rig), (roll, 0, c.clearance))
    shim, wheel = rigs.axle_shim(rig), bearing(c.bearing)
    side, outer = c.width / 2, c.width / 2 + c.shim + bear.B
    b.step("Cart plate", (0, 0, 25), "Lay the cart plate ready, holder's threads up.", bench=True, at=BESIDE)
    for sy, which in ((-1, "front"), (1, "back")):
        xs, z = [roll + sx * c.wheel_base / 2 for sx in (-1, 1)], rig.axle_z

        def y(start: float, thick: float, sy: int = sy) -> float:
            return start if sy > 0 else -start - thick

        order = []
        inner = [b.place("SH", shim, (x, y(side, c.shim), z), ALONG_Y) for x in xs]
        balls = [b.place("BB", wheel, (x, y(side + c.shim, bear.B), z), ALONG_Y) for x in xs]
        far = [b.place("SH", shim, (x, y(outer, c.shim), z), ALONG_Y) for x in xs]
        for x, near, ball, beyond in zip(xs, inner, balls, far):
            at = (x, y(outer + c.shim, 0), z)
            axle = b.screw(rig.axle_thread, rig.axle_length, at, (0, -sy, 0), beyond, plate)
            b.meet(plate, near)
            b.meet(near, ball)
            b.meet(ball, beyond)
            b.meet(axle, ball, "press")
            b.meet(ball, STAND)
            order.append((axle, near, ball, beyond))
        b.step(
            f"Wheels, {which}",
            (0, sy * 70, 25),
            "Put shim, bearing, shim on each axle and start its thread; polish a shank that the bearing "
            "does not pass." + (said("all wheels", loose_wheel=LOOSE_WHEEL, c=c) if sy > 0 else ""),
            order=order,
            sets=WHEELS_TIGHT if sy > 0 else WHEELS_LOOSE,
            leaves=WHEELS_TURN if sy > 0 else WHEELS_RISE,
            fan=2,
            bench=True,
            at=BESIDE,
            tools=("surface plate, grade 1 or better", f"feelers, {LOOSE_WHEEL * 1e3:g} um"),
        )
    h, (length, under) = rig.holder_screw, present(rig.holder_fixing)
    body = b.place("HB", rigs.holder_body(rig), (roll, 0, rig.cart_top))
    top = rig.cart_top + rig.holder_body
    ring = b.place(
        "OR", standard_parts.o_ring(present(rig.o_ring)), (roll, 0, top - standard_parts.GROOVE_DEPTH)
    )
    b.meet(plate, body)
    b.meet(body, ring)
    b.step(
        "Holder's body and seal",
        (0, 0, 60),
        "Grease the O-ring with a trace of silicone grease and lay it in the body's groove.",
        fan=1,
        bench=True,
        at=BESIDE,
    )
    fitting = b.place(
        "HF", rigs.hose_fitting(), (roll, -rig.holder_side / 2, top - rig.port_depth), AGAINST_Y
    )
    b.meet(fitting, body, "thread")
    b.step(
        "Hose fitting",
        (0, -40, 45),
        "Screw the hose fitting in by hand and a quarter turn more; its washer seals.",
        sets=(f"{fitting} in {body}: all, by its thread",),
        bench=True,
        at=BESIDE,
    )
    lid = b.place("HL", rigs.holder_lid(rig), (roll, 0, top))
    b.meet(body, lid)
    b.meet(ring, lid)
    for sx, sy in CORNERS:
        at = (roll + sx * h, sy * h, top + under)
        b.screw("M3", length, at, (0, 0, -1), lid, plate)
    b.step("Holder's lid", (0, 0, 95), said("Holder's lid"), fan=1, bench=True, at=BESIDE)
    b.supplies += supplies("vacuum", {}, vacuum=rig.holder.vacuum)
    b.group(None)
    return lid


def cart_on_base(b: Builder, before: Sequence[Move] = (), text: str = "") -> None:
    """The step that brings the cart in over the base plate, from the side."""
    cart = tuple(b.groups["cart"])
    b.step(
        "Cart on the base plate",
        (0, 0, 0),
        "Bring the cart in from the side and set it down on the base plate: it must roll at a breath, and "
        f"stand still where it is left. {text}".rstrip(),
        order=[*before, Move(cart, BESIDE, (OVER, STILL))],
        sets=("wheels on BP1: along z, turn about x and y",),
        leaves=("cart: rolls along x",),
    )


def place_sample(
    b: Builder,
    rig: CartLayout,
    roll: float,
    lid: str,
    dents: tuple[tuple[float, float], ...] = (),
    depth: float = 0.0,
    above: float = 2 * APPROACH,
) -> str:
    """The sample on the holder's lid, brought in from the front under what hangs `above` mm over its place;
    returns its designator."""
    b.group("cart")
    b.unit("cart with holder and sample")
    object_ = b.place("SA", rigs.sample(rig, dents, depth), (roll, 0, rig.lid_top))
    b.meet(lid, object_)
    front, high = -200.0, min(APPROACH, above / 2)
    b.step(
        "Sample",
        (0, 0, 82),
        "Lay the sample on the middle of the lid, clean and dry, and open the vacuum.",
        order=[Move((object_,), (0.0, front, high), ((0.0, 0.0, high), STILL))],
        sets=(f"{object_} on {lid}: all, by the vacuum",),
        leaves=(f"{object_}: all, while the vacuum is shut",),
    )
    b.group(None)
    return object_


def boards_on_bench(b: Builder, rig: StandLayout, bench: Bench, turned: float = 1.0) -> None:
    """The step that brings the boards, on their plates: bench equipment beside the base plate. `turned`: 1.0,
    or -1.0 if the array's y runs against the scene's."""
    on = f"blocks {bench.block:g} mm high" if bench.block else "the bench"
    near = rig.base_length / 2 + BOARDS_OFF
    far = near + PLATE_AHEAD + BOARD_OUTLINE.connector[1] + EDGE
    top = bench.block + BOARD_PLATE + STAND_OFF + BOARD_OUTLINE.thickness + BOARD_OUTLINE.highest - BASE[1]
    half, order = BOARD_OUTLINE.width / 2 + EDGE, []
    for n, stand in enumerate(stands(rig.array), start=1):
        y, (low, high) = turned * stand.y, sorted((stand.side * near, stand.side * far))
        name = f"board A{n} on its plate" + (f" and a block of {bench.block:g} mm" if bench.block else "")
        board = b.aid(name, (low, y - half, -BASE[1]), (high, y + half, top))
        order.append(Move((board,), (0.0, 0.0, 2 * APPROACH), (STILL,)))
    b.step(
        "Boards on the bench",
        (0, 0, 0),
        said("Boards on the bench", on=on, boards_off=BOARDS_OFF),
        order=order,
        leaves=("boards: along x and y, by the leads' slack", "sockets: up, by hand"),
        needs=(Need(("CA1", STAND), "its leads reach boards beside the base plate"),),
    )


def place_force_axis(
    b: Builder, rig: StandLayout, post: str, touch: float, height: float, roller: bool
) -> tuple[str, list[Move]]:
    """Vertical stage with the force gauge, tip at z = touch + height; returns the tip's (or roller's)
    designator, and the moves that put jam nut and tip on its shaft."""
    b.unit("force axis")
    travel = present(rig.design.calibration).axis_travel
    stage = replace(STAGES[0], travel=travel)
    resolution = present(rig.design.calibration).micrometer_resolution
    aside = min(travel, STAGE / 2)  # the screws are free by then; further down is the base
    zs, z = rig.stage_middle(touch), rig.axis_middle(touch) + height
    y = POST_Y
    fixed = b.place("SF", rigs.stage_fixed(stage), (0, y, zs), AGAINST_Y)
    b.meet(post, fixed)
    fixings = [
        (
            sy,
            b.screw(
                THREAD, LENGTH, (sx * STAGE_HOLE, y - UNDER, zs + sy * STAGE_HOLE), (0, 1, 0), fixed, post
            ),
        )
        for sx, sy in CORNERS
    ]
    head = b.place("MM", rigs.micrometer(travel, resolution), (0, y - STAGE_PLATE / 2, zs + 30.0))
    b.meet(fixed, head)
    b.group("axis")
    moving = b.place("SM", rigs.stage_moving(stage), (0, y - STAGE_PLATE, z), AGAINST_Y)
    b.meet(fixed, moving)
    b.group(None)
    b.step(
        "Vertical stage",
        (0, -40, AXIS_LIFT),
        said("Vertical stage", below=zs - STAGE_HOLE, above=zs + STAGE_HOLE),
        order=[(fixed, moving, head), *driven((moving,), fixings, (0.0, 0.0, 1.0), aside, z - height - zs)],
        tools=(SQUARE, SHIMS, "lever indicator, 1 um, on a stand"),
    )
    b.group("axis")
    back = y - 2 * STAGE_PLATE
    plate = b.place("AP", rigs.axis_plate(rig), (0, back - PLATE, z), ALONG_Y)
    b.meet(moving, plate)
    for sx, sy in CORNERS:
        b.screw(
            THREAD, LENGTH, (sx * STAGE_HOLE, back - UNDER, z + sy * STAGE_HOLE), (0, 1, 0), plate, moving
        )
    b.step("Axis plate", (0, -80, AXIS_LIFT), "Screw the axis plate on the stage's moving half.")
    front = back - 2 * PLATE
    gauge_plate = b.place("GP", rigs.gauge_plate(rig), (0, front, z), ALONG_Y)
    gauge_end = rig.gauge_bottom(touch) + height - GAUGE_SHAFT
    gauge = b.place("FG", rigs.force_gauge(rig), (0, 0, gauge_end))
    b.meet(gauge_plate, gauge)
    for dz in GAUGE_THREADS:
        b.screw(THREAD, LENGTH, (0, front + UNDER, z + dz), (0, -1, 0), gauge_plate, gauge)
    b.step(
        "Force gauge",
        (0, -130, AXIS_LIFT),
        "On the bench: screw the force gauge on its plate from behind, heads sunk.",
        bench=True,
    )
    b.meet(plate, gauge_plate)
    for sx, sy in CORNERS:
        at = (sx * GAUGE_SCREW_X, front + PLATE - UNDER, z + sy * GAUGE_SCREW_Z)
        b.screw(THREAD, LENGTH, at, (0, 1, 0), gauge_plate, plate)
    b.step("Gauge on its axis", (0, -150, AXIS_LIFT), said("Gauge on its axis"))
    tip_z = touch + height
    if roller:
        r = standard_parts.dowel_diameter(present(rig.design.calibration).roller) / 2
        tip = b.place("TI", rigs.roller_tip(rig), (0, 5.0, tip_z), AGAINST_Y)
        length = roller_length(rig.array)
        contact = b.place(
            "RO",
            standard_parts.dowel(present(rig.design.calibration).roller, length),
            (0, length / 2, tip_z + r),
            AGAINST_Y,
        )
    else:
        tip = contact = b.place("TI", rigs.flat_tip(rig), (0, 0, tip_z))
    b.meet(gauge, tip, "thread")
    nut = b.place("JN", screws.jam_nut(), (0, 0, tip_z + TIP))
    b.meet(tip, nut)
    b.meet(gauge, nut, "thread")
    b.group(None)
    under = [(0.0, -120.0, -15.0), (0.0, 0.0, -15.0), STILL]  # in from the front under the shaft, then up
    order = [
        Move(names, under[0], tuple(under[1:])) for names in ((nut,), tuple(dict.fromkeys((tip, contact))))
    ]
    return contact, order


def raised(b: Builder, down: bool = False) -> Move:
    """The force axis driven up by RAISED, or down again."""
    up = (0.0, 0.0, RAISED)
    return Move(tuple(b.groups["axis"]), up if down else STILL, (STILL if down else up,), "its micrometer")


def driven(
    moving: tuple[str, ...],
    fixings: Sequence[tuple[int, str]],
    axis: Vector,
    travel: float,
    off: float = 0.0,
    at: Vector = STILL,
) -> list[Move | tuple[str, ...]]:
    """Fix a stage: its moving half, with the parts on it, is driven to one end, the screws of the side that
    is then free go in, then those of the other side, and it is driven back.

    `fixings` are the screws, each with the side along the axis that it is on; `off`: final distance, mm, of
    the moving half from the middle of its travel; `at`: the stage's place meanwhile.
    """
    by, here = "its micrometer", at
    moves: list[Move | tuple[str, ...]] = []
    for side in (-1, 1):
        there = vector(p + (-side * travel - off) * a for p, a in zip(at, axis))
        moves.append(Move(moving, here, (there,), by))
        moves += [(name,) for on, name in fixings if on == side]
        here = there
    return [*moves, Move(moving, here, (at,), by)]
