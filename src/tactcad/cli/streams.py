"""Standard output and standard error that let the work go on when their readers are gone."""

from __future__ import annotations

import io
import os
import select
import sys
from typing import Any, TextIO


class Lossy(io.FileIO):
    """A stream's file that drops what cannot be written; `error` says why."""

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
        """Why output was lost; None where none was, or where its reader is gone: a pipe, or a terminal
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
