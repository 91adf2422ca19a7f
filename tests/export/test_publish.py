"""All or nothing, and nothing of somebody's lost: kills at every file operation, two writers, a machine that
refuses."""

from __future__ import annotations

import errno
import json
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import nullcontext
from pathlib import Path

import publish_child
import pytest

from tactcad.design.messages import CheckFailure, InputError
from tactcad.export import manifest as manifests
from tactcad.export import publication as publish
from tactcad.export.publication import DISCARD, KEEP, REFUSE, replacing

CHILD = Path(__file__).with_name("publish_child.py")
FILES = {"a.step", "b.dxf", "sub/c.svg"}
SCHEMA = "tactcad-test-1"


def export(directory: Path, content: str, others: str = REFUSE, **more) -> None:
    with replacing(directory, SCHEMA, others, **more) as work:
        work.write({name: content.encode() for name in FILES})


def files(folder: Path) -> dict[str, str]:
    return {p.relative_to(folder).as_posix(): p.read_text() for p in folder.rglob("*") if p.is_file()}


def whole(directory: Path) -> str:
    """The one content of all three files."""
    assert directory.is_dir() and not directory.is_symlink()
    found = files(directory)
    found.pop("manifest.json")
    assert set(found) == FILES
    assert len(set(found.values())) == 1
    return found["a.step"]


def names(folder: Path) -> set[str]:
    return {p.name for p in folder.iterdir()}


def child(directory: Path, content: str, fatal: int = 0, *how: str) -> subprocess.Popen:
    arguments = [sys.executable, str(CHILD), str(directory), content, str(fatal), *how]
    return subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def forked(directory: Path, content: str, fatal: int, *how: str) -> int:
    """The same in a fork, which starts at once; returns its exit status."""
    process = os.fork()
    if not process:
        status = 3
        try:
            publish_child.main(str(directory), content, fatal, *how)
            status = 0
        except CheckFailure:
            status = 1
        finally:
            os._exit(status)
    return os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])


@pytest.fixture(params=["exchange", "two-renames"])
def way(request, monkeypatch) -> str:
    """Both ways of putting a folder in its place."""
    if request.param == "two-renames":
        monkeypatch.setattr(publish, "_exchange", lambda one, other: False)
    return request.param


# --- an ordinary folder ---


def test_first_and_next_exports(tmp_path, way):
    out = tmp_path / "deep" / "exports" / "macro"
    for content in "abcd":
        export(out, content)
        assert whole(out) == content
        assert names(out.parent) == {"macro"}


@pytest.mark.parametrize("how", ["rename", "cp -a", "cp -r", "tar"])
def test_what_was_moved_or_copied_stays_what_it_is(tmp_path, how):
    out, other = tmp_path / "ex", tmp_path / "ex-revA"
    export(out, "A")
    if how == "rename":
        out.rename(other)
    elif how == "tar":
        subprocess.run(["tar", "cf", "ex.tar", "ex"], cwd=tmp_path, check=True)
    else:
        subprocess.run([*how.split(), out, other], check=True)
    for content in "BCD":
        export(out, content)
        assert whole(out) == content
    if how == "tar":
        (tmp_path / "there").mkdir()
        subprocess.run(["tar", "xf", "../ex.tar"], cwd=tmp_path / "there", check=True)
        other = tmp_path / "there" / "ex"
    assert whole(other) == "A"
    export(other, "E")  # and is as good as where it was made
    assert whole(other) == "E"


def test_an_open_file_of_the_earlier_folder_stays_readable(tmp_path):
    out = tmp_path / "macro"
    export(out, "a" * 100_000)
    with (out / "a.step").open() as reader:
        begun = reader.read(10)
        export(out, "b")
        assert begun + reader.read() == "a" * 100_000


def test_the_folder_keeps_its_permission_bits(tmp_path):
    out = tmp_path / "macro"
    export(out, "a")
    out.chmod(0o2750)
    export(out, "b")
    assert out.stat().st_mode & 0o7777 == 0o2750


