"""A zip with the same bytes in every process."""

from __future__ import annotations

import io
import os
import zipfile
from collections.abc import Mapping
from pathlib import Path

from tactcad.design.messages import InputError
from tactcad.export.contents import sha256_of

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


def refuse_what_is_no_zip(target: Path) -> None:
    """Raise InputError where the place of a new zip holds a link, or anything else that is no zip."""
    if target.is_symlink():
        raise InputError(
            str(target), "is a link; nothing was changed", legal="a zip to replace, or a new place"
        )
    if os.path.lexists(target) and not zipfile.is_zipfile(target):
        raise InputError(
            str(target), "is no zip; nothing was changed", legal="a zip to replace, or a new place"
        )


def replaced_content(target: Path, new: bytes) -> list[str]:
    """Differences between the zip at `target` and the new one, by file; empty where there is no zip or no
    difference.
    """
    if not target.is_file() or target.read_bytes() == new:
        return []
    try:
        with zipfile.ZipFile(target) as old, zipfile.ZipFile(io.BytesIO(new)) as now:
            contents = [{n: a.read(n) for n in a.namelist() if n != MANIFEST} for a in (old, now)]
    except (zipfile.BadZipFile, OSError, NotImplementedError, RuntimeError):
        return ["an earlier file that is no zip"]
    names = sorted({*contents[0], *contents[1]})
    return [n for n in names if contents[0].get(n) != contents[1].get(n)] or ["the zip's own form"]
