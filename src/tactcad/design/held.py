"""Unfinished files and folders, held by the process that makes them; the next run removes those of killed
runs.

Whoever makes one holds a lock (flock) on it, which ends with the process, however that ends. A file or folder
is a killed run's if its name has our form, nobody holds its lock and, for folders, our mark is in it.
"""

from __future__ import annotations

import fcntl
import os
import re
import shutil
import stat
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from tactcad.ending import unfinished

MARK = "written-by-tactcad"  # in every folder of ours; holds the process's number
OWN = ".tactcad-"  # in every name of ours, before eight characters drawn by chance
MAKING = "making"  # in a folder of ours: content that is useless until it is finished
DRAWN = "[a-z0-9_]{8}"  # as tempfile draws them

Settle = Callable[[Path], None]


def _nothing(_folder: Path) -> None:
    pass


@contextmanager
def held_folder(
    parent: Path, stem: str, settle: Settle = _nothing, clear: Settle = _nothing
) -> Iterator[Path]:
    """A folder `parent/STEM.tactcad-XXXXXXXX` of this process alone, removed when the block ends.

    Parameters
    ----------
    parent, stem
        Where it stands, and how its name begins.
    settle
        Called with the folder before its removal, to save what is not ours to remove.
    clear
        Called instead when a signal ends the program; if it leaves more than MAKING, the next run settles the
        folder.
    """
    while True:
        folder = Path(tempfile.mkdtemp(prefix=stem + OWN, dir=parent))
        try:
            handle = os.open(folder / MARK, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
        except FileNotFoundError:
            continue  # another process took the folder, not marked yet, for a killed run's
        except BaseException:
            folder.rmdir()
            raise
        if _take(handle) is not False and (folder / MARK).exists():
            break
        os.close(handle)
    with unfinished(lambda: _put_away(folder, settle, clear)):
        try:
            with suppress(OSError):  # a full disk: the number is for messages only
                os.write(handle, f"{os.getpid()}".encode())
            yield folder
        finally:
            with suppress(OSError):  # the next run sweeps
                _remove(folder, settle)
            os.close(handle)


def _put_away(folder: Path, settle: Settle, clear: Settle) -> None:
    clear(folder)
    if settle is _nothing or set(os.listdir(folder)) <= {MARK, MAKING}:
        _remove(folder, _nothing)


def sweep_folders(parent: Path, stem: str, settle: Settle = _nothing) -> tuple[str, ...]:
    """Remove what killed runs of `held_folder` left.

    Parameters
    ----------
    parent, stem, settle
        As for `held_folder`.

    Returns
    -------
    tuple of str
        Numbers of the processes that hold folders there now.
    """
    holders = []
    for folder in _of_our_form(parent, stem, ""):
        if folder.is_symlink() or not folder.is_dir():
            continue
        try:
            handle = os.open(folder / MARK, os.O_RDWR | os.O_NOFOLLOW | os.O_NONBLOCK)
        except FileNotFoundError:
            with suppress(OSError):  # killed before it could be marked: empty, or somebody else's
                folder.rmdir()
            continue
        except OSError:
            continue  # another user's
        try:
            if not stat.S_ISREG(os.fstat(handle).st_mode):
                continue
            free = _take(handle)
            if free:
                _remove(folder, settle)
            elif free is False:
                holders.append(os.pread(handle, 20, 0).decode("ascii", "replace") or "unknown")
        finally:
            os.close(handle)
    return tuple(holders)


@contextmanager
def held_file(place: Path) -> Iterator[Path]:
    """A file beside `place` for this process to write, gone when the block ends unless it was renamed.

    What killed runs left there of the same `place` goes first.
    """
    stem = f".{place.name[:100]}"
    for left in _of_our_form(place.parent, stem, ".part"):
        with suppress(OSError):  # another user's, or another process was faster
            _remove_if_left(left)
    while True:
        handle, name = tempfile.mkstemp(prefix=stem + OWN, suffix=".part", dir=place.parent)
        part = Path(name)
        if _take(handle) is not False and part.exists():
            break
        os.close(handle)  # another process took it for a killed run's
    with unfinished(lambda: part.unlink(missing_ok=True)):
        try:
            yield part
        finally:
            part.unlink(missing_ok=True)
            os.close(handle)


def _of_our_form(parent: Path, stem: str, suffix: str) -> list[Path]:
    form = re.compile(re.escape(stem + OWN) + DRAWN + re.escape(suffix))
    return [parent / name for name in sorted(os.listdir(parent)) if form.fullmatch(name)]


def _remove_if_left(part: Path) -> None:
    handle = os.open(part, os.O_RDWR | os.O_NOFOLLOW | os.O_NONBLOCK)
    try:
        if stat.S_ISREG(os.fstat(handle).st_mode) and _take(handle):
            part.unlink()
    finally:
        os.close(handle)


def _take(handle: int) -> bool | None:
    """Whether this process now holds the lock; None where the file system has no locks."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return None
    return True


def _remove(folder: Path, settle: Settle) -> None:
    """Remove the folder, its mark last, so that a half-removed one is still recognised as ours."""
    settle(folder)
    for path in folder.iterdir():
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        elif path.name != MARK:
            path.unlink()
    (folder / MARK).unlink()
    folder.rmdir()
