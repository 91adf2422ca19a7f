"""Commands that write, ended by four signals at moments spread over each one's run: whole or untouched,
and no litter.

What lies there before is what the command made of input A, after it what it makes of B; whatever ends it in
between, one of the two is there. Nothing here knows how anything is written. What a signal does while the
program is being loaded is in test_exits.py.
"""

from __future__ import annotations

import os
import random
import re
import secrets
import shutil
import signal
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import pytest
from command_line import ROOT, Started, contents, environment, tactcad_runs
from small_target import SMALL

pytestmark = pytest.mark.slow  # kills commands

SEED = int(os.environ.get("TACTCAD_SEED") or secrets.randbelow(10**9))
# SIGKILL last: it alone may leave something behind, which the run after it sweeps
STATUS = {"SIGTERM": 143, "SIGINT": 130, "SIGHUP": 129, "SIGKILL": -9}
COMMANDS = {  # N is A or B
    "export": "export N.toml --guide --drawings --out there/out",
    "release": "release N.toml --sample --out there",
    "golden": "golden hardware/N.toml",
    "validate": "validate --table1 N-table1.csv --out there/report",
    "calibrate": "calibrate N-readings.csv --out there/table.csv",
    "review": "review N.toml --out there/page.html",
}
BY_DAY = ("export", "calibrate")  # the quick ones, every signal once; by night all of them
OTHERS = ("home", "cache")  # where libraries and the cache keep theirs


@dataclass(frozen=True)
class Case:
    """A command in a folder of its own: seconds of a run, and what lies there after a run with either
    input."""

    work: Path
    words: str
    seconds: float
    whole: dict[str, dict[str, bytes]]

    def line(self, name: str) -> list[str]:
        return [re.sub(r"\bN\b", name, word) for word in self.words.split()]

    def run(self, name: str) -> None:
        (done,) = tactcad_runs([self.line(name)], self.work, environment(self.work))
        assert done.returncode == 0, done.stderr.decode()


def prepared(bench, work: Path, words: str) -> Case:
    """The inputs, both outputs made undisturbed, A's last: that is what lies there now."""
    readings = (ROOT / "hardware" / "examples" / "calibration.csv").read_text("utf-8")
    table = (ROOT / "src" / "tactcad" / "paper" / "data" / "table1.csv").read_text("utf-8")
    inputs = {
        "A-readings.csv": readings,
        "B-readings.csv": readings.partition("\n10,")[0] + "\n",  # without its last element
        "A-table1.csv": table,
        "B-table1.csv": table.replace("\n1,40.12,", "\n1,40.13,"),
    }
    for name, text in bench.texts.items():
        inputs[f"hardware/{name}.toml"] = text
        # one file name for both releases
        inputs[f"{name}.toml"] = re.sub('^revision = ".*"$', 'revision = "A"', text, flags=re.MULTILINE)
    for folder in ("hardware", "there"):
        (work / folder).mkdir()
    for path, text in inputs.items():
        (work / path).write_text(text, encoding="utf-8")
    shutil.copytree(bench.cache, work / "cache")
    environment(work)
    whole, seconds = {}, 0.0
    for name in "BA":
        start = time.monotonic()
        Case(work, words, 0.0, {}).run(name)
        seconds = time.monotonic() - start
        whole[name] = lying(work)
    assert whole["A"] != whole["B"] and not any(map(hidden, whole["A"]))
    return Case(work, words, seconds, whole)


def lying(work: Path) -> dict[str, bytes | None]:
    """Every file but those of others, and every empty folder, hidden ones too."""
    found = dict(contents(work))
    for folder in work.rglob("*"):
        if folder.is_dir() and folder != work / "tmp" and not any(folder.iterdir()):
            found[folder.relative_to(work).as_posix()] = None
    return {path: data for path, data in found.items() if path.split("/")[0] not in OTHERS}


def differences(found: dict[str, bytes | None], whole: dict[str, bytes | None]) -> list[str]:
    return sorted(
        path for path in found.keys() | whole.keys() if found.get(path, ...) != whole.get(path, ...)
    )


def hidden(path: str) -> bool:
    return path.startswith("tmp/") or any(part.startswith(".") for part in path.split("/"))


