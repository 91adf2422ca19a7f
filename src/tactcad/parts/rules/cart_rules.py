"""Rules on the wheeled cart, the vacuum holder on it, and the sample."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import wraps
from math import floor, pi, tan

from tactcad.design.fields import present
from tactcad.design.tree import LARGEST_SIDE
from tactcad.mechanics.statics import holding_force, tipping_margin

from ..array.layout import HOLE_WEB, Layout
from ..bought import standard_parts
from ..language.finding import SAME, Finding
from ..language.metric import METRIC, counterbore_diameter
from ..rigs.cart import FITTING_RADIUS, GROOVE_WALL, CartLayout, cart_layout
from ..rigs.frame import POST_Y, TIP_LAND, pad_middles
from .rule import Find, at_least, at_most, fits, rule, wrong

WALL = 0.8  # least material around an axle's hole, mm; as for free-standing aluminium walls
LEAST_TIPPING = 2.0  # mm that any load on the sample stays inside the wheels; chosen: a badly centred sample
LEAST_AIR = 0.5  # between things that pass each other, mm


def on_cart(find: Callable[[CartLayout], Iterable[Finding]]) -> Find:
    """Make a function of the cart's layout a rule; a design without a cart keeps it."""

    @wraps(find)
    def where_present(layout: Layout) -> Iterable[Finding]:
        rig = cart_layout(layout.design)
        return find(rig) if rig is not None else ()

    return where_present


@rule(after="stop_land_above_arm")
@on_cart
def axles_fit_plate(rig: CartLayout) -> Iterator[Finding]:
    m, c = METRIC[rig.axle_thread], rig.cart
    around = m.clearance / 2 + WALL
    highest = rig.axle_z - around
    yield from at_most("cart.clearance", "axles too near the plate's underside", c.clearance, highest)
    yield from at_least(
        "cart.thickness",
        "axles too near the plate's upper face",
        c.thickness,
        rig.axle_z + around - c.clearance,
    )
    deep = rig.axle_in_plate + 1.0 + 2 * m.pitch + m.tap_drill
    yield from at_least("cart.width", "axles of both sides meet in the plate", c.width, 2 * deep)
    longest = c.length - 2 * around
    yield from at_most("cart.wheel_base", "axles too near the plate's ends", c.wheel_base, longest)
    least = (m.clearance + METRIC["M3"].d) / 2 + HOLE_WEB
    if abs(c.wheel_base / 2 - rig.holder_screw) < least - SAME:
        yield wrong(
            "cart.wheel_base",
            "axles meet the holder's screws",
            c.wheel_base,
            f"at least {least:g} mm beside {rig.holder_screw:g} mm",
        )


@rule(after="stop_land_above_arm")
@on_cart
def cart_cannot_tip(rig: CartLayout) -> Iterator[Finding]:
    margin = tipping_margin(rig.contacts, rig.sample.side / 2)
    if margin < LEAST_TIPPING - SAME:
        yield wrong(
            "cart.wheel_base",
            f"a load at the sample's corner is {margin:g} mm inside the wheels: the cart may tip",
            rig.cart.wheel_base,
            f"wheels {LEAST_TIPPING:g} mm outside the sample, both ways",
        )


@rule(after="stop_land_above_arm")
@on_cart
def holder_on_cart(rig: CartLayout) -> Iterator[Finding]:
    whole = floor(min(rig.cart.width, rig.cart.length) + SAME)  # as the holder's side is
    most = (whole - rig.sample.side) / 2
    yield from at_most("holder.margin", "holder larger than the cart", rig.holder.margin, most)


@rule(after="stop_land_above_arm")
@on_cart
def cart_clears_post(rig: CartLayout) -> Iterator[Finding]:
    over = rig.cart_half - POST_Y + LEAST_AIR
    if over > 0.0:
        most = rig.cart.width - 2 * over
        yield wrong("cart.width", "cart reaches the post", rig.cart.width, f"at most {most:g} mm")


@rule(after="stop_land_above_arm")
@on_cart
def holes_under_sample(rig: CartLayout) -> Iterator[Finding]:
    h = rig.holder
    largest = rig.sample.side - 2.0
    what = "holes at the sample's edge draw air"
    yield from at_most("holder.vacuum_diameter", what, h.vacuum_diameter, largest)
    pitch = (h.vacuum_diameter - 2 * h.hole_diameter) / 2 / h.rings
    least = h.hole_diameter + LEAST_AIR
    if pitch < least - SAME:
        yield wrong(
            "holder.rings", f"holes only {pitch:.3g} mm apart", h.rings, f"{least:g} mm apart at least"
        )


