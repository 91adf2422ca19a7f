"""Progress on a terminal as one moving line; in a log as plain lines."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TextIO

SILENT = 2.0  # s; shorter work shows no progress


class Terminal:
    """A line that is written over, with lines worth keeping above it."""

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream

    def line(self, text: str) -> None:
        self.stream.write(f"\r\x1b[K{text}\n")
        self.stream.flush()

    def step(self, done: int, total: int, text: str) -> None:
        bar = "#" * round(20 * done / max(total, 1))
        end = "\r\x1b[K" if done == total else f"\r\x1b[K[{bar:20}] {done}/{total} {text[:50]}"
        self.stream.write(end)
        self.stream.flush()


class Log:
    """Plain lines, one for every piece of work."""

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream

    def line(self, text: str) -> None:
        print(text, file=self.stream, flush=True)

    def step(self, done: int, total: int, text: str) -> None:
        if done < total:
            print(f"[{done + 1}/{total}] {text}", file=self.stream, flush=True)


def progress(stream: TextIO) -> Terminal | Log:
    """The kind of progress that suits the stream."""
    return Terminal(stream) if stream.isatty() else Log(stream)


@contextmanager
def slow_work(stream: TextIO) -> Iterator[Callable[[int, int, str], None]]:
    """Gives a function to tell each step's (done, total, text); what is told is shown every SILENT seconds
    only."""
    shown, told, ended = progress(stream), [(0, 1, "")], threading.Event()

    def show() -> None:
        while not ended.wait(SILENT):
            shown.step(*told[-1])

    thread = threading.Thread(target=show, daemon=True)
    thread.start()
    try:
        yield lambda done, total, text: told.__setitem__(-1, (done, total, text))
    finally:
        ended.set()
        thread.join()
        shown.step(1, 1, "")  # on a terminal the line is removed
