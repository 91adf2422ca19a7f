"""Standard output and standard error: the work goes on when their readers are gone, and progress is one
moving line on a terminal, plain lines in a log."""

from __future__ import annotations

import io
import os
import select
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TextIO


class Lossy(io.FileIO):
    """A stream's file that drops output that cannot be written; `error` has the reason."""

    error: OSError | None = None

    def __init__(self, handle: int) -> None:
        super().__init__(handle, "w", closefd=False)
        self.terminal = self.isatty()

    def write(self, data: Any) -> int:
        try:
            while (count := super().write(data)) is None:  # a pipe that does not wait for its reader
                select.select([], [self], [])
            return count
        except OSError as error:
            self.error = self.error or error
            return memoryview(data).nbytes

    @property
    def failed(self) -> OSError | None:
        """Why output was lost; None if none was, or if its reader is gone: a pipe, or a terminal
        that hung up.
        """
        return None if self.terminal or isinstance(self.error, ConnectionError) else self.error


def mend() -> None:
    """Make every text printable, and reserve the number of a closed stream, so that no file of ours takes
    it.
    """
    if None in (sys.stdin, sys.stdout, sys.stderr):
        while (handle := os.open(os.devnull, os.O_RDWR)) <= 2:
            os.set_inheritable(handle, True)
        os.close(handle)
        sys.stdout = sys.stdout or open(1, "w", closefd=False)
        sys.stderr = sys.stderr or open(2, "w", closefd=False)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def own() -> Lossy:
    """Send this process's output and messages through such files; returns that of standard output."""
    mend()
    sys.stdout, output = _lossy(sys.stdout)
    sys.stderr, _ = _lossy(sys.stderr)
    return output


def _lossy(stream: TextIO) -> tuple[io.TextIOWrapper, Lossy]:
    """A stream in the place of that one, and its file."""
    at_once = isinstance(stream, io.TextIOWrapper) and (stream.line_buffering or stream.write_through)
    file = Lossy(stream.fileno())
    buffered: Any = io.BufferedWriter(file)  # the type stub requires more of a raw file than is used
    return io.TextIOWrapper(buffered, stream.encoding, "backslashreplace", line_buffering=at_once), file


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
    """Plain lines: one for each stage, or for every piece of work (--verbose)."""

    def __init__(self, stream: TextIO, every: bool) -> None:
        self.stream, self.every, self.last = stream, every, (0, 0)

    def line(self, text: str) -> None:
        print(text, file=self.stream, flush=True)

    def step(self, done: int, total: int, text: str) -> None:
        begins = total != self.last[1] or done < self.last[0]
        self.last = done, total
        if done < total and (begins or self.every):
            print(f"[{done + 1}/{total}] {text}", file=self.stream, flush=True)


class Silence:
    """No progress (--quiet); warnings are printed."""

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream

    def line(self, text: str) -> None:
        if text.startswith("warning:"):
            print(text, file=self.stream, flush=True)

    def step(self, done: int, total: int, text: str) -> None:
        pass


_loudness: list[str] = [""]


def set_loudness(option: str | None) -> None:
    """--quiet, --verbose, or neither."""
    _loudness[0] = option or ""


def progress(stream: TextIO) -> Terminal | Log | Silence:
    """The kind of progress for the stream and the options."""
    if _loudness[0] == "--quiet":
        return Silence(stream)
    return Terminal(stream) if stream.isatty() else Log(stream, _loudness[0] == "--verbose")


COLOURS = {"fail": "31", "flag": "33"}  # red and yellow


def coloured(text: str, severity: str, stream: TextIO) -> str:
    """The text in the colour of a failure or a flag, on a terminal and without NO_COLOR."""
    plain = os.environ.get("NO_COLOR") or not stream.isatty() or severity not in COLOURS
    return text if plain else f"\x1b[{COLOURS[severity]}m{text}\x1b[0m"


@contextmanager
def slow_work(stream: TextIO) -> Iterator[Callable[[int, int, str], None]]:
    """Gives a function that takes each step's (done, total, text) and shows one every SILENT seconds only."""
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
