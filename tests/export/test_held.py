"""Unfinished files and folders: held while their process lives, gone when it was killed and the next one
comes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tactcad.design.files import scratch_folder, whole_file, write_whole
from tactcad.design.held import MARK, held_folder, sweep_folders

KILLED = """
import os, signal, sys, tempfile
from pathlib import Path
from tactcad.design.files import scratch_folder, whole_file
tempfile.tempdir = sys.argv[1]
seen = 0
def count(event, args):
    global seen
    if event in ("open", "os.mkdir", "os.rename", "os.remove", "os.rmdir", "fcntl.flock", "os.chmod"):
        seen += 1
        if seen == int(sys.argv[2]):
            os.kill(os.getpid(), signal.SIGKILL)
sys.addaudithook(count)
with scratch_folder("release") as folder:
    (folder / "sub").mkdir()
    (folder / "sub" / "a.step").write_text("half")
    with whole_file(Path(sys.argv[1], "a.json")) as part:
        part.write_text("new")
"""


def names(folder: Path) -> set[str]:
    return {p.name for p in folder.iterdir()}


def test_what_a_killed_run_left_goes_with_the_next(tmp_path, monkeypatch):
    """Killed before every single file operation; then the next run of both kinds."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    (tmp_path / "a.json").write_text("old")
    left = 0
    for fatal in range(1, 60):
        run = subprocess.run([sys.executable, "-c", KILLED, str(tmp_path), str(fatal)], check=False)
        left += names(tmp_path) != {"a.json"}
        assert (tmp_path / "a.json").read_text() in ("old", "new")
        with scratch_folder("release") as folder:
            assert names(tmp_path) - {"a.json"} - {p.name for p in tmp_path.glob("*.part")} == {folder.name}
        write_whole(tmp_path / "a.json", b"old")
        assert names(tmp_path) == {"a.json"}
        if run.returncode == 0:
            break
        assert run.returncode == -signal.SIGKILL
    assert run.returncode == 0 and left > 10


def test_a_folder_that_is_held_stays(tmp_path):
    with held_folder(tmp_path, "x") as folder:
        assert sweep_folders(tmp_path, "x") == (str(os.getpid()),)
        assert folder.is_dir() and names(folder) == {MARK}
    assert names(tmp_path) == set()


@pytest.mark.parametrize("mark", ["none", "link", "folder", "pipe"])
def test_a_folder_without_our_mark_stays(tmp_path, mark):
    folder = tmp_path / "x.tactcad-abcdefgh"
    folder.mkdir()
    (folder / "thesis.txt").write_text("ten years")
    if mark == "link":
        (folder / MARK).symlink_to("thesis.txt")
    elif mark == "folder":
        (folder / MARK).mkdir()
    elif mark == "pipe":
        os.mkfifo(folder / MARK)
    before = names(folder)
    assert sweep_folders(tmp_path, "x") == ()
    assert names(folder) == before and (folder / "thesis.txt").read_text() == "ten years"


def test_a_link_to_a_marked_folder_is_not_followed(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / MARK).write_text("1")
    (tmp_path / "x.tactcad-abcdefgh").symlink_to("elsewhere")
    sweep_folders(tmp_path, "x")
    assert (tmp_path / "elsewhere" / MARK).exists() and (tmp_path / "x.tactcad-abcdefgh").is_symlink()


def test_links_inside_a_left_folder_are_removed_not_followed(tmp_path):
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "thesis.txt").write_text("ten years")
    left = tmp_path / "x.tactcad-abcdefgh"
    left.mkdir()
    (left / MARK).write_text("1")
    (left / "making").symlink_to("../precious")
    sweep_folders(tmp_path, "x")
    assert not left.exists() and (tmp_path / "precious" / "thesis.txt").exists()


def test_a_file_with_a_long_name_has_a_part_of_its_own(tmp_path):
    place = tmp_path / ("n" * 250)
    with whole_file(place) as part:
        part.write_text("x")
    assert names(tmp_path) == {place.name}


def test_the_part_of_another_file_stays(tmp_path):
    """`a` and `a.b` both have parts that begin alike."""
    other = tmp_path / ".a.b.tactcad-abcdefgh.part"
    other.write_text("half")
    write_whole(tmp_path / "a", b"x")
    assert other.exists()
    write_whole(tmp_path / "a.b", b"x")
    assert not other.exists()
