"""All or nothing: a folder of files appears under its name in one step, finished, or not at all.

DIR is an ordinary folder, which may be renamed, copied and archived. While it is being written there are

    exports/macro-array                              the earlier one, whole
    exports/.macro-array.tactcad-k3x0a9_2/           ours by its mark, held by the process that writes
        written-by-tactcad                           the mark
        making/                                      being written; named finished/ when it is

Then `finished` and DIR exchange names in one step (Linux's renameat2), and the earlier folder is examined
once more: unless it is exactly what tactcad wrote, it is kept beside as DIR-kept-1 and not removed unasked.
The next run does the same with the folder of a killed one. Where the system or the file system cannot
exchange, DIR is moved to `earlier` first; a kill between these two renames leaves no DIR until the next run
puts it back.
"""

from __future__ import annotations

import errno
import fcntl
import os
import stat
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path

from tactcad.design.files import absolute, flush_entry, in_one_line
from tactcad.design.held import MAKING, OWN, Settle, held_folder, sweep_folders
from tactcad.design.messages import CheckFailure, InputError

from .contents import NAME, NOTHING, Contents, contents, remove, sealed, sha256_of

WAIT_SECONDS = 600.0  # a cold export of the largest design takes a fraction of this
POLL_SECONDS = 0.1
SHOWN = 5  # names in a message
REFUSE, KEEP, DISCARD = "refuse", "keep", "discard"  # what to do with files that are not ours
LEGAL = "a new name, an empty folder, or one that tactcad wrote and nobody changed"
FINISHED = "finished"
AT_FDCWD, NOREPLACE, EXCHANGE = -100, 1, 2

Say = Callable[[str], None]


def _print(text: str) -> None:
    print(text, file=sys.stderr)


def looked_at(directory: str | Path, schema: str, others: str = REFUSE) -> Contents:
    """What lies in DIR now; changes nothing.

    Raises InputError where DIR is not a place for a folder, or holds what tactcad did not write there and
    `others` is REFUSE.
    """
    out = absolute(directory)
    with in_one_line(out):
        _refuse_place(out)
        seen = contents(out, schema)
    if seen.foreign and others == REFUSE:
        raise InputError(
            str(directory),
            f"holds what is not as tactcad wrote it: {named(seen.foreign)}; nothing was changed",
            legal="--keep, which moves the folder beside, --discard, which removes it, or another folder",
        )
    return seen


def _refuse_place(out: Path) -> None:
    if not out.name:
        raise InputError(str(out), "cannot be replaced", legal=LEGAL)
    if out.is_symlink():
        if Path(os.readlink(out)).parent.name == f".{out.name}.builds":
            raise InputError(
                str(out),
                f"was written by an earlier tactcad, as a link to {os.readlink(out)}; nothing was changed",
                legal=f"move or remove it together with .{out.name}.builds, then export again",
            )
        raise InputError(str(out), "is a link", legal=f"the folder that it leads to, or {LEGAL}")
    if os.path.lexists(out) and not out.is_dir():
        raise InputError(str(out), "is a file", legal=LEGAL)
    if os.path.ismount(out):
        raise InputError(str(out), "is a mount point, which cannot be replaced", legal=LEGAL)
    for folder in Path(os.path.realpath(out)).parents:
        if _says_tactcad(folder / NAME):
            raise InputError(str(out), f"lies inside {folder}, which tactcad wrote", legal=LEGAL)


def _says_tactcad(manifest: Path) -> bool:
    if not manifest.is_file():
        return False
    with manifest.open("rb") as file:
        return b'"schema": "tactcad-' in file.read(40)


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
    """One process's turn at DIR: `folder` to write into; `earlier` is what lay in DIR when the turn began."""

    out: Path
    schema: str
    others: str
    say: Say
    own: Path
    earlier: Contents
    kept: list[str] = field(default_factory=list)  # a line for each folder kept although nobody asked

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
        """Make `folder`, with its manifest, the new DIR; the earlier one is removed, or kept beside."""
        if self.out.is_dir():
            self.folder.chmod(stat.S_IMODE(self.out.stat().st_mode) | 0o700)
        flush(self.folder)
        finished = self.folder.rename(self.own / FINISHED)
        earlier = _put_in_place(finished, self.out, self.own / "earlier")
        flush_entry(self.out.parent)
        if earlier:
            self.settle(earlier)

    def settle(self, folder: Path) -> None:
        """Remove an earlier DIR, or keep it beside."""
        seen = contents(folder, self.schema)
        if self.others != KEEP or not self.earlier.foreign:
            if not seen.changed_since(self.earlier) and remove(folder, seen):
                return
            seen = contents(folder, self.schema)
        new = {path: seen.foreign[path] for path in seen.changed_since(self.earlier)}
        kept = _kept_beside(folder, self.out)
        if new:
            self.kept.append(f"kept as {kept} for {named(new)}")
        else:
            self.say(
                f"{self.out}: the earlier folder is kept as {kept} for "
                f"{named(seen.foreign) or 'what could not be removed'}"
            )


