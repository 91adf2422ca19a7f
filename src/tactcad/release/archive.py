"""A zip with the same bytes in every process, sealed: its comment holds the SHA-256 of all before it.

So an edit is seen without unpacking; a forgery is not (as in export/contents.py).
"""

from __future__ import annotations

import hashlib
import io
import os
import struct
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import BinaryIO

from tactcad.design.files import PIECE
from tactcad.design.messages import shortened
from tactcad.export.contents import CHANGED, MOST_BYTES, sha256_of
from tactcad.export.publication import SHOWN

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
    sums = "".join(f"{sha256_of(data)}  {path}\n" for path, data in files.items())
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for path, data in {**files, MANIFEST: sums.encode()}.items():
            entry = zipfile.ZipInfo(path, stamp)
            entry.create_system, entry.external_attr = UNIX, MODE << 16
            archive.writestr(entry, data, zipfile.ZIP_DEFLATED, 9)
    body = out.getvalue()[:-2]  # ends with the length of its comment, which is empty
    return body + _seal(sha256_of(body))


def _seal(digest: str) -> bytes:
    return struct.pack("<H", SEALED - 2) + SEAL + digest.encode()


def fault(path: Path) -> str:
    """Why the file is not, byte for byte, what `archive_bytes` made, with names of entries of another date or
    other permissions; empty where it is. Nothing is unpacked. Raises OSError.
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
    """Entries of the zip's directory; none where it cannot be read, or is larger than ours could be."""
    file.seek(max(file.seek(0, os.SEEK_END) - MOST_DIRECTORY, 0))
    try:
        with zipfile.ZipFile(io.BytesIO(file.read(MOST_DIRECTORY))) as archive:
            return archive.infolist()
    except (zipfile.BadZipFile, NotImplementedError, ValueError, struct.error):
        return []


def replaced_content(target: Path, new: bytes) -> list[str]:
    """Files that the zip at `target`, if there is one, and the new one do not have alike."""
    if not target.is_file():
        return []
    with target.open("rb") as old:
        earlier, now = (
            {(entry.filename, entry.CRC, entry.file_size) for entry in _directory(file)}
            for file in (old, io.BytesIO(new))
        )
    return sorted({name for name, *_ in earlier ^ now} - {MANIFEST})
