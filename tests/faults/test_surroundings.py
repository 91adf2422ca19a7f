"""Clocks, locales, hash seeds and the like: the same bytes in every product, and nothing taken for old or new
by its date."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import ROOT, assert_tidy, contents, environment, tactcad_forked, tactcad_run

pytestmark = pytest.mark.slow  # exports again and again

# The command with the user's locale switched on, as an application around it would, and another clock where
# asked for.
INSIDE = """
import locale, os, sys, time
assert locale.setlocale(locale.LC_ALL, "") == os.environ["LC_ALL"]
assert locale.format_string("%.1f", 0.5) == sys.argv[1]
if sys.argv[2] != "now":
    shift = float(sys.argv[2]) - time.time()
    real, real_ns = time.time, time.time_ns
    time.time, time.time_ns = lambda: real() + shift, lambda: real_ns() + int(shift * 1e9)
    assert abs(time.time() - float(sys.argv[2])) < 1
from tactcad.cli.main import main
sys.exit(main(sys.argv[3:]))
"""
# locale: half, as that locale writes it
LOCALES = {"de_DE.UTF-8": "0,5", "tr_TR.UTF-8": "0,5", "fa_IR.UTF-8": "0\u066b5"}
SURROUNDINGS = {
    "comma, seed 1, clock of 1990": (
        "de_DE.UTF-8",
        "631152000",
        {"PYTHONHASHSEED": "1", "SOURCE_DATE_EPOCH": "0", "TZ": "Pacific/Kiritimati", "HOME": "/proc/none"},
    ),
    "dotless i, seed 4242": ("tr_TR.UTF-8", "now", {"PYTHONHASHSEED": "4242", "TZ": "America/St_Johns"}),
    "Persian, clock of 2100": ("fa_IR.UTF-8", "4102444800", {"PYTHONHASHSEED": "77", "OMP_NUM_THREADS": "3"}),
    "C, ASCII": (
        "C",
        "now",
        {"PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "PYTHONIOENCODING": "ascii", "PYTHONHASHSEED": "5"},
    ),
}


@pytest.fixture(scope="session")
def locales(tmp_path_factory) -> Path:
    """The locales compiled for this run, whatever the machine has installed."""
    folder = tmp_path_factory.mktemp("locales")
    for name in LOCALES:
        language, charset = name.split(".")
        made = subprocess.run(
            ["localedef", "-i", language, "-f", charset, folder / name],
            capture_output=True,
            text=True,
            check=False,
        )
        if not (folder / name / "LC_NUMERIC").exists():
            pytest.fail(f"no locale {name}: on Debian apt-get install locales\n{made.stderr}")
    return folder


def export_in(name: str, design: str, work: Path, locales: Path, *options: str) -> None:
    locale, clock, more = SURROUNDINGS[name]
    env = environment(work, LC_ALL=locale, LOCPATH=str(locales), **more)
    command = [sys.executable, "-c", INSIDE, LOCALES.get(locale, "0.5"), clock]
    done = tactcad_run("export", design, *options, "--out", "exports/out", cwd=work, env=env, command=command)
    assert done.returncode == 0, done.stderr.decode()
    assert_tidy(work / "exports" / "out", work)


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[] if n == 0 else pytest.mark.nightly) for n, name in enumerate(SURROUNDINGS)],
)
def test_every_product_has_the_same_bytes_everywhere(bench, work, locales, name):
    """From a cold cache. The reference was made with seed 0, in the C locale, by today's clock. A home that
    libraries cannot keep their caches in is no reason to fail either.
    """
    shutil.rmtree(work / "cache")
    export_in(name, "A.toml", work, locales)
    assert contents(work / "exports" / "out") == bench.files["A"]


@pytest.mark.nightly
def test_every_product_of_every_design_has_the_same_bytes_everywhere(tmp_path, locales):
    """The shipped designs with all their scenes, guides and drawings, two surroundings."""
    for design in sorted((ROOT / "hardware").glob("*.toml")):
        made = []
        for name in ("comma, seed 1, clock of 1990", "dotless i, seed 4242"):
            work = tmp_path / f"{design.stem} {len(made)}"
            work.mkdir()
            export_in(name, str(design), work, locales, "--guide", "--drawings")
            made.append(contents(work / "exports" / "out"))
        assert made[0] == made[1]


def test_an_ascii_terminal_is_told_everything(work, locales):
    """A title and a path that the terminal cannot show are shown with escapes, and the export is done."""
    title = "tactile \u89e6\u899a \U0001f600 \u00e4"
    text = (work / "A.toml").read_text(encoding="utf-8")
    (work / "\u00fc.toml").write_text(text.replace("title = ", f'title = "{title}" # ', 1), encoding="utf-8")
    env = environment(
        work, LC_ALL="C", PYTHONUTF8="0", PYTHONCOERCECLOCALE="0", PYTHONIOENCODING="ascii:strict"
    )
    done = tactcad_run(
        "export", "\u00fc.toml".encode(), "--json", "--out", "exports/\u00fc".encode(), cwd=work, env=env
    )
    assert done.returncode == 0 and b"Traceback" not in done.stderr, done.stderr.decode()
    assert done.stdout.isascii() and done.stderr.isascii()
    svg = next((work / "exports" / "\u00fc" / "pictures").glob("*-above.svg"))
    assert title in svg.read_text(encoding="utf-8")
    done = tactcad_run("diff", "A.toml", "\u00fc.toml".encode(), cwd=work, env=env)
    assert done.returncode == 0 and done.stdout.isascii() and b"\\U0001f600" in done.stdout


DATES = {"long ago": 1.0, "far ahead": 4102444800.0}


@pytest.mark.parametrize("date", DATES)
def test_dates_of_files_mean_nothing(bench, exported, date):
    """Every file, cache entry and design dated far away: nothing is rebuilt, and a change is seen all the
    same."""
    out, env = exported / "exports" / "out", environment(exported)
    for path in [*exported.rglob("*"), exported]:
        os.utime(path, (DATES[date], DATES[date]), follow_symlinks=False)
    done = tactcad_forked("export", "A.toml", "--out", "exports/out", cwd=exported, env=env)
    assert done.returncode == 0 and b"nothing was rebuilt" in done.stderr
    (exported / "A.toml").write_text(bench.texts["B"], encoding="utf-8")
    os.utime(exported / "A.toml", (DATES[date], DATES[date]))
    done = tactcad_forked("export", "A.toml", "--out", "exports/out", cwd=exported, env=env)
    assert done.returncode == 0 and b" 0 made" in done.stderr
    assert contents(out) == bench.files["B"]
    assert_tidy(out, exported)
