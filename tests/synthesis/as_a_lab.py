"""A lab's way from arrays as made to K_obj, simulated: readings, `tactcad calibrate`, `tactcad stiffness`.

Nothing here uses the room's own interval, knowledge or yield. The virtual shop and mechanic make the arrays;
what is said of them comes from simulated readings through the lab's own evaluation. `many` does the same for
tens of thousands of arrays: own regressions of all readings, and the room's evaluation of what they give,
which test_evaluation.py holds against the lab's array by array.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from example_readings import Noise, calibration_rows

from tactcad.contact import springs
from tactcad.design.tree import Design
from tactcad.lab.calibration import calibrate
from tactcad.lab.calibration_file import Sensitivity
from tactcad.lab.combine import Interval, combine, hull
from tactcad.lab.grasp import common_slopes
from tactcad.lab.load_cell import LoadCell
from tactcad.lab.readings import CalibrationReadings, GraspReadings
from tactcad.mechanics import gauge_signal, ladder, strength
from tactcad.mechanics.readout import volts_per_strain
from tactcad.mechanics.section import HingeSection
from tactcad.paper.grasp_figures import Truth
from tactcad.parts.array.hinge_section import design_alloy, design_gauge, design_readout, hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import longest_lead_resistance
from tactcad.scenes import make_scene
from tactcad.stacks.mechanic import Assembled
from tactcad.stacks.variables import Distribution, made
from tactcad.stacks.virtual_build import ROUNDING, sensor
from tactcad.synthesis.interval import Covariance, Evaluation
from tactcad.synthesis.target import Target

LEVEL = 0.95
LIMIT = 2.0  # standard deviations at which a half-width stands
KNOWN = 1e9  # degrees of freedom of what counts as known


@dataclass(frozen=True)
class Outcome:
    """What a lab finds with arrays as made; arrays (arrays, points) but `lacks`, (arrays,) by name.

    low, high, estimate   of K_obj over the true one
    oracle                half-width over K_obj by somebody who knows K and K_v: noise alone
    lacks                 which arrays miss what, whatever their interval is
    """

    low: np.ndarray
    high: np.ndarray
    estimate: np.ndarray
    oracle: np.ndarray
    lacks: dict[str, np.ndarray]

    @property
    def half_width(self) -> np.ndarray:
        return (self.high - self.low) / 2.0

    @property
    def inside(self) -> np.ndarray:
        return (self.low <= 1.0) & (self.high >= 1.0)

    def met(self, wanted: float) -> np.ndarray:
        """Which arrays meet the target with a half-width, relative."""
        lacks = np.logical_or.reduce([*self.lacks.values()])
        return ~lacks & (self.half_width <= wanted).all(axis=1)


def spring_and_signal(section: HingeSection, design: Design) -> tuple[np.ndarray, np.ndarray]:
    """K (N/mm) and K_v (V/mm) of hinges as made, each (arrays, elements)."""
    shape = section.shape
    flat = section.rows(np.arange(int(np.prod(shape))))
    gauge = design_gauge(design)
    volts = volts_per_strain(gauge.factor, design_readout(design))
    signal = volts * gauge_signal.foil_strain_per_deflection(flat, gauge)
    return ladder.stiffness(flat).reshape(shape), signal.reshape(shape)


def softened(
    section: HingeSection, design: Design, distribution: Distribution, rng: np.random.Generator
) -> tuple[HingeSection, np.ndarray]:
    """The hinges without one recast layer an array, and how much its clamp turns, rad/(N mm), (arrays, 1):
    each from none to its limit, at which two standard deviations stand."""
    limits, shape = (
        (design.tolerance.recast_layer, design.tolerance.clamp_compliance),
        (len(section.load_arm), 1),
    )
    if distribution == "uniform":
        layer, turn = (limit * rng.uniform(size=shape) for limit in limits)
    else:
        layer, turn = (np.minimum(abs(limit / LIMIT * rng.standard_normal(shape)), limit) for limit in limits)
    left = section.with_(
        hinge_thickness=section.hinge_thickness - 2 * layer,
        hinge_length=section.hinge_length + 2 * layer,
        fillet_radius=section.fillet_radius + layer,
        arm_height=section.arm_height - 2 * layer,
        body_height=section.body_height - 2 * layer,
        body_length=section.body_length - layer,
    )
    return left, turn


def clamped(
    found: tuple[np.ndarray, np.ndarray], section: HingeSection, turn: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """K and K_v where the clamp's turn adds deflection, and no strain."""
    K, K_v = found
    lever = section.load_arm + section.hinge_length / 2 + section.body_length
    times = 1.0 / (1.0 + K * turn * lever**2)
    return K * times, K_v * times


