"""Uncertainty budget: every effect on K and on K_obj with its size for this array, largest first.

Sizes are half-widths. The pair is the reference element and the measuring element whose printed K_r/K_m
is nearest to the ratio that the paper proposes, on the sample of Figure 6; K_r is the stiffness that Table 2
supports.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, log, log10, nan, radians, tan

import numpy as np

from tactcad.contact import springs
from tactcad.fem.bonded_leaf import stiffness
from tactcad.mechanics import gauge_signal, ladder, lumped, readout
from tactcad.mechanics.as_built import COMMON, half_widths
from tactcad.mechanics.lumped import coupling
from tactcad.mechanics.section import HingeSection
from tactcad.paper.array_model import ArrayModel
from tactcad.paper.published import Published
from tactcad.paper.reference_stiffness import Table2Study
from tactcad.parts.array.element import WIRE_TOLERANCE
from tactcad.report import plots as d
from tactcad.report.figures import percent, sig
from tactcad.report.report import Picture, ReportSection, ReportTable

from .grasp_figures import elements_in_parallel
from .prose import drawn, effect_text, saying, section, table


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


def budget(data: Published, array: ArrayModel, study: Table2Study) -> Budget:
    """All effects for the design and Table 2's pair."""
    K_r = study.supported.value[0]
    k = study.measuring
    K_m = float(k[np.argmin(np.abs(np.log(study.reference_printed / k / data.figure["proposed_ratio"])))])
    short, long = (array.section.rows([int(i)]) for i in (np.argmin(array.arm), np.argmax(array.arm)))
    pair = BudgetPair(K_r, K_m, data.figure["figure_6_sample"], short, long)
    return Budget(
        K_r,
        K_m,
        pair.x,
        pair.by_reference,
        pair.by_measuring,
        -pair.by_ratio,
        tuple(sorted(effects(pair, study, data, array), key=lambda e: -e.on_object)),
    )


ROOM_SWING = 5.0  # K; hardware's own figure
CLOSED_FORM_ERROR = 0.0035  # goal for the closed forms against finite elements
SHEET_MEASURED = 0.01  # mm, half-width of a micrometer's reading of the sheet
RELAXATION_PER_DECADE = 0.04  # assumed: filled rubber loses 2 to 8 % of its force each decade of time
# s, assumed: reading a step in the sample test, a grasp with its weights
SAMPLE_TEST_TIME, GRASP_TIME = 10.0, 300.0
SLIPPERY = 0.02  # friction of a ball-bearing roller under the force sensor, chosen
CELL_MEASURED = 0.005  # relative half-width of a load cell's stiffness measured in its stand, chosen
# Fields of [tolerance] that are effects of their own, in the report's order.
AS_BUILT = (
    "hinge_thickness",
    "hinge_length",
    "fillet_radius",
    "arm_height",
    "sheet_thickness",
    "youngs_modulus",
    "recast_layer",
    "clamp_compliance",
)
Stiffness = Callable[[HingeSection], np.ndarray]
NOT_ON_K = (nan, nan)


@dataclass(frozen=True)
class Effect:
    """One effect. Sizes are relative half-widths; NaN if it does not act on K."""

    name: str
    how: str
    short_arm: float  # on K of the shortest arm
    long_arm: float
    on_object: float  # on K_obj of the pair
    remedy: str
    remaining: float  # on K_obj with the remedy


def effect(
    key: str, on_stiffness: tuple[float, float], on_object: float, remaining: float, **said: object
) -> Effect:
    """`said` is what the prose of that key leaves open."""
    name, how, remedy = effect_text(key, **said)
    return Effect(name, how, *on_stiffness, on_object, remedy, remaining)


