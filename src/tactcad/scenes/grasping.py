"""Grasping: the array on a vertical guide comes down on the sample under its own weight and added ones."""

from __future__ import annotations

from tactcad.design.tree import Design
from tactcad.parts.rigs import bought, carried, stand
from tactcad.parts.rigs.layout import (
    BAR,
    BAR_FRONT,
    CARRIAGE_LENGTH,
    CARRIAGE_ON_BAR,
    PLATFORM,
    RAIL_HEIGHT,
    RISER_PITCH,
    STAGE_HOLE,
    STANDARD_GRAVITY,
    RigLayout,
    pad_middles,
)
from tactcad.parts.rigs.moving import trim

from .array import AGAINST_Y, ALONG_Y, array
from .builder import Builder
from .common import CORNERS, place_cart, place_stand
from .scene import REST, UPRIGHT, Motion, Pose, Rotation, Scene

ALONG_RAIL: Rotation = ((-1, 0, 0), (0, -1, 0), (0, 0, 1))  # carriage: local y out of the rail, z along it


def grasping(design: Design, pose: Pose = REST) -> Scene:
    """Scene `grasping`: pads on the sample (pose.deflection mm into it), or pose.height mm over it."""
    rig = RigLayout(design)
    g = design.grasping
    weights = round(g.weights) if pose.weights is None else pose.weights
    b = Builder()
    pads = pad_middles(rig.array)
    dents = tuple((x - pose.cart, y) for x, y in pads) if pose.deflection else ()
    sample = place_cart(b, rig, pose.cart, dents, pose.deflection)
    post = place_stand(b, rig, stages=False)
    rail = _guide(b, rig, post)
    lift = pose.height - pose.deflection
    thick, mass = trim(rig)
    top = _moving(b, rig, rail, lift, thick, mass)
    b.group("axis")
    disc = bought.disc_weight(rig)
    z = top
    below = "BA1" if mass > 0 else "PF1"
    for _ in range(weights):
        name = b.place("WT", disc, (0, 0, z))
        b.meet(below, name)
        below, z = name, z + disc.body.thickness
    b.group(None)
    if weights:
        b.step(
            "Weights",
            (0, 0, 330),
            "One disc a loading step, laid on without a knock; each is weighed before. Without any, the grasping force is "
            f"the moving weight: {g.moving_weight:g} N.",
        )
    if pose.height == 0:
        for place in rig.array.elements:
            b.meet(place.designator, sample)
    c = design.cart
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
    return b.scene("grasping", motions, cover=set(b.groups["axis"]) - set(_array_names(b)))


def _array_names(b: Builder) -> list[str]:
    return [p.designator for p in b.placements if p.designator[0] == "E" and p.designator[1:].isdigit()]


def moving_mass(scene: Scene) -> float:
    """Mass of a grasping scene's moving axis without the added weights, g."""
    axis = dict(scene.groups)["axis"]
    return sum(
        p.part.mass for p in scene.placements if p.designator in axis and not p.designator.startswith("WT")
    )


def moving_weight(scene: Scene) -> float:
    """Initial grasping force, N: the moving axis's weight at standard gravity, the guide's friction left out."""
    return moving_mass(scene) * 1e-3 * STANDARD_GRAVITY


def _guide(b: Builder, rig: RigLayout, post: str) -> str:
    front = rig.post_y - rig.riser_depth
    z = rig.riser_middle
    length = rig.design.grasping.rail_length
    riser = b.place("RI", stand.riser(rig), (0, front, z), ALONG_Y)
    b.meet(post, riser)
    for sx, sy in CORNERS:
        at = (sx * STAGE_HOLE, front + rig.riser_depth - stand.RISER_UNDER_HEAD, z + sy * RISER_PITCH)
        b.screw("M4", stand.RISER_SCREW, at, (0, 1, 0), riser, post)
    b.step(
        "Riser",
        (0, -50, 110),
        "Screw the riser on the post's rows, its front upright within 0.01 mm on 100 mm against a square on the base plate.",
    )
    rail = b.place("RL", bought.rail(length), (0, front, z), AGAINST_Y)
    b.meet(riser, rail)
    for dz in bought.rail_holes(length):
        b.screw("M3", 8.0, (0, front - 3.0, z + dz), (0, 1, 0), rail, riser)
    b.step(
        "Guide rail",
        (0, -85, 110),
        "Lay the rail against a parallel set upright on the base plate; tighten its screws from the middle outwards.",
    )
    return rail


