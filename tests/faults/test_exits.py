"""The exit status says what came of the work, whoever reads along and whatever ends the command."""

from __future__ import annotations

import os
import random
import secrets
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from command_line import MODULE, contents, environment, running, tactcad_run

SEED = int(os.environ.get("TACTCAD_SEED") or secrets.randbelow(10**9))
STATUS = {"SIGINT": 130, "SIGTERM": 143, "SIGHUP": 129}  # 128 + the signal's number, as shells have it


IGNORING = (
    "import os, signal, sys; signal.signal(signal.{}, signal.SIG_IGN); os.execv(sys.argv[1], sys.argv[1:])"
)


def in_shell(line: str, cwd: Path, **env: str) -> subprocess.CompletedProcess[str]:
    """A line of bash in which `tactcad` is the command; its own status is the shell's."""
    script = f'tactcad() {{ {sys.executable} -m tactcad "$@"; }}\n{line}'
    return subprocess.run(
        ["bash", "-c", script],
        cwd=cwd,
        env=environment(cwd, **env),
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
        stdin=subprocess.DEVNULL,
    )


# --- readers that go away ---


@pytest.fixture
def refused_design(work) -> Path:
    """A design that every command refuses, beside the good ones."""
    text = (work / "A.toml").read_text(encoding="utf-8")
    (work / "bad.toml").write_text(
        text.replace("hinge_thickness = 0.25", "hinge_thickness = 3.0"), encoding="utf-8"
    )
    return work


@pytest.mark.by_day(3, "a fresh process each")
@pytest.mark.parametrize(
    "line, status",
    [
        ("check bad.toml bad.toml >&-", 1),  # of several designs those refused have failed the check
        ("schema | head -1", 0),
        ("--help >&- 2>&-", 0),
        ("check bad.toml bad.toml | true", 1),
        ("check bad.toml 2>&1 | true", 2),
        ("release --json --out zips bad.toml 2>&- | true", 2),
    ],
)
def test_nobody_reads(refused_design, line, status):
    done = in_shell(f"tactcad {line}; exit ${{PIPESTATUS[0]}}", refused_design, PYTHONUNBUFFERED="1")
    assert done.returncode == status, done.stderr
    assert "Traceback" not in done.stderr and "Exception ignored" not in done.stderr


@pytest.mark.by_day(1, "an export in a fresh process each")
@pytest.mark.parametrize("reader", ["2>&1 | head -1", "--json >&- 2>/dev/full"])
def test_an_export_is_made_although_nobody_reads(bench, work, reader):
    done = in_shell(
        f"tactcad export A.toml --out out {reader}; exit ${{PIPESTATUS[0]}}", work, PYTHONUNBUFFERED="1"
    )
    assert done.returncode == 0, done.stderr
    assert contents(work / "out") == bench.files["A"]


@pytest.mark.slow  # starts three processes
def test_output_that_finds_no_room_is_an_error_of_its_own(refused_design):
    """The work is done all the same, and a refusal stays one."""
    done = in_shell("tactcad export A.toml --out out --json >/dev/full", refused_design)
    assert done.returncode == 1
    assert done.stderr.endswith("tactcad: the output cannot be written: No space left on device\n")
    assert (refused_design / "out" / "manifest.json").is_file()
    assert in_shell("tactcad --help >/dev/full", refused_design).returncode == 1
    assert in_shell("tactcad check bad.toml >/dev/full", refused_design).returncode == 2


@pytest.mark.slow  # exports in a fresh process
def test_a_terminal_that_hung_up_is_no_error(bench, work):
    """The window was closed on a command that was told to ignore that: it goes on to its end."""
    import pty

    mine, theirs = pty.openpty()
    quiet = [sys.executable, "-c", IGNORING.format("SIGHUP"), *MODULE]
    with subprocess.Popen(
        [*quiet, "export", "A.toml", "--out", "out"],
        cwd=work,
        env=environment(work),
        stdin=subprocess.DEVNULL,
        stdout=theirs,
        stderr=theirs,
    ) as export:
        os.close(theirs)
        os.close(mine)
    assert export.returncode == 0
    assert contents(work / "out") == bench.files["A"]


# --- signals ---

IMPORTS = 800  # of a cold export, at least: the kernel's modules are among them
# Sends itself a signal at the n-th module that is imported after tactcad took its signals over; n = 0 counts
# them.
AT_IMPORT = """
import os, runpy, signal, sys
number, turn = int(sys.argv[1]), int(sys.argv[2])
sys.argv = ["tactcad", *sys.argv[3:]]
default, seen = signal.getsignal(signal.SIGTERM), 0
def count(event, details):
    global seen
    if event == "import" and signal.getsignal(signal.SIGTERM) != default:
        seen += 1
        if seen == turn:
            os.kill(os.getpid(), number)
sys.addaudithook(count)
try:
    runpy.run_module("tactcad", run_name="__main__", alter_sys=True)
finally:
    if not turn:
        print(seen)
"""


