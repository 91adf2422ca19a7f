"""Zips with the same bytes in every process, each sealed: its comment holds the SHA-256 of all before it.
They take their places together, and nobody's file is lost.

An edited zip is recognised by its seal without unpacking it; a forged one is not (as in export/manifest.py).
The places are examined before the work, and again before the new zips replace the old: a zip that is not
exactly as tactcad wrote it, and was not to be discarded, is kept as NAME-kept-1.zip.
"""

from __future__ import annotations

import hashlib
import io
import os
import stat
import struct
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from tactcad.design.files import PIECE, flush_entry, folder_for, in_one_line, refuse_link
from tactcad.design.messages import CheckFailure, InputError, shortened
from tactcad.design.staging import staged_folder
from tactcad.export.manifest import CHANGED, MOST_BYTES, PROTECTED, sha256_of
from tactcad.export.publication import DISCARD, REFUSE, SHOWN, Say, flush, free_name, named
from tactcad.shutdown import no_signals

MANIFEST = "MANIFEST.sha256"
MODE = 0o100644  # a plain file that everyone may read
UNIX = 3
OLDEST, NEWEST = 1980, 2107  # years that a zip can hold
SEAL = b"as tactcad wrote it, SHA-256 "  # followed by the digest, in hexadecimal
SEALED = 2 + len(SEAL) + 64  # bytes of the comment with its length before it
MOST_DIRECTORY = 1 << 20  # bytes at the end of a zip that are read for its directory; a file takes some 80


def archive_bytes(files: Mapping[str, bytes], date: str) -> bytes:
    """The files as a zip, in the mapping's order, with MANIFEST.sha256 at the end and sealed.

    Every entry is dated midnight of `date` (YYYY-MM-DD) and may be read by everyone.
    """
    year, month, day = map(int, date.split("-"))
    stamp = (min(max(year, OLDEST), NEWEST), month, day, 0, 0, 0)
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for path, data in {**files, MANIFEST: checksums(files)}.items():
            entry = zipfile.ZipInfo(path, stamp)
            entry.create_system, entry.external_attr = UNIX, MODE << 16
            archive.writestr(entry, data, zipfile.ZIP_DEFLATED, 9)
    body = out.getvalue()[:-2]  # ends with the length of its comment, which is empty
    return body + _seal(sha256_of(body))


def checksums(files: Mapping[str, bytes]) -> bytes:
    """MANIFEST.sha256 of the files, as sha256sum reads it."""
    return "".join(f"{sha256_of(data)}  {path}\n" for path, data in files.items()).encode()


def _seal(digest: str) -> bytes:
    return struct.pack("<H", SEALED - 2) + SEAL + digest.encode()


def fault(path: Path) -> str:
    """Why the file is not, byte for byte, what `archive_bytes` made, with names of entries of another date or
    other permissions; empty if it is. Nothing is unpacked. Raises OSError.
    """
    with path.open("rb") as file:
        size, digest = os.fstat(file.fileno()).st_size, hashlib.sha256()
        for at in range(0, size - SEALED if size <= MOST_BYTES else 0, PIECE):
            digest.update(file.read(min(PIECE, size - SEALED - at)))
        end = file.read(SEALED)
        if end == _seal(digest.hexdigest()):
            return ""
        ours = (UNIX, MODE << 16, (0, 0, 0))
        names = [
            shortened(entry.filename)
            for entry in _directory(file)
            if (entry.create_system, entry.external_attr, entry.date_time[3:]) != ours
        ]
    why = CHANGED if SEAL in end else "without tactcad's seal"
    shown = ", ".join(names[:SHOWN] + ["..."] * (len(names) > SHOWN))
    return f"{why}: {shown}" if names else why


def _directory(file: BinaryIO) -> list[zipfile.ZipInfo]:
    """Entries of the zip's directory; none if it cannot be read, or is too large to be ours."""
    file.seek(max(file.seek(0, os.SEEK_END) - MOST_DIRECTORY, 0))
    try:
        with zipfile.ZipFile(io.BytesIO(file.read(MOST_DIRECTORY))) as archive:
            return archive.infolist()
    except (zipfile.BadZipFile, NotImplementedError, ValueError, struct.error):
        return []


