"""Users' own files as stories: exports that are renamed, copied, archived, filled in, and exported again."""

from __future__ import annotations

import csv
import os
import random
import secrets
import shutil
import subprocess
import time
from pathlib import Path

import pytest
from command_line import MODULE, assert_sound, assert_tidy, contents, environment, refused, tactcad_forked

SEED = int(os.environ.get("TACTCAD_SEED") or secrets.randbelow(10**9))  # TACTCAD_SEED repeats a run's moments


def export(work: Path, design: str, *arguments: str) -> subprocess.CompletedProcess[bytes]:
    return tactcad_forked(
        "export", f"{design}.toml", "--out", "exports/out", *arguments, cwd=work, env=environment(work)
    )


@pytest.mark.by_day(1, "three exports each")
@pytest.mark.parametrize("how", ["mv", "cp -a", "cp -r"])
def test_a_renamed_or_copied_export_stays_what_it_is(bench, exported, how):
    subprocess.run([*how.split(), "exports/out", "revA"], cwd=exported, check=True)
    for design in "BAB":
        done = export(exported, design)
        assert done.returncode == 0, done.stderr.decode()
        assert contents(exported / "exports" / "out") == bench.files[design]
        assert contents(exported / "revA") == bench.files["A"]
    assert_sound(exported / "revA")
    assert_tidy(exported / "exports" / "out", exported)


def test_an_archived_export_comes_out_whole(bench, exported):
    subprocess.run(["tar", "-cf", "ex.tar", "-C", "exports", "out"], cwd=exported, check=True)
    assert export(exported, "B").returncode == 0
    (exported / "there").mkdir()
    subprocess.run(["tar", "-xf", "ex.tar", "-C", "there"], cwd=exported, check=True)
    assert contents(exported / "there" / "out") == bench.files["A"]
    done = tactcad_forked("export", "A.toml", "--out", "there/out", cwd=exported, env=environment(exported))
    assert b"nothing changed" in done.stderr, "an export is known wherever it lies"


def fill_in(sheet: Path) -> None:
    with sheet.open(newline="") as file:
        header, *rows = csv.reader(file)
    for row in rows:
        row[header.index("measured")] = row[header.index("nominal")]
    with sheet.open("w", newline="") as file:
        csv.writer(file).writerows([header, *rows])


@pytest.mark.by_day(1, "exports each")
@pytest.mark.parametrize("design", ["A", "B"], ids=["unchanged", "changed"])
def test_an_inspection_sheet_filled_in_inside_the_export_is_not_lost(bench, exported, design):
    out = exported / "exports" / "out"
    fill_in(out / "inspection.csv")
    (out / "photo.jpg").write_bytes(b"\xff\xd8")
    filled = contents(out)
    said = refused(export(exported, design))
    assert "inspection.csv (changed), photo.jpg (added)" in said and "--keep" in said and "--discard" in said
    assert contents(out) == filled
    assert_tidy(out, exported)

    done = export(exported, design, "--keep")
    assert done.returncode == 0 and b"out-kept-1" in done.stderr, done.stderr.decode()
    assert contents(out) == bench.files[design]
    assert contents(exported / "exports" / "out-kept-1") == filled
    done = tactcad_forked(
        "estimate",
        "A.toml",
        "--inspection",
        "exports/out-kept-1/inspection.csv",
        cwd=exported,
        env=environment(exported),
    )
    assert done.returncode == 0, done.stderr.decode()

    (out / "photo.jpg").write_bytes(b"\xff\xd8")
    done = export(exported, design, "--discard")
    assert done.returncode == 0 and b"photo.jpg" in done.stderr
    assert contents(out) == bench.files[design]
    assert {p.name for p in (exported / "exports").iterdir()} == {"out", "out-kept-1"}


@pytest.mark.slow  # exports twice
def test_an_inspection_sheet_has_a_place_of_its_own(exported):
    """As docs/release.md says it."""
    (exported / "inspections").mkdir()
    shutil.copy(exported / "exports" / "out" / "inspection.csv", exported / "inspections" / "A.csv")
    fill_in(exported / "inspections" / "A.csv")
    for design in "BA":
        assert export(exported, design).returncode == 0
    done = tactcad_forked(
        "estimate", "A.toml", "--inspection", "inspections/A.csv", cwd=exported, env=environment(exported)
    )
    assert done.returncode == 0, done.stderr.decode()


