"""Arrays of a design as they are made and used: how many meet the target, and what spreads the answer.

Arrays are built virtually (room `assembly`), with its correlations: one sheet, one machine's offset. Each is
calibrated once, with as many degrees of freedom as its runs leave, and pressed on objects over the range. It
meets the target where it goes together, all pads touch from the first load on, no stop closes and no hinge
is overloaded under the largest force, and the interval that its own readings give is no wider than wanted at
every object.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import betaincinv, fdtri, stdtrit

from tactcad.assembly.mechanic import Assembled
from tactcad.assembly.virtual_build import DECIDING, Sensor, sensor
from tactcad.assembly.virtual_shop import Distribution, made
from tactcad.design.tree import Design
from tactcad.lab.combine import DISAGREE
from tactcad.mechanics import strength
from tactcad.mechanics.section import Array
from tactcad.parts.hinge_section import design_alloy, hinge_section
from tactcad.parts.layout import Layout
from tactcad.scenes import make_scene

from .candidates import POINTS
from .interval import LEVEL, information, motion, weights
from .knowledge import Elements, Knowledge, elements, knowledge, reading_noise
from .target import Target

SEED = 20261123
AT_ONCE = 2000  # arrays in memory at a time


@dataclass(frozen=True)
class Yield:
    """Share of arrays that meet the target.

    count, share   arrays made of each distribution, and the lower share
    interval       of the share, Clopper and Pearson's, 95 %
    distribution   the one that gives it
    why            by what an array lacks, how many of that distribution lack it
    half_widths    of every array's interval, largest over the range, relative
    """

    count: int
    share: float
    interval: tuple[float, float]
    distribution: Distribution
    why: dict[str, int]
    half_widths: Array


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
        return np.geomspace(*self.target.stiffness_range, POINTS)

    def built(self, count: int, wanted: float, seed: int = SEED) -> Yield:
        """`count` arrays of each deciding distribution, held against a half-width (relative)."""
        best: Yield | None = None
        for name in DECIDING:
            rng, why, widths = np.random.default_rng(seed), dict[str, int](), []
            met = 0
            for start in range(0, count, AT_ONCE):
                some = min(AT_ONCE, count - start)
                lacks, width = self._some(name, some, wanted, rng)
                for what, bad in lacks.items():
                    why[what] = why.get(what, 0) + int(bad.sum())
                met += int((~np.logical_or.reduce(list(lacks.values()))).sum())
                widths.append(width)
            why = {what: n for what, n in sorted(why.items(), key=lambda item: -item[1]) if n}
            y = Yield(count, met / count, of_share(met, count), name, why, np.concatenate(widths))
            best = y if best is None or y.share < best.share else best
        assert best is not None
        return best

    def _some(
        self, distribution: Distribution, count: int, wanted: float, rng: np.random.Generator
    ) -> tuple[dict[str, Array], Array]:
        arrays = Assembled(self.layout, made(self.parts.variables, count, distribution, rng))
        lacks: dict[str, np.ndarray] = {
            f"assembly: {name}": bad for name, bad in self.parts.missed(arrays, count).items() if bad.any()
        }
        e = elements(arrays.section, self.design)
        grip, alloy = self.target.grasp, design_alloy(self.design)
        forces = np.max(
            [motion(e, np.ones(1), x, grip.force, grip.loads).largest for x in self.points], axis=0
        )
        rate = e.stiffness * self.points[-1] / (e.stiffness + self.points[-1])
        last = (rate * (arrays.pads.max(axis=1, keepdims=True) - arrays.pads)).sum(axis=1)
        lacks["pads not all touching at the first load"] = last > grip.force / grip.loads
        lacks["stop closes under the largest force"] = (forces > arrays.closing_force).any(axis=1)
        yields = strength.yield_force_where_known(e.section, alloy) / self.design.rating.yield_factor
        lacks["hinge beyond its rated force"] = (forces > yields).any(axis=1)
        lacks["force on one element"] = (forces > grip.element_force * (1.0 + 1e-9)).any(axis=1)
        width = self._half_widths(e, rng)
        lacks["interval too wide"] = ~(width <= wanted)
        return lacks, width

    def known(self, e: Elements) -> Knowledge:
        """What is known of elements as made; uncalibrated it is what the drawing says, the same for all."""
        if self.target.known.how == "calibrated":
            return knowledge(self.target, self.design, e, self.steps)
        return knowledge(self.target, self.design, self.drawn)

    def _half_widths(self, e: Elements, rng: np.random.Generator) -> Array:
        """Of each array's interval from its own readings, largest over the range, relative.

        Variances are estimated by those readings: each element's is chi-squared about the true one. Where
        elements disagree by chance beyond DISAGREE, the interval is widened as the lab's is.
        """
        known, grip, count = self.known(e), self.target.grasp, len(e.stiffness)
        n = e.stiffness.shape[1]
        ones, worst = np.ones(1), np.zeros(count)
        signal_dof = (n - 1.0) * (grip.loads - 2.0)
        of_belief = rng.chisquare(min(known.dof, 1e6), (count, n)) / min(known.dof, 1e6)
        of_noise = rng.chisquare(signal_dof, (count, 1)) / signal_dof
        chance = rng.random(count)
        for x in self.points:
            m = motion(e, ones, x, grip.force, grip.loads)
            by_noise, by_belief = weights(m, e, known, x, self.noise)
            S, pull = information(m, ones, by_noise + by_belief)
            signal = (pull**2 * by_noise * of_noise).sum(axis=1)
            belief = pull**2 * by_belief * of_belief
            variance = (signal + belief.sum(axis=1)) / S**2
            dof = (signal + belief.sum(axis=1)) ** 2 / (
                signal**2 / signal_dof + (belief**2).sum(axis=1) / known.dof
            )
            t = stdtrit(dof, 0.5 + LEVEL / 2.0)
            if n > 2 and known.dof < 1e6:
                widened = chance < DISAGREE
                factor = np.sqrt(np.maximum(fdtri(n - 2.0, dof, 1.0 - chance), 1.0))
                t = np.where(widened, factor * stdtrit(n - 2.0, 0.5 + LEVEL / 2.0), t)
            shared = sum(
                ((pull * (m.f * k - m.c * v)).sum(axis=1) / S) ** 2 for k, v in known.common.values()
            )
            half = t * np.sqrt(variance + shared) / x
            near, far = 1.0 - half, 1.0 + half
            low = 1.0 / (1.0 / near + x * known.load_cell)
            high = 1.0 / np.maximum(1.0 / far - x * known.load_cell, 1e-9)
            worst = np.maximum(worst, (high - low) / 2.0)
        return worst


def of_share(successes: int, count: int, level: float = 0.95) -> tuple[float, float]:
    """Clopper and Pearson's interval of a share (Biometrika 26, 1934): never covers less than its level."""
    tail = (1.0 - level) / 2.0
    low = float(betaincinv(successes, count - successes + 1.0, tail)) if successes else 0.0
    high = float(betaincinv(successes + 1.0, count - successes, 1.0 - tail)) if successes < count else 1.0
    return low, high
