"""Reads a release back, and reports how the zip differs from the design, and the suppliers' packages from
the zip."""

from __future__ import annotations

import re
import zipfile
import zlib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path, PurePosixPath

from tactcad.drawing.assemblies.assembly_sheets import assembly_faults
from tactcad.drawing.engine.paper import SAMPLE as STATUS
from tactcad.drawing.engine.sheet_files import pdf_runs
from tactcad.drawing.guide import page_path
from tactcad.drawing.parts.part_sheet import key_faults
from tactcad.export import inspection
from tactcad.export import strength_table as strength
from tactcad.export.contents import sha256_of
from tactcad.export.dxf import check_dxf
from tactcad.export.formats import has_limits, part_formats
from tactcad.parts.language.description import NOT_ORDERED, Part
from tactcad.parts.language.stock import cut_section
from tactcad.scenes import bom
from tactcad.scenes.scene import Scene

from .archive import MANIFEST, MODE
from .packages import ORDER, PART_INSPECTION, SHEET, Packed, table_rows
from .readme import DRAFT, MARK, SAMPLE
from .release_contents import ReleaseContents

README = "README.txt"
AP242 = "-ap242"  # ends the name of a model with limits


def check_archive(files: Mapping[str, bytes], contents: ReleaseContents) -> list[str]:
    """Faults of the whole zip's files (`read_back`)."""
    return [
        *_part_faults(files, contents),
        *(fault for scene in contents.scenes for fault in _scene_faults(files, contents, scene)),
        *_sheet_faults(files, contents),
        *_guide_faults(files, contents),
        *_table_faults(files, contents),
        *mark_faults(files, contents),
    ]


def read_back(path: Path, exported: Mapping[str, str] | None = None) -> tuple[dict[str, bytes], list[str]]:
    """The zip's files, each verified once by its checksum, and the faults of form and checksums.

    `exported`: checksums of files that have to be as an export's manifest lists them.
    """
    files: dict[str, bytes] = {}
    try:
        with zipfile.ZipFile(path) as archive:
            for name in archive.namelist():
                try:
                    files[name] = archive.read(name)
                except zipfile.BadZipFile:
                    return {}, [f"{name}: damaged"]
            return files, [*_form_faults(archive.infolist()), *_checksum_faults(files, exported or {})]
    except (zipfile.BadZipFile, zlib.error, EOFError, OSError, NotImplementedError, RuntimeError) as error:
        return {}, [f"not readable as a zip: {error}"]


def _form_faults(entries: Sequence[zipfile.ZipInfo]) -> list[str]:
    names = [e.filename for e in entries]
    wrong = [f"{name}: appears twice" for name, count in Counter(names).items() if count > 1]
    for e in entries:
        if PurePosixPath(e.filename).is_absolute() or ".." in PurePosixPath(e.filename).parts:
            wrong.append(f"{e.filename}: leads out of the folder")
        if e.external_attr >> 16 != MODE or e.date_time != entries[0].date_time:
            wrong.append(f"{e.filename}: another date or other permissions than the rest")
    return wrong


def _checksums(files: Mapping[str, bytes]) -> dict[str, str]:
    """SHA-256 by path, as the zip's own list has them, which `read_back` has verified."""
    lines = files[MANIFEST].decode().splitlines()
    return {path: digest for digest, _, path in (line.partition("  ") for line in lines)}


def _checksum_faults(files: Mapping[str, bytes], exported: Mapping[str, str]) -> list[str]:
    if MANIFEST not in files:
        return [f"no {MANIFEST}"]
    listed = _checksums(files)
    wrong = [f"{path}: not in {MANIFEST}" for path in files if path != MANIFEST and path not in listed]
    for path, digest in listed.items():
        if path not in files or sha256_of(files[path]) != digest:
            wrong.append(f"{path}: not as {MANIFEST} has it")
    changed = (path for path, digest in exported.items() if listed.get(path) != digest)
    return wrong + [f"{path}: not as it was exported" for path in changed]


