"""Time from a target to its answer, as the tables of docs/targets.md.

    python benchmarks/syntheses.py docs/targets.md     some minutes

Processor time of one process, each case in turn: arrays of ten and forty elements against the number of free
numbers; the same candidates in a plain loop over `estimate`'s closed form; arrays made against the width of
the yield's interval.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
from ladder_tables import filled

from tactcad.lab.array_estimate import estimate
from tactcad.mechanics.section import Array
from tactcad.parts.layout import Layout
from tactcad.synthesis.candidates import Candidates, Stand, stands
from tactcad.synthesis.made_arrays import MadeSensor
from tactcad.synthesis.realise import realised
from tactcad.synthesis.search import search
from tactcad.synthesis.target import Target, read_target

TARGET = Path(__file__).parents[1] / "hardware" / "targets" / "better-array.toml"
LOOPED = 50  # candidates of the plain loop
ARRAYS = (500, 2000, 8000)


def half_width(c: Candidates) -> Array:
    return c.half_width


def cases(target: Target) -> list[tuple[str, Stand]]:
    """2 x 5 and 2 x 20, of two and of three kinds of element."""
    wide = target.with_("room.width", 200.0)
    out = []
    for elements in (10, 40):
        for kinds in (2, 3):
            here = wide.with_("room.elements", (elements, elements)).with_("elements.kinds", kinds)
            out.append((f"2 x {elements // 2}, {kinds} kinds", stands(here)[-1]))
    return out


def searches(target: Target) -> str:
    rows = [
        "| array | free numbers | candidates | s | us a candidate | half-width, % |",
        "|---|---|---|---|---|---|",
    ]
    for name, stand in cases(target):
        start = time.process_time()
        found = search(stand, half_width)
        seconds = time.process_time() - start
        each = 1e6 * seconds / found.evaluations
        rows.append(
            f"| {name} | {len(stand.limits[0])} | {found.evaluations} | {seconds:.2g} | {each:.3g} | "
            f"{100 * found.half_width:.3g} |"
        )
    return "\n".join(rows) + "\n"


def loop(target: Target) -> str:
    """The same candidates all at once, and one by one as a design through `estimate`."""
    stand = stands(target)[0]
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
    return (
        "| way | us a candidate | times |\n|---|---|---|\n"
        f"| a plain loop over `estimate` | {1e6 * alone:.3g} | 1 |\n"
        f"| candidates at once, with interval and limits | {1e6 * at_once:.3g} | {alone / at_once:.3g} |\n"
    )


def yields(target: Target) -> str:
    found = search(stands(target)[0], half_width, within=1e-2)
    sensor = MadeSensor(target, found.design)
    rows = ["| arrays, of two distributions | s | yield, % | its interval, % |", "|---|---|---|---|"]
    for count in ARRAYS:
        start = time.process_time()
        made = sensor.built(count, 1.3 * found.half_width)
        seconds = time.process_time() - start
        low, high = (f"{100 * v:.4g}" for v in made.interval)
        rows.append(f"| {count} | {seconds:.2g} | {100 * made.share:.4g} | {low} to {high} |")
    return "\n".join(rows) + "\n"


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("document", type=Path, help="Markdown file that has the tables' places")
    document, target = parser.parse_args().document, read_target(TARGET)
    text = document.read_text(encoding="utf-8")
    for name, table in (("searches", searches), ("loop", loop), ("yields", yields)):
        text = filled(text, name, table(target))
    document.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
