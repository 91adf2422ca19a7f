"""Files and folders that are being written, under names of our form; the next run removes those of killed
runs.

The writer holds a lock (flock) on it until its process ends in any way. A file or folder is left from a
killed run if its name has our form, nobody holds its lock and, for folders, our mark is in it.
"""

from __future__ import annotations

import fcntl
import os
import re
import shutil
import stat
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from tactcad.shutdown import no_signals, unfinished

MARK = "written-by-tactcad"  # in every folder of ours, and locked
OWN = ".tactcad-"  # in every name of ours, before eight characters drawn by chance
MAKING = "making"  # in a folder of ours: content that is useless until it is finished
DRAWN = "[a-z0-9_]{8}"  # as tempfile draws them

Settle = Callable[[Path], None]


@contextmanager
def staged_folder(parent: Path, stem: str, settle: Settle = lambda _: None) -> Iterator[Path]:
    """A folder `parent/STEM.tactcad-XXXXXXXX` of this process alone, removed when the block ends.

    What killed runs left there of the same stem is removed first.

    Parameters
    ----------
    parent, stem
        Its folder, and the beginning of its name.
    settle
        Called with each of these folders before its removal, to save the user's files.
    """

    def removed(folder: Path) -> None:
        with suppress(OSError):  # another user's, or a killed run's helper still writes: the next run's
            settle(folder)
            # Remove the folder, its mark last, so that a half-removed one is still recognised as ours.
            for path in folder.iterdir():
                if path.is_dir() and not path.is_symlink():
                    shutil.rmtree(path)
                elif path.name != MARK:
                    path.unlink()
            (folder / MARK).unlink()
            folder.rmdir()

    for left in _of_our_form(parent, stem, ""):
        if left.is_dir() and not left.is_symlink():
            with suppress(OSError), _lock_of(left / MARK) as ours:
                if ours:
                    removed(left)
            with suppress(OSError):  # killed before it could be marked: empty, or somebody else's
                left.rmdir()
    with ExitStack() as known:
        with no_signals():  # until the leftovers are known
            folder, lock = _new_folder(parent, stem)
            known.enter_context(unfinished(lambda: removed(folder)))
        try:
            yield folder
        finally:
            removed(folder)
            os.close(lock)


def _new_folder(parent: Path, stem: str) -> tuple[Path, int]:
    """The folder, and its lock."""
    while True:
        folder = Path(tempfile.mkdtemp(prefix=stem + OWN, dir=parent))
        try:
            lock = os.open(folder / MARK, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
        except FileNotFoundError:
            continue  # another process took the folder, not marked yet, for a killed run's
        except BaseException:
            folder.rmdir()
            raise
        if _take(lock) is not False and (folder / MARK).exists():
            return folder, lock
        os.close(lock)


@contextmanager
def staged_file(place: Path) -> Iterator[Path]:
    """A file in `place`'s folder for this process to write, removed when the block ends unless it was
    renamed.

    What killed runs left there of the same `place` goes first.
    """
    stem = f".{place.name[:100]}"
    for left in _of_our_form(place.parent, stem, ".part"):
        remove_left(left)
    with ExitStack() as known:
        with no_signals():  # until the leftovers are known
            while True:
                lock, name = tempfile.mkstemp(prefix=stem + OWN, suffix=".part", dir=place.parent)
                part = Path(name)
                if _take(lock) is not False and part.exists():
                    break
                os.close(lock)  # another process took it for a killed run's
            known.enter_context(unfinished(lambda: part.unlink(missing_ok=True)))
        try:
            yield part
        finally:
            part.unlink(missing_ok=True)
            os.close(lock)


def remove_left(part: Path) -> None:
    """Remove an unfinished file unless a running process writes it."""
    with suppress(OSError), _lock_of(part) as ours:  # another user's, or another process was faster
        if ours:
            part.unlink()


def _of_our_form(parent: Path, stem: str, suffix: str) -> list[Path]:
    form = re.compile(re.escape(stem + OWN) + DRAWN + re.escape(suffix))
    return [parent / name for name in sorted(os.listdir(parent)) if form.fullmatch(name)]


@contextmanager
def _lock_of(path: Path) -> Iterator[bool]:
    """Whether this process now holds the lock of a regular file."""
    handle = os.open(path, os.O_RDWR | os.O_NOFOLLOW | os.O_NONBLOCK)
    try:
        yield stat.S_ISREG(os.fstat(handle).st_mode) and _take(handle) is True
    finally:
        os.close(handle)


def _take(handle: int) -> bool | None:
    """Whether this process now holds the lock; None if the file system has no locks."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return None
    return True
