"""The least half-width of K_obj that an array can have, against the angle at which the object's face may lie:
a table of docs/targets.md.

    python benchmarks/angle_front.py docs/targets.md    30 minutes of one core; set OMP_NUM_THREADS=1

Three starts differ in number of elements, places of the kinds, pitches, pads and force, and none sees
another's answers. Each goes through the angles from 0 up: its answer at one angle is where it starts at the
next. There it first tries pads of every size for a short time, since from one size to another no single step
leads on, and goes on from the best two. An array for a larger angle does for a smaller one too. If a start
does not keep every limit, the table names the one that it misses most, and by how much. A search is ended by
processor time, so that other work on the machine does not change it.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from measuring import ROOT
from tables import lines, write_tables

from tactcad.synthesis import bounds
from tactcad.synthesis.candidates import Stand, stands
from tactcad.synthesis.made_arrays import MadeSensor
from tactcad.synthesis.on_layer import others
from tactcad.synthesis.search import BY, Found, refusals, search
from tactcad.synthesis.synthesise import ARRAYS_ON_BODY, goal_of
from tactcad.synthesis.target import ARM, Target, read_target

TARGET = ROOT / "hardware" / "targets" / "tissue-array.toml"
ANGLES = (0, 1, 2, 4, 6, 8)  # degrees
STARTS = ((10, 3, 3.0, 3.4), (8, 3, 4.0, 2.0), (5, 3, 2.0, 1.0))  # elements, kinds, pad in mm, force in N
GUESS, FIRST, SEARCH = 6.0, 7.0, 34.0  # s of one core: on springs; by each of PADS; after these
PADS = (1.5, 1.75, 2.0, 2.25, 2.75, 3.25, 4.0)  # mm
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
KEPT = 0.975  # of the arrays built keep the half-width that is told; of TARGET's share half of what may fail
NOT_TOLD = ("elements.kinds", "elements.of_a_kind", "room.elements[1]")  # bounds that are starts or costs
HEADS = "angle, degrees | half-width by start, % | 97.5 % of arrays keep, % | elements | pad, mm | force, N"


def with_force(stand: Stand, force: float) -> Stand:
    force = float(f"{min(max(force, FORCES[0]), FORCES[1]):.2g}")
    target = stand.target.with_("grasp.force", force).with_("grasp.overload", round(force * OVERLOAD, 3))
    rating = replace(stand.base.rating, overload_force=target.grasp.overload)
    return replace(stand, target=target, base=replace(stand.base, rating=rating))


def around(stand: Stand, rng: np.random.Generator) -> Iterator[Stand]:
    """As `others`; on other pads with the same gap between rows and the force that goes with their area; with
    another force."""
    yield from others(stand, rng)
    d, (least, most), force = stand.base, FREE["elements.pads"], stand.target.grasp.force
    for step in (-1.0, -0.25, 0.25, 1.0):
        length = round(d.element.pad_length + step, 6)
        array = replace(d.array, row_pitch=round(d.array.row_pitch + step, 6))
        if least <= length <= most and array.row_pitch >= FREE["room.pitch"]:
            base = replace(d, array=array, element=replace(d.element, pad_length=length))
            yield with_force(replace(stand, base=base), force * length / d.element.pad_length)
    for factor in (0.5, 0.8, 0.93, 1.08, 1.25, 2.0):
        yield with_force(stand, force * factor)


def started(target: Target, elements: int, kinds: int, pad: float, force: float) -> tuple[Stand, np.ndarray]:
    """A start of its own: the best on springs of so many elements with such pads."""
    some = target.with_("room.elements", (elements, elements)).with_("elements.kinds", kinds)
    of = with_force(stands(some)[-1], force)
    d, apart = of.base, max(target.room.pitch, pad + 0.5)
    array, element = replace(d.array, row_pitch=apart), replace(d.element, pad_length=pad)
    of = replace(of, base=replace(d, array=array, element=element))
    until = time.process_time() + GUESS
    guess = search(replace(of, springs=True), goal_of(target), rules=None, until=until)
    free = with_force(replace(of, target=target.with_("elements.kinds", kinds)), force)
    return free, guess.row


def on_pads(stand: Stand, row: np.ndarray, length: float) -> tuple[Stand, np.ndarray]:
    """Other pads with the same gap between rows, the force that goes with their area, and hinges as far from
    the pads' edges."""
    d, more = stand.base, length - stand.base.element.pad_length
    array = replace(d.array, row_pitch=round(max(d.array.row_pitch + more, FREE["room.pitch"]), 6))
    base = replace(d, array=array, element=replace(d.element, pad_length=length))
    row = row.astype(float)
    row[: 3 * stand.kinds : 3] += round(more / 2.0 / ARM)
    at = with_force(replace(stand, base=base), stand.target.grasp.force * length / d.element.pad_length)
    return at, np.clip(row, at.limits[0], np.maximum(*at.limits))


