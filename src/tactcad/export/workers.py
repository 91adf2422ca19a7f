"""Work side by side, on every core that this process may use: in processes that end with the export, however
it ends.

They are forked: the kernel is loaded once, and a task's data is present. None starts threads; a worker that
crashes in the kernel leaves its task's name.
"""

from __future__ import annotations

import ctypes
import gc
import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Generator, Sequence
from contextlib import nullcontext, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any

from tactcad import profiling
from tactcad.design.messages import CheckFailure
from tactcad.shutdown import ignore_signals

PR_SET_PDEATHSIG = 1  # Linux, prctl(2)
EVERY = 2.0  # s between messages while something is waited for

_to_parent: Connection | None = None  # in a worker


@dataclass(frozen=True)
class Task:
    """A task: its name, its function, and its turn: those of a later turn need the results of earlier
    ones."""

    name: str
    make: Callable[[], Any]
    turn: int = 0


def relayed(say: Callable[[str], None]) -> Callable[[str], None]:
    """`say` in this process; in a worker, a relay to it."""
    return lambda text: _to_parent.send(("said", text)) if _to_parent else say(text)


def side_by_side(
    tasks: Sequence[Task],
    hear: Callable[[str], None] = lambda _: None,
    say: Callable[[str], None] = lambda _: None,
    every: float = EVERY,
) -> Generator[tuple[int, Any], None, None]:
    """Make everything, as many at once as there are cores; yields number and result of each that is ready.

    Within a turn they start in the order given; a turn starts when the one before it was taken up.

    Parameters
    ----------
    tasks
        Even a single one has its own process: the kernel would block this one, or crash it.
    hear
        Receives the tasks under way, at least every `every` seconds; an exception from it ends the work.
    say
        Receives lines from `relayed`, each once.

    Raises
    ------
    CheckFailure
        If a process was killed or crashed, with its task; else a task's own exception. The others are ended.
    """
    cores = min(len(os.sched_getaffinity(0)), len(tasks))
    waiting = sorted(range(len(tasks)), key=lambda n: tasks[n].turn)
    busy: dict[Connection, tuple[int, float]] = {}
    heard: dict[Connection, str] = {}
    lines: set[str] = set()
    idle, processes = [], []
    try:
        for _ in range(cores):
            pipe, process = _started(tasks)
            idle.append(pipe)
            processes.append(process)
        while waiting or busy:
            while idle and waiting and all(tasks[n].turn == tasks[waiting[0]].turn for n, _ in busy.values()):
                pipe, n = idle.pop(), waiting.pop(0)
                pipe.send(n)
                busy[pipe] = n, time.monotonic()
                hear(f"{tasks[n].name} (making)")
            ready = wait([*busy], every)
            for pipe in [] if ready else [min(busy, key=lambda each: busy[each][1])]:
                n, since = busy[pipe]
                hear(f"{tasks[n].name} ({heard.get(pipe) or f'for {time.monotonic() - since:.0f} s'})")
            for pipe in (pipe for pipe in busy.copy() if pipe in ready):
                n, _ = busy[pipe]
                try:
                    kind, content = pipe.recv()
                except (EOFError, OSError) as error:
                    name = tasks[n].name
                    raise CheckFailure(f"{name}: the process that made it crashed or was killed") from error
                if kind == "under way":
                    heard[pipe] = content
                    hear(f"{tasks[n].name} ({content})")
                elif kind == "said":
                    if content not in lines:
                        say(content)
                    lines.add(content)
                else:
                    del busy[pipe]
                    heard.pop(pipe, None)
                    idle.append(pipe)
                    if kind == "failed":
                        raise content
                    result, made = content
                    profiling.add(made)
                    yield n, result
    finally:
        for process in processes:
            process.kill()
        for process in processes:
            process.join()


def _started(tasks: Sequence[Task]) -> tuple[Connection, multiprocessing.process.BaseProcess]:
    forked = multiprocessing.get_context("fork")
    ours, theirs = forked.Pipe()
    process = forked.Process(target=_serve, args=(theirs, tasks, os.getpid()), daemon=True)
    process.start()
    theirs.close()  # or the end of that process would not be seen here
    return ours, process


def _serve(pipe: Connection, tasks: Sequence[Task], parent: int) -> None:
    """In a worker: make what the parent asks for, until it asks no more."""
    global _to_parent
    # Let this process be killed when its parent, of that number, is gone. A forked helper whose parent was
    # killed would wait for work for ever, and hold what it inherited, the lock of the export's folder
    # included. Systems without prctl leave it waiting. Ctrl-C and a terminal's end reach the helper too,
    # but the parent answers them.
    gc.freeze()
    ignore_signals()
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with suppress(AttributeError, OSError):
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # the parent was gone before
        os._exit(1)
    _to_parent = pipe
    counted = profiling.is_counted()
    while True:
        try:
            task = tasks[pipe.recv()]
        except (EOFError, OSError):
            return
        try:
            with (
                profiling.listening(lambda text: pipe.send(("under way", text))),
                profiling.profiled() if counted else nullcontext() as own,
            ):
                result = task.make()
            answer: tuple[str, Any] = ("made", (result, own.made if own else []))
        except Exception as error:
            answer = "failed", error
        pipe.send(answer)
