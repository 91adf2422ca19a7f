"""From a target to a synthesis. First the answer: the chosen design and the bounds it lies on, or that there
is none. Then its limits and alternatives, or the least changes, as time allows."""

from __future__ import annotations

import multiprocessing
import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import inf
from typing import Any

import numpy as np

from tactcad.checks.check import slow_failures
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.export.workers import Task, side_by_side
from tactcad.lab import array_estimate
from tactcad.mechanics.section import Array
from tactcad.scenes import LeftOut, left_out

from . import bounds
from .candidates import Candidates, Stand, origins, stands
from .interval import coupled_estimate
from .made_arrays import MadeSensor, Share, Yield, half_space_shares, variance_shares
from .search import FAR, Found, Goal, all_refusals, refusals, search
from .target import Target

ARRAYS = 2000  # made of each distribution
TRIED = 500  # for the least change of a field: the yield's interval is some 2 % either way
MARGINS = (1.0, 1.1, 1.2, 1.35, 1.5, 1.75, 2.0)  # between wanted and nominal half-width, tried for the yield
CURVE = 25  # points of the object's range in the report
RATIOS = (2.0, 4.0, 6.0, 10.0, 16.0, 30.0)  # K_r/K_m; the paper proposes about 10
PAPERS_RATIO = 10.0
SAME_RATIO = 0.03  # relative deviation within which a ratio counts as the one asked for
GAIN = 0.01  # relative gain below which an eased field is not said to limit
QUICK = 2e-3  # relative; all searches but the answer's stop there
# s from the beginning on, if nothing else is asked: the search for the answer, and all before the report;
# with bounds, yield and report they keep 30 s and 2 minutes.
SEARCHING, IN_ALL = 20.0, 105.0
# The same with a body under the pads: a candidate costs milliseconds, and so do arrays made.
ON_BODY, ALL_ON_BODY, ARRAYS_ON_BODY = 70.0, 160.0, 400
SHARE = 0.4  # of the seconds asked for, for the search
EACH = 0.5  # of the time left, for each search if several may follow
CLOSE_ENOUGH = 1.03  # a margin smaller by so much than what the arrays need may still do
HEARD = 0.2  # s, between looks at the clock
ANSWER = "answer"  # what is done for it
PARTS = (  # of the report, beside the answer
    "variance shares",
    "what limits it",
    "alternatives",
    "stiffness ratios",
    "solid elements",
    "least change",
)

Tell = Callable[[int, int, str], None]


class TimeIsOver(Exception):
    """Nothing more is to be begun."""


