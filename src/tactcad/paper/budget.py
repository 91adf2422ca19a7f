"""Uncertainty budget: every effect on K and on K_obj with its size for this array, largest first.

Sizes are half-widths. The pair is the reference element and the measuring element whose printed K_r/K_m
comes nearest to the ratio that the paper proposes, on the sample of Figure 6; K_r is the one that Table 2
supports.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, log, log10, nan, radians, tan

import numpy as np

from tactcad.lab.load_cell import CELL_ACCURACY
from tactcad.lab.simulate import approach
from tactcad.mechanics import gauge_signal, ladder, lumped, readout, self_heating
from tactcad.mechanics.sample_coupling import coupling
from tactcad.mechanics.section import HingeSection
from tactcad.paper.array_model import ArrayModel
from tactcad.paper.grasp_figures import elements_in_parallel
from tactcad.paper.published import Published
from tactcad.paper.reference_stiffness import Table2Study
from tactcad.paper.residuals import WIRE_TOLERANCE

MODULUS_PER_KELVIN = 4.5e-4  # aluminium, dlnE/dT between 0 and 50 C; handbooks give 4 to 5e-4
ROOM_SWING = 5.0  # K; hardware's own figure
RELAXATION_PER_DECADE = 0.04  # assumed: filled rubber loses 2 to 8 % of its force each decade of time
SAMPLE_TEST_TIME, GRASP_TIME = (
    10.0,
    300.0,
)  # s, assumed: reading a step in the sample test, a grasp with its weights
SLIPPERY = 0.02  # friction of a ball-bearing roller under the force sensor, chosen
CLOSED_FORM_ERROR = 0.0035  # goal that the closed forms are held to against finite elements

Stiffness = Callable[[HingeSection], np.ndarray]


@dataclass(frozen=True)
class Effect:
    """One effect. Sizes are relative half-widths; NaN where it does not act on K. `common` acts on all
    elements alike.
    """

    name: str
    how: str
    short_arm: float  # on K of the shortest arm
    long_arm: float
    on_object: float  # on K_obj of the pair
    remedy: str
    remaining: float  # on K_obj with the remedy


@dataclass(frozen=True)
class Budget:
    reference: float  # K_r, N/mm
    measuring: float
    object_stiffness: float
    sensitivity_reference: float  # dlnK_obj/dlnK_r
    sensitivity_measuring: float
    sensitivity_ratio: float
    effects: tuple[Effect, ...]  # largest on K_obj first

    def total(self, remaining: bool = False) -> float:
        """Root of the sum of squares on K_obj."""
        return sum((e.remaining if remaining else e.on_object) ** 2 for e in self.effects) ** 0.5


@dataclass(frozen=True)
class _Pair:
    """The pair and how errors reach K_obj through it."""

    K_r: float
    K_m: float
    x: float
    short: HingeSection  # the reference arm's section
    long: HingeSection  # the measuring arm's

    @property
    def by_reference(self) -> float:
        return float(lumped.condition_in_reference(self.K_r, self.K_m, self.x))

    @property
    def by_measuring(self) -> float:
        return float(lumped.condition_in_measuring(self.K_r, self.K_m, self.x))

    @property
    def by_ratio(self) -> float:
        return abs(float(lumped.condition_in_ratio(self.K_r, self.K_m, self.x)))

    def apart(self, short: float, long: float) -> float:
        """On K_obj, of errors of K that each element has for itself."""
        return ((self.by_reference * short) ** 2 + (self.by_measuring * long) ** 2) ** 0.5

    def together(self, short: float, long: float) -> float:
        """On K_obj, of errors of K that all elements share."""
        return abs(self.by_reference * short + self.by_measuring * long)

    def log_change(self, new: Stiffness, old: Stiffness) -> tuple[float, float]:
        """ln of new over old stiffness, of both arms."""
        short, long = (float(np.log(new(s) / old(s)).item()) for s in (self.short, self.long))
        return short, long

    def change(self, name: str, half: float) -> tuple[float, float]:
        """Half-width of ln K of both arms for a half-width (mm) of one dimension."""
        found = []
        for s in (self.short, self.long):
            own = getattr(s, name)
            both = [ladder.stiffness(s.with_(**{name: own + sign * half})) for sign in (-1, 1)]
            found.append(float(abs(np.log(both[0] / both[1])).item()) / 2)
        return found[0], found[1]


def budget(data: Published, array: ArrayModel, study: Table2Study) -> Budget:
    """All effects for the design and Table 2's pair."""
    K_r = study.supported.value[0]
    k = study.measuring
    K_m = float(k[np.argmin(np.abs(np.log(study.reference_printed / k / data.figure["proposed_ratio"])))])
    short, long = (array.section.rows([int(i)]) for i in (np.argmin(array.arm), np.argmax(array.arm)))
    pair = _Pair(K_r, K_m, data.figure["figure_6_sample"], short, long)
    effects = [
        _reference(pair, study, data, array),
        *_dimensions(pair, array),
        *_models(pair, array),
        *_calibration(pair, data, array),
        *_grasp(pair, data, array),
        *_sample(pair, data, array),
        *_electronics(pair, data, array),
    ]
    return Budget(
        K_r,
        K_m,
        pair.x,
        pair.by_reference,
        pair.by_measuring,
        -pair.by_ratio,
        tuple(sorted(effects, key=lambda e: -e.on_object)),
    )