def used_elsewhere(section: HingeSection, contact: float, rng: np.random.Generator) -> HingeSection:
    """The same hinges, pressed off the place where they were calibrated."""
    off = contact / LIMIT * rng.standard_normal(section.shape)
    return section.with_(load_arm=section.load_arm + off)


def outcome(
    target: Target,
    design: Design,
    count: int,
    distribution: Distribution,
    seed: int,
    *,
    contact: bool = True,
    points: int = 3,
) -> Outcome:
    """`count` arrays, each calibrated once and pressed on objects over the range.

    Parameters
    ----------
    contact
        Whether pads touch elsewhere in use than in the calibration.
    points
        Objects, evenly by logarithm from the softest to the stiffest.
    """
    rng = np.random.default_rng(seed)
    parts = sensor(design, [make_scene(design, "array")])
    arrays = Assembled(parts.layout, made(parts.variables, count, distribution, rng))
    objects = np.geomspace(*target.stiffness_range, points)
    left, turn = softened(arrays.section, design, distribution, rng)
    K, K_v = clamped(spring_and_signal(left, design), left, turn)
    used = used_elsewhere(left, target.known.contact if contact else 0.0, rng)
    in_use = clamped(spring_and_signal(used, design), used, turn)
    found = np.array(
        [
            [_felt(target, design, table, k, v, x, rng) for x in objects]
            for table, k, v in zip(
                (calibrated(target, design, k, v, rng) for k, v in zip(K, K_v)), in_use[0], in_use[1]
            )
        ]
    )
    bad = {r.name: (r.margin(r.value(arrays)) < -ROUNDING).any(axis=1) for r in parts.requirements}
    lacks = {name: np.broadcast_to(which, (count,)) for name, which in bad.items()}
    lacks |= overloaded(target, design, arrays, K, objects)
    return Outcome(*np.moveaxis(found, -1, 0), lacks)


def calibrated(
    target: Target, design: Design, K: np.ndarray, K_v: np.ndarray, rng: np.random.Generator
) -> Sensitivity:
    """One array's calibration, as `tactcad stiffness` reads it."""
    rig, known = design.calibration, target.known
    assert rig is not None
    cell = LoadCell(rig.load_cell_stiffness, rig.load_cell_accuracy * rig.load_cell_stiffness)
    number = np.arange(1, len(K) + 1)
    rows = calibration_rows(
        Truth(number, K, K_v, np.zeros(len(K))),
        rng.uniform(*cell.ends),
        rig.step * np.arange(round(rig.travel / rig.step) + 1),
        known.runs,
        Noise(
            known.force_noise,
            known.displacement_noise,
            design_readout(design).averaged_noise,
            of_run=known.run_scatter,
        ),
        rng,
    )
    line = np.arange(len(rows)) + 2
    readings = CalibrationReadings(rows[:, 0].astype(int), rows[:, 1].astype(int), *rows[:, 2:].T, line)
    table = calibrate(readings, cell)
    return Sensitivity(
        number,
        np.array([e.stiffness.value for e in table]),
        np.array([e.stiffness.standard_error for e in table]),
        np.array([e.signal_per_deflection.value for e in table]),
        np.array([e.signal_per_deflection.standard_error for e in table]),
        np.array([e.correlation for e in table]),
        np.array([e.dof for e in table]),
        np.full(len(K), cell.stiffness),
        np.full(len(K), cell.half_width),
    )


def exactly(K: np.ndarray, K_v: np.ndarray) -> Sensitivity:
    """A calibration without error."""
    none = np.zeros(len(K))
    return Sensitivity(np.arange(1, len(K) + 1), K, none, K_v, none, none, none + KNOWN, none + KNOWN, none)


def reading_error(design: Design) -> float:
    """Standard deviation of an averaged reading in a grasp, V: noise, rounding, and the zero's drift."""
    r = design_readout(design)
    count = 2.0 * r.adc_range / 2.0**r.adc_bits
    lead = longest_lead_resistance(Layout(design))  # copper, half a kelvin apart
    drift = lead / design.gauge.resistance * 0.0039 * 0.5 / 4.0 * r.excitation * r.gain  # a quarter bridge
    return float(((r.noise**2 + r.adc_noise**2 + count**2 / 12.0) / r.samples + (drift / LIMIT) ** 2) ** 0.5)


def pressed(
    target: Target, design: Design, K: np.ndarray, K_v: np.ndarray, x: float, rng: np.random.Generator
) -> GraspReadings:
    """Signals of one grasp on separate springs x."""
    grip = target.grasp
    load = grip.force * np.arange(1, grip.loads + 1) / grip.loads
    signal = K_v[:, np.newaxis] * springs.press(K, x, load)[2]
    signal += reading_error(design) * rng.standard_normal(signal.shape)
    return GraspReadings(1, np.arange(1, len(K) + 1), load, np.zeros(len(load), int), signal)


