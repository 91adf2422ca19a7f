"""Grasping: the array on a vertical guide comes down on the sample under its own weight and added ones,
trimmed by ballast.

The moving weight is that of the parts placed. The rule on the ballast places them too, with elements that
have no stop gap, because the scenes of a design must be known without the estimator.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import floor, radians, tan

from tactcad.design.fields import present
from tactcad.design.tree import Design
from tactcad.parts import rigs
from tactcad.parts.array.clamp import carrier_screw
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.supplies import supplies
from tactcad.parts.bought.screws import cap_screw
from tactcad.parts.bought.standard_parts import dowel, dowel_diameter
from tactcad.parts.language.description import Vector
from tactcad.parts.language.finding import Finding
from tactcad.parts.rigs.frame import (
    BAR_FRONT,
    CARRIAGE_LENGTH,
    PIN,
    PLATFORM,
    POST_Y,
    RAIL_HEIGHT,
    RISER_PITCH,
    STAGE_HOLE,
    STANDARD_GRAVITY,
    carrier_pattern,
    carrier_screw_length,
    pad_middles,
    under_carrier_screw,
)
from tactcad.parts.rigs.linear_guide import (
    LATCH,
    LATCH_DEPTH,
    LATCH_KEPT,
    LATCH_LENGTH,
    RISER_SCREW,
    RISER_UNDER_HEAD,
    STOP_DEPTH,
    STOP_LENGTH,
    STOP_PIN,
    GuideLayout,
    guide_layout,
    latch_above,
    latch_lies,
    rail_holes,
    stop_below,
)
from tactcad.parts.rigs.moving_weight import (
    BAR_SCREW_X,
    BAR_UNDER_HEAD,
    FOOT_UNDER_HEAD,
    PLATFORM_UNDER_HEAD,
    ballast_thickness,
)
from tactcad.parts.rigs.stand import StandLayout, grasping_bench
from tactcad.parts.rigs.stiffness import grasping_lines
from tactcad.parts.rules.grasping_rules import FITS
from tactcad.parts.rules.rule import fits, wrong

from ..builder import Builder, telling
from ..moves import PRESS
from ..rig import Rig, none
from ..rig_requirements import LEVELLED, LEVELLING_PLATE, SAMPLE, parallel, wheels
from ..scene import (
    AGAINST_Y,
    ALONG_Y,
    REST,
    STILL,
    UPRIGHT,
    Motion,
    Move,
    Need,
    Pose,
    Rotation,
    Scene,
    whole_um,
)
from ..shared_rigs import (
    CORNERS,
    SHIMS,
    SQUARE,
    boards_on_bench,
    cart_on_base,
    place_cart,
    place_sample,
    place_stand,
)
from .array import array, without_gaps

said = telling(__file__)

# Relative difference allowed between the parts' weight and the design's: the ballast is turned to weight
# anyway.
AGREES = 0.005
INNER = (LATCH_KEPT - LATCH, 0.0, 0.0)  # mm, from the latch's outer hole, where the scene has it


def grasping(design: Design, pose: Pose = REST) -> Scene:
    """Scene `grasping`: pads on the sample (pose.deflection mm into it), or pose.height mm over it."""
    rig = guide_layout(design)
    assert rig is not None, "RIG has its tables"
    g = rig.grasping
    weights = g.weights if pose.weights is None else pose.weights
    b = Builder()
    pads = pad_middles(rig.array)
    dents = tuple((x - pose.cart, y) for x, y in pads) if pose.deflection else ()
    lid = place_cart(b, rig.cart, pose.cart)
    post = place_stand(b, StandLayout(design), stages=False)
    rail = _guide(b, rig, post, latched=pose.height == g.lift)
    lift = pose.height - pose.deflection
    below, z = place_axis(b, rig, rail, lift)
    b.group(None)
    up, lid_text = (0.0, 0.0, g.lift), "The array hangs on the latch over it."
    cart_on_base(b, text=lid_text)
    boards_on_bench(b, StandLayout(design), grasping_bench(rig.array))
    axis = tuple(b.groups["axis"])
    b.unit("vertical axis")
    side, top = rig.cart.sample.side / 2, rig.cart.sample_top
    flat = b.aid("flat plate", (-side, -side, rig.cart.lid_top), (side, side, top))
    in_front, over = (0.0, -200.0, g.lift / 2), (0.0, 0.0, g.lift / 2)
    b.step(
        "Pads level with the lid",
        (0, 0, 0),
        said(
            "Pads level with the lid",
            levelled=_levelled(rig.array),
            design=design,
            difference=1e3 * tan(radians(SAMPLE * design.tolerance.tilt)) * rig.cart.sample.side,
        ),
        tools=(f"flat plate, as thick as the sample, parallel within {LEVELLING_PLATE * 1e3:g} um", SHIMS),
        order=[
            Move((flat,), in_front, (over, STILL)),
            *_latched(False),
            Move(axis, up, (STILL,)),
            Move(axis, STILL, (up,)),
            *_latched(True),
            Move((flat,), STILL, (over, in_front)),
        ],
        sets=("CA1: parallel to the lid, by shims under the foot",),
        needs=(
            Need((lid, "CA1"), "the array is lowered on the lid"),
            Need(("SA1",), "a plate lies there", away=True),
        ),
    )
    sample = place_sample(b, rig.cart, pose.cart, lid, dents, pose.deflection, g.lift)
    b.group("axis")
    b.unit("platform with weights")
    disc = rigs.disc_weight(rig)
    discs = []
    for _ in range(weights):
        name = b.place("WT", disc, (0, 0, z))
        discs.append(name)
        b.meet(below, name)
        below, z = name, z + disc.extrusion.thickness
    b.group(None)
    one_by_one = "One disc a loading step, laid on without a knock; each is weighed before. Without any, the"
    b.step(
        "Weights" if weights else "Lower",
        (0, 0, 330 if weights else 0),
        "Hold the platform, put the latch back in its outer hole, and lower the array by hand. "
        f"{one_by_one if weights else 'The'} grasping force is the moving weight: {g.moving_weight:g} N.",
        order=[*_latched(False), Move(axis, up, (STILL,))],
        needs=(Need((sample,), "the array is lowered on it"),),
        sets=("pads on the sample: along z", *(("discs: along x and y by the pin",) if discs else ())),
        leaves=("vertical axis: slides along z", *(("discs: up the pin, turn about z",) if discs else ())),
    )
    if pose.height == 0:
        for place in rig.array.elements:
            b.meet(place.designator, sample)
    c = rig.cart.cart
    still = (0.0, 0.0, 0.0)
    motions = (
        Motion("array down to the sample", (("axis", up, still),)),
        Motion(
            "cart rolls under the lifted array",
            (("axis", up, up), ("cart", (-c.roll, 0.0, 0.0), (c.roll, 0.0, 0.0))),
        ),
        Motion(
            "cart rolls with the array on the sample",
            (("axis", still, still), ("cart", (-c.roll / 5, 0.0, 0.0), (c.roll / 5, 0.0, 0.0))),
        ),
    )
    elements = {p.designator for p in rig.array.elements}
    return b.scene("grasping", motions, cover=set(b.groups["axis"]) - elements)


def _levelled(layout: Layout) -> str:
    """What the sinks on a flat plate must agree within."""
    spans = [max(along) - min(along) for along in zip(*pad_middles(layout))]
    ends = "rows" if spans[0] else "row"
    said = [
        f"{where} within {1e3 * tan(radians(LEVELLED * layout.design.tolerance.tilt)) * span:.1f} um"
        for where, span in ((f"at both ends of the {ends}", spans[1]), ("in both rows", spans[0]))
        if span
    ]
    return f"their means must agree {' and '.join(said)}"


def _latched(on: bool) -> list[Move]:
    """The latch by hand from its outer hole into the inner one, under the carriage, or back."""
    out, over = (0.0, -LATCH_LENGTH, 0.0), (INNER[0], -LATCH_LENGTH, 0.0)
    if on:
        return [Move(("LP1",), STILL, (out, over, INNER))]
    return [Move(("LP1",), INNER, (over, out, STILL))]


def _guide(b: Builder, rig: GuideLayout, post: str, latched: bool) -> str:
    """Riser, rail, end stop, and the latch under the lifted carriage or in store; returns the rail's
    designator."""
    b.supplies += supplies("guide", {})
    front = POST_Y - rig.riser_depth
    z = rig.riser_middle
    length = rig.grasping.rail_length
    riser = b.place("RI", rigs.riser(rig), (0, front, z), ALONG_Y)
    b.meet(post, riser)
    y = front + STOP_DEPTH - STOP_LENGTH
    stop = b.place("ES", dowel(STOP_PIN, STOP_LENGTH), (0, y, z - stop_below(rig)), ALONG_Y)
    b.meet(stop, riser, "press")
    b.step(
        "End stop",
        (0, -50, 110),
        said("End stop", stop_depth=STOP_DEPTH),
        bench=True,
        tools=(PRESS, f"a sleeve {STOP_LENGTH - STOP_DEPTH:g} mm long as stop"),
    )
    for sx, sy in CORNERS:
        at = (sx * STAGE_HOLE, front + rig.riser_depth - RISER_UNDER_HEAD, z + sy * RISER_PITCH)
        b.screw("M4", RISER_SCREW, at, (0, 1, 0), riser, post)
    b.step(
        "Riser",
        (0, -50, 110),
        said("Riser", below=z - RISER_PITCH, above=z + RISER_PITCH),
        tools=(SQUARE, SHIMS),
    )
    rail = b.place("RL", rigs.rail(length), (0, front, z), AGAINST_Y)
    b.meet(riser, rail)
    rail_screws = [
        b.screw("M3", 8.0, (0, front - 3.0, z + dz), (0, 1, 0), rail, riser)
        for dz in sorted(rail_holes(length), key=abs)
    ]
    hole, y = -LATCH if latched else -LATCH_KEPT, front + LATCH_DEPTH - LATCH_LENGTH
    latch = b.place(
        "LP", dowel(STOP_PIN, LATCH_LENGTH), (hole, y, z + latch_above(rig) - latch_lies()), ALONG_Y
    )
    b.meet(riser, latch)
    b.step(
        "Guide rail",
        (0, -85, 110),
        said("Guide rail"),
        tools=("parallel, as long as the rail",),
        order=[
            (rail,),
            *((name,) for name in rail_screws),
            Move((latch,), (0.0, -2 * LATCH_LENGTH, 0.0), (STILL,)),
        ],
        leaves=("LP1: slides along y, by hand",),
    )
    return rail


def check_moving_weight(design: Design, scene: Scene) -> list[Finding]:
    """A finding if the moving parts are heavier than asked for (which no ballast can mend), or lighter."""
    weight, wanted = moving_weight(scene), present(design.grasping).moving_weight
    if abs(weight - wanted) <= AGREES * wanted:
        return []
    message = f"what moves weighs {weight:.4g} N by its parts, grasping.moving_weight asks for {wanted:.4g} N"
    return [Finding("moving-weight", "fail", scene.name, (), weight, wanted, message)]


def _poses(design: Design) -> Iterator[Pose]:
    """Without weights; lifted; and with the pads in the sample: by its travel, but no deeper than they
    protrude from the arms' root fillets."""
    yield Pose(weights=0)
    yield Pose(height=present(design.grasping).lift, weights=0, cart=present(design.cart).roll)
    e = design.element
    deep = whole_um(min(present(design.sample).travel, e.pad_height - e.pad_root_radius))
    if deep > 0:
        yield Pose(deflection=deep)


