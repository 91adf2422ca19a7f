"""Progress on a terminal as one moving line; in a log as plain lines."""

from __future__ import annotations

from typing import TextIO


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
    """What suits the stream."""
    return Terminal(stream) if stream.isatty() else Log(stream)
