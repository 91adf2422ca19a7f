"""The whole validation: every study on one set of data and one design, as a report."""

from __future__ import annotations

import numpy as np

from tactcad.design.messages import InputError
from tactcad.fem import fem_ladder
from tactcad.paper import (
    budget,
    gain,
    grasp_figures,
    hinge,
    inclination,
    inversion,
    reference_element,
    reference_stiffness,
    residuals,
    table1_check,
    table2,
)
from tactcad.paper.array_model import ArrayModel
from tactcad.paper.published import Published
from tactcad.report.figures import sig
from tactcad.report.report import ValidationReport

SEED = 20260101  # of every Monte Carlo draw: the same report from the same data
LEAST_COMMON = 4  # elements of Table 1 that a design must have for meaningful fits


def validate(data: Published, array: ArrayModel) -> ValidationReport:
    """All ten sections. Raises InputError when the design has too few of Table 1's elements."""
    common = residuals.matched(data, array)[0]
    if len(common) < LEAST_COMMON or data.reference not in common:
        raise InputError(
            f"design {array.name}",
            "does not have Table 1's elements, by number and arm length",
            value=f"{len(common)} of them",
            legal=f"{LEAST_COMMON} of {data.table1.element.tolist()} at least, the reference element "
            f"among them",
        )
    rng = np.random.default_rng(SEED)
    K = residuals.residuals(data, array, rng, fem_ladder.stiffnesses(residuals.matched(data, array)[1]))
    fit = hinge.fit(data, array)
    signal = gain.fit(data, array)
    own = table1_check.check(data)
    ratios = reference_stiffness.study(data)
    supported = ratios.supported.value[0]
    reference = reference_element.study(data, array, ratios)
    six = grasp_figures.figure_6(data, array, supported, rng)
    seven = grasp_figures.figure_7(ratios)
    effects = budget.budget(data, array, ratios)
    inverted = inversion.invert(ratios)
    inclined = inclination.study(data, array, ratios)
    sections = (
        residuals.page(K, array),
        hinge.page(fit, array),
        gain.page(signal, array),
        table1_check.page(own, data),
        table2.page(ratios, data, K, reference),
        grasp_figures.page(six, seven, array),
        reference_element.page(reference),
        budget.page(effects),
        inversion.page(inverted),
        inclination.page(inclined),
    )
    by_key = {s.key: s for s in sections}
    summary = tuple(
        h
        for key in ("table2", "inclination", "reference", "stiffness", "table1", "inversion")
        for h in by_key[key].headline
    )
    return ValidationReport(
        "Compared with the paper: a spring-based tactile array",
        "Tables 1 and 2 of “Spring-based tactile array for assistive robotic surgical applications”, "
        f"the lumped pair, and the beam model of the design {array.name}.",
        summary,
        sections,
        "Every number on this page was computed when it was made; sentences are chosen by the numbers. "
        f"Intervals are 95 %. Units: N, mm, V. Monte Carlo seed {SEED}; supported reference stiffness "
        f"{sig(supported, 4)} N/mm.",
    )
