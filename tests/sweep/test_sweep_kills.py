"""Whatever is killed, the table is that of an undisturbed run, and nothing finished is computed again."""

from __future__ import annotations

import json
import random
import shutil
import signal
import sys
import time
from pathlib import Path

import psutil
import pytest
from small_study import ELEMENTS, SMALL, TACTCAD, cluster, computing, entries, started, swept, tables, written

pytestmark = pytest.mark.slow  # starts clusters


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """A study, and its tables and the names of its store's entries in number."""
    folder = tmp_path_factory.mktemp("undisturbed")
    path = written(folder, ELEMENTS)
    got = swept(path, "--out", folder / "out")
    assert got.returncode == 0, got.stderr
    assert len(entries(folder / "out")) == 8
    return path, tables(folder / "out")


def wait_for(what, seconds: float = 90.0) -> None:
    end = time.monotonic() + seconds
    while not what():
        assert time.monotonic() < end, "nothing happened"
        time.sleep(0.05)


def test_a_killed_client_and_killed_workers(undisturbed, tmp_path):
    path, wanted = undisturbed
    out = tmp_path / "out"
    client = started(*TACTCAD, "sweep", path, "--out", out)
    wait_for(lambda: len(entries(out)) >= 2 or client.poll() is not None)
    helpers = computing(client)
    client.kill()
    client.communicate()
    wait_for(lambda: not any(h.is_running() and h.status() != psutil.STATUS_ZOMBIE for h in helpers))
    finished = entries(out)
    assert 2 <= len(finished) < 8
    assert not (out / "results.parquet").exists()

    again = started(*TACTCAD, "sweep", path, "--out", out, "--json")
    wait_for(lambda: len(entries(out)) > len(finished) or again.poll() is not None)
    for helper in computing(again)[:1]:
        helper.kill()
    said, err = again.communicate(timeout=120)
    assert again.returncode == 0, err
    assert tables(out) == wanted
    after = entries(out)
    assert len(after) == 8 and {name: after[name] for name in finished} == finished
    record = json.loads(said)  # the worker may have kept a task and died before it said so
    assert record["kept"] >= len(finished) and record["kept"] + record["computed"] == 8


def litter(folder: Path) -> set[str]:
    """What lies there beside finished tasks and the marks of their folders."""
    found = [p for p in (folder / "out").rglob("*") if p.is_file() and p.name not in entries(folder / "out")]
    found += [*(folder / "tmp").iterdir(), *(folder / "home").iterdir()]
    return {str(p.relative_to(folder)) for p in found} - {"out/study.json", "out/store/CACHEDIR.TAG"}


@pytest.mark.parametrize("sent", ["SIGINT", "SIGTERM", "SIGHUP", "SIGKILL"])
def test_a_stopped_sweep_leaves_finished_tasks_only(undisturbed, tmp_path, sent):
    """While it starts, and among its tasks; after SIGKILL the next run removes what is left, even where
    nothing is left to compute."""
    path, wanted = undisturbed
    out, places = tmp_path / "out", {"TMPDIR": str(tmp_path / "tmp"), "HOME": str(tmp_path / "home")}
    (tmp_path / "tmp").mkdir()
    (tmp_path / "home").mkdir()
    command, number = [*TACTCAD, "sweep", path, "--out", out, "--json"], getattr(signal, sent)
    for least in (0, 1, 4):
        client = started(*command, **places)
        process = psutil.Process(client.pid)
        wait_for(lambda: process.children() and len(entries(out)) >= least)
        helpers = process.children(recursive=True)
        client.send_signal(number)
        _, err = client.communicate(timeout=60)
        assert client.returncode == (-number if sent == "SIGKILL" else 128 + number), err
        wait_for(lambda: not any(h.is_running() and h.status() != psutil.STATUS_ZOMBIE for h in helpers))
        assert sent == "SIGKILL" or (litter(tmp_path) == set() and "tactcad: " in err.splitlines()[-1]), err
    if sent == "SIGKILL":
        assert litter(tmp_path)
        shutil.copytree(path.parent / "out" / "store", out / "store", dirs_exist_ok=True)
    said, err = started(*command, **places).communicate(timeout=120)
    assert tables(out) == wanted and litter(tmp_path) == {f"out/{name}" for name in wanted}, err
    assert sent != "SIGKILL" or json.loads(said)["computed"] == 0


def test_a_killed_scheduler_of_a_cluster(undisturbed, tmp_path):
    """On `dask scheduler` and `dask worker` by command line; the same study then ends on another cluster."""
    path, wanted = undisturbed
    out = tmp_path / "out"
    with cluster(tmp_path / "a") as (address, processes):
        client = started(*TACTCAD, "sweep", path, "--out", out, "--scheduler", address)
        wait_for(lambda: len(entries(out)) >= 2 or client.poll() is not None)
        processes[0].kill()
        _, err = client.communicate(timeout=90)
    assert client.returncode == 1 and "Traceback" not in err
    assert err.splitlines()[-1].startswith("tactcad: the scheduler is gone; what was finished is kept")
    finished = entries(out)
    assert len(finished) >= 2
    with cluster(tmp_path / "b", workers=2) as (address, _):
        got = swept(path, "--out", out, "--scheduler", address)
    assert got.returncode == 0, got.stderr
    after = entries(out)
    assert tables(out) == wanted and {name: after[name] for name in finished} == finished


OTHER = """
import sys
import tactcad.export.inputs as inputs
inputs.source_digest = lambda room: "other"
from dask.__main__ import main
main()
"""
BLIND = """
import sys
import tactcad.sweep.store as kept
kept.MARK = "not-there.json"
from dask.__main__ import main
main()
"""


@pytest.mark.parametrize(
    "worker, said", [(OTHER, "is of another version: source of"), (BLIND, "does not see")]
)
def test_a_worker_that_would_make_something_else_is_refused(tmp_path, worker, said):
    path = written(tmp_path, SMALL)
    with cluster(tmp_path / "a", workers=0) as (address, processes):
        command = ("worker", address, "--no-nanny", "--local-directory", tmp_path / "b")
        processes.append(started(sys.executable, "-c", worker, *command))
        got = swept(path, "--out", tmp_path / "out", "--scheduler", address)
    assert got.returncode == 2 and "Traceback" not in got.stderr
    assert said in got.stderr.splitlines()[-1]
    assert entries(tmp_path / "out") == {}


@pytest.mark.nightly
@pytest.mark.night
def test_twenty_kills_at_random(undisturbed, tmp_path):
    """Of workers and clients, whenever."""
    path, wanted = undisturbed
    out, chance = tmp_path / "out", random.Random(19)
    kept: dict[str, int] = {}
    for _ in range(20):
        client = started(*TACTCAD, "sweep", path, "--out", out)
        time.sleep(chance.uniform(2, 12))
        victims = [client, *computing(client)]
        chance.choice(victims).send_signal(signal.SIGKILL)
        time.sleep(chance.uniform(0, 2))
        client.kill()
        client.communicate()
        now = entries(out)
        assert {name: now[name] for name in kept} == kept
        kept = now
        if len(kept) == 8:
            shutil.rmtree(out)
            kept = {}
    assert swept(path, "--out", out).returncode == 0
    assert tables(out) == wanted