def _reference(pair: _Pair, study: Table2Study, data: Published, array: ArrayModel) -> Effect:
    size = abs(log(study.reference_printed / pair.K_r))
    R = float(lumped.deflection_ratio(pair.K_r, pair.K_m, pair.x))
    off = abs(float(lumped.object_stiffness(study.reference_printed, pair.K_m, R)) / pair.x - 1)
    half = log(study.supported.high[0] / pair.K_r)
    stage = _stage_error(data, array)
    return Effect(
        "reference stiffness, printed against supported",
        f"equation (3) with either; the supported one's own interval is ±{half:.0%} of K_r",
        size,
        nan,
        off,
        "calibrate the reference element again",
        abs(pair.by_reference) * stage,
    )


def _dimensions(pair: _Pair, array: ArrayModel) -> list[Effect]:
    """Dimensions of the element, if K is taken from the drawing."""
    tol = array.tolerance
    measured = "calibrate each element: K is measured, not computed"

    def one(title: str, name: str, half: float, remedy: str, better: float) -> Effect:
        now, then = pair.change(name, half), pair.change(name, better)
        return Effect(
            title, f"±{half:g} mm by the closed form", *now, pair.apart(*now), remedy, pair.apart(*then)
        )

    pad = array.pad_length / 2
    wire = WIRE_TOLERANCE["1 pass"]
    sheet = pair.change("width", tol.sheet_thickness)
    return [
        one(
            "load point anywhere on the pad",
            "load_arm",
            pad,
            f"roller within {array.rig.load_point:g} mm",
            array.rig.load_point,
        ),
        one("hinge thickness, one pass of the wire", "hinge_thickness", wire, measured, 0.0),
        one("hinge thickness, as toleranced", "hinge_thickness", tol.hinge_thickness, measured, 0.0),
        one("hinge length", "hinge_length", tol.hinge_length, measured, 0.0),
        one("arm height", "arm_height", tol.arm_height, measured, 0.0),
        Effect(
            "sheet thickness",
            f"±{tol.sheet_thickness:g} mm, all elements alike",
            *sheet,
            pair.together(*sheet),
            "measure the sheet to 0.01 mm",
            pair.together(*sheet) * 0.01 / tol.sheet_thickness,
        ),
    ]


def _models(pair: _Pair, array: ArrayModel) -> list[Effect]:
    """What a computed K leaves out."""
    width = pair.log_change(lambda s: ladder.stiffness(s, "solid"), lambda s: ladder.stiffness(s, "plane"))
    gauge = pair.log_change(lambda s: gauge_signal.stiffness(s, array.gauge), ladder.stiffness)
    warm = MODULUS_PER_KELVIN * ROOM_SWING
    error = CLOSED_FORM_ERROR
    return [
        Effect(
            "plane stress instead of a solid",
            "solid rung over plane rung",
            *width,
            pair.together(*width),
            "solid rung",
            pair.apart(error, error),
        ),
        Effect(
            "gauge stiffens the leaf",
            "composite beam; upper bound",
            *gauge,
            pair.together(*gauge),
            "calibrate with the gauge on",
            0.0,
        ),
        Effect(
            "closed form against finite elements",
            "what the ladder is held to",
            error,
            error,
            pair.apart(error, error),
            "finite-element rung, 0.1 %",
            pair.apart(0.001, 0.001),
        ),
        Effect(
            "Young's modulus with temperature",
            f"{ROOM_SWING:g} K at {MODULUS_PER_KELVIN:g} 1/K",
            warm,
            warm,
            pair.together(warm, warm),
            "1 K room",
            pair.together(warm, warm) / ROOM_SWING,
        ),
    ]