def test_an_exception_inside_changes_nothing(tmp_path):
    out = tmp_path / "macro"
    export(out, "a")
    with pytest.raises(CheckFailure, match="not closed"), replacing(out, SCHEMA) as work:
        (work.folder / "a.step").write_text("b")
        raise CheckFailure("contour not closed")
    assert whole(out) == "a"
    assert names(tmp_path) == {"macro"}


# --- what others put there ---


def fill_in(out: Path) -> None:
    (out / "a.step").write_text("measured")


def add(out: Path) -> None:
    (out / "sub" / "notes.txt").write_text("ten years")


def add_folder(out: Path) -> None:
    (out / "photos").mkdir()


def link(out: Path) -> None:
    shutil.copy(out / "a.step", out.parent / "same")
    (out / "a.step").unlink()
    (out / "a.step").symlink_to("../same")


def pipe(out: Path) -> None:
    (out / "b.dxf").unlink()
    os.mkfifo(out / "b.dxf")


def protect_file(out: Path) -> None:
    (out / "a.step").chmod(0o444)


def protect(out: Path) -> None:
    out.chmod(0o555)


def edit_manifest(out: Path) -> None:
    """Even so that it says what is there."""
    text = (out / "manifest.json").read_text()
    (out / "manifest.json").write_text(text.replace('"a.step"', '"A.step"'))
    (out / "a.step").rename(out / "A.step")


def without_manifest(out: Path) -> None:
    (out / "manifest.json").unlink()


def of_another_kind(out: Path) -> None:
    shutil.rmtree(out)
    with replacing(out, "tactcad-other-1") as work:
        work.write({"report.html": b"an evening's work"})


MEDDLINGS = {
    fill_in: "a.step (changed)",
    add: "sub/notes.txt (added)",
    add_folder: "photos (added)",
    link: "a.step (changed)",
    pipe: "b.dxf (changed)",
    protect_file: "a.step (write-protected)",
    protect: "the folder (write-protected)",
    edit_manifest: "manifest.json (changed)",
    without_manifest: "a.step (added)",
    of_another_kind: "report.html (added)",
}


def tree(folder: Path) -> dict[str, tuple]:
    """Everything below by path: its mode, and a file's content or a link's target."""
    found = {}
    for path in [folder, *sorted(folder.rglob("*"))]:
        state = path.lstat()
        held = os.readlink(path) if path.is_symlink() else path.read_bytes() if path.is_file() else ""
        found[path.relative_to(folder).as_posix()] = (state.st_mode, held)
    return found


@pytest.mark.parametrize("meddle", MEDDLINGS, ids=lambda m: m.__name__)
def test_what_somebody_did_in_the_folder_is_refused_named_kept_or_discarded(tmp_path, meddle, capsys, way):
    out = tmp_path / "ex"
    export(out, "old")
    meddle(out)
    before = tree(tmp_path)
    with pytest.raises(InputError, match="--keep.*--discard") as refusal:
        export(out, "new")
    assert MEDDLINGS[meddle] in str(refusal.value)
    assert tree(tmp_path) == before
    shutil.copytree(
        tmp_path, tmp_path.with_name(f"{tmp_path.name}-copy"), symlinks=True, copy_function=copied
    )

    export(out, "new", KEEP)
    assert whole(out) == "new" and "kept as" in capsys.readouterr().err
    assert tree(out.with_name("ex-kept-1")) == {
        k.removeprefix("ex").lstrip("/") or ".": v
        for k, v in before.items()
        if k == "ex" or k.startswith("ex/")
    }

    out = tmp_path.with_name(f"{tmp_path.name}-copy") / "ex"
    export(out, "new", DISCARD)
    assert whole(out) == "new" and MEDDLINGS[meddle] in capsys.readouterr().err
    assert "ex-kept-1" not in names(out.parent)


def test_what_is_larger_than_anything_of_ours_is_somebodys(tmp_path, monkeypatch):
    """Although it has its listed digest, which nobody waits for."""
    out = tmp_path / "ex"
    export(out, "old" * 5000)
    monkeypatch.setattr(manifests, "MOST_BYTES", (out / "manifest.json").stat().st_size)
    with pytest.raises(InputError, match=r"a\.step \(changed\)"):
        export(out, "new")