@dataclass(frozen=True)
class Alternative:
    """One design of the front.

    name, what   its figure, and what was kept besides the interval
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
    """Result of `design`.

    target      as asked
    found       the chosen candidate
    wanted      half-width that arrays must keep, relative; if none is asked for, the least that
                `target.share` of them keep
    made        its yield
    solid       K of every element by solid elements, N/mm
    met         whether every wish of the target is met
    bounds      bounds that the answer lies on
    left_out    parts of the report that time did not allow
    unknown     unknown entries of the report, with reasons
    binding     fields whose easing narrows the interval, the bounds apart
    """

    target: Target
    found: Found
    wanted: float
    made: Yield
    met: bool
    bounds: tuple[bounds.Bound, ...] = ()
    binding: tuple[Limit, ...] = ()
    shares: tuple[Share, ...] = ()
    front: tuple[Alternative, ...] = ()
    ratios: tuple[tuple[float, float], ...] = ()
    changes: tuple[LeastChange, ...] = ()
    solid: tuple[float, ...] = ()
    evaluations: int = 0
    left_out: tuple[str, ...] = ()
    unknown: tuple[str, ...] = ()

    @cached_property
    def design(self) -> Design:
        """The chosen design, every derived value with its origin."""
        return self.as_design(self.found, self.target.target.name)

    def as_design(self, found: Found, name: str) -> Design:
        """A found candidate as a design of that name."""
        d, wish = found.design, self.target.target
        identity = replace(d.design, name=name, title=wish.title, revision="A", unchanged={})
        on = f"on bounds: {', '.join(b.field for b in self.bounds) or 'none'}"
        return replace(d, design=identity, origin={**d.origin, **origins(self.target.base, d, on)})

    @cached_property
    def sensor(self) -> MadeSensor:
        return MadeSensor(self.target, self.found.design)

    @cached_property
    def base_half_width(self) -> float | None:
        """Half-width of the unchanged base design, under the same forces and knowledge; None outside the
        estimator's range."""
        sensor = MadeSensor(self.target, self.target.base)
        if not np.isfinite(sensor.drawn.stiffness).all():
            return None
        if self.target.on_layer:
            return sensor.worst()[0]
        x = np.geomspace(*self.target.stiffness_range, CURVE)
        got = sensor.interval(x).half_width(x)
        return float(got.max()) if np.isfinite(got).all() else None

    @cached_property
    def base_breaks(self) -> list[str]:
        """Why the unchanged base design misses the target."""
        return bounds.base_breaks(self.target)

    @cached_property
    def scenes_left_out(self) -> list[LeftOut]:
        """Rigs of the base design that do not take the chosen array."""
        return left_out(self.found.design) if self.found.accepted else []

    @property
    def object_range(self) -> tuple[float, float]:
        """Least and largest K_obj under the design's pads, N/mm."""
        return self.target.range_of(self.found.design)

    @property
    def ratio(self) -> float:
        """K_r/K_m: the stiffest element's stiffness over the softest's."""
        K = self.found.candidate.elements.stiffness
        return float(K.max() / K.min())

    def coupling(self, share: float) -> float:
        """Relative excess of K_obj at the middle of the range if the pads are coupled by a share of a
        half-space's coupling and `--coupling 0` is given."""
        s, grip, alone = self.sensor, self.target.grasp, np.eye(len(self.sensor.drawn.stiffness))
        x, shares = float(np.median(s.points)), share * half_space_shares(s) * (1.0 - alone) + alone
        felt = coupled_estimate(s.drawn, s.known(s.drawn), x, s.noise, grip.force, grip.loads, shares)
        return float(felt[0] / x - 1.0)


def goal_of(target: Target, margin: float = 1.0) -> Goal:
    """The search's goal to minimise: the half-width, or the target's own goal once the half-width is met."""
    wanted, least = target.target.half_width, target.target.least

    def goal(c: Candidates) -> Array:
        width = c.half_width
        if wanted is None or least in ("width", "tolerance"):
            return width
        kept = wanted / (100.0 * width * margin)  # below 1: too wide, which is nearer than a limit missed
        what = {"room": c.area / 1e4, "cut": c.cut / 1e4, "kinds": c.different}[least]
        return np.where(kept < 1.0, FAR * (1.0 - kept / 2.0), what + 1e-3 * width)

    return goal


def attempt(
    target: Target,
    arrays: int = ARRAYS,
    within: float = 1e-3,
    *,
    until: float = inf,
    near: Found | None = None,
    evolve: bool = True,
) -> Synthesis:
    """The best design of a target, its yield and whether that meets it; nothing else.

    Parameters
    ----------
    target
        What is asked for.
    arrays
        Number made of each distribution for the yield.
    within
        Relative change of the answer at which the search may stop.
    until
        Of `time.perf_counter`; then the best so far is taken.
    near, evolve
        A candidate of nearly the same target, and whether more is looked at than what lies around it. With
        one, only what the least change of a field needs is found.
    """
    looked, best, rules = 0, None, refusals if near else all_refusals
    needed = 1.0  # margin that the arrays of the best so far need
    arrays = min(arrays, TRIED) if near else arrays
    arrays = min(arrays, ARRAYS_ON_BODY) if target.on_layer else arrays
    planned = tries(target)
    for margin, some in planned:
        now = time.perf_counter()
        if best and now > until:
            break
        if margin < min(needed / CLOSE_ENOUGH, planned[-1][0]):
            continue
        goal, start = goal_of(target, margin), near or (best.found if best else None)
        end = now + (until - now) * (1.0 if len(planned) == 1 else EACH)
        found = _together(
            [
                partial(_in_turn, s, goal, rules, start, evolve, within, end, len(some) - i)
                for i, s in enumerate(some)
            ]
        )
        looked += sum(one.evaluations for one in found)
        chosen = min(found, key=lambda f: (not f.accepted, f.goal))
        made, wanted = _made(target, chosen, arrays, bool(near))
        met = chosen.accepted and made.share >= target.target.share and chosen.half_width <= wanted
        this = Synthesis(target, chosen, wanted, made, met)
        if best is None or _worth(this) > _worth(best):
            best = this
        too_wide = len(planned) > 1 and chosen.goal >= FAR / 2.0
        if met or ((not chosen.accepted or too_wide) and target.target.least != "tolerance"):
            break
        needed = _margin(made, chosen, target.target.share)
    assert best is not None
    return replace(best, evaluations=looked)