@dataclass(frozen=True)
class BudgetPair:
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
        """Half-width of K_obj for half-widths of K that are independent in the two elements."""
        return ((self.by_reference * short) ** 2 + (self.by_measuring * long) ** 2) ** 0.5

    def together(self, short: float, long: float) -> float:
        """Half-width of K_obj for half-widths of K that both elements share."""
        return abs(self.by_reference * short + self.by_measuring * long)

    def log_change(self, new: Stiffness, old: Stiffness) -> tuple[float, float]:
        """ln of new over old stiffness, of both arms."""
        short, long = (float(np.log(new(s) / old(s)).item()) for s in (self.short, self.long))
        return short, long

    def change(self, name: str, half: float) -> tuple[float, float]:
        """Half-width of ln K of both arms for a half-width (mm) of one dimension."""
        changes = []
        for s in (self.short, self.long):
            own = getattr(s, name)
            both = [ladder.stiffness(s.with_(**{name: own + sign * half})) for sign in (-1, 1)]
            changes.append(float(abs(np.log(both[0] / both[1])).item()) / 2)
        return changes[0], changes[1]


def effects(pair: BudgetPair, study: Table2Study, data: Published, array: ArrayModel) -> list[Effect]:
    return [
        _reference(pair, study, data, array),
        *_as_built(pair, array),
        *_contact(pair, array),
        *_models(pair, array),
        *_calibration(pair, data, array),
        *_grasp(pair, data, array),
        *_sample(pair, data, array),
        *_signal(pair, data, array),
    ]


def _reference(pair: BudgetPair, study: Table2Study, data: Published, array: ArrayModel) -> Effect:
    size = abs(log(study.reference_printed / pair.K_r))
    R = float(lumped.deflection_ratio(pair.K_r, pair.K_m, pair.x))
    off = abs(float(lumped.object_stiffness(study.reference_printed, pair.K_m, R)) / pair.x - 1)
    half = log(study.supported.high[0] / pair.K_r)
    remaining = abs(pair.by_reference) * stage_error(data, array)
    return effect("reference", (size, nan), off, remaining, half=half)


# --- on K computed from the drawing: the element as built, and the model's omissions ---


def _as_built(pair: BudgetPair, array: ArrayModel) -> list[Effect]:
    """Effects of [tolerance], by the model's own derivatives."""
    short, long = (half_widths(s, array.tolerance) for s in (pair.short, pair.long))
    found = []
    for field in AS_BUILT:
        size, half = getattr(array.tolerance, field), (float(short[field].item()), float(long[field].item()))
        on_object = pair.together(*half) if field in COMMON else pair.apart(*half)
        left = on_object * SHEET_MEASURED / size if field == "sheet_thickness" else 0.0
        found.append(effect(field, half, on_object, left, size=size, measured=SHEET_MEASURED))
    return found


def _contact(pair: BudgetPair, array: ArrayModel) -> list[Effect]:
    """Position of the load, and the coarsest cut: by the closed form at both ends, since the effects are
    large."""
    found = []
    for key, name, half, better in (
        ("load point", "load_arm", array.pad_length / 2, array.calibration.load_point),
        ("one pass", "hinge_thickness", WIRE_TOLERANCE["1 pass"], 0.0),
    ):
        now, then = pair.change(name, half), pair.change(name, better)
        found.append(effect(key, now, pair.apart(*now), pair.apart(*then), half=half, better=better))
    return found


def _bonded(pair: BudgetPair, array: ArrayModel) -> list[Effect]:
    """Effects of the bond line and of the gauge on K, by elements with a layer of each."""

    def stiffer(more: int, fewer: int) -> tuple[float, float]:
        over, under = array.layers[:more], array.layers[:fewer]
        return pair.log_change(
            lambda s: np.array(stiffness(s.rows(0), over)), lambda s: np.array(stiffness(s.rows(0), under))
        )

    bond = int(array.bond_line)
    glued, gauge = stiffer(bond, 0), stiffer(len(array.layers), bond)
    whole = pair.log_change(lambda s: gauge_signal.stiffness(s, array.gauge), ladder.stiffness)
    found = [effect("gauge", gauge, pair.together(*gauge), 0.0, bound=whole[0])]
    if bond:
        line = {"thickness": array.layers[0].thickness * 1e3, "modulus": array.layers[0].modulus}
        found.append(effect("bond line", glued, pair.together(*glued), 0.0, **line))
    return found


