"""Grasping: the array on a vertical guide comes down on the sample under its own weight and added ones."""

from __future__ import annotations

from collections.abc import Iterator

from tactcad.design.present import present
from tactcad.design.tree import Design
from tactcad.parts import rigs
from tactcad.parts.finding import Finding
from tactcad.parts.library.dowels import dowel
from tactcad.parts.rigs.frame import POST_Y, RISER_PITCH, STAGE_HOLE, pad_middles
from tactcad.parts.rigs.guide_layout import GuideLayout, guide_layout
from tactcad.parts.rigs.rail import rail_holes
from tactcad.parts.rigs.riser import (
    LATCH,
    LATCH_KEPT,
    RISER_SCREW,
    RISER_UNDER_HEAD,
    STOP_DEPTH,
    STOP_LENGTH,
    STOP_PIN,
    latch_above,
    latch_lies,
    stop_below,
)
from tactcad.parts.rigs.stand_layout import StandLayout
from tactcad.parts.rigs.stiffness import grasping_lines
from tactcad.parts.rules.grasping_rules import FITS

from ..builder import Builder
from ..common import CORNERS, place_cart, place_stand
from ..moving_axis import ballast_trims_moving_weight, moving_weight, place_axis
from ..rig import Rig, none
from ..rig_requirements import wheels
from ..scene import AGAINST_Y, ALONG_Y, REST, Motion, Pose, Scene, whole_um

# Relative difference allowed between the parts' weight and the design's: the ballast is turned to weight
# anyway.
AGREES = 0.005


def grasping(design: Design, pose: Pose = REST) -> Scene:
    """Scene `grasping`: pads on the sample (pose.deflection mm into it), or pose.height mm over it."""
    rig = guide_layout(design)
    assert rig is not None, "RIG has its tables"
    g = rig.grasping
    weights = g.weights if pose.weights is None else pose.weights
    b = Builder()
    pads = pad_middles(rig.array)
    dents = tuple((x - pose.cart, y) for x, y in pads) if pose.deflection else ()
    sample = place_cart(b, rig.cart, pose.cart, dents, pose.deflection)
    post = place_stand(b, StandLayout(design), stages=False)
    rail = _guide(b, rig, post, latched=pose.height == g.lift)
    lift = pose.height - pose.deflection
    below, z = place_axis(b, rig, rail, lift)
    disc = rigs.disc_weight(rig)
    for _ in range(weights):
        name = b.place("WT", disc, (0, 0, z))
        b.meet(below, name)
        below, z = name, z + disc.extrusion.thickness
    b.group(None)
    if weights:
        b.step(
            "Weights",
            (0, 0, 330),
            "Lift the array by its platform and set the latch under the carriage. Once cart and sample stand "
            "below, hold the platform, put the latch back in its outer hole, and lower the array by hand. "
            "One disc a loading step, laid on without a "
            "knock; each is weighed before. Without any, the "
            f"grasping force is the moving weight: {g.moving_weight:g} N.",
        )
    if pose.height == 0:
        for place in rig.array.elements:
            b.meet(place.designator, sample)
    c = rig.cart.cart
    up, still = (0.0, 0.0, g.lift), (0.0, 0.0, 0.0)
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


def _guide(b: Builder, rig: GuideLayout, post: str, latched: bool) -> str:
    """Riser, rail, end stop, and the latch under the lifted carriage or beside it; returns the rail's
    designator."""
    front = POST_Y - rig.riser_depth
    z = rig.riser_middle
    length = rig.grasping.rail_length
    riser = b.place("RI", rigs.riser(rig), (0, front, z), ALONG_Y)
    b.meet(post, riser)
    for sx, sy in CORNERS:
        at = (sx * STAGE_HOLE, front + rig.riser_depth - RISER_UNDER_HEAD, z + sy * RISER_PITCH)
        b.screw("M4", RISER_SCREW, at, (0, 1, 0), riser, post)
    b.step(
        "Riser",
        (0, -50, 110),
        "Screw the riser on the post's rows, its front upright within 0.01 mm on 100 mm against a square "
        "on the base plate.",
    )
    rail = b.place("RL", rigs.rail(length), (0, front, z), AGAINST_Y)
    b.meet(riser, rail)
    for dz in rail_holes(length):
        b.screw("M3", 8.0, (0, front - 3.0, z + dz), (0, 1, 0), rail, riser)
    pin, y = dowel(STOP_PIN, STOP_LENGTH), front + STOP_DEPTH - STOP_LENGTH
    stop = b.place("ES", pin, (0, y, z - stop_below(rig)), ALONG_Y)
    hole = -LATCH if latched else -LATCH_KEPT
    latch = b.place("LP", pin, (hole, y, z + latch_above(rig) - latch_lies()), ALONG_Y)
    b.meet(riser, stop, "press")
    b.meet(riser, latch)
    b.step(
        "Guide rail",
        (0, -85, 110),
        "Lay the rail against a parallel set upright on the base plate; tighten its screws from the "
        f"middle outwards. Press the end stop's pin in below the rail, {STOP_DEPTH:g} mm deep: it keeps the "
        "carriage on its rail. Put the latch, the pin that slides, by hand in the outer of the two holes "
        "beside the rail, where it is out of the way; in the inner one it holds the lifted carriage up.",
        tools=("parallel, as long as the rail", "soft-faced hammer"),
    )
    return rail


def check_moving_weight(design: Design, scene: Scene) -> list[Finding]:
    """A finding where what moves is heavier than asked for (no ballast can mend that), or lighter."""
    weight, wanted = moving_weight(scene), present(design.grasping).moving_weight
    if abs(weight - wanted) <= AGREES * wanted:
        return []
    message = f"what moves weighs {weight:.4g} N by its parts, grasping.moving_weight asks for {wanted:.4g} N"
    return [Finding("moving-weight", "fail", scene.name, (), weight, wanted, message)]


def _poses(design: Design) -> Iterator[Pose]:
    """Without weights; lifted; and the pads in the sample: by its travel, but no deeper than they stand out
    of the arms' root fillets."""
    yield Pose(weights=0)
    yield Pose(height=present(design.grasping).lift, weights=0, cart=present(design.cart).roll)
    e = design.element
    deep = whole_um(min(present(design.sample).travel, e.pad_height - e.pad_root_radius))
    if deep > 0:
        yield Pose(deflection=deep)


RIG = Rig(
    name="grasping",
    tables=("grasping", "sample", "cart", "holder"),
    make=grasping,
    poses=_poses,
    under_sensor=none,
    rules=(*FITS, ballast_trims_moving_weight),
    deflections=grasping_lines,
    requirements=wheels,
    checks=(("moving weight", check_moving_weight),),
)