def copied(source: str, target: str) -> None:
    if Path(source).is_fifo():
        os.mkfifo(target)
    else:
        shutil.copy2(source, target, follow_symlinks=False)


def test_names_of_kept_folders_are_never_taken_twice(tmp_path, way):
    out = tmp_path / "ex"
    (tmp_path / "ex-kept-2").symlink_to("nowhere")
    for content in "abc":
        export(out, content)
        fill_in(out)
        export(out, content.upper(), KEEP)
    assert {n: (tmp_path / n / "b.dxf").read_text() for n in names(tmp_path) - {"ex", "ex-kept-2"}} == {
        "ex-kept-1": "a",
        "ex-kept-3": "b",
        "ex-kept-4": "c",
    }


def test_what_is_missing_is_nothing_to_lose(tmp_path):
    export(tmp_path / "ex", "a")
    (tmp_path / "ex" / "a.step").unlink()
    shutil.rmtree(tmp_path / "ex" / "sub")
    export(tmp_path / "ex", "b")
    assert whole(tmp_path / "ex") == "b"


@pytest.mark.parametrize("others", [REFUSE, KEEP, DISCARD])
def test_what_appears_while_the_new_folder_is_made_is_kept_and_said(tmp_path, way, others, capsys):
    out = tmp_path / "ex"
    export(out, "old")
    if others != REFUSE:
        fill_in(out)
    said = r"the earlier folder is kept as .*ex-kept-1 for .*sub/notes.txt \(added\)$"
    asked = others == KEEP
    with nullcontext() if asked else pytest.raises(CheckFailure, match=f"is in place; {said}"):
        with replacing(out, SCHEMA, others) as work:
            add(out)
            work.write({name: b"new" for name in FILES})
    assert re.search(said, capsys.readouterr().err.strip()) if asked else True
    assert whole(out) == "new"
    kept = files(tmp_path / "ex-kept-1")
    assert kept["sub/notes.txt"] == "ten years" and kept["b.dxf"] == "old"
    assert names(tmp_path) == {"ex", "ex-kept-1"}


def test_a_folder_moved_away_meanwhile(tmp_path, way):
    out = tmp_path / "ex"
    export(out, "A")
    with replacing(out, SCHEMA) as work:
        out.rename(tmp_path / "ex-revA")
        work.write({name: b"B" for name in FILES})
    assert whole(out) == "B" and whole(tmp_path / "ex-revA") == "A"


# --- kills ---


def killed_everywhere(tmp_path: Path, *how: str, meddled: bool = False) -> tuple[int, int]:
    """One run dies before its first operation, the next before its second, until one has lived.

    After each the next run settles what it left: DIR is whole, and what somebody wrote is in DIR or kept.
    Returns how many died with the earlier folder standing and with the new one.
    """
    out, stood = tmp_path / "macro", []
    export(out, "old")
    for fatal in range(1, 200):
        before = whole(out)
        status = forked(out, f"new {fatal}", fatal, *how, *(["meddled"] if meddled else []))
        notes = list(tmp_path.rglob("meanwhile.txt"))
        assert len(notes) <= 1 and all(note.read_text() == "of somebody" for note in notes)
        if "two-renames" not in how:
            # what stands is the earlier or the new one, with what somebody wrote into it
            assert {f: t for f, t in files(out).items() if f not in ("manifest.json", "meanwhile.txt")} in (
                dict.fromkeys(FILES, before),
                dict.fromkeys(FILES, f"new {fatal}"),
            )
        if status != -signal.SIGKILL:
            assert status == (1 if meddled else 0)
            break
        settle(out, bool(notes))
        assert whole(out) in (before, f"new {fatal}")
        stood.append(whole(out) == f"new {fatal}")
        for kept in tmp_path.glob("macro-kept-*"):
            shutil.rmtree(kept)
        assert names(tmp_path) == {"macro"}
    else:
        pytest.fail("never lived")
    return stood.count(False), stood.count(True)


