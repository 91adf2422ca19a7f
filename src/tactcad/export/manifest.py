"""manifest.json: what a folder that tactcad wrote holds, and whether it is unchanged; of an export every part
in numbers too.

Every folder that tactcad writes has a manifest.json with `schema`, `files: [{path, sha256, ...}]` and, last,
`seal`: the SHA-256 of the manifest's text without it, so that an edited manifest is recognised too. Files
with their listed digest, and folders that hold one, are ours. Everything else is somebody's: a file that was
added or changed, a link in a file's place, an empty folder; and anything write-protected, because whoever did
that wants it kept.
"""

from __future__ import annotations

import hashlib
import json
import os
import stat
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path, PurePosixPath
from typing import Any, NoReturn

from tactcad.design.files import read_bytes, read_json
from tactcad.design.messages import InputError

from .formats import part_formats

NAME = "manifest.json"
MOST_BYTES = 1_000_000_000  # none of our files comes near; anything larger is not ours
ADDED, CHANGED, PROTECTED = "added", "changed", "write-protected"

State = tuple[int, ...]  # of one file: mode, inode, size, times; a difference means that somebody changed it


@dataclass(frozen=True)
class Contents:
    """A folder's entries by path: all with their states, and somebody's with what each is (see the words
    above).

    `record` is the manifest, None if there is none or it was edited; `missing` are listed but absent.
    """

    states: Mapping[str, State]
    foreign: Mapping[str, str]
    missing: tuple[str, ...]
    record: Mapping[str, Any] | None

    def changed_since(self, before: Contents) -> tuple[str, ...]:
        """Entries that are somebody's, and were not there before or were in another state."""
        return tuple(p for p in self.foreign if p not in before.foreign or before.states[p] != self.states[p])


NOTHING = Contents({}, {}, (), None)