def _felt(
    target: Target,
    design: Design,
    table: Sensitivity,
    K: np.ndarray,
    K_v: np.ndarray,
    x: float,
    rng: np.random.Generator,
) -> list[float]:
    """Low, high and estimate over x, and an oracle's half-width."""
    readings = pressed(target, design, K, K_v, x, rng)
    got, sure = combined(readings, table), combined(readings, exactly(K, K_v))
    return [got.low / x, got.high / x, got.estimate / x, (sure.high - sure.low) / 2.0 / x]


def combined(readings: GraspReadings, table: Sensitivity) -> Interval:
    """`evaluate`'s interval of all elements together, without its pairs, which take five times as long."""
    tables = [table]
    if table.load_cell_half_width.any():
        tables += [table.at_load_cell_limit(sign) for sign in (-1.0, 1.0)]
    best, *others = (
        combine(common_slopes(readings.element, readings.signal, at)[0], LEVEL)[0] for at in tables
    )
    return hull(best, others)


def overloaded(
    target: Target, design: Design, arrays: Assembled, K: np.ndarray, objects: np.ndarray
) -> dict[str, np.ndarray]:
    """Which arrays have an element that closes its stop, passes its rated force or the one asked for, under
    the largest force on any of the objects."""
    most = np.array([target.grasp.force])
    forces = np.array([[springs.press(k, x, most)[1][:, 0] for x in objects] for k in K]).max(axis=1)
    rated = (
        strength.yield_force_where_known(arrays.section, design_alloy(design)) / design.rating.yield_factor
    )
    return {
        "stop": (forces > arrays.closing_force).any(axis=1),
        "rated": (forces > rated).any(axis=1),
        "asked": (forces > target.grasp.element_force * (1.0 + 1e-9)).any(axis=1),
    }


def many(
    target: Target, design: Design, count: int, distribution: Distribution, seed: int, at_once: int = 2000
) -> Outcome:
    """As `outcome`, of many arrays; without an oracle."""
    rng = np.random.default_rng(seed)
    parts = sensor(design, [make_scene(design, "array")])
    objects = np.geomspace(*target.stiffness_range, 3)
    found, lacks = [], []
    for _ in range(0, count, at_once):
        arrays = Assembled(parts.layout, made(parts.variables, at_once, distribution, rng))
        left, turn = softened(arrays.section, design, distribution, rng)
        K, K_v = clamped(spring_and_signal(left, design), left, turn)
        used = used_elsewhere(left, target.known.contact, rng)
        in_use = clamped(spring_and_signal(used, design), used, turn)
        table = calibrations(target, design, K, K_v, rng)
        found.append([_many_felt(target, design, table, *in_use, x, rng) for x in objects])
        bad = {r.name: (r.margin(r.value(arrays)) < -ROUNDING).any(axis=1) for r in parts.requirements}
        bad |= overloaded(target, design, arrays, K, objects)
        lacks.append({name: np.broadcast_to(which, (at_once,)) for name, which in bad.items()})
    low, high, estimate = np.concatenate(np.moveaxis(np.array(found), 1, -1), axis=1)
    return Outcome(
        low,
        high,
        estimate,
        np.full_like(low, np.nan),
        {n: np.concatenate([b[n] for b in lacks]) for n in lacks[0]},
    )


Table = tuple[np.ndarray, np.ndarray, Covariance]


def calibrations(
    target: Target, design: Design, K: np.ndarray, K_v: np.ndarray, rng: np.random.Generator
) -> Table:
    """K, K_v and their relative covariance from every array's calibration, each run a line of its own."""
    rig, known = design.calibration, target.known
    assert rig is not None
    steps = rig.step * np.arange(1, round(rig.travel / rig.step) + 1)  # the first reading is left out
    true = rig.load_cell_stiffness * (1.0 + rig.load_cell_accuracy * rng.uniform(-1.0, 1.0, (len(K), 1)))
    share = true / (true + K)
    shape = (*K.shape, known.runs, len(steps))

    def normal(sigma: float, shape: tuple[int, ...] = shape) -> np.ndarray:
        return sigma * rng.standard_normal(shape)

    def run() -> np.ndarray:
        return 1.0 + normal(known.run_scatter, (*shape[:3], 1))

    deflection = share[..., None, None] * (steps + normal(known.displacement_noise))
    force = K[..., None, None] * deflection * run() + normal(known.force_noise)
    signal = K_v[..., None, None] * deflection * run() + normal(design_readout(design).averaged_noise)
    away = steps - steps.mean()
    k_run, v_run = (y @ away / (away @ away) for y in (force, signal))
    k, v = k_run.mean(axis=-1), v_run.mean(axis=-1)
    off = np.stack([k_run - k[..., None], v_run - v[..., None]])
    kk, vv, kv = (
        (off[a] * off[b]).sum(axis=-1) / known.runs / (known.runs - 1) for a, b in ((0, 0), (1, 1), (0, 1))
    )
    left = 1.0 - k / rig.load_cell_stiffness
    a, b, c = 1.0 / left**2, v / rig.load_cell_stiffness / left**2, 1.0 / left
    K_hat, V_hat = k / left, v / left
    return (
        K_hat,
        V_hat,
        Covariance.of(
            a * a * kk / K_hat**2,
            (b * b * kk + 2 * b * c * kv + c * c * vv) / V_hat**2,
            (a * b * kk + a * c * kv) / (K_hat * V_hat),
        ),
    )


