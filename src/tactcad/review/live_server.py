"""The page of a live design on this machine's own address, for who has the token and for nobody else.

It answers two requests: the page, and what changed since a version. No request names a file, and none is
read for one.
"""

from __future__ import annotations

import hmac
import json
import re
import secrets
from collections.abc import Callable
from dataclasses import asdict
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from tactcad.design.messages import InputError

from .live import Live, LiveState
from .review_page import review_page
from .viewer_library import ViewerLibrary

ADDRESS = "127.0.0.1"
WAIT = 20.0  # s that a question is held; chosen: below what browsers and their helpers end by themselves
TIMEOUT = 10.0  # s for a reader or writer that stands still; chosen
HEADERS = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
}


class LiveServer(ThreadingHTTPServer):
    """Answers for one live design; `url` is the page's address, with the token that every request needs."""

    daemon_threads = True

    def __init__(self, live: Callable[[], Live], library: ViewerLibrary, port: int) -> None:
        """`port` 0 takes a free one; `live`, which takes seconds, is made once the port is this server's.

        Raises InputError where the port is taken or not allowed, and what `live` raises."""
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
        # a page elsewhere whose name is made to mean this machine asks under that name
        self.hosts = {f"{name}:{self.server_port}" for name in (ADDRESS, "localhost")}

    @property
    def url(self) -> str:
        return f"http://{ADDRESS}:{self.server_port}/{self.token}/"

    def page(self) -> bytes:
        """The page as it is now."""
        shown, record, block = self.live.state()
        return review_page(record | {"live": asdict(shown)}, block, self.library)

    def news(self, version: int, model: int) -> bytes:
        """What is to be shown once it is no longer that version, at most after WAIT: a line of JSON; where
        the model is another one, its record is in it and its block follows."""
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
            pass  # the reader has gone, or stands still

    def version_string(self) -> str:
        return "tactcad"

    def log_message(self, format: str, *args: object) -> None:
        """Nothing: a request's address holds the token."""
