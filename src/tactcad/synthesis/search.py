"""The search: scipy's differential evolution over whole numbers, closed forms for many candidates at a time;
then all candidates that differ from the best in one or two numbers, until none is better.

Less violation of limits is better; then the goal decides. The best is made a design and checked
against every rule. If one refuses it, the search runs again and checks each new best.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import combinations, product
from math import inf

import numpy as np
from scipy.optimize import differential_evolution

from tactcad.checks.check import quick_failures, slow_failures
from tactcad.design.design_text import design_text
from tactcad.design.load import parse
from tactcad.design.messages import InputError
from tactcad.design.tree import Design
from tactcad.mechanics.section import Array
from tactcad.parts.rules import broken_rules

from .candidates import Candidates, Stand, realised
from .on_layer import others

SEED = 20261122
POPULATION = 12  # candidates for each number
GENERATIONS = 400
WORTH = 1e-3  # relative; a gain below is not worth holding against the rules again
FAR = 1e3  # goal of a candidate that violates limits, and on
BY = (-5, -2, -1, 1, 2, 5)  # steps by which two numbers are moved at once
FURTHER = (-30, -12, 12, 30)  # and one alone
DESCENT = 0.4  # of the time, at least, for what follows evolution
REFUSED = 100  # candidates by rules or checks, after which no more are tried
LOOKED_BACK = 8  # candidates, where time is over and the best is refused
SEVERAL = 400  # random moves of several numbers
# On a body, where a candidate costs milliseconds: candidates before the best of them is taken, steps of
# several numbers, share of the time for the first guess on springs, and the spread at which it stops.
AT_ONCE, FEW, GUESS, GUESSED = 16, 100, 0.2, 0.02

Goal = Callable[[Candidates], Array]
Refusals = Callable[[Design], dict[str, str]]
Around = Callable[[Stand, np.random.Generator], Iterable[Stand]]


@dataclass(frozen=True)
class Found:
    """The best candidate of a stand.

    candidate     one row
    goal          what was made least
    accepted      whether it keeps every limit and every rule
    evaluations   candidates that were looked at
    refused       why candidates were refused that would have been the best, by rule, check or field
    in_time       whether the search came to its own end
    """

    candidate: Candidates
    row: Array
    goal: float
    accepted: bool
    evaluations: int
    refused: dict[str, str]
    in_time: bool

    @property
    def half_width(self) -> float:
        return float(self.candidate.half_width[0])

    @cached_property
    def design(self) -> Design:
        return realised(self.candidate)


def refusals(design: Design) -> dict[str, str]:
    """Why a design is refused: all rules that it breaks, else the quick checks that it fails; or the field
    that its own file would be refused for."""
    try:
        parse(design_text(design), design.name)
    except InputError as error:
        return {error.where: str(error)}
    broken = {f"rule {f.check}": f.broken for f in broken_rules(design)}
    return broken or {f"check {f.check}": f.text for f in quick_failures(design)}


def all_refusals(design: Design) -> dict[str, str]:
    """`refusals`, and the checks that take a second."""
    return refusals(design) or {f"check {f.check}": f.text for f in slow_failures(design)}


def search(
    stand: Stand,
    goal: Goal,
    *,
    rules: Refusals | None = all_refusals,
    start: Array | None = None,
    evolve: bool = True,
    within: float = 1e-4,
    until: float = inf,
    around: Around = others,
) -> Found:
    """The candidate of a stand with the least goal.

    Parameters
    ----------
    stand
        Parameters that are not searched.
    goal
        Minimised over candidates that keep every limit, (candidates,).
    rules
        Why a design is refused; None if the best is not to be checked.
    start
        A candidate's numbers to start from.
    evolve
        False: search only the neighbourhood of `start`.
    within
        Spread of the population's goals, relative, at which evolution stops: further generations would
        change the answer by less.
    until
        Of `time.perf_counter`; then the best so far is returned.
    around
        Stands that are tried beside a given one, on a body.
    """
    if stand.on_layer:
        return _on_layer(stand, goal, rules, start, evolve, until, around)
    low, high = stand.limits
    high = np.maximum(low, high)
    refused: dict[str, str] = {}
    tried: dict[tuple[str, bytes], bool] = {}
    looked, in_time = 0, True
    least = (inf, np.rint((low + high) / 2.0))  # goal and numbers of the best, whether it keeps limits or not
    kept: list[tuple[float, Array]] = []  # of the best that keep them, one after the other

    def over(left: float = 0.0) -> bool:
        return time.perf_counter() > until - left

    def spent() -> bool:
        return over() or list(tried.values()).count(False) >= (REFUSED if evolve else REFUSED // 5)

    def keeps(row: Array, held: Refusals) -> bool:
        key = held.__name__, row.astype(int).tobytes()
        if key not in tried:
            why = held(realised(stand.candidates(row[np.newaxis])))
            refused.update(why)
            tried[key] = not why
        return tried[key]

    def value(numbers: Array, held: Refusals | None) -> Array:
        nonlocal least, looked
        rows = np.rint(numbers.T if numbers.ndim == 2 else numbers[np.newaxis])
        looked += len(rows)
        out = valued(stand, rows, goal)[1]
        for i in np.argsort(out):
            if out[i] < least[0]:
                least = float(out[i]), rows[i]
            if out[i] >= FAR or (kept and out[i] >= kept[-1][0] * (1.0 - WORTH if held else 1.0)):
                break
            if held and spent():
                break
            if held and not keeps(rows[i], held):
                out[i] = FAR * 0.9
                continue
            kept.append((float(out[i]), rows[i]))
            break
        return out

    def look(held: Refusals | None) -> None:
        descent = DESCENT * (until - time.perf_counter())

        def evolved(*_: object, **__: object) -> bool:
            nonlocal in_time
            in_time = not over(descent)
            return not in_time or (held is not None and not kept and spent())

        if evolve or start is None:
            differential_evolution(
                value,
                list(zip(low.astype(float), high.astype(float))),
                args=(held,),
                integrality=np.ones(len(low), bool),
                vectorized=True,
                updating="deferred",
                polish=False,
                callback=evolved,
                popsize=POPULATION,
                maxiter=GENERATIONS,
                tol=within,
                # from nowhere "best1bin" was caught up to 24 % above the best of a small problem; from a
                # design that was best for nearly the same target it is quicker
                strategy="rand1bin" if start is None else "best1bin",
                mutation=(0.3, 0.7) if start is None else (0.4, 0.9),
                recombination=0.8,
                init="sobol",
                x0=None if start is None else np.clip(start, low, high),
                rng=np.random.default_rng(SEED),
            )
        else:
            value(np.clip(start, low, high), held)
        before = inf
        while not over() and (now := (kept[-1] if kept else least))[0] < before:
            before = now[0]
            value(np.unique(np.clip(now[1] + moves(len(low)), low, high), axis=0).T, held)

    every = () if rules is None else (refusals, rules) if rules is not refusals else (rules,)
    accepted = False
    for held in (None, *every):
        if held is refusals is not rules and keeps(kept[-1][1], refusals):
            continue  # what refuses the best are the slow checks
        earlier, kept = kept, []
        look(held)
        accepted = bool(kept) and (rules is None or keeps(kept[-1][1], rules))
        if accepted or over() or not (earlier or kept):
            break
    if rules and not accepted:  # some of what was best before, the latest first
        passed = [*earlier, *kept][::-1]
        some = passed[:: 1 + len(passed) // LOOKED_BACK]
        kept = next(([one] for one in some if keeps(one[1], rules)), [])
        accepted = bool(kept)
    reached, row = kept[-1] if accepted else least
    candidate = stand.candidates(row[np.newaxis])
    return Found(candidate, row, reached, accepted, looked, refused, in_time)


def valued(at: Stand, rows: Array, goal: Goal) -> tuple[Candidates, Array]:
    """The candidates, and what is made least: their goal, or FAR and above where they miss limits."""
    c = at.candidates(rows)
    with np.errstate(all="ignore"):
        bad, wanted = c.violation, goal(c)
        value = np.where(bad > 0.0, FAR * (1.0 + np.minimum(bad, 1e3)), wanted)
    return c, np.where(np.isfinite(value), value, FAR * 1e4)


@lru_cache
def moves(count: int) -> Array:
    """Steps from a candidate of so many numbers to those around it, (candidates, numbers)."""
    unit = np.eye(count)
    alone = [step * unit for step in (*BY, *FURTHER)]
    both = [a * unit[i] + b * unit[j] for i, j in combinations(range(count), 2) for a, b in product(BY, BY)]
    several = np.random.default_rng(SEED).choice((0, 0, 0, *BY), (SEVERAL, count))
    return np.vstack([*alone, *both, several])


def _on_layer(
    stand: Stand,
    goal: Goal,
    rules: Refusals | None,
    start: Array | None,
    evolve: bool,
    until: float,
    around: Around,
) -> Found:
    """From a start, or from the best on springs, go to the first better neighbour, in a random order, until
    none is better; `evolve` also tries other orders of kinds, pitches and pads."""
    began, looked, starts = time.perf_counter(), 0, list[Array]()
    if start is not None:
        starts = [start]
    else:
        low, high = stand.target.room.elements
        # without an inclination more elements are better
        some = {high} if not stand.target.object.angle[1] else {low, round((low * high) ** 0.5), high}
        for n in sorted(some, reverse=True):
            of = replace(stand, springs=True, target=stand.target.with_("room.elements", (n, n)))
            share = GUESS * (until - began) / len(some)
            guess = search(of, goal, rules=None, within=GUESSED, until=time.perf_counter() + share)
            starts.append(guess.row)
            looked += guess.evaluations
    rng, why = np.random.default_rng(SEED), dict[str, str]()
    best, passed = (inf, stand, starts[0]), list[tuple[float, Stand, Array]]()
    decided_by: tuple[int, ...] = ()

    def worth() -> float:
        """What a candidate must be below; where limits are missed, by how much they are counts alone."""
        base = FAR if best[0] >= FAR else 0.0
        return base + (best[0] - base) * (1.0 - WORTH)

    def better(at: Stand, few: Stand, rows: Array) -> bool:
        nonlocal best, looked, decided_by
        looked += len(rows)
        # no candidate is better than at the few poses that decide the best: most need no others
        if few.tried:
            rows = rows[valued(few, rows, goal)[1] < worth()]
        c, value = valued(at, rows, goal)
        for i in np.argsort(value):
            if not value[i] < worth():
                return False
            if value[i] < FAR and rules:
                if refused := refusals(realised(at.candidates(rows[i : i + 1]))):
                    why.update(refused)
                    continue
            best, decided_by = (float(value[i]), at, rows[i]), c.decided_by.get(int(i), decided_by)
            if value[i] < FAR:
                passed.append(best)
            return True
        return False

    def descend(until: float) -> None:
        moved = True
        while moved and time.perf_counter() < until:
            moved, (_, at, row) = False, best
            low, high = at.limits
            some = np.unique(np.clip(row + few_moves(len(row)), low, np.maximum(low, high)), axis=0)
            parts = np.array_split(rng.permutation(some), max(len(some) // AT_ONCE, 1))
            few = replace(at, tried=decided_by)
            steps = [(at, few, part) for part in parts]
            if evolve:
                steps += [(o, replace(o, tried=decided_by), row[np.newaxis]) for o in around(at, rng)]
            for k in rng.permutation(len(steps)):
                if time.perf_counter() > until:
                    break
                if better(*steps[k]):
                    moved = True
                    break

    ends = []
    for left, first in zip(range(len(starts), 0, -1), starts):
        best, now = (inf, stand, first), time.perf_counter()
        better(stand, stand, first[np.newaxis])
        descend(now + (until - now) / (left + 0.5))
        ends.append(best)
    best = min(ends, key=lambda end: end[0])
    descend(until)
    passed.sort(key=lambda one: -one[0])
    accepted = bool(passed)
    if rules and rules is not refusals and passed:
        tries = passed[::-1][:: 1 + len(passed) // LOOKED_BACK]
        whys = [(one, rules(realised(one[1].candidates(one[2][np.newaxis])))) for one in tries[:1]]
        for one in tries[1:]:
            if not whys[-1][1]:
                break
            why.update(whys[-1][1])
            whys.append((one, rules(realised(one[1].candidates(one[2][np.newaxis])))))
        best, refused = whys[-1]
        accepted = not refused
    value, at, row = best
    in_time = time.perf_counter() < until
    return Found(at.candidates(row[np.newaxis]), row, value, accepted, looked, why, in_time)


@lru_cache
def few_moves(count: int) -> Array:
    """Steps of one number, and a few of several by chance."""
    alone = [step * np.eye(count) for step in (*BY, *FURTHER)]
    several = np.random.default_rng(SEED).choice((0, 0, 0, *BY), (FEW, count))
    return np.vstack([*alone, several])
