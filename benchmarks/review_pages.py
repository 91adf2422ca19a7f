"""Seconds from a design to its review page, with nothing in the cache and with everything, and its size.

usage: python benchmarks/review_pages.py [docs/review.md]

Each run is a process of its own; the shortest of three counts. With a page it writes the table there.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
from datetime import date
from pathlib import Path

from tactcad.bench.machine import machine

RUNS = 3
WHAT = (
    ("macro-array", ("--scene", "array")),
    ("macro-array", ()),
    ("macro-array", ("--drawings",)),
    ("soft-tissue", ()),
    ("smallest-bearing", ()),
)


def measured(design: str, options: tuple[str, ...]) -> tuple[float, float, int]:
    """Seconds cold and warm, and bytes."""
    cold, warm, size = [], [], 0
    for _ in range(RUNS):
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, "-m", "tactcad", "review", design, *options, "--json"]
            command += ["--out", str(Path(folder) / "page.html")]
            env = os.environ | {"TACTCAD_CACHE": str(Path(folder) / "cache")}
            for seconds in (cold, warm):
                said = subprocess.run(command, env=env, capture_output=True, text=True, check=True).stdout
                record = json.loads(said)
                seconds.append(record["seconds"])
                size = record["bytes"]
    return min(cold), min(warm), size


def table() -> str:
    rows = ["| design | page of | cold, s | warm, s | size, MB |", "|---|---|---|---|---|"]
    for design, options in WHAT:
        cold, warm, size = measured(design, options)
        what = {"--scene": "its array", "--drawings": "all scenes, with sheets"}.get(
            options[0] if options else "", "all scenes"
        )
        rows.append(f"| {design} | {what} | {cold:.1f} | {warm:.1f} | {size / 1e6:.2f} |")
    return "\n".join(rows) + f"\n\n{date.today()}, {machine_text()}."


def machine_text() -> str:
    m = machine()
    return f"{m['processor']}, {m['cores']} cores, {m['system']}, load {m['load']} when it ended"


def main(pages: list[str]) -> None:
    made = table()
    print(made)
    for page in map(Path, pages):
        text = page.read_text("utf-8")
        marked = re.sub(
            r"(?s)(<!-- table review -->\n).*?(<!-- end -->)", lambda m: f"{m[1]}{made}\n{m[2]}", text
        )
        page.write_text(marked, "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
