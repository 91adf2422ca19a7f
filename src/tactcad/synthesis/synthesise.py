"""From a target to a synthesis: the chosen design, how surely it feels, what limits it, and alternatives;
and how much there is to do for a target, counted before anything is searched."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, log2
from operator import attrgetter
from typing import Any

import numpy as np

from tactcad.checks.check import slow_failures
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.lab import array_estimate
from tactcad.mechanics.section import Array
from tactcad.scenes import LeftOut, left_out

from . import relax
from .candidates import Candidates, Stand, origins, stands
from .interval import coupled_estimate
from .made_arrays import MadeSensor, Yield
from .search import FAR, GENERATIONS, POPULATION, Found, Goal, all_refusals, refusals, search
from .shares import Share, half_space_shares, variance_shares
from .target import Target

ARRAYS = 2000  # made of each distribution
MARGINS = (1.0, 1.1, 1.2, 1.35, 1.5, 1.75, 2.0)  # between wanted and nominal half-width, tried for the yield
CURVE = 25  # points of the object's range in the report
RATIOS = (2.0, 4.0, 6.0, 10.0, 16.0, 30.0)  # K_r/K_m; the paper proposes about 10
PAPERS_RATIO = 10.0
SAME_RATIO = 0.03  # relative, within which a ratio counts as the asked one
NEAR = 0.01  # relative gain below which an eased field is not said to limit
ALTERNATIVES = 9  # searches for the report's front, about
QUICK = 2e-3  # relative; searches beside the answer stop there
NEAR_SEEDS = (1, 2)  # each such search is made twice, and the better one counts

_narrowest = attrgetter("half_width")  # the goal of searches beside the answer

Tell = Callable[[int, int, str], None]
GoOn = Callable[[], None]  # called before each search beside the answer; raises TimeIsOver


class TimeIsOver(Exception):
    """Nothing more is to be begun."""


@dataclass(frozen=True)
class Alternative:
    """One design of the front.

    name, what   of the entry, and what was held beside the interval
    found        its candidate
    half_width   relative, nominal, largest over the range
    """

    name: str
    what: str
    found: Found

    @property
    def half_width(self) -> float:
        return self.found.half_width

    def record(self) -> dict[str, Any]:
        c, stand = self.found.candidate, self.found.candidate.stand
        return {
            "name": self.name,
            "what": self.what,
            "half_width": self.half_width,
            "elements": int(c.total[0]),
            "different": int(c.different[0]),
            "carrier_area_mm2": float(c.area[0]),
            "cut_length_mm": float(c.cut[0]),
            "hinge_tolerance_mm": stand.base.tolerance.hinge_thickness,
            "sheet_mm": stand.base.sheet.thickness,
            "alloy": stand.base.material.alloy,
            "arms_mm": [round(float(a), 6) for a in c.arm[0]],
            "hinges_mm": [round(float(t), 6) for t in c.thickness[0]],
            "counts": [int(n) for n in c.count[0]],
            "stiffness_N_per_mm": [float(k) for k in c.elements.stiffness[0]],
        }


@dataclass(frozen=True)
class Limit:
    """A field of the target that limits: eased by one step alone, the half-width falls to `half_width`."""

    field: str
    value: Any
    eased: Any
    half_width: float
    gain: float


@dataclass(frozen=True)
class LeastChange:
    """A field whose change alone makes the target possible, and the nearest value that does."""

    field: str
    value: Any
    needed: Any


@dataclass(frozen=True)
class Synthesis:
    """What `design` found.

    target      as asked
    found       the chosen candidate
    wanted      half-width that arrays are held against, relative; without one asked, the least that
                `target.share` of them keep
    made        its yield
    solid       K of every element by solid elements, N/mm
    met         whether the target is
    left_out    parts of the report that there was no time for
    not_tried   fields whose least change there was no time to search
    unknown     what of the report is not known, and why
    binding     fields whose easing narrows the interval; None where that was not searched
    """

    target: Target
    found: Found
    wanted: float
    made: Yield
    met: bool
    binding: tuple[Limit, ...] | None = None
    shares: tuple[Share, ...] = ()
    front: tuple[Alternative, ...] = ()
    ratios: tuple[tuple[float, float], ...] = ()
    changes: tuple[LeastChange, ...] = ()
    solid: tuple[float, ...] = ()
    evaluations: int = 0
    left_out: tuple[str, ...] = ()
    not_tried: tuple[str, ...] = ()
    unknown: tuple[str, ...] = ()

    @cached_property
    def design(self) -> Design:
        """The chosen design, every derived value with its origin."""
        return self.as_design(self.found, self.target.target.name)

    def as_design(self, found: Found, name: str) -> Design:
        """A found candidate as a design of that name."""
        d, wish = found.design, self.target.target
        identity = replace(d.design, name=name, title=wish.title, revision="A")
        binding = "limits not searched"
        if self.binding is not None:
            binding = f"binding: {', '.join(limit.field for limit in self.binding) or 'nothing near'}"
        return replace(d, design=identity, origin={**d.origin, **origins(self.target.base, d, binding)})

    @cached_property
    def sensor(self) -> MadeSensor:
        return MadeSensor(self.target, self.found.design)

    @cached_property
    def base_half_width(self) -> float | None:
        """Of the base design as it is, under the same forces and knowledge; None beyond the estimator."""
        x = np.geomspace(*self.target.stiffness_range, CURVE)
        got = MadeSensor(self.target, self.target.base).interval(x).half_width(x)
        return float(got.max()) if np.isfinite(got).all() else None

    @cached_property
    def base_cannot(self) -> str:
        """Why the base design as it is does not bear the target's forces; "" where it does."""
        return MadeSensor(self.target, self.target.base).cannot_bear

    @cached_property
    def scenes_left_out(self) -> list[LeftOut]:
        """Rigs of the base design that do not take the chosen array."""
        return left_out(self.found.design) if self.found.accepted else []

    @property
    def ratio(self) -> float:
        """K_r/K_m: the stiffest element's stiffness over the softest's."""
        K = self.found.candidate.elements.stiffness
        return float(K.max() / K.min())

    def coupling(self, share: float) -> float:
        """By how much, relative, K_obj is believed too large at the middle of the range where the pads are
        coupled by a share of a half-space's and `--coupling 0` is said."""
        s, grip, alone = self.sensor, self.target.grasp, np.eye(len(self.sensor.drawn.stiffness))
        x, shares = float(np.median(s.points)), share * half_space_shares(s) * (1.0 - alone) + alone
        felt = coupled_estimate(s.drawn, s.known(s.drawn), x, s.noise, grip.force, grip.loads, shares)
        return float(felt[0] / x - 1.0)


