"""Reads a release back, and reports how the zip differs from the design."""

from __future__ import annotations

import re
import zipfile
import zlib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path, PurePosixPath

from tactcad.drawing.assemblies.assembly_sheets import assembly_faults
from tactcad.drawing.engine.sheet_files import pdf_runs
from tactcad.drawing.engine.title import SAMPLE as STATUS
from tactcad.drawing.guide import page_path
from tactcad.drawing.parts.part_sheet import key_faults
from tactcad.export import inspection
from tactcad.export import strength_table as strength
from tactcad.export.dxf import check_dxf
from tactcad.export.formats import has_limits
from tactcad.export.manifest import sha256_of
from tactcad.parts.cut_section import cut_section
from tactcad.parts.description import Part
from tactcad.scenes import bom
from tactcad.scenes.scene import Scene

from .archive import MANIFEST, MODE
from .packages import table_rows
from .readme import DRAFT, MARK, SAMPLE
from .release_contents import ReleaseContents

README = "README.txt"
AP242 = "-ap242"  # ends the name of a model with limits


def check_archive(path: Path, contents: ReleaseContents) -> list[str]:
    """What is wrong with the written zip; empty where nothing is."""
    files, wrong = read_back(path)
    return wrong or [
        *_part_faults(files, contents),
        *(fault for scene in contents.scenes for fault in _scene_faults(files, contents, scene)),
        *_sheet_faults(files, contents),
        *_guide_faults(files, contents),
        *_table_faults(files, contents),
        *mark_faults(files, contents),
    ]


def read_back(path: Path) -> tuple[dict[str, bytes], list[str]]:
    """The zip's files, and what is wrong with its form and checksums."""
    try:
        with zipfile.ZipFile(path) as archive:
            if broken := archive.testzip():
                return {}, [f"{broken}: damaged"]
            files = {name: archive.read(name) for name in archive.namelist()}
            return files, [*_form_faults(archive.infolist()), *_manifest_faults(files)]
    except (zipfile.BadZipFile, zlib.error, EOFError, OSError, NotImplementedError, RuntimeError) as error:
        return {}, [f"not readable as a zip: {error}"]


def _form_faults(entries: Sequence[zipfile.ZipInfo]) -> list[str]:
    names = [e.filename for e in entries]
    wrong = [f"{name}: stands twice" for name, count in Counter(names).items() if count > 1]
    for e in entries:
        if PurePosixPath(e.filename).is_absolute() or ".." in PurePosixPath(e.filename).parts:
            wrong.append(f"{e.filename}: leads out of the folder")
        if e.external_attr >> 16 != MODE or e.date_time != entries[0].date_time:
            wrong.append(f"{e.filename}: another date or other permissions than the rest")
    return wrong


def _manifest_faults(files: Mapping[str, bytes]) -> list[str]:
    if MANIFEST not in files:
        return [f"no {MANIFEST}"]
    lines = files[MANIFEST].decode().splitlines()
    listed = {path: digest for digest, _, path in (line.partition("  ") for line in lines)}
    wrong = [f"{path}: not in {MANIFEST}" for path in files if path != MANIFEST and path not in listed]
    for path, digest in listed.items():
        if path not in files or sha256_of(files[path]) != digest:
            wrong.append(f"{path}: not as {MANIFEST} has it")
    return wrong


