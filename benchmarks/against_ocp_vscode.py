"""Seconds and bytes of the review page against ocp_vscode's `show` of the same array, in turn on one machine.

usage: python benchmarks/against_ocp_vscode.py [docs/review.md]

Each run is a process of its own, which starts to count when tactcad is loaded; the shortest of five counts.
A listener takes what OCP CAD Viewer would get; drawing is on neither side. With a page it writes the table
there.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
import threading
import time
from datetime import date
from pathlib import Path

from websockets.sync.server import serve

from tactcad.bench.machine import machine

RUNS = 5
DESIGN = "macro-array"
PAGE, VIEWER = "page", "viewer"
WHOLE, HANDED = "whole", "handed"
ROWS = {
    "cold": "an empty cache",
    "warm": "a full cache",
    "again": "the same again in that process",
    HANDED: "solids at hand: tessellated and handed over, no checks",
}


# --- in the process that is measured ---


def child(side: str, what: str) -> None:
    """Print the seconds of a first and a second call, and a page's bytes; or the seconds from solids on."""
    if what == HANDED:
        print(json.dumps({HANDED: page_handed() if side == PAGE else viewer_handed()}))
        return
    from tactcad.review.show import show, show_in_vscode

    act = show if side == PAGE else show_in_vscode
    first, shown = timed(lambda: act(DESIGN))
    again, _ = timed(lambda: act(DESIGN))
    print(json.dumps({"first": first, "again": again, "bytes": len(shown.html) if shown else 0}))


def timed(act):
    """Seconds that it takes, and what it gives."""
    started = time.perf_counter()
    made = act()
    return time.perf_counter() - started, made


def solids_at_hand():
    """The design, its scene, makers of shapes that know every one but no mesh, and the shapes."""
    from tactcad.export.cache import Cache
    from tactcad.export.shapes import Shapes
    from tactcad.parts.designs import load
    from tactcad.scenes import make_scene

    design = load(DESIGN)
    scene = make_scene(design, "array")
    shapes = Shapes(Cache(Path(tempfile.mkdtemp(dir=Path.home())), print), "benchmark")
    return design, scene, shapes, {part.part_no: shapes.of(part) for part in scene.parts}


def page_handed() -> float:
    from tactcad.review.live_record import live_record
    from tactcad.review.review_page import review_page
    from tactcad.review.viewer_library import viewer_library
    from tactcad.solids import facets  # noqa: F401  loaded before the clock runs

    design, scene, shapes, _ = solids_at_hand()
    return timed(lambda: review_page(*live_record(design, scene.name, shapes), viewer_library()))[0]


def viewer_handed() -> float:
    import ocp_vscode

    from tactcad.review.scene_facts import scene_facts
    from tactcad.solids.assembly_tree import assembly_tree

    design, scene, _, solids = solids_at_hand()
    under = {p.designator: p.under for p in scene_facts(design, scene).placed}
    return timed(lambda: ocp_vscode.show(assembly_tree(scene, solids, under), progress=""))[0]


# --- in the process that measures ---


class Listener:
    """What OCP CAD Viewer is at its other end; the largest message of each kind, bytes."""

    def __init__(self) -> None:
        self.largest = {b"D:": 0, b"B:": 0}
        self.server = serve(self._take, "127.0.0.1", 0, max_size=None)
        self.port = self.server.socket.getsockname()[1]
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def _take(self, connection) -> None:
        for message in connection:
            data = message if isinstance(message, bytes) else message.encode()
            kind = data[:2]
            if kind == b"C:":
                connection.send('{"command": "status", "text": {}}' if b"status" in data else "{}")
            else:
                self.largest[kind] = max(self.largest[kind], len(data))
            if kind == b"B:":
                connection.send('{"ok": true}')


def run(side: str, what: str, home: Path, port: int) -> dict[str, float]:
    env = os.environ | {"TACTCAD_CACHE": str(home / "cache"), "HOME": str(home), "OCP_PORT": str(port)}
    done = subprocess.run(
        [sys.executable, __file__, "child", side, what], env=env, capture_output=True, text=True, check=True
    )
    return json.loads(done.stdout.splitlines()[-1])


def measured() -> tuple[dict[str, dict[str, float]], dict[str, int]]:
    """Seconds by row and side, and bytes by side."""
    listener, size = Listener(), 0
    seconds: dict[str, dict[str, list[float]]] = {row: {PAGE: [], VIEWER: []} for row in ROWS}
    for _ in range(RUNS):
        for side in (PAGE, VIEWER):
            with tempfile.TemporaryDirectory() as folder:
                cold, warm, handed = (
                    run(side, what, Path(folder), listener.port) for what in (WHOLE, WHOLE, HANDED)
                )
            found = {"cold": cold["first"], "warm": warm["first"], "again": warm["again"], **handed}
            for row, value in found.items():
                seconds[row][side].append(value)
            size = max(size, int(warm["bytes"]))
    least = {row: {side: min(values) for side, values in sides.items()} for row, sides in seconds.items()}
    return least, {PAGE: size, VIEWER: sum(listener.largest.values())}


def table() -> str:
    seconds, sizes = measured()
    rows = ["| from | page, s | OCP CAD Viewer, s | page / viewer |", "|---|---|---|---|"]
    for row, text in ROWS.items():
        page, viewer = seconds[row][PAGE], seconds[row][VIEWER]
        rows.append(f"| {text} | {page:.2f} | {viewer:.2f} | {page / viewer:.2f} |")
    page, viewer = sizes[PAGE] / 1e6, sizes[VIEWER] / 1e6
    rows.append(f"| (bytes handed over, MB) | {page:.2f} | {viewer:.2f} | {page / viewer:.2f} |")
    m = machine()
    where = f"{m['processor']}, {m['cores']} cores, {m['system']}, load {m['load']} when it ended"
    return "\n".join(rows) + f"\n\n{date.today()}, {where}."


def main(pages: list[str]) -> None:
    made = table()
    print(made)
    marked = re.compile(r"(?s)(<!-- table ocp-vscode -->\n).*?(<!-- end -->)")
    for page in map(Path, pages):
        page.write_text(marked.sub(lambda m: f"{m[1]}{made}\n{m[2]}", page.read_text("utf-8")), "utf-8")


if __name__ == "__main__":
    if sys.argv[1:2] == ["child"]:
        child(*sys.argv[2:])
    else:
        main(sys.argv[1:])
