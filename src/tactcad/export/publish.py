"""All or nothing: a folder of files appears under its name in one step, finished, or not at all.

DIR is a relative link into a hidden sibling folder of numbered builds:

    exports/macro-array -> .macro-array.builds/7
    exports/.macro-array.builds/6            the build before, for readers that still have it open
    exports/.macro-array.builds/8.part       being written (or left by a run that was killed)
    exports/.macro-array.lock                who writes; the lock goes with its process, however that ends

The switch is the rename of a new link over the old one, which the file system does at once. Builds
are numbered, not dated, so that a clock set back changes nothing.
"""

from __future__ import annotations

import fcntl
import os
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from tactcad.design.files import absolute, refusal
from tactcad.design.messages import CheckFailure, InputError

WAIT_SECONDS = 600.0  # a cold export of the largest design takes a fraction of this
POLL_SECONDS = 0.1


@dataclass(frozen=True)
class Published:
    """Where a finished folder is, or will be, published: DIR and its hidden siblings."""

    link: Path  # absolute

    @property
    def builds(self) -> Path:
        return self.link.with_name(f".{self.link.name}.builds")

    @property
    def lock(self) -> Path:
        return self.link.with_name(f".{self.link.name}.lock")

    @property
    def current(self) -> Path | None:
        """The folder that DIR stands for now, None where there is none. It is never written to again."""
        number = self._linked_number()
        build = self.builds / str(number)
        return build if number is not None and build.is_dir() else None

    def _linked_number(self) -> int | None:
        """The number of the build that DIR links to; None where DIR is no link of ours."""
        try:
            folder, _, number = os.readlink(self.link).rpartition("/")
        except OSError:
            return None
        return int(number) if folder == self.builds.name and number.isdecimal() else None

    def refuse_foreign(self) -> None:
        """Raises InputError where DIR holds anything that was not put there by an export, or lies in one."""
        for folder in Path(os.path.realpath(self.link.parent)).parts:
            if folder.startswith(".") and folder.endswith(".builds"):
                raise InputError(str(self.link), "lies inside an earlier export", legal=LEGAL)
        if self.link.is_symlink():
            if self._linked_number() is None:
                raise InputError(str(self.link), "is a link to somewhere else", legal=LEGAL)
        elif self.link.is_dir():
            if any(self.link.iterdir()):
                raise InputError(str(self.link), "is a folder with other files in it", legal=LEGAL)
        elif self.link.exists():
            raise InputError(str(self.link), "is a file", legal=LEGAL)


LEGAL = "a new name, an empty folder, or the folder of an earlier export"


def published(directory: str | os.PathLike[str]) -> Published:
    """Where `directory` would be published; touches nothing. Raises InputError where it has no name."""
    link = absolute(directory)
    if not link.name:
        raise InputError(str(directory), "cannot be replaced", legal=LEGAL)
    return Published(link)


@contextmanager
def locked(
    directory: str | os.PathLike[str],
    wait: float = WAIT_SECONDS,
    say: Callable[[str], None] = lambda text: print(text, file=sys.stderr),
) -> Iterator[Published]:
    """Be the only one who writes `directory`; what killed runs left behind is swept first.

    Waits up to `wait` seconds for another export, and says so once. Raises InputError where
    `directory` is not ours to replace or the place cannot be written to, CheckFailure where the wait was in
    vain. Whatever is raised inside, the earlier export stands.
    """
    place = published(directory)
    with in_one_line(place.link):
        place.refuse_foreign()
        place.link.parent.mkdir(parents=True, exist_ok=True)
        handle = os.open(place.lock, os.O_RDWR | os.O_CREAT, 0o666)
    try:
        with in_one_line(place.link):
            take_lock(handle, place.link, wait, say)
            place.refuse_foreign()  # it may have changed while we waited
            _sweep(place)
        yield place
    finally:
        os.close(handle)


@contextmanager
def new_build(place: Published) -> Iterator[Path]:
    """A fresh folder to write into, published when the block ends well and gone when it does not.

    Only inside `locked`. Raises InputError where the machine refuses to write, CheckFailure where the disk is full.
    """
    with in_one_line(place.link):
        place.builds.mkdir(exist_ok=True)
        number = 1 + max((n for n in map(_number, place.builds.iterdir()) if n is not None), default=0)
        part, build = place.builds / f"{number}.part", place.builds / str(number)
        part.mkdir()
        before = place.current
        try:
            yield part
            _flush(part)
            part.rename(build)
            flush_entry(place.builds)
            _switch(place, number)
        except BaseException:
            shutil.rmtree(part, ignore_errors=True)
            if place.current != build:
                shutil.rmtree(build, ignore_errors=True)
            raise
    with suppress(OSError):  # the new build stands already; the next run sweeps what is left
        _remove_builds(place, keep={build, before})


def _switch(place: Published, number: int) -> None:
    """Let DIR mean the build of that number, in one step."""
    temporary = place.builds / "link.part"
    temporary.unlink(missing_ok=True)
    temporary.symlink_to(f"{place.builds.name}/{number}")
    if not place.link.is_symlink() and place.link.is_dir():
        place.link.rmdir()  # empty: a link cannot be renamed over a folder
    temporary.rename(place.link)
    flush_entry(place.link.parent)


def take_lock(handle: int, target: Path, wait: float, say: Callable[[str], None]) -> None:
    """Take the lock, or wait for whoever has it."""
    until = time.monotonic() + wait
    said = False
    while True:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            break
        except BlockingIOError:
            holder = os.pread(handle, 100, 0).decode("ascii", "replace").strip() or "unknown"
            if time.monotonic() > until:
                raise CheckFailure(
                    f"{target}: another export (process {holder}) has been writing it for "
                    f"{wait:.0f} s; nothing was changed"
                ) from None
            if not said:
                say(f"{target}: waiting for another export (process {holder}) to finish")
                said = True
            time.sleep(POLL_SECONDS)
    with suppress(OSError):  # a full disk: the number is for the message only
        os.ftruncate(handle, 0)
        os.pwrite(handle, f"{os.getpid()}\n".encode(), 0)


def _sweep(place: Published) -> None:
    """Remove what killed runs left: all but the build that DIR links to and the last one before it."""
    if not place.builds.is_dir():
        return
    current = place.current
    keep = {current}
    if current:
        older = [n for n in map(_number, place.builds.iterdir()) if n is not None and n < int(current.name)]
        keep |= {place.builds / str(max(older))} if older else set()
    _remove_builds(place, keep)


def _remove_builds(place: Published, keep: set[Path | None]) -> None:
    for path in place.builds.iterdir():
        if path in keep:
            continue
        if path.is_symlink() or not path.is_dir():
            path.unlink()
            continue
        doomed = path.with_suffix(".part")  # half removed, it must not pass for a build
        if path != doomed:
            path.rename(doomed)
        shutil.rmtree(doomed)


def _number(path: Path) -> int | None:
    """Number of a finished or unfinished build, None for anything else."""
    stem = path.name.removesuffix(".part")
    return int(stem) if stem.isdecimal() else None


def _flush(folder: Path) -> None:
    """Everything in the folder is on the disk before its name is."""
    for base, _, names in os.walk(folder):
        for name in names:
            flush_entry(Path(base, name))
        flush_entry(Path(base))


def flush_entry(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


@contextmanager
def in_one_line(target: Path) -> Iterator[None]:
    """Turn the machine's refusals to write `target` into the one-line messages of the house."""
    try:
        yield
    except OSError as error:
        raise refusal(str(target), error) from error