def _models(pair: BudgetPair, array: ArrayModel) -> list[Effect]:
    """Effects that a computed K leaves out."""
    width = pair.log_change(lambda s: ladder.stiffness(s, "solid"), lambda s: ladder.stiffness(s, "plane"))
    other = (abs(log(array.stiffness_factor)),) * 2
    error = (CLOSED_FORM_ERROR,) * 2
    warm = (array.modulus_per_kelvin * ROOM_SWING,) * 2
    warmed = pair.together(*warm)
    room = {"swing": ROOM_SWING, "per_kelvin": array.modulus_per_kelvin}
    return [
        effect("plane stress", width, pair.together(*width), pair.apart(*error)),
        effect("design's modulus", other, pair.together(*other), 0.0),
        *_bonded(pair, array),
        effect("closed form", error, pair.apart(*error), pair.apart(0.001, 0.001)),
        effect("temperature", warm, warmed, warmed / ROOM_SWING, **room),
    ]


# --- of calibration, grasp and sample test ---


def _calibration(pair: BudgetPair, data: Published, array: ArrayModel) -> list[Effect]:
    """The paper's calibration: force sensor on the pad."""
    rig = array.calibration

    def stuck(mu: float) -> tuple[float, float]:
        rubbing = {"pad_height": array.pad_height, "friction": mu}
        return pair.log_change(lambda s: ladder.stiffness(s.with_(**rubbing)), ladder.stiffness)

    flat, roller, accuracy = stuck(rig.friction), stuck(SLIPPERY), rig.load_cell_accuracy
    stage = stage_error(data, array)
    stages = pair.apart(stage, stage)
    of_cell = (pair.K_r / rig.load_cell_stiffness * accuracy, pair.K_m / rig.load_cell_stiffness * accuracy)
    cell = pair.together(*of_cell)
    cell_left = cell * min(CELL_MEASURED / max(accuracy, CELL_MEASURED), 1.0)
    said = {"stiffness": rig.load_cell_stiffness, "accuracy": accuracy, "measured": CELL_MEASURED}
    resolution = rig.micrometer_resolution * 1e3
    return [
        effect("friction", flat, pair.together(*flat), pair.together(*roller), friction=rig.friction),
        effect("load cell in series", of_cell, cell, cell_left, **said),
        effect("micrometer", (stage, stage), stages, stages / 3**0.5, resolution=resolution),
    ]


def stage_error(data: Published, array: ArrayModel) -> float:
    """Relative half-width of one run's slope from the micrometer alone, over the paper's steps."""
    step = data.figure["calibration_step"] * 1e-3
    points = round(data.figure["calibration_travel"] / data.figure["calibration_step"]) + 1
    return array.calibration.micrometer_resolution / (step * ((points**2 - 1) * points / 12) ** 0.5)


def _grasp(pair: BudgetPair, data: Published, array: ArrayModel) -> list[Effect]:
    """Pads out of plane, where R is made of totals instead of slopes."""
    K, _ = _in_parallel(pair, data, array)
    z = float(springs.press(K, pair.x, np.array([array.grasping.moving_weight]))[0][0])
    height, tilt = array.tolerance.pad_height, array.tolerance.tilt
    span = float(max(np.ptp(array.pad_x), np.ptp(array.pad_y)))
    tilted = span / 2 * tan(radians(tilt))
    at = {"load": array.grasping.moving_weight, "approach": z * 1e3}
    uneven = pair.by_ratio * 2**0.5 * height / z
    by_tilt = {"tilt": tilt, "span": span, "tilted": tilted * 1e3}
    return [
        effect("pad height", NOT_ON_K, uneven, 0.0, height=height * 1e3, **at),
        effect("tilt", NOT_ON_K, pair.by_ratio * tilted / z, 0.0, **by_tilt, **at),
    ]