def ended(case: Case, name: str, sent: str, seconds: float) -> bool:
    """Send the signal after that many seconds: whether that ended the command, by the signal's status and in
    one line."""
    process = Started(case.line(name), case.work, environment(case.work))
    began = time.monotonic()
    while not takes_signals(process.pid) and not process.ended(0.002):
        pass  # until it is tactcad's turn, Python answers
    if not process.ended(began + seconds - time.monotonic()):
        with suppress(ProcessLookupError):  # it has ended since
            os.kill(process.pid, getattr(signal, sent))
    done = process.result()
    text = done.stderr.decode()
    assert done.returncode in (0, STATUS[sent]), text
    assert "Traceback" not in text and "Exception" not in text, text
    if done.returncode > 0:
        assert text.splitlines()[-1].startswith("tactcad: ") and text.count("tactcad: ") == 1, text
    return done.returncode != 0


def takes_signals(process: int) -> bool:
    try:
        status = Path(f"/proc/{process}/status").read_text()
    except OSError:
        return False
    caught = int(re.search(r"^SigCgt:\s*(\w+)$", status, re.MULTILINE)[1], 16)
    return bool(caught >> (signal.SIGTERM - 1) & 1)


def end_at(case: Case, standing: str, sent: str, moments: int, every: bool) -> tuple[str, int]:
    """End runs at that many moments; what stands there at last, and how many moments came before the run's
    end.

    With `every`, every second one has to make everything anew. What may leave something behind, SIGKILL
    alone, is followed by an undisturbed run: every time, or the last time.
    """
    chance = random.Random(f"{SEED} {case.words} {sent}")
    early, seconds = 0, case.seconds
    for n in range(moments):
        wanted = "AB"[standing == "A"]
        cold = every and n % 2 == 1
        if cold:
            shutil.rmtree(case.work / "cache", ignore_errors=True)
        share = (n + chance.random()) / moments
        about = f"TACTCAD_SEED={SEED}: {case.words}, {sent} at {share:.3f}"
        began = time.monotonic()
        if ended(case, wanted, sent, share * seconds):
            early += 1
        elif not cold:  # the machine is faster than it was
            seconds = time.monotonic() - began
        found = lying(case.work)
        visible = {path: data for path, data in found.items() if not hidden(path)}
        differing = {name: differences(visible, case.whole[name]) for name in (standing, wanted)}
        assert not all(differing.values()), f"{about}: {differing}"
        assert sent == "SIGKILL" or found == visible, f"{about} left {sorted(set(found) - set(visible))}"
        standing = wanted if visible == case.whole[wanted] else standing
        if sent == "SIGKILL" and (every or n == moments - 1):  # the other signals are held to leave nothing
            run_after(case, wanted, about)
            standing = wanted
    return standing, early


def run_after(case: Case, wanted: str, about: str) -> None:
    """The next run finishes, and leaves nothing of the others'."""
    case.run(wanted)
    assert lying(case.work) == case.whole[wanted], about
    assert not list((case.work / "cache").rglob("*.part")), about


@pytest.mark.parametrize("command", BY_DAY)
def test_one_moment_of_each_signal(bench, tmp_path, command):
    """With a warm cache, one after the other; then one run to the end."""
    case, standing = prepared(bench, tmp_path, COMMANDS[command]), "A"
    for sent in STATUS:
        standing, _ = end_at(case, standing, sent, 1, every=False)


@pytest.mark.nightly
@pytest.mark.night
@pytest.mark.parametrize("command", COMMANDS)
def test_twenty_moments_of_each_signal(bench, tmp_path, command):
    case, standing = prepared(bench, tmp_path, COMMANDS[command]), "A"
    for sent in STATUS:
        standing, early = end_at(case, standing, sent, 20, every=True)
        print(f"{command}, {sent}: 20 moments, {early} before the run's end, seed {SEED}", flush=True)
        assert early >= 8


def test_of_a_killed_synthesis_nothing_is_left(tmp_path):
    """Before the answer nothing; the answer comes in one step. After SIGKILL the next run clears up."""
    environment(tmp_path)
    (tmp_path / "N.toml").write_text(SMALL, "utf-8")
    case = Case(tmp_path, "design N.toml --out there/out", 0.0, {})
    for seconds, sent in (
        (0.1, "SIGTERM"),
        (4.0, "SIGHUP"),
        (5.0, "SIGINT"),
        (6.0, "SIGKILL"),
        (3.0, "SIGTERM"),
    ):
        assert ended(case, "N", sent, seconds)
        found = lying(tmp_path)
        visible = {path for path in found if not hidden(path)}
        answer = {f"there/out/{name}" for name in ("design.toml", "report.html", "report.json")}
        assert visible - answer <= {"N.toml", "there"} and visible & answer in (set(), answer), sent
        assert sent == "SIGKILL" or set(found) == visible, (sent, sorted(set(found) - visible))
        shutil.rmtree(tmp_path / "there" / "out", ignore_errors=True)
