"""Seconds to see a design, as the tables of benchmarks/results/review.md: its page, live in a browser,
compared with OCP CAD Viewer.

    python benchmarks/review_times.py benchmarks/results/review.md [review] [live] [ocp-vscode]

Pages: each run is a process of its own, with an empty and with a full cache; the shortest of three counts.
Live: the hinge of all elements is changed, so that each of their five parts is built anew; Chromium without a
graphics card draws by software. OCP CAD Viewer: `show` of the same array in turn, each a process that starts
to count when tactcad is loaded; a listener takes what the viewer would get, and drawing is on neither side.
"""

from __future__ import annotations

import json
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from measuring import array_text, environment, made_here, published, python, tactcad
from tables import lines, write_tables

from tactcad.design.load import DEFAULT_DESIGN

# --- pages ---

PAGE_RUNS = 3
PAGES = (
    ("macro-array", "its array", ("--scene", "array")),
    ("macro-array", "all scenes", ()),
    ("macro-array", "all scenes, with sheets", ("--drawings",)),
    ("soft-tissue", "all scenes", ()),
    ("smallest-bearing", "all scenes", ()),
)


def pages() -> str:
    rows = []
    for design, what, options in PAGES:
        seconds: tuple[list[float], list[float]] = [], []
        for _ in range(PAGE_RUNS):
            with tempfile.TemporaryDirectory() as folder:
                command = tactcad("review", design, *options, "--json", "--out", Path(folder) / "page.html")
                for times in seconds:
                    record = json.loads(_output(command, TACTCAD_CACHE=str(Path(folder) / "cache")))
                    times.append(record["seconds"])
                    (size,) = record["files"].values()
        cold, warm = map(min, seconds)
        rows.append((design, what, f"{cold:.1f}", f"{warm:.1f}", f"{size / 1e6:.2f}"))
    return f"{lines('design | page of | cold, s | warm, s | size, MB', rows)}\n\n{made_here()}."


def _output(command: list[str], **more: str) -> str:
    own = environment(**more)
    return subprocess.run(command, env=own, capture_output=True, text=True, check=True).stdout


# --- live: from saving a design to its picture in a browser ---

ELEMENTS = (10, 40, 200)
HINGE = "hinge_thickness = 0.25"
SAVES = 11
SOFTWARE = (
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--no-sandbox",
)
DRAWN = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"


def live() -> str:
    rows = []
    for elements in ELEMENTS:
        known, drawn = saved(elements)
        seconds = (statistics.median(known), statistics.median(drawn), max(drawn))
        rows.append((f"2 x {elements // 2}", *(f"{s:.2f}" for s in seconds)))
    said = f"{made_here()}; median of {SAVES} saves, drawn without a graphics card."
    return f"{lines('array | the page has the model, s | it is drawn, s | longest, s', rows)}\n\n{said}"


def saved(elements: int) -> tuple[list[float], list[float]]:
    """Of each save of an array of that many elements, seconds until the page has the model, and until it has
    drawn it."""
    from playwright.sync_api import sync_playwright

    known, drawn, design = [], [], array_text(elements)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as play:
        path = Path(folder) / "array.toml"
        path.write_text(design, "utf-8")
        server = subprocess.Popen(tactcad("view", path), stdout=subprocess.PIPE, text=True)
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


# --- compared with OCP CAD Viewer ---

RUNS = 5
PAGE, VIEWER = "page", "viewer"
WHOLE, HANDED = "whole", "handed"
FROM = {
    "cold": "an empty cache",
    "warm": "a full cache",
    "again": "the same again in that process",
    HANDED: "solids at hand: tessellated and handed over, no checks",
}


def child(side: str, what: str) -> dict[str, float]:
    """Seconds of a first and a second call, and a page's bytes; or the seconds from solids on."""
    if what == HANDED:
        return {HANDED: handed(side)}
    from tactcad.review.show import show, show_in_vscode

    act = show if side == PAGE else show_in_vscode
    first, shown = timed(lambda: act(DEFAULT_DESIGN))
    again, _ = timed(lambda: act(DEFAULT_DESIGN))
    return {"first": first, "again": again, "bytes": len(shown.html) if shown else 0}


def timed(act: Callable[[], Any]) -> tuple[float, Any]:
    started = time.perf_counter()
    made = act()
    return time.perf_counter() - started, made


def handed(side: str) -> float:
    """Seconds from makers of shapes that know every shape, but no mesh."""
    import ocp_vscode

    from tactcad.export.cache import Cache
    from tactcad.export.shapes import Shapes
    from tactcad.review.facts import scene_facts
    from tactcad.review.live import live_record
    from tactcad.review.review_page import review_page, viewer_library
    from tactcad.scenes import make_scene
    from tactcad.solids.assembly_tree import assembly_tree

    design = published()
    scene = make_scene(design, "array")
    shapes = Shapes(Cache(Path(tempfile.mkdtemp(dir=Path.home())), print), "benchmark")
    solids = {part.part_no: shapes.of(part) for part in scene.parts}
    if side == PAGE:
        return timed(lambda: review_page(*live_record(design, scene.name, shapes), viewer_library()))[0]
    under = {p["designator"]: p["under"] for p in scene_facts(design, scene)["placed"]}
    return timed(lambda: ocp_vscode.show(assembly_tree(scene, solids, under), progress=""))[0]


class Listener:
    """What OCP CAD Viewer is at its other end; the largest message of each kind, bytes."""

    def __init__(self) -> None:
        from websockets.sync.server import serve

        self.largest = {b"D:": 0, b"B:": 0}
        self.server = serve(self._take, "127.0.0.1", 0, max_size=None)
        self.port = self.server.socket.getsockname()[1]
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def _take(self, connection: Any) -> None:
        for message in connection:
            data = message if isinstance(message, bytes) else message.encode()
            kind = data[:2]
            if kind == b"C:":
                connection.send('{"command": "status", "text": {}}' if b"status" in data else "{}")
            else:
                self.largest[kind] = max(self.largest[kind], len(data))
            if kind == b"B:":
                connection.send('{"ok": true}')


def beside_viewer() -> str:
    listener, size = Listener(), 0.0
    seconds: dict[tuple[str, str], list[float]] = {(row, side): [] for row in FROM for side in (PAGE, VIEWER)}
    for _ in range(RUNS):
        for side in (PAGE, VIEWER):
            with tempfile.TemporaryDirectory() as home:
                own = {"TACTCAD_CACHE": f"{home}/cache", "HOME": home, "OCP_PORT": str(listener.port)}
                cold, warm, again = (
                    json.loads(_output(python(__file__, "child", side, what), **own).splitlines()[-1])
                    for what in (WHOLE, WHOLE, HANDED)
                )
            found = {"cold": cold["first"], "warm": warm["first"], "again": warm["again"], **again}
            for row, value in found.items():
                seconds[row, side].append(value)
            size = max(size, warm["bytes"])
    both = [(text, *(min(seconds[row, side]) for side in (PAGE, VIEWER))) for row, text in FROM.items()]
    both.append(("(bytes handed over, MB)", size / 1e6, sum(listener.largest.values()) / 1e6))
    rows = [(text, f"{a:.2f}", f"{b:.2f}", f"{a / b:.2f}") for text, a, b in both]
    return f"{lines('from | page, s | OCP CAD Viewer, s | page / viewer', rows)}\n\n{made_here()}."


if __name__ == "__main__":
    if sys.argv[1:2] == ["child"]:
        print(json.dumps(child(*sys.argv[2:])))
    else:
        raise SystemExit(write_tables(__doc__, {"review": pages, "live": live, "ocp-vscode": beside_viewer}))
