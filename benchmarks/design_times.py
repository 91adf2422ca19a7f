"""Time from a target to its answer, and of arrays built virtually: the tables of docs/targets.md and
docs/stack.md.

    python benchmarks/design_times.py docs/targets.md    some minutes
    python benchmarks/design_times.py docs/stack.md      a few minutes

Processor time of one process, each case in turn: arrays of ten and forty elements against the number of free
numbers; the same candidates in a plain loop over `estimate`'s closed form; arrays made against the width of
the yield's interval; arrays built against their elements, an element's time level where time goes with the
elements.
"""

from __future__ import annotations

import time

import numpy as np
from measuring import ROOT, array_of, processor_seconds
from tables import lines, write_tables

from tactcad.lab.array_estimate import estimate
from tactcad.mechanics.section import Array
from tactcad.parts.array.layout import Layout
from tactcad.stacks.virtual_build import sensor
from tactcad.synthesis.candidates import Candidates, realised, stands
from tactcad.synthesis.made_arrays import MadeSensor
from tactcad.synthesis.search import search
from tactcad.synthesis.target import Target, read_target

TARGET = ROOT / "hardware" / "targets" / "better-array.toml"
LOOPED = 50  # candidates of the plain loop
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


def loop() -> str:
    """The same candidates all at once, and one by one as a design through `estimate`."""
    stand = stands(target())[0]
    low, high = stand.limits
    rows = np.random.default_rng(1).integers(low, np.maximum(high, low) + 1, (100 * LOOPED, len(low)))
    stand.candidates(rows[:10]).violation
    start = time.process_time()
    with np.errstate(all="ignore"):
        usable = np.isfinite(stand.candidates(rows).violation)
    at_once = (time.process_time() - start) / len(rows)
    start = time.process_time()
    for row in rows[usable][:LOOPED]:
        estimate(Layout(realised(stand.candidates(row[np.newaxis]))), "solid")
    alone = (time.process_time() - start) / LOOPED
    shown = (f"{1e6 * at_once:.3g}", f"{alone / at_once:.3g}")
    return lines(
        "way | us a candidate | times",
        [
            ("a plain loop over `estimate`", f"{1e6 * alone:.3g}", 1),
            ("candidates at once, with interval and limits", *shown),
        ],
    )


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
        made.built(2)  # loads what is loaded once
        seconds = processor_seconds(lambda: made.built(count))
        each = seconds / (3 * count * elements)
        first = first or each
        shown = (f"{seconds:.2g}", f"{3 * count / seconds:.3g}", f"{each / first:.2f}")
        rows.append((elements, 3 * count, *shown))
    heads = "elements | arrays, of three distributions | s | arrays a second | s an element, relative"
    return lines(heads, rows)


if __name__ == "__main__":
    tables = {"searches": searches, "loop": loop, "yields": yields, "virtual builds": virtual_builds}
    raise SystemExit(write_tables(__doc__, tables))
