"""The one way in which files named by users are read, and single files written.

Reading: regular files of bounded size only, so that a pipe, a device or a huge file named by mistake neither
hangs the command nor fills the memory. Writing: the whole file or nothing.
"""

from __future__ import annotations

import csv
import errno
import io
import json
import os
import stat
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from itertools import islice
from math import isfinite
from pathlib import Path
from typing import Any, NoReturn

from tactcad.shutdown import unfinished

from .messages import CheckFailure, InputError, hidden, shortened
from .staging import OWN, staged_file, staged_folder

PIECE = 1 << 20  # bytes read at once

# refusals of the operating system, not mistakes of ours: answered by one line instead of a traceback
NO_ROOM = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO}
REFUSED_BY_MACHINE = NO_ROOM | {
    errno.EACCES,
    errno.EPERM,
    errno.EROFS,
    errno.EEXIST,
    errno.ENOTEMPTY,
    errno.ENOTDIR,
    errno.EISDIR,
    errno.ENOENT,
    errno.ENAMETOOLONG,
    errno.EBUSY,
    errno.ELOOP,
    errno.EMFILE,
    errno.ENFILE,
    errno.EINVAL,
    errno.EXDEV,
}


def read_bytes(path: str | Path, most_bytes: int, kind: str) -> bytes:
    """All bytes of a regular file.

    Parameters
    ----------
    path
        The file, as the user named it.
    most_bytes
        What is larger is refused unread.
    kind
        What was expected, for messages: "a design file (TOML)".

    Raises
    ------
    InputError
        If there is no such file, it is a folder, pipe or device, too large, or may not be read.
    """
    shown = str(path)
    if "\0" in shown:
        raise InputError(shown, "cannot be read: a NUL in its name", legal=kind)
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK)  # without waiting for a pipe's writer
        with open(handle, "rb") as stream:
            state = os.fstat(handle)
            if not stat.S_ISREG(state.st_mode):
                raise InputError(shown, "cannot be read: not a file", legal=kind)
            # a file may say less than it gives, as those of /proc do; never more memory than it takes
            pieces = iter(lambda: stream.read(PIECE), b"")
            some = state.st_size <= most_bytes
            data = b"".join(islice(pieces, most_bytes // PIECE + 2)) if some else None
    except (FileNotFoundError, NotADirectoryError):
        raise InputError(shown, "cannot be read: no such file", legal=kind) from None
    except IsADirectoryError:
        raise InputError(shown, "cannot be read: not a file", legal=kind) from None
    except OSError as error:
        raise InputError(shown, f"cannot be read: {error.strerror}", legal=kind) from None
    if data is None or len(data) > most_bytes:
        raise InputError(
            shown, "larger than such a file can be", legal=f"{kind} of at most {most_bytes} bytes"
        )
    return data


def read_text(path: str | Path, most_bytes: int, kind: str) -> str:
    """All of a regular file as UTF-8 text, without a byte order mark.

    Parameters
    ----------
    path, most_bytes, kind
        As for `read_bytes`.

    Raises
    ------
    InputError
        As `read_bytes`; with line and column (in bytes) if it is not UTF-8, or holds a NUL.
    """
    data = read_bytes(path, most_bytes, kind)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        # error.object is the text after the mark
        before = error.object[: error.start]
        line, column = before.count(b"\n") + 1, len(before) - before.rfind(b"\n")
        bad = error.object[error.start : error.end]
        raise InputError(
            f"{path}:{line}:{column}", "is not UTF-8 text", value=bad, legal=f"{kind} in UTF-8"
        ) from None
    if "\0" in text:
        line = text[: text.index("\0")].count("\n") + 1
        raise InputError(f"{path}:{line}:1", "a NUL character: not a text file", legal=kind)
    return text


def read_json(path: str | Path, most_bytes: int, kind: str) -> Any:
    """The value of a JSON file.

    Parameters
    ----------
    path, most_bytes, kind
        As for `read_bytes`.

    Raises
    ------
    InputError
        As `read_text`; with line and column if it is not JSON, which has neither NaN nor infinities, if it is
        nested too deeply, or if a text holds invisible characters.
    """
    text = read_text(path, most_bytes, f"{kind} (JSON)")
    try:
        value = json.loads(text, parse_constant=_no_number, parse_float=_finite, parse_int=_within_floats)
    except json.JSONDecodeError as error:
        raise InputError(
            f"{path}:{error.lineno}:{error.colno}", f"not JSON: {error.msg}", legal=kind
        ) from None
    except RecursionError:
        raise InputError(str(path), "nested too deeply", legal=kind) from None
    except ValueError as error:  # NaN, or an integer of thousands of digits
        raise InputError(str(path), f"not JSON: {error}", legal=kind) from None
    if not text.isascii() or "\\u" in text:
        # Raise InputError if a key or text holds half a pair, a control, or what turns the direction of
        # text.
        shown = str(path)
        left = [value]
        while left:
            item = left.pop()
            if isinstance(item, dict):
                left += [*item, *item.values()]
            elif isinstance(item, list):
                left += item
            elif isinstance(item, str) and (fault := hidden(item)):
                raise InputError(shown, f"a text holds {fault}", value=item, legal=kind)
    return value


def _within_floats(text: str) -> int:
    _finite(text)
    return int(text)


def _finite(text: str) -> float:
    value = float(text)
    return value if isfinite(value) else _no_number(text)


def _no_number(text: str) -> NoReturn:
    raise ValueError(f"{shortened(text)} is no number")


def write_whole(path: str | Path, data: bytes) -> None:
    """Write a file of these bytes in one step. Raises as `whole_file` does."""
    with whole_file(path) as part:
        part.write_bytes(data)


@contextmanager
def whole_file(path: str | Path) -> Iterator[Path]:
    """A temporary file in the path's folder: flushed and renamed over the path when the block ends well,
    otherwise removed.

    The folder must exist; links are followed to it, and refused in the file's place. Leftovers of killed runs
    are removed first. A replaced file keeps its permissions; a write-protected one is kept. Raises InputError
    if the place cannot be written to, CheckFailure if there is no room; the earlier file is then unchanged.
    """
    with in_one_line(path):
        place = Path(os.path.realpath(path))
        mode = _mode(path, place)
        with staged_file(place) as part:
            yield part
            flush_entry(part)
            part.chmod(mode)
            part.replace(place)
            flush_entry(place.parent)


def _mode(path: str | Path, place: Path) -> int:
    """Permissions of the file that is to be at `place`. Raises InputError if there can be none."""
    refuse_link(path)
    if not os.path.lexists(place):
        mask = os.umask(0)
        os.umask(mask)
        return 0o666 & ~mask
    if not place.is_file():
        raise InputError(
            str(path), "not a file; nothing was changed", legal="a new name, or a file to replace"
        )
    mode = stat.S_IMODE(place.stat().st_mode)
    if not mode & stat.S_IWUSR:
        raise InputError(
            str(path), "is write-protected; nothing was changed", legal="a new name, or make it writable"
        )
    return mode


def refuse_link(path: str | Path) -> None:
    """Raise InputError if a file to be written is a link: it would go to a place that nobody named."""
    if os.path.islink(path) and not os.path.isdir(path):
        raise InputError(
            str(path), "is a link; nothing was changed", legal="the file that it leads to, or a new name"
        )


def flush_entry(path: Path) -> None:
    """Write the content of the file or folder to the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


@contextmanager
def scratch_folder(purpose: str) -> Iterator[Path]:
    """A temporary folder; what killed runs left of that purpose is removed first.

    Raises as `whole_file` does.
    """
    with in_one_line("temporary folder"):
        parent = absolute(tempfile.gettempdir())
    with in_one_line(parent), staged_folder(parent, f"tactcad-{purpose}") as folder:
        yield folder


def refuse_overwriting(out: str | Path, *inputs: str | Path | None, option: str = "--out") -> None:
    """Refuse, before any work, an output that would overwrite an input, and a file that is a link.

    Parameters
    ----------
    out
        File or folder to be written.
    inputs
        Files and folders that are read; None and missing ones are ignored.
    option
        The option that names `out`, for the message.

    Raises
    ------
    InputError
        If `out` is one of the inputs, under whatever name or link, lies in a folder that is one, or is a
        folder with one in it; or if it is a link, but not to a folder.
    """
    absolute(out)  # a folder to start from is there
    place, around = _identity(out), _folders(out)
    for source in inputs:
        if source is None or (own := _identity(source)) is None:
            continue
        if own == place or place in _folders(source) or own in around:
            raise InputError(
                option, f"{out} would overwrite {source}, which is read", legal="a place apart from it"
            )
    refuse_link(out)


def _identity(path: str | Path) -> tuple[int, int] | None:
    """Device and inode number at the end of all links, None if nothing is there."""
    try:
        state = os.stat(path)
    except (OSError, ValueError):
        return None
    return state.st_dev, state.st_ino


def _folders(path: str | Path) -> set[tuple[int, int] | None]:
    """The folders around it, by the name given and by where links lead."""
    ways = (Path(way(path)) for way in (os.path.abspath, os.path.realpath))
    return {_identity(folder) for way in ways for folder in way.parents} - {None}


def absolute(path: str | Path) -> Path:
    """The path from the root. Raises InputError if the working folder was removed."""
    with in_one_line(path):
        return Path(os.path.abspath(path))


def make_folder(path: str | Path) -> None:
    """Make the folder if it does not exist. Raises as `write_whole` does."""
    with in_one_line(path):
        Path(path).mkdir(parents=True, exist_ok=True)


@contextmanager
def folder_for(path: Path) -> Iterator[None]:
    """The folder, made if there is none, and then removed if the block leaves it empty. Raises OSError."""
    if path.exists():
        yield
        return
    with folder_for(path.parent), unfinished(path.rmdir):
        path.mkdir(exist_ok=True)
        try:
            yield
        finally:
            with suppress(OSError):  # the block wrote into it
                path.rmdir()


@contextmanager
def in_one_line(target: str | Path) -> Iterator[None]:
    """Turn an operating system's refusal to write `target` into a one-line message (`refusal`)."""
    try:
        yield
    except OSError as error:
        raise refusal(str(target), error) from error


def refusal(where: str, error: OSError) -> InputError | CheckFailure:
    """Our message for an operating system's refusal to write: CheckFailure if there is no room, else
    InputError.

    Raises any other `error` again.
    """
    if error.errno not in REFUSED_BY_MACHINE:
        raise error
    there = str(error.filename or where)
    shown = there != where and OWN not in there  # a temporary path tells nobody anything
    reason = f"{error.strerror} ({there})" if shown else error.strerror
    if error.errno in NO_ROOM:
        return CheckFailure(f"{where}: cannot be written: {reason}; nothing was changed")
    return InputError(where, f"cannot be written: {reason}; nothing was changed", legal="a writable place")


def as_csv(rows: Iterable[Iterable[object]], end: str = "\r\n") -> bytes:
    """Rows, the first of which names the columns, as CSV (RFC 4180, UTF-8)."""
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator=end).writerows(rows)
    return text.getvalue().encode()
