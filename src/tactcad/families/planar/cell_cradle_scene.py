"""The calibration's three scenes: the cradle on its foot z, x or y, and what hangs on one pad."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Literal

from tactcad.parts.array.supplies import supplies as bill_lines
from tactcad.parts.bought.standard_parts import dowel
from tactcad.parts.language.description import Vector, vector
from tactcad.parts.language.metric import METRIC
from tactcad.parts.rigs.frame import STANDARD_GRAVITY
from tactcad.scenes.builder import Builder, telling
from tactcad.scenes.moves import APPROACH, PRESS, TWEEZED
from tactcad.scenes.rig import Rig, plain_rig, require_element
from tactcad.scenes.scene import AGAINST_Y, DOWN, HAND, REST, STILL, UPRIGHT, Move, Pose, Rotation, Scene

from . import cell_board, parts
from . import cell_cradle as cradle
from .cell_cradle import CradleLayout
from .cell_layout import CellPlace, PlanarLayout
from .cell_loads import FITS, OFF_AXIS, OFF_LEVEL, OFF_MIDDLE, STEPS, loads, requirements
from .cell_tables import PlanarDesign

said = telling(__file__)

Axis = Literal["z", "x", "y"]
# From the array's axes to the scene's, whose z points up: the load's axis downwards, pads to the front.
STANDS: dict[Axis, Rotation] = {
    "z": UPRIGHT,
    "x": ((0, 1, 0), (0, 0, -1), (-1, 0, 0)),
    "y": ((-1, 0, 0), (0, 0, -1), (0, -1, 0)),
}
HALF_TURN: Rotation = ((-1, 0, 0), (0, -1, 0), (0, 0, 1))  # the cradle's frame in the array's
ACROSS: Rotation = ((0, 0, 1), (1, 0, 0), (0, 1, 0))  # the hanger's sheet across x
AWAY = 60.0  # mm that hangers come from; chosen: a hand's width
TOOLS = ("spirit level, 0.1 mm/m", "balance, 1 mg", "tweezers of plastic")


def _mounted(rig: CradleLayout) -> Builder:
    """The array in its cradle, which lies on foot z, in the array's axes."""
    b, seat, (hx, hy) = Builder(), rig.seat, rig.layout.half
    block = b.place("CR", cradle.cradle(rig), (0.0, 0.0, seat - cradle.THICK), HALF_TURN)
    b.step("Cradle", (0, 0, -30), "Lay the cradle down on its foot z, seat up.")
    for x, y in rig.pins:
        pin = b.place("DP", dowel(cradle.PIN, rig.pin_length), (x, y, seat - rig.pin_depth))
        b.meet(pin, block, "press")
    out = rig.height - cradle.PIN_SHORT
    b.step(
        "Pins",
        (0, 0, 20),
        f"Press the three pins in until {out:.3g} mm stand out.",
        tools=(PRESS, f"a sleeve {out:.3g} mm long as stop"),
    )
    own = [b.place("AR", cradle.array(rig), (0.0, 0.0, rig.layout.pad_z), DOWN, on=block)]
    if rig.tongue:
        own.append(b.place("AR", cradle.tongue(rig), (0.0, 0.0, seat)))
        at = (0.0, -hy - rig.tongue + cell_board.EDGE, rig.layout.board_z)
        own.append(b.place("AR", cradle.plug(rig), at))
        b.meet(own[1], own[0])
        b.meet(own[1], own[2])
        b.meet(own[1], block)
    under = seat - METRIC[parts.SCREW].head_height
    for x, y in parts.screw_places(rig.layout):
        own.append(b.place("AH", cradle.head(rig), (x, y, under), on=own[0]))
    b.step(
        "Array in the cradle",
        (0, 0, 30),
        said("Array in the cradle"),
        order=[tuple(own)],
        sets=("AR1 on CR1: along z", "AR1 against DP1 DP2 DP3: along x and y, turn about z"),
        leaves=("AR1: away from the pins, until it is clamped",),
    )
    b.place("CH", cradle.heel(rig), (-hx, 0.0, seat), on=block)
    bar = b.place("CB", cradle.clamp(rig), (-hx, 0.0, rig.cover_top), on=own[0])
    for x, y in cradle.clamp_screws(rig):
        at = (x, y, rig.cover_top + cradle.BAR)
        b.screw(cradle.CLAMP_SCREW, rig.clamp_screw, at, (0, 0, -1), bar, block)
    b.step("Clamp", (0, 0, 45), said("Clamp", cradle=cradle))
    return b


def scene(design: PlanarDesign, pose: Pose = REST, *, along: Axis) -> Scene:
    """The load along z, x or y of the array on the pad of pose.element."""
    layout = PlanarLayout(design)
    rig, places = CradleLayout(layout), layout.elements
    require_element(pose, len(places))
    b, edge = _mounted(rig), "with its pins' end over the table's edge, so that the hanger goes round it"
    if along != "z":
        ready = b.scene("calibration-z")
        b = Builder()
        b.subassembly(ready, STANDS[along], STILL)
        edge = "with its seat flush with the table's edge, so that what hangs on a pad passes the table"
    b.step(
        f"Cradle on its foot {along}",
        (0, 0, 0),
        f"Stand the cradle on its foot {along}, {edge}, and hold it down with a clamp. Level the table under "
        "it to 0.2 mm/m, both ways.",
        tools=TOOLS,
    )
    cap, hung = _hung(b, rig, along, places[pose.element - 1])
    b.supplies += bill_lines("cells calibration", {})
    b.step("Weights", (0, 0, 0), _weights(rig, along))
    n = pose.element
    _every_cell(b, rig, along, cap, hung, (places[n - 1], *places[n:], *places[:n]))
    b.step("Readings", (0, 0, 0), _readings(rig, along))
    return b.scene(f"calibration-{along}")


