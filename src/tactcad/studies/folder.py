"""A report's folder appears whole or not at all.

It is written beside its place and then moved there in one step; an earlier report is exchanged for it in
one step where the system can (Linux's renameat2), else moved aside first and back if the second move fails.
"""

from __future__ import annotations

import ctypes
import json
import os
import shutil
import tempfile
from collections.abc import Iterable
from pathlib import Path

from tactcad.design.messages import CheckFailure, InputError

AT_FDCWD, RENAME_EXCHANGE = -100, 2


def replace(out: Path, files: dict[str, bytes], schema: str) -> None:
    """Make `out` a folder of exactly these files; their names may have one folder in them.

    `out` may be missing, empty, or an earlier report (a report.json of that schema beside files of these
    kinds only). Raises InputError where it is something else, CheckFailure where the disk refuses; then
    `out` is as before.
    """
    out = Path(os.path.abspath(out))
    require_ours(out, files, schema)
    part = None
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        part = Path(tempfile.mkdtemp(prefix=f".{out.name}.", suffix=".part", dir=out.parent))
        part.chmod(0o755)
        for name, content in files.items():
            (part / name).parent.mkdir(exist_ok=True)
            (part / name).write_bytes(content)
        _move(part, out)
    except OSError as error:
        raise CheckFailure(
            f"{out}: cannot be written: {error.strerror or error}; nothing was changed"
        ) from None
    finally:
        if part is not None:
            shutil.rmtree(part, ignore_errors=True)


def require_ours(out: Path, names: Iterable[str], schema: str) -> None:
    """Raise InputError unless `out` is missing, empty, or an earlier report with files of the names' endings."""
    if not os.path.lexists(out):
        return
    if out.is_symlink() or not out.is_dir():
        raise InputError(
            str(out), "is not a folder", legal="a folder that is missing, empty, or an earlier report"
        )
    there = sorted(p.relative_to(out).as_posix() for p in out.rglob("*") if not p.is_dir())
    endings = {Path(name).suffix for name in names}
    if not there:
        return
    try:
        ours = json.loads((out / "report.json").read_text("utf-8")).get("schema") == schema
    except (OSError, ValueError, AttributeError):
        ours = False
    foreign = [name for name in there if Path(name).suffix not in endings]
    if not ours or foreign:
        raise InputError(
            str(out),
            "holds files that are not an earlier report's",
            value=foreign[0] if foreign else there[0],
            legal="a folder that is missing, empty, or an earlier report",
        )


def _move(part: Path, out: Path) -> None:
    """After it `part` is the earlier folder, or is gone."""
    if not out.exists() or not any(out.iterdir()):
        os.rename(part, out)  # onto an empty folder too
        return
    if _exchange(part, out):
        return
    aside = part.with_suffix(".old")
    os.rename(out, aside)
    try:
        os.rename(part, out)
    except OSError:
        os.rename(aside, out)
        raise
    shutil.rmtree(aside, ignore_errors=True)


def _exchange(a: Path, b: Path) -> bool:
    """Exchange two names in one step; False where the system or its file system cannot."""
    try:
        renameat2 = ctypes.CDLL(None, use_errno=True).renameat2
    except (AttributeError, OSError):
        return False
    return renameat2(AT_FDCWD, os.fsencode(a), AT_FDCWD, os.fsencode(b), RENAME_EXCHANGE) == 0
