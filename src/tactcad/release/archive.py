"""A zip of equal bytes in every process, and a file that appears under its name finished or not at all."""

from __future__ import annotations

import io
import os
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from tactcad.design.messages import InputError
from tactcad.export.manifest import sha256_of
from tactcad.export.publish import WAIT_SECONDS, flush_entry, in_one_line, take_lock

MANIFEST = "MANIFEST.sha256"
MODE = 0o100644  # a plain file that everyone may read
UNIX = 3
OLDEST, NEWEST = 1980, 2107  # years that a zip can hold


def archive_bytes(files: Mapping[str, bytes], date: str) -> bytes:
    """The files as a zip, in the mapping's order and with MANIFEST.sha256 at the end.

    Every entry is dated midnight of `date` (YYYY-MM-DD) and may be read by everyone.
    """
    year, month, day = map(int, date.split("-"))
    stamp = (min(max(year, OLDEST), NEWEST), month, day, 0, 0, 0)
    listed = "".join(f"{sha256_of(data)}  {path}\n" for path, data in files.items())
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for path, data in {**files, MANIFEST: listed.encode()}.items():
            entry = zipfile.ZipInfo(path, stamp)
            entry.create_system, entry.external_attr = UNIX, MODE << 16
            archive.writestr(entry, data, zipfile.ZIP_DEFLATED, 9)
    return out.getvalue()


@contextmanager
def written_beside(target: Path, say: Callable[[str], None], wait: float = WAIT_SECONDS) -> Iterator[Path]:
    """A file to write beside `target`, which is renamed over it when the block ends well and gone when it does not.

    Only one process at a time has it; what a killed one left there is written over. Whoever has the older
    `target` open keeps reading that. Raises InputError where the machine refuses or a folder stands there,
    CheckFailure where the disk is full.
    """
    if target.is_dir():
        raise InputError(str(target), "is a folder", legal="the name of a file")
    part = target.with_name(f".{target.name}.part")
    with in_one_line(target):
        target.parent.mkdir(parents=True, exist_ok=True)
        handle = _own(part, target, wait, say)
        try:
            yield part
            flush_entry(part)
            part.chmod(MODE & 0o777)
            part.rename(target)
            flush_entry(target.parent)
        except BaseException:
            part.unlink(missing_ok=True)
            raise
        finally:
            os.close(handle)


def _own(part: Path, target: Path, wait: float, say: Callable[[str], None]) -> int:
    """The part file, opened and locked; the lock goes with the process, however that ends."""
    while True:
        handle = os.open(part, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o644)
        try:
            take_lock(handle, target, wait, say)
            if part.exists() and os.path.samestat(os.fstat(handle), part.stat()):
                return handle
        except BaseException:
            os.close(handle)
            raise
        os.close(handle)  # whoever had it has renamed it since


def replaced_content(target: Path, new: bytes) -> list[str]:
    """What differs between the zip that stands at `target` and the new one, by file; empty where there is none or
    nothing does."""
    if not target.is_file() or target.read_bytes() == new:
        return []
    try:
        with zipfile.ZipFile(target) as old, zipfile.ZipFile(io.BytesIO(new)) as now:
            contents = [{n: a.read(n) for n in a.namelist() if n != MANIFEST} for a in (old, now)]
    except (zipfile.BadZipFile, OSError, NotImplementedError, RuntimeError):
        return ["an earlier file that is no zip"]
    names = sorted({*contents[0], *contents[1]})
    return [n for n in names if contents[0].get(n) != contents[1].get(n)] or ["the zip's own form"]
