"""Ending the program on a signal: at once, in one place, and leaving nothing half made behind.

An exception raised at any point of the program would pass through libraries that swallow it or turn it into
another error, native imports above all. So the handler itself stops our processes, removes unfinished files,
prints one line and exits. It waits only for the current native call. This module imports only what Python has
loaded anyway, because `tactcad.__main__` imports it before everything else.
"""

from __future__ import annotations

import os
import signal
import sys

TYPE_CHECKING = False  # typing is not loaded yet
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from subprocess import CompletedProcess
    from typing import Any

SAID = {
    signal.SIGINT: "interrupted",
    signal.SIGTERM: "terminated (SIGTERM)",
    signal.SIGHUP: "the terminal hung up (SIGHUP)",
}

_unfinished: list[Callable[[], object]] = []  # functions that remove unfinished files
_groups: list[int] = []  # process groups that end with the program, as `os.kill` has them: below 0
_owner = 0  # the process that they belong to: a forked helper has only a copy of the lists


def end_on_signals() -> None:
    """Make SIGINT, SIGTERM and SIGHUP end this process with 128 + their number, except those that it was
    started to ignore, as by nohup.
    """
    global _owner
    _owner = os.getpid()
    for number in SAID:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _end)


def ignore_signals() -> None:
    """Ignore these signals: the work is done, and the exit status is known."""
    for number in SAID:
        signal.signal(number, signal.SIG_IGN)


class no_signals:
    """A block that these signals wait for."""

    def __enter__(self) -> None:
        self._before = signal.pthread_sigmask(signal.SIG_BLOCK, SAID)

    def __exit__(self, *_: object) -> None:
        signal.pthread_sigmask(signal.SIG_SETMASK, self._before)


class unfinished:
    """A block that makes something: `with unfinished(put_away)` has `put_away` called when a signal ends the
    program.

    `put_away` may be called between any two steps of the block, and must decide by the files on disk what to
    remove.
    """

    def __init__(self, put_away: Callable[[], object]) -> None:
        self.put_away = put_away

    def __enter__(self) -> None:
        _unfinished.append(self.put_away)

    def __exit__(self, *_: object) -> None:
        _unfinished.remove(self.put_away)


def run(command: list[str], timeout: float, **how: Any) -> CompletedProcess[Any]:
    """Run a command without input as `subprocess.run` does, in a process group of its own, which ends with
    the command, with its time (s) and with the program. Raises OSError, subprocess.TimeoutExpired.
    """
    import subprocess

    how |= {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with no_signals():  # until its group is known
        process = subprocess.Popen(command, start_new_session=True, **how)
        _groups.append(-process.pid)
    with process:
        try:
            out, err = process.communicate(timeout=timeout)
        finally:
            _send([-process.pid], signal.SIGKILL)
            _groups.remove(-process.pid)
    return subprocess.CompletedProcess(command, process.returncode, out, err)


def _end(number: int, _frame: object) -> None:
    if os.getpid() != _owner:
        os._exit(128 + number)
    ignore_signals()
    # stopped first and killed at the end: a thread of ours could start another one when one is killed
    helpers = [*_groups, *_started()]
    _send(helpers, signal.SIGSTOP)
    for put_away in reversed(_unfinished):
        try:
            put_away()
        except Exception:
            pass  # the next run removes it

    def leave(*_: object) -> None:
        _send(helpers, signal.SIGKILL)
        os._exit(128 + number)

    for each in SAID:  # a second Ctrl-C ends the process even while the line below waits for its reader
        signal.signal(each, leave)
    line = f"tactcad: {SAID[signal.Signals(number)]}; what was not finished is as it was before\n"
    try:
        os.write(2, (("\r\x1b[K" if os.isatty(2) else "") + line).encode())
    except OSError:
        pass  # the exit status also shows it
    leave()


def _started() -> list[int]:
    """Processes that multiprocessing started, if it is loaded: those of a pool, Dask's workers, and its own
    two, which it does not list."""
    processes = sys.modules.get("multiprocessing.process")
    numbers = [child.pid for child in processes.active_children()] if processes else []
    for name, own, number in (
        ("forkserver", "_forkserver", "_forkserver_pid"),
        ("resource_tracker", "_resource_tracker", "_pid"),  # it would complain that we left it
    ):
        numbers.append(getattr(getattr(sys.modules.get(f"multiprocessing.{name}"), own, None), number, None))
    return [number for number in numbers if number]


def _send(numbers: Iterable[int], signal_number: int) -> None:
    for number in numbers:
        try:
            os.kill(number, signal_number)
        except OSError:
            pass  # it has ended