ALONG_RAIL: Rotation = ((-1, 0, 0), (0, -1, 0), (0, 0, 1))  # carriage: local y out of the rail, z along it
PIN_SCREW = ("M4", 10.0)
CARRIAGE_SCREW = ("M3", 6.0)  # four of them
NEWTON = STANDARD_GRAVITY * 1e-3  # N, weight of a gram
# A thinner disc is not turned flat (chosen); a longer pin, in steps of 5 mm, bends under the tool: 12
# diameters.
LEAST_BALLAST = 0.5
LONGEST_PIN = 5.0 * floor(12 * PIN / 5.0)


def moving_mass(scene: Scene) -> float:
    """Mass of a grasping scene's moving axis without the added weights, g."""
    axis = dict(scene.groups)["axis"]
    return sum(
        p.part.mass for p in scene.placements if p.designator in axis and not p.designator.startswith("WT")
    )


def moving_weight(scene: Scene) -> float:
    """Initial grasping force, N: the moving axis's weight at standard gravity, the guide's friction left
    out."""
    return moving_mass(scene) * NEWTON


def place_axis(b: Builder, rig: GuideLayout, rail: str, lift: float) -> tuple[str, float]:
    """All that moves with the array, trimmed by a ballast; the group `axis` stays open for the weights.

    Returns the designator of what the weights lie on, and the z of its surface (mm).
    """
    before = len(b.placements)
    carriage, bar, platform = _place_carried(b, rig, rail, lift, array(rig.design))
    thick, ballast = _trim(rig, sum(p.part.mass for p in b.placements[before:]) + _carriage_screws_mass())
    z = rig.platform_top + lift
    pin = b.place("PN", rigs.pin(rig, thick), (0, 0, z))
    b.meet(platform, pin)
    b.screw(*PIN_SCREW, (0, 0, z - PLATFORM_UNDER_HEAD), (0, 0, 1), platform, pin)
    b.step("Pin", (0, 0, 280), "Screw the pin on the platform from below.", bench=True)
    below = platform
    if ballast > 0:
        disc = rigs.ballast(rig, ballast)
        below = b.place("BA", disc, (0, 0, z))
        b.meet(platform, below)
        z += disc.extrusion.thickness
        b.step(
            "Ballast",
            (0, 0, 305),
            said("Ballast", rig=rig, grams=rig.grasping.moving_weight / NEWTON),
            tools=("balance, 0.1 g",),
            bench=True,
            sets=(f"{below} on {platform}: along z", f"{below}: along x and y, by the pin"),
            leaves=(f"{below}: up the pin, turn about z",),
        )
    front, up = BAR_FRONT + rig.bar, (0.0, 0.0, rig.grasping.lift)
    for sx in (-1, 1):
        for sy in (-1, 1):
            at = (sx * 7.5, front - BAR_UNDER_HEAD, rig.bar_bottom + lift + rig.carriage_on_bar + sy * 5.0)
            b.screw(*CARRIAGE_SCREW, at, (0, 1, 0), bar, carriage)
    b.meet(bar, carriage)
    b.step(
        "Bar on the carriage",
        (0, -160, 0),
        said("Bar on the carriage"),
        order=[Move((carriage,), _fallen(rig), (up,)), *_latched(True), ()],
        at=up,
    )
    return below, z