def _many_felt(
    target: Target,
    design: Design,
    table: Table,
    K: np.ndarray,
    K_v: np.ndarray,
    x: float,
    rng: np.random.Generator,
) -> list[np.ndarray]:
    grip, rig = target.grasp, design.calibration
    assert rig is not None
    load = grip.force * np.arange(1, grip.loads + 1) / grip.loads
    rate = K * x / (K + x)
    volts = K_v[..., None] * (rate / K / rate.sum(axis=1, keepdims=True))[..., None] * load
    volts += reading_error(design) * rng.standard_normal(volts.shape)
    volts -= volts.mean(axis=2, keepdims=True)
    _, size, vt = np.linalg.svd(volts, full_matrices=False)
    dof = (K.shape[1] - 1) * (grip.loads - 2)
    noise = np.sqrt((size[:, 1:] ** 2).sum(axis=1, keepdims=True) / dof)
    g = (volts @ vt[:, 0, :, None])[..., 0]
    g *= np.sign(g.sum(axis=1, keepdims=True))
    K_hat, V_hat, errors = table
    f = g * K_hat / V_hat
    read = Evaluation(
        g / V_hat, f, (noise / V_hat, noise * K_hat / V_hat), errors, (target.known.runs - 1.0, dof)
    )
    got = read.evaluated(x)
    soft = rig.load_cell_accuracy / (1.0 - rig.load_cell_accuracy) / rig.load_cell_stiffness
    stiff = rig.load_cell_accuracy / (1.0 + rig.load_cell_accuracy) / rig.load_cell_stiffness
    return [1.0 / (1.0 / got.low + stiff) / x, 1.0 / (1.0 / got.high - soft) / x, got.estimate / x]


def believed(
    K: np.ndarray, K_v: np.ndarray, K_se: np.ndarray, V_se: np.ndarray, correlation: np.ndarray, dof: float
) -> Sensitivity:
    """Beliefs with stated errors, behind no load cell."""
    none, number = np.zeros(len(K)), np.arange(1, len(K) + 1)
    return Sensitivity(number, K, K_se, K_v, V_se, correlation, none + dof, none + KNOWN, none)


def uncalibrated(
    target: Target,
    design: Design,
    count: int,
    distribution: Distribution,
    seed: int,
    errors: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> np.ndarray:
    """K_obj over the true one, (arrays, points), of arrays that are believed to be as drawn, or as drawn with
    the hinges' thickness measured; each gauge has a sensitivity of its own. `errors` (relative standard
    errors of K and K_v, correlation) make the weights only."""
    rng = np.random.default_rng(seed)
    parts = sensor(design, [make_scene(design, "array")])
    arrays = Assembled(parts.layout, made(parts.variables, count, distribution, rng))
    said = drawn = hinge_section(parts.layout, parts.layout.elements)
    left, turn = softened(arrays.section, design, distribution, rng)
    used = used_elsewhere(left, target.known.contact, rng)
    K, K_v = clamped(spring_and_signal(used, design), used, turn)
    K_v = K_v * (1.0 + target.known.gauge_factor / LIMIT * rng.standard_normal(K.shape))
    out = []
    for i in range(count):
        if target.known.how == "inspected":
            t = arrays.section.hinge_thickness[i]
            wrong = target.known.thickness / LIMIT * rng.standard_normal(t.shape)
            said = drawn.with_(hinge_thickness=t + wrong)
        k, v = spring_and_signal(said, design)
        table = believed(k, v, errors[0] * k, errors[1] * v, errors[2], KNOWN)
        objects = np.geomspace(*target.stiffness_range, 3)
        out.append(
            [combined(pressed(target, design, K[i], K_v[i], x, rng), table).estimate / x for x in objects]
        )
    return np.array(out)
