"""Seconds from saving a design to its picture in a browser: `tactcad view` of the published array and longer
ones.

usage: python benchmarks/live_page.py [docs/review.md]

The hinge of all elements is changed, so that each of their five parts is built anew; Chromium without a
graphics card draws by software. With a page it writes the table there.
"""

from __future__ import annotations

import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from datetime import date
from pathlib import Path

from playwright.sync_api import sync_playwright

from tactcad.bench.arrays import text
from tactcad.bench.machine import machine

ELEMENTS = (10, 40, 200)
HINGE = "hinge_thickness = 0.25"
SAVES = 11
SOFTWARE = [
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--no-sandbox",
]
DRAWN = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"


def measured(elements: int) -> tuple[list[float], list[float]]:
    """Of each save of an array of that many elements, seconds until the page has the model, and until it has
    drawn it."""
    known, drawn, design = [], [], text(elements)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as play:
        path = Path(folder) / "array.toml"
        path.write_text(design, "utf-8")
        command = [sys.executable, "-m", "tactcad", "view", str(path)]
        server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        try:
            url = server.stdout.readline().rpartition(" ")[2].strip()
            browser = play.chromium.launch(executable_path=shutil.which("chromium"), args=SOFTWARE)
            page = browser.new_page(viewport={"width": 1300, "height": 800})
            page.goto(url)
            page.wait_for_selector("html[data-ready]")
            page.evaluate(DRAWN)
            for n in range(1, SAVES + 1):
                time.sleep(1)
                started = time.perf_counter()
                thicker = f"hinge_thickness = {0.25 + 0.005 * n:.3f}"
                path.write_text(design.replace(HINGE, thicker, 1), "utf-8")
                page.wait_for_selector(f"html[data-version='{n}']", state="attached")
                known.append(time.perf_counter() - started)
                page.evaluate(DRAWN)
                drawn.append(time.perf_counter() - started)
            browser.close()
        finally:
            server.terminate()
            server.wait()
    return known, drawn


def table() -> str:
    rows = ["| array | the page has the model, s | it is drawn, s | longest, s |", "|---|---|---|---|"]
    for elements in ELEMENTS:
        known, drawn = measured(elements)
        seconds = (statistics.median(known), statistics.median(drawn), max(drawn))
        rows.append(f"| 2 x {elements // 2} | " + " | ".join(f"{s:.2f}" for s in seconds) + " |")
    m = machine()
    where = f"{m['processor']}, {m['cores']} cores, {m['system']}, load {m['load']} when it ended"
    said = f"median of {SAVES} saves, drawn without a graphics card"
    return "\n".join(rows) + f"\n\n{date.today()}, {where}; {said}."


def main(pages: list[str]) -> None:
    made = table()
    print(made)
    for page in map(Path, pages):
        marked = re.compile(r"(?s)(<!-- table live -->\n).*?(<!-- end -->)")
        page.write_text(marked.sub(lambda m: f"{m[1]}{made}\n{m[2]}", page.read_text("utf-8")), "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
