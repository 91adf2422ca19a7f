"""Calibration: the array on its back on two micro-stages, the force gauge's roller on one element's pad."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import floor

from tactcad.design.fields import present
from tactcad.design.tree import Design
from tactcad.parts import rigs
from tactcad.parts.array.element import deflected_element, element_number
from tactcad.parts.bought.standard_parts import dowel_diameter
from tactcad.parts.language.finding import Finding, Severity
from tactcad.parts.rigs.frame import (
    PLATE,
    carrier_pattern,
    carrier_screw_length,
    pad_middles,
    under_carrier_screw,
)
from tactcad.parts.rigs.stand import StandLayout, calibration_bench
from tactcad.parts.rigs.stiffness import calibration_lines, calibration_loads, series_give
from tactcad.parts.rules.calibration_rules import FITS

from ..builder import Builder, telling
from ..moves import APPROACH, driver
from ..rig import Rig, require_element
from ..rig_requirements import roller
from ..scene import (
    AGAINST_Y,
    DOWN,
    REST,
    STILL,
    Motion,
    Move,
    Need,
    Placement,
    Pose,
    Rotation,
    Scene,
    Vector,
    whole_um,
)
from ..shared_rigs import (
    AXIS_LIFT,
    BESIDE,
    CORNERS,
    JAM_SPANNER,
    LENGTH,
    OVER,
    RAISED,
    STAND,
    THREAD,
    UNDER,
    boards_on_bench,
    driven,
    place_force_axis,
    place_stand,
    raised,
)
from .array import array, carrier_tools, flatness_tools

said = telling(__file__)

BACK_DOWN: Rotation = DOWN  # half a turn about x: pads up
FRONT = -250.0  # mm along y, where the mount is assembled
IN_FRONT: Vector = (0.0, FRONT, RAISED / 2)  # from its final place
BLOCK = (35.0, 9.0)  # mm: section of gauge blocks over 10 mm (ISO 3650)
Names = tuple[str, ...]
ROLLED = 0.8  # of the gauge's range, on the block; chosen: a step more is no overload
Mounted = tuple[Names, str, Names, Names]  # array, mount, screws into the carrier and into the stage
OUT_OF_X: Rotation = ((0, 0, -1), (0, 1, 0), (1, 0, 0))  # local z runs along -x


def calibration(design: Design, pose: Pose = REST) -> Scene:
    """Scene `calibration`: the roller on the pad of pose.element, which it has pushed pose.deflection mm
    down.

    pose.height lifts the roller. Raises InputError if the array has no such element.
    """
    rig = StandLayout(design)
    pads = pad_middles(rig.array)
    require_element(pose, len(pads))
    px, py = pads[pose.element - 1]
    dx, dy = -px, py  # the array lies on its back: its y runs against the scene's
    b = Builder()
    post = place_stand(b, rig, stages=True)
    under = _stages(b, rig, dx, dy)
    contact, tip = place_force_axis(b, rig, post, rig.pads_up, pose.height - pose.deflection, roller=True)
    c, tall = present(design.calibration), rig.pads_up - 2 * rig.stage.height
    low = (-BLOCK[0] / 2, -BLOCK[1] / 2, 2 * rig.stage.height)
    block = b.aid(f"steel block of {tall:g} mm", low, (-low[0], -low[1], rig.pads_up))
    b.meet(contact, "TI1", "press")
    b.step(
        "Roller tip",
        (0, -130, AXIS_LIFT - 40),
        said("Roller tip", raised=RAISED, tall=tall),
        order=[
            *tip,
            raised(b),
            Move((block,), (0.0, -150.0, RAISED / 2), ((0.0, 0.0, RAISED / 2), STILL)),
            raised(b, down=True),
            Move(("JN1",), STILL, (STILL,), JAM_SPANNER),
        ],
        tools=(JAM_SPANNER, "gauge blocks, steel", "epoxy adhesive, two parts"),
        needs=(Need(("CA1",), "the block is where the array will be", away=True),),
        sets=(f"{contact} in TI1: all, by adhesive", "TI1 to FG1: all, by JN1"),
    )
    b.step(
        "Stiffness of gauge and stand",
        (0, 0, 0),
        said(
            "Stiffness of gauge and stand",
            most=ROLLED * c.load_cell_range,
            series=_series(design),
            raised=RAISED,
        ),
        order=[raised(b), Move((block,), STILL, ((0.0, 0.0, RAISED / 2), (0.0, -150.0, RAISED / 2)))],
        needs=(
            Need((contact, under), "the roller presses a block on the upper stage"),
            Need(("CA1",), "the block is where the array will be", away=True),
        ),
    )
    mounted = _mounted_array(b, rig, under, contact, dx, dy, pose)
    boards_on_bench(b, rig, calibration_bench(rig.array), -1.0)
    b.step(
        "Calibrate",
        (0, 0, 0),
        said("Calibrate", c=c, step=c.step * 1e3, travel=c.travel * 1e3, limits=_limits(design)),
        elements=True,
        order=[raised(b, down=True)],
        needs=(Need((contact, "E1"), "the roller presses its pads"),),
    )
    b.step(
        "Take the array off, then fit the stop plate",
        (0, 0, 0),
        said("Take the array off, then fit the stop plate", raised=RAISED),
        tools=(*flatness_tools(rig.array), *carrier_tools(design)),
        order=[raised(b), *_off(b.placements, mounted)],
        apart=True,
    )
    if pose.height == 0:
        b.meet(contact, f"E{pose.element}")
    return b.scene("calibration", _motions(design, pads, px, py), cover=b.groups["axis"])


def _stages(b: Builder, rig: StandLayout, dx: float, dy: float) -> str:
    """The y stage on the x stage, both on the base plate; returns the moving half on top.

    They are put together on the bench: on the base plate a large y stage would meet the post before its
    screws are free.
    """
    b.unit("stages")
    stage = rig.stage
    fixed, moving = rigs.stage_fixed(stage), rigs.stage_moving(stage)
    head = rigs.micrometer(stage.travel, 0.01)
    t, half = stage.plate, stage.size / 2
    below, at = STAND, (0.0, 0.0)
    stages: list[tuple[str, ...]] = []
    seats: list[tuple[str, str, Vector]] = []  # fixed half, the part under it, the middle of its threads
    for level, (axis, out, side) in enumerate((("x", OUT_OF_X, (-1, 0)), ("y", AGAINST_Y, (0, -1)))):
        z = 2 * t * level
        b.group(None if axis == "x" else "stage-x")
        low = b.place("SF", fixed, (*at, z))
        b.meet(below, low)
        seats.append((low, below, (*at, z + UNDER)))
        micrometer = b.place("MM", head, (at[0] + side[0] * half, at[1] + side[1] * half, z + t / 2), out)
        b.meet(low, micrometer)
        at = (dx, 0.0) if axis == "x" else (dx, dy)
        b.group("stage-x" if axis == "x" else "stage-y")
        high = b.place("SM", moving, (*at, z + t))
        b.meet(low, high)
        stages.append((low, high, micrometer))
        below = high

    def fixed_by(level: int) -> list[tuple[int, str]]:
        """Screws of a stage, each with the side along its travel that it is on."""
        low, on, (x, y, z) = seats[level]
        screws = []
        for sx, sy in CORNERS:
            place = (x + sx * stage.hole, y + sy * stage.hole, z)
            screws.append(((sx, sy)[level], b.screw(THREAD, LENGTH, place, (0, 0, -1), low, on)))
        return screws

    b.group("stage-x")
    upper_fixings = fixed_by(1)  # first on the bench, so first by number
    b.group(None)
    fixings = [fixed_by(0), upper_fixings]
    (x_fixed, x_moving, x_micrometer), upper = stages
    on_x, on_base = ([name for _, name in screws] for screws in reversed(fixings))
    b.step(
        "Stage along y on stage along x",
        (0, 0, 55),
        said("Stage along y on stage along x"),
        bench=True,
        at=BESIDE,
        later=on_base,
        sets=(f"{upper[0]} to {x_moving}: all, by {' '.join(on_x)}",),
        leaves=(
            f"{x_moving} on {x_fixed}: along x, by {x_micrometer}",
            f"{upper[1]} on {upper[0]}: along y, by {upper[2]}",
        ),
        order=[stages[0], upper, *driven((upper[1],), fixings[1], (0.0, 1.0, 0.0), stage.travel, dy, BESIDE)],
    )
    b.step(
        "Stages on the base plate",
        (0, 0, 30),
        said("Stages on the base plate"),
        order=[
            Move((x_fixed, x_moving, x_micrometer, *upper, *on_x), BESIDE, (OVER, STILL)),
            *driven((x_moving, *upper, *on_x), fixings[0], (1.0, 0.0, 0.0), stage.travel, dx),
        ],
    )
    return below


def _mounted_array(
    b: Builder, rig: StandLayout, under: str, roller: str, dx: float, dy: float, pose: Pose
) -> Mounted:
    """The array on its mount, pads up, on the upper stage."""
    z = 2 * rig.stage.height
    b.group("stage-y")
    b.unit("array on its mount")
    mount = b.place("AM", rigs.array_mount(rig), (dx, dy, z))
    b.meet(under, mount)
    carrier_top = rig.array.carrier_bottom + rig.design.clamp.carrier_thickness
    radius = dowel_diameter(present(rig.design.calibration).roller) / 2
    pressed = rig.array.elements[pose.element - 1]
    deflected = (
        {pose.element: deflected_element(rig.array, pressed, pose.deflection, radius)}
        if pose.deflection
        else {}
    )
    standing = array(rig.design, deflected, stops=False)
    b.subassembly(standing, BACK_DOWN, (dx, dy, z + PLATE + carrier_top))
    ready = tuple(p.designator for p in standing.placements)
    b.meet(mount, "CA1")
    screws = []
    for x, y in carrier_pattern(rig.array):
        at = (dx + x, dy + y, z + PLATE - under_carrier_screw(rig.design))
        thread, length = rig.design.clamp.mount_thread, carrier_screw_length(rig.design)
        screws.append(b.screw(thread, length, at, (0, 0, 1), mount, "CA1"))
    b.step("Array on its mount", (0, 0, 120), said("Array on its mount"), bench=True, at=IN_FRONT)
    fixings = []
    for sx, sy in CORNERS:
        at = (dx + sx * rig.stage.hole, dy + sy * rig.stage.hole, z + UNDER)
        fixings.append(b.screw(THREAD, LENGTH, at, (0, 0, -1), mount, under))
    high = (0.0, 0.0, RAISED / 2)
    b.step(
        "Mount on the stages",
        (0, 0, 145),
        said("Mount on the stages"),
        order=[Move((*ready, mount, *screws), IN_FRONT, (high, STILL))],
        needs=(Need((roller,), "a pad's edge is aligned with it"),),
        leaves=("AM1 on SM2: turn about z, to its holes' play, until its screws are tight",),
    )
    b.group(None)
    return ready, mount, tuple(screws), tuple(fixings)


def _off(placements: Iterable[Placement], mounted: Mounted) -> list[Move]:
    """The mount's screws out, it and the array off to the front, and the array off the mount."""
    array, mount, screws, fixings = mounted
    placed = {p.designator: p for p in placements}

    def out(names: Iterable[str], at: Vector, away: float) -> Iterator[Move]:
        x, y, z = at
        for name in names:
            yield Move((name,), at, ((x, y, z + away), (x, 2 * FRONT, z + away)), driver(placed[name].part))

    high = (0.0, 0.0, RAISED / 2)
    return [
        *out(fixings, STILL, 2 * APPROACH),
        Move((*array, mount, *screws), STILL, (high, IN_FRONT)),
        *out(screws, IN_FRONT, -2 * APPROACH),
        Move(array, IN_FRONT, ((0.0, FRONT, IN_FRONT[2] + APPROACH),)),
    ]


