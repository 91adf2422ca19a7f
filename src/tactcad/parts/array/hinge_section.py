"""The array's elements as parameters of the mechanics."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from operator import attrgetter
from typing import TypeVar

import numpy as np

from tactcad.design.materials import ALLOYS, OPTIONAL, PROPERTIES, Alloy
from tactcad.design.sensing import ADC_NOISE, AMPLIFIERS, MULTIPLEXERS, SWITCHES, Converter
from tactcad.design.tree import Design
from tactcad.mechanics import ladder, strength, validity
from tactcad.mechanics.gauge_signal import Gauge
from tactcad.mechanics.ladder import elasticity
from tactcad.mechanics.readout import ReadOut, sample_noise, transmission
from tactcad.mechanics.section import Array, HingeSection
from tactcad.mechanics.validity import Reason

from ..bought.electronic_parts import completion_resistance, converter_of
from .converter_figures import bridge_supply, converter_noise, converter_supply
from .layout import ElementPlace, HingeShape, Layout
from .leads import longest_lead_resistance

T = TypeVar("T")


def hinge_section(layout: Layout, places: Sequence[ElementPlace]) -> HingeSection:
    """Section parameters of elements of the array, mm and MPa.

    Parameters
    ----------
    layout
        The array.
    places
        The elements.

    Returns
    -------
    HingeSection
        Of shape (len(places),), or of many designs at once (..., len(places)).
    """
    own = [own_parameters(p.hinge, p.load_arm, p.body_length) for p in places]
    stacked = {n: np.stack(np.broadcast_arrays(*(each[n] for each in own)), axis=-1) for n in own[0]}
    return HingeSection.of(**stacked, **shared_parameters(layout.design))


@dataclass(frozen=True)
class Hinges:
    """Every element's hinge by the default rung, by number; NaN beyond its range.

    stiffness    K, N/mm
    yield_force  N at the pad
    broken       why the estimator refuses it (a validity.Reason, or None)
    """

    section: HingeSection
    stiffness: Array
    yield_force: Array
    broken: np.ndarray


@lru_cache(maxsize=16)
def hinges(layout: Layout) -> Hinges:
    """The layout's hinges, computed once."""
    s = hinge_section(layout, layout.elements)
    known = ladder.evaluate(s)
    at_yield = strength.yield_force_where_known(s, design_alloy(layout.design))
    return Hinges(s, known.stiffness, at_yield, known.broken)


def arms(layout: Layout) -> Array:
    """Distance from every hinge's centre to its arm's tip, by number, mm."""
    return np.array([p.arm for p in layout.elements])


def element_section(layout: Layout, place: ElementPlace) -> HingeSection:
    """Section parameters of one element: numbers, or arrays where the layout has them."""
    own = own_parameters(place.hinge, place.load_arm, place.body_length)
    return HingeSection.of(**own, **shared_parameters(layout.design))


def thickness_elasticity(layout: Layout, place: ElementPlace) -> float:
    """dlnK/dln t of one element, by the solid rung; beyond the range of its fit by the section integral."""
    s = hinge_section(layout, (place,))
    return float(elasticity(s, "hinge_thickness", "solid" if ladder.evaluate(s).valid else "section").item())


def own_parameters(hinge: HingeShape, load_arm: float, body_length: float) -> dict[str, float]:
    """Parameters that may differ between elements of one design, by the names of `HingeSection`'s fields;
    mm.
    """
    return {
        "hinge_thickness": hinge.t,
        "hinge_length": hinge.l,
        "fillet_radius": hinge.r,
        "load_arm": load_arm,
        "arm_height": hinge.h,
        "body_length": body_length,
    }


def shared_parameters(design: Design) -> dict[str, float]:
    """Parameters that all elements of a design share, by the names of `HingeSection`'s fields; mm, MPa."""
    shared = {name: attrgetter(path)(design) for name, path in SHARED.items()}
    return shared | {"two_sided": design.element.sides == "two"}


def design_alloy(design: Design) -> Alloy:
    """The design's material with the values that the design file gives."""
    own = vars(design.material)
    row = ALLOYS.get(design.material.alloy)
    return Alloy(
        own["alloy"], **{k: own[k] for k in (*PROPERTIES, *OPTIONAL)}, source=row.source if row else ""
    )


