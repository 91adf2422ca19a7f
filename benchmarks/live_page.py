"""Seconds from saving a design to its picture in a browser: `tactcad view` of the published 2 x 5 array.

usage: python benchmarks/live_page.py [docs/review.md]

The hinge of all elements is changed; Chromium without a graphics card draws by software. With a page it
writes the table there.
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

from tactcad.bench.machine import machine

DESIGN = Path(__file__).parents[1] / "hardware" / "macro-array.toml"
HINGE = "hinge_thickness = 0.25"
SAVES = 11
SOFTWARE = [
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--no-sandbox",
]
DRAWN = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"


def measured() -> tuple[list[float], list[float]]:
    """Of each save, seconds until the page has the model, and until it has drawn it."""
    known, drawn = [], []
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as play:
        path, text = Path(folder) / "array.toml", DESIGN.read_text("utf-8")
        path.write_text(text, "utf-8")
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
                path.write_text(text.replace(HINGE, f"hinge_thickness = {0.25 + 0.005 * n:.3f}", 1), "utf-8")
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
    rows = ["| from the save until | median of 11, s | longest, s |", "|---|---|---|"]
    for what, seconds in zip(("the page has the model", "it is drawn"), measured(), strict=True):
        rows.append(f"| {what} | {statistics.median(seconds):.2f} | {max(seconds):.2f} |")
    m = machine()
    where = f"{m['processor']}, {m['cores']} cores, {m['system']}, load {m['load']} when it ended"
    return "\n".join(rows) + f"\n\n{date.today()}, {where}, drawn without a graphics card."


def main(pages: list[str]) -> None:
    made = table()
    print(made)
    for page in map(Path, pages):
        marked = re.compile(r"(?s)(<!-- table live -->\n).*?(<!-- end -->)")
        page.write_text(marked.sub(lambda m: f"{m[1]}{made}\n{m[2]}", page.read_text("utf-8")), "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