def _trim(rig: GuideLayout, mass: float) -> tuple[float, float]:
    """Thickness (mm) and mass (g) of the ballast, from all other moving parts; no mass if those are too
    heavy.

    A pin that is longer because of the ballast weighs slightly more itself, which is taken into account.
    """
    room = rig.grasping.moving_weight / NEWTON - mass - cap_screw(*PIN_SCREW).mass
    thick = ballast_thickness(rig, max(room - rigs.pin(rig).mass, 0.0))
    return thick, max(room - rigs.pin(rig, thick).mass, 0.0)


def ballast_range(rig: GuideLayout) -> tuple[float, float]:
    """Smallest and largest moving weight (N) that a ballast under the weights can trim to.

    Computed without the estimator: elements are taken without a stop gap, with an allowance for the material
    that a gap could remove.
    """
    layout, d = rig.array, rig.design
    b = Builder()
    _place_carried(b, rig, "RL1", 0.0, without_gaps(d))
    heavy = sum(p.part.mass for p in b.placements) + rigs.pin(rig).mass
    heavy += cap_screw(*PIN_SCREW).mass + _carriage_screws_mass()
    over = max(layout.ledge_of(p.hinge) - p.hinge.h for p in layout.elements)
    land = over * (d.stop.land_length + over) * d.sheet.thickness * d.material.density * 1e-6
    light = heavy - land * len(layout.elements)
    grams = 1.0 / ballast_thickness(rig, 1.0)  # mass of a millimetre of disc, g
    stack = rig.grasping.weights * rigs.disc_weight(rig).extrusion.thickness
    longest = rigs.pin(rig, LONGEST_PIN - 1.0 - stack).mass
    most = light + (LONGEST_PIN - 1.0 - stack) * grams
    return (heavy + longest + LEAST_BALLAST * grams) * NEWTON, most * NEWTON