def _part_faults(files: Mapping[str, bytes], contents: ReleaseContents) -> Iterator[str]:
    """One STEP file of one solid a part, one more a part with limits, one cut file a part that is cut from
    sheet or plate; their names and headers name its revision."""
    identity = contents.design.design
    parts = {p.part_no: p for scene in contents.scenes for p in scene.parts}
    for part in parts.values():
        revision = identity.of_part(part.part_no).revision
        yield from _step_part_faults(files, f"step/{part.part_no}_{revision}.step", revision)
        if has_limits(part):
            yield from _step_part_faults(files, f"step/{part.part_no}_{revision}{AP242}.step", revision)
        if cut_section(part) is not None:
            yield from _dxf_faults(files, f"dxf/{part.part_no}_{revision}.dxf", part)
    for folder in sorted({"pdf/", *(form.folder for form in part_formats() if form.released)}):
        for path in files:
            number, _, letter = PurePosixPath(path).stem.removesuffix(AP242).rpartition("_")
            if path.startswith(folder) and letter != (own := identity.of_part(number).revision):
                yield f"{path}: its name does not end in revision {own}"
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
    """The assembly has as many solids as its bill, the bill's files are present with its digests, and it has
    the revision."""
    revision = contents.design.design.revision
    path = f"step/{contents.design.name}-{scene.name}_{revision}.step"
    bill = bill_of(scene)
    if path not in files or bill not in files:
        yield f"{path} or {bill}: missing"
        return
    text = files[path].decode("ascii")
    yield from _header_faults(path, text, revision)
    rows = bom.rows_from_csv(files[bill])
    solids = len(re.findall("=NEXT_ASSEMBLY_USAGE_OCCURRENCE\\(", text))
    meant = sum(r.qty for r in rows if r.has_solid)
    if solids != meant:
        yield f"{path}: {solids} solids, {bill} has {meant:g}"
    for row in rows:
        if row.make_buy == "make" and row.rev != contents.design.design.of_part(row.part_no).revision:
            yield f"{bill}: {row.part_no} is of revision {row.rev!r}"
        if row.file and _checksums(files).get(row.file) != row.sha256:
            yield f"{bill}: {row.file} is missing or differs from the bill"


def _sheet_faults(files: Mapping[str, bytes], contents: ReleaseContents) -> Iterator[str]:
    """A sheet for every part made and an assembly drawing for every scene: number and revision on every page,
    key characteristics once and with the model's values, the digest of the file that the part is made from,
    balloons and parts list as in the bill; PRELIMINARY on every page of a draft and on none of a release."""
    design = contents.design
    for part in contents.made:
        revision = design.design.of_part(part.part_no).revision
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
            if part.by_contour
            else f"step/{part.part_no}_{revision}.step"
        )
        if _checksums(files).get(source, "no file") not in "".join(pages[0]).replace(" ", ""):
            yield f"{path}: does not have the SHA-256 of {source}"
        yield from _page_faults(path, pages, contents)
    revision = design.design.revision
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
    """Texts of a PDF's pages; none if it is absent or cannot be read."""
    from pypdf.errors import PyPdfError

    try:
        return pdf_runs(files[path]) if path in files else []
    except (PyPdfError, ValueError):
        return []


def _page_faults(path: str, pages: Sequence[Sequence[str]], contents: ReleaseContents) -> Iterator[str]:
    """PRELIMINARY, the sample's status and the legal owner are on every page that needs them."""
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
    for name in (inspection.NAME, PART_INSPECTION, strength.NAME):
        if name not in files and name != PART_INSPECTION:
            yield f"{name}: missing"
        for row in table_rows(files.get(name, b"")):
            of = identity if name == strength.NAME else identity.of_part(row["part_no"])
            if (row["design"], row["revision"]) != (of.name, of.revision):
                yield f"{name}: a row of {row['design']} revision {row['revision']}"
    if (
        f"{identity.name}, revision {identity.revision}:"
        not in files.get(README, b"").decode().splitlines()[0]
    ):
        yield f"{README}: does not name {identity.name} revision {identity.revision} in its first line"