def goal_of(target: Target, margin: float = 1.0) -> Goal:
    """What the search makes least: the half-width, or what the target names once the half-width is met."""
    wanted, least = target.target.half_width, target.target.least

    def goal(c: Candidates) -> Array:
        width = c.half_width
        if wanted is None or least in ("width", "tolerance"):
            return width
        beyond = np.maximum(width * margin / (wanted / 100.0) - 1.0, 0.0)
        what = {"room": c.area / 1e4, "cut": c.cut / 1e4, "kinds": c.different}[least]
        return np.where(beyond > 0.0, FAR * (1.0 + beyond), what + 1e-3 * width)

    return goal


def attempt(target: Target, arrays: int = ARRAYS, within: float = 1e-3) -> Synthesis:
    """The best design of a target, its yield and whether that meets it; nothing else.

    Parameters
    ----------
    target
        What is asked for.
    arrays
        To be made of each distribution for the yield.
    within
        Relative, by how much more search might change the answer.
    """
    looked, best = 0, None
    for margin, some in tries(target):
        for rules in (refusals, all_refusals):
            found = [search(s, goal_of(target, margin), rules=rules, within=within) for s in some]
            looked += sum(one.evaluations for one in found)
            chosen = min(found, key=lambda f: (not f.accepted, f.goal))
            if not (chosen.accepted and slow_failures(chosen.design)):
                break  # else once more, where whatever would be the best yet is held against slow checks too
        made, wanted = _made(target, chosen, arrays)
        met = chosen.accepted and made.share >= target.target.share and chosen.half_width <= wanted
        this = Synthesis(target, chosen, wanted, made, met)
        if best is None or _worth(this) > _worth(best):
            best = this
        if met or (not chosen.accepted and target.target.least != "tolerance"):
            break
    assert best is not None
    return replace(best, evaluations=looked)


def _worth(got: Synthesis) -> tuple[bool, bool, float, float]:
    return got.met, got.found.accepted, got.made.share, -got.found.half_width


