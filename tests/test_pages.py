"""What any page tells to type is what the program takes, and is typed: one mechanism for all pages.

The tutorials, whose outputs are compared too, are typed by test_tutorials.py.
"""

from __future__ import annotations

import csv
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tactcad.cli.main import COMMANDS, parser_of

ROOT = Path(__file__).parents[1]
PAGES = sorted([*(ROOT / "docs").glob("*.md"), ROOT / "README.md", ROOT / "CONTRIBUTING.md"])
FENCED = re.compile(r"^```sh\n(.*?)^```$", re.MULTILINE | re.DOTALL)
INDENTED = re.compile(r"^    ((?:tactcad|make|python|pip|dask|duckdb|mkdir|cp) .*)$", re.MULTILINE)
# What is not typed here, and why.
LEFT = {
    "make ": "targets run the whole house",
    "pip install": "fetches",
    "python benchmarks/": "measures for hours; its script is looked for",
    "python packaging/": "compares whole trees; its script is looked for",
    "python tests/": "writes tables of the documentation; its script is looked for",
    "dask ": "a cluster's own programs",
    "--scheduler tcp": "needs that cluster",
    "duckdb": "not installed",
    "tactcad view": "serves until it is stopped; tests/review/test_live.py",
}
NEW = "tactcad new my-sensor.toml --from soft-tissue"
MAY_FAIL = ("--strict",)  # exit status 1 where a rig does not fit, which is what it is for


def commands(page: Path) -> list[str]:
    """Every command of a page in order, without what is said beside it; README's are those of the path."""
    text = page.read_text("utf-8")
    found = [(m.start(), line) for m in FENCED.finditer(text) for line in _lines(m[1])]
    found += [(m.start(), re.split(r" {2,}", m[1])[0].strip()) for m in INDENTED.finditer(text)]
    return [line.replace(".venv/bin/", "") for _, line in sorted(found, key=lambda f: f[0])]


def _lines(block: str) -> list[str]:
    lines = (line.partition(" # ")[0].strip() for line in block.splitlines())
    return [line for line in lines if line and not line.startswith("#")]


def left(command: str) -> bool:
    return any(part in command for part in LEFT)


TYPED = [page for page in PAGES if not page.name.startswith("tutorial-") and commands(page)]


@pytest.mark.parametrize("page", TYPED, ids=lambda page: page.stem)
def test_every_command_of_a_page_is_one_that_the_program_takes(page):
    for command in commands(page):
        program, *words = shlex.split(command)
        if program == "tactcad" and words:
            assert words[0] in (*COMMANDS, "help"), command
            parser_of(words[0], raises=True).parse(words[1:])
        elif program == "make":
            makefile = (ROOT / "Makefile").read_text("utf-8")
            assert all(re.search(rf"^{target}:", makefile, re.MULTILINE) for target in words), command
        elif program == "python":
            assert (ROOT / words[0]).is_file(), command
        else:
            assert program in ("tactcad", "pip", "dask", "duckdb", "mkdir", "cp"), command


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> tuple[Path, set[str]]:
    """A folder, and what was typed in it: a checkout's designs under git, a sensor of one's own, a study, a
    shop, a table of designs."""
    place = tmp_path_factory.mktemp("pages")
    shutil.copytree(ROOT / "hardware", place / "hardware")
    shutil.copytree(ROOT / "exports" / "golden", place / "exports" / "golden")
    study = (place / "hardware" / "studies" / "hinges.toml").read_text("utf-8")
    small = re.sub(r"^count = \d+", "count = 16", study, flags=re.MULTILINE)
    (place / "hardware" / "studies" / "hinges.toml").write_text(small, "utf-8")
    (place / "mine.toml").write_text(small, "utf-8")
    shutil.copy(ROOT / "src" / "tactcad" / "checks" / "data" / "shop.toml", place / "my-shop.toml")
    (place / "designs.csv").write_text(
        "hinge_thickness,hinge_length,fillet_radius,load_arm,arm_height,body_height,body_length,poisson,"
        "youngs_modulus,width\n0.25,0.88,0.3,5,2.6,3,4,0.33,69000,3\n",
        "utf-8",
    )
    typed(place, NEW)
    own = (place / "my-sensor.toml").read_text("utf-8")  # whose it is, as the release page asks for
    owner = '[design]\norganisation = "Our lab"\ncontact = "workshop@our-lab.example"\n'
    (place / "my-sensor.toml").write_text(own.replace("[design]\n", owner, 1), "utf-8")
    shutil.copy(place / "my-sensor.toml", place / "hardware")
    who = "git -c user.name=a -c user.email=a@b.example"
    typed(place, "git init -q . && git add hardware && " + f"{who} commit -qm 0")
    for n in (1, 2, 3):
        old = (place / "hardware" / "my-sensor.toml").read_text("utf-8")
        (place / "hardware" / "my-sensor.toml").write_text(f"{old}# {n}\n", "utf-8")
        typed(place, f"{who} commit -qam {n}")
    typed(place, "git update-ref refs/remotes/origin/main HEAD~1")
    for name in ("my-sensor.toml", "macro-array"):
        typed(place, f"tactcad export {name} --scene array")
    shutil.copy(place / "exports" / "my-sensor" / "inspection.csv", place)
    fill_in(place / "inspection.csv")
    return place, {NEW}


def typed(folder: Path, command: str) -> subprocess.CompletedProcess:
    env = os.environ | {"PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    done = subprocess.run(
        ["sh", "-e", "-c", command], cwd=folder, env=env, capture_output=True, text=True, check=False
    )
    allowed = (0, 1) if any(part in command for part in MAY_FAIL) else (0,)
    assert done.returncode in allowed, f"{command}\n{done.stdout[-2000:]}{done.stderr[-2000:]}"
    return done


def fill_in(sheet: Path) -> None:
    """Fill in an inspection sheet, as a shop does, with what the drawing says."""
    with sheet.open(newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    for row in rows:
        row[head.index("measured")] = row[head.index("nominal")]
    with sheet.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([head, *rows])


@pytest.mark.slow  # runs every command of the documentation
@pytest.mark.cad
@pytest.mark.parametrize("page", TYPED, ids=lambda page: page.stem)
def test_every_command_of_a_page_runs_in_order(page, folder):
    """A command that another page has too is typed once."""
    place, done = folder
    for command in commands(page):
        if left(command) or command in done:
            continue
        typed(place, command)
        done.add(command)
        words = shlex.split(command)
        if words[0] == "cp" and words[1].endswith("inspection.csv"):
            fill_in(place / words[2])
