"""Rules on the wheeled cart."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import wraps

from tactcad.mechanics.rig_statics import tipping_margin

from ..finding import SAME, Finding
from ..layout import HOLE_WEB, Layout
from ..library.screws import METRIC
from ..rigs.cart_layout import CartLayout, cart_layout
from ..rigs.frame import POST_Y
from .rule import Find, at_least, at_most, rule, wrong

WALL = 0.8  # least material beside an axle's hole, mm; as for free-standing aluminium walls
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
    most = min(rig.cart.width, rig.cart.length)
    legal = f"at most {most:g} mm in all"
    yield from at_most("holder.margin", "holder larger than the cart", rig.holder_side, most, legal)


@rule(after="stop_land_above_arm")
@on_cart
def cart_clears_post(rig: CartLayout) -> Iterator[Finding]:
    over = rig.cart_half - POST_Y + LEAST_AIR
    if over > 0.0:
        most = rig.cart.width - 2 * over
        yield wrong("cart.width", "cart reaches the post", rig.cart.width, f"at most {most:g} mm")
