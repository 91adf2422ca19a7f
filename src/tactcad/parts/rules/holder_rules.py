"""Rules on the vacuum holder and the sample on it."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi, tan

from tactcad.design.following import LARGEST_SIDE
from tactcad.design.present import present
from tactcad.mechanics.rig_statics import holding_force

from ..finding import SAME, Finding
from ..layout import Layout
from ..library import orings
from ..library.screws import METRIC, counterbore_diameter
from ..rigs.cart_layout import GROOVE_WALL, CartLayout
from ..rigs.frame import TIP_LAND, pad_middles
from ..rigs.hose_fitting import FITTING_RADIUS
from .cart_rules import LEAST_AIR, on_cart
from .rule import at_least, at_most, fits, rule, wrong


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
    short = orings.GROOVE_DEPTH + 1.0 + m5.d / 2 - rig.port_depth
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
            f"less than {max(orings.INSIDE.values()):g} mm",
        )
        return
    outer = orings.groove(rig.o_ring)[1] / 2
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
            "at least 5 mm, and lid, plenum and floor for a screw of at most 30 mm",
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
