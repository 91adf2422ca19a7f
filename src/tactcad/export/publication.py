"""All or nothing: a folder of files appears under its name in one step, finished, or not at all.

DIR is an ordinary folder, which may be renamed, copied and archived. While it is being written there are

    exports/macro-array                              the earlier one, whole
    exports/.macro-array.tactcad-k3x0a9_2/           ours by its mark, locked by the process that writes
        written-by-tactcad                           the mark
        making/                                      being written; named finished/ when it is

Then `finished` and DIR exchange names in one step (Linux's renameat2), and the earlier folder is examined
once more: unless it is exactly as tactcad wrote it, it is kept as DIR-kept-1 and not removed unasked. The
next run does the same with the folder of a killed one. If the system or the file system cannot exchange, DIR
is moved to `earlier` first; a kill between these two renames leaves no DIR until the next run puts it back.
Of two runs that write DIR at once the later one stays, whole.
"""

from __future__ import annotations

import errno
import os
import stat
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count
from pathlib import Path

from tactcad.design.files import absolute, flush_entry, in_one_line
from tactcad.design.messages import CheckFailure, InputError
from tactcad.design.staging import MAKING, OWN, staged_folder

from .contents import NAME, NOTHING, Contents, contents, remove, sealed, sha256_of

SHOWN = 5  # names in a message
REFUSE, KEEP, DISCARD = "refuse", "keep", "discard"  # what to do with files that are not ours
LEGAL = "a new name, an empty folder, or an unchanged one that tactcad wrote"
FINISHED, EARLIER = "finished", "earlier"
AT_FDCWD, EXCHANGE = -100, 2
MEANWHILE = (errno.ENOENT, errno.EEXIST, errno.ENOTEMPTY)  # DIR appeared or disappeared

Say = Callable[[str], None]


def _print(text: str) -> None:
    print(text, file=sys.stderr)


def looked_at(directory: str | Path, schema: str, others: str = REFUSE) -> Contents:
    """The present contents of DIR; changes nothing.

    Raises InputError if DIR is not a place for a folder, or holds what tactcad did not write there and
    `others` is REFUSE.
    """
    out = absolute(directory)
    with in_one_line(out):
        if not out.name:
            raise InputError(str(out), "cannot be replaced", legal=LEGAL)
        if out.is_symlink():
            raise InputError(str(out), "is a link", legal=f"the folder that it leads to, or {LEGAL}")
        if os.path.lexists(out) and not out.is_dir():
            raise InputError(str(out), "is a file", legal=LEGAL)
        if os.path.ismount(out):
            raise InputError(str(out), "is a mount point, which cannot be replaced", legal=LEGAL)
        for folder in Path(os.path.realpath(out)).parents:
            manifest = folder / NAME
            if manifest.is_file() and b'"schema": "tactcad-' in manifest.read_bytes()[:40]:
                raise InputError(str(out), f"lies inside {folder}, which tactcad wrote", legal=LEGAL)
        seen = _contents_of_one(out, schema)
    if seen.foreign and others == REFUSE:
        raise InputError(
            str(directory),
            f"holds what is not as tactcad wrote it: {named(seen.foreign)}; nothing was changed",
            legal="--keep, which moves the folder aside, --discard, which removes it, or another folder",
        )
    return seen


def _contents_of_one(out: Path, schema: str) -> Contents:
    """The contents of DIR; read again if another run put its folder there meanwhile, so that one's files are
    never compared with the other's manifest.
    """
    while True:
        before = _which(out)
        try:
            seen = contents(out, schema)
        except OSError:
            if _which(out) == before:
                raise
        else:
            if _which(out) == before:
                return seen


def _which(out: Path) -> tuple[int, int] | None:
    """The folder's identity: a number, which a later one may have again, and when it was last renamed."""
    try:
        found = os.lstat(out)
    except FileNotFoundError:
        return None
    return found.st_ino, found.st_ctime_ns


def named(foreign: Mapping[str, str]) -> str:
    names = [f"{path if path != '.' else 'the folder'} ({why})" for path, why in foreign.items()]
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return ", ".join(names[:SHOWN]) + more


def left_unfinished(directory: str | Path) -> bool:
    """Whether another run writes DIR, or was killed when it did."""
    out = absolute(directory)
    return any(name.startswith(f".{out.name}{OWN}") for name in os.listdir(out.parent))