def settle(out: Path, noted: bool) -> None:
    """What the next run does first; it finds what somebody wrote in DIR, or in what the killed one left."""
    try:
        with replacing(out, SCHEMA):
            pass
    except InputError:  # in DIR: it refuses, and the user moves it
        (out / "meanwhile.txt").unlink()
        return settle(out, False)
    except CheckFailure as error:
        assert noted and "kept as" in str(error) and "meanwhile.txt (added)" in str(error)
        (kept,) = out.parent.glob("macro-kept-*")
        assert (kept / "meanwhile.txt").read_text() == "of somebody"
    else:
        assert not noted or list(out.parent.glob("macro-kept-*/meanwhile.txt"))


@pytest.mark.by_day(1, "hundreds of processes each")
@pytest.mark.parametrize(
    "how, meddled",
    [
        ("exchange", True),
        ("two-renames", False),
        pytest.param("exchange", False, marks=pytest.mark.slow),  # a process for every file operation
        pytest.param("two-renames", True, marks=pytest.mark.slow),  # a process for every file operation
    ],
)
def test_killed_before_every_single_file_operation(tmp_path, how, meddled):
    earlier, new = killed_everywhere(tmp_path, how, meddled=meddled)
    assert earlier > 15  # died before the exchange
    assert new > 3  # died after it, while the earlier folder went


def test_killed_on_the_very_first_export(tmp_path):
    for fatal in range(1, 80):
        out = tmp_path / str(fatal) / "macro"
        status = forked(out, "new", fatal)
        assert not os.path.lexists(out) or whole(out) == "new"
        if status == 0:
            break
    assert status == 0


def test_killed_at_random_moments(tmp_path):
    out = tmp_path / "macro"
    export(out, "old")
    moment = random.Random(4)
    before = "old"
    for turn_no in range(8):
        run = child(out, f"new {turn_no}")
        time.sleep(moment.uniform(0.02, 0.12))
        run.kill()
        run.communicate()
        assert whole(out) in (before, f"new {turn_no}")
        before = whole(out)
    export(out, "last")
    assert names(tmp_path) == {"macro"}


def test_what_a_killed_run_left_is_named_although_the_next_refuses(tmp_path):
    out, said = tmp_path / "macro", []
    export(out, "a")
    left = tmp_path / ".macro.tactcad-abcdefgh"
    left.mkdir()
    (left / "written-by-tactcad").write_text("1")
    shutil.copytree(out, left / "apart")
    add(left / "apart")
    with pytest.raises(CheckFailure, match="not closed"), replacing(out, SCHEMA, say=said.append):
        raise CheckFailure("contour not closed")
    (line,) = said
    assert "macro-kept-1 for sub/notes.txt (added)" in line
    assert names(tmp_path) == {"macro", "macro-kept-1"}


@pytest.mark.parametrize("whole", [True, False])
def test_what_a_killed_run_left_is_put_back_where_there_is_no_folder_unless_half_removed(tmp_path, whole):
    out, left = tmp_path / "macro", tmp_path / ".macro.tactcad-abcdefgh"
    export(out, "a")
    left.mkdir()
    (left / "written-by-tactcad").write_text("1")
    out.rename(left / "apart")
    if not whole:
        (left / "apart" / "a.step").unlink()
    with pytest.raises(CheckFailure, match="not closed"), replacing(out, SCHEMA):
        raise CheckFailure("contour not closed")
    assert names(tmp_path) == ({"macro"} if whole else set())


def test_interrupted_while_the_earlier_folder_is_looked_at(tmp_path, monkeypatch):
    """Ctrl-C between exchange and look: what somebody wrote is not removed with our own folder."""
    out = tmp_path / "ex"
    export(out, "old")
    real = publish._settled

    def settled(*arguments):
        monkeypatch.setattr(publish, "_settled", real)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), replacing(out, SCHEMA) as work:
        add(out)
        monkeypatch.setattr(publish, "_settled", settled)
        work.write({name: b"new" for name in FILES})
    assert whole(out) == "new"
    assert (tmp_path / "ex-kept-1" / "sub" / "notes.txt").read_text() == "ten years"
    assert names(tmp_path) == {"ex", "ex-kept-1"}


# --- writers at once ---


