"""Nobody's file is lost where zips are written: refused, kept or discarded; killed anywhere; a full disk."""

from __future__ import annotations

import os
import resource
import signal
import sys
import tracemalloc
import zipfile
from pathlib import Path

import pytest
from variants import TINY_TEXT

from tactcad.cli.main import main
from tactcad.design.messages import CheckFailure, InputError
from tactcad.release import archive as places
from tactcad.release.archive import MANIFEST, SEAL, archive_bytes

NAMES = ("a-A.zip", "a-A-sheet.zip", "a-A-gone.zip")  # the last one has no new zip
KEPT = {name: f"{name[:-4]}-kept-1.zip" for name in NAMES}
CHANGES = {"os.rename", "os.mkdir", "os.remove", "os.rmdir", "os.link", "open", "os.chmod", "fcntl.flock"}
WAYS = ("refuse", "keep", "discard")


def zipped(text: str, **more: bytes) -> bytes:
    return archive_bytes({"README.txt": text.encode(), **more}, "2026-11-21")


def publish(out: Path, text: str, others: str = "refuse", meanwhile=lambda: None, say=lambda _: None) -> None:
    zips = [out / name for name in NAMES]
    with places.replacing(zips, places.looked_at(zips, others), others, say) as folder:
        for name in NAMES[:2]:
            (folder / name).write_bytes(zipped(text))
        meanwhile()


def files(out: Path) -> dict[str, bytes]:
    return {p.name: p.read_bytes() for p in out.iterdir()}


def standing(text: str) -> dict[str, bytes]:
    return {name: zipped(text) for name in NAMES[:2]}


@pytest.fixture
def out(tmp_path) -> Path:
    """With an earlier release."""
    for name in NAMES:
        (tmp_path / name).write_bytes(zipped("old"))
    return tmp_path


def add(path: Path) -> None:
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("quot\x1bation.pdf", "signed")


def forge(path: Path) -> None:
    """A file put in as tactcad would, with its digest in the manifest; the seal is that of before."""
    path.write_bytes(zipped("old", quotation=b"signed")[:-64] + path.read_bytes()[-64:])


def replace(path: Path) -> None:
    path.unlink()
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("thesis.txt", "ten years")


MEDDLINGS = {
    add: r"(changed: 'quot\x1bation.pdf')",
    forge: "(changed)",
    replace: "(without tactcad's seal: 'thesis.txt')",
    lambda path: path.write_bytes(path.read_bytes() + b"\n"): "(changed)",
    lambda path: path.write_text(""): "(without tactcad's seal)",
    lambda path: path.chmod(0o444): "(write-protected)",
}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("meddle", MEDDLINGS)
def test_what_is_not_as_written_is_refused_kept_or_discarded(out, name, meddle):
    meddle(out / name)
    before, lines = files(out), []
    with pytest.raises(InputError, match="nothing was changed; legal: --keep.*--discard") as refusal:
        publish(out, "new")
    assert f"{name} {MEDDLINGS[meddle]}" in str(refusal.value)
    assert files(out) == before
    publish(out, "new", "keep", say=lines.append)
    assert files(out) == standing("new") | {KEPT[name]: before[name]} and KEPT[name] in lines[0]
    (out / KEPT[name]).replace(out / name)
    publish(out, "newer", "discard", say=lines.append)
    assert files(out) == standing("newer") and "discarded" in lines[1] and len(lines) == 2


@pytest.mark.parametrize("others", WAYS)
@pytest.mark.parametrize("make", [lambda p: p.symlink_to(NAMES[0]), Path.mkdir, os.mkfifo])
def test_what_is_no_file_is_never_replaced(out, others, make):
    (out / NAMES[1]).unlink()
    make(out / NAMES[1])
    with pytest.raises(InputError, match=r"sheet.zip \((a link|no file)\)"):
        publish(out, "new", others)
    assert {p.name for p in out.iterdir()} == {*NAMES} and (out / NAMES[0]).read_bytes() == zipped("old")


