"""A study of a second, and what tests change of it; the command in a process of its own."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import psutil

from tactcad.cli.main import main
from tactcad.sweep.measured import made_by
from tactcad.sweep.on_dask import SweepTask
from tactcad.sweep.store import claimed
from tactcad.sweep.study import read_study

SMALL = """
[study]
name = "small"
design = "macro-array"
sampling = "sobol"
count = 24
seed = 3

[vary."element.hinge_thickness"]
range = [0.2, 0.4]

[vary."array.row_arms[0][3]"]
range = [6, 9]

[measure]
what = ["solid", "strength"]
elements = [4, 9]
"""

# Three designs whose words a spreadsheet would run, or take an apostrophe from.
WORDS = ["=cmd|' /C calc'!A0", "@SUM(1)", "'-plain"]
THREE = f"""[study]\nname = "three"\nsampling = "list"\n[vary."element.hinge_thickness"]
values = [0.25, 0.3, 0.35]\n[vary."design.title"]\nvalues = {WORDS}
[measure]\nwhat = ["solid"]\nelements = [4]\n"""

# Eight tasks of half a second each.
ELEMENTS = """
[study]
name = "elements"

[vary."element.hinge_thickness"]
range = [0.24, 0.26]
steps = 4

[vary."array.row_arms[0][3]"]
values = [6.0, 8.0]

[measure]
what = ["solid", "fem-plane"]
elements = [4]
"""

DASK = [sys.executable, "-m", "dask"]
TACTCAD = [sys.executable, "-m", "tactcad"]
ONE_THREAD = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def written(folder: Path, text: str = SMALL, **changes: str) -> Path:
    """A study file, lines of it replaced: name="value" becomes `name = value`; "" leaves the line out."""
    lines = []
    for line in text.splitlines():
        key = line.partition(" = ")[0]
        new = changes.get(key)
        lines += [line] if new is None else [f"{key} = {new}"] if new else []
    path = folder / "study.toml"
    path.write_text("\n".join(lines) + "\n")
    return path


def swept(*arguments: object) -> subprocess.CompletedProcess[str]:
    """`tactcad sweep ARGUMENTS` to its end; what hangs fails."""
    command = [*TACTCAD, "sweep", *map(str, arguments)]
    return subprocess.run(command, env=ONE_THREAD, capture_output=True, text=True, timeout=300, check=False)


def tables(folder: Path) -> dict[str, bytes]:
    """What a study leaves for its reader."""
    return {
        name: (folder / name).read_bytes() for name in ("results.parquet", "results.csv", "manifest.json")
    }


def finished(path: Path, out: Path) -> int:
    """A study of one task done in this process: the command's status, which finds nothing left to compute."""
    study = read_study(path)
    folder = claimed(study, out)
    SweepTask(study, made_by(study.measure.what), str(folder), 0, study.count).carry_out()
    return main(["sweep", str(path), "--out", str(out)])


def entries(folder: Path) -> dict[str, int]:
    """The store's finished tasks, each with the number of its file: another one if it was written again."""
    return {p.name: p.stat().st_ino for p in (folder / "store").glob("??/*") if len(p.name) == 64}


def started(*command: object, **places: str) -> subprocess.Popen[str]:
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen(list(map(str, command)), env=ONE_THREAD | places, **pipes)


def computing(process: subprocess.Popen) -> list[psutil.Process]:
    """Worker processes of a sweep on this machine, or of a `dask worker`."""
    try:
        children = psutil.Process(process.pid).children(recursive=True)
        spawned = [c for c in children if "spawn_main" in " ".join(c.cmdline())]
        return spawned + [c for c in children if "forkserver" in " ".join(c.parent().cmdline())]
    except (psutil.Error, AttributeError):  # one of them has just ended
        return []


@contextmanager
def cluster(folder: Path, workers: int = 1):
    """`dask scheduler` and `dask worker` processes, and the address."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    scheduler = started(*DASK, "scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard")
    worker = ("worker", address, "--nthreads", 2, "--local-directory", folder, "--death-timeout", 30)
    processes = [scheduler, *(started(*DASK, *worker) for _ in range(workers))]
    try:
        yield address, processes
    finally:
        for process in processes:
            for child in (*computing(process), process):
                child.kill()
            process.communicate()
