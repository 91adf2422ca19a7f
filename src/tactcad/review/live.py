"""A design file followed while it is edited: the last good model, the text's faults since, and its page on
this machine's own address, only with the token.

The server answers two requests: the page, and the changes since a version. No request names a file or causes
one to be read.
"""

from __future__ import annotations

import hmac
import importlib
import json
import re
import secrets
import threading
import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from tactcad.design.files import read_text
from tactcad.design.load import MOST_BYTES, parse
from tactcad.design.messages import CheckFailure, InputError
from tactcad.design.tree import CommonTables
from tactcad.export.inputs import flattened
from tactcad.export.shapes import Shapes
from tactcad.lab.array_estimate import ELEMENT
from tactcad.parts.rules import refuse_broken
from tactcad.scenes import chosen_scenes, make_scene

from .facts import estimate_facts
from .review_page import ViewerLibrary, review_page
from .review_record import mesh_pack, record_of

POLL = 0.1  # s between two looks at the file; chosen: a tenth of the second in which a change is to be seen
ADDRESS = "127.0.0.1"
WAIT = 20.0  # s that a request waits; chosen: below the timeouts of browsers and proxies
TIMEOUT = 10.0  # s for a stalled reader or writer; chosen
HEADERS = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
}
# Of each element, as the page's panel calls them.
NUMBERS = ELEMENT.some("stiffness", "rated_force", "yield_force")
LEFT_OUT = "Left out while live; `tactcad review` has it."


Change = dict[str, Any]  # `what`, `before` and `after` (None if there is none) of designators, `about`


def _change(about: str, what: str, before: Any, after: Any) -> Change:
    return {"about": about, "what": what, "before": before, "after": after}


@dataclass(frozen=True)
class LiveState:
    """The page's state.

    version  grows with every change of the rest
    model    version at which the model changed last
    seconds  that the model took from the file's reading on
    message  why the present file gives no model, "" if it does
    changes  of `number_changes`, from the model before
    """

    version: int
    model: int
    file: str
    seconds: float
    message: str
    changes: tuple[dict[str, Any], ...]


def load_kernel() -> None:
    """Load the kernel now: a first model from the cache does not need it, and the first save would wait for
    it."""
    for module in ("build", "step", "triangles"):
        importlib.import_module(f"tactcad.solids.{module}")


class Live:
    """The file's last good model. One thread calls `look` again and again, others wait for changes."""

    def __init__(self, path: Path, scene: str, shapes: Callable[[], Shapes]) -> None:
        """`shapes` gives makers of solids that share their cache: one knows its shapes by part number, which
        stays when the part changes. Raises InputError if the file is no design that keeps its rules."""
        self.path, self.scene, self.shapes = path, scene, shapes
        self.changed = threading.Condition()
        self._text: str | None = None
        self._trouble = ""
        started = time.perf_counter()
        self._text = self._read()
        self.design, self.record, self.block = self._made(self._text)
        self.shown = LiveState(0, 0, str(path), time.perf_counter() - started, "", ())

    def look(self) -> None:
        """Reload the file if it changed."""
        started = time.perf_counter()
        try:
            text: str | None = self._read()
        except InputError as error:
            self._later(None, str(error))
            return
        if text == self._text:
            self._trouble = ""
            return
        assert text is not None
        try:
            design, record, block = self._made(text)
        except (InputError, CheckFailure) as error:
            self._later(text, str(error))
        except Exception as error:  # a file in editing may hold anything: keep the page up
            traceback.print_exc()
            self._later(text, f"{type(error).__name__}: {error}")
        else:
            self._take(text, (design, record, block), started)

    def state(self) -> tuple[LiveState, dict[str, Any], bytes]:
        """The present state, with the record and the block of the same version."""
        with self.changed:
            return self.shown, self.record, self.block

    def after(self, version: int, seconds: float) -> tuple[LiveState, dict[str, Any], bytes]:
        """The same once it is another version than that, or after so many seconds."""
        with self.changed:
            self.changed.wait_for(lambda: self.shown.version != version, seconds)
            return self.state()

    def _read(self) -> str:
        return read_text(self.path, MOST_BYTES, "a design file (TOML)")

    def _made(self, text: str) -> tuple[CommonTables, dict[str, Any], bytes]:
        design = parse(text, str(self.path))
        refuse_broken(design)
        (scene,) = chosen_scenes(design, [self.scene])
        return design, *live_record(design, scene, self.shapes())

    def _later(self, text: str | None, message: str) -> None:
        """Show the message if a second look confirms it: an editor may be writing, or replacing, the file."""
        if message != self._trouble:
            self._trouble = message
            return
        self._text = text
        if message != self.shown.message:
            s = self.shown
            self._tell(LiveState(s.version + 1, s.model, s.file, s.seconds, message, s.changes))

    def _take(self, text: str, made: tuple[CommonTables, dict[str, Any], bytes], started: float) -> None:
        design, record, block = made
        changes = number_changes((self.design, self.record), (design, record))
        self._text, self._trouble, s = text, "", self.shown
        if not changes and not s.message:
            return  # a comment
        new = s.version + 1
        with self.changed:
            self.design, self.record, self.block = made
            kept = tuple(changes) or s.changes  # a mended text may be the one before
            model = new if changes else s.model
            self._tell(LiveState(new, model, s.file, time.perf_counter() - started, "", kept))

    def _tell(self, shown: LiveState) -> None:
        with self.changed:
            self.shown = shown
            self.changed.notify_all()