@pytest.mark.parametrize("others", WAYS)
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("make", [replace, lambda p: (p.unlink(), p.mkdir())])
def test_what_appears_meanwhile_is_kept_and_said(out, others, name, make):
    if others != "refuse":
        (out / name).write_text("there before")
    with pytest.raises(CheckFailure, match=f"new zips are in place.*{KEPT[name]}"):
        publish(out, "new", others, lambda: make(out / name))
    assert make is not replace or zipfile.ZipFile(out / KEPT[name]).namelist() == ["thesis.txt"]
    assert {p.name for p in out.iterdir()} == {*NAMES[:2], KEPT[name]}
    assert {n: (out / n).read_bytes() for n in NAMES[:2]} == standing("new")


def test_nothing_is_unpacked_and_little_is_read(out, monkeypatch):
    """64 MB of zeros under the name of the manifest, and 30,000 names of 200 letters."""
    with zipfile.ZipFile(out / NAMES[0], "w", zipfile.ZIP_DEFLATED) as archive:
        for n in range(30_000):
            archive.writestr(zipfile.ZipInfo(f"{n:0200}"), b"")
        archive.writestr(MANIFEST, bytes(64_000_000))
        archive.comment = SEAL + b"0" * 64
    monkeypatch.setattr(zipfile.ZipFile, "open", lambda *_: pytest.fail("unpacked"))
    tracemalloc.start()
    with pytest.raises(InputError, match=r"a-A.zip \(changed"):
        places.looked_at([out / NAMES[0]], "refuse")
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 8_000_000


def killed(out: Path, fatal: int) -> bool:
    """Publishes in a fork that dies before its n-th file operation; whether it died."""
    if process := os.fork():
        return os.waitpid(process, 0)[1] == signal.SIGKILL
    seen = []

    def count(event: str, _args: tuple) -> None:
        if event in CHANGES:
            seen.append(event)
            if len(seen) == fatal:
                os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(count)
    try:
        publish(out, "new", "keep")
    finally:
        os._exit(0)


def test_killed_before_every_file_operation(out):
    """Each place always has one of both, the quotation is never gone, the next run leaves nothing of ours."""
    (out / NAMES[0]).chmod(0o640)
    for fatal in range(1, 200):
        publish(out, "old")
        add(out / NAMES[1])
        quoted = (out / NAMES[1]).read_bytes()
        died = killed(out, fatal)
        there = {p.name: p.read_bytes() for p in out.glob("a-*")}
        assert there[NAMES[0]] in (zipped("old"), zipped("new"))
        assert there[NAMES[1]] in (quoted, zipped("new")) and quoted in there.values()
        publish(out, "newer", "keep")
        kept = {p.name: p.read_bytes() for p in out.glob("*-kept-*")}
        assert set(kept.values()) == {quoted} and files(out) == standing("newer") | kept
        for name in kept:
            (out / name).unlink()
        if not died:
            break
    assert fatal > 15 and not died and (out / NAMES[0]).stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize("folder", [".", "made/deep"])
def test_a_full_disk_leaves_no_folder(tmp_path, folder):
    """The limit on a file's size stands for the disk's."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, hard))
    try:
        with pytest.raises(CheckFailure, match="nothing was changed"):
            publish(tmp_path / folder, "new")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert list(tmp_path.iterdir()) == []


def test_two_designs_of_one_name_and_a_folder_that_is_no_folder_are_refused_before_any_work(tmp_path, capsys):
    for folder in "AB":
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "tiny.toml").write_text(TINY_TEXT)
    (tmp_path / "gone").symlink_to(tmp_path / "nowhere")
    a, b = (str(tmp_path / folder / "tiny.toml") for folder in "AB")
    for words, said in (
        ([a, b, "--out", str(tmp_path / "out")], "has the name and revision of"),
        ([a, "--out", str(tmp_path / "gone")], "gone: is a link"),
    ):
        assert main(["release", *words, "--sample"]) == 2
        assert said in capsys.readouterr().err
    assert sorted(p.name for p in tmp_path.iterdir()) == ["A", "B", "gone"]
