"""Arrays built virtually, by the thousand: how many go together, what fails, and what they are like."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import isfinite
from typing import Any

import numpy as np
from scipy.special import betaincinv

from tactcad.design.family import Family, family_of
from tactcad.design.load import paths
from tactcad.design.tree import CommonTables
from tactcad.mechanics.section import Array
from tactcad.parts.array.element import ARM_LENGTH, PAD_LENGTH
from tactcad.parts.array.layout import Layout
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.requirement import DimensionLimits, Requirement
from tactcad.scenes.scene import Scene

from .mechanic import Assembled
from .stack import LEAST_YIELD, ROUNDING, SEED, StackLine, stack
from .variables import Distribution, made, of_element

# The worse of these decides. Corners are also reported.
DECIDING: tuple[Distribution, ...] = ("normal", "uniform")
LEVEL = 0.95
NEAR = 0.1  # of K, for which arrays are counted
AT_ONCE = 20_000  # elements in memory at a time


@dataclass(frozen=True)
class ElementBuilt:
    """One element over all arrays built, normal parts: N/mm, um, mm, N; each a mean and a standard deviation,
    the last the least."""

    number: int
    stiffness: tuple[float, float]
    pad_height_um: tuple[float, float]
    load_arm: tuple[float, float]
    stop_gap: tuple[float, float]
    stop_closes_at_least: float

    def known(self) -> dict[str, Any]:
        """Figures by field, with None for unknown ones: arrays built outside the closed form's range have no
        stiffness."""

        def figures(value: Any) -> Any:
            if isinstance(value, tuple):
                return tuple(map(figures, value))
            return value if isfinite(value) else None

        return {name: figures(value) for name, value in asdict(self).items()}


@dataclass(frozen=True)
class Builds:
    """Arrays that were built virtually.

    count, seed  of each distribution
    kept         by distribution: share of arrays that meet every requirement
    failures     by distribution: how many arrays miss a requirement, by its name
    elements     as built
    near         share of arrays of normal parts with every K within NEAR of the drawn one; None if the family
                 has no K as built
    """

    count: int
    seed: int
    kept: dict[str, float]
    failures: dict[str, dict[str, int]]
    elements: tuple[ElementBuilt, ...]
    near: float | None = None

    @property
    def worse(self) -> Distribution:
        """The deciding distribution with the lower yield."""
        return min(DECIDING, key=lambda name: self.kept[name])

    @property
    def share(self) -> float:
        """Yield: share of arrays that meet every requirement, under the worse deciding distribution."""
        return self.kept[self.worse]

    @property
    def interval(self) -> tuple[float, float]:
        """In which the yield lies at 95 %."""
        return of_share(round(self.share * self.count), self.count)


@dataclass(frozen=True)
class Sensor:
    """A design for virtual builds: variables and requirements are made once."""

    layout: Layout
    variables: dict[str, DimensionLimits]
    requirements: tuple[Requirement, ...]

    @property
    def _family(self) -> Family:
        return family_of(self.layout.design)

    def built(self, count: int, seed: int = SEED) -> Builds:
        """`count` arrays of each distribution."""
        kept: dict[str, float] = {}
        failures: dict[str, dict[str, int]] = {}
        elements: tuple[ElementBuilt, ...] = ()
        near = None
        for name in (*DECIDING, "corners"):
            missed, arrays = self._all(count, name, np.random.default_rng(seed))
            kept[name] = float(1.0 - np.logical_or.reduce(list(missed.values())).mean())
            failures[name] = {r: int(m.sum()) for r, m in missed.items() if m.any()}
            if name == "normal":
                elements = self._family.stack.elements(self.layout, arrays)
                if "stiffness" in arrays:
                    off = np.abs(arrays["stiffness"] / self._drawn() - 1.0).max(axis=1)
                    near = float((off <= NEAR).mean())
        return Builds(count, seed, kept, failures, elements, near)

    def _drawn(self) -> Array:
        """K of every element as drawn, N/mm."""
        middle = {name: np.zeros((1, v.pieces)) for name, v in self.variables.items()}
        stack = self._family.stack
        return np.asarray(stack.figures(stack.built(self.layout, middle))["stiffness"])

    def missed(self, arrays: Assembled, count: int) -> dict[str, Array]:
        """For each requirement a mask of `count` arrays that miss it."""
        bad = {r.name: r.margin(r.value(arrays)).min(axis=1) < -ROUNDING for r in self.requirements}
        return {name: np.broadcast_to(which, (count,)) for name, which in bad.items()}

    def _all(
        self, count: int, distribution: Distribution, rng: np.random.Generator
    ) -> tuple[dict[str, Array], dict[str, Array]]:
        """For each requirement a mask of arrays that miss it; and the elements' figures, (arrays,
        elements)."""
        at_once = max(1, AT_ONCE // len(self.layout.elements))
        missed: dict[str, list[Array]] = {r.name: [] for r in self.requirements}
        figures: dict[str, list[Array]] = {}
        for start in range(0, count, at_once):
            some = min(at_once, count - start)
            arrays = self._family.stack.built(self.layout, made(self.variables, some, distribution, rng))
            for name, bad in self.missed(arrays, some).items():
                missed[name].append(bad)
            if distribution == "normal":
                for name, value in self._family.stack.figures(arrays).items():
                    figures.setdefault(name, []).append(value)
        together = {name: np.vstack(values) for name, values in figures.items()}
        return {name: np.concatenate(values) for name, values in missed.items()}, together

    def stack(self, *names: str) -> list[StackLine]:
        """The stack of every requirement, or of those named, from no more arrays than take as long as
        1000 of a 2 x 5."""
        count = int(np.clip(10_000 / len(self.layout.elements), 100, 1000))
        wanted = [r for r in self.requirements if not names or r.name in names]
        return stack(self.layout, self.variables, wanted, count)

    def refusal(self, builds: Builds) -> str:
        """Why a design with these builds is not released: what fails most, by how much at worst, and which
        limit to mend; "" if enough of them meet all requirements."""
        if builds.share >= LEAST_YIELD:
            return ""
        failed = builds.failures[builds.worse]
        worst = max(failed, key=lambda name: failed[name])
        (line,) = self.stack(worst)
        most = line.contributors[0] if line.contributors else None
        values = paths(self.layout.design)
        looked_at = " and ".join(
            path if values[path] is None else f"{path} = {values[path]:g}" for path in line.requirement.fields
        )
        missed = f"{line.shortfall:.3g} {line.requirement.unit}".rstrip()
        return (
            f"{100 * builds.share:.1f} % of {builds.count} virtual arrays ({builds.worse} parts, seed "
            f"{builds.seed}) meet all requirements; needed: {100 * LEAST_YIELD:g} %. Most often missed: "
            f"{worst} ({failed[worst]} arrays; the worst case misses its limit by {missed})"
            + (f"; largest contributor: {most.name}, {100 * most.share:.0f} %" if most else "")
            + (f"; look at {looked_at}" if looked_at else "")
        )


def sensor(design: CommonTables, scenes: Sequence[Scene] | None = None) -> Sensor:
    """A design's array, and the rigs of these scenes (by default all), ready to be built virtually."""
    family = family_of(design)
    layout = family.layout(design)
    if scenes is None:
        scenes = [make_scene(design, name) for name in scene_names(design)]
    variables, wanted = family.stack.limits(layout, scenes)
    return Sensor(layout, variables, tuple(wanted))