def _in_parallel(pair: BudgetPair, data: Published, array: ArrayModel) -> tuple[np.ndarray, int]:
    """Stiffnesses of the elements in a grasp, and the reference element's place among them."""
    truth, reference = elements_in_parallel(data, array)
    K = truth.stiffness.copy()
    K[reference] = pair.K_r
    return K, reference


def _sample(pair: BudgetPair, data: Published, array: ArrayModel) -> list[Effect]:
    """Effects of the rubber and of its test."""
    nu, thickness = array.sample.poisson, array.sample.thickness
    rig, x, cell = array.calibration, pair.x, array.calibration.load_cell_stiffness
    stiffest, accuracy = float(data.table2.object_stiffness.value.max()), rig.load_cell_accuracy
    # Tangential over normal stiffness of a pad, 2(1 - nu)/(2 - nu): Johnson, Contact Mechanics.
    lateral = x * 2 * (1 - nu) / (2 - nu)
    lever = array.pad_height + float(pair.short.hinge_thickness.item()) / 2
    shear_r, shear_m = (
        lateral * (lever / float(s.load_arm.item())) ** 2 / K
        for s, K in ((pair.short, pair.K_r), (pair.long, pair.K_m))
    )
    sheared = pair.together(shear_r, shear_m)
    relaxed = RELAXATION_PER_DECADE * abs(log10(GRASP_TIME / SAMPLE_TEST_TIME))
    thick, thin = (pair.by_ratio * abs(log(_coupled(pair, data, array, h))) for h in (inf, thickness))
    own = {"stiffest": stiffest, "becomes": stiffest * cell / (cell - stiffest), "accuracy": accuracy}
    times = {"share": RELAXATION_PER_DECADE, "test": SAMPLE_TEST_TIME, "grasp": GRASP_TIME}
    return [
        effect("own compliance", NOT_ON_K, cell / (cell - x) - 1, x / cell * accuracy, **own),
        effect("pads coupled", NOT_ON_K, thick, thin, thickness=thickness),
        effect("rubber shears", (shear_r, shear_m), sheared, sheared / 5),
        effect("relaxation", NOT_ON_K, relaxed, RELAXATION_PER_DECADE * log10(2), **times),
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
        array.sample.poisson,
    )
    return float(shares.ratio[measuring])


# --- of bridge, leads, gauge and amplifier, at the first load of a grasp ---


def _signal(pair: BudgetPair, data: Published, array: ArrayModel) -> list[Effect]:
    K, reference = _in_parallel(pair, data, array)
    rig, factor, averaged = array.grasping, array.gauge.factor, array.readout.averaged_noise
    deflection = springs.press(K, pair.x, np.array([rig.moving_weight]))[2]
    d = np.array([deflection[reference, 0], deflection[int(np.argmin(np.abs(K - pair.K_m))), 0]])
    strained = gauge_signal.foil_strain_per_deflection
    q = np.array([strained(s, array.gauge).item() for s in (pair.short, pair.long)])
    bend = np.abs(readout.bridge_nonlinearity(factor * q * d))
    per_mm = readout.volts_per_strain(factor, array.readout) * q
    noise = pair.by_ratio * 2 * float(((averaged / (per_mm * d)) ** 2).sum() ** 0.5)
    drift = abs(gauge_signal.continuous(array.readout.excitation, array.gauge, array.power).drift)
    warm = pair.by_ratio * float((drift / (factor * q * d)).max())
    zero_drift = array.tolerance.zero_drift
    leads = pair.by_ratio * float(((zero_drift / (factor * q * d)) ** 2).sum() ** 0.5)
    slope = rig.moving_weight / (rig.weight * max(rig.weights, 1))
    creep = pair.by_ratio * 2**0.5 * array.tolerance.creep
    n = rig.weights + 1  # loads; root sum of squares about their mean, N, by which a slope's noise is divided
    span = rig.weight * ((n**2 - 1) * n / 12) ** 0.5
    steady = noise * rig.moving_weight / max(span, 1e-9)
    crept = creep * log10(GRASP_TIME / SAMPLE_TEST_TIME)
    at = {"load": rig.moving_weight}
    times = {"creep": array.tolerance.creep, "test": SAMPLE_TEST_TIME, "grasp": GRASP_TIME}
    return [
        effect("bridge", NOT_ON_K, pair.by_ratio * float(abs(bend[1] - bend[0])), 0.0, **at),
        effect("noise", NOT_ON_K, noise, steady, noise=averaged * 1e3, **at),
        effect("leads", NOT_ON_K, leads, leads * min(slope, 1.0), zero_drift=zero_drift, **at),
        effect("creep", NOT_ON_K, crept, creep * log10(2), **times),
        effect("self-heating", NOT_ON_K, warm, 0.0, **at),
    ]


