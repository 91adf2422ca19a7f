"""`tactcad export` killed with SIGKILL at random moments spread over its whole run: all or nothing, and no
litter."""

from __future__ import annotations

import os
import random
import secrets
import shutil
import subprocess
import time
from pathlib import Path

import pytest
from command_line import MODULE, assert_sound, assert_tidy, contents, environment, running, tactcad_forked

# TACTCAD_SEED repeats a run's moments.
SEED = int(os.environ.get("TACTCAD_SEED") or secrets.randbelow(10**9))


def killed_after(seconds: float, *arguments: str, cwd: Path, env: dict[str, str]) -> bool:
    """Whether the kill came before the end."""
    with subprocess.Popen([*MODULE, *arguments], cwd=cwd, env=env, stderr=subprocess.DEVNULL) as process:
        try:
            process.wait(timeout=seconds)
        except subprocess.TimeoutExpired:
            process.kill()
    return process.returncode == -9


def kill_exports(bench, folder: Path, kills: int) -> None:
    """Exports of A and B in turn into one folder, each killed once and then done again.

    Two in three start with a cold cache, so that kills fall into the kernel's work too, the others with what
    is there.
    """
    chance = random.Random(SEED)
    out, env = folder / "exports" / "out", environment(folder)
    bench.write_designs(folder)
    shutil.copytree(bench.cache, folder / "cache")
    standing, early = None, 0
    for turn in range(kills):
        wanted = "AB"[turn % 2]
        cold = turn % 3 != 2
        if cold:
            shutil.rmtree(folder / "cache", ignore_errors=True)
        moment = (chance.random() + turn) / kills * bench.seconds * (1.0 if cold else 0.4)
        arguments = ("export", f"{wanted}.toml", "--out", "exports/out")
        early += killed_after(moment, *arguments, cwd=folder, env=env)
        if os.path.lexists(out):
            assert_sound(out)
            found = contents(out)
            assert found in ([bench.files[wanted]] + ([bench.files[standing]] if standing else []))
        else:
            assert standing is None
        done = tactcad_forked(*arguments, cwd=folder, env=env)
        assert done.returncode == 0, done.stderr.decode()
        assert contents(out) == bench.files[wanted]
        assert_tidy(out, folder)
        standing = wanted
    print(f"seed {SEED}: {kills} kills, {early} before the end of the run, over {bench.seconds:.1f} s")
    assert early >= kills / 2, f"seed {SEED}: only {early} of {kills} kills came before the end"


@pytest.mark.slow  # two exports with a cold cache
def test_killed_at_two_random_moments(bench, tmp_path):
    """Both with a cold cache; warm ones are in test_kill_matrix.py."""
    kill_exports(bench, tmp_path, 2)


@pytest.mark.nightly
def test_killed_at_fifty_random_moments(bench, tmp_path):
    kill_exports(bench, tmp_path, 50)


@pytest.mark.slow  # starts helpers and kills; by day test_exits.py
def test_killed_while_helpers_draw(bench, work):
    """The processes that draw sheets end with the export that was killed."""
    env = environment(work)
    arguments = ("export", "A.toml", "--drawings", "-v", "--out", "exports/out")
    with subprocess.Popen(
        [*MODULE, *arguments], cwd=work, env=env, stderr=subprocess.PIPE, text=True
    ) as export:
        helpers = []
        for line in export.stderr:
            children = Path(f"/proc/{export.pid}/task/{export.pid}/children").read_text().split()
            if "drawings/" in line and "(making)" in line and children:
                helpers = [int(child) for child in children]
                break
        export.kill()
    if os.cpu_count() > 1:
        assert helpers, "nobody helped: this test shows nothing"
    until = time.monotonic() + 20
    while any(running(helper) for helper in helpers) and time.monotonic() < until:
        time.sleep(0.05)
    assert not any(running(helper) for helper in helpers)
    done = tactcad_forked("export", "A.toml", "--out", "exports/out", cwd=work, env=env)
    assert done.returncode == 0, done.stderr.decode()
    assert contents(work / "exports" / "out") == bench.files["A"]
    assert_tidy(work / "exports" / "out", work)
