"""build123d and CadQuery must share one CAD kernel, and what is installed must be what is pinned."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]
PINS = dict(
    line.split("==")
    for line in (ROOT / "requirements/pins.txt").read_text().splitlines()
    if line and not line.startswith("#")
)
SHIM = tomllib.loads((ROOT / "packaging/ocp-shim/pyproject.toml").read_text())["project"]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]

ONE_KERNEL = """
import sys, {first}
before = sys.modules["OCP"]
import {second}
assert sys.modules["OCP"] is before
from OCP.IVtkOCC import IVtkOCC_Shape  # only VTK's build of the kernel has it

box = build123d.Box(2, 3, 5)
seen = cadquery.Shape.cast(box.solid().wrapped)
assert seen.isValid() and abs(seen.Volume() - 30) < 1e-12, seen.Volume()
other = cadquery.Workplane().box(2, 3, 7).val().wrapped
assert type(other) is type(box.solid().wrapped)
back = build123d.Solid(other)
assert abs(back.volume - 42) < 1e-12, back.volume
"""


@pytest.mark.slow  # loads both in a fresh process
@pytest.mark.cad
@pytest.mark.parametrize(
    "first, second",
    # slow: loads both kernels in another process
    [("build123d", "cadquery"), pytest.param("cadquery", "build123d", marks=pytest.mark.slow)],
)
def test_both_share_one_kernel_in_either_order(first, second):
    script = ONE_KERNEL.format(first=first, second=second)
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr


def test_pip_finds_nothing_broken():
    run = subprocess.run([sys.executable, "-m", "pip", "check"], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout


def test_installed_versions_are_the_pinned_ones():
    assert {name: metadata.version(name) for name in PINS} == PINS
    assert metadata.version(SHIM["name"]) == SHIM["version"]


@pytest.mark.parametrize("extra", ["", "cad", "cadquery", "review", "robot", "sweep", "test"])
def test_pins_meet_what_the_project_asks_for(extra):
    asked = PROJECT["optional-dependencies"][extra] if extra else PROJECT["dependencies"]
    pins = {_plain(name): version for name, version in PINS.items()}
    for requirement in map(Requirement, asked):
        assert requirement.specifier.contains(pins[_plain(requirement.name)]), requirement


def test_base_install_asks_for_no_kernel():
    base = {_plain(Requirement(line).name) for line in PROJECT["dependencies"]}
    assert not base & {"build123d", "cadquery", "cadquery-ocp", "cadquery-ocp-novtk", "vtk", "bd-warehouse"}


def _plain(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()
