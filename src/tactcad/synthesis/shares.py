"""Causes of the spread of K_obj: Sobol's first and total shares of its variance, by cause.

Arrays are made, known and read once each; y = ln of the estimate over the true K_obj. First and total
effects are Jansen's estimators (Saltelli et al. 2010, Comput. Phys. Commun. 181, 259, table 2 c and f) with
all numbers of one cause drawn anew together; their standard errors are the bootstrap's.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from tactcad.lab.pads import INCOMPRESSIBLE, places
from tactcad.mechanics.lumped import shares_between
from tactcad.mechanics.section import Array
from tactcad.stacks.mechanic import Assembled
from tactcad.stacks.variables import IN_PLAY, MODULUS, SHEET, SIGMAS, made

from .interval import coupled_estimate, information, motion, weights
from .knowledge import as_made
from .made_arrays import MadeSensor

SEED = 20261124
COUNT = 2048
RESAMPLED = 100  # bootstrap samples for the shares' standard errors
SLIGHT = 0.05  # of a half-space's coupling, the most that is drawn; chosen: pads well apart on thin tissue
LEAST = 5e-4  # shares below are not listed
READINGS = "noise of readings"
CONTACT = "contact's place along the arm"
CALIBRATION = "calibration's noise and scatter"
GAUGES = "gauges' own sensitivity"
INSPECTION = "thickness as measured"
CELL = "load cell's limits"
COUPLING = f"coupling of the pads, to {100 * SLIGHT:g} % of a half-space's"
LAYER = "recast layer"
CLAMP = "turn of the clamp"
PADS = "pad heights"


@dataclass(frozen=True)
class Share:
    """Shares of the variance of ln K_obj that a cause has alone, and with all it interacts with; standard
    errors of the sampling."""

    cause: str
    first: float
    total: float
    first_error: float = 0.0
    total_error: float = 0.0


def half_space_shares(sensor: MadeSensor) -> Array:
    """Displacement of each pad by the force on another over that by its own on an elastic half-space."""
    d, (x, y) = sensor.design, places(sensor.layout)
    return shares_between(x, y, d.element.pad_length, d.sheet.thickness, np.inf, INCOMPRESSIBLE)


def variance_shares(sensor: MadeSensor, count: int = COUNT, seed: int = SEED) -> list[Share]:
    """Every cause that matters, largest first, at the middle of the object's range."""
    rng = np.random.default_rng(seed)
    others = sensor.parts.variables
    some = {k: v for k, v in others.items() if v.element or k in (IN_PLAY, SHEET, MODULUS)}
    variables = {k: replace(v, wire=0) for k, v in some.items()}  # shares are of causes that are independent
    n = len(sensor.drawn.stiffness)

    def draw() -> dict[str, Array]:
        parts = made(variables, count, "normal", rng)
        causes = {
            name: rng.standard_normal((count, n, 2)) for name in (READINGS, CONTACT, *_of_belief(sensor))
        }
        alike = {name: rng.uniform(-1.0, 1.0, count) for name in (CELL, COUPLING)}
        soft = dict(zip((LAYER, CLAMP), sensor.softening(count, "normal", rng)))
        return {**parts, **causes, **alike, **soft}

    middle = made(others, 1, "normal", rng, only=())
    estimate = _estimator(sensor, {k: np.broadcast_to(v, (count, v.shape[1])) for k, v in middle.items()})
    a, b = draw(), draw()
    y_a, y_b = estimate(a), estimate(b)
    again = rng.integers(count, size=(RESAMPLED, count))
    every = np.vstack([np.arange(count), again])  # the sample itself, then its bootstrap
    variance = np.concatenate([y_a[every], y_b[every]], axis=1).var(axis=1)
    out = [Share(PADS, 0.0, 0.0)]  # slopes do not depend on them once all pads touch, as every array must
    for name in a:
        y_c = estimate({**a, name: b[name]})
        # formula c, unlike b of table 2, is stable if a single cause has nearly all of the variance
        total = ((y_a - y_c) ** 2 / 2.0)[every].mean(axis=1) / variance
        # a first share never exceeds the total one: any excess is sampling error
        first = np.clip(1.0 - ((y_b - y_c) ** 2 / 2.0)[every].mean(axis=1) / variance, 0.0, total)
        if total[0] > LEAST:
            errors = float(first[1:].std()), float(total[1:].std())
            out.append(Share(name, float(first[0]), float(total[0]), *errors))
        else:
            out.append(Share(name, 0.0, 0.0))
    return sorted(out, key=lambda s: -s.total)


def _estimator(sensor: MadeSensor, rest: dict[str, Array]) -> Callable[[dict[str, Array]], Array]:
    """ln of K_obj as estimated over the true one, for arrays with these deviations and errors."""
    x = float(np.median(sensor.points))
    grip, noise, alone = sensor.target.grasp, sensor.noise, np.eye(len(sensor.layout.elements))
    coupled = half_space_shares(sensor) * (1.0 - alone)
    calibrated, inspected = sensor.calibrated, sensor.target.known.how == "inspected"
    ones = np.ones(1)

    def estimate(causes: dict[str, Array]) -> Array:
        parts = {k: v for k, v in causes.items() if k in rest}
        section = Assembled(sensor.layout, {**rest, **parts}).section
        true = as_made(section, sensor.design, causes[LAYER], causes[CLAMP])
        known = sensor.known(true)
        m = motion(true, ones, np.asarray(x), grip.force, grip.loads)
        by_noise, _, weighed = weights(m, true, known, ones, np.asarray(x), noise)
        S, pull = information(m, ones, weighed)
        e_k, e_v = (d * causes[CONTACT][..., 0] for d in known.place)
        if calibrated:
            k, v = known.calibration_errors(*np.moveaxis(causes[CALIBRATION], -1, 0))
        else:
            drawn = sensor.drawn
            if inspected:
                drawn = sensor.inspected(true, causes[INSPECTION][..., 0])
            gauges = sensor.target.known.gauge_factor / SIGMAS * causes[GAUGES][..., 0]
            k, v = np.log(drawn.stiffness / true.stiffness), np.log(drawn.signal / true.signal) + gauges
        e_k, e_v = e_k + k, e_v + v
        by_reading = causes[READINGS][..., 0] * np.sqrt(by_noise)
        shift = -(pull * (m.f * e_k - m.c * e_v + by_reading)).sum(axis=1) / S
        share = (SLIGHT * (1.0 + causes[COUPLING]) / 2.0)[:, np.newaxis, np.newaxis]
        felt = coupled_estimate(true, known, x, noise, grip.force, grip.loads, share * coupled + alone)
        at = np.maximum(felt + shift, 1e-3 * x)
        return -np.log(x / at + x * known.load_cell * causes[CELL])

    return estimate


def _of_belief(sensor: MadeSensor) -> tuple[str, ...]:
    """Causes by the knowledge of the elements."""
    how = sensor.target.known.how
    return {"calibrated": (CALIBRATION,), "inspected": (GAUGES, INSPECTION), "drawn": (GAUGES,)}[how]
