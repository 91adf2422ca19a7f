"""How a signal ends the program: at once, by one door, with nothing half made left behind.

An exception raised wherever the program happens to be would pass through libraries that swallow it or turn it
into another error, native imports above all. So the handler itself puts away what is unfinished, says one
line and exits. It waits only for the native call that is running. Nothing but what Python has loaded anyway
is imported here: `tactcad.__main__` lets it stand before everything else.
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

_unfinished: list[Callable[[], object]] = []  # what puts it away
_owner = 0  # the process whose unfinished things they are: a forked helper has only a copy


def end_on_signals() -> None:
    """From now on SIGINT, SIGTERM and SIGHUP end this process with 128 + their number; what it was started to
    ignore, as nohup does, stays ignored."""
    global _owner
    _owner = os.getpid()
    for number in SAID:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _end)


def past_ending() -> None:
    """Ignore them: the work is done, and the exit status is known."""
    for number in SAID:
        signal.signal(number, signal.SIG_IGN)


class unfinished:
    """Around the making of something: `with unfinished(put_away)` has `put_away` called when a signal ends
    the program.

    It may be called between any two steps of the block, and must tell by what lies on the disk what is to go.
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
    _kill_helpers()
    for put_away in reversed(_unfinished):
        try:
            put_away()
        except Exception:
            pass  # the next run does it
    for each in SAID:  # whoever presses Ctrl-C again does not wait for a reader that takes no line
        signal.signal(each, signal.SIG_DFL)
    line = f"tactcad: {SAID[signal.Signals(number)]}; what was not finished is as it was before\n"
    try:
        os.write(2, (("\r\x1b[K" if os.isatty(2) else "") + line).encode())
    except OSError:
        pass  # the status tells it
    os._exit(128 + number)


def _kill_helpers(of: str = "self") -> None:
    """The processes that this one started, and theirs: they work for nobody now. Each stands still before it
    is asked for its own, or it would start another meanwhile."""
    try:
        for thread in os.listdir(f"/proc/{of}/task"):
            with open(f"/proc/{of}/task/{thread}/children", encoding="ascii") as children:
                for child in children.read().split():
                    os.kill(int(child), signal.SIGSTOP)
                    _kill_helpers(child)
                    os.kill(int(child), signal.SIGKILL)
    except OSError:
        pass  # no such list here, or one that ended by itself
