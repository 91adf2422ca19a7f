"""What a night tries, one thing at a time, each in whatever process it is handed to and kept when it has
ended, under the digest of what it depends on."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import mutants
from random_designs import judged, raw_table

from tactcad.export.cache import Cache
from tactcad.export.inputs import digest
from tactcad.export.manifest import sha256_of
from tactcad.sweep.on_dask import Done

ROOT = Path(__file__).parents[1]
ROW_LENGTHS, RIGS = (1, 2, 3, 5, 8), 0.5  # of the designs that a night draws; half of them with rigs
KILLS = (
    *(
        f"tests/faults/test_kill_matrix.py::test_twenty_moments_of_each_signal[{command}]"
        for command in ("calibrate", "export", "golden", "release", "validate")
    ),
    "tests/sweep/test_sweep_kills.py::test_twenty_kills_at_random",
)


@dataclass(frozen=True)
class Night:
    """Folder, seed, and digest of the sources that all depends on: what has ended under them is not tried
    again."""

    folder: str
    seed: int
    sources: str

    @property
    def store(self) -> Cache:
        return Cache(Path(self.folder) / "store")


@dataclass(frozen=True)
class Item:
    """The `number`-th thing: `what` of a kind, "design", "kill", "mutant", or "whole": a file of tests that
    mutants are tried on, where nothing is broken."""

    night: Night
    number: int
    kind: str
    what: str

    @property
    def key(self) -> str:
        tests = [] if self.kind == "design" else self.tests
        return f"{self.night.seed} {self.night.sources} {self.kind} {self.what} {_tests_digest(*tests)}"

    @property
    def tests(self) -> list[str]:
        """Files of tests that it runs."""
        if self.kind == "kill":
            return [self.what.partition("::")[0]]
        return [self.what] if self.kind == "whole" else mutants.tests_of(_mutants()[self.what])

    def carry_out(self) -> Done:
        store = self.night.store
        if store.get(self.key) is not None:
            return Done(self.number, 1, False)
        start = time.process_time()
        found = {"design": _design, "kill": _kill, "mutant": _mutant, "whole": _whole}[self.kind](self)
        store.put(self.key, json.dumps(found).encode())
        return Done(self.number, 1, True, seconds=time.process_time() - start)

    def found(self) -> dict[str, Any] | None:
        """What came of it, None where it has not ended; `failed` says what is wrong, if anything."""
        kept = self.night.store.get(self.key)
        return None if kept is None else json.loads(kept)


def _design(item: Item) -> dict[str, Any]:
    number = Random(f"{item.night.seed} {item.what}").randrange(2**48)
    return asdict(judged(raw_table(number, ROW_LENGTHS, RIGS))) | {"draw": number}


def _whole(item: Item) -> dict[str, Any]:
    failed = _first_failed(item, None)
    return {"failed": [f"with nothing broken: {failed}"] if failed else []}


def _mutant(item: Item) -> dict[str, Any]:
    failed = _first_failed(item, _mutants()[item.what])
    return {"by": failed, "failed": [] if failed else ["survived: no test failed"]}


def _first_failed(item: Item, mutant: mutants.Mutant | None) -> str:
    return _runner().failed_test(item.tests, mutant)


def _kill(item: Item) -> dict[str, Any]:
    command = [sys.executable, "-m", "pytest", "-q", "-m", "nightly", "-p", "no:cacheprovider", item.what]
    env = os.environ | {"TACTCAD_SEED": str(item.night.seed)}
    done = subprocess.run(command, cwd=ROOT, env=env, capture_output=True, text=True, check=False)
    return {"failed": done.stdout.splitlines()[-3:] if done.returncode else []}


@cache
def _tests_digest(*tests: str) -> str:
    """Of these files and the fixtures above them; other tests may change."""
    files = {ROOT / name for name in tests}
    files |= {c for f in files for folder in f.parents if (c := folder / "conftest.py").is_file()}
    return digest({str(f.relative_to(ROOT)): sha256_of(f.read_bytes()) for f in sorted(files)})


@cache
def _mutants() -> dict[str, mutants.Mutant]:
    return {m.label: m for m in mutants.every()}


@cache
def _runner() -> mutants.Runner:
    return mutants.Runner()
