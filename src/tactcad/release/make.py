"""Make a release: checks, golden file, export, zip, read back, and only then its name."""

from __future__ import annotations

import secrets
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tactcad.checks.described.goes_together import check_assembly
from tactcad.checks.shop import load_shop
from tactcad.design.files import refuse_overwriting, scratch_folder
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import CommonTables
from tactcad.export.cache import Cache, default_root
from tactcad.export.formats import ExportOptions, part_formats
from tactcad.export.golden_file import check_golden, golden_path
from tactcad.export.kept_checks import checked
from tactcad.export.manifest import FileRecord, read_manifest, sha256_of
from tactcad.export.pipeline import Progress, export
from tactcad.export.publication import REFUSE
from tactcad.scenes import make_scene, scene_names

from .archive import Foreign, archive_bytes, looked_at, replaced_content, replacing
from .packages import PACKAGES, nest_files, packed
from .readme import package_readme, readme_bytes
from .release_contents import ReleaseContents, Sets
from .verify import README, check_contents, check_packages, read_back

QUOTED = ("wire-cut", "machining")  # checks whose flags are reported to the shop


@dataclass(frozen=True)
class Released:
    """Result of a release: the zip, whether it is a draft or a sample, the files that it holds, failures
    (drafts only), differences from the previous zip, and the suppliers' packages.
    """

    path: Path
    design: str
    revision: str
    draft: bool
    files: tuple[str, ...]
    failures: tuple[str, ...]
    replaced: tuple[str, ...]
    sample: bool
    packages: tuple[Path, ...]


@dataclass(frozen=True)
class Terms:
    """Terms of a release: whether a draft (checks may fail), whether a sample (no owner), the number of sets,
    and the treatment of existing zips that are not as tactcad wrote them (places.py)."""

    draft: bool = False
    sample: bool = False
    sets: Sets = "one"
    others: str = REFUSE


def looked_up(
    design: CommonTables, design_file: Path, out: str | Path, shop_file: Path, terms: Terms
) -> tuple[list[Path], Mapping[str, Foreign]]:
    """Places of a release's zips, the whole one's first, and the result of `places.looked_at`."""
    stem = ReleaseContents(design, (), (), (), terms.draft, terms.sample).stem
    places = [Path(out) / f"{stem}{way}.zip" for way in ("", *(f"-{one.name}" for one in PACKAGES))]
    for place in places:
        refuse_overwriting(place, design_file, shop_file)
    return places, looked_at(places, terms.others)