def replaced_content(target: Path, new: bytes) -> list[str]:
    """Files that differ between the zip at `target`, if there is one, and the new one."""
    if not target.is_file():
        return []
    with target.open("rb") as old:
        earlier, now = (
            {(entry.filename, entry.CRC, entry.file_size) for entry in _directory(file)}
            for file in (old, io.BytesIO(new))
        )
    return sorted({name for name, *_ in earlier ^ now} - {MANIFEST})


LINK, OTHER, UNREADABLE = NO_FILE = "a link", "no file", "a file that cannot be read"
Foreign = tuple[str, int, int, int]  # its fault; inode, size and time (ns) show a change


def looked_at(places: Sequence[Path], others: str) -> dict[str, Foreign]:
    """Files in the places of zips that are not as tactcad wrote them, by name; changes nothing.

    Raises InputError if there is any and `others` is REFUSE, or any is no file that can be read.
    """
    out = places[0].parent
    refuse_link(out)
    with in_one_line(out):
        foreign = {place.name: found for place in places if (found := _foreign(place))}
    odd = any(why in NO_FILE for why, *_ in foreign.values())
    if odd or (foreign and others == REFUSE):
        differing = named({name: why for name, (why, *_) in foreign.items()})
        what = f"holds what is not as tactcad wrote it: {differing}; nothing was changed"
        ways = "" if odd else "--keep, which moves it aside, --discard, which removes it, or "
        raise InputError(str(out), what, legal=ways + "another folder")
    return foreign


def _foreign(path: Path) -> Foreign | None:
    try:
        s = path.lstat()
    except FileNotFoundError:
        return None
    why = "" if stat.S_ISREG(s.st_mode) else LINK if stat.S_ISLNK(s.st_mode) else OTHER
    try:
        why = why or fault(path) or ("" if s.st_mode & stat.S_IWUSR else PROTECTED)
    except OSError:
        why = UNREADABLE
    return (why, s.st_ino, s.st_size, s.st_mtime_ns) if why else None


@contextmanager
def replacing(places: Sequence[Path], seen: Mapping[str, Foreign], others: str, say: Say) -> Iterator[Path]:
    """A folder for new zips, named as their places, which they take when the block ends well; what lies in
    other places goes. Only a kill between two renames, microseconds apart, can leave some old and some new.

    `seen` is what `looked_at` found; `say` receives a line for all that is kept or discarded. Raises
    InputError if it cannot write there, CheckFailure if there is no room or what appeared was kept.
    """
    out, stem, appeared = places[0].parent, f".{places[0].stem}", []
    with in_one_line(out), folder_for(out), staged_folder(out, stem) as own:
        yield own
        flush(own)
        with no_signals():
            for place in places:
                now, before = _foreign(place), seen.get(place.name)
                if now and now == before and others == DISCARD:
                    say(f"{place}: discarded: {now[0]}")
                elif now:
                    kept = _kept_beside(place)
                    say(f"{place}: what lay there is kept as {kept}: {now[0]}")
                    appeared += [] if now == before else [str(kept)]
            for place in places:
                new = own / place.name
                if not new.exists():
                    place.unlink(missing_ok=True)
                    continue
                if place.is_file():
                    new.chmod(stat.S_IMODE(place.stat().st_mode) | stat.S_IWUSR)
                new.replace(place)
            flush_entry(out)
    if appeared:
        raise CheckFailure(
            f"{out}: the new zips are in place; what appeared is kept as {', '.join(appeared)}"
        )


def _kept_beside(place: Path) -> Path:
    """Give it the first free name NAME-kept-N.zip as well, so that its place is never empty."""
    kept = free_name(place, place.suffix)
    try:
        os.link(place, kept, follow_symlinks=False)
    except FileExistsError:  # it was taken meanwhile
        return _kept_beside(place)
    except OSError:  # a folder, or no links here
        place.rename(kept)
    return kept