def sha256_of(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def sealed(record: Mapping[str, Any]) -> bytes:
    """The record as JSON text with its seal. Raises ValueError if a number is not finite."""
    return _json({**record, "seal": sha256_of(_json(record))})


def read_sealed(folder: Path, schema: str) -> dict[str, Any]:
    """The manifest of a folder that tactcad wrote, without its seal. Every reader of manifests calls this.

    Raises InputError if there is none, it has another schema, or it is not exactly what tactcad wrote.
    """
    path = folder / NAME
    record = read_json(path, MOST_BYTES, "a manifest")
    found = record.get("schema") if isinstance(record, dict) else None
    if found != schema:
        raise InputError(str(path), "another schema", value=found, legal=schema)
    record.pop("seal", None)
    try:
        texts = [row[key] for row in record["files"] for key in ("path", "sha256")]
        as_written = sealed(record) == read_bytes(path, MOST_BYTES, "a manifest")
    except (LookupError, TypeError, RecursionError):
        texts, as_written = [], False
    if not as_written or not all(isinstance(text, str) for text in texts):
        what = "altered since tactcad wrote it: its seal is missing, or of another text"
        raise InputError(str(path), what, legal="the manifest as written, or the folder made again")
    return record


def _json(record: Mapping[str, Any]) -> bytes:
    return (json.dumps(record, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()


def contents(folder: Path, schema: str) -> Contents:
    """Contents of `folder`; a path that is not a folder is a single entry, somebody's."""
    if not os.path.lexists(folder):
        return NOTHING
    if folder.is_symlink() or not folder.is_dir():
        return Contents({".": _state(folder)}, {".": ADDED}, (), None)
    record = _sealed_record(folder, schema)
    digests = {row["path"]: row["sha256"] for row in record["files"]} if record else {}
    parents = {str(p) for path in digests for p in PurePosixPath(path).parents} | {"."}
    states, foreign = {}, {}
    for path in _entries(folder):
        states[path] = state = _state(folder / path)
        if path == NAME:
            why = "" if record else CHANGED
        elif stat.S_ISDIR(state[0]):
            why = "" if path in parents else ADDED
        else:
            why = _fault(folder / path, state, digests.get(path))
        if why := why or ("" if state[0] & stat.S_IWUSR else PROTECTED):
            foreign[path] = why
    missing = tuple(path for path in digests if path not in states)
    if not record and set(states) == {"."}:
        foreign.pop(".", None)  # an empty folder holds nothing to lose
    return Contents(states, foreign, missing, record)


def _fault(entry: Path, state: State, sha256: str | None) -> str:
    if sha256 is None:
        return ADDED
    if not stat.S_ISREG(state[0]):
        return CHANGED
    try:
        return "" if sha256_of(read_bytes(entry, MOST_BYTES, "a file")) == sha256 else CHANGED
    except InputError:
        return CHANGED


def _entries(folder: Path) -> Iterator[str]:
    """The folder (".") and all below it by path, a folder before its contents; links are not followed.

    Raises OSError if a folder cannot be read: its contents are unknown.
    """

    def unreadable(error: OSError) -> NoReturn:
        raise error

    for base, folders, files in os.walk(folder, onerror=unreadable):
        folders.sort()
        inside = os.path.relpath(base, folder)
        yield Path(inside).as_posix()
        for name in sorted(files + [f for f in folders if os.path.islink(os.path.join(base, f))]):
            yield Path(inside, name).as_posix()


def _state(path: Path) -> State:
    s = path.lstat()
    if stat.S_ISDIR(s.st_mode):
        return (s.st_mode, s.st_ino)  # its times change when it is moved, or when something in it is
    return (s.st_mode, s.st_ino, s.st_size, s.st_mtime_ns, s.st_ctime_ns)


def _sealed_record(folder: Path, schema: str) -> dict[str, Any] | None:
    """The folder's manifest, None if it is not one of that schema just as we wrote it."""
    try:
        return read_sealed(folder, schema) if stat.S_ISREG((folder / NAME).lstat().st_mode) else None
    except (OSError, InputError):
        return None


def remove(folder: Path, seen: Contents) -> bool:
    """Remove the folder with the entries that were seen in it; False if it holds new or changed ones.

    The manifest goes last, so that the rest of an interrupted removal is still recognised as ours.
    """
    folders = [path for path, state in seen.states.items() if stat.S_ISDIR(state[0])]
    files = [path for path in seen.states if path not in set(folders) | {NAME}]
    try:
        for path in folders if seen.foreign else ():  # to be discarded although write-protected
            (folder / path).chmod(0o700)
        for path in (*files, *folders[:0:-1], *({NAME} & set(seen.states)), "."):
            if path in folders:
                (folder / path).rmdir()
            elif _state(folder / path) == seen.states[path]:
                (folder / path).unlink()
            else:
                return False
    except OSError:
        return False
    return True


SCHEMA = "tactcad-manifest-1"  # of an export's


@dataclass(frozen=True)
class FileRecord:
    """One file: path below the export's folder with "/", kind, its part ("" for a whole scene)."""

    path: str
    kind: str
    part_no: str
    revision: str
    sha256: str


@dataclass(frozen=True)
class PartRecord:
    """One part in its own frame. `area_mm2` is the solid's surface; `cut_length_mm` and `section_area_mm2`
    are the cut file's; None if there is none.

    `box_mm` is ((x, y, z) least, (x, y, z) largest). `qty` is the largest count in one scene, as an array
    moves from rig to rig; each scene's own count is in its bill of materials.
    """

    part_no: str
    name: str
    process: str
    qty: int
    volume_mm3: float
    area_mm2: float
    mass_g: float
    centre_mm: tuple[float, float, float]
    box_mm: tuple[tuple[float, float, float], tuple[float, float, float]]
    cut_length_mm: float | None
    section_area_mm2: float | None = None


@dataclass(frozen=True)
class Manifest:
    """Contents of an export. `inputs`: its inputs (inputs.Inputs.as_json)."""

    design: str
    revision: str
    files: tuple[FileRecord, ...]
    parts: tuple[PartRecord, ...]
    inputs: Mapping[str, Any] = field(default_factory=dict)


def manifest_bytes(manifest: Manifest) -> bytes:
    """The manifest as JSON text, sealed. Raises ValueError if a number is not finite."""
    return sealed({"schema": SCHEMA, **asdict(manifest)})


def read_manifest(folder: Path) -> Manifest:
    """The manifest of an export's folder; the files themselves are not looked at.

    Raises InputError if it is absent, altered, of another schema, or no export's.
    """
    record = read_sealed(folder, SCHEMA)
    try:
        del record["schema"]
        files = tuple(FileRecord(**row) for row in record.pop("files"))
        parts = tuple(_part(row) for row in record.pop("parts"))
        manifest = Manifest(files=files, parts=parts, **record)
        _require_kinds(manifest)
        return manifest
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise InputError(str(folder / NAME), f"cannot be used: {error}") from error


def read_export(source: str, folder: Path) -> Manifest:
    """The manifest of an export that `source` names, of which every file is as tactcad wrote it.

    Raises InputError if something in the folder is altered, missing or added.
    """
    if wrong := check_manifest(folder):
        legal = f"a folder with {NAME}, as `tactcad export` writes"
        raise InputError(source, f"not a sound export: {wrong[0]}", legal=legal)
    return read_manifest(folder)


def _require_kinds(manifest: Manifest) -> None:
    """Raise ValueError if text is no text or a number no number."""
    texts = [manifest.design, manifest.revision, *(v for f in manifest.files for v in vars(f).values())]
    numbers: list[Any] = []
    for part in manifest.parts:
        texts += [part.part_no, part.name, part.process]
        (x0, y0, z0), (x1, y1, z1) = part.box_mm
        (x, y, z) = part.centre_mm
        numbers += [part.qty, part.volume_mm3, part.area_mm2, part.mass_g, x, y, z, x0, y0, z0, x1, y1, z1]
        numbers += [v for v in (part.cut_length_mm, part.section_area_mm2) if v is not None]
    if not all(isinstance(text, str) for text in texts):
        raise ValueError("a name is no text")
    if not all(isinstance(n, int | float) and not isinstance(n, bool) for n in numbers):
        raise ValueError("a figure of a part is no number")


def _part(row: dict[str, Any]) -> PartRecord:
    low, high = row["box_mm"]
    return PartRecord(**{**row, "centre_mm": tuple(row["centre_mm"]), "box_mm": (tuple(low), tuple(high))})


def check_manifest(folder: Path) -> list[str]:
    """Faults of an export's folder compared with its manifest.

    Every named file is present with its digest, once, of a known kind and part; there is no other file; and
    every part has volume, surface and mass, and its centre in its box.
    """
    try:
        manifest, seen = read_manifest(folder), contents(folder, SCHEMA)
    except InputError as error:
        return [f"{error.where}: {error.what}"]
    except OSError as error:
        return [f"{error.filename}: {error.strerror}"]
    files = {path: why for path, why in seen.foreign.items() if not stat.S_ISDIR(seen.states[path][0])}
    wrong = [f"{path}: {why}" for path, why in files.items() if why != PROTECTED]
    wrong += [f"{path}: missing" for path in seen.missing]
    paths = Counter(file.path for file in manifest.files)
    numbers = Counter(part.part_no for part in manifest.parts)
    for what, names in (("file", paths), ("part", numbers)):
        wrong += [f"{what} {name} is listed twice" for name, times in names.items() if times > 1]
    for file in manifest.files:
        if file.kind not in kinds():
            wrong.append(f"{file.path}: kind {file.kind!r} is none of {', '.join(sorted(kinds()))}")
        if file.part_no and file.part_no not in numbers:
            wrong.append(f"{file.path}: part {file.part_no!r} is not listed")
    for part in manifest.parts:
        inside = all(a < c < b for a, c, b in zip(part.box_mm[0], part.centre_mm, part.box_mm[1]))
        if not inside or min(part.qty, part.volume_mm3, part.area_mm2, part.mass_g) <= 0:
            wrong.append(f"part {part.part_no}: its numbers cannot be true")
    return wrong


@cache
def kinds() -> set[str]:
    """Every kind of file of an export; a function, as the formats' modules need this one."""
    others = "step-assembly picture bom drawing inspection report netlist wiring robot board gerber"
    return {form.kind for form in part_formats()} | set(others.split())