def tries(target: Target) -> list[tuple[float, list[Stand]]]:
    """What is searched until the target is met: margins between wanted and nominal half-width, and stands."""
    everything, least = stands(target), target.target.least
    if target.target.half_width is not None and least in ("room", "cut", "kinds"):
        return [(margin, everything) for margin in MARGINS]
    if target.target.half_width is None or least != "tolerance":
        return [(1.0, everything)]
    loosest_first = sorted(set(target.stock.hinge_tolerances), reverse=True)
    return [
        (1.0, [s for s in everything if s.base.tolerance.hinge_thickness == tolerance])
        for tolerance in loosest_first
    ]


def _made(target: Target, found: Found, arrays: int) -> tuple[Yield, float]:
    asked = target.target.half_width
    if not found.accepted:
        return Yield(0, 0.0, (0.0, 1.0), "normal", {}, np.zeros(0)), (asked or 0.0) / 100.0
    sensor = MadeSensor(target, found.design)
    if asked is not None:
        return sensor.built(arrays, asked / 100.0), asked / 100.0
    # a little above the least that enough of them keep, so that the share asked for is kept for sure
    wanted = sensor.kept_by(1.0 - (1.0 - target.target.share) / 2.0, arrays)
    wanted = float(f"{1.005 * wanted:.3g}") if np.isfinite(wanted) else found.half_width
    return sensor.built(arrays, wanted), wanted


def design(
    target: Target,
    *,
    arrays: int = ARRAYS,
    seconds: float | None = None,
    tell: Tell = lambda done, total, what: None,
) -> Synthesis:
    """A sensor from a target.

    Parameters
    ----------
    target
        As `target.read_target` gives it.
    arrays
        To be made of each distribution for the yield.
    seconds
        Time to take; what is not done by then of the report (limits, variance shares, front, ratios) is left
        out and named. The search and the yield are never cut short.
    tell
        Called with (done, total, what comes next).

    Returns
    -------
    Synthesis
        `met` says whether the target is; where it is not, `changes` has the least change of each field that
        alone would make it possible.
    """
    started = time.perf_counter()

    def go_on() -> None:
        if seconds is not None and time.perf_counter() - started > seconds:
            raise TimeIsOver

    steps: list[tuple[str, Callable[[Synthesis, GoOn], Synthesis]]] = [
        ("variance shares", _with_shares),
        ("solid elements", _with_solids),
        ("what limits it", _with_limits),
        ("alternatives", _with_front),
        ("stiffness ratios", _with_ratios),
    ]
    tell(0, len(steps) + 1, "searching")
    got = attempt(target, arrays)
    if not got.met:
        return _with_changes(got, arrays, tell, go_on)
    skipped, unknown = [], []
    for i, (what, step) in enumerate(steps, start=1):
        try:
            go_on()
            tell(i, len(steps) + 1, what)
            got = step(got, go_on)
        except TimeIsOver:
            skipped.append(what)
        except CheckFailure as why:
            unknown.append(f"{what}: not known, because {why}")
    return replace(got, left_out=tuple(skipped), unknown=tuple(unknown))


def _with_shares(got: Synthesis, _: GoOn) -> Synthesis:
    return replace(got, shares=tuple(variance_shares(got.sensor)))


def _with_solids(got: Synthesis, _: GoOn) -> Synthesis:
    rows = array_estimate.estimate(got.sensor.layout, "fem-solid")
    return replace(got, solid=tuple(row.stiffness for row in rows))


def _search_near(target: Target, found: Found, goal: Goal | None = None) -> Found:
    """The search on the found one's stand for another target, started from it."""
    here = found.candidate.stand
    same = [s for s in stands(target) if _same_stand(s, here)] or stands(target)
    near = [
        search(
            s,
            goal or goal_of(target),
            start=found.row if s.kinds == here.kinds else None,
            within=QUICK,
            seed=seed,
        )
        for s in same
        for seed in NEAR_SEEDS
    ]
    return min(near, key=lambda f: (not f.accepted, f.goal))


def _same_stand(one: Stand, other: Stand) -> bool:
    """Whether all is the same but tolerances; or one has more kinds of element than the other's target
    allows."""
    alike = one.base.sheet, one.base.material.alloy
    kinds = one.kinds == other.kinds or one.kinds > other.target.elements.kinds
    return kinds and alike == (other.base.sheet, other.base.material.alloy)


def _with_limits(got: Synthesis, go_on: GoOn) -> Synthesis:
    """Fields whose easing by a step narrows the interval, the most helpful first."""
    width, limits = got.found.half_width, []
    for name, other in relax.eased(got.target):
        if name in relax.NOT_NARROWING:
            continue
        go_on()
        found = _search_near(other, got.found, _narrowest)
        if found.accepted and found.half_width < width * (1.0 - NEAR):
            gain = 1.0 - found.half_width / width
            values = relax.value_of(got.target, name), relax.value_of(other, name)
            limits.append(Limit(name, *values, found.half_width, gain))
    return replace(got, binding=tuple(sorted(limits, key=lambda limit: -limit.gain)))