def mark_faults(files: Mapping[str, bytes], contents: ReleaseContents) -> Iterator[str]:
    """A draft's README is marked as one, a release's is not; likewise a sample's."""
    said = files.get(README, b"").decode().splitlines()
    for kind, mark, meant in (("draft", DRAFT, contents.draft), ("sample", SAMPLE, contents.sample)):
        if (mark in said) != meant:
            yield f"{README}: {'does not say' if meant else 'says'} that it is a {kind}"


OWN = (README, MANIFEST, ORDER, PART_INSPECTION, inspection.NAME)


def check_packages(
    paths: Sequence[Path], packages: Sequence[Packed], every: Mapping[str, bytes], contents: ReleaseContents
) -> list[str]:
    """Faults of the written packages.

    Parameters
    ----------
    paths, packages
        The written zips, and what they are to hold, in the same order.
    every
        The whole zip's files, found right.
    contents
        What the release is about.
    """
    wrong, orders = [], []
    for path, one in zip(paths, packages, strict=True):
        files, faults = read_back(path)
        faults = faults or [*_package_faults(files, every, one, contents)]
        wrong += [f"{one.package.name}: {fault}" for fault in faults]
        if one.package is not SHEET and ORDER in files:  # its lines are made by others
            orders += table_rows(files[ORDER])
    return wrong or [*_order_faults(orders, every, contents)]


def _package_faults(
    files: Mapping[str, bytes], every: Mapping[str, bytes], one: Packed, contents: ReleaseContents
) -> Iterator[str]:
    """Faults of a package: files as in the whole zip, named by a line of the order, and every file that a
    line names."""
    named = dict(_named(files.get(ORDER, b"")))
    for path, data in files.items():
        if path in OWN:
            continue
        if data != every.get(path):
            yield f"{path}: not as in the whole zip"
        if path not in named:
            yield f"{path}: no line of {ORDER} names it"
    for path, digest in named.items():
        if _checksums(files).get(path) != digest:
            yield f"{path}: not here as {ORDER} has it"
    if inspection.NAME in files and files[inspection.NAME] != every.get(inspection.NAME):
        yield f"{inspection.NAME}: not as in the whole zip"
    listed = table_rows(every.get(PART_INSPECTION, b""))
    yield from (
        f"{PART_INSPECTION}: {row['part_no']}: not as in the whole zip"
        for row in table_rows(files.get(PART_INSPECTION, b""))
        if row not in listed
    )
    identity = contents.design.design
    title = f"{identity.name}, revision {identity.revision}: {one.package.title}"
    if files.get(README, b"").decode().splitlines()[:1] != [title]:
        yield f"{README}: its first line is not {title!r}"
    yield from mark_faults(files, contents)


def _named(order: bytes) -> Iterator[tuple[str, str]]:
    for row in table_rows(order):
        for name, path in row.items():
            if path and f"{name}_sha256" in row:
                yield path, row[f"{name}_sha256"]


def _order_faults(
    orders: Sequence[Mapping[str, str]], every: Mapping[str, bytes], contents: ReleaseContents
) -> Iterator[str]:
    """Every line of the bills is in one package, once, with at least the largest set-up's quantity (for one
    set exactly that), and its spares."""
    needed: dict[str, float] = {}
    spares: dict[str, float] = {}
    for scene in contents.scenes:
        for row in bom.rows_from_csv(every[bill_of(scene)]):
            if row.process not in NOT_ORDERED:
                needed[row.part_no] = max(needed.get(row.part_no, 0.0), row.qty)
                spares[row.part_no] = row.spares
    counts = Counter(row["part_no"] for row in orders)
    yield from (f"{n} of the bills is in {counts[n]} packages" for n in needed if counts[n] != 1)
    yield from (f"{n} of an order is in no bill" for n in counts if n not in needed)
    for line in orders:
        number, qty = line["part_no"], float(line["qty"])
        least = needed.get(number, 0.0)
        if qty < least or (contents.sets == "one" and qty != least):
            yield f"{number}: {qty:g} ordered, {least:g} needed"
        if float(line["order"]) != round(qty + spares.get(number, 0.0), 6):
            yield f"{number}: {line['order']} with spares, not {qty:g} and {spares.get(number, 0.0):g}"