def _part_faults(files: Mapping[str, bytes], contents: ReleaseContents) -> Iterator[str]:
    """One STEP file of one solid a part, one more a part with limits, one cut file a part that is cut from
    sheet or plate; their names and headers name the revision."""
    revision = contents.design.design.revision
    parts = {p.part_no: p for scene in contents.scenes for p in scene.parts}
    for part in parts.values():
        yield from _step_part_faults(files, f"step/{part.part_no}_{revision}.step", revision)
        if has_limits(part):
            yield from _step_part_faults(files, f"step/{part.part_no}_{revision}{AP242}.step", revision)
        if cut_section(part) is not None:
            yield from _dxf_faults(files, f"dxf/{part.part_no}_{revision}.dxf", part)
    for folder in ("step/", "dxf/", "pdf/"):
        for path in files:
            if path.startswith(folder) and not PurePosixPath(path).stem.removesuffix(AP242).endswith(
                f"_{revision}"
            ):
                yield f"{path}: its name does not end in revision {revision}"
    cut = {p.part_no for p in parts.values() if cut_section(p) is not None}
    for path in files:
        if path.startswith("dxf/") and PurePosixPath(path).stem.rpartition("_")[0] not in cut:
            yield f"{path}: no part cut from sheet or plate has this name"


def _step_part_faults(files: Mapping[str, bytes], path: str, revision: str) -> Iterator[str]:
    if path not in files:
        yield f"{path}: missing"
        return
    text = files[path].decode("ascii")
    yield from _header_faults(path, text, revision)
    counts = tuple(
        len(re.findall(rf"={name}\(", text)) for name in ("PRODUCT", "NEXT_ASSEMBLY_USAGE_OCCURRENCE")
    )
    if counts != (1, 0) or "MANIFOLD_SOLID_BREP(" not in text:
        yield f"{path}: {counts[0]} products and {counts[1]} instances instead of one solid part"


def _header_faults(path: str, text: str, revision: str) -> Iterator[str]:
    header = text.partition("ENDSEC;")[0]
    if f"'revision {revision}'" not in header:
        yield f"{path}: its header does not name revision {revision}"


def _dxf_faults(files: Mapping[str, bytes], path: str, part: Part) -> Iterator[str]:
    if path not in files:
        yield f"{path}: missing"
        return
    yield from (f"{path}: {fault}" for fault in check_dxf(files[path], part))


def _scene_faults(files: Mapping[str, bytes], contents: ReleaseContents, scene: Scene) -> Iterator[str]:
    """The assembly has as many solids as its bill, the bill's files are here as it has them, and it says the
    revision."""
    revision = contents.design.design.revision
    path = f"step/{contents.design.name}-{scene.name}_{revision}.step"
    bill = bill_of(scene)
    if path not in files or bill not in files:
        yield f"{path} or {bill}: missing"
        return
    text = files[path].decode("ascii")
    yield from _header_faults(path, text, revision)
    rows = bom.rows_from_csv(files[bill])
    solids, meant = (
        len(re.findall("=NEXT_ASSEMBLY_USAGE_OCCURRENCE\\(", text)),
        sum(r.qty for r in rows if r.has_solid),
    )
    if solids != meant:
        yield f"{path}: {solids} solids, {bill} has {meant:g}"
    for row in rows:
        if row.make_buy == "make" and row.rev != revision:
            yield f"{bill}: {row.part_no} is of revision {row.rev!r}"
        if row.file and sha256_of(files.get(row.file, b"")) != row.sha256:
            yield f"{bill}: {row.file} is not here as it stands there"


def _sheet_faults(files: Mapping[str, bytes], contents: ReleaseContents) -> Iterator[str]:
    """A sheet for every part made and an assembly drawing for every scene: number and revision on every page,
    key characteristics once and with the model's values, the digest of the file that the part is made from,
    balloons and parts list as the bill has them; PRELIMINARY on every page of a draft and on none of a
    release."""
    design, revision = contents.design, contents.design.design.revision
    for part in contents.made:
        path = f"pdf/{part.part_no}_{revision}.pdf"
        pages = _pages(files, path)
        if len(pages) != 1:
            yield f"{path}: {len(pages)} pages instead of 1"
            continue
        yield from (f"{path}: {t!r} is missing" for t in (part.part_no, revision) if t not in pages[0])
        yield from (
            f"{path}: {fault}" for fault in key_faults(pages[0], [c for c in part.characteristics if c.key])
        )
        source = (
            f"dxf/{part.part_no}_{revision}.dxf"
            if part.process == "wire-cut"
            else f"step/{part.part_no}_{revision}.step"
        )
        if sha256_of(files.get(source, b"")) not in "".join(pages[0]).replace(" ", ""):
            yield f"{path}: does not have the SHA-256 of {source}"
        yield from _page_faults(path, pages, contents)
    for scene in contents.scenes:
        path = f"pdf/{design.name}-{scene.name}_{revision}.pdf"
        rows = bom.rows_from_csv(files[bill_of(scene)]) if bill_of(scene) in files else ()
        pages = _pages(files, path)
        faults = (
            assembly_faults(files[path], f"{design.name}-{scene.name}", revision, rows)
            if pages
            else ["missing"]
        )
        yield from (f"{path}: {fault}" for fault in faults)
        yield from _page_faults(path, pages, contents)