def _series(design: Design) -> str:
    """Effect of the stand's and mount's compliance on the apparent stiffness of the stiffest element, and how
    to separate the two.
    """
    give, cell = series_give(design), present(design.calibration).load_cell_stiffness
    known = [load for load in calibration_loads(design) if not load.refused]
    stiffest = max(known, key=lambda load: load.force / load.deflection, default=None)
    seems = ""
    if stiffest is not None:
        softer = give / (give + stiffest.deflection / stiffest.force)
        seems = f": an arm of {stiffest.place.arm:g} mm would seem {softer * 100:.2g} % softer"
    return said("series", give=give * 1e3, cell=1e3 / cell, seems=seems)


def _limits(design: Design) -> str:
    """Load that the calibration puts on each arm, and the travel at which it would do damage."""
    c = present(design.calibration)
    lines, seen = [], set()
    for load in sorted(calibration_loads(design), key=lambda load: load.place.arm):
        if not load.refused and load.place.arm not in seen:
            seen.add(load.place.arm)
            lines.append(
                f"arm {load.place.arm:g} carries {load.force:.2f} N and would yield at "
                f"{floor(load.travel_at_yield * 1e3):g} um"
            )
    return (
        f"Nothing protects the elements here: never turn the micrometer beyond {c.travel * 1e3:g} um "
        "from first touch." + (f" There {', '.join(lines)}." if lines else "")
    )