def same_pads(stand: Stand, rng: np.random.Generator) -> Iterator[Stand]:
    length = stand.base.element.pad_length
    return (o for o in around(stand, rng) if o.base.element.pad_length == length)


def answer(stand: Stand, row: np.ndarray, angle: float) -> Found:
    """The best from a start; where the search comes to its end, again from near the best, until time is
    over."""
    stand = replace(stand, target=stand.target.with_("object.angle", (0.0, angle)))
    goal, rng = goal_of(stand.target), np.random.default_rng(len(row))
    begun = []
    for length in sorted({*PADS, stand.base.element.pad_length}):
        at, first = on_pads(stand, row, length)
        until = time.process_time() + FIRST
        begun.append(search(at, goal, rules=refusals, start=first, until=until, around=same_pads))
    ends = []
    for begin in sorted(begun, key=worth)[:2]:
        best, at, first = begin, begin.candidate.stand, begin.row
        until = time.process_time() + SEARCH / 2
        while time.process_time() < until:
            found = search(at, goal, rules=refusals, start=first, until=until, around=around)
            best = min((best, found), key=worth)
            at, first = best.candidate.stand, best.row + rng.choice((0, 0, *BY), len(best.row))
            at = with_force(at, at.target.grasp.force * rng.choice((0.7, 1.0, 1.4)))
            first = np.clip(first, *at.limits)
        ends.append(best)
    return min(ends, key=worth)


def worth(found: Found) -> tuple[bool, float]:
    return not found.accepted, found.goal


def said(found: Found) -> str:
    if found.accepted:
        return f"{100 * found.half_width:.3g}"
    misses = {name: float(miss[0]) for name, miss in found.candidate.misses.items()}
    name = max(misses, key=misses.__getitem__)
    return f"{name} +{100 * misses[name]:.2g} %"


def row_of(angle: int, starts: list[Found]) -> tuple:
    """Of the table."""
    best = min(starts, key=worth)
    stand = best.candidate.stand
    on, kept = [], float("nan")
    if best.accepted:
        on = [name for name in bounds.touched(best) if name not in NOT_TOLD]
        target = stand.target.with_("object.angle", (0.0, float(angle)))
        kept = MadeSensor(target, best.design).kept_by(KEPT, ARRAYS_ON_BODY)
    return (
        angle,
        "; ".join(said(one) for one in starts),
        f"{100 * kept:.3g}",
        int(best.candidate.total[0]),
        f"{stand.base.element.pad_length:g}",
        f"{stand.target.grasp.force:g}",
        ", ".join(on),
    )


def front() -> str:
    target = read_target(TARGET)
    for field, value in FREE.items():
        target = target.with_(field, value)
    at, found = [started(target, *start) for start in STARTS], list[list[Found]]()
    for angle in ANGLES:
        found.append([answer(*one, float(angle)) for one in at])
        at = [(one.candidate.stand, one.row) for one in found[-1]]
        print(angle, [said(one) for one in found[-1]], flush=True)
    best = [[min(later, key=worth) for later in zip(*found[n:])] for n in range(len(ANGLES))]
    return lines(f"{HEADS} | lies on", [row_of(*one) for one in zip(ANGLES, best)])


if __name__ == "__main__":
    time.perf_counter = time.process_time  # of `search`
    raise SystemExit(write_tables(__doc__, {"angle front": front}))
