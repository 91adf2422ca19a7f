"""Time from a target to its answer, and of arrays built virtually: the tables of docs/targets.md,
docs/benchmarks.md and docs/stack.md.

    python benchmarks/design_times.py docs/targets.md       some minutes
    python benchmarks/design_times.py docs/benchmarks.md    half an hour
    python benchmarks/design_times.py docs/stack.md         a few minutes

Processor time of one process, each case in turn: arrays of ten and forty elements against the number of free
numbers; arrays made against the width of the yield's interval; arrays built against their elements, a
constant time an element means time in proportion to the elements.
"""

from __future__ import annotations

import os
import time

import numpy as np
from measuring import ROOT, array_of, processor_seconds
from tables import lines, write_tables

from tactcad.mechanics.section import Array
from tactcad.stacks.virtual_build import sensor
from tactcad.synthesis.candidates import Candidates, stands
from tactcad.synthesis.made_arrays import MadeSensor
from tactcad.synthesis.search import search
from tactcad.synthesis.synthesise import Synthesis, design
from tactcad.synthesis.target import Target, parse_target, read_target

TARGET = ROOT / "hardware" / "targets" / "better-array.toml"
HEADS = "target | answer, processor s | by the clock, s | end, s | half-width, % | met"
TARGETS = 20
PAPER = """
    object.stiffness = [2.34, 10.01]
    grasp = {force = 13.04, overload = 13.04, element_force = 2.0}
    room = {elements = [2, 10], pitch = 4.0, length = 64.0, width = 40.0}
    """
BY_HAND = (
    """
    target = {name = "tissue", half_width = 15}
    object.stiffness = [3, 6]
    grasp = {force = 6, overload = 8}
    room = {elements = [4, 6], pitch = 4}
    elements = {arms = [5, 7], hinges = [0.25, 0.4]}
    """,
    """
    target = {name = "stainless"}
    object.stiffness = [1, 5]
    grasp = {force = 6, overload = 12}
    room = {elements = [12, 12], pitch = 3, length = 60, width = 40}
    stock = {alloys = ["1.4310-C1300"], sheets = [2.0]}
    """,
    f'target = {{name = "paper"}}{PAPER}',
    f'target = {{name = "paper-finer", half_width = 2}}{PAPER}',
)
ARRAYS = (500, 2000, 8000)
SIZES = (10, 40, 160, 1000)
ELEMENTS = 20_000  # built in a run of each size, so that each takes about as long


def target() -> Target:
    return read_target(TARGET)


def half_width(c: Candidates) -> Array:
    return c.half_width


def searches() -> str:
    """2 x 5 and 2 x 20, of two and of three kinds of element."""
    rows, wide = [], target().with_("room.width", 200.0)
    for elements in (10, 40):
        for kinds in (2, 3):
            here = wide.with_("room.elements", (elements, elements)).with_("elements.kinds", kinds)
            stand = stands(here)[-1]
            start = time.process_time()
            found = search(stand, half_width)
            seconds = time.process_time() - start
            name, each = f"2 x {elements // 2}, {kinds} kinds", 1e6 * seconds / found.evaluations
            shown = (f"{seconds:.2g}", f"{each:.3g}", f"{100 * found.half_width:.3g}")
            rows.append((name, len(stand.limits[0]), found.evaluations, *shown))
    return lines("array | free numbers | candidates | s | us a candidate | half-width, %", rows)


def yields() -> str:
    found = search(stands(target())[0], half_width, within=1e-2)
    made, rows = MadeSensor(target(), found.design), []
    for count in ARRAYS:
        start = time.process_time()
        built = made.built(count, 1.3 * found.half_width)
        seconds = time.process_time() - start
        low, high = (f"{100 * v:.4g}" for v in built.interval)
        rows.append((count, f"{seconds:.2g}", f"{100 * built.share:.4g}", f"{low} to {high}"))
    return lines("arrays, of two distributions | s | yield, % | its interval, %", rows)


def virtual_builds() -> str:
    rows, first = [], 0.0
    for elements in SIZES:
        made, count = sensor(array_of(elements), ()), ELEMENTS // elements
        made.built(2)  # load all modules once
        seconds = processor_seconds(lambda: made.built(count))
        each = seconds / (3 * count * elements)
        first = first or each
        shown = (f"{seconds:.2g}", f"{3 * count / seconds:.3g}", f"{each / first:.2f}")
        rows.append((elements, 3 * count, *shown))
    heads = "elements | arrays, of three distributions | s | arrays a second | s an element, relative"
    return lines(heads, rows)


def asked(n: int) -> str:
    """One of the twenty targets: four by hand, the others by chance."""
    if n < len(BY_HAND):
        return BY_HAND[n]
    rng = np.random.default_rng((20261125, n))

    def between(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    soft, elements, sheet = between(0.5, 30.0), int(rng.integers(4, 11)), rng.choice([2, 3, 4])
    force = elements * sheet / 3.0 * between(0.3, 2.0)
    arm, hinge, width = rng.uniform(3.0, 7.0), between(0.12, 0.3), rng.choice([0, 0, 3, 6, 12, 25])
    least = rng.choice(["width", "room", "kinds", "cut", "tolerance"], p=[0.6, 0.1, 0.1, 0.1, 0.1])
    wish = f', half_width = {width}, least = "{least}"' if width else ""
    return f"""
        target = {{name = "by-chance"{wish}}}
        object.stiffness = [{soft:.3g}, {soft * between(1.5, 6.0):.3g}]
        grasp = {{force = {force:.3g}, overload = {force * between(1.0, 3.0):.3g}}}
        room.rows = {rng.integers(1, 3)}
        room.elements = [2, {elements}]
        room.pitch = {rng.choice([0.2, 4.0, 6.0])}
        room.length = {rng.choice([60, 70, 2000])}
        stock.sheets = [{sheet}]
        stock.hinge_tolerances = {rng.choice(["[0.005]", "[0.002, 0.01]"])}
        elements.arms = [{arm:.1f}, {arm + rng.uniform(1.0, 8.0):.1f}]
        elements.hinges = [{hinge:.2f}, {hinge * between(1.5, 4.0):.2f}]
        elements.kinds = {rng.choice([2, 2, 3])}
        known.how = "{rng.choice(["calibrated", "drawn", "inspected"], p=[0.6, 0.2, 0.2])}"
        """


def processors() -> float:
    """Processor seconds of this process and of its children that have ended."""
    return sum(os.times()[:4])


def answers() -> str:
    """The twenty targets by `design`."""
    rows = []
    for n in range(TARGETS):
        start, cost, first = time.perf_counter(), processors(), dict[str, float]()

        def answered(got: Synthesis) -> None:
            first.update(cost=processors() - cost, clock=time.perf_counter() - start)

        got = design(parse_target(asked(n), "t"), answered=answered)
        seconds = (first["cost"], first["clock"], time.perf_counter() - start)
        width = f"{100 * got.found.half_width:.4g}" if got.found.accepted else ""
        rows.append((n, *(f"{s:.3g}" for s in seconds), width, "yes" if got.met else "no"))
    return lines(HEADS, rows)


if __name__ == "__main__":
    tables = {"answers": answers, "searches": searches, "yields": yields, "virtual builds": virtual_builds}
    raise SystemExit(write_tables(__doc__, tables))
