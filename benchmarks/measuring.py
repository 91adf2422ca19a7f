"""What benchmarks share: times in turns, whole processes, the machine, and arrays of every size."""

from __future__ import annotations

import dataclasses
import importlib.metadata
import json
import os
import platform
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from functools import lru_cache
from math import ceil
from pathlib import Path
from statistics import median
from typing import Any, Literal, TypeVar

import calculix

from tactcad import __version__
from tactcad.costs.grades import processor
from tactcad.design.load import DEFAULT_DESIGN, find, parse
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design

ROOT = Path(__file__).parents[1]
K = TypeVar("K", bound=Hashable)
T = TypeVar("T")

# --- a run and its benchmarks ---

Mode = Literal["smoke", "short", "full"]


@dataclass(frozen=True)
class RunPlan:
    """Plan of a run: mode; seed of everything random; a scratch folder; `say` receives the name of each
    measurement.

    smoke: does everything run? Its figures mean nothing. short: four minutes on two quiet cores. full: for
    publication, some 40 minutes.
    """

    mode: Mode
    seed: int
    folder: Path
    say: Callable[[str], None] = lambda text: None

    def of(self, smoke: T, short: T, full: T) -> T:
        """The one for this mode."""
        return {"smoke": smoke, "short": short, "full": full}[self.mode]


@dataclass(frozen=True)
class Benchmark:
    """`measure` returns {"tables", "findings"} and, if something could not be measured, "missing"."""

    title: str
    question: str
    measure: Callable[[RunPlan], dict]
    kernel: bool


BENCHMARKS: dict[str, Benchmark] = {}


def benchmark(name: str, title: str, question: str, kernel: bool = True) -> Callable:
    """Registers the function below it; `kernel`: it needs the CAD kernel."""

    def register(measure: Callable[[RunPlan], dict]) -> Callable[[RunPlan], dict]:
        BENCHMARKS[name] = Benchmark(title, question, measure, kernel)
        return measure

    return register


# --- times of alternatives, measured alternately, so that other load on the machine affects all equally ---

LEAST_SAMPLE = 0.005  # s: shorter actions run several times a sample, to reduce the error of clock and loop


@dataclass(frozen=True)
class Timed:
    """Seconds of one action: shortest and median of `runs` samples. The shortest counts: disturbances only
    add time."""

    seconds: float
    median: float
    runs: int


def interleaved(actions: Mapping[K, Callable[[], object]], repeats: int) -> dict[K, Timed]:
    """Each action once to warm up, then `repeats` rounds of all, every round beginning with the next one."""
    loops = {name: max(1, ceil(LEAST_SAMPLE / max(_seconds(a, 1), 1e-9))) for name, a in actions.items()}
    order = list(actions)
    samples: dict[K, list[float]] = {name: [] for name in actions}
    for turn in range(repeats):
        first = turn % len(order)
        for name in order[first:] + order[:first]:
            samples[name].append(_seconds(actions[name], loops[name]) / loops[name])
    return {name: of_samples(s) for name, s in samples.items()}


def of_samples(seconds: Sequence[float]) -> Timed:
    """The same from times measured elsewhere, such as by another process's own clock."""
    return Timed(min(seconds), median(seconds), len(seconds))


def _seconds(action: Callable[[], object], loops: int) -> float:
    start = time.perf_counter()
    for _ in range(loops):
        action()
    return time.perf_counter() - start


def processor_seconds(action: Callable[[], object]) -> float:
    """Of this process, which other load moves little."""
    start = time.process_time()
    action()
    return time.process_time() - start


# --- whole processes ---

# The meter is a process of its own, and a small one: a child's largest memory counts from the moment it is
# forked, when it still is as large as its parent.
METER = """
import json, os, sys, time
target, *command = sys.argv[1:]
start = time.perf_counter()
_, status, usage = os.wait4(os.posix_spawnp(command[0], command, os.environ), 0)
seconds = time.perf_counter() - start
with open(target, "w") as file:
    unit = 1 if sys.platform == "darwin" else 1024
    json.dump({"seconds": seconds, "peak_bytes": usage.ru_maxrss * unit}, file)
sys.exit(os.waitstatus_to_exitcode(status))
"""


@dataclass(frozen=True)
class Run:
    """One process: seconds, largest resident memory in bytes, standard output."""

    seconds: float
    peak_bytes: int
    output: str

    @property
    def last_line(self) -> dict:
        """The JSON that it printed last."""
        return json.loads(self.output.strip().splitlines()[-1])


def environment(**more: str) -> dict[str, str]:
    """Of children: one thread a process, the program and the benchmarks that run."""
    paths = [str(ROOT / "src"), str(ROOT / "benchmarks"), *filter(None, [os.environ.get("PYTHONPATH")])]
    one_thread = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    return {**os.environ, **one_thread, "PYTHONPATH": os.pathsep.join(paths), **more}


def measured(command: Sequence[str], **more: str) -> Run:
    """Run a command to its end, on one thread. Raises CheckFailure with its last words if it fails."""
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / "meter.json"
        meter = [sys.executable, "-I", "-S", "-c", METER, str(result), *command]
        own = environment(TMPDIR=folder, **more)  # removed with what a killed process leaves in it
        run = subprocess.run(meter, env=own, capture_output=True, text=True, check=False)
        if run.returncode:
            words = (run.stderr or run.stdout).strip().splitlines() or ["it said nothing"]
            raise CheckFailure(f"{' '.join(command)[:200]} ended with status {run.returncode}: {words[-1]}")
        return Run(**json.loads(result.read_text("utf-8")), output=run.stdout)


