"""The least half-width of K_obj that an array can have, against the angle at which the object's face may lie:
a table of docs/targets.md.

    python benchmarks/angle_front.py docs/targets.md    15 minutes of three cores; set OMP_NUM_THREADS=1

Three starts draw from other random numbers, and none sees another's answers. Every element has an arm and a
hinge of its own. A linear program takes the step that lowers the half-width at its worst poses most, within a
distance that follows from how well the last step was foretold. Each start goes up through the angles and
down again. At each angle it first looks for arrays that are their own mirror image along and across the
rows, on pads of every size and with fewer elements; then the elements go their own ways, and kicks of random
size follow, for a pad that loses contact makes a step in the half-width that no derivative shows. The numbers
are then rounded to what a drawing states, and searched again under all rules. If a start does not keep every
limit, the table names the one that it misses most, and by how much. A search is ended by processor time, so
that other work on the machine does not change it.
"""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf
from typing import NamedTuple

import numpy as np
from measuring import ROOT
from scipy.optimize import linprog
from tables import lines, write_tables

from tactcad.contact.stated_errors import LINEAR_REACH
from tactcad.design.messages import InputError
from tactcad.mechanics import validity
from tactcad.mechanics.register import ladder_data
from tactcad.synthesis import bounds
from tactcad.synthesis.candidates import LEAST_STEPS, POINTS, RADIUS, SLOT, Candidates, Stand, stands
from tactcad.synthesis.made_arrays import MadeSensor
from tactcad.synthesis.on_layer import AROUND, CLEAR, CandidatesOnLayer
from tactcad.synthesis.search import Found, refusals, search, valued
from tactcad.synthesis.synthesise import ARRAYS_ON_BODY, goal_of
from tactcad.synthesis.target import ARM, THICKNESS, Target, read_target

TARGET = ROOT / "hardware" / "targets" / "tissue-array.toml"
ANGLES = (0, 1, 2, 4, 6, 8)  # degrees
SEEDS = (1, 2, 3)  # of the starts
PADS, FINER = (1.75, 2.5, 3.25, 4.0), (-0.5, -0.25, 0.25, 0.5)  # mm, tried first; and beside the best
FEWER = (6, 8)  # elements
ROUNDINGS, DRAWS = 200, 20  # that are tried
AT_ONCE = 0.5  # degrees, by which a found array is taken to a larger angle
# s of one core: from each mirrored start; with mirrors given up; by kicks; rounded; on the way down
MIRRORED, OWN, KICKS, ROUNDED, DOWN = 3.0, 4.0, 10.0, 10.0, 5.0
# What may vary: all that the paper's clamp and read-out leave free.
FREE = {
    "room.elements": (3, 10),
    "room.pitch": 1.8,
    "room.length": 2000.0,
    "room.width": 2000.0,
    "elements.pads": (1.5, 8.0),
    "elements.arms": (4.0, 12.0),
}
FORCES = (0.1, 10.0)  # N, on the whole array; the largest in an accident is OVERLOAD times as large
OVERLOAD = 6.0 / 3.4  # as of TARGET
APART = (3.2, 8.0)  # mm, pitch: the sheet and the least gap at least; between facing pads it is CLEAR to 8
KEPT = 0.975  # of the arrays built keep the half-width that is told; of TARGET's share half of what may fail
NOT_TOLD = ("elements.kinds", "elements.of_a_kind", "room.elements[1]")  # bounds that are starts or costs
HEADS = "angle, degrees | half-width by start, % | 97.5 % of arrays keep, % | elements | kinds"
# Derivatives are taken over SMALL of each number's scale; a step of less than LEAST of it ends a climb;
# MARGIN keeps ratios of the estimator's range off their ends.
SMALL, LEAST, MARGIN = 1e-3, 2e-3, 2e-3
GAIN = 0.995  # of the half-width at least, for mirrors to be given up
UNBOUNDED = 2.0  # half-width, relative, that counts for any larger one
SCALES = {
    "arm": 2.0,
    "log thickness": 0.3,
    "slot": 0.4,
    "radius": 0.2,
    "pitch": 1.0,
    "gap": 1.0,
    "log force": 0.4,
}