def at_import(work: Path, name: str, turn: int) -> subprocess.CompletedProcess[bytes]:
    command = [sys.executable, "-c", AT_IMPORT, str(int(getattr(signal, name))), str(turn)]
    env = environment(work, TACTCAD_CACHE=str(work / "cold"))
    return tactcad_run("export", "A.toml", "--out", "out", cwd=work, env=env, command=command)


def assert_ended(done: subprocess.CompletedProcess[bytes], name: str) -> None:
    """By that signal, said in one line after what it had said before."""
    said = done.stderr.decode()
    assert done.returncode == STATUS[name], said[-2000:]
    assert said.splitlines()[-1].startswith("tactcad: ") and said.count("tactcad: ") == 1, said[-2000:]
    assert "Traceback" not in said and "Exception" not in said and "Error" not in said, said[-2000:]


def interrupted_imports(work: Path, moments: int, count: int) -> None:
    """At as many moments, spread over so many imports."""
    chance = random.Random(SEED)
    before = sorted(p.name for p in work.iterdir())
    for n in range(moments):
        name = list(STATUS)[n % 3]
        shutil.rmtree(work / "cold", ignore_errors=True)  # else later runs load fewer
        turn = 1 + int((n + chance.random()) / moments * 0.98 * count)  # runs differ by a few imports
        assert_ended(at_import(work, name, turn), name)
        assert not (work / "out").exists(), f"seed {SEED}: {name} at import {turn}"
        assert not list((work / "tmp").iterdir())
    assert set(before) >= {p.name for p in work.iterdir()} - {"cold", "home", "tmp"}


@pytest.mark.slow  # a cold export in a fresh process
def test_interrupted_while_modules_are_loaded(work):
    interrupted_imports(work, 1, IMPORTS)


@pytest.mark.nightly
def test_interrupted_at_sixty_imports(work):
    counted = at_import(work, "SIGINT", 0)
    assert counted.returncode == 0, counted.stderr.decode()
    count = int(counted.stdout.split()[-1])
    assert count > IMPORTS
    shutil.rmtree(work / "out")
    interrupted_imports(work, 60, count)


@pytest.mark.by_day(1, "an export in a fresh process each")
@pytest.mark.parametrize("name", STATUS)
def test_what_was_to_be_ignored_stays_ignored(bench, work, name):
    """As nohup and a shell's `&` ask for: the export is made."""
    command = [sys.executable, "-c", IGNORING.format(name), *MODULE, "export", "A.toml", "--out", "out"]
    with subprocess.Popen(command, cwd=work, env=environment(work), stderr=subprocess.PIPE) as export:
        for line in export.stderr:
            export.send_signal(getattr(signal, name))
    assert export.returncode == 0
    assert contents(work / "out") == bench.files["A"]


@pytest.mark.by_day(1, "an export in fresh processes each")
@pytest.mark.parametrize(
    "name, group",
    [
        ("SIGTERM", False),
        ("SIGINT", True),  # a terminal's Ctrl-C goes to all of them
        *(
            pytest.param(*pair, marks=pytest.mark.nightly)
            for pair in (("SIGINT", False), ("SIGTERM", True), ("SIGHUP", True), ("SIGHUP", False))
        ),
    ],
)
def test_helpers_end_with_what_they_help(bench, work, name, group):
    """The processes that draw sheets are gone with the export, whether it alone got the signal or all of them
    did."""
    arguments = ("export", "A.toml", "--drawings", "--out", "out", "-v")
    with subprocess.Popen(
        [*MODULE, *arguments],
        cwd=work,
        env=environment(work),
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as export:
        said, helpers = "", []
        for line in export.stderr:
            said += line
            helpers = Path(f"/proc/{export.pid}/task/{export.pid}/children").read_text().split()
            if helpers and "drawings/" in line:
                break
        (os.killpg if group else os.kill)(export.pid, getattr(signal, name))
        said += export.stderr.read()
    assert helpers or os.cpu_count() < 2, "nobody helped: this test shows nothing"
    assert_ended(subprocess.CompletedProcess([], export.returncode, b"", said.encode()), name)
    until = time.monotonic() + 5
    while any(running(int(helper)) for helper in helpers) and time.monotonic() < until:
        time.sleep(0.02)
    assert not any(running(int(helper)) for helper in helpers)
    assert not (work / "out").exists() and not list((work / "tmp").iterdir())
