"""What the tutorials tell to type is typed, in order, in an empty folder, and prints what they show."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow  # runs the tutorials

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
BLOCK = re.compile(r"^```(sh|text)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
SLOW = re.compile(r"tactcad (export|check|release)")  # they build solids: a minute each


def steps(page: str) -> list[tuple[str, list[str]]]:
    """Every block of commands, with the blocks of text shown below it."""
    found: list[tuple[str, list[str]]] = []
    for kind, text in BLOCK.findall((DOCS / page).read_text("utf-8")):
        if kind == "sh":
            found.append((text, []))
        else:
            found[-1][1].append(text)
    return found


def follow(commands: str, shown: list[str], folder: Path) -> None:
    """Type the commands in `folder`; they end well, and the lines shown are printed in their order."""
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    done = subprocess.run(
        ["sh", "-e", "-c", commands],
        cwd=folder,
        env={**os.environ, "PATH": path, "TACTCAD_CACHE": str(folder.parent / "cache")},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"{commands}{done.stdout}"
    printed = iter(line.rstrip() for line in done.stdout.splitlines())
    for line in "".join(shown).splitlines():
        assert line == "..." or line.rstrip() in printed, f"{commands}does not print, in its place: {line}"


@pytest.fixture
def empty(tmp_path) -> Path:
    (tmp_path / "empty").mkdir()
    return tmp_path / "empty"


def test_a_lab_s_readings(empty):
    for commands, shown in steps("tutorial-readings.md"):
        follow(commands, shown, empty)


def test_a_sensor_of_your_own_up_to_the_solids(empty):
    for commands, shown in steps("tutorial-sensor.md"):
        if not SLOW.search(commands):
            follow(commands, shown, empty)


def test_a_sensor_from_a_target_up_to_the_solids(empty):
    for commands, shown in steps("tutorial-target.md"):
        if not SLOW.search(commands):
            follow(commands, shown, empty)


@pytest.mark.nightly
@pytest.mark.cad
def test_a_sensor_from_a_target_to_the_zip(empty):
    for commands, shown in steps("tutorial-target.md"):
        follow(commands, shown, empty)
    assert (empty / "to-the-shop" / "tissue-A.zip").is_file()


@pytest.mark.nightly
@pytest.mark.cad
def test_a_sensor_of_your_own_to_the_zip(empty):
    for commands, shown in steps("tutorial-sensor.md"):
        follow(commands, shown, empty)
    assert (empty / "exports" / "my-sensor" / "pictures" / "my-sensor-array-open.svg").is_file()
    assert (empty / "exports" / "releases" / "my-sensor-A.zip").is_file()


@pytest.mark.parametrize("page", ["tutorial-sensor.md", "tutorial-readings.md", "tutorial-target.md"])
def test_every_block_is_one_that_is_run_or_compared(page):
    text = (DOCS / page).read_text("utf-8")
    assert text.count("```") == 2 * len(BLOCK.findall(text)) and not re.search(r"^    \S", text, re.MULTILINE)