class AtPoses(CandidatesOnLayer):
    """Candidates whose numbers need not be whole, with what each is at every pose."""

    @property
    def steps(self) -> np.ndarray:
        return self.borne

    def feel(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        width, force, _ = Candidates.feel(self)
        self.widths, self.depths = np.full((2, len(width), len(self.at.modulus)), inf)
        for i in np.flatnonzero(np.isfinite(self.elements.stiffness).all(axis=1)):
            try:
                self.widths[i], self.depths[i], of_kinds = self.pressed(int(i))
            except (InputError, np.linalg.LinAlgError):
                continue
            force[i] = of_kinds.max(0)
        return self.widths.max(1), force, self.depths.max(1)

    @cached_property
    def excess(self) -> np.ndarray:
        """Over every limit: of an element, a pose, or the estimator's range, [candidate, limit]."""
        of, shape = self.of_kinds, self.arm.shape
        parts = [of["grasp.element_force"], of["strength"], np.log(1.0 + of["stop"]), of["readout"]]
        parts += [LEAST_STEPS / np.maximum(self.steps, 0.1) - 1.0, self.depths / LINEAR_REACH - 1.0]
        sampled, groups = ladder_data()["range"], validity.PLANE_GROUPS | validity.WIDTH_GROUPS
        for s in (self.section, *self.at_limits):
            slot = s.hinge_thickness + s.notch_sides * s.fillet_radius
            ratios = [sampled["least_height"] * slot / s.arm_height, 2.0 * s.fillet_radius / s.hinge_length]
            ratios += [sampled["least"][name] / value(s) for name, (_, value, _) in validity.LEAST.items()]
            for name, (low, high) in sampled["groups"].items():
                ratios += [low / groups[name](s), groups[name](s) / high]
            parts += [np.broadcast_to(ratio, shape) - 1.0 + MARGIN for ratio in ratios]
        return np.concatenate(parts, axis=1)


class End(NamedTuple):
    """Of a climb: half-width and excess in one number, the numbers, their space, and half-width and excess
    at each pose and limit."""

    worth: float
    x: np.ndarray
    of: Space
    widths: np.ndarray
    excess: np.ndarray


@dataclass(frozen=True)
class Space:
    """What is searched at one angle (degrees) with so many elements and one pad length (mm): arm and log
    thickness of every element, slot, radius, pitch, gap, log force. `mirrored`: of a quarter of them."""

    target: Target
    angle: float
    pad: float
    elements: int = 10
    mirrored: bool = True

    @cached_property
    def stand(self) -> Stand:
        some = self.target.with_("room.elements", (self.elements, self.elements))
        some = some.with_("elements.kinds", self.elements).with_("object.angle", (0.0, self.angle))
        # a quarter of all directions does for an array that is its own mirror image both ways
        ends = range(POINTS, POINTS + 2 * AROUND if self.angle else POINTS, AROUND)
        few = [*range(POINTS), *(n + k for n in ends for k in range(AROUND // 4 + 1))]
        return replace(stands(some)[-1], tried=tuple(few) if self.mirrored else ())

    @cached_property
    def own(self) -> np.ndarray:
        """Which of the free elements each element is."""
        half = np.arange(self.elements // 2)
        row = np.minimum(half, half[::-1])
        return np.concatenate([row, row]) if self.mirrored else np.arange(self.elements)

    @cached_property
    def free(self) -> int:
        return int(self.own.max()) + 1

    @cached_property
    def scale(self) -> np.ndarray:
        return np.repeat([*SCALES.values()], [self.free, self.free, *[1] * (len(SCALES) - 2)])

    @cached_property
    def limits(self) -> tuple[np.ndarray, np.ndarray]:
        base, out = self.stand.base, []
        # by rule gauge_fits_face
        clears = self.pad + base.element.pad_root_radius + base.gauge.carrier_arm_side
        for end, row in enumerate(self.stand.limits):
            arm = max(row[0] * ARM, clears)
            hinge = [arm] * self.free + [np.log(row[1] * THICKNESS)] * self.free
            gap, force = (CLEAR, APART[1])[end], np.log(FORCES[end])
            out.append(np.array([*hinge, row[-2] * SLOT, row[-1] * RADIUS, APART[end], gap, force]))
        return out[0], out[1]

    def placed(self, pitch: float, gap: float, force: float) -> Stand:
        d, target = self.stand.base, self.stand.target.with_("grasp.force", force)
        target = target.with_("grasp.overload", round(force * OVERLOAD, 6))
        spacer = round(pitch - d.sheet.thickness, 6)
        array = replace(d.array, pitch=pitch, spacer=spacer, row_pitch=round(self.pad + gap, 6))
        rating = replace(d.rating, overload_force=target.grasp.overload)
        base = replace(d, array=array, element=replace(d.element, pad_length=self.pad), rating=rating)
        return replace(self.stand, target=target, base=base)

    def hinges(self, x: np.ndarray) -> dict[str, np.ndarray]:
        """Of `Candidates`, of rows of numbers."""
        arm, thickness, rest = np.split(x, [self.free, 2 * self.free], axis=1)
        of = {"arm": arm[:, self.own], "thickness": np.exp(thickness[:, self.own])}
        return of | {"count": np.ones((len(x), self.elements)), "slot": rest[:, 0], "radius": rest[:, 1]}

    def values(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Half-width at every pose and excess over every limit, of rows of numbers."""
        parts = []
        for place in dict.fromkeys(map(tuple, x[:, -3:])):  # those on one stand at a time
            rows = np.flatnonzero((x[:, -3:] == place).all(1))
            pitch, gap, force = map(float, place)
            stand = self.placed(pitch, gap, float(np.exp(force)))
            with np.errstate(all="ignore"):
                c = AtPoses(stand, **self.hinges(x[rows]))
                c.felt  # noqa: B018
                parts.append((rows, c.widths, np.where(np.isfinite(c.excess), c.excess, 10.0)))
        order = np.argsort(np.concatenate([rows for rows, _, _ in parts]))
        return np.concatenate([w for _, w, _ in parts])[order], np.concatenate([e for _, _, e in parts])[
            order
        ]

    def end(self, x: np.ndarray) -> End:
        x = np.clip(x, *self.limits)
        widths, excess = (v[0] for v in self.values(x[np.newaxis]))
        return End(worth(widths, excess), x, self, widths, excess)

    def derivatives(self, at: End) -> tuple[np.ndarray, np.ndarray]:
        step = SMALL * self.scale
        step = np.where(at.x + step > self.limits[1], -step, step)
        # in one batch with where they start: an estimator's rounding can follow the batch
        widths, excess = self.values(np.vstack([at.x, at.x + np.diag(step)]))
        with np.errstate(invalid="ignore"):
            return ((widths[1:] - widths[0]).T / step), ((excess[1:] - excess[0]).T / step)

    def released(self, x: np.ndarray) -> np.ndarray:
        """The numbers of the same array without its mirrors."""
        return np.concatenate(
            [x[: self.free][self.own], x[self.free : 2 * self.free][self.own], x[2 * self.free :]]
        )


def worth(widths: np.ndarray, excess: np.ndarray) -> float:
    return min(float(widths.max()), UNBOUNDED) + float(np.maximum(excess, 0.0).sum())


def climb(end: End, until: float, trust: float = 0.5) -> End:
    """By linear programs, to where no step within `trust` of the scales is better."""
    of = end.of
    (low, high), n = of.limits, len(end.x)
    while trust > LEAST and time.process_time() < until:
        by_w, by_e = of.derivatives(end)
        told = np.isfinite(by_w).all(1)
        near = (end.excess > -1.0) & (end.excess < 9.0) & np.isfinite(by_e).all(1)
        ones, none = -np.ones((told.sum(), 1)), np.zeros((near.sum(), 1))
        rows = np.vstack(
            [
                np.hstack([by_w[told] * of.scale, ones, 0.0 * ones]),
                np.hstack([by_e[near] * of.scale, none, none - 1.0]),
            ]
        )
        right = -np.concatenate([end.widths[told], end.excess[near]])
        before = end.worth
        while trust > LEAST and time.process_time() < until:
            room = np.maximum((low - end.x) / of.scale, -trust), np.minimum((high - end.x) / of.scale, trust)
            ends = [*zip(*room), (None, None), (0.0, None)]
            step = linprog([*np.zeros(n), 1.0, 30.0], A_ub=rows, b_ub=right, bounds=ends)
            if step.status == 0:
                new = of.end(end.x + step.x[:n] * of.scale)
                if new.worth < end.worth:
                    foretold = end.worth - step.x[n]
                    good = (end.worth - new.worth) / max(foretold, 1e-12)
                    end, trust = new, min(trust * (2.0 if good > 0.7 else 0.6 if good < 0.3 else 1.0), 1.0)
                    break
            trust /= 3.0
        if before - end.worth < 1e-4 * before:
            break
    return end


def kicked(end: End, rng: np.random.Generator, until: float) -> End:
    """Moves a few numbers at random, or lets two elements change places, and climbs where that is not much
    worse."""
    of, n = end.of, end.of.free
    while time.process_time() < until:
        size = 10.0 ** rng.uniform(-2.3, -0.3)
        x = end.x + rng.normal(size=len(end.x)) * size * of.scale * (
            rng.random(len(end.x)) < rng.uniform(0.1, 0.6)
        )
        if rng.random() < 0.25:
            i, j = rng.choice(n, 2, replace=False)
            x[[i, j, n + i, n + j]] = x[[j, i, n + j, n + i]]
        new = of.end(x)
        if end.worth < new.worth < 1.25 * end.worth and rng.random() < 0.15:
            new = climb(new, min(until, soon(MIRRORED)), max(size, 0.03))
        end = min(end, new, key=lambda e: e.worth)
    return end


def by_chance(of: Space, rng: np.random.Generator) -> End:
    """Any array, not too far from what can be made, and with an end to its intervals if one is soon found."""
    for _ in range(DRAWS):
        x = rng.uniform(*of.limits)
        x[of.free : 2 * of.free] = np.log(rng.uniform(0.2, 0.45, of.free))
        shared = rng.uniform((0.8, 0.2, APART[0], CLEAR, 0.3), (1.6, 0.4, 4.5, 2.0, 2.0))
        x[2 * of.free :] = *shared[:-1], np.log(shared[-1])
        end = of.end(x)
        if np.isfinite(end.widths).all():
            break
    return end


def rounded(end: End) -> Found:
    """In a drawing's steps, searched again under all rules."""
    of, (pitch, gap, force) = end.of, end.x[-3:]

    def placed(pitch: float, gap: float, force: float) -> Stand:
        at = of.placed(round(max(pitch, APART[0]), 6), round(max(gap, CLEAR), 6), float(f"{force:.2g}"))
        return replace(at, target=at.target.with_("room.elements", FREE["room.elements"]), tried=())

    stand = placed(round(float(pitch), 2), round(float(gap), 2), float(np.exp(force)))
    # every number up or down by chance, the nearer the more often, a mirrored one with its mirrors
    step = np.repeat([ARM, THICKNESS, SLOT, RADIUS], [of.free, of.free, 1, 1])
    hinge = np.concatenate([end.x[: of.free], np.exp(end.x[of.free : 2 * of.free]), end.x[-5:-3]]) / step
    some = np.floor(hinge + np.random.default_rng(of.elements).random((ROUNDINGS, len(hinge))))
    some[0] = np.rint(hinge)
    arm, thickness, shared = np.split(some, [of.free, 2 * of.free], axis=1)
    each = np.stack([arm[:, of.own], thickness[:, of.own], np.ones((ROUNDINGS, of.elements))], axis=2)
    rows = np.clip(np.hstack([each.reshape(ROUNDINGS, -1), shared]), *stand.limits)
    row = rows[valued(stand, rows, goal_of(stand.target))[1].argmin()]

    def around(at: Stand, _: np.random.Generator) -> Iterator[Stand]:
        a, force = at.base.array, at.target.grasp.force
        own = round(a.row_pitch - of.pad, 6)
        for by in (0.93, 0.97, 1.03, 1.08):
            yield placed(a.pitch, own, force * by)
        for step in (-0.2, -0.05, 0.05, 0.2):
            yield placed(a.pitch + step, own, force)
            yield placed(a.pitch, own + step, force)

    until = soon(ROUNDED)
    return search(stand, goal_of(stand.target), rules=refusals, start=row, until=until, around=around)


def turned(end: End, angle: float) -> End:
    """A found array taken to a larger angle: far from one most intervals have no end, and nothing tells
    which way is better."""
    while end.of.angle < angle:
        of = replace(end.of, angle=min(end.of.angle + AT_ONCE, angle))
        end = climb(of.end(end.x), soon(MIRRORED))
    return end


def soon(seconds: float) -> float:
    return time.process_time() + seconds


def best_of(ends: list[End]) -> End:
    return min(ends, key=lambda e: e.worth)


def up(target: Target, angle: float, before: list[End], rng: np.random.Generator) -> list[End]:
    """The best mirrored array at an angle, and the best; from the two of the angle before."""
    tried = []
    for pad in PADS:
        of = Space(target, angle, pad)
        tried += [climb(by_chance(of, rng), soon(MIRRORED)) for _ in range(2 if before else 3)]
        tried += [turned(replace(e.of, pad=pad).end(e.x), angle) for e in before[:1]]
    tried += [turned(e, angle) for e in before[:1]]
    best, moved = best_of(tried), True
    tried += [climb(by_chance(replace(best.of, elements=n), rng), soon(MIRRORED)) for n in FEWER]
    looked = set[float]()
    while moved:
        near = [best.of.pad + step for step in FINER]
        near = [pad for pad in near if FREE["elements.pads"][0] <= pad <= FREE["elements.pads"][1]]
        beside = [climb(replace(best.of, pad=p).end(best.x), soon(MIRRORED)) for p in near if p not in looked]
        looked |= {*near}
        tried += beside
        moved = best_of(tried) is not best
        best = best_of(tried)
    tried.append(kicked(best, rng, soon(KICKS)))
    tried.sort(key=lambda e: e.worth)
    best, starts = tried[0], [turned(e, angle) for e in before[1:] if not e.of.mirrored]
    starts.append(replace(best.of, mirrored=False).end(best.of.released(best.x)))
    own = kicked(best_of([climb(e, soon(OWN)) for e in starts]), rng, soon(KICKS))
    return [best, own if own.worth < best.worth * GAIN else best]


def start(seed: int) -> list[Found]:
    """By angle."""
    time.perf_counter = time.process_time  # of `search`
    target, rng = read_target(TARGET), np.random.default_rng(seed)
    for name, value in FREE.items():
        target = target.with_(name, value)
    way, ends = list[End](), list[End]()
    begun = time.process_time()
    for angle in ANGLES:
        way = up(target, float(angle), way, rng)
        ends.append(way[1])
        print(
            f"start {seed}, {angle} degrees: {100 * way[0].worth:.3g} % mirrored, "
            f"{100 * way[1].worth:.3g} %, pads {way[1].of.pad:g} mm, {time.process_time() - begun:.0f} s",
            flush=True,
        )
    found = [rounded(ends[-1])]
    for n in range(len(ANGLES) - 2, -1, -1):
        down = climb(replace(ends[n + 1].of, angle=float(ANGLES[n])).end(ends[n + 1].x), soon(DOWN))
        ends[n] = kicked(best_of([ends[n], down]), rng, soon(DOWN))
        found.append(rounded(ends[n]))
        print(
            f"start {seed}, {ANGLES[n]} degrees: {100 * ends[n].worth:.3g} %, rounded {said(found[-1])}",
            flush=True,
        )
    return found[::-1]


def said(found: Found) -> str:
    if found.accepted:
        return f"{100 * found.half_width:.3g}"
    misses = {name: float(miss[0]) for name, miss in found.candidate.misses.items()}
    name = max(misses, key=misses.__getitem__)
    return f"{name} +{100 * misses[name]:.2g} %"


def row_of(angle: int, starts: tuple[Found, ...]) -> tuple:
    """Of the table."""
    best = min(starts, key=lambda found: (not found.accepted, found.goal))
    stand = best.candidate.stand
    on, kept = [], "none"
    if best.accepted:
        on = [name for name in bounds.touched(best) if name not in NOT_TOLD]
        kept = f"{100 * MadeSensor(stand.target, best.design).kept_by(KEPT, ARRAYS_ON_BODY):.3g}"
    return (
        angle,
        "; ".join(said(one) for one in starts),
        kept,
        int(best.candidate.total[0]),
        int(best.candidate.different[0]),
        f"{stand.base.element.pad_length:g}",
        f"{stand.target.grasp.force:g}",
        ", ".join(on),
    )


def front() -> str:
    with ProcessPoolExecutor(len(SEEDS), multiprocessing.get_context("fork")) as pool:
        by_start = list(pool.map(start, SEEDS))
    return lines(
        f"{HEADS} | pad, mm | force, N | lies on",
        [row_of(angle, of) for angle, *of in zip(ANGLES, *by_start)],
    )


if __name__ == "__main__":
    raise SystemExit(write_tables(__doc__, {"angle front": front}))
