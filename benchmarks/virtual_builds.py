"""Arrays built virtually against their elements, as the table of docs/stack.md.

    python benchmarks/virtual_builds.py docs/stack.md     a few minutes

Processor time of one process, each size in turn; the last column is an element's time against the smallest
array's: level where the time goes with the elements.
"""

from __future__ import annotations

import argparse
import re
import time
from pathlib import Path

from tactcad.assembly.virtual_build import sensor
from tactcad.bench import arrays

SIZES = (10, 40, 160, 1000)
ELEMENTS = 20_000  # built in a run of each size, so that each takes about as long
BEGIN, END = "<!-- table virtual builds -->\n", "<!-- end -->\n"


def row(elements: int) -> tuple[int, int, float]:
    """Elements of an array, arrays built of each distribution, and seconds of processor time in all."""
    made = sensor(arrays.of(elements), ())
    count = ELEMENTS // elements
    made.built(2)  # loads what is loaded once
    start = time.process_time()
    made.built(count)
    return elements, count, time.process_time() - start


def table() -> str:
    lines = ["| elements | arrays, of three distributions | s | arrays a second | s an element, relative |"]
    lines.append("|---|---|---|---|---|")
    first = None
    for elements, count, seconds in map(row, SIZES):
        each = seconds / (3 * count * elements)
        first = first or each
        lines.append(
            f"| {elements} | {3 * count} | {seconds:.2g} | {3 * count / seconds:.3g} | {each / first:.2f} |"
        )
    return "\n".join(lines) + "\n"


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("document", type=Path, help="Markdown file that has the table's place")
    document = parser.parse_args().document
    text = document.read_text(encoding="utf-8")
    pattern = re.compile(re.escape(BEGIN) + ".*?" + re.escape(END), re.DOTALL)
    if not pattern.search(text):
        parser.error(f"{document}: no place for the table: {BEGIN.strip()}")
    new = BEGIN + table() + END
    document.write_text(pattern.sub(lambda _: new, text), encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
