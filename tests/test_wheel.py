"""The wheel, installed with the base dependencies only, works in an empty folder."""

from __future__ import annotations

import importlib.metadata
import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest
from packaging.requirements import Requirement

pytestmark = pytest.mark.slow  # builds and installs a wheel

ROOT = Path(__file__).parents[1]
BASE = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]


def run(*command: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "TACTCAD", "VIRTUAL"))}
    environment["TACTCAD_CACHE"] = str(cwd.parent / "cache")
    return subprocess.run(
        list(map(str, command)), cwd=cwd, env=environment, capture_output=True, text=True, check=False
    )


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    """Built without network from a copy of what the repository holds."""
    source = tmp_path_factory.mktemp("source")
    for name in ("src", "hardware"):
        ignored = shutil.ignore_patterns("__pycache__", "*.egg-info")
        shutil.copytree(ROOT / name, source / name, symlinks=True, ignore=ignored)
    for name in ("pyproject.toml", "README.md"):
        shutil.copy(ROOT / name, source)
    out = tmp_path_factory.mktemp("wheel")
    pip = (sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--no-index")
    built = run(*pip, "--wheel-dir", out, source, cwd=source)
    assert built.returncode == 0, built.stderr
    (made,) = out.glob("*.whl")
    return made


def closure(requirements: list[str]) -> set[str]:
    """Distributions that the requirements ask for, and those that these ask for."""
    found: set[str] = set()
    waiting = [Requirement(r) for r in requirements]
    while waiting:
        asked = waiting.pop()
        name = re.sub(r"[-_.]+", "-", asked.name).lower()
        if name not in found and (asked.marker is None or asked.marker.evaluate({"extra": ""})):
            found.add(name)
            waiting += map(Requirement, importlib.metadata.requires(name) or ())
    return found


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory) -> Path:
    """The bin folder of an environment that holds the wheel and its base dependencies (links), no kernel."""
    home = tmp_path_factory.mktemp("fresh") / "env"
    made = run(sys.executable, "-m", "venv", "--without-pip", home, cwd=home.parent)
    assert made.returncode == 0, made.stderr
    (site,) = home.glob("lib/python3*/site-packages")
    for name in closure(BASE):
        distribution = importlib.metadata.distribution(name)
        tops = {file.parts[0] for file in distribution.files or ()} - {"..", "__pycache__"}
        for top in tops:
            if not (site / top).exists():
                (site / top).symlink_to(Path(str(distribution.locate_file(top))).resolve())
    pip = (
        sys.executable,
        "-m",
        "pip",
        "--python",
        home / "bin" / "python",
        "install",
        "--no-deps",
        "--no-index",
    )
    done = run(*pip, wheel, cwd=home.parent)
    assert done.returncode == 0, done.stderr
    return home / "bin"


@pytest.fixture
def empty(tmp_path) -> Path:
    (tmp_path / "empty").mkdir()
    return tmp_path / "empty"


def test_the_base_install_has_no_kernel(installed, empty):
    run_ = run(installed / "python", "-c", "import build123d", cwd=empty)
    assert "No module named 'build123d'" in run_.stderr


@pytest.mark.parametrize(
    "command, said",
    [
        ("estimate", "macro-array"),
        ("estimate soft-tissue --force 0.2", "2024-T3"),
        ("schema", "[element]"),
        ("export --help", "examples:"),
        ("size --stiffness 10 --load-arm 6", "N/mm"),
        ("diff macro-array double-sample", "sample"),
    ],
)
def test_what_needs_no_kernel_works_in_an_empty_folder(installed, empty, command, said):
    done = run(installed / "tactcad", *command.split(), cwd=empty)
    assert done.returncode == 0, done.stderr
    assert said in done.stdout
    assert not list(empty.iterdir())


def test_it_brings_all_of_the_review_page(wheel):
    own = {
        p.name
        for p in (ROOT / "src/tactcad/review").iterdir()
        if p.suffix in (".js", ".css", ".html", ".txt")
    }
    with zipfile.ZipFile(wheel) as archive:
        shipped = {Path(name).name for name in archive.namelist() if name.startswith("tactcad/review/")}
    assert len(own) > 8 and own <= shipped


def test_a_new_design_is_written_and_estimated(installed, empty):
    assert run(installed / "tactcad", "new", "my-sensor.toml", cwd=empty).returncode == 0
    done = run(installed / "tactcad", "estimate", "my-sensor.toml", cwd=empty)
    assert done.stdout.startswith("my-sensor A, 7075-T6")
    assert [p.name for p in empty.iterdir()] == ["my-sensor.toml"]


def test_cut_files_need_no_kernel(installed, empty):
    script = (
        "from tactcad.parts.rules import load; from tactcad.scenes import make_scene;"
        "from tactcad.export.dxf import dxf_bytes;"
        "element = make_scene(load('macro-array'), 'array').placements[1].part;"
        "print(dxf_bytes(element).decode().split()[-1])"
    )
    done = run(installed / "python", "-c", script, cwd=empty)
    assert done.stdout == "EOF\n", done.stderr


@pytest.mark.parametrize(
    "command",
    [
        "export",
        "check",
        "release",
        "golden",
        "diff macro-array soft-tissue --freecad changes.FCStd",
        "sweep study.toml --out o",
    ],
)
def test_what_needs_an_extra_says_what_to_install(installed, empty, command, tmp_path, monkeypatch):
    (tmp_path / "freecad").symlink_to("/bin/true")
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    done = run(installed / "tactcad", *command.split(), cwd=empty)
    assert done.returncode == 2 and not list(empty.iterdir())
    legal = f"pip install '.[{'sweep' if 'sweep' in command else 'cad'}]' in a checkout of tactcad"
    assert done.stderr.endswith(f"not installed here; legal: {legal}\n") and done.stderr.count("\n") == 1
