"""A sweep's overhead, as the tables of benchmarks/results/sweeps.md.

    python benchmarks/sweeps.py benchmarks/results/sweeps.md --designs 10000000    some quiet minutes

Every sweep is one of this machine's own processes, into a new folder. Memory is what each process holds in
pages (RSS), looked at every 0.2 s. Rates are by processor time, which other work on the machine hardly moves;
seconds of a whole sweep, and of two workers against one, want a quiet machine.
"""

from __future__ import annotations

import argparse
import dataclasses
import os
import shutil
import tempfile
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path

import psutil
import pyarrow.parquet as pq
from measuring import processor_seconds
from tables import filled, lines

from tactcad.design.design_text import design_text
from tactcad.design.load import read
from tactcad.mechanics import ladder
from tactcad.mechanics.accuracy import expected_error_of
from tactcad.parts.array.hinge_section import element_section
from tactcad.sweep import measured as one_task
from tactcad.sweep import run_sweep
from tactcad.sweep.designs_taken import designs_taken
from tactcad.sweep.measured import Refused, alike
from tactcad.sweep.study import Study, read_study

HEAD = '[study]\nname = "speed"\nsampling = "sobol"\ncount = {count}\nseed = 0\n'
VARY = (
    '[vary."element.hinge_thickness"]\nrange = [0.2, 0.4]\n'
    '[vary."array.row_arms[0][3]"]\nrange = [5, 9]\n'
    '[vary."element.fillet_radius"]\nrange = [0.25, 0.35]\n'
)
CLOSED = '[measure]\nwhat = ["solid"]\nelements = [4]\n'
ELEMENTS = '[measure]\nwhat = ["fem-plane"]\nelements = [4]\n'
EXPORTS = '[measure]\nwhat = ["export"]\n'
SMALL_TASKS, PLANE, SOLID, EXPORTED = 400, 480, 120, 24
RUNS = 5  # of the closed forms: the middle one is published


def study_of(folder: Path, count: int, measure: str, head: str = "") -> Study:
    path = folder / "study.toml"
    vary = VARY.partition('[vary."array')[0] if head else VARY
    path.write_text(HEAD.format(count=count) + head + vary + measure)
    return read_study(path)


@contextmanager
def watched() -> Iterator[dict[str, float]]:
    """Most memory of this process, and of any that it started, in MB."""
    most, ended, me = {"client": 0.0, "worker": 0.0}, threading.Event(), psutil.Process()

    def look() -> None:
        while not ended.wait(0.2):
            most["client"] = max(most["client"], me.memory_info().rss / 1e6)
            for child in me.children(recursive=True):
                try:
                    most["worker"] = max(most["worker"], child.memory_info().rss / 1e6)
                except psutil.Error:
                    pass

    thread = threading.Thread(target=look)
    thread.start()
    try:
        yield most
    finally:
        ended.set()
        thread.join()


def swept(study: Study, folder: Path, workers: int) -> run_sweep.Swept:
    return run_sweep.sweep(study, folder, None, workers, False, lambda _: None, lambda *_: None)


def bare(study: Study) -> float:
    """Processor seconds of the same calls, one design each, in this process, nothing kept."""
    one_task.measured(study, 0, 1, Path())  # load all modules once
    return processor_seconds(lambda: [one_task.measured(study, i, i + 1, Path()) for i in range(study.count)])


def vector_call(study: Study) -> float:
    """Designs a second of processor time of the closed form and its promised error alone, in one call."""
    columns = designs_taken(study, 0, study.count)
    ((_, many),) = alike(study, columns, Refused(study.count))
    section = element_section(many, many.elements[3])

    def call() -> None:
        ladder.evaluate(section, "solid")
        expected_error_of(section, "solid")

    return study.count / min(processor_seconds(call) for _ in range(3))


def overhead(folder: Path) -> str:
    study, usual = study_of(folder, SMALL_TASKS, CLOSED), one_task.CLOSED_FORMS_A_TASK
    one_task.CLOSED_FORMS_A_TASK = 1
    try:
        took = swept(study, folder / "small", 1).seconds["computing"]
    finally:
        one_task.CLOSED_FORMS_A_TASK = usual
    call = bare(study)
    spent = {"calling the function": call, "as a task, kept in the store": took, "overhead": took - call}
    rows = [(name, f"{1e3 * seconds / SMALL_TASKS:.2g}") for name, seconds in spent.items()]
    return lines("one task of one closed form | ms", rows)


