"""The least half-width of K_obj that an array can have, against the angle at which the object's face may lie:
a table of docs/targets.md.

    python benchmarks/angle_front.py docs/targets.md    an hour of one core; set OMP_NUM_THREADS=1

Each angle is searched from three starts of their own: another number of elements, other places of the kinds,
pitches and pads. If a start does not keep every limit, the table names the one that it misses most, and by
how much. What the best answer lies on is printed.
A search is ended by processor time, so that other work on the machine does not change it.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
from measuring import ROOT
from tables import lines, write_tables

from tactcad.synthesis import bounds
from tactcad.synthesis.candidates import Stand, stands
from tactcad.synthesis.search import Found, refusals, search
from tactcad.synthesis.synthesise import goal_of
from tactcad.synthesis.target import Target, read_target

TARGET = ROOT / "hardware" / "targets" / "tissue-array.toml"
# K_obj, N/mm; thickness, mm; angles, degrees
OBJECTS = (((1.0, 5.0), 6.0, (0, 1, 2, 3, 5, 8)), ((5.0, 20.0), 10.0, (0, 2, 5, 8)))
STARTS = ((10, 3.0), (8, 4.0), (5, 2.0))  # elements, pad length in mm
GUESS, SEARCH = 10.0, 120.0  # s of one core
# What may vary: all that the paper's clamp, read-out and axis leave free.
FREE = {
    "room.elements": (3, 10),
    "room.length": 2000.0,
    "room.width": 2000.0,
    "elements.pads": (1.5, 8.0),
    "elements.arms": (4.0, 12.0),
}
HEADS = "K_obj, N/mm | thickness, mm | angle, degrees | half-width by start, % | elements | pad, mm"


def started(target: Target, elements: int, pad: float) -> tuple[Stand, np.ndarray]:
    """A start of its own: the best on springs of so many elements with such pads."""
    of = stands(target.with_("room.elements", (elements, elements)))[-1]
    d, apart = of.base, max(target.room.pitch, pad + 0.5)
    array, element = replace(d.array, row_pitch=apart), replace(d.element, pad_length=pad)
    of = replace(of, base=replace(d, array=array, element=element))
    until = time.process_time() + GUESS
    guess = search(replace(of, springs=True), goal_of(target), rules=None, until=until)
    return replace(of, target=target), guess.row


def answer(target: Target, elements: int, pad: float) -> Found:
    stand, row = started(target, elements, pad)
    until = time.process_time() + SEARCH
    return search(stand, goal_of(target), rules=refusals, start=row, until=until)


def said(found: Found) -> str:
    if found.accepted:
        return f"{100 * found.half_width:.3g}"
    misses = {name: float(miss[0]) for name, miss in found.candidate.misses.items()}
    name = max(misses, key=misses.__getitem__)
    return f"{name} +{100 * misses[name]:.2g} %"


def front() -> str:
    rows = []
    for stiffness, thickness, angles in OBJECTS:
        target = read_target(TARGET).with_("object.stiffness", stiffness).with_("object.thickness", thickness)
        for field, value in FREE.items():
            target = target.with_(field, value)
        for angle in angles:
            all_found = [
                answer(target.with_("object.angle", (0.0, float(angle))), *start) for start in STARTS
            ]
            best = min(all_found, key=lambda f: (not f.accepted, f.goal))
            base, c = best.candidate.stand.base, best.candidate
            shown = "; ".join(said(one) for one in all_found)
            rows.append(
                (f"{stiffness[0]:g} to {stiffness[1]:g}", f"{thickness:g}", angle, shown, int(c.total[0]))
                + (f"{base.element.pad_length:g}",)
            )
            print(rows[-1], bounds.touched(best) if best.accepted else "", flush=True)
    return lines(HEADS, rows)


if __name__ == "__main__":
    time.perf_counter = time.process_time  # of `search`
    raise SystemExit(write_tables(__doc__, {"angle front": front}))
