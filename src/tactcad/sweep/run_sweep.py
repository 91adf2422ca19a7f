"""A study from its file to its table: results missing in the store are computed, then all are joined chunk by
chunk to Parquet and CSV, never whole in memory."""

from __future__ import annotations

import hashlib
import io
import time
from collections import Counter
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import AbstractContextManager, ExitStack, closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tactcad import __version__
from tactcad.design.files import absolute, scratch_folder, whole_file, write_whole
from tactcad.design.messages import CheckFailure
from tactcad.export.manifest import NAME as MANIFEST
from tactcad.export.manifest import sealed
from tactcad.shutdown import unfinished

from .designs_taken import prepared
from .measured import as_rows, designs_a_task, loaded_first, made_by
from .on_dask import Done, SweepTask, all_done, cluster, refuse_unanswered
from .store import MARK, SCHEMA, FarStore, StudyStore, claimed, store_apart
from .study import Study

if TYPE_CHECKING:
    import pyarrow as pa
    from distributed import Client

MOST_CSV = 1_000_000  # rows that are written as CSV unasked


@dataclass(frozen=True)
class Swept:
    """A finished study: its folder, its files, designs computed now and taken from the store, seconds that
    starting, computing and writing took; `in_workers`: processor seconds of the measuring alone."""

    folder: Path
    files: tuple[str, ...]
    tally: Tally
    computed: int
    kept: int
    seconds: dict[str, float]
    in_workers: float


def sweep(
    study: Study,
    out: str | Path,
    address: str | None,
    workers: int,
    with_csv: bool,
    say: Callable[[str], None],
    tell: Callable[[int, int, str], None],
    store: str | None = None,
) -> Swept:
    """Measure every design of a study that is not measured yet, and write the table.

    Parameters
    ----------
    study
        As read.
    out
        Its folder: new, empty, or this study's.
    address
        Of a Dask scheduler; None for processes on this machine.
    workers
        How many of those.
    with_csv
        Whether CSV is written for any number of rows.
    say
        Receives lines worth keeping.
    tell
        Receives (done, total, text) as designs finish.
    store
        An fsspec address that keeps finished results; None for the folder.

    Raises
    ------
    InputError
        The folder holds something else, nobody answers at the address, or a worker is of another version.
    CheckFailure
        Workers died of a task, or the scheduler is gone; what was finished stays.
    """
    apart = store_apart(store, absolute(out)) if store is not None else None
    # what cannot be used is refused before the folder is this study's
    if not (absolute(out) / MARK).exists():
        if store is not None and apart is not None:
            FarStore(store)
        if address is not None:
            refuse_unanswered(address)
    folder = claimed(study, out)
    inputs = made_by(study.measure.what)
    kept = StudyStore(study, folder, inputs.key, apart)
    kept.tidy()
    step, count = designs_a_task(study), study.count
    tasks = [(start, min(start + step, count)) for start in range(0, count, step)]
    tell(0, count, "reading what is finished")
    missing = [task for task in tasks if kept.get(*task) is None]
    orders = [SweepTask(study, inputs, str(folder), *task, apart) for task in missing]
    work = _Work(count, sum(stop - start for start, stop in missing), tell)
    with_csv = with_csv or count <= MOST_CSV
    with unfinished(lambda: kept.tidy(address is None)), scratch_folder("sweep") as scratch:
        on = address, min(workers, len(missing)), loaded_first(study), lambda: prepared(study), say, scratch
        with closing(work.done_on(cluster(*on), orders)) as done:
            tally = write_tables(folder, _chunks(kept, tasks, orders, done), with_csv, study.vary)
    write_whole(folder / MANIFEST, _manifest(study, folder, tally))
    work.lap("writing")
    files, computed = (*tally.sha256, MANIFEST), work.computed
    return Swept(folder, files, tally, computed, count - computed, work.seconds, work.in_workers)


