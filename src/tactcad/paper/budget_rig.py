"""Effects of calibration, grasp and sample test."""

from __future__ import annotations

from math import inf, log, log10, nan, radians, tan

import numpy as np

from tactcad.lab.simulate import approach
from tactcad.mechanics import ladder
from tactcad.mechanics.sample_coupling import coupling
from tactcad.paper.array_model import ArrayModel
from tactcad.paper.budget_effect import BudgetPair, Effect
from tactcad.paper.grasp_figures import elements_in_parallel
from tactcad.paper.published import Published

RELAXATION_PER_DECADE = 0.04  # assumed: filled rubber loses 2 to 8 % of its force each decade of time
# s, assumed: reading a step in the sample test, a grasp with its weights
SAMPLE_TEST_TIME, GRASP_TIME = 10.0, 300.0
SLIPPERY = 0.02  # friction of a ball-bearing roller under the force sensor, chosen
CELL_MEASURED = 0.005  # relative half-width of a load cell's stiffness measured in its stand, chosen


def rig(pair: BudgetPair, data: Published, array: ArrayModel) -> list[Effect]:
    return [*_calibration(pair, data, array), *_grasp(pair, data, array), *_sample(pair, data, array)]


def _calibration(pair: BudgetPair, data: Published, array: ArrayModel) -> list[Effect]:
    """The paper's calibration: force sensor on the pad."""
    rig = array.rig

    def stuck(mu: float) -> tuple[float, float]:
        rubbing = {"pad_height": array.pad_height, "friction": mu}
        return pair.log_change(lambda s: ladder.stiffness(s.with_(**rubbing)), ladder.stiffness)

    flat, roller = stuck(rig.friction), stuck(SLIPPERY)
    stage = stage_error(data, array)
    cell_r, cell_m = (K / rig.load_cell_stiffness * rig.load_cell_accuracy for K in (pair.K_r, pair.K_m))
    cell = pair.together(cell_r, cell_m)
    return [
        Effect(
            "friction at the force sensor's tip",
            f"µ {rig.friction:g}, K L/(L − µH), H = pad height + t/2",
            *flat,
            pair.together(*flat),
            "roller instead of a flat tip",
            pair.together(*roller),
        ),
        Effect(
            "load cell in series in the calibration",
            f"{rig.load_cell_stiffness:g} N/mm ±{rig.load_cell_accuracy:.0%}: K = k K_c/(K_c - k)",
            cell_r,
            cell_m,
            cell,
            f"measure the cell in its stand to {CELL_MEASURED:.1%}",
            cell * min(CELL_MEASURED / max(rig.load_cell_accuracy, CELL_MEASURED), 1.0),
        ),
        Effect(
            "micrometer of the calibration",
            f"{rig.micrometer_resolution * 1e3:g} µm on the slope of one run",
            stage,
            stage,
            pair.apart(stage, stage),
            "three runs",
            pair.apart(stage, stage) / 3**0.5,
        ),
    ]


def stage_error(data: Published, array: ArrayModel) -> float:
    """Relative half-width of one run's slope from the micrometer alone, over the paper's steps."""
    step = data.figure["calibration_step"] * 1e-3
    points = round(data.figure["calibration_travel"] / data.figure["calibration_step"]) + 1
    return array.rig.micrometer_resolution / (step * ((points**2 - 1) * points / 12) ** 0.5)