def _moving(b: Builder, rig: RigLayout, rail: str, lift: float, thick: float, ballast: float) -> float:
    """All that moves with the array, with `ballast` g of ballast, about `thick` mm of it; returns z of the surface
    that the weights lie on."""
    design = rig.design
    b.group("axis")
    b.unit("vertical axis")
    front = BAR_FRONT + BAR
    zc = rig.carriage_middle + lift
    carriage = b.place(
        "CG", bought.carriage(), (0, front + RAIL_HEIGHT, zc - CARRIAGE_LENGTH / 2), ALONG_RAIL
    )
    b.meet(rail, carriage)
    b.step(
        "Carriage",
        (0, -85, 200),
        "Slide the carriage from its transport rail on the guide, seals taken off, one drop of thin oil.",
    )
    foot = b.place("FO", carried.foot(rig), (0, 0, rig.foot_bottom + lift))
    bar = b.place("BR", carried.bar(rig), (0, BAR_FRONT, rig.bar_bottom + lift), ALONG_Y)
    b.meet(foot, bar)
    for sx in (-1, 1):
        at = (sx * carried.BAR_SCREW_X, carried.BAR_MIDDLE, rig.bar_bottom + lift - carried.FOOT_UNDER_HEAD)
        b.screw("M4", 10.0, at, (0, 0, 1), foot, bar)
    b.step(
        "Foot and bar",
        (0, -140, 0),
        "On the bench: screw the foot under the bar, from below, square within 0.02 mm.",
        bench=True,
    )
    b.subassembly(array(design), UPRIGHT, (0, 0, rig.array_z + lift))
    b.meet("CA1", foot)
    for x, y in carried.carrier_pattern(rig):
        at = (x, y, rig.foot_bottom + lift + carried.under_carrier_screw(rig))
        b.screw(design.clamp.mount_thread, carried.CARRIER_SCREW, at, (0, 0, -1), foot, "CA1")
    b.step(
        "Array under the foot",
        (0, -140, -35),
        "Screw the finished array (its own guide) under the foot. Leads leave along x in a loose loop to the post.",
    )
    for sx in (-1, 1):
        for sy in (-1, 1):
            at = (
                sx * 7.5,
                front - carried.BAR_UNDER_HEAD,
                rig.bar_bottom + lift + CARRIAGE_ON_BAR + sy * 5.0,
            )
            b.screw("M3", 8.0, at, (0, 1, 0), bar, carriage)
    b.meet(bar, carriage)
    b.step(
        "Bar on the carriage",
        (0, -160, 0),
        "Screw the bar on the carriage. Lower the array on a flat plate on the cart: no light may show under any pad; the "
        f"signal of each element tells the rest. A tilt of {design.tolerance.tilt:g} degree is allowed, shim under the foot.",
    )
    b.unit("platform with weights")
    under = carried.PLATFORM_UNDER_HEAD
    z = rig.platform_top + lift
    platform = b.place("PF", carried.platform(rig), (0, 0, z - PLATFORM))
    b.meet(bar, platform)
    for sx in (-1, 1):
        b.screw(
            "M4",
            10.0,
            (sx * carried.BAR_SCREW_X, carried.BAR_MIDDLE, z - PLATFORM + under),
            (0, 0, -1),
            platform,
            bar,
        )
    b.step("Platform", (0, 0, 250), "Screw the platform on the bar, heads sunk.")
    pin = b.place("PN", carried.pin(rig, thick), (0, 0, z))
    b.meet(platform, pin)
    b.screw("M4", 10.0, (0, 0, z - under), (0, 0, 1), platform, pin)
    b.step("Pin", (0, 0, 280), "Screw the pin on the platform from below.")
    if ballast > 0:
        disc = carried.ballast(rig, ballast)
        name = b.place("BA", disc, (0, 0, z))
        b.meet(platform, name)
        b.step(
            "Ballast",
            (0, 0, 305),
            f"Weigh all that moves: with the ballast it must be {design.grasping.moving_weight:g} N. Turn the ballast thinner until it is.",
        )
        z += disc.body.thickness
    b.group(None)
    return z
