"""A study's tasks on Dask, which decides where and when each runs; results go to the store, not through
it."""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from importlib import metadata
from itertools import islice
from multiprocessing import forkserver
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Protocol

from tactcad.design.messages import CheckFailure, InputError, install
from tactcad.export.inputs import Inputs, reasons

from .measured import made_by, measured
from .store import MARK, StudyStore, mark_of
from .study import EXPORT, Study

if TYPE_CHECKING:
    from distributed import Client, LocalCluster

# Tasks that the scheduler knows of at a time: enough for some hundred workers, and little memory however
# many designs there are.
AT_ONCE = 500
ANSWER = "10s"  # within which a scheduler answers, or nobody is there

# Of workers on this machine. Dask has their C library give back every freed array at once; vector calls then
# take 2.5 times as long, measured. Up to these sizes (bytes) it keeps them; of the second, 32 MiB is the most
# that it takes. A process uses one core: there is one for each.
ENVIRONMENT = {
    "MALLOC_TRIM_THRESHOLD_": str(1 << 28),
    "MALLOC_MMAP_THRESHOLD_": str(1 << 25),
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
}

# Dask's own log messages, which this module replaces by a line.
LOGS = ("distributed", "distributed.client", "tornado.application", "asyncio")
QUIET = {"logging": dict.fromkeys(LOGS, "critical")}

NO_HELPERS = "may start no processes, which an export needs; it needs DASK_DISTRIBUTED__WORKER__DAEMON=False"

# One task at a time in a process, whatever threads its worker has: the CAD kernel holds the interpreter's
# lock, and is not made for threads.
_ALONE = threading.Lock()


@dataclass(frozen=True)
class Done:
    """A task at its end: whether it was computed now, or found in the store; `unable`: why neither.

    `seconds`: processor time of computing, without what the store takes.
    """

    start: int
    designs: int
    computed: bool
    unable: str = ""
    seconds: float = 0.0


class SweepOrder(Protocol):
    """A task for a worker."""

    def carry_out(self) -> Done:
        """Do it, unless the store has it: Dask runs tasks of a dead worker again, finished ones too."""


@dataclass(frozen=True)
class SweepTask:
    """Designs `start` to `stop` (exclusive) of a study, kept in `folder` or at the address `store`, made by
    `inputs`."""

    study: Study
    inputs: Inputs
    folder: str
    start: int
    stop: int
    store: str | None = None

    def carry_out(self) -> Done:
        which = self.start, self.stop - self.start
        what = self.study.measure.what
        if self.inputs != (own := made_by(what)):
            return Done(*which, False, "is of another version: " + "; ".join(reasons(own, self.inputs)[:3]))
        if EXPORT in what and multiprocessing.current_process().daemon:
            return Done(*which, False, NO_HELPERS)
        folder = Path(self.folder)
        if (self.store is None or EXPORT in what) and not self._sees(folder):
            return Done(*which, False, f"does not see {folder}: every worker needs the same folder there")
        try:
            store = StudyStore(self.study, folder, self.inputs.key, self.store)
            if store.get(self.start, self.stop) is not None:
                return Done(*which, False)
            start = time.process_time()
            table = measured(self.study, self.start, self.stop, folder)
            seconds = time.process_time() - start
        except InputError as error:  # of an export's folder, or of the store: it has no pickle
            return Done(*which, False, f"cannot go on: {error}")
        store.put(self.start, self.stop, table)
        return Done(*which, True, seconds=seconds)

    def _sees(self, folder: Path) -> bool:
        return (folder / MARK).is_file() and mark_of(folder).get("study") == self.study.identity


def _carried_out(order: SweepOrder) -> Done:
    with _ALONE:
        return order.carry_out()


@contextmanager
def cluster(
    address: str | None,
    workers: int,
    loads: list[str],
    prepare: Callable[[], None],
    say: Callable[[str], None],
    scratch: Path,
) -> Iterator[Client]:
    """A client of the scheduler at that address, or of processes on this machine if there is none.

    Parameters
    ----------
    address
        As "tcp://HOST:8786".
    workers
        Processes on this machine.
    loads
        Modules that these start with; never the CAD kernel, which cannot be forked.
    prepare
        Work to do here meanwhile.
    say
        Receives the dashboard's address.
    scratch
        A folder for temporary files of the processes on this machine.

    Raises
    ------
    InputError
        If nobody answers.
    """
    import dask

    with ExitStack() as stack:
        if address is None:
            stack.enter_context(_environment(ENVIRONMENT | {"TMPDIR": str(scratch)}))
            stack.enter_context(_loaded_ahead(loads, scratch))  # in a process of its own
        prepare()  # in no thread: Dask's own would wait for the interpreter's lock, in all for longer
        loaded = _distributed()
        ours = {"distributed.worker.daemon": False, "distributed.worker.multiprocessing-method": "forkserver"}
        stack.enter_context(dask.config.set({**QUIET, **ours, "temporary-directory": str(scratch)}))
        if address is not None:
            client = stack.enter_context(_connected(loaded.Client, address))
            _refuse_without_tactcad(client)
            say(f"dashboard: {client.dashboard_link}; workers now: {len(client.nthreads())}")
        else:
            local = stack.enter_context(_started(loaded.LocalCluster, workers))
            client = stack.enter_context(loaded.Client(local))
            say(f"dashboard: {client.dashboard_link}")
        yield client