def in_turns(
    commands: Mapping[K, Sequence[str]], turns: int, say: Callable[[str], None]
) -> dict[K, list[Run]]:
    """Each command once a turn."""
    runs: dict[K, list[Run]] = {name: [] for name in commands}
    for turn in range(turns):
        for name, command in commands.items():
            say(f"{name}, run {turn + 1}")
            runs[name].append(measured(command))
    return runs


def cost(runs: Sequence[Run], seconds: Sequence[float] = ()) -> dict[str, float]:
    """Shortest and median time (s), as the processes report it or else of the whole process, and the smallest
    of their largest memories (bytes)."""
    timed = of_samples(seconds or [run.seconds for run in runs])
    peak = min(run.peak_bytes for run in runs)
    return {"seconds": timed.seconds, "median": timed.median, "peak_bytes": peak}


def python(*args: object) -> list[str]:
    return [sys.executable, *map(str, args)]


def tactcad(*args: object) -> list[str]:
    return python("-m", "tactcad", *args)


def child_seconds(command: Sequence[str], **more: str) -> float:
    """Processor seconds of a command and of all that it starts."""
    used = lambda: sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])  # noqa: E731
    start = used()
    subprocess.run(command, env=environment(**more), capture_output=True, check=False)
    return used() - start


# --- the machine, and the peers that are installed on it ---

LIBRARIES = (
    "numpy",
    "scipy",
    "scikit-fem",
    "matplotlib",
    "build123d",
    "cadquery",
    "cadquery-ocp",
    "manifold3d",
    "trimesh",
    "ezdxf",
    "scikit-sparse",
)
MISSING = "not installed"
PEERS = Path(__file__).with_name("peers")


def machine() -> dict:
    """Processor model, cores, memory (GB), system, and how busy it is now (load average)."""
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return {
        "processor": processor(),
        "cores": usable,
        "memory_GB": round(memory / 1e9, 1),
        "system": f"{platform.system()} {platform.machine()}",
        "load": round(os.getloadavg()[0], 2),
    }


def made_here() -> str:
    """The line below a table: date, machine and its load."""
    m = machine()
    return (
        f"{date.today()}, {m['processor']}, {m['cores']} cores, {m['system']}, load {m['load']} when it ended"
    )


def versions() -> dict[str, str]:
    """Python, tactcad and its libraries."""

    def version(library: str) -> str:
        try:
            return importlib.metadata.version(library)
        except importlib.metadata.PackageNotFoundError:
            return MISSING

    return {"python": platform.python_version(), "tactcad": __version__} | {n: version(n) for n in LIBRARIES}


def peers() -> dict[str, str]:
    """Versions of other programs that are measured too."""
    found = ""
    if ccx := calculix.executable():
        said = subprocess.run([ccx, "-v"], capture_output=True, text=True, check=False).stdout
        found = match[1] if (match := re.search(r"Version ([\d.]+)", said)) else ""
    return {"CalculiX": found or MISSING, "FreeCAD": freecad_version() or MISSING}


def freecad(job: Mapping[str, Any]) -> tuple[list[str], dict[str, str]]:
    """Command and environment that build an element in FreeCAD's own Python. The environment carries the job:
    FreeCAD's command line takes every argument for a file to open."""
    name = next(filter(None, map(shutil.which, ("freecadcmd", "FreeCADCmd"))), "freecadcmd")
    platform = os.environ.get("QT_QPA_PLATFORM", "offscreen")
    return [name, str(PEERS / "freecad_element.py")], {
        "TACTCAD_PEER": json.dumps(job),
        "QT_QPA_PLATFORM": platform,
    }


def freecad_answer(output: str) -> dict:
    """The line that the script prints after its mark, found among FreeCAD's own output."""
    lines = [line for line in output.splitlines() if line.startswith("PEER ")]
    return json.loads(lines[-1].removeprefix("PEER ")) if lines else {}


@lru_cache(maxsize=1)
def freecad_version() -> str:
    """Its version, "" if it is not installed or does not answer."""
    command, own = freecad({"repeats": 0})
    try:  # a fresh user folder makes its first start slow
        run = subprocess.run(
            command,
            env=environment(**own),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=False,
            timeout=60,
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return freecad_answer(run.stdout).get("version", "")


# --- the published array, and its rows repeated to a number of elements ---

LONGER = 0.5  # mm, of the first arm of a design that is to differ


@lru_cache(maxsize=1)
def published_text() -> str:
    return find(DEFAULT_DESIGN).read_text("utf-8")


def published() -> Design:
    """The design as shipped."""
    return parse(published_text(), DEFAULT_DESIGN)


def array_text(elements: int, changed: bool = False) -> str:
    """The design file of an array of that many elements, an even number; `changed` makes its first arm
    longer."""
    (line,) = (line for line in published_text().splitlines() if line.startswith("row_arms"))
    rows = _repeated(tomllib.loads(line)["row_arms"], elements)
    if changed:
        rows[0][0] += LONGER
    return published_text().replace(line, f"row_arms = {rows}")


def array_of(elements: int) -> Design:
    """The same as a design."""
    design = published()
    rows = tuple(map(tuple, _repeated(design.array.row_arms, elements)))
    return dataclasses.replace(design, array=dataclasses.replace(design.array, row_arms=rows))


def _repeated(rows: Sequence[Sequence[float]], elements: int) -> list[list[float]]:
    return [[row[i % len(row)] for i in range(elements // 2)] for row in rows]
