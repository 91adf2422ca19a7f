"""Ending the program on a signal: at once, in one place, and leaving nothing half made behind.

An exception raised wherever the program happens to be would pass through libraries that swallow it or turn it
into another error, native imports above all. So the handler itself removes what is unfinished, prints one
line and exits. It waits only for the native call that is running. This module imports only what Python has
loaded anyway, because `tactcad.__main__` imports it before everything else.
"""

from __future__ import annotations

import os
import signal

TYPE_CHECKING = False  # typing is not loaded yet
if TYPE_CHECKING:
    from collections.abc import Callable

SAID = {
    signal.SIGINT: "interrupted",
    signal.SIGTERM: "terminated (SIGTERM)",
    signal.SIGHUP: "the terminal hung up (SIGHUP)",
}

_unfinished: list[Callable[[], object]] = []  # functions that remove what is unfinished
_owner = 0  # the process that they belong to: a forked helper has only a copy of the list


def end_on_signals() -> None:
    """Make SIGINT, SIGTERM and SIGHUP end this process with 128 + their number, except those that it was
    started to ignore, as by nohup.
    """
    global _owner
    _owner = os.getpid()
    for number in SAID:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _end)


def past_ending() -> None:
    """Ignore these signals: the work is done, and the exit status is known."""
    for number in SAID:
        signal.signal(number, signal.SIG_IGN)


class unfinished:
    """A block that makes something: `with unfinished(put_away)` has `put_away` called when a signal ends the
    program.

    `put_away` may be called between any two steps of the block, and must decide by what is on the disk what
    to remove.
    """

    def __init__(self, put_away: Callable[[], object]) -> None:
        self.put_away = put_away

    def __enter__(self) -> None:
        _unfinished.append(self.put_away)

    def __exit__(self, *_: object) -> None:
        _unfinished.remove(self.put_away)


def _end(number: int, _frame: object) -> None:
    if os.getpid() != _owner:
        os._exit(128 + number)
    past_ending()
    helpers = _stopped_helpers()
    for put_away in reversed(_unfinished):
        try:
            put_away()
        except Exception:
            pass  # the next run removes it

    def leave(*_: object) -> None:
        for helper in helpers:
            try:
                os.kill(helper, signal.SIGKILL)
            except OSError:
                pass
        os._exit(128 + number)

    for each in SAID:  # a second Ctrl-C ends the process even while the line below waits for its reader
        signal.signal(each, leave)
    line = f"tactcad: {SAID[signal.Signals(number)]}; what was not finished is as it was before\n"
    try:
        os.write(2, (("\r\x1b[K" if os.isatty(2) else "") + line).encode())
    except OSError:
        pass  # the exit status says it too
    leave()


def _stopped_helpers(of: str = "self") -> list[int]:
    """Stop the processes that this one started, and theirs, each before its own children are listed, or it
    could start another meanwhile: their numbers. A thread of ours could do so when one is killed.
    """
    stopped: list[int] = []
    try:
        threads = os.listdir(f"/proc/{of}/task")
    except OSError:
        threads = []  # no such list on this system, or the process has ended
    for thread in threads:
        try:
            with open(f"/proc/{of}/task/{thread}/children", encoding="ascii") as children:
                for child in children.read().split():
                    os.kill(int(child), signal.SIGSTOP)
                    stopped += [int(child), *_stopped_helpers(child)]
        except OSError:
            pass  # the thread has ended
    return stopped
