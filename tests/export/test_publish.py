"""All or nothing, tried with kills at every file operation, two writers, and a machine that refuses."""

from __future__ import annotations

import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

from tactcad.design.messages import CheckFailure, InputError
from tactcad.export.publish import locked, new_build, published

CHILD = Path(__file__).with_name("publish_child.py")
FILES = {"a.step", "b.dxf", "sub/c.svg"}


def export(directory: Path, content: str) -> None:
    with locked(directory) as place, new_build(place) as folder:
        for name in FILES:
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).write_text(content)


def whole(directory: Path) -> str:
    """The one content of all three files."""
    found = {p.relative_to(directory).as_posix(): p.read_text() for p in directory.rglob("*") if p.is_file()}
    assert set(found) == FILES
    assert len(set(found.values())) == 1
    return found["a.step"]


def names(folder: Path) -> set[str]:
    return {p.name for p in folder.iterdir()}


def child(directory: Path, content: str, fatal: int = 0) -> subprocess.Popen:
    arguments = [sys.executable, str(CHILD), str(directory), content, str(fatal)]
    return subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_first_and_next_exports(tmp_path):
    out = tmp_path / "deep" / "exports" / "macro"
    for content in "abcd":
        export(out, content)
        assert whole(out) == content
    assert not Path(os.readlink(out)).is_absolute()
    assert names(out.parent / ".macro.builds") == {"3", "4"}  # the current one and the one before


def test_the_folder_may_be_moved_with_its_builds(tmp_path):
    export(tmp_path / "exports" / "macro", "a")
    (tmp_path / "exports").rename(tmp_path / "elsewhere")
    assert whole(tmp_path / "elsewhere" / "macro") == "a"


def test_a_reader_keeps_the_build_that_it_opened(tmp_path):
    out = tmp_path / "macro"
    export(out, "a")
    opened = published(out).current
    export(out, "b")
    assert whole(opened) == "a"
    assert whole(out) == "b"


def test_an_exception_inside_changes_nothing(tmp_path):
    out = tmp_path / "macro"
    export(out, "a")
    with pytest.raises(CheckFailure, match="not closed"), locked(out) as place, new_build(place) as folder:
        (folder / "a.step").write_text("b")
        raise CheckFailure("contour not closed")
    assert whole(out) == "a"
    assert names(tmp_path / ".macro.builds") == {"1"}


def test_killed_before_every_single_file_operation(tmp_path):
    """One run dies before its first operation, the next before its second, until one has lived."""
    out = tmp_path / "macro"
    export(out, "very old")
    export(out, "old")
    before, outcomes = "old", []
    for fatal in range(1, 80):
        run = child(out, f"new {fatal}", fatal)
        run.communicate()
        assert whole(out) in (before, f"new {fatal}")
        outcomes.append(whole(out) == f"new {fatal}")
        before = whole(out)
        if run.returncode == 0:
            break
        assert run.returncode == -signal.SIGKILL
    assert run.returncode == 0
    assert outcomes.count(False) > 15  # died before the switch
    assert outcomes.count(True) > 3  # died after it, while sweeping
    assert len(names(tmp_path / ".macro.builds")) == 2
    assert names(tmp_path) == {"macro", ".macro.builds", ".macro.lock"}


def test_killed_on_the_very_first_export(tmp_path):
    for fatal in range(1, 40):
        out = tmp_path / str(fatal) / "macro"
        run = child(out, "new", fatal)
        run.communicate()
        assert not os.path.lexists(out) or whole(out) == "new"
        if run.returncode == 0:
            break
    assert run.returncode == 0


def test_killed_at_random_moments(tmp_path):
    out = tmp_path / "macro"
    export(out, "old")
    moment = random.Random(4)
    before = "old"
    for turn in range(8):
        run = child(out, f"new {turn}")
        time.sleep(moment.uniform(0.02, 0.12))
        run.kill()
        run.communicate()
        assert whole(out) in (before, f"new {turn}")
        before = whole(out)


def test_two_writers_take_turns(tmp_path):
    out = tmp_path / "macro"
    runs = [child(out, content) for content in "abcd"]
    for run in runs:
        run.communicate()
        assert run.returncode == 0
    assert whole(out) in "abcd"
    assert len(names(tmp_path / ".macro.builds")) == 2