@dataclass(frozen=True)
class Work:
    """DIR while it is replaced: `folder` to write into; `earlier` is what lay in DIR before."""

    out: Path
    schema: str
    others: str
    say: Say
    own: Path
    earlier: Contents

    @property
    def folder(self) -> Path:
        return self.own / MAKING

    def write(self, files: Mapping[str, bytes]) -> None:
        """Write the files and a manifest of them, and publish them."""
        for path, data in files.items():
            (self.folder / path).parent.mkdir(parents=True, exist_ok=True)
            (self.folder / path).write_bytes(data)
        listed = [{"path": path, "sha256": sha256_of(data)} for path, data in files.items()]
        (self.folder / NAME).write_bytes(sealed({"schema": self.schema, "files": listed}))
        self.publish()

    def publish(self) -> None:
        """Make `folder`, with its manifest, the new DIR; the earlier one is removed, or kept under another
        name.

        Raises CheckFailure if something appeared in the earlier one meanwhile: it is kept.
        """
        if self.out.is_dir():
            self.folder.chmod(stat.S_IMODE(self.out.stat().st_mode) | 0o700)
        flush(self.folder)
        earlier = _put_in_place(self.folder.rename(self.own / FINISHED), self.out, self.own / EARLIER)
        flush_entry(self.out.parent)
        if earlier:
            self.settle(earlier)

    def settle(self, folder: Path) -> None:
        """Remove an earlier DIR; or keep it under another name, if asked, or if it has contents that appeared
        after the work began."""
        seen = contents(folder, self.schema)
        if self.others != KEEP or not self.earlier.foreign:
            if not seen.changed_since(self.earlier) and remove(folder, seen):
                return
            seen = contents(folder, self.schema)
        new = {path: seen.foreign[path] for path in seen.changed_since(self.earlier)}
        kept = free_name(self.out)
        os.rename(folder, kept)
        if new:
            what = "what appeared in the earlier one meanwhile is kept as"
            raise CheckFailure(f"{self.out}: the new folder is in place; {what} {kept} for {named(new)}")
        why = named(seen.foreign) or "what could not be removed"
        self.say(f"{self.out}: the earlier folder is kept as {kept} for {why}")


@contextmanager
def replacing(directory: str | Path, schema: str, others: str = REFUSE, say: Say = _print) -> Iterator[Work]:
    """Write a folder anew; what killed runs left is settled first.

    If anything is raised inside, the earlier folder stays.

    Parameters
    ----------
    directory
        The folder, DIR.
    schema
        Of the manifest that it has, or will have.
    others
        What to do with files in it that tactcad did not write: refuse, keep or discard.
    say
        Receives lines worth keeping, such as what was kept.

    Yields
    ------
    Work
        A folder to write into, and what lay in DIR before.

    Raises
    ------
    InputError
        If DIR may not be replaced (see `looked_at`), or the place cannot be written to.
    CheckFailure
        If the disk is full, or if, after publication of the new DIR, something had appeared in the earlier
        one and was kept.
    """
    out = absolute(directory)

    def recover(left: Path) -> None:
        """Recover from a killed run: put DIR back if it is missing, settle the other folders."""
        if os.path.lexists(left / EARLIER) and not os.path.lexists(out):
            os.rename(left / EARLIER, out)
        for name in (FINISHED, EARLIER):
            if os.path.lexists(left / name):
                try:
                    Work(out, schema, REFUSE, say, left, NOTHING).settle(left / name)
                except CheckFailure as kept:
                    say(str(kept))

    with in_one_line(out):
        looked_at(out, schema, others)
        out.parent.mkdir(parents=True, exist_ok=True)
        with staged_folder(out.parent, f".{out.name}", recover) as own:
            work = Work(out, schema, others, say, own, looked_at(out, schema, others))
            if work.earlier.foreign and others == DISCARD:
                say(f"{out}: to be discarded: {named(work.earlier.foreign)}")
            work.folder.mkdir()
            yield work


def _put_in_place(finished: Path, out: Path, aside: Path) -> Path | None:
    """Make `finished` the new DIR; returns the earlier DIR's new place, None if there was none."""
    while True:
        try:
            if not os.path.lexists(out):
                os.rename(finished, out)
                return None
            if _exchange(finished, out):
                return finished
            os.rename(out, aside)
            os.rename(finished, out)
            return aside
        except OSError as error:
            if error.errno not in MEANWHILE or not finished.exists() or aside.exists():
                raise


def free_name(path: Path, ending: str = "") -> Path:
    """The first name PATH-kept-N that is free."""
    names = (path.with_name(f"{path.name.removesuffix(ending)}-kept-{n}{ending}") for n in count(1))
    return next(name for name in names if not os.path.lexists(name))


def _exchange(one: Path, other: Path) -> bool:
    """Exchange two names in one step; False if the system or its file system cannot."""
    import ctypes  # not needed by an export without changes

    renameat2 = getattr(ctypes.CDLL(None, use_errno=True), "renameat2", None)
    if renameat2 is None:
        return False
    if renameat2(AT_FDCWD, os.fsencode(one), AT_FDCWD, os.fsencode(other), EXCHANGE) == 0:
        return True
    number = ctypes.get_errno()
    if number in (errno.ENOSYS, errno.EINVAL, errno.ENOTSUP):
        return False
    raise OSError(number, os.strerror(number), str(one), None, str(other))


def flush(folder: Path) -> None:
    """Write everything in the folder to the disk, before its name."""
    for base, _, names in os.walk(folder):
        for name in names:
            flush_entry(Path(base, name))
        flush_entry(Path(base))