def _margin(made: Yield, found: Found, share: float) -> float:
    """Half-width that a share of the arrays made keep, relative to the nominal one; 1 if they lack more."""
    kept = made.kept_by(share) if made.count else np.inf
    return kept / found.half_width if np.isfinite(kept) else 1.0


def _in_turn(
    stand: Stand,
    goal: Goal,
    rules: Any,
    near: Found | None,
    evolve: bool,
    within: float,
    until: float,
    left: int,
) -> Found:
    """The search on one of `left` stands that share the remaining time."""
    now, start = time.perf_counter(), bounds.numbers(near, stand) if near else None
    until = now + max(until - now, 0.0) * min(1.0, _cores() / left)
    return search(stand, goal, rules=rules, start=start, evolve=evolve, within=within, until=until)


def _cores() -> int:
    return 1 if multiprocessing.current_process().daemon else len(os.sched_getaffinity(0))


def _together(makes: Sequence[Callable[[], Any]]) -> list[Any]:
    """Side by side; one after the other where this process is one of several itself."""
    if len(makes) == 1 or _cores() == 1:
        return [make() for make in makes]
    done = dict(side_by_side([Task(ANSWER, make) for make in makes]))
    return [done[n] for n in range(len(makes))]


def _worth(got: Synthesis) -> tuple[bool, bool, float, float]:
    return got.met, got.found.accepted, got.made.share, -got.found.half_width


def tries(target: Target) -> list[tuple[float, list[Stand]]]:
    """Searches to run until the target is met: margins between wanted and nominal half-width, and stands."""
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


def _made(target: Target, found: Found, arrays: int, only_met: bool) -> tuple[Yield, float]:
    asked = target.target.half_width
    if not found.accepted or (only_met and asked and 100.0 * found.half_width > asked):
        return Yield(0, 0.0, (0.0, 1.0), "normal", {}, np.zeros(0)), (asked or 0.0) / 100.0
    sensor = MadeSensor(target, found.design)
    if asked is not None:
        return sensor.built(arrays, asked / 100.0), asked / 100.0
    # slightly above the least that enough of them keep, so that rounding cannot lose the share asked for
    wanted = sensor.kept_by(1.0 - (1.0 - target.target.share) / 2.0, arrays)
    wanted = float(f"{1.005 * wanted:.3g}") if np.isfinite(wanted) else found.half_width
    return sensor.built(arrays, wanted), wanted