def _chunks(
    kept: StudyStore, tasks: list[tuple[int, int]], orders: list[SweepTask], done: Iterator[Done]
) -> Iterator[pa.Table]:
    """Every task's rows in the order of the designs, each as soon as it is kept, so that most of the table is
    written during the computation."""
    running = {order.start for order in orders}
    for start, stop in tasks:
        while start in running:
            running.remove(next(done).start)
            if not running:
                next(done, None)  # the cluster ends
        table = kept.get(start, stop)
        if table is None:
            raise CheckFailure(f"{kept.folder}: designs {start + 1} to {stop} are damaged; run it again")
        yield as_rows(kept.study, start, table)


class _Work:
    """Progress of `wanted` designs of `count`, and the times of its parts."""

    def __init__(self, count: int, wanted: int, tell: Callable[[int, int, str], None]) -> None:
        self.count, self.wanted, self.tell = count, wanted, tell
        self.computed, self.in_workers = 0, 0.0
        self.seconds: dict[str, float] = {}
        self._last = time.perf_counter()

    def done_on(
        self, clusters: AbstractContextManager[Client], orders: list[SweepTask]
    ) -> Generator[Done, None, None]:
        """Tasks as they finish, on a cluster that is there until all have."""
        if not orders:
            return
        before, finished = self.count - self.wanted, 0
        self.tell(before, self.count, "starting")
        with clusters as client:
            self.lap("starting")
            self.tell(before, self.count, "designs, none finished yet")
            for each in all_done(client, orders):
                finished += each.designs
                self.computed += each.designs * each.computed
                self.in_workers += each.seconds
                self.tell(before + finished, self.count, self._rate(finished))
                yield each
            self.lap("computing")
        self.lap("ending")

    def lap(self, name: str) -> None:
        """A part has ended."""
        now = time.perf_counter()
        self.seconds[name] = round(now - self._last, 3)
        self._last = now

    def _rate(self, finished: int) -> str:
        rate = finished / max(time.perf_counter() - self._last, 1e-6)
        left = (self.wanted - finished) / rate
        units = f"{left:.0f} s" if left < 120 else f"{left / 60:.0f} min"
        return f"designs, {rate:.3g} a second, {units if left < 7200 else f'{left / 3600:.1f} h'} left"


def _manifest(study: Study, folder: Path, tally: Tally) -> bytes:
    inputs = made_by(study.measure.what)
    record = {
        "schema": SCHEMA,
        "study": {
            "name": study.study.name,
            "sha256": study.identity,
            "table": _plain(study.study),
            "vary": {path: _plain(one) for path, one in study.vary.items()},
            "measure": _plain(study.measure),
            "design": study.base,
        },
        "designs": tally.rows,
        "refused": tally.refused,
        "versions": {"tactcad": __version__, **inputs.libraries},
        "sources": dict(inputs.sources),
        "files": [
            {"path": name, "sha256": sha256, "bytes": (folder / name).stat().st_size}
            for name, sha256 in tally.sha256.items()
        ],
    }
    return sealed(record)


def _plain(table: object) -> dict:
    """A table of the study as its file has it."""
    return {name: value for name, value in vars(table).items() if value is not None}


PARQUET, CSV = "results.parquet", "results.csv"
ROWS_A_GROUP = 1 << 16  # of Parquet: a reader takes a row group at once
SELDOM = 16  # rows a value from which on a column repeats; chosen: with fewer, a dictionary saves little
LOOKED_AT = 1 << 13  # first rows that tell; chosen: counting values takes longer than writing them
MOST_REASONS = 1000  # that are counted; of more, the rest counts as one


