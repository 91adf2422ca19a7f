"""The zip's form, and its appearing whole or not at all: killed anywhere, two at once, a machine that
refuses."""

from __future__ import annotations

import fcntl
import os
import resource
import signal
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import pytest

from tactcad.design.files import whole_file
from tactcad.design.messages import CheckFailure, InputError
from tactcad.release.archive import MANIFEST, archive_bytes, replaced_content

CHILD = Path(__file__).with_name("archive_child.py")
FILES = {"README.txt": b"read me", "dxf/a_A.dxf": b"0\nEOF\n" * 500, "step/ä_A.step": b"\x00\xff"}


def child(target: Path, letter: str, fatal: int = 0) -> subprocess.Popen:
    return subprocess.Popen(
        [sys.executable, str(CHILD), str(target), letter, str(fatal)], stdout=subprocess.PIPE, text=True
    )


def whole(target: Path) -> str:
    text = target.read_text()
    assert len(text) == 50_000 and len(set(text)) == 1
    return text[0]


def test_checksums_and_permissions_hold_after_unzip(tmp_path):
    (tmp_path / "a.zip").write_bytes(archive_bytes(FILES, "2026-11-21"))
    os.umask(os.umask(0o022))
    subprocess.run(["unzip", "-q", "a.zip", "-d", "out"], cwd=tmp_path, check=True)
    checked = subprocess.run(
        ["sha256sum", "--strict", "-c", MANIFEST],
        cwd=tmp_path / "out",
        capture_output=True,
        text=True,
        check=False,
    )
    assert checked.returncode == 0 and checked.stdout.count(": OK") == len(FILES), checked.stderr
    for name, data in FILES.items():
        path = tmp_path / "out" / name
        assert path.read_bytes() == data and path.stat().st_mode & 0o777 == 0o644


@pytest.mark.parametrize("date", ["2026-11-21", "1980-01-01", "0001-02-28", "9999-12-31", "2024-02-29"])
def test_one_date_on_every_entry(date):
    import io

    with zipfile.ZipFile(io.BytesIO(archive_bytes(FILES, date))) as archive:
        assert archive.namelist() == [*FILES, MANIFEST]
        (stamp,) = {e.date_time for e in archive.infolist()}
    year = min(max(int(date[:4]), 1980), 2107)
    assert stamp == (year, int(date[5:7]), int(date[8:]), 0, 0, 0)


def test_killed_before_every_single_file_operation(tmp_path):
    target = tmp_path / "deep" / "a.zip"
    child(target, "o").communicate()
    outcomes = []
    for fatal in range(1, 40):
        before = whole(target)
        letter = chr(ord("A") + fatal % 26)
        run = child(target, letter, fatal)
        run.communicate()
        assert whole(target) in (before, letter)
        outcomes.append(whole(target) == letter)
        if run.returncode == 0:
            break
        assert run.returncode == -signal.SIGKILL
    assert run.returncode == 0 and outcomes[-1]
    assert outcomes.count(False) >= 4 and outcomes.count(True) >= 2
    assert [p.name for p in target.parent.iterdir()] == [
        "a.zip"
    ]  # the last one swept what the killed ones left


def test_two_writers_at_once_leave_one_whole_file(tmp_path):
    target = tmp_path / "a.zip"
    runs = [child(target, letter) for letter in "abcd"]
    assert [run.wait() for run in runs] == [0] * 4
    assert whole(target) in "abcd"
    assert [p.name for p in tmp_path.iterdir()] == ["a.zip"]


def test_a_reader_keeps_the_file_that_it_opened(tmp_path):
    target = tmp_path / "a.zip"
    target.write_bytes(b"old" * 1000)
    with target.open("rb") as reader:
        assert reader.read(3) == b"old"
        with whole_file(target) as part:
            part.write_bytes(b"new")
        assert reader.read() == b"old" * 999
    assert target.read_bytes() == b"new"


def test_what_fails_inside_changes_nothing(tmp_path):
    target = tmp_path / "a.zip"
    target.write_bytes(b"old")
    with pytest.raises(CheckFailure), whole_file(target) as part:
        part.write_bytes(b"new")
        raise CheckFailure("does not read back")
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == {"a.zip": b"old"}


def test_a_full_disk(tmp_path):
    """The limit on a file's size stands for the disk's: the same kind of refusal in the middle of writing."""
    target = tmp_path / "a.zip"
    target.write_bytes(b"old")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        with (
            pytest.raises(CheckFailure, match="File too large.*nothing was changed"),
            whole_file(target) as part,
        ):
            part.write_bytes(b"n" * 5000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == {"a.zip": b"old"}


READ_ONLY = """
import os, sys
from pathlib import Path
from tactcad.design.messages import InputError
from tactcad.design.files import whole_file
if os.geteuid() == 0:
    os.seteuid(65534)  # root may write everywhere; nobody may not
try:
    with whole_file(Path(sys.argv[1])): pass
except InputError as error:
    sys.exit("refused: " + str(error))
"""


def test_a_read_only_folder():
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "a.zip").write_bytes(b"old")
        os.chmod(name, 0o555)
        run = subprocess.run(
            [sys.executable, "-c", READ_ONLY, f"{name}/a.zip"], capture_output=True, text=True, check=False
        )
        assert (
            run.returncode == 1 and run.stderr.startswith("refused: ") and "Permission denied" in run.stderr
        )
        assert os.listdir(name) == ["a.zip"] and (Path(name) / "a.zip").read_bytes() == b"old"


@pytest.mark.parametrize("where", ["file/a.zip", "folder"])
def test_places_that_cannot_be(where, tmp_path):
    (tmp_path / "file").write_text("")
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError, match="cannot be written|not a file"), whole_file(tmp_path / where):
        pytest.fail("let in")


@pytest.mark.parametrize("name", [".a.zip.part", ".a.zip.tactcad-abcdefgh.part", ".a.zip.tactcad-short.part"])
def test_files_of_others_beside_stay(name, tmp_path):
    """A link of our form is not followed; a file of our form that is held, and names of other forms, stay."""
    (tmp_path / "precious").write_text("keep")
    (tmp_path / name).symlink_to("precious")
    other = tmp_path / ".a.zip.tactcad-held0000.part"
    with other.open("w") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        with whole_file(tmp_path / "a.zip") as part:
            part.write_text("x")
    assert (tmp_path / "precious").read_text() == "keep"
    assert (tmp_path / name).is_symlink() and other.exists()
    with whole_file(tmp_path / "a.zip"):
        pass
    assert not other.exists()  # nobody holds it any more


def test_what_an_earlier_zip_has_otherwise_is_named(tmp_path):
    target = tmp_path / "a.zip"
    new = archive_bytes(FILES, "2026-11-21")
    assert replaced_content(target, new) == []
    target.write_bytes(new)
    assert replaced_content(target, new) == []
    target.write_bytes(archive_bytes({**FILES, "README.txt": b"other", "bom.csv": b""}, "2026-11-21"))
    assert replaced_content(target, new) == ["README.txt", "bom.csv"]
