"""Requirements on the rigs: four wheels on a plane, array and sample parallel, the roller in its seat; and
for bonding gauges: place on the hinge, leaf on its backing, pins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import degrees, inf
from typing import TYPE_CHECKING

from tactcad.design.fields import present
from tactcad.parts.array.clamp import pressed
from tactcad.parts.array.element import SLOT
from tactcad.parts.array.layout import Layout
from tactcad.parts.bought.standard_parts import BORE, LEAST_PLAY, OUTSIDE, dowel_limits
from tactcad.parts.language.limits import deviations, general
from tactcad.parts.language.stock import PLACE
from tactcad.parts.rigs.bonding_fixture import (
    PLAY,
    TIP,
    TIP_OVER_REST,
    TONGUE,
    TONGUE_WIDTH,
    BondingLayout,
    bonding_rigs,
    kind_suffix,
)
from tactcad.parts.rigs.cart import AXLES, AXLES_OVER, LID_FLAT, LOOSE_WHEEL, cart_layout
from tactcad.parts.rigs.force_gauge import SEAT, SEAT_RADIUS, seat_radius
from tactcad.parts.rigs.frame import CARRIAGE_LENGTH
from tactcad.parts.rigs.linear_guide import RAIL_FLAT, guide_layout

from .requirement import LEAST_PRESS, SHEET, Built, DimensionLimits, Requirement, of_element, summed, variable

if TYPE_CHECKING:
    from tactcad.mechanics.section import Array

AXLE_HEIGHT = "axles: height over the cart's underside"
WHEEL = "wheel: outside diameter"
BORES = "wheel: bore"
SHANKS = "axle: shank"
# Shank of an ISO 4762 screw of product grade A (ISO 4759-1:2000).
SHANK = "h13"
# mm, largest offset of the roller from its seat's middle, which shifts the load along the arm. The seat's
# place in the tip does not matter: the guide sets the bonded roller by the pad's edge.
ROLLER_PLACE = 0.02
# Wheels around the cart: the fourth's distance from the plane of three is the alternating sum of their
# heights.
AROUND = (1.0, -1.0, 1.0, -1.0)


def wheels(layout: Layout, known: dict[str, DimensionLimits]) -> list[Requirement]:
    """Requirement of the cart: no wheel is loose. Adds the variables that it depends on to `known`."""
    design = layout.design
    rig = present(cart_layout(design))
    plate = ((f"{design.name}-cart-plate", AXLES_OVER),)
    for name, (low, high), of in (
        (AXLE_HEIGHT, (-AXLES, AXLES), plate),
        (WHEEL, OUTSIDE, ()),
        (BORES, BORE, ()),
        (SHANKS, deviations(SHANK, rig.bearing.d), ()),
    ):
        known[name] = variable(name, low, high, len(AROUND), of)
    return [Requirement("wheels touch", "mm", -inf, LOOSE_WHEEL, loose_wheel)]


def loose_wheel(a: Built) -> Array:
    """Distance of a wheel from the plane of the other three, if the axles are tightened with the cart pressed
    on a surface plate: each wheel yields by half its play on the shank. A shank that does not enter is
    polished until it does."""
    import numpy as np

    heights = a.made[AXLE_HEIGHT] - a.made[WHEEL] / 2
    play = np.maximum(a.made[BORES] - a.made[SHANKS], 0.0)
    off = np.abs(heights @ np.array(AROUND)) - play.sum(axis=1) / 2
    return np.maximum(off, 0.0)[:, np.newaxis]


# Of tolerance.tilt: what the guide levels to by the elements' signals, and what the sample's faces may be
# off. Chosen: the other limits take the rest.
LEVELLED = SAMPLE = 0.25
LEVELLING_PLATE = 0.005  # mm, parallelism of the plate in the sample's place; chosen: ground stock has it


def parallel(layout: Layout, known: dict[str, DimensionLimits]) -> Requirement:
    """Requirement of grasping: array parallel to the sample, along x and along y. Foot, bar, post, cart and
    the array's own tilt are levelled out; what comes after adds up: other faces on the lid, a cart that rocks
    to its loose wheel, the carriage on its rail. Adds the variables, apart, to `known`.

    A face within its flatness over a length is taken as a plane that leans by as much; a bow, the usual form,
    leans less.
    """
    import numpy as np

    design = layout.design
    rig = present(guide_layout(design))
    cart, tilt, name = rig.cart, design.tolerance.tilt, design.name
    own = {
        "grasping: levelled by signals, degrees": (LEVELLED * tilt, ()),
        "sample: parallel faces, degrees": (SAMPLE * tilt, ()),
        "levelling plate: parallel faces, degrees": (_lean(LEVELLING_PLATE, cart.sample.side), ()),
        "holder's lid: flatness, degrees": (
            _lean(LID_FLAT, cart.holder_side),
            ((f"{name}-holder-lid", "flatness"),),
        ),
        "riser: flatness under the rail, degrees": (
            _lean(RAIL_FLAT, CARRIAGE_LENGTH),
            ((f"{name}-riser", "flatness"),),
        ),
    }
    for each, (half, of) in own.items():
        known[each] = replace(variable(each, -half, half, 2, of), apart=True)
    bases = np.array([cart.cart.wheel_base, 2 * cart.wheel_y])

    def value(a: Built) -> Array:
        return np.abs(sum(a.made[each] for each in own)) + np.degrees(loose_wheel(a) / bases)

    return Requirement(PARALLEL, "degree", -inf, tilt, value, fields=("tolerance.tilt",))


PARALLEL = "array parallel to the sample"


def _lean(flat: float, length: float) -> float:
    """Angle, degrees, of a face that is off by `flat` over a length, mm."""
    return degrees(flat / length)


def roller(layout: Layout, known: dict[str, DimensionLimits]) -> list[Requirement]:
    """Requirement of the calibration's tip: the roller lies in its seat. Adds the variables to `known`."""
    design = layout.design
    size, of = present(design.calibration).roller, ((f"{design.name}-tip-roller", SEAT_RADIUS),)
    seat, pin = "roller tip: seat radius", "roller: diameter"
    low, high = (limit - float(size) for limit in dowel_limits(size))
    known[seat], known[pin] = variable(seat, -SEAT, SEAT, stated=of), variable(pin, low, high)
    play = 2 * seat_radius(size) - float(size)
    return [
        summed("roller enters its seat", LEAST_PLAY, inf, play, ((seat, 2.0), (pin, -1.0))),
        summed("roller in its seat's middle", -inf, ROLLER_PLACE, play / 2, ((seat, 1.0), (pin, -0.5))),
    ]