def killed_while_somebody_writes(bench, work: Path, kills: int) -> None:
    """Somebody saves a note into the export while the next one is made, which is killed at some moment after.

    Whatever happened, DIR is whole but for the note; the next run refuses for it or has kept it; it is never
    gone.
    """
    chance, out = random.Random(SEED), work / "exports" / "out"
    env, standing = environment(work), "A"
    died = 0
    for turn in range(kills):
        wanted = "BA"[turn % 2]
        arguments = ["export", f"{wanted}.toml", "--out", "exports/out"]
        with subprocess.Popen([*MODULE, *arguments], cwd=work, env=env, stderr=subprocess.DEVNULL) as process:
            while process.poll() is None and not list(work.glob("exports/.out.tactcad-*/making")):
                time.sleep(0.001)
            (out / "note.txt").write_text(f"note {turn}")
            time.sleep(chance.random() * bench.seconds * 0.1 * turn / kills)  # the first one at once
            process.kill()
        died += process.returncode == -9
        assert process.returncode in (-9, 1), "a note that was kept is a failure to be told"
        files = contents(out)
        assert (files.pop("note.txt", None), files) in (
            (f"note {turn}".encode(), bench.files[standing]),
            (None, bench.files[wanted]),
        )
        done = tactcad_forked(*arguments, cwd=work, env=env)
        if done.returncode == 2:
            assert "note.txt (added)" in refused(done)
            done = tactcad_forked(*arguments, "--keep", cwd=work, env=env)
        assert done.returncode in (0, 1), done.stderr.decode()
        (note,) = work.glob("exports/out-kept-*/note.txt")
        assert note.read_text() == f"note {turn}"
        assert contents(out) == bench.files[wanted]
        shutil.rmtree(note.parent)
        assert_tidy(out, work)
        standing = wanted
    print(f"seed {SEED}: {died} of {kills} killed before their end")
    assert died, f"seed {SEED}"


@pytest.mark.slow  # exports and kills, again and again
def test_killed_while_somebody_writes_into_the_export(bench, exported):
    killed_while_somebody_writes(bench, exported, 4)


@pytest.mark.nightly
def test_killed_often_while_somebody_writes_into_the_export(bench, exported):
    killed_while_somebody_writes(bench, exported, 40)


@pytest.mark.slow  # exports twice
def test_foreign_siblings_of_an_export_are_left_alone(bench, work):
    """Folders, files and links that are called as an earlier tactcad called its own."""
    exports = work / "exports"
    (exports / ".out.builds" / "1").mkdir(parents=True)
    (exports / ".out.builds" / "1" / "thesis.txt").write_text("ten years")
    (exports / "precious").write_text("keep")
    (exports / ".out.lock").symlink_to("precious")
    before = contents(exports)
    for design in "AB":
        assert export(work, design).returncode == 0
    shutil.rmtree(exports / "out")
    assert contents(exports) == before


def test_the_link_that_an_earlier_tactcad_wrote_is_refused_and_kept(bench, work):
    exports = work / "exports"
    shutil.copytree(bench.folder / "A" / "out", exports / ".out.builds" / "1")
    (exports / "out").symlink_to(".out.builds/1")
    said = refused(export(work, "B"))
    assert "is a link" in said
    assert contents(exports / "out") == bench.files["A"]


@pytest.mark.parametrize("name", ["golden", "releases", "check", "bench"])
def test_names_of_folders_in_exports_are_no_designs(work, name):
    text = (work / "A.toml").read_text()
    (work / "A.toml").write_text(text.replace('name = "macro-array"', f'name = "{name}"'))
    said = refused(tactcad_forked("export", "A.toml", cwd=work, env=environment(work)))
    assert said.startswith("tactcad: design.name: ")
    assert not (work / "exports").exists()