@dataclass
class Tally:
    """A table's summary: rows, refused ones with reasons, most frequent first; its files' SHA-256."""

    rows: int = 0
    refused: int = 0
    reasons: Counter[str] = field(default_factory=Counter)
    sha256: dict[str, str] = field(default_factory=dict)

    def add(self, table: pa.Table) -> None:
        import pyarrow.compute as pc

        self.rows += table.num_rows
        refused = table.filter(pc.invert(table["valid"]))
        self.refused += refused.num_rows
        for entry in refused["reason"].value_counts().to_pylist():
            known = entry["values"] in self.reasons or len(self.reasons) < MOST_REASONS
            self.reasons[entry["values"] if known else "other reasons"] += entry["counts"]


class _Digested(io.BufferedWriter):
    """A file with its digest computed on writing: reading it back would take as long again."""

    def __init__(self, path: Path) -> None:
        super().__init__(io.FileIO(path, "wb"))
        self.sha256 = hashlib.sha256()

    def write(self, data: Any) -> int:
        self.sha256.update(data)
        return super().write(data)


def write_tables(folder: Path, chunks: Iterable[pa.Table], with_csv: bool, varied: Iterable[str]) -> Tally:
    """Write results.parquet, and results.csv if asked, each whole or not at all.

    Parameters
    ----------
    folder
        The study's.
    chunks
        Tables of one schema, in the order of the designs.
    with_csv
        Whether CSV is also written.
    varied
        Columns whose words are the user's: in CSV none is a formula.

    Raises
    ------
    InputError, CheckFailure
        As `whole_file`.
    """
    import pyarrow.csv
    import pyarrow.parquet as pq

    tally = Tally()
    with ExitStack() as stack:
        files: dict[str, _Digested] = {}
        writers: list = []
        for table in _grouped(chunks):
            if not writers:
                for name in (PARQUET, *([CSV] if with_csv else [])):
                    place = stack.enter_context(whole_file(folder / name))
                    files[name] = stack.enter_context(_Digested(place))
                parquet = pq.ParquetWriter(files[PARQUET], table.schema, **_encoded(table))
                writers.append(stack.enter_context(parquet))
                if with_csv:
                    writers.append(stack.enter_context(pyarrow.csv.CSVWriter(files[CSV], table.schema)))
            for n, writer in enumerate(writers):
                writer.write_table(_without_formulas(table, varied) if n else table)
            tally.add(table)
    tally.sha256 = {name: file.sha256.hexdigest() for name, file in files.items()}
    return tally


def _without_formulas(table: pa.Table, names: Iterable[str]) -> pa.Table:
    """For CSV: an apostrophe before each word that a spreadsheet would run, or that begins with one, so that
    the first can always be removed again."""
    import pyarrow.compute as pc

    for name in names:
        if table[name].type == "string":
            words = pc.replace_substring_regex(table[name], r"^('*[=+\-@\t\r])", r"'\1")
            table = table.set_column(table.column_names.index(name), name, words)
    return table


def _encoded(first: pa.Table) -> dict[str, Any]:
    """Parquet's encoding of a study's columns. Drawn numbers neither repeat nor compress, and trying doubles
    the time. Repeated values are kept as a dictionary and runs of places in it; designs' own numbers as
    steps."""
    import pyarrow as pa
    import pyarrow.compute as pc

    names, head = first.column_names, first.slice(0, LOOKED_AT)
    repeat = [n for n in names if SELDOM * pc.count_distinct(head[n]).as_py() <= head.num_rows]
    return {
        "use_dictionary": repeat,
        "column_encoding": {"number": "DELTA_BINARY_PACKED"},
        "compression": {n: "snappy" if pa.types.is_string(first[n].type) else "none" for n in names},
    }


def _grouped(chunks: Iterable[pa.Table]) -> Iterable[pa.Table]:
    """Small chunks joined to row groups."""
    import pyarrow as pa

    waiting: list[pa.Table] = []
    rows = 0
    for chunk in chunks:
        waiting.append(chunk)
        rows += chunk.num_rows
        if rows >= ROWS_A_GROUP:
            yield pa.concat_tables(waiting).combine_chunks()
            waiting, rows = [], 0
    if waiting:
        yield pa.concat_tables(waiting).combine_chunks()
