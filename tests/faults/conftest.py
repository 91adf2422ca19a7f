"""Undisturbed exports of two designs, made once, that all faults are held against."""

from __future__ import annotations

import fcntl
import os
import pickle
import shutil
import signal
import time
from pathlib import Path

import pytest
from command_line import (
    Bench,
    assert_sound,
    assert_tidy,
    contents,
    environment,
    one_by_one,
    tactcad_forked,
    tactcad_run,
)

# A shell that starts the tests in the background has SIGINT ignored, nohup SIGHUP: what the tests start would
# inherit it.
for _number in (signal.SIGINT, signal.SIGHUP, signal.SIGTERM):
    if signal.getsignal(_number) is signal.SIG_IGN:
        signal.signal(_number, signal.SIG_DFL)


@pytest.fixture(scope="session")
def bench(tmp_path_factory) -> Bench:
    """Made once: of workers side by side, who comes second reads what the first one made."""
    base = tmp_path_factory.getbasetemp()
    base = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    kept = base / "bench.pickle"
    with (base / "bench.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not kept.exists():
            kept.write_bytes(pickle.dumps(undisturbed(base / "bench")))
    return pickle.loads(kept.read_bytes())


def undisturbed(folder: Path) -> Bench:
    folder.mkdir()
    texts = {"A": one_by_one(4.0, "A"), "B": one_by_one(5.0, "B")}
    files, env = {}, environment(folder, PYTHONHASHSEED="0")
    seconds = 0.0
    for name, text in texts.items():
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
        start = time.monotonic()
        run = tactcad_forked if seconds else tactcad_run  # the first tells how long a process takes
        done = run("export", f"{name}.toml", "--out", f"{name}/out", cwd=folder, env=env)
        seconds = seconds or time.monotonic() - start
        assert done.returncode == 0, done.stderr.decode()
        assert_sound(folder / name / "out")
        assert_tidy(folder / name / "out", folder)
        files[name] = contents(folder / name / "out")
    assert files["A"] != files["B"] and len(files["A"]) > 20
    return Bench(folder, texts, files, folder / "cache", seconds)


@pytest.fixture
def work(bench, tmp_path):
    """A folder with the designs A.toml and B.toml, and a warm cache of its own."""
    bench.write_designs(tmp_path)
    shutil.copytree(bench.cache, tmp_path / "cache")
    return tmp_path


@pytest.fixture
def exported(bench, work):
    """That folder with A exported to exports/out."""
    done = tactcad_forked("export", "A.toml", "--out", "exports/out", cwd=work, env=environment(work))
    assert done.returncode == 0, done.stderr.decode()
    assert contents(work / "exports" / "out") == bench.files["A"]
    return work