def design(
    target: Target,
    *,
    arrays: int = ARRAYS,
    seconds: float | None = None,
    tell: Tell = lambda done, total, what: None,
    answered: Callable[[Synthesis], object] = lambda got: None,
    ending: Callable[[], float] = lambda: 0.0,
) -> Synthesis:
    """A sensor from a target.

    Parameters
    ----------
    target
        As `target.read_target` gives it.
    arrays
        To be made of each distribution for the yield.
    seconds
        Time budget: the best design by then, and the parts of the report done by then. Bounds and yield are
        never left out.
    tell
        Called with (done, total, name of the next task).
    answered
        Called with the answer, before the rest of the report is begun.
    ending
        Returns the seconds to leave for the caller's own work; called after `answered`.

    Returns
    -------
    Synthesis
        `met`: whether the target is met; if not, `changes` has for each field the least change that alone
        would make the target possible.
    """
    started = time.perf_counter()
    tell(0, 1, "searching")
    usual, in_all = (ON_BODY, ALL_ON_BODY) if target.on_layer else (SEARCHING, IN_ALL)
    searching = usual if seconds is None else min(SHARE * seconds, max(usual, seconds / 4.0))
    got = attempt(target, arrays, until=started + searching)
    if not got.met and (smaller := bounds.compact(got.found)):
        tried = attempt(smaller, arrays, until=started + searching)
        got = tried if _worth(tried) > _worth(got) else got
    on = _together([partial(bounds.bound, got.found, field) for field in bounds.touched(got.found)])
    got = replace(got, bounds=tuple(each for each in on if each))
    if not got.found.in_time:
        got = replace(
            got, unknown=(f"the search was ended after {searching:.3g} s: more time may find better",)
        )
    tasks = list(_beside(got) if got.met else _changes(got, arrays))
    answered(_with_results(got, tasks, {}))
    until, done = started + (seconds or in_all) - ending(), dict[int, Any]()

    def hear(what: str) -> None:
        tell(len(done), len(tasks), what)
        if time.perf_counter() > until:
            raise TimeIsOver

    with suppress(TimeIsOver), closing(side_by_side(tasks, hear, every=HEARD)) as ready:
        for n, result in ready:
            done[n] = result
            hear(tasks[n].name)
    return _with_results(got, tasks, done)


def _with_results(got: Synthesis, tasks: Sequence[Task], done: dict[int, Any]) -> Synthesis:
    """The answer with the other results, in the order of the tasks, not of their completion."""
    part = [task.name.partition(": ")[0] for task in tasks]
    found: dict[str, list] = {name: [] for name in part}
    for n in sorted(done):
        found[part[n]] += [done[n]] if done[n] else []
    left = {name: sum(part[n] == name and n not in done for n in range(len(tasks))) for name in found}
    told = {name: found.get(name, []) for name in PARTS}
    chosen = Alternative("chosen", "the design chosen", got.found)
    solid = told["solid elements"][0] if told["solid elements"] else ()
    return replace(
        got,
        shares=told["variance shares"][0] if told["variance shares"] else (),
        solid=() if isinstance(solid, str) else solid,
        binding=tuple(sorted(told["what limits it"], key=lambda limit: -limit.gain)),
        front=(chosen, *told["alternatives"]) if told["alternatives"] else (),
        ratios=tuple(told["stiffness ratios"]),
        changes=tuple(told["least change"]),
        left_out=tuple(f"{name} ({count} of {part.count(name)})" for name, count in left.items() if count),
        unknown=(*got.unknown, solid) if isinstance(solid, str) else got.unknown,
    )


def _beside(got: Synthesis) -> Iterator[Task]:
    """The report's other tasks, most important first."""
    on = (*bounds.NOT_NARROWING, *(b.field for b in got.bounds))
    if not got.target.on_layer:  # they are those of springs
        yield Task("variance shares", lambda: tuple(variance_shares(got.sensor)))
    for name, other in bounds.eased(got.target):
        if name not in on:
            yield Task(f"what limits it: {name}", partial(_limit, got, name, other))
    yield from _front(got)
    for ratio in RATIOS:
        yield Task(f"stiffness ratios: {ratio:g}", partial(_ratio, got, ratio))
    yield Task("solid elements", partial(_solid, got))


def _solid(got: Synthesis) -> tuple[float, ...] | str:
    """K of every element, or why it is not known."""
    try:
        return tuple(row.stiffness for row in array_estimate.estimate(got.sensor.layout, "fem-solid"))
    except CheckFailure as why:
        return f"solid elements: not known, because {why}"