def _calibration(pair: _Pair, data: Published, array: ArrayModel) -> list[Effect]:
    """The paper's calibration: force sensor on the pad."""
    rig = array.rig

    def stuck(mu: float) -> tuple[float, float]:
        rubbing = {"pad_height": array.pad_height, "friction": mu}
        return pair.log_change(lambda s: ladder.stiffness(s.with_(**rubbing)), ladder.stiffness)

    flat, roller = stuck(rig.friction), stuck(SLIPPERY)
    stage = _stage_error(data, array)
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
            "micrometer of the calibration",
            f"{rig.micrometer_resolution * 1e3:g} µm on the slope of one run",
            stage,
            stage,
            pair.apart(stage, stage),
            "three runs",
            pair.apart(stage, stage) / 3**0.5,
        ),
    ]


def _stage_error(data: Published, array: ArrayModel) -> float:
    """Relative half-width of one run's slope from the micrometer alone, over the paper's steps."""
    step = data.figure["calibration_step"] * 1e-3
    points = round(data.figure["calibration_travel"] / data.figure["calibration_step"]) + 1
    return array.rig.micrometer_resolution / (step * ((points**2 - 1) * points / 12) ** 0.5)


def _grasp(pair: _Pair, data: Published, array: ArrayModel) -> list[Effect]:
    """Pads out of plane, when R is made of totals instead of slopes."""
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


def _sample(pair: _Pair, data: Published, array: ArrayModel) -> list[Effect]:
    """What the rubber and its test do."""
    rig, x = array.rig, pair.x
    cell = rig.load_cell_stiffness
    stiffest = float(data.table2.object_stiffness.value.max())
    taken = cell / (cell - x) - 1
    known = x / cell * CELL_ACCURACY
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
            f"subtract it, known to {CELL_ACCURACY:.0%}",
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


def _coupled(pair: _Pair, data: Published, array: ArrayModel, thickness: float) -> float:
    """R of the pair through a continuous sample, over separate springs; for the design's own elements."""
    place = array.rows(data.table1.element)
    K = ladder.stiffness(array.section).copy()
    K[place[place >= 0]] = data.table1.stiffness.value[place >= 0]
    reference = int(array.rows(np.array([data.table1.element[data.reference]]))[0])
    K[reference] = pair.K_r
    measuring = int(np.argmin(np.abs(np.log(K / pair.K_m))))
    found = coupling(
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
    return float(found.ratio[measuring])


def _electronics(pair: _Pair, data: Published, array: ArrayModel) -> list[Effect]:
    """Bridge, noise, and the gauge's own warmth, at the first load of a grasp."""
    truth, reference = elements_in_parallel(data, array)
    K = truth.stiffness.copy()
    K[reference] = pair.K_r
    _, deflection = approach(np.array([array.rig.moving_weight]), K, pair.x)
    d = np.array([deflection[reference, 0], deflection[int(np.argmin(np.abs(K - pair.K_m))), 0]])
    q = np.array(
        [gauge_signal.foil_strain_per_deflection(s, array.gauge).item() for s in (pair.short, pair.long)]
    )
    factor = array.gauge.factor
    bend = np.abs(readout.bridge_nonlinearity(factor * q * d))
    per_mm = readout.volts_per_strain(factor, array.readout) * q
    noise = float(((array.readout.averaged_noise / (per_mm * d)) ** 2).sum() ** 0.5)
    drift = abs(self_heating.continuous(array.readout.excitation, array.gauge, array.power).drift)
    warm = float((drift / (factor * q * d)).max())
    at = f"at the first load, {array.rig.moving_weight:g} N"
    return [
        Effect(
            "bridge non-linearity",
            f"quarter bridge {at}",
            nan,
            nan,
            pair.by_ratio * float(abs(bend[1] - bend[0])),
            "invert the bridge exactly",
            0.0,
        ),
        Effect(
            "noise of the averaged reading",
            f"{array.readout.averaged_noise * 1e3:.2g} mV {at}, two standard deviations",
            nan,
            nan,
            pair.by_ratio * 2 * noise,
            "slope over all weights",
            pair.by_ratio * 2 * noise * array.rig.moving_weight / max(_span(array), 1e-9),
        ),
        Effect(
            "gauge warms itself",
            f"power on all the time; drift against the signal {at}, R of totals",
            nan,
            nan,
            pair.by_ratio * warm,
            "power on only while reading; slopes, since what is left is the same in each reading",
            0.0,
        ),
    ]


def _span(array: ArrayModel) -> float:
    """Root sum of squares of the loads about their mean, N: what a slope's noise is divided by."""
    n = array.rig.weights + 1
    return array.rig.weight * ((n**2 - 1) * n / 12) ** 0.5