def _grasp(pair: BudgetPair, data: Published, array: ArrayModel) -> list[Effect]:
    """Pads out of plane, where R is made of totals instead of slopes."""
    truth, reference = elements_in_parallel(data, array)
    K = truth.stiffness.copy()
    K[reference] = pair.K_r
    z = float(approach(np.array([array.rig.moving_weight]), K, pair.x)[0][0])
    height = array.tolerance.pad_height
    span = float(max(np.ptp(array.pad_x), np.ptp(array.pad_y)))
    tilted = span / 2 * tan(radians(array.tolerance.tilt))
    slopes = "slopes against load, not totals"
    at = f"at the first load, {array.rig.moving_weight:g} N, approach {z * 1e3:.3g} µm"
    return [
        Effect(
            "pad height",
            f"±{height * 1e3:g} µm {at}",
            nan,
            nan,
            pair.by_ratio * 2**0.5 * height / z,
            slopes,
            0.0,
        ),
        Effect(
            "tilt of the array",
            f"{array.tolerance.tilt:g} degree over {span:g} mm: {tilted * 1e3:.3g} µm {at}",
            nan,
            nan,
            pair.by_ratio * tilted / z,
            slopes,
            0.0,
        ),
    ]


def _sample(pair: BudgetPair, data: Published, array: ArrayModel) -> list[Effect]:
    """Effects of the rubber and of its test."""
    rig, x = array.rig, pair.x
    cell = rig.load_cell_stiffness
    stiffest = float(data.table2.object_stiffness.value.max())
    taken = cell / (cell - x) - 1
    known = x / cell * rig.load_cell_accuracy
    # Tangential over normal stiffness of a pad, 2(1 - nu)/(2 - nu): Johnson, Contact Mechanics.
    lateral = x * 2 * (1 - rig.sample_poisson) / (2 - rig.sample_poisson)
    lever = array.pad_height + float(pair.short.hinge_thickness.item()) / 2
    shear_r, shear_m = (
        lateral * (lever / float(s.load_arm.item())) ** 2 / K
        for s, K in ((pair.short, pair.K_r), (pair.long, pair.K_m))
    )
    relaxed = RELAXATION_PER_DECADE * abs(log10(GRASP_TIME / SAMPLE_TEST_TIME))
    ratio = {h: _coupled(pair, data, array, h) for h in (inf, rig.sample_thickness)}
    return [
        Effect(
            "load cell's own compliance in the sample test",
            f"{stiffest:g} N/mm becomes {stiffest * cell / (cell - stiffest):.3g} uncorrected",
            nan,
            nan,
            taken,
            f"subtract it, known to {rig.load_cell_accuracy:.0%}",
            known,
        ),
        Effect(
            "pads coupled through one sample",
            "elastic half-space against separate springs",
            nan,
            nan,
            pair.by_ratio * abs(log(ratio[inf])),
            f"sample {rig.sample_thickness:g} mm thick, bonded",
            pair.by_ratio * abs(log(ratio[rig.sample_thickness])),
        ),
        Effect(
            "rubber shears on stuck pads",
            "lateral stiffness of the sample on the pad's lever (H/L)^2",
            shear_r,
            shear_m,
            pair.together(shear_r, shear_m),
            "lubricate the sample: a fifth of it",
            pair.together(shear_r, shear_m) / 5,
        ),
        Effect(
            "relaxation between sample test and grasp",
            f"assumed {RELAXATION_PER_DECADE:.0%} a decade, {SAMPLE_TEST_TIME:g} s to {GRASP_TIME:g} s",
            nan,
            nan,
            relaxed,
            "same waiting time in both, within a factor of two",
            RELAXATION_PER_DECADE * log10(2),
        ),
    ]


def _coupled(pair: BudgetPair, data: Published, array: ArrayModel, thickness: float) -> float:
    """R of the pair through a continuous sample, over separate springs; for the design's own elements."""
    place = array.rows(data.table1.element)
    K = ladder.stiffness(array.section).copy()
    K[place[place >= 0]] = data.table1.stiffness.value[place >= 0]
    reference = int(array.rows(np.array([data.table1.element[data.reference]]))[0])
    K[reference] = pair.K_r
    measuring = int(np.argmin(np.abs(np.log(K / pair.K_m))))
    shares = coupling(
        K,
        array.pad_x,
        array.pad_y,
        pair.x,
        reference,
        array.pad_length,
        float(np.max(array.section.width)),
        thickness,
        array.rig.sample_poisson,
    )
    return float(shares.ratio[measuring])
