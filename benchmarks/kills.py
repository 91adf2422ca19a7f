"""A study once undisturbed, and once with its workers, scheduler and client killed at random.

    python benchmarks/kills.py mine.toml exports/kills/mine --kills 20

Prints one row for benchmarks/results/sweeps.md. Ends with status 1 if the tables differ, or if something
finished was run again: the store shows that, since an entry that is written again is another file. If it is
stopped itself, it goes on with the same FOLDER. The cluster is `dask scheduler` and two `dask worker` by
command line, so that each can be killed alone; `dask worker` restarts its processes, this script all else.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import socket
import subprocess
import sys
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path

import psutil

TABLES = ("results.parquet", "results.csv", "manifest.json")
PYTHON = [sys.executable, "-m"]
# chosen: between two kills so many seconds at least, in which a started cluster gets to work
LEAST = 4.0


def started(*command: object) -> subprocess.Popen:
    one = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    return subprocess.Popen(
        [*PYTHON, *map(str, command)], env=one, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )


def ended(process: subprocess.Popen) -> None:
    """Kill it and all that it started."""
    with suppress(psutil.Error):
        for child in psutil.Process(process.pid).children(recursive=True):
            with suppress(psutil.Error):
                child.kill()
    process.kill()
    process.communicate()


class Cluster:
    """A scheduler and two workers, and the client of one study; what is missing is started again."""

    def __init__(self, study: Path, out: Path) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.study, self.out = study, out
        self.running: dict[str, subprocess.Popen] = {}

    def complete(self) -> None:
        address = f"tcp://127.0.0.1:{self.port}"
        scratch = ("--local-directory", self.out.parent / "scratch")
        commands = {
            "scheduler": ("dask", "scheduler", "--host", "127.0.0.1", "--port", self.port, "--no-dashboard"),
            "worker 1": ("dask", "worker", address, "--nthreads", 1, *scratch),
            "worker 2": ("dask", "worker", address, "--nthreads", 1, *scratch),
            "client": ("tactcad", "sweep", self.study, "--out", self.out, "--scheduler", address),
        }
        for name, command in commands.items():
            if name not in self.running or self.running[name].poll() is not None:
                self.running[name] = started(*command)

    def kill(self, what: str) -> None:
        if what in ("client", "scheduler"):
            self.running[what].kill()
            self.running.pop(what).communicate()
            return
        with suppress(psutil.Error):
            for child in psutil.Process(self.running[what].pid).children(recursive=True):
                if "spawn_main" in " ".join(child.cmdline()):
                    child.kill()

    def close(self) -> None:
        for process in self.running.values():
            ended(process)


def entries(folder: Path) -> dict[str, int]:
    """Finished tasks by name, each with the number of its file."""
    return {p.name: p.stat().st_ino for p in (folder / "store").glob("??/*") if len(p.name) == 64}


def undisturbed(study: Path, out: Path) -> float:
    """Seconds that it takes, as the first run of it found."""
    kept = out.parent / "undisturbed.json"
    if not kept.exists():
        start = time.monotonic()
        subprocess.run([*PYTHON, "tactcad", "sweep", str(study), "--out", str(out)], check=True)
        kept.write_text(json.dumps(time.monotonic() - start))
    return json.loads(kept.read_text())


def disturbed(study: Path, out: Path, kills: int, seconds: float, seed: int) -> dict:
    """Kill until the study is finished, then go on to its end; the record of what was seen."""
    kept = out.parent / "disturbed.json"
    record = json.loads(kept.read_text()) if kept.exists() else {"killed": [], "again": 0, "seen": {}}
    chance = random.Random(f"{seed} {len(record['killed'])}")
    cluster = Cluster(study, out)
    try:
        while not (out / "manifest.json").exists():
            cluster.complete()
            pause = LEAST + chance.uniform(0.0, 2.0) * seconds / kills
            with suppress(subprocess.TimeoutExpired):
                cluster.running["client"].wait(pause if len(record["killed"]) < kills else 5.0)
            if len(record["killed"]) < kills and cluster.running["client"].poll() is None:
                record["killed"].append(chance.choice(("worker 1", "worker 2", "scheduler", "client")))
                cluster.kill(record["killed"][-1])
            look(record, out)
            kept.write_text(json.dumps(record))
    finally:
        cluster.close()
    return record


def look(record: dict, out: Path) -> None:
    """Count entries that are not the file that they were."""
    now = entries(out)
    record["again"] += sum(now.get(name) != number for name, number in record["seen"].items())
    record["seen"] = now


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("study", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=19)
    args = parser.parse_args()
    folder = args.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    calm, wild = folder / "undisturbed", folder / "disturbed"
    seconds = undisturbed(args.study, calm)
    record = disturbed(args.study, wild, args.kills, seconds, args.seed)
    same = all((calm / name).read_bytes() == (wild / name).read_bytes() for name in TABLES)
    manifest = json.loads((wild / "manifest.json").read_text())
    kinds = Counter(name.split()[0] for name in record["killed"])
    print(
        f"| {manifest['study']['table']['name']} | {manifest['designs']} | {len(record['seen'])} | "
        f"{kinds['worker']}, {kinds['scheduler']}, {kinds['client']} | {record['again']} | "
        f"{'yes' if same else 'NO'} |"
    )
    return 0 if same and not record["again"] and len(record["killed"]) == args.kills else 1


if __name__ == "__main__":
    raise SystemExit(main())