def _with_front(got: Synthesis, go_on: GoOn) -> Synthesis:
    """Designs with fewer elements, in less room, with looser tolerances, each as accurate as can be."""
    target, c = got.target, got.found.candidate
    wish = target.with_("target.half_width", None)
    entries = [Alternative("chosen", "the design chosen", got.found)]
    most = int(target.room.elements[1])
    for n in sorted({2, 4, 6, 8, most // 2, most, 2 * most}):
        if max(2, 2 * target.elements.of_a_kind) <= n != int(c.total[0]):
            go_on()
            low = min(int(target.room.elements[0]), n)
            found = _search_near(wish.with_("room.elements", (low, n)), got.found, _narrowest)
            if found.accepted and int(found.candidate.total[0]) == n:
                entries.append(Alternative(f"elements-{n}", f"at most {n} elements", found))
    longest = float(np.max(c.layout.carrier_length))
    for less in (1.0, 2.0, 3.0):
        go_on()
        found = _search_near(wish.with_("room.length", round(longest - less, 3)), got.found, _narrowest)
        if found.accepted:
            entries.append(Alternative(f"shorter-{less:g}", f"{less:g} mm shorter", found))
    for times in (0.5, 2.0) if target.known.how == "drawn" else ():
        go_on()
        finest = round(min(target.stock.hinge_tolerances) * times, 6)
        found = _search_near(wish.with_("stock.hinge_tolerances", (finest,)), got.found, _narrowest)
        if found.accepted:
            entries.append(Alternative(f"tolerance-{finest:g}", f"hinges within {finest:g} mm", found))
    return replace(got, front=tuple(e for e in entries if not slow_failures(e.found.design)))


def _with_ratios(got: Synthesis, go_on: GoOn) -> Synthesis:
    """Half-width by K_r/K_m, everything else at its best."""
    out = []
    for ratio in RATIOS:

        def goal(c: Candidates, ratio: float = ratio) -> Array:
            K = c.elements.stiffness
            off = np.abs(np.log(K.max(axis=1) / K.min(axis=1) / ratio))
            return np.where(off > SAME_RATIO, FAR * (1.0 + off), c.half_width)

        go_on()
        found = _search_near(got.target, got.found, goal)
        if found.accepted:
            out.append((ratio, found.half_width))
    return replace(got, ratios=tuple(out))


def _with_changes(got: Synthesis, arrays: int, tell: Tell, go_on: GoOn) -> Synthesis:
    """What of the target, changed alone by the least, would make it possible; each shown by a run."""
    names = [name for name, _ in relax.eased(got.target)]
    changes, skipped = [], []

    def possible(target: Target) -> bool:
        go_on()
        return attempt(target, arrays).met

    for i, name in enumerate(names):
        try:
            go_on()
            tell(i, len(names), f"impossible as asked; the least change of {name}")
            change = relax.least_change(got.target, name, possible)
        except TimeIsOver:
            skipped.append(name)
            continue
        if change:
            changes.append(LeastChange(name, relax.value_of(got.target, name), change[0]))
    return replace(got, changes=tuple(changes), not_tried=tuple(skipped))


def work_ahead(target: Target, report: bool) -> dict[str, float]:
    """Counts of what `design` does at most.

    Parameters
    ----------
    target
        What is asked for.
    report
        With what the report tells beside the design: limits, alternatives, ratios.

    Returns
    -------
    dict
        candidate: looked at by the search; near: searches beside the answer; yield: how often arrays are
        made; element: of the largest array.
    """
    some = tries(target)
    asked_too = 2 if target.target.half_width is None else 1  # what arrays keep, then how many keep it
    near = len(list(relax.eased(target))) + ALTERNATIVES + len(RATIOS)
    return {
        "candidate": sum(_candidates(stand) for _, stands in some for stand in stands),
        "near": float(near * len(NEAR_SEEDS) * report),
        "yield": float(asked_too * len(some)),
        "element": float(target.room.elements[1]),
    }


def _candidates(stand: Stand) -> float:
    """scipy's population by Sobol is the next power of two; all generations of it, and its first."""
    numbers = len(stand.limits[0])
    return float(2 ** ceil(log2(POPULATION * numbers)) * (GENERATIONS + 1))