def element_figures(arrays: Assembled) -> dict[str, Array]:
    made_, arm = arrays.made, np.array([p.load_arm for p in arrays.layout.elements])
    return {
        "stiffness": arrays.stiffness,
        "pad_height_um": 1e3 * (arrays.carried - arrays.carried.min(axis=1, keepdims=True)),
        "load_arm": arm + made_[of_element(ARM_LENGTH)] - made_[of_element(PAD_LENGTH)] / 2,
        "stop_gap": arrays.gaps,
        "closes": arrays.closing_force,
    }


def elements_built(layout: Layout, figures: dict[str, Array]) -> tuple[ElementBuilt, ...]:
    def of(name: str, i: int) -> tuple[float, float]:
        return (float(figures[name][:, i].mean()), float(figures[name][:, i].std()))

    return tuple(
        ElementBuilt(
            p.number,
            of("stiffness", i),
            of("pad_height_um", i),
            of("load_arm", i),
            of("stop_gap", i),
            float(figures["closes"][:, i].min()),
        )
        for i, p in enumerate(layout.elements)
    )


def of_share(successes: int, count: int) -> tuple[float, float]:
    """Clopper and Pearson's interval of a share (Biometrika 26, 1934): never covers less than LEVEL."""
    tail = (1.0 - LEVEL) / 2.0
    low = float(betaincinv(successes, count - successes + 1.0, tail)) if successes else 0.0
    high = float(betaincinv(successes + 1.0, count - successes, 1.0 - tail)) if successes < count else 1.0
    return low, high


def widest(count: int) -> float:
    """Half-width of `of_share` of so many at its largest, where half of them succeed."""
    low, high = of_share(count // 2, count)
    return (high - low) / 2.0