def _best_nearby(target: Target, found: Found, goal: Goal = bounds.narrowest) -> Found:
    """The best for nearly the same target: near the found one; a full search if there is none."""
    some, until = bounds.near(target, found), bounds.soon(target)
    for evolve in (False,) if target.on_layer else (False, True):
        near = [
            search(
                s,
                goal,
                rules=refusals,
                start=bounds.numbers(found, s),
                evolve=evolve,
                within=QUICK,
                until=until,
            )
            for s in some
        ]
        best = min(near, key=lambda f: (not f.accepted, f.goal))
        if best.accepted:
            break
    return best


def _limit(got: Synthesis, name: str, other: Target) -> Limit | None:
    """The field, where easing it by a step narrows the interval."""
    width, found = got.found.half_width, _best_nearby(other, got.found)
    if not found.accepted or found.half_width >= width * (1.0 - GAIN):
        return None
    values = bounds.value_of(got.target, name), bounds.value_of(other, name)
    return Limit(name, *values, found.half_width, 1.0 - found.half_width / width)


def _front(got: Synthesis) -> Iterator[Task]:
    """Designs with fewer elements, in less room, with looser tolerances, each as accurate as can be."""
    target, c = got.target, got.found.candidate
    wish = target.with_("target.half_width", None)

    def entry(name: str, what: str, path: str, value: Any, total: int | None = None) -> Task:
        def make() -> Alternative | None:
            found = _best_nearby(wish.with_(path, value), got.found)
            fits = found.accepted and total in (None, int(found.candidate.total[0]))
            return Alternative(name, what, found) if fits and not slow_failures(found.design) else None

        return Task(f"alternatives: {name}", make)

    most = int(target.room.elements[1])
    for n in sorted({2, 4, 6, 8, most // 2, most, 2 * most}):
        if max(2, 2 * target.elements.of_a_kind) <= n != int(c.total[0]):
            low = min(int(target.room.elements[0]), n)
            yield entry(f"elements-{n}", f"at most {n} elements", "room.elements", (low, n), n)
    longest = float(np.max(c.layout.carrier_length))
    for less in (1.0, 2.0, 3.0):
        length = round(longest - less, 3)
        yield entry(f"shorter-{less:g}", f"{less:g} mm shorter", "room.length", length)
    for times in (0.5, 2.0) if target.known.how == "drawn" else ():
        finest = round(min(target.stock.hinge_tolerances) * times, 6)
        what = f"hinges within {finest:g} mm"
        yield entry(f"tolerance-{finest:g}", what, "stock.hinge_tolerances", (finest,))


def _ratio(got: Synthesis, ratio: float) -> tuple[float, float] | None:
    """Half-width at a K_r/K_m, everything else at its best."""

    def goal(c: Candidates) -> Array:
        K = c.elements.stiffness
        off = np.abs(np.log(K.max(axis=1) / K.min(axis=1) / ratio))
        return np.where(off > SAME_RATIO, FAR * (1.0 + off), c.half_width)

    at = _best_nearby(got.target, got.found, goal)
    return (ratio, at.half_width) if at.accepted else None


def _changes(got: Synthesis, arrays: int) -> Iterator[Task]:
    """The least change of each single field that would make the target possible; each shown by a run."""

    def change(name: str) -> LeastChange | None:
        near = got.found

        def possible(target: Target, checked: bool = False) -> bool:
            nonlocal near
            tried = attempt(target, arrays, QUICK, near=near, evolve=False)
            if not tried.met and near is got.found:  # nothing found yet: from anywhere
                tried = attempt(target, arrays, QUICK, near=near)
            met = tried.met and not (checked and slow_failures(tried.found.design))
            near = tried.found if met else near
            return met

        least = bounds.least_change(got.target, name, possible)
        if least and slow_failures(near.design):
            near = got.found
            least = bounds.least_change(got.target, name, partial(possible, checked=True))
        return LeastChange(name, bounds.value_of(got.target, name), least[0]) if least else None

    for name, _ in bounds.eased(got.target):
        yield Task(f"least change: {name}", partial(change, name))