def test_who_waits_says_for_whom_and_gives_up_in_the_end(tmp_path):
    out = tmp_path / "macro"
    said = []
    gives_up = pytest.raises(CheckFailure, match=f"process {os.getpid()}.*nothing was changed")
    with locked(out), gives_up, locked(out, wait=0.25, say=said.append):
        pass
    assert len(said) == 1
    assert f"process {os.getpid()}" in said[0]


def test_the_lock_goes_with_a_killed_process(tmp_path):
    out = tmp_path / "macro"
    script = (
        "import time; from tactcad.export.publish import locked\n"
        f"with locked({str(out)!r}): print(1, flush=True); time.sleep(60)"
    )
    holder = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE)
    holder.stdout.readline()
    holder.kill()
    holder.communicate()
    with locked(out, wait=0.0):
        pass


def test_an_empty_folder_is_replaced(tmp_path):
    out = tmp_path / "macro"
    out.mkdir()
    export(out, "a")
    assert whole(out) == "a"


def folder_of_somebody(path: Path) -> None:
    path.mkdir()
    (path / "thesis.txt").write_text("ten years")


def link_of_somebody(path: Path) -> None:
    folder_of_somebody(path.with_name("elsewhere"))
    path.symlink_to("elsewhere")


def file_of_somebody(path: Path) -> None:
    path.write_text("ten years")


@pytest.mark.parametrize("make", [folder_of_somebody, link_of_somebody, file_of_somebody])
def test_what_is_not_ours_is_refused_and_kept(tmp_path, make):
    out = tmp_path / "macro"
    make(out)
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(InputError, match="macro: is a .*legal: a new name"):
        export(out, "a")
    assert sorted(tmp_path.rglob("*")) == before


def test_an_export_inside_an_export_is_refused(tmp_path):
    export(tmp_path / "macro", "a")
    with pytest.raises(InputError, match="inside an earlier export"):
        export(tmp_path / "macro" / "again", "b")
    assert whole(tmp_path / "macro") == "a"


def test_the_root_folder_is_refused():
    with pytest.raises(InputError, match="cannot be replaced"):
        published("/")


def test_a_full_disk(tmp_path):
    out = tmp_path / "macro"
    export(out, "a")
    refused = pytest.raises(CheckFailure, match="No space left on device.*nothing was changed")
    with refused, locked(out) as place, new_build(place) as folder:
        (folder / "a.step").symlink_to("/dev/full")  # the kernel's own full disk
        (folder / "a.step").write_text("b" * 100_000)
    assert whole(out) == "a"
    assert names(tmp_path / ".macro.builds") == {"1"}


def test_a_file_larger_than_allowed(tmp_path):
    out = tmp_path / "macro"
    export(out, "a")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        with pytest.raises(CheckFailure, match="File too large"):
            export(out, "b" * 2000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert whole(out) == "a"


def test_a_parent_that_is_a_file(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        export(tmp_path / "file" / "macro", "a")


def test_a_name_that_is_too_long(tmp_path):
    with pytest.raises(InputError, match="File name too long"):
        export(tmp_path / ("x" * 252), "a")


READ_ONLY = """
import os, sys
from tactcad.design.messages import InputError
from tactcad.export.publish import locked, new_build
if os.geteuid() == 0:
    os.seteuid(65534)  # root may write everywhere; nobody may not
try:
    with locked(sys.argv[1]) as place, new_build(place): pass
except InputError as error:
    sys.exit("refused: " + str(error))
"""


def test_a_read_only_folder():
    with tempfile.TemporaryDirectory() as name:
        os.chmod(name, 0o555)
        run = subprocess.run(
            [sys.executable, "-c", READ_ONLY, f"{name}/macro"], capture_output=True, text=True, check=False
        )
        assert run.returncode == 1
        assert run.stderr.startswith("refused: ")
        assert "Permission denied" in run.stderr
        assert not os.listdir(name)


def test_names_in_any_script_and_locale(tmp_path):
    out = tmp_path / "feder äö 触覚"
    run = subprocess.run(
        [sys.executable, str(CHILD), str(out), "a", "0"],
        env={**os.environ, "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
        capture_output=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert whole(out) == "a"