def _motions(design: Design, pads: Iterable[tuple[float, float]], px: float, py: float) -> tuple[Motion, ...]:
    """Roller down, and with the roller lifted once around all pads, edges and corners of their rectangle."""
    lifted = (0.0, 0.0, present(design.calibration).retract)
    xs, ys = sorted(-(x - px) for x, _ in pads), sorted(y - py for _, y in pads)
    corners = [(xs[0], ys[0]), (xs[-1], ys[0]), (xs[-1], ys[-1]), (xs[0], ys[-1])]
    ways = [Motion("roller down to the pad", (("axis", lifted, (0.0, 0.0, 0.0)),))]
    for n, (start, end) in enumerate(zip(corners, corners[1:] + corners[:1]), start=1):
        ways.append(
            Motion(
                f"stages along side {n} of the pads' rectangle, roller lifted",
                (
                    ("axis", lifted, lifted),
                    ("stage-x", (start[0], 0.0, 0.0), (end[0], 0.0, 0.0)),
                    ("stage-y", (*start, 0.0), (*end, 0.0)),
                ),
            )
        )
    return tuple(ways)


def check_travel(design: Design, _scene: Scene) -> list[Finding]:
    """Fail if the travel makes a hinge yield, flag if it passes the rated deflection; each with the largest
    travel that does not.

    An element whose strength the estimator cannot compute is flagged by the strength check.
    """
    findings = []
    travel = present(design.calibration).travel
    for load in calibration_loads(design):
        if load.refused or load.deflection <= load.rated_deflection:
            continue
        severity: Severity = "fail" if travel > load.travel_at_yield else "flag"
        message = (
            f"{travel:g} mm of travel bend it by {load.deflection:.4g} mm, it is rated "
            f"for {load.rated_deflection:.4g}: calibrate it to {load.travel_at_rated:.4g} mm of travel"
        )
        findings.append(
            Finding(
                "calibration",
                severity,
                load.place.designator,
                (load.place.hinge_x, load.place.hinge.t / 2),
                load.deflection,
                load.rated_deflection,
                message,
                element_number(design, load.place),
            )
        )
    return findings


def _poses(design: Design) -> Iterator[Pose]:
    """Every element under the sensor, deflected by its stage's whole travel: to a micrometre, which a check
    can resolve; an element that the estimator refuses, as if it had no stiffness."""
    travel = present(design.calibration).travel
    for n, load in enumerate(calibration_loads(design), start=1):
        yield Pose(element=n, deflection=whole_um(travel if load.refused else load.deflection))


def _under_sensor(design: Design) -> Iterator[Pose]:
    return (Pose(element=n) for n in range(1, sum(map(len, design.array.row_arms)) + 1))


RIG = Rig(
    name="calibration",
    tables=("calibration",),
    make=calibration,
    poses=_poses,
    under_sensor=_under_sensor,
    rules=FITS,
    deflections=calibration_lines,
    requirements=roller,
    checks=(("calibration travel", check_travel),),
)