def _guide_faults(files: Mapping[str, bytes], contents: ReleaseContents) -> Iterator[str]:
    """A guide for every scene, of this revision, with every picture that it shows."""
    revision = contents.design.design.revision
    for scene in contents.scenes:
        path = page_path(scene)
        if path not in files:
            yield f"{path}: missing"
            continue
        page = files[path].decode()
        if f"revision {revision}," not in page:
            yield f"{path}: does not name revision {revision}"
        for picture in re.findall(r'<img src="([^"]+)"', page):
            if f"guide/{picture}" not in files:
                yield f"{path}: its picture {picture} is missing"


def _pages(files: Mapping[str, bytes], path: str) -> list[list[str]]:
    """Texts of a PDF's pages; none where it is absent or cannot be read."""
    from pypdf.errors import PyPdfError

    try:
        return pdf_runs(files[path]) if path in files else []
    except (PyPdfError, ValueError):
        return []


def _page_faults(path: str, pages: Sequence[Sequence[str]], contents: ReleaseContents) -> Iterator[str]:
    """PRELIMINARY, the sample's status and the legal owner stand on every page where they belong."""
    owner = contents.design.design.organisation
    for n, runs in enumerate(pages, start=1):
        text = _flat("".join(runs))
        if (MARK in runs) != contents.draft:
            yield f"{path}, sheet {n}: {'without' if contents.draft else 'with'} {MARK}"
        if (_flat(STATUS) in text) != contents.sample:
            yield f"{path}, sheet {n}: {'without' if contents.sample else 'with'} {STATUS!r}"
        if owner and _flat(owner) not in text:
            yield f"{path}, sheet {n}: does not name the legal owner"


def _flat(text: str) -> str:
    """Without spaces, since a cell of the title block breaks its text into lines."""
    return re.sub(r"\s", "", text)


def bill_of(scene: Scene) -> str:
    return "bom.csv" if scene.name == "array" else f"bom-{scene.name}.csv"


def _table_faults(files: Mapping[str, bytes], contents: ReleaseContents) -> Iterator[str]:
    identity = contents.design.design
    for name in (inspection.NAME, strength.NAME):
        rows = table_rows(files.get(name, b""))
        if {(row["design"], row["revision"]) for row in rows} != {(identity.name, identity.revision)}:
            yield f"{name}: not of {identity.name} revision {identity.revision} alone"
    if (
        f"{identity.name}, revision {identity.revision}:"
        not in files.get(README, b"").decode().splitlines()[0]
    ):
        yield f"{README}: does not name {identity.name} revision {identity.revision} in its first line"


def mark_faults(files: Mapping[str, bytes], contents: ReleaseContents) -> Iterator[str]:
    """A draft's README says that it is one, a release's does not; and so of a sample."""
    said = files.get(README, b"").decode().splitlines()
    for kind, mark, meant in (("draft", DRAFT, contents.draft), ("sample", SAMPLE, contents.sample)):
        if (mark in said) != meant:
            yield f"{README}: {'does not say' if meant else 'says'} that it is a {kind}"
