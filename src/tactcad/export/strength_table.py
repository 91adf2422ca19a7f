"""The golden files' figures of every element, and the strength summary: a CSV file with its ratings, and its
load under the overload force."""

from __future__ import annotations

import numpy as np

from tactcad.design.files import as_csv
from tactcad.design.tree import Design
from tactcad.mechanics import strength
from tactcad.parts.array.element import element_number
from tactcad.parts.array.hinge_section import design_alloy, hinges
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.stop_gap import overloads

NAME = "strength.csv"


def elements(design: Design) -> dict[str, dict]:
    """Hinge, stiffness (N/mm) and force at yield (N) of every element by the default rung; None outside its
    range."""
    layout = Layout(design)
    known = hinges(layout)
    return {
        place.designator: {
            "part_no": element_number(design, place),
            "arm_mm": place.arm,
            "load_arm_mm": place.load_arm,
            "hinge_thickness_mm": place.hinge.t,
            "hinge_length_mm": place.hinge.l,
            "fillet_radius_mm": place.hinge.r,
            "arm_height_mm": place.hinge.h,
            "stiffness_n_per_mm": None if why else float(K),
            "yield_force_n": None if why else float(force),
        }
        for place, K, force, why in zip(layout.elements, known.stiffness, known.yield_force, known.broken)
    }


def strength_bytes(layout: Layout) -> bytes:
    """The summary (RFC 4180, UTF-8), rows by element number, by the rung `solid`; four significant digits.

    The second stiffness is with the Young's modulus of the alloy in the table of materials. Yield factors are
    yield strength over the fillet's stress. If an element is out of the estimator's range, its figures are
    blank and the last column gives the reason.
    """
    design, places = layout.design, layout.elements
    known, alloy, states = hinges(layout), design_alloy(design), overloads(layout)
    stiffness, yields = known.stiffness, known.yield_force
    rated = np.array([state.rated_force for state in states])
    goodman = strength.goodman(alloy, rated * alloy.yield_strength / yields)
    rows = []
    for i, (place, state) in enumerate(zip(places, states)):
        figures = {
            "stiffness_N_per_mm": stiffness[i],
            "stiffness_with_tables_modulus_N_per_mm": stiffness[i] * (design.stiffness_factor or 1.0),
            "rated_force_N": state.rated_force,
            "yield_force_N": yields[i],
            "yield_factor_at_rated": yields[i] / state.rated_force,
            "goodman_factor_at_rated": goodman[i],
            "overload_force_N": design.rating.overload_force,
            "largest_stop_gap_mm": state.gap,
            "stop_closes_at_N": state.closing_force,
            "hinge_deflection_at_overload_mm": state.deflection,
            "rated_deflection_mm": state.rated_deflection,
            "fillet_stress_at_overload_MPa": state.stress,
            "yield_factor_at_overload": state.yield_factor,
        }
        row = {
            "design": design.name,
            "revision": design.design.revision,
            "element": place.designator,
            "part_no": element_number(design, place),
            "alloy": alloy.name,
            "yield_strength_MPa": f"{alloy.yield_strength:g}",
            "arm_mm": f"{place.arm:g}",
        }
        row |= {name: "" if state.refused else f"{float(value):.4g}" for name, value in figures.items()}
        rows.append(row | {"not_known_because": state.refused})
    return as_csv([rows[0], *(row.values() for row in rows)])
