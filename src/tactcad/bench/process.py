"""Whole processes: time from start to end, largest memory, and what they printed."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import tactcad
from tactcad.design.files import scratch_folder
from tactcad.design.messages import CheckFailure

from .timing import of_samples

METER = Path(__file__).with_name("meter.py")
K = TypeVar("K", bound=Hashable)


@dataclass(frozen=True)
class Run:
    """One process: seconds, largest resident memory in bytes, standard output."""

    seconds: float
    peak_bytes: int
    output: str


def measured(command: Sequence[str], environment: Mapping[str, str] | None = None) -> Run:
    """Run a command to its end, on one thread. Raises CheckFailure with its last words where it fails."""
    with scratch_folder("bench-run") as folder:
        result = folder / "meter.json"
        meter = [sys.executable, "-I", "-S", str(METER), str(result), *command]
        here = {"TMPDIR": str(folder)}  # removed with what a killed process leaves in it
        environment = {**os.environ, **surroundings(), **here, **(environment or {})}
        run = subprocess.run(meter, env=environment, capture_output=True, text=True, check=False)
        if run.returncode:
            words = (run.stderr or run.stdout).strip().splitlines() or ["it said nothing"]
            raise CheckFailure(f"{' '.join(command)[:200]} ended with status {run.returncode}: {words[-1]}")
        return Run(**json.loads(result.read_text("utf-8")), output=run.stdout)


def in_turns(
    commands: Mapping[K, Sequence[str]], turns: int, say: Callable[[str], None]
) -> dict[K, list[Run]]:
    """Each command once a turn, so that other load on the machine affects all alike."""
    runs: dict[K, list[Run]] = {name: [] for name in commands}
    for turn in range(turns):
        for name, command in commands.items():
            say(f"{name}, run {turn + 1}")
            runs[name].append(measured(command))
    return runs


def cost(runs: Sequence[Run], seconds: Sequence[float] = ()) -> dict[str, float]:
    """Shortest and median time (s), as the processes report it or else of the whole process, and the smallest
    of their largest memories (bytes).
    """
    timed = of_samples(list(seconds) or [run.seconds for run in runs])
    peak = min(run.peak_bytes for run in runs)
    return {"seconds": timed.seconds, "median": timed.median, "peak_bytes": peak}


def surroundings() -> dict[str, str]:
    """The environment of children: one thread a process, and the running tactcad."""
    here = str(Path(tactcad.__file__).parents[1])
    path = os.pathsep.join([here, *filter(None, [os.environ.get("PYTHONPATH")])])
    return {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": path}


def python(*args: str) -> list[str]:
    return [sys.executable, *args]


def command(*args: str) -> list[str]:
    """`tactcad ARGS` as a process."""
    return python("-m", "tactcad", *args)


def child(task: str, **arguments: object) -> list[str]:
    """A task of `children` as a process; it prints its result as JSON on its last line."""
    return python("-m", "tactcad.bench.children", task, json.dumps(arguments))


def last_line(run: Run) -> dict:
    """The JSON that a child printed last."""
    return json.loads(run.output.strip().splitlines()[-1])
