"""All or nothing: a folder of files appears under its name in one step, finished, or not at all.

While DIR is written anew there is `.DIR.tactcad-k3x0a9_2/` beside it (staging.py), with `making/`, which is
named `apart/` when it is finished. Then `apart` and DIR exchange names in one step (Linux's renameat2);
where that is not possible, DIR is moved to `apart` and `making` to DIR. The earlier folder, now `apart`, is
examined once more: unless it is exactly as tactcad wrote it, it is kept as DIR-kept-1. The next run does the
same with the `apart` of a killed one, and puts it back if there is no DIR.
"""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import count
from pathlib import Path

from tactcad.design.files import absolute, flush_entry, in_one_line
from tactcad.design.messages import CheckFailure, InputError
from tactcad.design.staging import MAKING, OWN, staged_folder

from .manifest import NAME, NOTHING, Contents, contents, remove, sealed, sha256_of

SHOWN = 5  # names in a message
REFUSE, KEEP, DISCARD = "refuse", "keep", "discard"  # what to do with files that are not ours
LEGAL = "a new name, an empty folder, or an unchanged one that tactcad wrote"
APART = "apart"  # beside MAKING: content that is looked through before it goes
AT_FDCWD, EXCHANGE = -100, 2

Say = Callable[[str], None]


def looked_at(directory: str | Path, schema: str, others: str = REFUSE) -> Contents:
    """The present contents of DIR; changes nothing.

    Raises InputError if DIR is not a place for a folder, or holds what tactcad did not write there and
    `others` is REFUSE.
    """
    out = absolute(directory)
    with in_one_line(out):
        manifests = [folder / NAME for folder in Path(os.path.realpath(out)).parents]
        ours = [m for m in manifests if m.is_file() and b'"schema": "tactcad-' in m.read_bytes()[:40]]
        faults = {
            "cannot be replaced": not out.name,
            "is a link": out.is_symlink(),
            "is a file": os.path.lexists(out) and not out.is_dir(),
            "is a mount point, which cannot be replaced": os.path.ismount(out),
            f"lies inside {ours[0].parent if ours else ''}, which tactcad wrote": bool(ours),
        }
        for fault in (what for what, found in faults.items() if found):
            raise InputError(str(out), fault, legal=LEGAL)
        seen = contents(out, schema)
    if seen.foreign and others == REFUSE:
        raise InputError(
            str(directory),
            f"holds what is not as tactcad wrote it: {named(seen.foreign)}; nothing was changed",
            legal="--keep, which moves the folder aside, --discard, which removes it, or another folder",
        )
    return seen


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
    """DIR while it is replaced: `folder` to write into, its manifest last; `earlier` is what lay in DIR."""

    schema: str
    folder: Path
    earlier: Contents

    def write(self, files: Mapping[str, bytes]) -> None:
        """Write the files and a manifest of them."""
        for path, data in files.items():
            (self.folder / path).parent.mkdir(parents=True, exist_ok=True)
            (self.folder / path).write_bytes(data)
        listed = [{"path": path, "sha256": sha256_of(data)} for path, data in files.items()]
        (self.folder / NAME).write_bytes(sealed({"schema": self.schema, "files": listed}))


def _print(text: str) -> None:
    print(text, file=sys.stderr)


@contextmanager
def replacing(directory: str | Path, schema: str, others: str = REFUSE, say: Say = _print) -> Iterator[Work]:
    """Write a folder, DIR, anew, and give it its name when the block ends well and has written a manifest;
    else the earlier folder stays. What killed runs left is settled first.

    Parameters
    ----------
    directory, schema
        The folder, and the schema of its manifest.
    others
        What to do with files in it that tactcad did not write: refuse, keep or discard.
    say
        Receives lines worth keeping, such as what was kept.

    Raises
    ------
    InputError
        If DIR may not be replaced (see `looked_at`), or the place cannot be written to.
    CheckFailure
        If the disk is full, or the earlier folder was kept, unasked, for what appeared in it meanwhile.
    """
    out = absolute(directory)

    def recover(left: Path) -> None:
        """Put DIR back if it is missing, otherwise settle what is left."""
        if not os.path.lexists(out) and not contents(left / APART, schema).missing:
            with suppress(FileNotFoundError):
                (left / APART).rename(out)
        if kept := _settled(left / APART, out, schema, REFUSE, NOTHING):
            say(f"{out}: {kept}")

    with in_one_line(out):
        looked_at(out, schema, others)
        out.parent.mkdir(parents=True, exist_ok=True)
        with staged_folder(out.parent, f".{out.name}", recover) as own:
            work = Work(schema, own / MAKING, looked_at(out, schema, others))
            if work.earlier.foreign and others == DISCARD:
                say(f"{out}: to be discarded: {named(work.earlier.foreign)}")
            work.folder.mkdir()
            yield work
            if not (work.folder / NAME).exists():
                return
            _put_in_place(work.folder, out)
            if kept := _settled(own / APART, out, schema, others, work.earlier):
                if others != KEEP:
                    raise CheckFailure(f"{out}: the new folder is in place; {kept}")
                say(f"{out}: {kept}")


def _put_in_place(new: Path, out: Path) -> None:
    """Give the new folder its name; an earlier one is then APART beside it."""
    apart = new.with_name(APART)
    if out.is_dir():
        new.chmod(stat.S_IMODE(out.stat().st_mode) | 0o700)
    flush(new)
    new.rename(apart)
    if not os.path.lexists(out):
        apart.rename(out)
    elif not _exchange(apart, out):
        apart.rename(new)
        out.rename(apart)
        new.rename(out)
    flush_entry(out.parent)


def _settled(folder: Path, out: Path, schema: str, others: str, before: Contents) -> str:
    """Remove an earlier DIR; or keep it under another name, and say so, if that is asked for or if it holds
    what was not there before."""
    seen = contents(folder, schema)
    wanted = seen.changed_since(before) or (seen.foreign and others == KEEP)
    if not seen.states or (not wanted and remove(folder, seen)):
        return ""
    kept = free_name(out)
    folder.rename(kept)
    why = named(seen.foreign) or "what could not be removed"
    return f"the earlier folder is kept as {kept} for {why}"


def free_name(path: Path, ending: str = "") -> Path:
    """The first name PATH-kept-N that is free."""
    names = (path.with_name(f"{path.name.removesuffix(ending)}-kept-{n}{ending}") for n in count(1))
    return next(name for name in names if not os.path.lexists(name))


def _exchange(one: Path, other: Path) -> bool:
    """Exchange two names in one step; False if the system or its file system cannot."""
    import ctypes  # not needed by an export without changes

    renameat2 = getattr(ctypes.CDLL(None), "renameat2", lambda *_: -1)
    return renameat2(AT_FDCWD, os.fsencode(one), AT_FDCWD, os.fsencode(other), EXCHANGE) == 0


def flush(folder: Path) -> None:
    """Write everything in the folder to the disk, before its name."""
    for base, _, names in os.walk(folder):
        for name in names:
            flush_entry(Path(base, name))
        flush_entry(Path(base))