@pytest.mark.parametrize("how", ["exchange", "two-renames"])
def test_of_writers_at_once_one_stays_whole(tmp_path, how):
    """Who meets another between its renames, or while it looks, is refused: it finds the other's folder in
    its way, none at all, or files that are not of the manifest that it read."""
    refused = ("Directory not empty", "No such file", "holds what is not as tactcad wrote it")
    out = tmp_path / "macro"
    runs = [child(out, content, 0, how) for content in "abcd"]
    for run in runs:
        said = run.communicate()[1]
        assert run.returncode == 0 or any(words in said for words in refused)
    assert whole(out) in "abcd"
    assert names(tmp_path) == {"macro"}


def test_a_writer_leaves_the_folder_of_another_that_runs(tmp_path):
    out = tmp_path / "macro"
    with replacing(out, SCHEMA) as slow:
        export(out, "fast")
        assert whole(out) == "fast" and slow.folder.is_dir()
        slow.write({name: b"slow" for name in FILES})
    assert whole(out) == "slow" and names(tmp_path) == {"macro"}


def test_what_a_killed_writer_left_goes_with_the_next(tmp_path):
    out = tmp_path / "macro"
    holder = child(out, "never", 0, "hanging")
    assert holder.stdout.readline() == "hanging\n"
    holder.kill()
    holder.communicate()
    export(out, "a")
    assert whole(out) == "a" and names(tmp_path) == {"macro"}


# --- foreign things of like names ---


FOREIGN = (
    ".foo.builds",
    ".foo.lock",
    ".foo.tactcad-abcdefgh",
    ".foo.tactcad-short",
    ".foo.tactcad-12345678.part",
)


@pytest.mark.parametrize("name", FOREIGN)
@pytest.mark.parametrize("kind", ["folder", "file", "link", "link to a folder"])
def test_foreign_siblings_are_not_touched(tmp_path, name, kind):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "thesis.txt").write_text("ten years")
    (elsewhere / "written-by-tactcad").write_text("not with this name")
    place = tmp_path / name
    if kind == "folder":
        place.mkdir()
        (place / "thesis.txt").write_text("ten years")
    elif kind == "file":
        place.write_text("ten years")
    else:
        place.symlink_to("elsewhere" if kind == "link to a folder" else "elsewhere/thesis.txt")
    before = tree(tmp_path)
    for content in "ab":
        export(tmp_path / "foo", content)
    shutil.rmtree(tmp_path / "foo")
    assert tree(tmp_path) == before


def test_an_empty_folder_is_replaced(tmp_path, way):
    out = tmp_path / "macro"
    out.mkdir()
    export(out, "a")
    assert whole(out) == "a" and names(tmp_path) == {"macro"}


def folder_of_somebody(path: Path) -> None:
    path.mkdir()
    (path / "thesis.txt").write_text("ten years")


def link_of_somebody(path: Path) -> None:
    folder_of_somebody(path.with_name("elsewhere"))
    path.symlink_to("elsewhere")


def file_of_somebody(path: Path) -> None:
    path.write_text("ten years")


def earlier_tactcads(path: Path) -> None:
    folder_of_somebody(path.with_name(".macro.builds"))
    path.symlink_to(".macro.builds/7")


@pytest.mark.parametrize("make", [folder_of_somebody, link_of_somebody, file_of_somebody, earlier_tactcads])
@pytest.mark.parametrize("others", [REFUSE, KEEP])
def test_what_is_not_ours_is_refused_or_kept(tmp_path, make, others):
    out = tmp_path / "macro"
    make(out)
    before = sorted(tmp_path.rglob("*"))
    if make is folder_of_somebody and others == KEEP:
        export(out, "a", others)
        assert files(tmp_path / "macro-kept-1") == {"thesis.txt": "ten years"}
        return
    with pytest.raises(InputError, match="macro: .*legal: "):
        export(out, "a", others)
    assert sorted(tmp_path.rglob("*")) == before


def test_an_export_inside_an_export_is_refused(tmp_path):
    export(tmp_path / "macro", "a")
    with pytest.raises(InputError, match="lies inside"):
        export(tmp_path / "macro" / "deep" / "again", "b")
    assert whole(tmp_path / "macro") == "a" and "deep" not in names(tmp_path / "macro")


def test_the_root_folder_is_refused():
    with pytest.raises(InputError, match="cannot be replaced"):
        publish.looked_at("/", SCHEMA)


