"""Unfinished files and folders: held while their process lives, gone when it was killed and the next one
comes."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import tempfile
import tracemalloc
from pathlib import Path

import pytest

from tactcad.design.files import read_bytes, scratch_folder, whole_file, write_whole
from tactcad.design.messages import InputError
from tactcad.design.staging import MARK, staged_folder

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


def next_run(folder: Path) -> None:
    with staged_folder(folder, "x"):
        pass


def test_a_folder_that_is_being_written_stays(tmp_path):
    with staged_folder(tmp_path, "x") as folder:
        next_run(tmp_path)
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
    next_run(tmp_path)
    assert names(folder) == before and (folder / "thesis.txt").read_text() == "ten years"


def test_a_link_to_a_marked_folder_is_not_followed(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / MARK).write_text("1")
    (tmp_path / "x.tactcad-abcdefgh").symlink_to("elsewhere")
    next_run(tmp_path)
    assert (tmp_path / "elsewhere" / MARK).exists() and (tmp_path / "x.tactcad-abcdefgh").is_symlink()


def test_links_inside_a_left_folder_are_removed_not_followed(tmp_path):
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "thesis.txt").write_text("ten years")
    left = tmp_path / "x.tactcad-abcdefgh"
    left.mkdir()
    (left / MARK).write_text("1")
    (left / "making").symlink_to("../precious")
    next_run(tmp_path)
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


def test_a_write_protected_file_is_kept_and_another_keeps_its_permissions(tmp_path):
    mine = tmp_path / "mine.csv"
    mine.write_text("mine")
    mine.chmod(0o444)
    with pytest.raises(InputError, match="is write-protected; nothing was changed"):
        write_whole(mine, b"ours")
    assert mine.read_text() == "mine" and mine.stat().st_mode & 0o777 == 0o444
    mine.chmod(0o600)
    write_whole(mine, b"ours")
    assert mine.read_text() == "ours" and mine.stat().st_mode & 0o777 == 0o600


def test_no_temporary_folder_at_all(monkeypatch):
    def nowhere():
        raise FileNotFoundError(errno.ENOENT, "No usable temporary directory found")

    monkeypatch.setattr(tempfile, "gettempdir", nowhere)
    with (
        pytest.raises(InputError, match="^temporary folder: cannot be written: No usable"),
        scratch_folder("x"),
    ):
        pass


def test_a_small_file_takes_little_memory_whatever_it_may_be_at_most(tmp_path):
    (tmp_path / "small").write_bytes(bytes(60_000))
    tracemalloc.start()
    assert len(read_bytes(tmp_path / "small", 1_000_000_000, "a file")) == 60_000
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 5_000_000


@pytest.mark.parametrize(
    "made, staged", [("mkstemp", "staged_file(here / 'out.csv')"), ("mkdtemp", "staged_folder(here, 'out')")]
)
def test_a_signal_as_soon_as_it_exists_leaves_nothing(tmp_path, made, staged):
    """The moment between making a file or folder and knowing what to remove."""
    code = f"""
import os, signal, sys, tempfile
from pathlib import Path
from tactcad.design import staging
from tactcad.shutdown import end_on_signals

here, make = Path(sys.argv[1]), tempfile.{made}

def then_killed(*args, **how):
    out = make(*args, **how)
    os.kill(os.getpid(), signal.SIGTERM)
    return out

tempfile.{made} = then_killed
end_on_signals()
with staging.{staged}:
    pass
"""
    ended = subprocess.run([sys.executable, "-c", code, str(tmp_path)], capture_output=True, text=True)
    assert ended.returncode == 128 + signal.SIGTERM, ended.stderr
    assert list(tmp_path.iterdir()) == []
