"""Rules of the rigs; they say nothing where the design has no such table.

RIG_RULES hold between the rigs' own fields: a design that breaks one is refused. FITS tell, by scene, whether the
rig takes this design's array: one that does not fit costs the design that scene, and nothing else.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import hypot, pi, tan

from tactcad.mechanics.rigs import holding_force, tipping_margin
from tactcad.parts.library import orings

from ..broken import Broken
from ..deflected import deflection_at_pad_edge
from ..layout import HOLE_WEB, Layout
from ..library.dowels import dowel_diameter, dowel_lengths
from ..library.screws import METRIC, counterbore_diameter
from .bought import FITTING_RADIUS
from .calibration_loads import calibration_loads
from .carried import BAR_MIDDLE, BAR_SCREW_X, CARRIER_SCREW, under_carrier_screw
from .layout import (
    BAR,
    BAR_FRONT,
    BAR_WIDTH,
    CARRIAGE_LENGTH,
    FOOT,
    GROOVE_WALL,
    RAIL_HEIGHT,
    STAGE_HOLE,
    TIP_LAND,
    RigLayout,
    pad_middles,
)
from .moving import ballast_range

SAME = 1e-9
WALL = 0.8  # least material beside an axle's hole, mm; as for free-standing aluminium walls
LEAST_TIPPING = 2.0  # mm that any load on the sample stays inside the wheels; chosen: a badly centred sample
ROLLER_OUT = 0.1  # mm that the roller's holder keeps from pads beside the one that is pressed; chosen
LEAST_AIR = 0.5  # between things that pass each other, mm

Finding = tuple[str, str, object, str]
Rule = Callable[[Layout], Iterator[Finding]]


def axles_carry_wheels(layout: Layout) -> Iterator[Finding]:
    rig = RigLayout(layout.design)
    if rig.has_cart and rig.axle_length is None:
        yield (
            "cart.shim",
            f"no ISO 4762 {rig.axle_thread} has so long a plain shank",
            rig.cart.shim,
            "thinner shims",
        )


def axles_fit_plate(layout: Layout) -> Iterator[Finding]:
    rig = RigLayout(layout.design)
    if not rig.has_cart or rig.axle_length is None:
        return
    m, c = METRIC[rig.axle_thread], rig.cart
    around = m.clearance / 2 + WALL
    low, high = rig.axle_z - around, rig.axle_z + around - c.thickness
    if c.clearance > low + SAME:
        yield ("cart.clearance", "axles too near the plate's underside", c.clearance, f"at most {low:g} mm")
    elif c.clearance < high - SAME:
        yield (
            "cart.thickness",
            "axles too near the plate's upper face",
            c.thickness,
            f"at least {c.thickness + high - c.clearance:g} mm",
        )
    deep = rig.axle_in_plate + 1.0 + 2 * m.pitch + m.tap_drill
    if c.width / 2 < deep - SAME:
        yield ("cart.width", "axles of both sides meet in the plate", c.width, f"at least {2 * deep:g} mm")
    end = c.wheel_base + 2 * around
    if c.length < end - SAME:
        yield (
            "cart.wheel_base",
            "axles too near the plate's ends",
            c.wheel_base,
            f"at most {c.length - 2 * around:g} mm",
        )
    apart = abs(c.wheel_base / 2 - rig.holder_screw)
    least = (m.clearance + METRIC["M3"].d) / 2 + HOLE_WEB
    if apart < least - SAME:
        yield (
            "cart.wheel_base",
            "axles meet the holder's screws",
            c.wheel_base,
            f"at least {least:g} mm beside {rig.holder_screw:g} mm",
        )


def cart_cannot_tip(layout: Layout) -> Iterator[Finding]:
    rig = RigLayout(layout.design)
    if not rig.has_cart:
        return
    margin = tipping_margin(rig.contacts, layout.design.sample.side / 2)
    if margin < LEAST_TIPPING - SAME:
        yield (
            "cart.wheel_base",
            f"a load at the sample's corner is {margin:g} mm inside the wheels: the cart may tip",
            rig.cart.wheel_base,
            f"wheels {LEAST_TIPPING:g} mm outside the sample, both ways",
        )


def holder_on_cart(layout: Layout) -> Iterator[Finding]:
    rig = RigLayout(layout.design)
    if rig.has_cart and rig.holder_side > min(rig.cart.width, rig.cart.length) + SAME:
        yield (
            "holder.margin",
            "holder larger than the cart",
            rig.holder_side,
            f"at most {min(rig.cart.width, rig.cart.length):g} mm in all",
        )


def cart_clears_post(layout: Layout) -> Iterator[Finding]:
    rig = RigLayout(layout.design)
    if rig.has_cart and rig.cart_half > rig.post_y - LEAST_AIR:
        yield (
            "cart.width",
            "cart reaches the post",
            rig.cart.width,
            f"at most {rig.cart.width - 2 * (rig.cart_half - rig.post_y + LEAST_AIR):g} mm",
        )


def holes_under_sample(layout: Layout) -> Iterator[Finding]:
    rig, h = RigLayout(layout.design), layout.design.holder
    if not rig.has_cart:
        return
    if h.rings != round(h.rings):
        yield ("holder.rings", "not a whole number", h.rings, "1, 2, 3 ...")
    if h.vacuum_diameter > layout.design.sample.side - 2.0 + SAME:
        yield (
            "holder.vacuum_diameter",
            "holes at the sample's edge draw air",
            h.vacuum_diameter,
            f"at most {layout.design.sample.side - 2.0:g} mm",
        )
    pitch = (h.vacuum_diameter - 2 * h.hole_diameter) / 2 / max(1.0, h.rings)
    if pitch < h.hole_diameter + LEAST_AIR - SAME:
        yield (
            "holder.rings",
            f"holes only {pitch:.3g} mm apart",
            h.rings,
            f"{h.hole_diameter + LEAST_AIR:g} mm apart at least",
        )


def vacuum_holds(layout: Layout) -> Iterator[Finding]:
    rig, h = RigLayout(layout.design), layout.design.holder
    if not rig.has_cart:
        return
    area = len(rig.suction_holes) * pi * h.hole_diameter**2 / 4
    force = holding_force(h.vacuum, area)
    if force < h.pull - SAME:
        yield (
            "holder.vacuum",
            f"holds {force:.3g} N at its holes against a pull of {h.pull:g} N",
            h.vacuum,
            f"at least {h.vacuum * h.pull / force:.3g} kPa, or more holes",
        )


def plenum_takes_port(layout: Layout) -> Iterator[Finding]:
    rig, h = RigLayout(layout.design), layout.design.holder
    if not rig.has_cart:
        return
    least = orings.GROOVE_DEPTH + 1.0 + METRIC["M5"].d / 2
    if rig.port_depth < least - SAME:
        yield (
            "holder.plenum_depth",
            "port's thread meets the seal's groove",
            h.plenum_depth,
            f"at least {h.plenum_depth + least - rig.port_depth:g} mm",
        )
    wall = (rig.holder_side - h.vacuum_diameter) / 2
    if wall < 5.0 - SAME:
        yield (
            "holder.margin",
            f"wall of {wall:g} mm takes no M5 fitting",
            h.margin,
            f"at least {h.margin + 5.0 - wall:g} mm",
        )
    flat = (h.vacuum_diameter / 2 - rig.plenum_corner) * tan(pi / 8)
    if flat < METRIC["M5"].tap_drill / 2 + 0.1 - SAME:
        yield (
            "holder.vacuum_diameter",
            "plenum's flat wall is narrower than the port",
            h.vacuum_diameter,
            "a wider plenum",
        )


def seal_fits_holder(layout: Layout) -> Iterator[Finding]:
    rig, h = RigLayout(layout.design), layout.design.holder
    if not rig.has_cart:
        return
    if rig.o_ring is None:
        yield (
            "holder.vacuum_diameter",
            "no O-ring of the table reaches around the plenum",
            h.vacuum_diameter,
            f"less than {max(orings.INSIDE.values()):g} mm",
        )
        return
    outer = orings.groove(rig.o_ring)[1] / 2
    if outer > rig.holder_side / 2 - GROOVE_WALL + SAME:
        yield (
            "holder.margin",
            "seal's groove reaches the holder's side",
            h.margin,
            f"at least {h.margin + outer + GROOVE_WALL - rig.holder_side / 2:.4g} mm",
        )
    if outer + METRIC["M3"].clearance / 2 + GROOVE_WALL > rig.screw_circle + SAME:
        yield ("holder.margin", "seal's groove meets the holder's screws", h.margin, "a wider margin")


def holder_can_be_screwed(layout: Layout) -> Iterator[Finding]:
    rig = RigLayout(layout.design)
    if rig.has_cart and rig.holder_fixing is None:
        yield (
            "holder.lid_thickness",
            "no standard M3 screw sinks its head in the lid and engages the cart plate",
            rig.holder.lid_thickness,
            "at least 5 mm, and lid, plenum and floor for a screw of at most 30 mm",
        )


def screws_clear_sample(layout: Layout) -> Iterator[Finding]:
    rig = RigLayout(layout.design)
    if not rig.has_cart:
        return
    free = rig.holder_screw - counterbore_diameter("M3") / 2 - layout.design.sample.side / 2
    if free < -SAME:
        yield (
            "holder.margin",
            "sample lies on the lid's screws",
            rig.holder.margin,
            f"at least {rig.holder.margin - free:g} mm",
        )


def stages_reach_pads(layout: Layout) -> Iterator[Finding]:
    c = layout.design.calibration
    if c is None:
        return
    far = max(max(abs(x), abs(y)) for x, y in pad_middles(layout))
    if far > c.stage_travel + SAME:
        yield (
            "calibration.stage_travel",
            "stages do not reach every pad",
            c.stage_travel,
            f"at least {far:g} mm",
        )


def axis_reaches_contact(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    if d.calibration is None:
        return
    rig, c = RigLayout(d), d.calibration
    down = max(c.travel, d.sample.travel if d.sample else 0.0)
    for touch in rig.touches:
        rest = rig.axis_middle(touch) - rig.stage_middle(touch)
        need = max(rest + c.retract, down - rest)
        if need > c.axis_travel + SAME:
            yield (
                "calibration.axis_travel",
                f"vertical axis rests {rest:+.3g} mm off its middle",
                c.axis_travel,
                f"at least {need:.4g} mm",
            )


def calibration_bends_elastically(layout: Layout) -> Iterator[Finding]:
    """No hinge yields at the end of the travel: in this set-up there is no stop plate."""
    c = layout.design.calibration
    if c is None or misfit(layout, "calibration") is not None:
        return
    for load in calibration_loads(layout.design):
        if c.travel > load.travel_at_yield:  # not where the estimator does not reach
            yield (
                "calibration.travel",
                f"the hinge of element {load.place.number} yields before its end",
                c.travel,
                f"at most {load.travel_at_yield:.4g} mm",
            )


def roller_stays_on_pad(layout: Layout) -> Iterator[Finding]:
    """High pads of short arms swing sideways: at the end of the travel the roller still stands on every pad."""
    c = layout.design.calibration
    if c is None or misfit(layout, "calibration") is not None:
        return
    roller = dowel_diameter(c.roller) / 2
    for load in calibration_loads(layout.design):
        most = deflection_at_pad_edge(layout, load.place, roller)
        deflection = c.travel if load.refused else load.deflection
        if deflection > most:
            yield (
                "calibration.travel",
                f"the pad of element {load.place.number} swings out from under the roller",
                c.travel,
                f"at most {c.travel * most / deflection:.4g} mm",
            )


def mount_clears_carrier(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    if d.calibration is None:
        return
    free = STAGE_HOLE - counterbore_diameter("M4") / 2
    x, y = (size / 2 for size in layout.carrier_size)
    if min(x, y) > free - LEAST_AIR + SAME:
        yield (
            "array.row_arms",
            "the array's carrier covers the screws of the calibration mount",
            min(x, y),
            f"at most {free - LEAST_AIR:g} mm from the middle, along or across",
        )


def carrier_screws_fit(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    under = under_carrier_screw(RigLayout(d))
    if not 2.0 - SAME <= under <= FOOT + SAME:
        low, high = CARRIER_SCREW + 0.3 - FOOT, CARRIER_SCREW + 0.3 - 2.0
        yield (
            "clamp.carrier_thickness",
            f"{CARRIER_SCREW:g} mm screws into the carrier leave {under:g} mm under their heads",
            d.clamp.carrier_thickness,
            f"from {low:g} to {high:g} mm",
        )
    least = counterbore_diameter(d.clamp.mount_thread) + HOLE_WEB
    if d.clamp.mount_pitch_y < least - SAME:
        yield (
            "clamp.mount_pitch_y",
            "heads of the screws into the carrier run into each other",
            d.clamp.mount_pitch_y,
            f"at least {least:g} mm",
        )
    if 2 * layout.mount_x < least - SAME:
        yield (
            "clamp.carrier_screw_offset",
            "heads of the screws into the carrier run into the other row's",
            d.clamp.carrier_screw_offset,
            f"at least {d.clamp.carrier_screw_offset + 2 * least - 4 * layout.mount_x:g} mm",
        )


def roller_clears_neighbours(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    if d.calibration is None:
        return
    size = d.calibration.roller
    length = next((n for n in dowel_lengths(size) if n >= d.sheet.thickness), None)
    most = 2 * (d.array.pitch - d.sheet.thickness / 2 - 0.1)
    if length is None or length > most + SAME:
        yield (
            "calibration.roller",
            f"no standard pin covers a pad and clears its neighbours: shortest {length} mm",
            size,
            f"a pin from {d.sheet.thickness:g} to {most:g} mm long",
        )
    out = dowel_diameter(size) / 2
    if d.calibration.travel > out - ROLLER_OUT + SAME:
        yield (
            "calibration.travel",
            "the roller's holder would come down on the neighbouring pads",
            d.calibration.travel,
            f"at most {out - ROLLER_OUT:g} mm, the roller's radius less {ROLLER_OUT:g}",
        )
    if out > d.array.row_pitch - d.element.pad_length / 2 - 0.1:
        yield ("calibration.roller", "roller touches the facing pad", size, "a thinner one")


def rail_is_long_enough(layout: Layout) -> Iterator[Finding]:
    rig, g = RigLayout(layout.design), layout.design.grasping
    if g is None or not rig.has_cart:
        return
    if abs(g.rail_length / 20 - round(g.rail_length / 20)) > SAME:
        yield (
            "grasping.rail_length",
            "not a multiple of the rail's hole pitch",
            g.rail_length,
            "a multiple of 20 mm",
        )
        return
    half = CARRIAGE_LENGTH / 2
    top = rig.riser_middle + g.rail_length / 2 - rig.carriage_middle - half
    bottom = rig.carriage_middle - half - (rig.riser_middle - g.rail_length / 2)
    if top < g.lift - SAME or bottom < 1.0:
        yield (
            "grasping.rail_length",
            f"carriage can rise {top:.3g} mm and fall {bottom:.3g} mm",
            g.rail_length,
            f"rise at least {g.lift:g}, fall at least 1 mm",
        )


def bar_clears_screws(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    if d.grasping is None:
        return
    head = counterbore_diameter(d.clamp.mount_thread) / 2
    beside = layout.mount_x - head - BAR_WIDTH / 2
    before = BAR_FRONT - d.clamp.mount_pitch_y / 2 - head
    if max(beside, before) < 0.2 - SAME:
        yield (
            "clamp.mount_pitch_y",
            "bar stands on the carrier's screws",
            d.clamp.mount_pitch_y,
            f"at most {2 * (BAR_FRONT - head - 0.2):g} mm",
        )


def mount_holes_apart(layout: Layout) -> Iterator[Finding]:
    yield from _apart_from(layout, STAGE_HOLE, STAGE_HOLE, "the stage's screws in the array mount")


def foot_holes_apart(layout: Layout) -> Iterator[Finding]:
    yield from _apart_from(layout, BAR_SCREW_X, BAR_MIDDLE, "the bar's screws in the foot")


def _apart_from(layout: Layout, x: float, y: float, what: str) -> Iterator[Finding]:
    """The carrier's pattern of threads against M4 screws at (x, y): a web between their counterbores."""
    c = layout.design.clamp
    apart = hypot(layout.mount_x - x, c.mount_pitch_y / 2 - y)
    least = (counterbore_diameter("M4") + counterbore_diameter(c.mount_thread)) / 2 + HOLE_WEB
    if apart < least - SAME:
        yield (
            "clamp.mount_pitch_y",
            f"screws into the carrier run into {what}: {apart:.3g} mm apart",
            c.mount_pitch_y,
            f"at least {least:g} mm apart",
        )


