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
        ["sh", "-e", "-c", commands.replace("CHECKOUT", str(ROOT))],
        cwd=folder,
        env=os.environ | {"PATH": path},
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


@pytest.mark.cad
@pytest.mark.parametrize(
    "page, last",
    [
        ("tutorial-readings.md", "elements.csv"),
        ("tutorial-sensor.md", "exports/releases/my-sensor-A.zip"),
        ("tutorial-target.md", "to-the-shop/tissue-A.zip"),
    ],
)
def test_a_tutorial_runs_whole_and_prints_what_it_shows(page, last, empty):
    for commands, shown in steps(page):
        follow(commands, shown, empty)
    assert (empty / last).is_file()


@pytest.mark.parametrize("page", ["tutorial-sensor.md", "tutorial-readings.md", "tutorial-target.md"])
def test_every_block_is_one_that_is_run_or_compared(page):
    text = (DOCS / page).read_text("utf-8")
    assert text.count("```") == 2 * len(BLOCK.findall(text)) and not re.search(r"^    \S", text, re.MULTILINE)
