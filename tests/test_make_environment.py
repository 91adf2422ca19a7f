"""packaging/environment.sh, tried with a stand-in for Python whose pip only writes down what it was asked."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

# Answers -c like the real one, but has no library that is named in LACKS; makes a .venv whose pip logs.
PYTHON = """#!/bin/sh
case "$*" in
*CDLL*) for name in $LACKS; do case "$*" in *"$name"*) exit 1 ;; esac; done; exit 0 ;;
*"-m venv"*) mkdir -p .venv/bin && cp "$0" .venv/bin/python ;;
*"-m pip"*) echo "$*" >>pip.log; case "$*" in *"-r requirements"*) exit "${PIP_STATUS:-0}" ;; esac ;;
*) exec REAL "$@" ;;
esac
"""


@pytest.fixture
def clone(tmp_path) -> Path:
    """What the script reads, and the stand-in."""
    for name in ("requirements", "packaging"):
        shutil.copytree(ROOT / name, tmp_path / name)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    python = tmp_path / "python-stand-in"
    python.write_text(PYTHON.replace("REAL", sys.executable))
    python.chmod(0o755)
    return tmp_path


def make(clone: Path, **environment: str) -> subprocess.CompletedProcess:
    return subprocess.run(
        ["packaging/environment.sh"],
        cwd=clone,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHON": str(clone / "python-stand-in"), "LACKS": "", **environment},
    )


def installs(clone: Path) -> int:
    """How often the pinned packages were installed so far."""
    log = clone / "pip.log"
    return log.read_text().count("-r requirements/pins.txt") if log.exists() else 0


@pytest.mark.parametrize(
    "lacks, packages",
    [
        ("libGL.so.1", "apt-get install libgl1\n"),
        ("libX11.so.6", "apt-get install libx11-6\n"),
        ("libGL.so.1 libX11.so.6", "apt-get install libgl1 libx11-6\n"),
    ],
)
def test_a_missing_library_is_named_before_anything_is_installed(clone, lacks, packages):
    run = make(clone, LACKS=lacks)
    assert run.returncode == 1
    assert lacks.replace(" ", ", ") in run.stderr
    assert packages in run.stderr
    assert not (clone / ".venv").exists()
    assert installs(clone) == 0


def test_a_missing_python_is_named(clone):
    run = make(clone, PYTHON="no-such-python")
    assert run.returncode == 1
    assert "apt-get install python3.11" in run.stderr


def test_the_second_time_installs_nothing(clone):
    first, second = make(clone), make(clone)
    assert (first.returncode, second.returncode) == (0, 0), first.stderr
    assert installs(clone) == 1
    assert second.stdout == ""


def test_an_interrupted_install_is_not_a_finished_one(clone):
    assert make(clone, PIP_STATUS="1").returncode != 0
    assert make(clone).returncode == 0
    assert installs(clone) == 2


def test_an_interrupted_renewal_is_not_a_finished_one(clone):
    """A complete environment, then a new pin whose install breaks off."""
    make(clone)
    (clone / "requirements" / "pins.txt").write_text("numpy==2.4.6\n")
    assert make(clone, PIP_STATUS="1").returncode != 0
    assert make(clone).returncode == 0
    assert installs(clone) == 3


@pytest.mark.parametrize(
    "name",
    [
        "requirements/pins.txt",
        "pyproject.toml",
        "packaging/ocp-shim/pyproject.toml",
        "packaging/environment.sh",
    ],
)
def test_a_change_of_what_is_asked_for_installs_anew(clone, name):
    make(clone)
    with open(clone / name, "a") as file:
        file.write("# changed\n")
    make(clone)
    assert installs(clone) == 2


def test_a_moved_folder_installs_anew(clone, tmp_path_factory):
    make(clone)
    moved = tmp_path_factory.mktemp("elsewhere") / "clone"
    shutil.copytree(clone, moved)
    make(moved)
    assert installs(moved) == 2