@contextmanager
def _environment(values: Mapping[str, str]) -> Iterator[None]:
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name in values:
            os.environ.pop(name, None)
        os.environ.update({name: value for name, value in before.items() if value is not None})


@contextmanager
def _loaded_ahead(modules: list[str], scratch: Path) -> Iterator[None]:
    """The process from which workers are forked: they share its loaded modules, and without threads it can be
    forked. It is reached by a socket in `scratch`."""
    config: dict[str, object] = vars(multiprocessing.current_process())["_config"]
    folder = os.open(scratch, os.O_RDONLY)  # by its number, as a socket's path has at most 107 bytes
    config["tempdir"] = f"/proc/self/fd/{folder}"
    multiprocessing.set_forkserver_preload(["distributed", *modules])
    forkserver.ensure_running()
    try:
        yield
    finally:
        server = vars(forkserver)["_forkserver"]
        os.kill(server._forkserver_pid, signal.SIGKILL)  # to end by itself takes it most of a second
        server._stop()  # the next sweep starts its own, with its own socket
        config["tempdir"] = None
        os.close(folder)


def _started(local: type[LocalCluster], workers: int) -> LocalCluster:
    """Processes of one thread each."""
    try:
        return local(
            n_workers=workers,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            silence_logs=logging.CRITICAL,
        )
    except RuntimeError as error:
        raise CheckFailure(f"a process on this machine ended while it was started: {error}") from error


def _distributed() -> ModuleType:
    """Dask's `distributed`, quiet: it reads how when it is loaded, which is also when Dask gets its other
    settings."""
    import dask

    with dask.config.set(QUIET):
        import distributed
    return distributed


def refuse_unanswered(address: str) -> None:
    """Raise InputError if no scheduler answers, or a worker of its has no tactcad."""
    with _connected(_distributed().Client, address) as client:
        _refuse_without_tactcad(client)


def _connected(client: type[Client], address: str) -> Client:
    try:
        return client(address, timeout=ANSWER)
    except (OSError, ValueError) as error:  # a timeout is an OSError
        legal = "a Dask scheduler, as tcp://HOST:8786"
        raise InputError("--scheduler", "no scheduler answers there", value=address, legal=legal) from error


def _refuse_without_tactcad(client: Client) -> None:
    """A worker without tactcad cannot even read a task: it would end, and the study would wait."""
    try:
        client.run(metadata.version, "tactcad")
    except metadata.PackageNotFoundError as error:
        raise InputError("a worker", "has no tactcad", legal=f"{install('sweep')} there") from error


def all_done(client: Client, orders: Iterable[SweepOrder]) -> Iterator[Done]:
    """Each task's end, as they come; never more than AT_ONCE of them are handed out.

    Raises
    ------
    InputError
        If a worker is of another version, or does not see the folder.
    CheckFailure
        If a task killed every worker it was given to, or the scheduler is gone.
    """
    from distributed import CancelledError, KilledWorker, as_completed
    from distributed.comm.core import CommClosedError

    left = iter(orders)
    running = as_completed(client.map(_carried_out, list(islice(left, AT_ONCE)), pure=False))
    try:
        for future in running:
            done = future.result()
            if done.unable:
                raise InputError("a worker", done.unable)
            yield done
            for order in islice(left, 1):
                running.add(client.submit(_carried_out, order, pure=False))
    except KilledWorker as error:
        raise CheckFailure(
            f"a task killed every worker it was given to, the last one {error.last_worker.address}: too "
            "little memory? What was finished is kept"
        ) from error
    except ImportError as error:
        legal = f"{install('cad', 'sweep')} there"
        raise InputError("a worker", f"lacks {error.name}: {error}", legal=legal) from error
    except (CancelledError, CommClosedError, TimeoutError) as error:
        raise CheckFailure(
            "the scheduler is gone; what was finished is kept, and the same command goes on from there"
        ) from error


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0))