def weights_clear_guide(layout: Layout) -> Iterator[Finding]:
    g = layout.design.grasping
    if g is None:
        return
    free = BAR_FRONT + BAR + RAIL_HEIGHT - 6.5 - LEAST_AIR
    if g.weight_diameter / 2 > free + SAME:
        yield (
            "grasping.weight_diameter",
            "weights rub on the guide",
            g.weight_diameter,
            f"at most {2 * free:g} mm",
        )
    if g.weights != round(g.weights):
        yield ("grasping.weights", "not a whole number", g.weights, "0, 1, 2 ...")


def ballast_trims_moving_weight(layout: Layout) -> Iterator[Finding]:
    wanted = layout.design.grasping.moving_weight
    try:
        low, high = ballast_range(RigLayout(layout.design))
    except (AttributeError, ValueError):
        return  # parts that cannot be drawn: the design is refused for that
    if low <= wanted <= high:
        return
    legal = (
        f"from {low:.4g} to {high:.4g} N"
        if low < high
        else "fewer or larger weights: their stack is too high"
    )
    yield ("grasping.moving_weight", "no ballast under the weights brings what moves to it", wanted, legal)


def tip_land_clears_sample(layout: Layout) -> Iterator[Finding]:
    s = layout.design.sample
    if s is None:
        return
    most = min(TIP_LAND, s.thickness / 2)
    if s.travel > most + SAME:
        yield (
            "sample.travel",
            "deeper than the tip's land is high, or than half the sample",
            s.travel,
            f"at most {most:g} mm",
        )


