"""manifest.json: every file of an export with its digest, and every part in numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

from tactcad.design.files import read_bytes
from tactcad.design.messages import InputError

from .contents import MOST_BYTES, NAME, read_sealed, sealed, sha256_of
from .formats import part_formats

SCHEMA = "tactcad-manifest-1"
KINDS = {f.kind for f in part_formats()}
KINDS |= {*"step-assembly picture bom drawing inspection report netlist wiring robot board gerber".split()}


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
    """The manifest as JSON text, sealed (contents.py). Raises ValueError if a number is not finite."""
    return sealed({"schema": SCHEMA, **asdict(manifest)})


def read_manifest(folder: Path) -> Manifest:
    """The manifest of an export's folder; the files themselves are not looked at.

    Raises InputError if it is absent, altered (contents.py), of another schema, or no export's.
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
    texts = [
        manifest.design,
        manifest.revision,
        *(value for file in manifest.files for value in vars(file).values()),
    ]
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

    Every named file is present with its digest, there is no other file, and every part number is known.
    """
    try:
        manifest = read_manifest(folder)
    except InputError as error:
        return [f"{error.where}: {error.what}"]
    named = [file.path for file in manifest.files]
    present = {p.relative_to(folder).as_posix() for p in folder.rglob("*") if not p.is_dir()}
    wrong = [f"{path}: listed twice" for path in sorted(set(named)) if named.count(path) > 1]
    wrong += [f"{path}: not in the manifest" for path in sorted(present - set(named) - {NAME})]
    parts = {part.part_no for part in manifest.parts}
    for file in manifest.files:
        wrong += _file_faults(folder, file, parts)
    return wrong + _part_faults(manifest.parts)


def _file_faults(folder: Path, file: FileRecord, parts: set[str]) -> list[str]:
    path = PurePosixPath(file.path)
    if path.is_absolute() or ".." in path.parts or not path.parts:
        return [f"{file.path}: leads out of the folder"]
    wrong = (
        []
        if file.kind in KINDS
        else [f"{file.path}: kind {file.kind!r} is none of {', '.join(sorted(KINDS))}"]
    )
    if file.part_no and file.part_no not in parts:
        wrong.append(f"{file.path}: part {file.part_no!r} is not listed")
    try:
        same = sha256_of(read_bytes(folder / path, MOST_BYTES, "a file of an export")) == file.sha256
    except InputError as error:
        return [*wrong, f"{file.path}: {error.what}"]
    return wrong if same else [*wrong, f"{file.path}: its content has changed"]


def _part_faults(parts: Sequence[PartRecord]) -> list[str]:
    """Numbers that cannot be: a part without volume, surface or mass, or a centre outside its box."""
    numbers = [part.part_no for part in parts]
    wrong = [f"part {n} is listed twice" for n in sorted(set(numbers)) if numbers.count(n) > 1]
    for part in parts:
        positive = (part.qty, part.volume_mm3, part.area_mm2, part.mass_g)
        low, high = part.box_mm
        inside = all(a < c < b for a, c, b in zip(low, part.centre_mm, high))
        if not (inside and all(v > 0 for v in positive)):
            wrong.append(f"part {part.part_no}: its numbers cannot be true")
    return wrong
