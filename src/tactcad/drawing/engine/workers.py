"""Work in processes that end with the export, however it ends: drawings, in parallel on the machine's cores;
and what the kernel may crash on.
"""

from __future__ import annotations

import ctypes
import gc
import multiprocessing
import os
import signal
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from dataclasses import dataclass
from itertools import count
from typing import Protocol

from tactcad.design.messages import CheckFailure
from tactcad.ending import past_ending

PR_SET_PDEATHSIG = 1  # Linux, prctl(2)
EVERY = 2.0  # s between messages while a drawing is waited for


@dataclass(frozen=True)
class Written:
    """A drawing."""

    pdf: bytes
    svg: bytes


class Named(Protocol):
    """What a drawing is made of: it knows what it is called."""

    @property
    def name(self) -> str: ...


def end_with(parent: int) -> None:
    """Let this process be killed when its parent, of that number, is gone.

    A forked helper whose parent was killed would wait for work for ever, and hold what it inherited, the lock
    of the export's folder included. Systems without prctl leave it waiting. Ctrl-C and a terminal's end reach
    the helper too, but the parent answers them; SIGTERM is how the pool ends it.
    """
    gc.freeze()
    past_ending()
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with suppress(AttributeError, OSError):
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # the parent was gone before
        os._exit(1)


def _pool(count: int) -> ProcessPoolExecutor:
    # fork: the kernel is loaded already, and runs no threads of its own (its booleans and meshes are serial)
    return ProcessPoolExecutor(count, multiprocessing.get_context("fork"), end_with, (os.getpid(),))


def all_written(
    orders: Sequence[Named],
    make: Callable[..., Written],
    say: Callable[[int, int, str], None] = lambda *_: None,
) -> list[Written]:
    """Make drawings side by side on the machine's cores, each by `make` in a process of its own.

    `say` receives (done, total, text) at least every EVERY seconds. Raises CheckFailure for the first that
    cannot be drawn, or where a process was killed.
    """
    if not orders:
        return []
    cores = min(len(os.sched_getaffinity(0)), len(orders))
    # even a single drawing has a process of its own: the kernel would block this one, and nothing could be
    # shown meanwhile.
    made: list[Written] = []
    with _pool(cores) as pool:
        futures = [pool.submit(make, order) for order in orders]
        try:
            for n, (order, future) in enumerate(zip(orders, futures)):
                say(n, len(orders), f"drawing of {order.name}")
                for rounds in count(1):
                    if wait([future], EVERY).done:
                        break
                    say(n, len(orders), f"drawing of {order.name} (for {rounds * EVERY:g} s)")
                made.append(future.result())
        except BrokenProcessPool as error:
            killed = "drawings: a process that made them was killed; no drawing was written"
            raise CheckFailure(killed) from error
        finally:
            for future in futures:
                future.cancel()
    say(len(orders), len(orders), "done")
    return made


def made_apart(name: str, make: Callable[..., bytes], *arguments: object) -> bytes:
    """What `make` returns, made in a process of its own.

    Raises CheckFailure, naming it, where that process was killed or crashed; else what `make` raises.
    """
    with _pool(1) as pool:
        try:
            return pool.submit(make, *arguments).result()
        except BrokenProcessPool as error:
            raise CheckFailure(f"{name}: the process that made it crashed or was killed") from error