PLACE_ON_HINGE = "gauge lies on its hinge"
SHARE = "bonding: element in its play on the tongue, share"
EYE = "bonding: gauge set between the tongue's edges"
TONGUE_ = "bonding nest: tongue width"


def bonding_requirements(layout: Layout, known: dict[str, DimensionLimits]) -> list[Requirement]:
    """Requirements on a design with [bonding]; adds the variables they depend on to `known`."""
    own: dict[str, DimensionLimits] = {}
    rigs = bonding_rigs(layout.design)
    wanted = [_on_hinge(layout, rigs, own)]
    for rig in rigs:
        wanted += [_on_backing(rig, own), _between_pins(rig, own), *_clamp_slides(rig, own)]
    known |= {name: replace(v, apart=True) for name, v in own.items()}
    return wanted


def _on_hinge(
    layout: Layout, rigs: Sequence[BondingLayout], known: dict[str, DimensionLimits]
) -> Requirement:
    """Each gauge within what bonding.signal_share lets it err along its hinge."""
    import numpy as np

    from tactcad.parts.array.measurements import allowed_places

    places = layout.elements
    table = rigs[0].table
    nests = tuple((_nest(rig), TONGUE_WIDTH) for rig in rigs)
    known[TONGUE_] = variable(TONGUE_, -TONGUE, TONGUE, len(rigs), nests)
    known[SHARE] = variable(SHARE, -1.0, 1.0, len(places))
    known[EYE] = variable(EYE, -table.sight, table.sight, len(places))
    allowed = allowed_places(layout)
    kind = np.array([next(i for i, rig in enumerate(rigs) if rig.hinge == p.hinge) for p in places])
    play = np.array([rig.play for rig in rigs])[kind]

    def room(a: Built) -> Array:
        loose = play + a.made[of_element(SLOT)] - a.made[TONGUE_][:, kind]
        return allowed - np.abs(a.made[SHARE] * loose / 2 + a.made[EYE])

    return Requirement(PLACE_ON_HINGE, "mm", 0.0, inf, room, fields=("bonding.sight", "bonding.signal_share"))