def live_record(design: CommonTables, scene_name: str, shapes: Shapes) -> tuple[dict[str, Any], bytes]:
    """`review_record` of one scene without its slow parts: checks, virtual builds with each requirement's
    variance, pictures of strain.

    Parameters
    ----------
    design
        Must keep its rules.
    scene_name
        The scene.
    shapes
        Makes solids, or takes them from its cache: parts that did not change are not meshed again.
    """
    scene = make_scene(design, scene_name)
    parts = list({part.part_no: part for part in scene.parts}.values())
    pack = mesh_pack(parts, shapes)
    array = estimate_facts(design)
    elements = {p.part.part_no for p in scene.placements if p.designator in array["elements"]}
    strains = {number: {"why_not": LEFT_OUT} for number in sorted(elements)}
    return record_of(design, [scene], parts, pack, array, strains, ({}, [])), pack.block


def number_changes(
    old: tuple[CommonTables, Mapping[str, Any]], new: tuple[CommonTables, Mapping[str, Any]]
) -> list[Change]:
    """Differences between two designs and their records: fields first, then the elements' estimates, equal
    changes of several elements as one, then masses."""
    before, after = (flattened(design) for design, _ in (old, new))
    fields = [
        _change("", path, before.get(path), after.get(path))
        for path in (*after, *(p for p in before if p not in after))
        if before.get(path) != after.get(path)
    ]
    scene = new[1]["scenes"][0]["name"]
    pair = _mass(old[1]), _mass(new[1])
    masses = [_change(scene, "mass, g", *pair)] if pair[0] != pair[1] else []
    return [*fields, *_estimates(old[1], new[1]), *masses]


def _estimates(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[Change]:
    before, after = (record["array"]["elements"] for record in (old, new))
    for figure in NUMBERS:
        same: dict[tuple[Any, Any], list[str]] = {}
        for designator in (*after, *(d for d in before if d not in after)):
            pair = (_number(before, designator, figure.name), _number(after, designator, figure.name))
            if pair[0] != pair[1]:
                same.setdefault(pair, []).append(designator)
        yield from (
            _change(" ".join(who), f"{figure.heading}, {figure.unit}", *pair) for pair, who in same.items()
        )


def _number(elements: Mapping[str, Any], designator: str, name: str) -> float | None:
    estimate = elements.get(designator, {}).get("estimate")
    return estimate[name] if estimate else None


def _mass(record: Mapping[str, Any]) -> float:
    """Mass of all parts of the scene, g, to a milligram: the sum's last digits depend on the order."""
    mass = {part["part_no"]: part["mass_g"] for part in record["parts"]}
    return round(sum(mass[p["part_no"]] for p in record["scenes"][0]["placed"]), 3)


class LiveServer(ThreadingHTTPServer):
    """Answers for one live design; `url` is the page's address, with the token that every request needs."""

    daemon_threads = True

    def __init__(self, live: Callable[[], Live], library: ViewerLibrary, port: int) -> None:
        """`port` 0 takes a free one; `live`, which takes seconds, is made once the port is this server's.

        Raises InputError if the port is taken or not allowed, and what `live` raises."""
        self.library = library
        self.token = secrets.token_urlsafe(24)
        try:
            super().__init__((ADDRESS, port), _Answer)
        except (OSError, OverflowError) as error:
            why = getattr(error, "strerror", None) or str(error)
            legal = "a free port from 1024 to 65535, or 0 for any"
            raise InputError("--port", f"cannot be used: {why}", value=port, legal=legal) from None
        try:
            self.live = live()
        except BaseException:
            self.server_close()
            raise
        # a foreign page whose name resolves to this machine sends that name (DNS rebinding)
        self.hosts = {f"{name}:{self.server_port}" for name in (ADDRESS, "localhost")}

    @property
    def url(self) -> str:
        return f"http://{ADDRESS}:{self.server_port}/{self.token}/"

    def page(self) -> bytes:
        """The present page."""
        shown, record, block = self.live.state()
        return review_page(record | {"live": asdict(shown)}, block, self.library)

    def news(self, version: int, model: int) -> bytes:
        """The state after that version, at most after WAIT: a line of JSON; if the model changed, its record
        is included and its block follows."""
        shown, record, block = self.live.after(version, WAIT)
        if shown.model == model:
            return _line(shown, None)
        return _line(shown, record) + block


def _line(shown: LiveState, record: dict[str, Any] | None) -> bytes:
    return json.dumps({"live": asdict(shown), "record": record}, allow_nan=False).encode() + b"\n"


class _Answer(BaseHTTPRequestHandler):
    server: LiveServer
    timeout = TIMEOUT

    def do_GET(self) -> None:
        if self.headers.get("Host", "") not in self.server.hosts:
            self._send(403, "text/plain", b"not this machine's address\n")
            return
        token, slash, rest = self.path.removeprefix("/").partition("/")
        known = hmac.compare_digest(token.encode(), self.server.token.encode())
        asked = re.fullmatch(r"events\?version=(\d{1,9})&model=(\d{1,9})", rest, re.ASCII)
        if known and slash and not rest:
            self._send(200, "text/html; charset=utf-8", self.server.page())
        elif known and asked:
            self._send(200, "application/octet-stream", self.server.news(int(asked[1]), int(asked[2])))
        else:
            self._send(404, "text/plain", b"nothing here\n")

    def _send(self, status: int, kind: str, data: bytes) -> None:
        try:
            self.send_response(status)
            for name, value in {**HEADERS, "Content-Type": kind, "Content-Length": str(len(data))}.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(data)
        except OSError:
            pass  # the reader is gone or stalled

    def version_string(self) -> str:
        return "tactcad"

    def log_message(self, format: str, *args: object) -> None:
        """Nothing: a request's address holds the token."""