@fits
def ballast_trims_moving_weight(layout: Layout) -> Iterator[Finding]:
    guide = guide_layout(layout.design)
    if guide is None or carrier_screw(layout) is None or layout.hold_down.length is None:
        return  # no array to weigh: the design is refused for that
    wanted = guide.grasping.moving_weight
    try:
        low, high = ballast_range(guide)
    except ValueError:
        return  # contours that cannot be drawn: the design is refused for that
    if low <= wanted <= high:
        return
    within = f"from {low:.4g} to {high:.4g} N"
    legal = within if low < high else "fewer or larger weights: their stack is too high"
    what = "no ballast under the weights brings what moves to it"
    yield wrong("grasping.moving_weight", what, wanted, legal)


def _carriage_screws_mass() -> float:
    return 4 * cap_screw(*CARRIAGE_SCREW).mass


def _fallen(rig: GuideLayout) -> Vector:
    """From the carriage on the sample's top to the carriage on the end stop."""
    lowest = rig.riser_middle - stop_below(rig) + dowel_diameter(STOP_PIN) / 2
    return 0.0, 0.0, round(lowest - (rig.carriage_middle - CARRIAGE_LENGTH / 2), 6)


def _place_carried(
    b: Builder, rig: GuideLayout, rail: str, lift: float, standing: Scene
) -> tuple[str, str, str]:
    """Place the load of the guide, with that array, but for pin and ballast; returns carriage, bar and
    platform."""
    design = rig.design
    b.group("axis")
    b.unit("vertical axis")
    front = BAR_FRONT + rig.bar
    zc = rig.carriage_middle + lift
    carriage = b.place("CG", rigs.carriage(), (0, front + RAIL_HEIGHT, zc - CARRIAGE_LENGTH / 2), ALONG_RAIL)
    b.meet(rail, carriage)
    fallen = _fallen(rig)
    b.step(
        "Carriage",
        (0, -85, 200),
        said("Carriage"),
        order=[Move((carriage,), (0.0, 0.0, 2 * rig.grasping.rail_length), (fallen,))],
        at=fallen,
        leaves=(f"{carriage} on {rail}: slides along z",),
        sets=(f"{carriage} on {rail}: all but z",),
    )
    foot = b.place("FO", rigs.foot(rig), (0, 0, rig.foot_bottom + lift))
    bar = b.place("BR", rigs.bar(rig), (0, BAR_FRONT, rig.bar_bottom + lift), ALONG_Y)
    b.meet(foot, bar)
    for sx in (-1, 1):
        at = (sx * BAR_SCREW_X, rig.bar_middle, rig.bar_bottom + lift - FOOT_UNDER_HEAD)
        b.screw("M4", 10.0, at, (0, 0, 1), foot, bar)
    b.step(
        "Foot and bar",
        (0, -140, 0),
        "On the bench: screw the foot under the bar, from below, square within 0.02 mm.",
        bench=True,
    )
    b.subassembly(standing, UPRIGHT, (0, 0, rig.array_z + lift))
    b.meet("CA1", foot)
    for x, y in carrier_pattern(rig.array):
        at = (x, y, rig.foot_bottom + lift + under_carrier_screw(rig.design))
        b.screw(design.clamp.mount_thread, carrier_screw_length(design), at, (0, 0, -1), foot, "CA1")
    b.step("Array under the foot", (0, -140, -35), said("Array under the foot"), elements=True, bench=True)
    under = PLATFORM_UNDER_HEAD
    z = rig.platform_top + lift
    platform = b.place("PF", rigs.platform(rig), (0, 0, z - PLATFORM))
    b.meet(bar, platform)
    for sx in (-1, 1):
        b.screw(
            "M4", 10.0, (sx * BAR_SCREW_X, rig.bar_middle, z - PLATFORM + under), (0, 0, -1), platform, bar
        )
    b.step("Platform", (0, 0, 250), "Screw the platform on the bar, heads sunk.", bench=True)
    return carriage, bar, platform


RIG = Rig(
    name="grasping",
    tables=("grasping", "sample", "cart", "holder"),
    make=grasping,
    poses=_poses,
    under_sensor=none,
    rules=(*FITS, ballast_trims_moving_weight),
    deflections=grasping_lines,
    requirements=lambda layout, known: [*wheels(layout, known), parallel(layout, known)],
    checks=(("moving weight", check_moving_weight),),
)
