"""What a release must hold: every file as it was exported, where it was read back and compared with its part;
every file that a bill or a guide names; and zips that are what was packed, byte for byte."""

from __future__ import annotations

import re
import zipfile
import zlib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from tactcad.drawing.guide import page_path
from tactcad.export import inspection
from tactcad.export import strength_table as strength
from tactcad.export.formats import has_limits
from tactcad.export.manifest import sha256_of
from tactcad.parts.language.description import NOT_ORDERED
from tactcad.parts.language.stock import cut_section
from tactcad.scenes import bom
from tactcad.scenes.scene import Scene

from .archive import MANIFEST, MODE, checksums
from .packages import ORDER, SHEET, Packed, table_rows
from .readme import DRAFT, SAMPLE
from .release_contents import ReleaseContents

README = "README.txt"


def read_back(path: Path, packed: Mapping[str, bytes]) -> list[str]:
    """Faults of a written zip: entries other than what was packed and its checksums, or of another date or
    other permissions than the rest."""
    wrong, found = [], Counter[str]()
    expected = {**packed, MANIFEST: checksums(packed)}
    try:
        with zipfile.ZipFile(path) as archive:
            entries = archive.infolist()
            for e in entries:
                found[e.filename] += 1
                try:
                    if archive.read(e) != expected.get(e.filename):
                        wrong.append(f"{e.filename}: not as it was packed")
                except zipfile.BadZipFile:
                    return [f"{e.filename}: damaged"]
                if e.external_attr >> 16 != MODE or e.date_time != entries[0].date_time:
                    wrong.append(f"{e.filename}: another date or other permissions than the rest")
    except (zipfile.BadZipFile, zlib.error, EOFError, OSError, NotImplementedError, RuntimeError) as error:
        return [f"not readable as a zip: {error}"]
    wrong += [f"{name}: appears twice" for name, count in found.items() if count > 1]
    return wrong + [f"{name}: missing" for name in expected if name not in found]


def check_contents(
    files: Mapping[str, bytes], exported: Mapping[str, str], contents: ReleaseContents
) -> list[str]:
    """Faults of the whole zip's files.

    Parameters
    ----------
    files
        By path in the zip.
    exported
        SHA-256 of those that were exported, as the export's manifest has them.
    contents
        What the release is about.
    """
    needed = [*_expected(contents), *(path for scene in contents.scenes for path in _shown(files, scene))]
    wrong = [f"{path}: missing" for path in dict.fromkeys(needed) if path not in files]
    changed = (path for path, digest in exported.items() if sha256_of(files.get(path, b"")) != digest)
    wrong += [f"{path}: not as it was exported" for path in changed]
    for bill in (bill_of(scene) for scene in contents.scenes):
        for row in bom.rows_from_csv(files[bill]) if bill in files else ():
            if row.file and sha256_of(files.get(row.file, b"")) != row.sha256:
                wrong.append(f"{bill}: {row.file} is missing or differs from the bill")
    return wrong + readme_faults(files.get(README, b""), contents, contents.design.design.title)


def _expected(contents: ReleaseContents) -> Iterator[str]:
    """Solid, model with limits, cut file and sheet of a part; solid, sheet, bill and guide of a scene; the
    tables."""
    identity, made = contents.design.design, contents.made
    for part in {p.part_no: p for scene in contents.scenes for p in scene.parts}.values():
        stem = f"{part.part_no}_{identity.of_part(part.part_no).revision}"
        yield f"step/{stem}.step"
        if has_limits(part):
            yield f"step/{stem}-ap242.step"
        if cut_section(part) is not None:
            yield f"dxf/{stem}.dxf"
        if part in made:
            yield f"pdf/{stem}.pdf"
    for scene in contents.scenes:
        stem = f"{identity.name}-{scene.name}_{identity.revision}"
        yield from (f"step/{stem}.step", f"pdf/{stem}.pdf", bill_of(scene), page_path(scene))
    yield from (inspection.NAME, strength.NAME)


def _shown(files: Mapping[str, bytes], scene: Scene) -> list[str]:
    """The pictures in a scene's guide."""
    page = files.get(page_path(scene), b"").decode()
    return [f"guide/{picture}" for picture in re.findall(r'<img src="([^"]+)"', page)]


def bill_of(scene: Scene) -> str:
    return "bom.csv" if scene.name == "array" else f"bom-{scene.name}.csv"


def readme_faults(readme: bytes, contents: ReleaseContents, title: str) -> list[str]:
    """The first line names design, revision and title; a draft is marked as one, a release is not; likewise a
    sample."""
    said, identity = readme.decode().splitlines(), contents.design.design
    first = f"{identity.name}, revision {identity.revision}: {title}"
    wrong = [] if said[:1] == [first] else [f"{README}: its first line is not {first!r}"]
    for kind, mark, meant in (("draft", DRAFT, contents.draft), ("sample", SAMPLE, contents.sample)):
        if (mark in said) != meant:
            wrong.append(f"{README}: {'does not say' if meant else 'says'} that it is a {kind}")
    return wrong


def check_packages(
    packages: Sequence[Packed],
    readmes: Sequence[bytes],
    files: Mapping[str, bytes],
    contents: ReleaseContents,
) -> list[str]:
    """Faults of the suppliers' packages, each with its README, out of the whole zip's files: every line of
    the bills is in one package, once, with at least the largest set-up's quantity (for one set exactly that),
    and its spares."""
    wrong, orders = [], []
    for one, readme in zip(packages, readmes, strict=True):
        faults = readme_faults(readme, contents, one.package.title)
        wrong += [f"{one.package.name}: {fault}" for fault in faults]
        if one.package is not SHEET:  # its lines are made by others
            orders += table_rows(one.files[ORDER])
    needed: dict[str, float] = {}
    spares: dict[str, float] = {}
    for scene in contents.scenes:
        for row in bom.rows_from_csv(files[bill_of(scene)]):
            if row.process not in NOT_ORDERED:
                needed[row.part_no] = max(needed.get(row.part_no, 0.0), row.qty)
                spares[row.part_no] = row.spares
    counts = Counter(row["part_no"] for row in orders)
    wrong += [f"{n} of the bills is in {counts[n]} packages" for n in needed if counts[n] != 1]
    wrong += [f"{n} of an order is in no bill" for n in counts if n not in needed]
    for line in orders:
        number, qty = line["part_no"], float(line["qty"])
        least = needed.get(number, 0.0)
        if qty < least or (contents.sets == "one" and qty != least):
            wrong.append(f"{number}: {qty:g} ordered, {least:g} needed")
        if float(line["order"]) != round(qty + spares.get(number, 0.0), 6):
            wrong.append(
                f"{number}: {line['order']} with spares, not {qty:g} and {spares.get(number, 0.0):g}"
            )
    return wrong
