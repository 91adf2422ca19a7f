"""Load on every element at the end of the calibration's travel, without the stop plate."""

from __future__ import annotations

from dataclasses import dataclass

from tactcad.design.present import present
from tactcad.design.tree import Design

from ..layout import ElementPlace, Layout


@dataclass(frozen=True)
class CalibrationLoad:
    """One element at the end of calibration.travel.

    Gauge and element are springs in series: of the micrometer's travel D the element takes d = D K_g/(K_g +
    K).

    deflection        mm at the pad
    force             N
    rated_deflection  mm that the hinge may give way
    travel_at_rated   mm of the micrometer that reach it
    travel_at_yield   mm of the micrometer at which the fillet yields
    refused           why the estimator refuses the element; then the numbers are NaN
    """

    place: ElementPlace
    deflection: float
    force: float
    rated_deflection: float
    travel_at_rated: float
    travel_at_yield: float
    refused: str = ""


def calibration_loads(design: Design) -> tuple[CalibrationLoad, ...]:
    """Every element, by number."""
    from tactcad.mechanics import ladder, strength  # numpy, which only checks and guides need

    from ..hinge_section import design_alloy, hinge_section, in_design

    c, layout = present(design.calibration), Layout(design)
    s = hinge_section(layout, layout.elements)
    known = ladder.evaluate(s, ladder.DEFAULT_RUNG)
    yields = strength.yield_force_where_known(s, design_alloy(design))
    loads = []
    for place, K, why, at_yield in zip(layout.elements, known.stiffness, known.reason, yields):
        share = c.load_cell_stiffness / (c.load_cell_stiffness + K)
        rated = at_yield / design.rating.deflection_factor / K
        deflection = c.travel * share
        figures = (deflection, K * deflection, rated, rated / share, at_yield / K / share)
        gives, force, may_give, to_rated, to_yield = map(float, figures)
        loads.append(
            CalibrationLoad(
                place, gives, force, may_give, to_rated, to_yield, in_design(str(why), layout, place)
            )
        )
    return tuple(loads)