def _hung(b: Builder, rig: CradleLayout, along: Axis, cell: CellPlace) -> tuple[str, str]:
    """The cap on the cell's pad, and hanger or link on the cap; their designators."""
    at = (cell.x, cell.y, rig.layout.pad_z)
    x, y, z = (sum(r * p for r, p in zip(row, at)) for row in STANDS[along])
    cap = b.place("CA", cradle.cap(rig), (x, y, z), UPRIGHT if along == "z" else AGAINST_Y, on="AR1")
    b.step(
        "Cap on a pad",
        (0, 0, 20) if along == "z" else (0, -20, 0),
        said("Cap on a pad", cell=cell),
        by=TWEEZED,
        sets=(f"{cap} on the pad: along z; along x and y, turn about x and y by its bore",),
        leaves=(f"{cap}: turns about the post",),
    )
    if along == "z":
        hung = b.place("HA", cradle.hanger(rig), (x - cradle.SHEET / 2.0, y, rig.tip), ACROSS, on=cap)
        text = (
            "Bring the hanger in from the overhanging end, around array and cradle, and set its nib into the "
            "cap's dimple. It must swing freely."
        )
    else:
        at = (x, y + cradle.SHEET / 2.0, z - rig.sunk)
        hung = b.place("LI", cradle.link(rig), at, AGAINST_Y, on=cap)
        text = (
            "Bring the link's arc over the cap and let it down into the groove: it hangs there past the "
            "posts below, on both sides of them, and touches nothing else."
        )
    far, high = _way(rig, along, cell, STILL)
    b.step(
        "Hanger" if along == "z" else "Link",
        (40, 0, 0) if along == "z" else (0, -40, 0),
        text + " Hang the pan into its eye.",
        order=[Move((hung,), far, (high, STILL))],
        sets=(f"{hung} on {cap}: along {along if along == 'z' else 'z'}",),
        leaves=(f"{hung} on {cap}: swings until it hangs plumb",),
    )
    return cap, hung


def _way(rig: CradleLayout, along: Axis, first: CellPlace, at: Vector) -> tuple[Vector, Vector]:
    """Hanger or link on its way out from over a pad, offsets from the first one's: out, and lifted over the
    cap."""
    x, y, z = at
    if along == "z":
        return (rig.box[2] - first.x + AWAY, y, z + cradle.LIFTED), (x, y, z + cradle.LIFTED)
    return (x, y - AWAY, z + rig.sunk), (x, y, z + rig.sunk)


def _every_cell(
    b: Builder, rig: CradleLayout, along: Axis, cap: str, hung: str, cells: Sequence[CellPlace]
) -> None:
    """Cap and hanger or link from pad to pad; at last on the first one again."""
    first, order, by = cells[0], [], HAND if along == "z" else TWEEZED
    off = (0.0, 0.0, APPROACH) if along == "z" else (0.0, -APPROACH, 0.0)
    offsets = [(cell.x - first.x, cell.y - first.y, 0.0) for cell in cells]
    turned = [vector(sum(r * o for r, o in zip(row, at)) for row in STANDS[along]) for at in offsets]
    for old, new in zip(turned, turned[1:]):
        (out, high), (far, over) = (_way(rig, along, first, at) for at in (old, new))
        order.append(Move((hung,), old, (high, out), by))
        above = (vector(a + o for a, o in zip(at, off)) for at in (old, new))
        order.append(Move((cap,), old, (*above, new), TWEEZED))
        order.append(Move((hung,), out, (far, over, new), by))
    name, how = ("hanger", "as it came in") if along == "z" else ("link", "with the tweezers, as it came in")
    b.step(
        "Every cell",
        (0, 0, 0),
        said("Every cell", name=name, how=how),
        order=order,
        sets=(f"{cap} on each pad in turn: along z; along x and y, turn about x and y by its bore",),
    )


def _weights(rig: CradleLayout, along: Axis) -> str:
    """Loads by kind of cells."""
    hung = "hanger" if along == "z" else "link"
    kinds = "; ".join(
        f"on {load.kind} cells {STEPS} steps of {load.step:g} g ({load.tare * 1e3 / STANDARD_GRAVITY:.2g} g "
        f"of cap and {hung} included {load.most:.2g} N, and they bear {load.heaviest:.2g} N)"
        for load in loads(rig, along)
    )
    return said("weights", hung=hung, kinds=kinds, rig=rig)


def _readings(rig: CradleLayout, along: Axis) -> str:
    """The order of cells, the table, and what the rig adds to the error."""
    if along == "z":
        off, other = OFF_MIDDLE, "across"
        what = f"a load {off:g} mm from the pad's middle tips its cell like"
    else:
        off, other = OFF_LEVEL, "more or less"
        what = f"a groove {off:g} mm from the pad's level is like"
    return said(
        "readings",
        newton=STANDARD_GRAVITY * 1e-3,
        along=along,
        what=what,
        share=100 * off / rig.layout.pad_height,
        other=other,
        off_axis=OFF_AXIS,
        turned=OFF_AXIS / 10,
    )


def rig(along: Axis) -> Rig:
    """The declaration of one of the three scenes."""

    def poses(design: PlanarDesign) -> Iterator[Pose]:
        """Cells in the other corners of the plane."""
        p = design.planar
        last = p.rows * p.columns
        yield from (Pose(element=n) for n in sorted({p.columns, last - p.columns + 1, last} - {1}))

    plain = plain_rig(f"calibration-{along}", partial(scene, along=along), FITS, requirements)
    return replace(plain, tables=("calibration",), poses=poses)
