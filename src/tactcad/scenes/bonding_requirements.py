"""What must hold for gauges to be bonded where they read: place on the hinge, leaf on its backing, pins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

from tactcad.parts.end_plate import pressed
from tactcad.parts.layout import Layout
from tactcad.parts.library.dowels import dowel_limits
from tactcad.parts.library.fits import general
from tactcad.parts.plate import PLACE
from tactcad.parts.rigs.bonding_layout import PLAY, TIP, TONGUE, BondingLayout, bonding_rigs, kind_suffix
from tactcad.parts.rigs.bonding_nest import TIP_OVER_REST, TONGUE_WIDTH

from .requirement import LEAST_PRESS, Built, DimensionLimits, Requirement, summed, variable

if TYPE_CHECKING:
    from tactcad.mechanics.section import Array

PLACE_ON_HINGE = "gauge lies on its hinge"
SHARE, EYE = (
    "bonding: element in its play on the tongue, share",
    "bonding: gauge set between the tongue's edges",
)
TONGUE_ = "bonding nest: tongue width"


def bonding_requirements(layout: Layout, known: dict[str, DimensionLimits]) -> list[Requirement]:
    """Requirements on a design with [bonding]; adds the variables they depend on to `known`."""
    own: dict[str, DimensionLimits] = {}
    wanted = _requirements(layout, own)
    known |= {name: replace(v, apart=True) for name, v in own.items()}
    return wanted


def _requirements(layout: Layout, known: dict[str, DimensionLimits]) -> list[Requirement]:
    rigs = bonding_rigs(layout.design)
    wanted = [_on_hinge(layout, rigs, known)]
    for rig in rigs:
        wanted += [_on_backing(rig, known), _between_pins(rig, known), *_clamp_slides(rig, known)]
    return wanted


def _on_hinge(
    layout: Layout, rigs: Sequence[BondingLayout], known: dict[str, DimensionLimits]
) -> Requirement:
    """Each gauge within what bonding.signal_share lets it err along its hinge."""
    import numpy as np

    from tactcad.parts.gauge_checks import allowed_places

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
        loose = play + a.made["element: slot length"] - a.made[TONGUE_][:, kind]
        return allowed - np.abs(a.made[SHARE] * loose / 2 + a.made[EYE])

    return Requirement(PLACE_ON_HINGE, "mm", 0.0, inf, room, fields=("bonding.sight", "bonding.signal_share"))


def _on_backing(rig: BondingLayout, known: dict[str, DimensionLimits]) -> Requirement:
    """The rear body stands off its rest until the leaf lies on the tongue."""
    nest, body = f"bonding nest{_kind(rig)}: tip over rest", "bonding: rear body's height over the leaf"
    known[nest] = variable(nest, -TIP, TIP, stated=((_nest(rig), TIP_OVER_REST),))
    own = general(rig.design.element.rear_height)
    known.setdefault(body, variable(body, -own, own))
    return summed(f"leaf lies on its backing{_kind(rig)}", 0.0, inf, rig.drop, ((nest, 1.0), (body, -1.0)))


def _between_pins(rig: BondingLayout, known: dict[str, DimensionLimits]) -> Requirement:
    at, pin = _pins(rig, known)
    air = 2 * rig.pin_y - rig.pin_d - rig.design.sheet.thickness
    # each of a pair takes half of its zone and of its own thickness
    terms = ((at, 1.0), (pin, -0.5), ("sheet: thickness", -1.0))
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