@contextmanager
def turn(
    directory: str | Path, schema: str, others: str = REFUSE, say: Say = _print, wait: float = WAIT_SECONDS
) -> Iterator[Work]:
    """Hold the exclusive right to write a folder; first settles what killed runs left.

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
        Receives lines worth keeping, such as that another process is waited for.
    wait
        How long to wait for another process, s.

    Yields
    ------
    Work
        A folder to write into, and what lay in DIR when the turn began.

    Raises
    ------
    InputError
        Where DIR is not ours to replace (see `looked_at`), or the place cannot be written to.
    CheckFailure
        Where the wait was in vain, the disk is full, or, after the new DIR stands, where something in the
        earlier one appeared meanwhile and was kept.
    """
    out = absolute(directory)
    kept: list[str] = []

    def settle(left: Path) -> None:
        _recover(left, out, schema, kept)

    def clear(own: Path) -> None:
        seen = contents(own / FINISHED, schema)  # the new folder, or the earlier one exchanged for it
        if seen.states and not seen.foreign:
            remove(own / FINISHED, seen)

    with in_one_line(out):
        looked_at(out, schema, others)
        out.parent.mkdir(parents=True, exist_ok=True)
        try:
            with ExitStack() as stack:
                own = _own_folder(out, settle, clear, stack, say, time.monotonic() + wait)
                work = Work(out, schema, others, say, own, looked_at(out, schema, others), kept)
                if work.earlier.foreign and others == DISCARD:
                    say(f"{out}: to be discarded: {named(work.earlier.foreign)}")
                work.folder.mkdir()
                yield work
        except BaseException:
            for line in kept:
                say(f"{out}: what appeared in the earlier folder meanwhile is {line}")
            raise
    if kept:
        raise CheckFailure(
            f"{out}: the new folder stands; what appeared in the earlier one meanwhile is {'; '.join(kept)}"
        )


def _own_folder(out: Path, settle: Settle, clear: Settle, stack: ExitStack, say: Say, until: float) -> Path:
    """Our unfinished folder beside DIR, once no other process has one."""
    said = False
    holders: tuple[str, ...] | None
    while True:
        parent = os.open(out.parent, os.O_RDONLY | os.O_DIRECTORY)
        try:  # one process at a time looks around; closing releases the lock
            fcntl.flock(parent, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holders = None
        except OSError:  # a file system without locks: the last one stays
            holders = ()
        else:
            holders = sweep_folders(out.parent, f".{out.name}", settle)
        try:
            if holders == ():
                return stack.enter_context(held_folder(out.parent, f".{out.name}", settle, clear))
        finally:
            os.close(parent)
        holder = f"process {holders[0]}" if holders else "which looks around"
        if time.monotonic() > until:
            raise CheckFailure(
                f"{out}: another run ({holder}) has been writing it all the time; nothing was changed"
            )
        if holders and not said:
            say(f"{out}: waiting for another export ({holder}) to finish")
            said = True
        time.sleep(POLL_SECONDS)


def _recover(left: Path, out: Path, schema: str, kept: list[str]) -> None:
    """Settle a killed run's folder: DIR is put back where it is missing, everything else as `Work` does."""
    if os.path.lexists(left / "earlier") and not os.path.lexists(out):
        os.rename(left / "earlier", out)
    work = Work(out, schema, REFUSE, _print, left, NOTHING, kept)
    for name in (FINISHED, "earlier"):
        if os.path.lexists(left / name):
            work.settle(left / name)


def _put_in_place(finished: Path, out: Path, aside: Path) -> Path | None:
    """Make `finished` the new DIR; returns where the earlier DIR is now, None where there was none."""
    while True:  # DIR may appear or disappear meanwhile
        try:
            if not os.path.lexists(out):
                move(finished, out)
                return None
            return finished if _rename(finished, out, EXCHANGE) else _moved_aside(finished, out, aside)
        except (FileExistsError, FileNotFoundError):
            if not os.path.lexists(finished):
                raise


def _moved_aside(finished: Path, out: Path, aside: Path) -> Path:
    os.rename(out, aside)
    try:
        os.rename(finished, out)
    except OSError:
        os.rename(aside, out)
        raise
    return aside


def _kept_beside(folder: Path, out: Path) -> Path:
    """Move the folder to the first name DIR-kept-N that is free."""
    for n in count(1):
        kept = out.with_name(f"{out.name}-kept-{n}")
        with suppress(FileExistsError):
            move(folder, kept)
            break
    return kept


def move(old: Path, new: Path) -> None:
    """Rename to a name that must be free. Raises FileExistsError."""
    if _rename(old, new, NOREPLACE):
        return
    if os.path.lexists(new):
        raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(new))
    os.rename(old, new)


def _rename(old: Path, new: Path, flag: int) -> bool:
    """Rename with that flag of renameat2; False where the system or its file system does not support it."""
    import ctypes  # not needed by an export without changes

    try:
        renameat2 = ctypes.CDLL(None, use_errno=True).renameat2
    except (AttributeError, OSError):
        return False
    if renameat2(AT_FDCWD, os.fsencode(old), AT_FDCWD, os.fsencode(new), flag) == 0:
        return True
    number = ctypes.get_errno()
    if number in (errno.ENOSYS, errno.EINVAL, errno.ENOTSUP):
        return False
    raise OSError(number, os.strerror(number), str(old), None, str(new))


def flush(folder: Path) -> None:
    """Write everything in the folder to the disk, before its name."""
    for base, _, names in os.walk(folder):
        for name in names:
            flush_entry(Path(base, name))
        flush_entry(Path(base))
