"""Arrays of a design as they are made and used: how many meet the target, and what spreads the answer.

Arrays are built virtually (room `stacks`), with its correlations: one sheet, one machine's offset; each
has one recast layer and one clamp that turns, anywhere up to their limits. Each is calibrated once, with as
many degrees of freedom as its runs leave, and pressed on objects over the range. An array meets the target if
it can be assembled, all pads touch from the first load on, no stop closes and no hinge is overloaded under
the largest force, and its interval is within the wanted half-width for every object.

Causes of the spread have Sobol's first and total shares of the variance. Arrays are made, known and read
once each; y = ln of the estimate over the true K_obj. First and total effects are Jansen's estimators
(Saltelli et al. 2010, Comput. Phys. Commun. 181, 259, table 2 c and f) with all numbers of one cause drawn
anew together; their standard errors are the bootstrap's.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from tactcad.design.tree import Design
from tactcad.lab.pads import INCOMPRESSIBLE, places
from tactcad.mechanics import strength
from tactcad.mechanics.lumped import shares_between
from tactcad.mechanics.section import Array
from tactcad.mechanics.strength import tip_compliance
from tactcad.parts.array.hinge_section import arms, design_alloy, hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.stop_gap import stop_gaps
from tactcad.scenes import make_scene
from tactcad.stacks.mechanic import Assembled
from tactcad.stacks.variables import IN_PLAY, MODULUS, SHEET, SIGMAS, Distribution, made, within_limits
from tactcad.stacks.virtual_build import DECIDING, Sensor, of_share, sensor

from .candidates import POINTS
from .interval import (
    Bounds,
    Covariance,
    Evaluated,
    Evaluation,
    bounds,
    coupled_estimate,
    information,
    motion,
    weights,
)
from .knowledge import Elements, Knowledge, as_made, elements, knowledge, reading_noise
from .on_layer import LayerGrasps, Poses, level, of_elements, poses
from .target import Target

SEED = 20261123
AT_ONCE, AT_ONCE_ON_BODY = 2000, 250  # arrays in memory at a time


@dataclass(frozen=True)
class Yield:
    """Share of arrays that meet the target.

    count, share   arrays made of each distribution, and the lower share
    interval       of the share, Clopper and Pearson's, 95 %
    distribution   the one that gives it
    why            by failure, the number of arrays of that distribution with it
    half_widths    of every array's interval, largest over the range, relative; inf if it lacks anything
                   else
    """

    count: int
    share: float
    interval: tuple[float, float]
    distribution: Distribution
    why: dict[str, int]
    half_widths: Array

    def kept_by(self, share: float) -> float:
        """The least half-width that a share of the arrays keep."""
        return float(np.quantile(self.half_widths, share, method="higher"))


@dataclass(frozen=True)
class MadeSensor:
    """A design of a target, ready to be made many times."""

    target: Target
    design: Design

    @cached_property
    def layout(self) -> Layout:
        return Layout(self.design)

    @cached_property
    def parts(self) -> Sensor:
        return sensor(self.design, [make_scene(self.design, "array")])

    @cached_property
    def drawn(self) -> Elements:
        """Every element, by number."""
        return elements(hinge_section(self.layout, self.layout.elements), self.design)

    @property
    def steps(self) -> Array:
        rig = self.design.calibration
        return np.array([rig.travel / rig.step if rig else 0.0])

    @cached_property
    def noise(self) -> float:
        return reading_noise(self.design)

    @cached_property
    def points(self) -> Array:
        """K_obj at which arrays are tried, N/mm."""
        return np.geomspace(*self.target.range_of(self.design), POINTS)

    def built(self, count: int, wanted: float) -> Yield:
        """`count` arrays of each deciding distribution, and how many keep a half-width (relative)."""
        return min((self.built_of(name, count, wanted) for name in DECIDING), key=lambda y: y.share)

    def kept_by(self, share: float, count: int) -> float:
        """The least half-width (relative) that a share of the arrays keep, whichever their distribution; inf
        if too many lack anything else."""
        return max(self.built_of(name, count, np.inf).kept_by(share) for name in DECIDING)

    def built_of(self, name: Distribution, count: int, wanted: float) -> Yield:
        """`built` of one distribution."""
        lacking, widths = self._tried(name, count)
        met = int((widths <= wanted).sum())
        lacking = lacking | {"interval too wide": count - met}
        why = {what: n for what, n in sorted(lacking.items(), key=lambda item: -item[1]) if n}
        return Yield(count, met / count, of_share(met, count), name, why, widths)

    def _tried(self, name: Distribution, count: int) -> tuple[dict[str, int], Array]:
        """Number of arrays by failure, and their half-widths: computed once for any wanted half-width."""
        known = self.__dict__.setdefault("tried", {})
        if (name, count) not in known:
            rng, why, widths = np.random.default_rng(SEED), dict[str, int](), []
            most = AT_ONCE_ON_BODY if self.target.on_layer else AT_ONCE
            for start in range(0, count, most):
                lacks, width = self._some(name, min(most, count - start), rng)
                for what, bad in lacks.items():
                    why[what] = why.get(what, 0) + int(bad.sum())
                widths.append(width)
            known[name, count] = why, np.concatenate(widths)
        return known[name, count]

    def _some(
        self, distribution: Distribution, count: int, rng: np.random.Generator
    ) -> tuple[dict[str, Array], Array]:
        arrays = Assembled(self.layout, made(self.parts.variables, count, distribution, rng))
        lacks: dict[str, Any] = {
            f"assembly: {name}": bad for name, bad in self.parts.missed(arrays, count).items() if bad.any()
        }
        e = as_made(arrays.section, self.design, *self.softening(count, distribution, rng))
        grip, alloy = self.target.grasp, design_alloy(self.design)
        behind = arrays.pads.max(axis=1, keepdims=True) - arrays.pads
        if self.target.on_layer:
            forces, widths = self._on_body(e, behind, rng)
        else:
            forces = self.largest(e)
            rate = e.stiffness * self.points[-1] / (e.stiffness + self.points[-1])
            last = (rate * behind).sum(axis=1)
            lacks["pads not all touching at the first load"] = last > grip.force / grip.loads
            widths = self._half_widths(e, rng)
        closing = arrays.gaps / tip_compliance(e.section, e.stiffness, arrays.arm)
        lacks["stop closes under the largest force"] = (forces > closing).any(axis=1)
        yields = strength.yield_force_where_known(e.section, alloy) / self.design.rating.yield_factor
        lacks["hinge beyond its rated force"] = (forces > yields).any(axis=1)
        lacks["force on one element"] = (forces > grip.element_force * (1.0 + 1e-9)).any(axis=1)
        return lacks, np.where(np.logical_or.reduce(list(lacks.values())), np.inf, widths)

    def _on_body(self, e: Elements, behind: Array, rng: np.random.Generator) -> tuple[Array, Array]:
        """Largest force on each element of arrays as made, N, and their half-widths, in the poses that are
        worst as drawn; a calibration's own estimate of its scatter makes half-widths of arrays differ."""
        at = poses(self.target, self.design)
        got = self.on_body.expected(at)
        some = {int(self.on_body.half_width(at, got).argmax()), *map(int, got.force.argmax(axis=0))}
        count = len(behind)
        forces, widths = np.zeros(behind.shape), np.zeros(count)
        for pose in some:
            alike = Poses(np.full(count, at.modulus[pose]), np.tile(at.slope[pose], (count, 1)))
            there = self.on_body.expected(alike, stiffness=e.stiffness, height=behind)
            forces = np.maximum(forces, there.force)
            widths = np.maximum(widths, self.on_body.half_width(alike, there))
        dof = behind.shape[1] * (self.target.known.runs - 1.0)
        own = np.sqrt(rng.chisquare(dof, count) / dof) if self.calibrated else np.ones(count)
        return forces, widths * own

    def softening(
        self, count: int, distribution: Distribution, rng: np.random.Generator
    ) -> tuple[Array, Array]:
        """Recast layer, mm, and turn of the clamp, rad/(N mm), of arrays, (count, 1): equal for an array's
        elements, and never negative."""
        t = self.design.tolerance
        share = np.abs(within_limits(rng.standard_normal((2, count, 1)), distribution))
        return t.recast_layer * share[0], t.clamp_compliance * share[1]

    @cached_property
    def on_body(self) -> LayerGrasps:
        """The array as drawn on the target's body."""
        x, y = places(self.layout)
        e = self.drawn
        arm = e.section.load_arm
        known = of_elements(self.known(e), lambda of: np.broadcast_to(of, e.stiffness.shape))
        return LayerGrasps(self.target, self.design, x, y, arm, e.stiffness, e.signal, known, self.noise)

    def worst(self) -> tuple[float, Array]:
        """Largest half-width over the object, inclined or not, and the largest force on each element, N."""
        if not self.target.on_layer:
            width = self.interval(self.points).half_width(self.points).max()
            return float(width), self.largest(self.drawn)
        at = poses(self.target, self.design, angles=2)
        got = self.on_body.expected(at, min(self.target.grasp.loads, 10))
        return float(self.on_body.half_width(at, got).max()), got.force.max(axis=0)

    def largest(self, e: Elements) -> Array:
        """Largest force on each element over the object's range, on separate springs, N."""
        grip, x = self.target.grasp, self.points.reshape(-1, *(1,) * e.stiffness.ndim)
        return motion(e, np.ones(1), x, grip.force, grip.loads).largest.max(axis=0)

    def interval(self, x: Array, members: list[int] | None = None) -> Bounds:
        """The interval at K_obj `x` (N/mm) as drawn, of all elements or of those of these indices; on a body
        that is level, of all."""
        if self.target.on_layer:
            there = level(x / self.target.unit(self.design))
            half = self.on_body.half_width(there, self.on_body.expected(there)) * x
            return Bounds(x - half, x + half, half)
        ones, grip = np.ones(len(self.drawn.stiffness)), self.target.grasp
        used = None if members is None else np.isin(np.arange(len(ones)), members) * ones
        known, at = self.known(self.drawn), x[:, np.newaxis]
        return bounds(self.drawn, ones, known, at, self.noise, grip.force, grip.loads, used)

    @property
    def cannot_bear(self) -> str:
        """Why the array as drawn does not bear the target's forces; "" if it does."""
        e, (_, largest) = self.drawn, self.worst()
        tip = tip_compliance(e.section, e.stiffness, arms(self.layout))
        if (largest * tip > stop_gaps(self.layout)).any():
            return "a stop closes under the largest force"
        yields = strength.yield_force_where_known(e.section, design_alloy(self.design))
        beyond = (largest > yields / self.design.rating.yield_factor).any()
        return "a hinge is beyond its rated force" if beyond else ""

    @property
    def calibrated(self) -> bool:
        return self.target.known.how == "calibrated"

    def known(self, e: Elements) -> Knowledge:
        """Knowledge of elements as made; if uncalibrated, the drawing's values, the same for all."""
        if self.calibrated:
            return knowledge(self.target, self.design, e, self.steps)
        return knowledge(self.target, self.design, self.drawn)

    def _half_widths(self, e: Elements, rng: np.random.Generator) -> Array:
        """Half-width of each array's interval from its own readings, largest over the range, relative."""
        read = self.read(e, rng)
        return np.max([(at.high - at.low) / 2.0 / x for x, at in zip(self.points, read)], axis=0)

    def read(self, e: Elements, rng: np.random.Generator) -> list[Evaluated]:
        """Results of arrays as made at each of `points`: calibrated once, then read on every object."""
        known, grip, ones = self.known(e), self.target.grasp, np.ones(1)
        used, (K, signal, errors) = self._used(e, known, rng), self._believed(e, known, rng)
        n = e.stiffness.shape[1]
        signal_dof = (n - 1.0) * (grip.loads - 2.0)
        out = []
        for x in self.points:
            m = motion(used, ones, x, grip.force, grip.loads)
            noise = self.noise * np.sqrt(rng.chisquare(signal_dof, (len(m.s), 1)) / signal_dof)
            volts = used.signal * m.s + self.noise * rng.standard_normal(m.s.shape)
            of_s, of_f = 1.0 / signal, K / signal
            shared = tuple((k - v, -v) for k, v in known.common.values())
            readings = Evaluation(
                volts * of_s,
                volts * of_f,
                (noise * of_s, noise * of_f),
                errors,
                (known.dof, signal_dof),
                shared,
            )
            out.append(readings.evaluated(x).with_load_cell(known.load_cell))
        return out

    def _used(self, e: Elements, known: Knowledge, rng: np.random.Generator) -> Elements:
        """Elements as they are in use: touched elsewhere, and uncalibrated with gauges of their own."""
        z = rng.standard_normal(e.stiffness.shape)
        gauge = 0.0 if self.calibrated else self.target.known.gauge_factor / SIGMAS
        own = 1.0 + gauge * rng.standard_normal(e.stiffness.shape)
        stiffness = e.stiffness * np.exp(known.place[0] * z)
        return replace(e, stiffness=stiffness, signal=e.signal * np.exp(known.place[1] * z) * own)

    def inspected(self, e: Elements, z: Array) -> Elements:
        """Elements as drawn, but with the measured thickness; `z` standard normal numbers."""
        t = e.section.hinge_thickness + self.target.known.thickness / SIGMAS * z
        return elements(self.drawn.section.with_(hinge_thickness=t), self.design)

    def _believed(
        self, e: Elements, known: Knowledge, rng: np.random.Generator
    ) -> tuple[Array, Array, Covariance]:
        """K and K_v as believed, and the covariance of the errors as stated.

        If calibrated, every run has an error, which the lab knows by the runs' scatter only. Otherwise
        elements are as drawn, or as drawn with the measured thickness, and the stated variances are the true
        ones.
        """
        if not self.calibrated:
            drawn = self.drawn
            if self.target.known.how == "inspected":
                drawn = self.inspected(e, rng.standard_normal(e.section.hinge_thickness.shape))
            return drawn.stiffness, drawn.signal, Covariance.of(known.of_k, known.of_v, known.cross)
        runs = self.target.known.runs
        z = np.sqrt(runs) * rng.standard_normal((2, runs, *e.stiffness.shape))
        err = np.stack(known.calibration_errors(*z))
        mean = err.mean(axis=1)
        off = (err - mean[:, np.newaxis]) / np.sqrt(runs * (runs - 1.0))
        stated = Covariance.of(
            (off[0] ** 2).sum(axis=0), (off[1] ** 2).sum(axis=0), (off[0] * off[1]).sum(axis=0)
        )
        return e.stiffness * (1.0 + mean[0]), e.signal * (1.0 + mean[1]), stated


SHARES_SEED = 20261124
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


def variance_shares(sensor: MadeSensor, count: int = COUNT, seed: int = SHARES_SEED) -> list[Share]:
    """Every cause that matters, largest first, at the middle of the object's range."""
    rng = np.random.default_rng(seed)
    others = sensor.parts.variables
    some = {k: v for k, v in others.items() if v.element or k in (IN_PLAY, SHEET, MODULUS)}
    variables = {k: replace(v, wire=0) for k, v in some.items()}  # shares are of causes that are independent
    n = len(sensor.drawn.stiffness)
    by_belief = {"calibrated": (CALIBRATION,), "inspected": (GAUGES, INSPECTION), "drawn": (GAUGES,)}
    apiece = (READINGS, CONTACT, *by_belief[sensor.target.known.how])

    def draw() -> dict[str, Array]:
        parts = made(variables, count, "normal", rng)
        causes = {name: rng.standard_normal((count, n, 2)) for name in apiece}
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
