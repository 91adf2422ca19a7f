"""Make a release: checks, golden file, export, zip, read back, and only then its name."""

from __future__ import annotations

import secrets
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tactcad.checks.check_report import Report
from tactcad.checks.goes_together import check_assembly
from tactcad.design.files import make_folder, refuse_overwriting, scratch_folder, whole_file
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.export.golden_file import check_golden, golden_path
from tactcad.export.manifest import FileRecord, read_manifest
from tactcad.export.pipeline import ExportOptions, Progress, export
from tactcad.scenes import make_scene, scene_names

from .archive import archive_bytes, refuse_what_is_no_zip, replaced_content
from .readme import MARK, ReleaseContents, readme_bytes
from .verify import README, check_archive

QUOTED = ("wire-cut", "machining")  # checks whose flags are reported to the shop


@dataclass(frozen=True)
class Released:
    """Result of a release: the zip, whether it is a draft, how many files it holds, failures (drafts only),
    and differences from the zip that stood there before.
    """

    path: Path
    design: str
    revision: str
    draft: bool
    files: tuple[str, ...]
    failures: tuple[str, ...]
    replaced: tuple[str, ...]


def release(
    design: Design,
    design_file: Path,
    out: str | Path,
    shop_file: Path,
    progress: Progress,
    draft: bool = False,
) -> Released:
    """Write a design's release, `<design>-<revision>.zip`, or as a draft
    `<design>-<revision>-PRELIMINARY.zip`.

    Parameters
    ----------
    design, design_file
        The design, and the file that it was read from.
    out
        The folder to write to.
    shop_file
        The limits that parts are checked against.
    progress
        Receives what is done, and why nothing is.
    draft
        Continue even where checks fail; the README lists the failures.

    Returns
    -------
    Released
        The zip, its files, and what differs from the one that stood there before.

    Raises
    ------
    CheckFailure
        With nothing written and an older zip as it was, where a check fails, the golden file does not hold
        just this revision, or what was written does not read back.
    InputError
        Where `out` cannot be written, or the zip's place is taken by what is none.
    """
    revision = design.design.revision
    target = Path(out) / f"{design.name}-{revision}{f'-{MARK}' if draft else ''}.zip"
    refuse_overwriting(target, design_file, shop_file)
    refuse_what_is_no_zip(target)
    # the golden file first: it needs no kernel
    failures = golden_faults(design, design_file)
    _refuse(design, failures, draft, progress)
    # beside the published seed, which the checks take, one that nobody could design for
    failures += [str(f) for f in check_assembly(design, seed=secrets.randbelow(2**32))]
    _refuse(design, failures, draft, progress)
    report = _checked(design, shop_file, progress)
    failures += [str(f) for f in report.failures]
    _refuse(design, failures, draft, progress)

    scenes = [make_scene(design, name) for name in scene_names(design)]
    flags = [
        f for case in report.cases if case.check in QUOTED for f in case.findings if f.severity == "flag"
    ]
    contents = ReleaseContents(design, scenes, flags, failures, draft)
    with scratch_folder("release") as folder:
        files = _exported(design, tuple(scene.name for scene in scenes), folder / "export", progress, draft)
    files = {README: readme_bytes(contents, list(files)), **files}
    data = archive_bytes(files, design.design.date)
    make_folder(target.parent)
    with whole_file(target) as part:
        replaced = replaced_content(target, data)
        part.write_bytes(data)
        wrong = check_archive(part, contents)
        if wrong:
            raise CheckFailure(
                f"{target}: the finished release does not hold: {'; '.join(wrong)}; nothing was changed"
            )
    return Released(target, design.name, revision, draft, (*files,), tuple(failures), tuple(replaced))


def golden_faults(design: Design, design_file: Path) -> list[str]:
    """Why the golden file does not allow a release of this revision; empty where it holds just this geometry,
    or where the design stands in no hardware/ and can have none."""
    path = golden_path(design_file, design)
    return [] if path is None else [finding.message for finding in check_golden(design, path)]


class NotReleased(CheckFailure):
    """Why a design was not released: `failures`, a line each."""

    def __init__(self, name: str, failures: Sequence[str]) -> None:
        self.failures = tuple(failures)
        super().__init__(f"{name}: not released, {len(failures)} reasons; nothing was written")


def _refuse(design: Design, failures: Sequence[str], draft: bool, progress: Progress) -> None:
    if failures and not draft:
        for failure in failures:
            progress.line(failure)
        raise NotReleased(design.name, failures)


def _checked(design: Design, shop_file: Path, progress: Progress) -> Report:
    from tactcad.checks.run import run_checks  # loads the kernel

    return run_checks(design, scene_names(design), shop_file, progress.step)


def _exported(
    design: Design, scenes: tuple[str, ...], folder: Path, progress: Progress, draft: bool
) -> dict[str, bytes]:
    """The export's files that go to the shop, by their path in the zip."""
    export(design, ExportOptions(scenes, drawings=True, draft=draft), folder, progress)
    paths = {_path_in_zip(file): file.path for file in read_manifest(folder).files}
    return {name: (folder / path).read_bytes() for name, path in sorted(paths.items()) if name}


def _path_in_zip(file: FileRecord) -> str:
    """Path of an exported file in the zip; "" where it is of no use to a shop."""
    if file.kind in ("dxf", "step-part", "step-assembly", "inspection"):
        return file.path
    if file.kind == "drawing" and file.path.endswith(".pdf"):
        return f"pdf/{Path(file.path).name}"
    return file.path if file.kind in ("bom", "report") and file.path.endswith(".csv") else ""