@rule(after="stop_land_above_arm")
@on_cart
def vacuum_holds(rig: CartLayout) -> Iterator[Finding]:
    h = rig.holder
    area = len(rig.suction_holes) * pi * h.hole_diameter**2 / 4
    force = holding_force(h.vacuum, area)
    if force < h.pull - SAME:
        yield wrong(
            "holder.vacuum",
            f"holds {force:.3g} N at its holes against a pull of {h.pull:g} N",
            h.vacuum,
            f"at least {h.vacuum * h.pull / force:.3g} kPa, or more holes",
        )


@rule(after="stop_land_above_arm")
@on_cart
def plenum_takes_port(rig: CartLayout) -> Iterator[Finding]:
    h, m5 = rig.holder, METRIC["M5"]
    short = standard_parts.GROOVE_DEPTH + 1.0 + m5.d / 2 - rig.port_depth
    what = "port's thread meets the seal's groove"
    yield from at_least("holder.plenum_depth", what, h.plenum_depth, h.plenum_depth + short)
    wall = (rig.holder_side - h.vacuum_diameter) / 2
    what = f"wall of {wall:g} mm takes no M5 fitting"
    yield from at_least("holder.margin", what, h.margin, h.margin + 5.0 - wall)
    flat = (h.vacuum_diameter / 2 - rig.plenum_corner) * tan(pi / 8)
    if flat < m5.tap_drill / 2 + 0.1 - SAME:
        yield wrong(
            "holder.vacuum_diameter",
            "plenum's flat wall is narrower than the port",
            h.vacuum_diameter,
            "a wider plenum",
        )


@rule(after="stop_land_above_arm")
@on_cart
def seal_fits_holder(rig: CartLayout) -> Iterator[Finding]:
    h = rig.holder
    if rig.o_ring is None:
        yield wrong(
            "holder.vacuum_diameter",
            "no O-ring of the table reaches around the plenum",
            h.vacuum_diameter,
            f"less than {max(standard_parts.INSIDE.values()):g} mm",
        )
        return
    outer = standard_parts.groove(rig.o_ring)[1] / 2
    least = h.margin + outer + GROOVE_WALL - rig.holder_side / 2
    what = "seal's groove reaches the holder's side"
    yield from at_least("holder.margin", what, h.margin, least, f"at least {least:.4g} mm")
    if outer + METRIC["M3"].clearance / 2 + GROOVE_WALL > rig.screw_circle + SAME:
        yield wrong("holder.margin", "seal's groove meets the holder's screws", h.margin, "a wider margin")


@rule(after="stop_land_above_arm")
@on_cart
def holder_can_be_screwed(rig: CartLayout) -> Iterator[Finding]:
    if rig.holder_fixing is None:
        yield wrong(
            "holder.lid_thickness",
            "no standard M3 screw sinks its head in the lid and engages the cart plate",
            rig.holder.lid_thickness,
            "at least 5.2 mm, and lid, plenum and floor for a screw of at most 30 mm",
        )


@rule(after="stop_land_above_arm")
@on_cart
def screws_clear_sample(rig: CartLayout) -> Iterator[Finding]:
    margin = rig.holder.margin
    free = rig.holder_screw - counterbore_diameter("M3") / 2 - rig.sample.side / 2
    yield from at_least("holder.margin", "sample lies on the lid's screws", margin, margin - free)


@rule(after="stop_land_above_arm")
@on_cart
def port_clears_cart(rig: CartLayout) -> Iterator[Finding]:
    if rig.cart.width <= rig.holder_side + SAME:
        return
    floor = rig.holder.floor
    free = rig.holder_body - rig.port_depth - FITTING_RADIUS
    yield from at_least("holder.floor", "hose fitting meets the cart plate", floor, floor + LEAST_AIR - free)


@rule(after="stop_land_above_arm")
def tip_land_clears_sample(layout: Layout) -> Iterator[Finding]:
    s = layout.design.sample
    if s is not None:
        what = "deeper than the tip's land is high, or than half the sample"
        yield from at_most("sample.travel", what, s.travel, min(TIP_LAND, s.thickness / 2))


@fits
def pads_on_sample(layout: Layout) -> Iterator[Finding]:
    d = layout.design
    half_pad, half_sheet = d.element.pad_length / 2, d.sheet.thickness / 2
    far = max(max(abs(x) + half_pad, abs(y) + half_sheet) for x, y in pad_middles(layout))
    if 2 * far > LARGEST_SIDE + SAME:
        rows = d.array.row_arms
        most = int((LARGEST_SIDE - d.sheet.thickness) / d.array.pitch + SAME) + 1
        yield wrong(
            "array.row_arms",
            f"pads reach beyond {LARGEST_SIDE:g} mm, the largest sample whose cart clears the post",
            max(map(len, rows)),
            f"at most {most} elements a row at this pitch, or a smaller array.pitch",
        )
    yield from at_least("sample.side", "pads reach beyond the sample", present(d.sample).side, 2 * far)