def design_gauge(design: Design) -> Gauge:
    """The design's strain gauge, the same on all elements."""
    # A record filled with the table's values of the same names
    return Gauge(**{name: getattr(design.gauge, name) for name in _names(Gauge)})


def design_readout(design: Design) -> ReadOut:
    """The design's bridge, amplifier and card, with the longest of its leads; or the bridge alone, as a
    converter takes it."""
    given, layout = design.readout, Layout(design)
    converter = converter_of(design)
    left = transmission(
        design.gauge.resistance,
        completion_resistance(design),
        longest_lead_resistance(layout),
        0.0 if converter else SWITCHES[given.switch].on_ohm,
        given.connection == "three-wire",
    )
    if converter:
        return _by_converter(layout, converter, left)
    noise = derived_noise(design) if given.noise is None else given.noise
    own = {name: getattr(given, name) for name in _names(ReadOut) if hasattr(given, name)}
    adc_noise = ADC_NOISE * given.adc_range if given.adc_noise is None else given.adc_noise
    return ReadOut(**own | {"noise": noise, "adc_noise": adc_noise, "transmission": left})


def _by_converter(layout: Layout, converter: Converter, left: float) -> ReadOut:
    """At its highest gain, which takes least and tells most."""
    volts, rails, gain = bridge_supply(layout), converter_supply(), max(converter.gains)
    noise, offset = converter_noise(layout, converter, gain), layout.design.readout.bridge_offset
    reach = volts / gain
    return ReadOut(volts, 1.0, rails, -rails, 0.0, offset, noise, converter.bits, reach, 1, 0.0, left)


def derived_noise(design: Design) -> float:
    """Rms of one sample at the amplifier's output, V, by the electronic parts of the design."""
    r, amplifier = design.readout, AMPLIFIERS[design.readout.amplifier]
    arm, gauge = completion_resistance(design), design.gauge.resistance
    source = gauge * arm / (gauge + arm) + arm / 2 + 2 * MULTIPLEXERS[r.multiplexer].on_ohm
    return sample_noise(r.gain, amplifier.noise_density(r.gain), amplifier.bandwidth(r.gain), source)


@cache
def _names(kind: Callable[..., object]) -> tuple[str, ...]:
    return tuple(inspect.signature(kind).parameters)


# A section's parameters and their fields in the design file; an element may override the first four.
SHARED = {
    "body_height": "element.body_height",
    "poisson": "material.poisson",
    "youngs_modulus": "material.youngs_modulus",
    "width": "sheet.thickness",
    "pad_height": "element.pad_height",
    "friction": "rating.friction",
}
PATHS = {
    "hinge_thickness": "element.hinge_thickness",
    "hinge_length": "element.hinge_length",
    "fillet_radius": "element.fillet_radius",
    "arm_height": "element.arm_height",
    "load_arm": "array.row_arms",
    "body_length": "element.rear_length",
    **SHARED,
}


def in_design(why: Reason | None, layout: Layout, place: ElementPlace) -> str:
    """Why the estimator refuses an element, with the design's own fields and their values: "...
    (array.row_arms: load_arm 30, element.body_height: 4)". "" for None.
    """
    if why is None:
        return ""
    own = own_parameters(place.hinge, place.load_arm, place.body_length)
    values = own | shared_parameters(layout.design)
    named = (f"{_path(name, layout, place)}: {name} {values[name]:.4g}" for name in why.fields)
    return f"{why.rule} ({', '.join(named)})"


def _path(name: str, layout: Layout, place: ElementPlace) -> str:
    hinge = layout.design.element.override.get(place.number)
    if hinge is not None and getattr(hinge, name, None) is not None:
        return f"element.override.{place.number}.{name}"
    return PATHS[name]


def not_reached(layout: Layout, places: Sequence[ElementPlace], section: HingeSection, rung: str) -> str:
    """Why a rung does not reach the first of these elements that it does not, their parameters in `section`;
    "" if it reaches all."""
    for place, why in zip(places, validity.first_broken(section, rung).ravel()):
        if why:
            return f"rung {rung} does not reach element {place.number}: {in_design(why, layout, place)}"
    return ""