def release(
    design: CommonTables,
    design_file: Path,
    out: str | Path,
    shop_file: Path,
    progress: Progress,
    terms: Terms,
) -> Released:
    """Write a design's release, `<design>-<revision>.zip`, and a zip for each way of making (packages.py),
    `<design>-<revision>-<way>.zip`; the revision is followed by SAMPLE for a sample and by PRELIMINARY for a
    draft.

    Parameters
    ----------
    design, design_file
        The design, with its owner and contact unless a sample, and its file.
    out
        The folder to write to.
    shop_file
        The limits that parts are checked against.
    progress
        Receives each task, and the reason if nothing is done.
    terms
        Draft or not, sample or not, and so on. A draft's README lists the checks that fail.

    Returns
    -------
    Released
        The zip, its files, the differences from the previous one, and the packages.

    Raises
    ------
    CheckFailure
        If a check fails, the golden file does not hold exactly this revision, or a written file does not read
        back; nothing is then written and older zips remain. Otherwise as `places.replacing`.
    InputError
        If `out` cannot be written, or as `places.looked_at`.
    """
    places, foreign = looked_up(design, design_file, out, shop_file, terms)
    scenes = [make_scene(design, name) for name in scene_names(design)]
    # the golden file first: it needs no kernel
    failures = golden_faults(design, design_file)
    _refuse(design, failures, terms.draft, progress)
    # besides the published seed of the checks, one that nobody could design for
    failures += [str(f) for f in check_assembly(design, seed=secrets.randbelow(2**32))]
    _refuse(design, failures, terms.draft, progress)

    cache = Cache(default_root(), progress.line)
    report = checked(design, scene_names(design), cache, shop_file, progress.step)
    failures += [str(f) for f in report.failures]
    _refuse(design, failures, terms.draft, progress)

    flags = [
        f for case in report.cases if case.check in QUOTED for f in case.findings if f.severity == "flag"
    ]
    contents = ReleaseContents(design, scenes, flags, failures, terms.draft, terms.sample, terms.sets)
    with scratch_folder("release") as folder:
        options = ExportOptions(
            tuple(scene.name for scene in scenes),
            guides=True,
            drawings=True,
            draft=terms.draft,
            sample=terms.sample,
        )
        export(design, options, folder / "export", progress)
        chosen = {_path_in_zip(file): file for file in read_manifest(folder / "export").files}
        digests = {path: file.sha256 for path, file in chosen.items() if path}
        files = {path: (folder / "export" / chosen[path].path).read_bytes() for path in sorted(digests)}
    date, shop = design.design.date, load_shop(shop_file)
    files = dict(sorted((files | nest_files(contents, shop)).items()))
    files = {README: readme_bytes(contents, list(files)), **files}
    data = archive_bytes(files, date)
    target = places[0]
    whole = f"{target.name} (SHA-256 {sha256_of(data)})"
    packages = packed(contents, files, shop)
    readmes = [package_readme(contents, one, whole, shop) for one in packages]
    targets = [target.with_stem(f"{target.stem}-{one.package.name}") for one in packages]
    zips = {target: files}
    zips |= {t: {README: readme, **p.files} for t, readme, p in zip(targets, readmes, packages)}
    with replacing(places, foreign, terms.others, progress.line) as folder:
        replaced = [] if target.name in foreign else replaced_content(target, data)
        wrong = check_contents(files, digests, contents) or check_packages(packages, readmes, files, contents)
        for place, content in zips.items():
            (folder / place.name).write_bytes(data if place is target else archive_bytes(content, date))
            wrong += [f"{place.name}: {fault}" for fault in read_back(folder / place.name, content)]
        if wrong:
            raise CheckFailure(
                f"{target}: the finished release does not hold: {'; '.join(wrong)}; nothing was changed"
            )
    return Released(
        target,
        design.name,
        design.design.revision,
        terms.draft,
        (*files,),
        tuple(failures),
        tuple(replaced),
        terms.sample,
        tuple(targets),
    )


def golden_faults(design: CommonTables, design_file: Path) -> list[str]:
    """Why the golden file does not allow a release of this revision; empty if it holds just this content,
    or if the design is in no hardware/, can have none, and keeps no letters."""
    path = golden_path(design_file, design)
    return [finding.message for finding in check_golden(design, path)]


class NotReleased(CheckFailure):
    """Why a design was not released: `failures`, a line each."""

    def __init__(self, name: str, failures: Sequence[str]) -> None:
        self.failures = tuple(failures)
        super().__init__(f"{name}: not released, {len(failures)} reasons; nothing was written")


def _refuse(design: CommonTables, failures: Sequence[str], draft: bool, progress: Progress) -> None:
    if failures and not draft:
        for failure in failures:
            progress.line(failure)
        raise NotReleased(design.name, failures)


def _path_in_zip(file: FileRecord) -> str:
    """Path of an exported file in the zip; "" if it is of no use to a shop or a builder."""
    if file.path.startswith("guide/"):
        return file.path
    parts = {form.kind for form in part_formats() if form.released}
    if file.kind in parts | {"step-assembly", "inspection", "netlist", "wiring", "board", "gerber"}:
        return file.path
    if file.kind == "drawing" and file.path.endswith(".pdf"):
        return f"pdf/{Path(file.path).name}"
    return file.path if file.kind in ("bom", "report") and file.path.endswith(".csv") else ""