def _on_backing(rig: BondingLayout, known: dict[str, DimensionLimits]) -> Requirement:
    """The rear body is clear of its rest until the leaf lies on the tongue."""
    nest, body = f"bonding nest{_kind(rig)}: tip over rest", "bonding: rear body's height over the leaf"
    known[nest] = variable(nest, -TIP, TIP, stated=((_nest(rig), TIP_OVER_REST),))
    own = general(rig.design.element.rear_height)
    known.setdefault(body, variable(body, -own, own))
    return summed(f"leaf lies on its backing{_kind(rig)}", 0.0, inf, rig.drop, ((nest, 1.0), (body, -1.0)))


def _between_pins(rig: BondingLayout, known: dict[str, DimensionLimits]) -> Requirement:
    at, pin = _pins(rig, known)
    air = 2 * rig.pin_y - rig.pin_d - rig.design.sheet.thickness
    # each of a pair takes half of its zone and of its own thickness
    terms = ((at, 1.0), (pin, -0.5), (SHEET, -1.0))
    return summed(f"element enters between the fixture's pins{_kind(rig)}", 0.0, inf, air, terms)


def _clamp_slides(rig: BondingLayout, known: dict[str, DimensionLimits]) -> list[Requirement]:
    """The bar's holes pass the pins; these hold in the nest."""
    at, pin = _pins(rig, known)
    hole, size = f"bonding clamp{_kind(rig)}: holes' places", "bonding clamp: holes' diameter"
    known[hole] = variable(hole, -PLACE / 2, PLACE / 2, 2)
    own = general(rig.bar_hole)
    known.setdefault(size, variable(size, -own, own))
    # two pairs must not bind: the worst of two holes, each of a pin's place and its own
    slides = summed(
        f"clamp slides on its pins{_kind(rig)}",
        0.0,
        inf,
        PLAY,
        ((size, 1.0), (pin, -0.5), (at, -1.0), (hole, -1.0)),
    )
    bore = pressed(rig.pin_d)
    nest = f"bonding nest{_kind(rig)}: dowel hole diameter"
    of = ((_nest(rig), bore.name),)
    known[nest] = variable(nest, bore.lower - rig.pin_d, bore.upper - rig.pin_d, stated=of)
    holds = summed(
        f"pins hold in the fixture's nest{_kind(rig)}", LEAST_PRESS, inf, 0.0, ((pin, 0.5), (nest, -1.0))
    )
    return [slides, holds]


def _pins(rig: BondingLayout, known: dict[str, DimensionLimits]) -> tuple[str, str]:
    """Variables of the places of a pair of pins, and of their diameters."""
    at, pin = f"bonding nest{_kind(rig)}: pins' places", "bonding pins: diameter"
    known.setdefault(at, variable(at, -PLACE / 2, PLACE / 2, 2, ((_nest(rig), "dowel holes"),)))
    low, high = (limit - rig.pin_d for limit in dowel_limits(rig.design.clamp.dowel))
    known.setdefault(pin, variable(pin, low, high, 2))
    return at, pin


def _nest(rig: BondingLayout) -> str:
    return f"{rig.design.name}-bonding-nest{kind_suffix(rig)}"


def _kind(rig: BondingLayout) -> str:
    suffix = kind_suffix(rig)
    return f" {suffix.removeprefix('-')}" if suffix else ""
