"""A report's folder appears whole or not at all.

It is written beside its place and then moved there in one step; an earlier report is exchanged for it in
one step where the system can (Linux's renameat2), else moved aside first and back if the second move fails.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import tempfile
from pathlib import Path

from tactcad.design.files import absolute, read_json, refusal
from tactcad.design.messages import InputError

MOST_BYTES = 100_000_000  # a report takes two
AT_FDCWD, RENAME_EXCHANGE = -100, 2


def replace(out: Path, files: dict[str, bytes], schema: str) -> None:
    """Make `out` a folder of exactly these files; their names may have one folder in them.

    `out` may be missing, empty, or an earlier report (a report.json of that schema beside files of these
    kinds only). Raises InputError where it is something else or may not be written, CheckFailure where there is no
    room; then `out` is as before.
    """
    out = absolute(out)
    refuse_foreign(out, {Path(name).suffix for name in files}, schema)
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
        raise refusal(str(out), error) from error
    finally:
        if part is not None:
            shutil.rmtree(part, ignore_errors=True)


def refuse_foreign(out: Path, endings: set[str], schema: str) -> None:
    """Raises InputError where `out` is neither missing nor empty nor an earlier report of such files."""
    if not os.path.lexists(out):
        return
    if out.is_symlink() or not out.is_dir():
        raise InputError(
            str(out), "is not a folder", legal="a folder that is missing, empty, or an earlier report"
        )
    try:
        there = sorted(os.listdir(out))
        if there and _is_report(out, schema):  # only then is it looked into: it may be a whole disk
            files = sorted(p.relative_to(out).as_posix() for p in out.rglob("*") if not p.is_dir())
            there = [name for name in files if Path(name).suffix not in endings]
    except OSError as error:
        raise refusal(str(out), error) from error
    if there:
        raise InputError(
            str(out),
            "holds files that are not an earlier report's",
            value=there[0],
            legal="a folder that is missing, empty, or an earlier report",
        )


def _is_report(out: Path, schema: str) -> bool:
    try:
        return read_json(out / "report.json", MOST_BYTES, "a report").get("schema") == schema
    except (InputError, AttributeError):
        return False


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