def test_a_mount_point_is_refused_before_anything_is_made(tmp_path, monkeypatch):
    export(tmp_path / "macro", "a")
    monkeypatch.setattr(os.path, "ismount", lambda path: Path(path) == tmp_path / "macro")
    with pytest.raises(InputError, match="is a mount point"):
        publish.looked_at(tmp_path / "macro", SCHEMA)
    assert whole(tmp_path / "macro") == "a"


def test_a_folder_that_cannot_be_read_is_nobodys_to_remove(tmp_path, monkeypatch):
    """What lies in it is not missing: it may be anybody's."""
    export(tmp_path / "macro", "a")
    scan = os.scandir

    def of_others(folder):
        if Path(folder).name == "sub":
            raise PermissionError(errno.EACCES, "Permission denied", str(folder))
        return scan(folder)

    monkeypatch.setattr(os, "scandir", of_others)
    with pytest.raises(InputError, match=r"Permission denied \(.*macro/sub\); nothing was changed"):
        export(tmp_path / "macro", "b")
    monkeypatch.undo()
    assert whole(tmp_path / "macro") == "a"


@pytest.mark.parametrize(
    "manifest",
    [
        "[" * 100_000,
        "null",
        "{}",
        '{"schema": "tactcad-test-1"}',
        '{"schema": "tactcad-test-1", "files": [{"path": 1}], "seal": 1}',
        "\0",
    ],
)
def test_a_manifest_of_somebody_makes_nothing_ours(tmp_path, manifest):
    out = tmp_path / "macro"
    out.mkdir()
    (out / "manifest.json").write_text(manifest)
    with pytest.raises(InputError, match=r"manifest.json \(changed\)"):
        export(out, "a")
    assert (out / "manifest.json").read_text() == manifest


def test_a_sealed_manifest_that_leads_out_of_the_folder_reaches_nothing(tmp_path):
    from tactcad.export.manifest import sealed, sha256_of

    (tmp_path / "precious").write_text("keep")
    out = tmp_path / "macro"
    out.mkdir()
    rows = [
        {"path": path, "sha256": sha256_of(b"keep")} for path in ("../precious", str(tmp_path / "precious"))
    ]
    (out / "manifest.json").write_bytes(sealed({"schema": SCHEMA, "files": rows}))
    export(out, "a")
    assert whole(out) == "a" and (tmp_path / "precious").read_text() == "keep"


def test_a_manifest_lists_every_file_by_its_digest(tmp_path):
    export(tmp_path / "macro", "a")
    rows = json.loads((tmp_path / "macro" / "manifest.json").read_text())["files"]
    checked = subprocess.run(
        ["sha256sum", "--strict", "-c"],
        input="".join(f"{row['sha256']}  {row['path']}\n" for row in rows),
        cwd=tmp_path / "macro",
        capture_output=True,
        text=True,
        check=True,
    )
    assert checked.stdout.count(": OK") == len(FILES)


# --- a machine that refuses ---


def test_a_full_disk(tmp_path):
    out = tmp_path / "macro"
    export(out, "a")
    refused = pytest.raises(CheckFailure, match="No space left on device.*nothing was changed")
    with refused, replacing(out, SCHEMA) as work:
        (work.folder / "a.step").symlink_to("/dev/full")  # the kernel's own full disk
        work.write({"a.step": b"b" * 100_000})
    assert whole(out) == "a"
    assert names(tmp_path) == {"macro"}


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
    assert whole(out) == "a" and names(tmp_path) == {"macro"}


def test_a_parent_that_is_a_file(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        export(tmp_path / "file" / "macro", "a")


@pytest.mark.parametrize("length", [252, 300])
def test_a_name_that_is_too_long(tmp_path, length):
    with pytest.raises(InputError, match="File name too long"):
        export(tmp_path / ("x" * length), "a")


READ_ONLY = """
import os, sys
from tactcad.design.messages import InputError
from tactcad.export.publication import replacing
if os.geteuid() == 0:
    os.seteuid(65534)  # root may write everywhere; nobody may not
try:
    with replacing(sys.argv[1], 's'): pass
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