def two_workers(folder: Path) -> str:
    """One worker against two, from the first task to the last: without starting, and loading the kernel."""
    rows = []
    one_element(folder / "small.toml")
    for what, count, measure, head in (
        ("elements by fem-plane", PLANE, ELEMENTS, ""),
        ("elements by fem-solid", SOLID, ELEMENTS.replace("plane", "solid"), ""),
        ("exports of an array of one element", EXPORTED, EXPORTS, 'design = "small.toml"\n'),
    ):
        load, took = os.getloadavg()[0], []
        study = study_of(folder, count, measure, head)
        for n in (1, 2):
            shutil.rmtree(folder / "cache", ignore_errors=True)  # exports find in it what an earlier one made
            took.append(per_task(study, folder / f"{what} {n}", n) * count)
        one, two = took
        rows.append((f"{count} {what}", f"{one:.3g}", f"{two:.3g}", f"{one / two:.2f}", f"{load:.2g}"))
    return lines("worker processes | 1, s | 2, s | times as fast | load before", rows)


def per_task(study: Study, folder: Path, workers: int) -> float:
    """Seconds a task, between the first `workers` of them and the last."""
    ends: list[float] = []
    run_sweep.sweep(
        study, folder, None, workers, False, lambda _: None, lambda *_: ends.append(time.perf_counter())
    )
    done = ends[-study.count :]
    return (done[-1] - done[workers - 1]) / (study.count - workers)


def one_element(path: Path) -> None:
    macro = read("macro-array")
    rigs = dict.fromkeys(("cart", "holder", "sample", "calibration", "grasping"))
    array = dataclasses.replace(macro.array, row_arms=((6.0,),))
    origin = {"material.youngs_modulus": "the paper's"}
    path.write_text(design_text(dataclasses.replace(macro, array=array, origin=origin, **rigs)))


def whole_sweep(folder: Path, designs: int, name: str) -> tuple[run_sweep.Swept, float]:
    """A study of closed forms, and the seconds that it took."""
    study = study_of(folder, designs, CLOSED)
    start = time.perf_counter()
    got = swept(study, folder / name, 2)
    return got, time.perf_counter() - start


def in_fresh_process(folder: Path, designs: int, name: str) -> tuple[run_sweep.Swept, float]:
    """`whole_sweep` in a process without Dask. Its store, no longer needed, takes no memory then."""
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        found = pool.submit(whole_sweep, folder, designs, name).result()
    shutil.rmtree(folder / name / "store")
    return found


def closed_forms(folder: Path, designs: int) -> str:
    study, load = study_of(folder, designs, CLOSED), os.getloadavg()[0]
    runs = [in_fresh_process(folder, designs, f"closed {n}") for n in range(RUNS)]
    got, whole = sorted(runs, key=lambda run: run[1])[RUNS // 2]
    with watched() as memory:  # of another run, which looking takes time from
        swept(study, folder / "watched", 2)
    some = study_of(folder, min(designs, 1 << 19), CLOSED)
    rate = vector_call(some)
    table = pq.read_table(got.folder / "results.parquet")
    start = time.perf_counter()
    pq.write_table(table, folder / "once.parquet")
    once = time.perf_counter() - start
    inside = designs / got.in_workers
    rows = {
        f"load of the machine before, of {os.cpu_count()} cores": f"{load:.2g}",
        **{f"{name}, s": f"{seconds:.3g}" for name, seconds in got.seconds.items()},
        "whole, s": f"{whole:.3g}",
        "the same columns written once by pyarrow, s": f"{once:.3g}",
        "whole against that": f"{whole / once:.2g}",
        "designs a second of processor time inside workers": f"{inside:.3g}",
        "of the vector call alone": f"{rate:.3g}",
        "share": f"{inside / rate:.2g}",
        "most memory of the client, MB": f"{memory['client']:.0f}",
        "most memory of a worker, MB": f"{memory['worker']:.0f}",
        "results.parquet, MB": f"{(got.folder / 'results.parquet').stat().st_size / 1e6:.0f}",
    }
    return lines(f"{designs:.0e} closed forms, 2 worker processes | ", list(rows.items()))


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("document", type=Path, help="Markdown file that has the tables' place")
    parser.add_argument("--designs", type=int, default=1_000_000, help="closed forms (default 1e6)")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        os.environ["TACTCAD_CACHE"] = str(folder / "cache")  # empty
        parts = [closed_forms(folder, args.designs), overhead(folder), two_workers(folder)]
    text = args.document.read_text("utf-8")
    args.document.write_text(filled(text, "sweeps", "\n\n".join(parts)), "utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