MATTERS = 0.05


def page(b: Budget) -> ReportSection:
    return section(
        "budget",
        findings(b),
        (_table(b),),
        (_plot(b),),
        b,
        reference=sig(b.reference),
        measuring=b.measuring,
        object_stiffness=b.object_stiffness,
    )


def findings(b: Budget) -> tuple[str, ...]:
    say = saying("budget", b=b)
    top, left = b.effects[:3], sorted(b.effects, key=lambda e: -e.remaining)[:2]
    small = next(e for e in b.effects if e.name.startswith("closed form"))
    return (
        say(
            "largest",
            top=[f"{e.name} ({percent(e.on_object)})" for e in top],
            large=sum(e.on_object > MATTERS for e in b.effects),
            count=len(b.effects),
            matters=MATTERS,
        ),
        say(
            "sensitivity",
            by=[abs(v) for v in (b.sensitivity_reference, b.sensitivity_measuring, b.sensitivity_ratio)],
        ),
        say(
            "together",
            stood=b.total(),
            left=b.total(remaining=True),
            lead=[f"{e.name} ({percent(e.remaining)})" for e in left],
        ),
        say(
            "closed form",
            small=small,
            above=sum(e.on_object > small.on_object for e in b.effects),
            others=len(b.effects) - 1,
        ),
    )


def _table(b: Budget) -> ReportTable:
    def part(v: float) -> str:
        return "–" if np.isnan(v) else percent(v) if v < 10 else f"× {sig(v)}"

    return table(
        "budget table",
        [e.name for e in b.effects],
        [part(e.short_arm) for e in b.effects],
        [part(e.long_arm) for e in b.effects],
        [part(e.on_object) for e in b.effects],
        [e.how for e in b.effects],
        [e.remedy for e in b.effects],
        [part(e.remaining) for e in b.effects],
    )


def _plot(b: Budget) -> Picture:
    shown = [e for e in b.effects if e.on_object > 0]
    with d.panels(size=(11.2, 0.31 * len(shown) + 1.3)) as (figure, ax):
        y = np.arange(len(shown))[::-1]
        least = 3e-4
        stood, left = "as the paper's rig stood, K from the drawing", [max(e.remaining, least) for e in shown]
        ax.barh(y, [e.on_object for e in shown], 0.62, color=d.BLUE, label=stood, left=0)
        ax.plot(left, y, "D", color=d.ORANGE, mec=d.BLACK, ms=7, label="with the remedy")
        ax.set(xscale="log", xlim=(least, max(e.on_object for e in shown) * 1.6))
        ax.set_xticks([1e-3, 1e-2, 0.1, 1.0], ["0.1 %", "1 %", "10 %", "100 %"])
        ax.set_yticks(y, [e.name for e in shown])
        ax.set(ylim=(-0.7, len(shown) - 0.3), xlabel="half-width on K_obj (left edge: 0.03 % and less)")
        ax.legend(loc="lower right")
        ax.grid(axis="y", visible=False)
        return drawn(figure, "budget")