def port_clears_cart(layout: Layout) -> Iterator[Finding]:
    rig, h = RigLayout(layout.design), layout.design.holder
    if not rig.has_cart or rig.cart.width <= rig.holder_side + SAME:
        return
    free = rig.holder_body - rig.port_depth - FITTING_RADIUS
    if free < LEAST_AIR - SAME:
        yield (
            "holder.floor",
            "hose fitting meets the cart plate",
            h.floor,
            f"at least {h.floor + LEAST_AIR - free:g} mm",
        )


def pads_on_sample(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    far = max(
        max(abs(x) + d.element.pad_length / 2, abs(y) + d.sheet.thickness / 2) for x, y in pad_middles(layout)
    )
    if far > d.sample.side / 2 + SAME:
        yield ("sample.side", "pads reach beyond the sample", d.sample.side, f"at least {2 * far:g} mm")


RIG_RULES: dict[str, Rule] = {
    rule.__name__: rule
    for rule in (
        axles_carry_wheels,
        axles_fit_plate,
        cart_cannot_tip,
        holder_on_cart,
        cart_clears_post,
        holes_under_sample,
        vacuum_holds,
        plenum_takes_port,
        seal_fits_holder,
        holder_can_be_screwed,
        screws_clear_sample,
        port_clears_cart,
        tip_land_clears_sample,
        axis_reaches_contact,
        calibration_bends_elastically,
        roller_stays_on_pad,
        weights_clear_guide,
    )
}

FITS: dict[str, tuple[Rule, ...]] = {
    "calibration": (
        stages_reach_pads,
        mount_clears_carrier,
        carrier_screws_fit,
        mount_holes_apart,
        roller_clears_neighbours,
    ),
    "grasping": (
        pads_on_sample,
        carrier_screws_fit,
        bar_clears_screws,
        foot_holes_apart,
        rail_is_long_enough,
        ballast_trims_moving_weight,
    ),
}


def misfit(layout: Layout, scene: str) -> Broken | None:
    """Why the scene's rig cannot take this array; None where it can."""
    for rule in FITS.get(scene, ()):
        for finding in rule(layout):
            return Broken(rule.__name__, *finding)
    return None
