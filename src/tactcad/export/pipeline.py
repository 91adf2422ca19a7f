"""Export of a design: every file of its scenes, made once, checked, and published in one step."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from tactcad.design.family import family_of
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import CommonTables

from . import manifest as manifests
from .cache import Cache, default_root
from .formats import ExportOptions, part_formats
from .inputs import Inputs, digest, first_installed, inputs_from_json, inputs_of, reasons
from .manifest import Contents, FileRecord, Manifest, PartRecord
from .publication import REFUSE, left_unfinished, looked_at, replacing
from .shapes import Shapes
from .workers import Task, relayed, side_by_side

if TYPE_CHECKING:
    from tactcad.parts.language.description import Part
    from tactcad.scenes.scene import Scene

    from .products import Batch, Output, Plan

# Rooms and libraries that an exported file may depend on: a change in any of them rebuilds.
ROOMS = ("", *"design contour mechanics parts scenes stacks circuit solids drawing export families".split())
# The kernel's binding comes with VTK or, in the extra `cad` of PyPI, without; in a checkout the second is an
# empty replacement of the first.
KERNEL = first_installed("cadquery-ocp", "cadquery-ocp-novtk")
LIBRARIES = ("build123d", KERNEL, "ezdxf", "numpy", "scipy")
DRAWN_WITH = ("matplotlib", "reportlab")  # for drawings: font and PDF
FOR_ROBOTS = ("contact", "lab", "robot")  # further rooms for robots' files
# Kinds of files that parts are ordered by, the one that the bill names last.
ORDERED = [form.kind for form in sorted(part_formats(), key=lambda form: form.ordered) if form.ordered]


class Progress(Protocol):
    """Receives the messages of an export."""

    def line(self, text: str) -> None:
        """A line that is kept on a terminal."""

    def step(self, done: int, total: int, text: str) -> None:
        """`done` of `total` pieces of work are finished; `text` is the next one."""


class Quiet:
    """Progress that nobody watches: of a worker, or in a notebook."""

    def line(self, text: str) -> None:
        pass

    def step(self, done: int, total: int, text: str) -> None:
        pass


@dataclass(frozen=True)
class Exported:
    """Result of an export: its folder, how many files it holds, which were made anew, which parts the kernel
    built, and why (empty if nothing had changed).
    """

    folder: Path
    files: int
    made: tuple[str, ...]
    built: tuple[str, ...]
    reasons: tuple[str, ...]


def export(
    design: CommonTables, options: ExportOptions, out: str | Path, progress: Progress, others: str = REFUSE
) -> Exported:
    """Write a design's scenes to a folder, all or nothing.

    Nothing is written if the folder already holds exactly this export; the rules between fields, which the
    earlier export kept, are tried only if something has to be made.

    Parameters
    ----------
    design
        Read field by field.
    options
        Scenes, pose, detail, and additional products.
    out
        The folder.
    progress
        Receives each task and its reason.
    others
        What to do with files in the folder that tactcad did not write (publication.py).

    Returns
    -------
    Exported
        The files made, and why; none if nothing had changed.

    Raises
    ------
    InputError
        If the design breaks a rule, or `out` may not be replaced or cannot be written.
    CheckFailure
        If a file does not read back as it should, or if something in `out` had changed meanwhile and was
        kept.
    """
    inputs = inputs_of(
        {"design": design, "options": options},
        ROOMS + (FOR_ROBOTS if options.robot else ()),
        LIBRARIES + (DRAWN_WITH if options.drawings else ()),
    )
    earlier = looked_at(out, manifests.SCHEMA, others)
    why = _reasons(earlier, inputs)
    if why:
        from tactcad.parts.rules import refuse_broken  # loads numpy: not needed if nothing changed

        refuse_broken(design)  # before anything is written to the disk
    elif not left_unfinished(out):
        return _unchanged(out, earlier, progress)
    cache = Cache(default_root(), relayed(progress.line))
    with replacing(out, manifests.SCHEMA, others, progress.line) as work:
        why = _reasons(work.earlier, inputs)
        if not why:
            return _unchanged(out, work.earlier, progress)
        for reason in why:
            progress.line(f"{out}: {reason}")
        shapes = Shapes(cache, digest((inputs.sources, inputs.libraries)))
        count, taken, made = _rebuild(design, options, work.folder, shapes, inputs, progress)
    cache.trim()
    progress.line(f"{out}: {count} files, {len(made)} made, {taken} taken from the cache")
    return Exported(Path(out), count, made, tuple(shapes.built), tuple(why))


def _unchanged(out: str | Path, earlier: Contents, progress: Progress) -> Exported:
    assert earlier.record  # otherwise there would have been reasons
    count = len(earlier.record["files"]) + 1
    progress.line(f"{out}: nothing changed, {count} files are up to date; nothing was rebuilt")
    return Exported(Path(out), count, (), (), ())


def _reasons(earlier: Contents, now: Inputs) -> list[str]:
    """Why the export has to be made anew; empty if it need not."""
    wrong = [f"{path}: {why}" for path, why in earlier.foreign.items()]
    wrong += [f"{path}: missing" for path in earlier.missing]
    if wrong:
        return [f"the earlier export was altered: {wrong[0]}"]
    if earlier.record is None:
        return ["there is no earlier export"]
    return reasons(inputs_from_json(earlier.record.get("inputs")), now)


def _rebuild(
    design: CommonTables,
    options: ExportOptions,
    folder: Path,
    shapes: Shapes,
    inputs: Inputs,
    progress: Progress,
) -> tuple[int, int, tuple[str, ...]]:
    """Number of all files, and of those taken from the cache; and those made."""
    from tactcad.scenes import make_scene
    from tactcad.scenes.scene import at_detail

    from .products import Plan

    scenes = [at_detail(make_scene(design, name, options.pose), options.detail) for name in options.scenes]
    plan = Plan(design, options, scenes, shapes)
    jobs = plan.jobs()
    made = _write_products(folder, plan, jobs, progress)
    products = [file for job in jobs for file in job.files]
    records = [_record(folder, file, design) for file in products]
    records += _write_bills(folder, design, scenes, records)
    records += _write_element_tables(folder, design)
    part_records = tuple(_part_record(part, plan) for part in plan.parts)
    record = Manifest(design.name, design.design.revision, tuple(records), part_records, inputs.as_json())
    (folder / manifests.NAME).write_bytes(manifests.manifest_bytes(record))
    wrong = manifests.check_manifest(folder)
    if wrong:
        raise CheckFailure(f"the finished export does not hold: {'; '.join(wrong)}")
    return len(records) + 1, len(products) - len(made), made


def _write_products(folder: Path, plan: Plan, jobs: Sequence[Batch], progress: Progress) -> tuple[str, ...]:
    """Write every file's bytes, from the cache if it has them; returns the paths that were made anew."""
    made = set()
    for file, data, anew in made_files(plan, jobs, progress.step, progress.line):
        path = folder / file.path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
        if anew:
            made.add(file.path)
    return tuple(file.path for job in jobs for file in job.files if file.path in made)


def made_files(
    plan: Plan, jobs: Sequence[Batch], step: Callable[[int, int, str], None], say: Callable[[str], None]
) -> Iterator[tuple[Output, bytes, bool]]:
    """Every file of the jobs, its bytes, and whether they were made anew; what the cache holds comes first.

    Parameters
    ----------
    plan
        That the jobs are of.
    jobs
        Made in parallel (workers.py), after the solids that they need.
    step, say
        Receive done, total and current task; and lines to keep.
    """
    cache, shapes = plan.shapes.cache, plan.shapes
    total, done, missing = sum(len(job.files) for job in jobs), 0, []
    for job in jobs:
        data = [cache.get(file.key) for file in job.files]
        if any(each is None for each in data):
            missing.append(job)
            continue
        for file, content in zip(job.files, data):
            step(done, total, f"{file.path} (kept)")
            done += 1
            yield file, content or b"", False
    if missing:
        from .products import solid

        # Load the kernel, and what works with it, once for all processes, and end its threads.
        for module in ("solids.build", "solids.step", "drawing.parts.solid_views", "drawing.engine.picture"):
            import_module(f"tactcad.{module}")
        import_module("tactcad.solids.occt").end_threads()
        solids = [Task(f"solid of {part.part_no}", partial(solid, part, shapes)) for part in plan.parts]
        missing.sort(key=lambda job: -job.size)
        tasks = [*solids, *(Task(job.files[0].path, job.make, job.turn) for job in missing)]
        hear = lambda text: step(done, total, text)  # noqa: E731
        with closing(side_by_side(tasks, hear, say)) as ready:
            for n, result in ready:
                if n < len(solids):
                    shapes.built += [plan.parts[n].part_no] * result
                    continue
                for file, content in zip(missing[n - len(solids)].files, result):
                    cache.put(file.key, content)
                    done += 1
                    yield file, content, True
    step(total, total, "done")


def _record(folder: Path, product: Output, design: CommonTables) -> FileRecord:
    sha256 = manifests.sha256_of((folder / product.path).read_bytes())
    of_board = product.kind in ("board", "gerber")
    of = design.design.of_part(design.design.board_no if of_board else product.part_no)
    return FileRecord(product.path, product.kind, product.part_no, of.revision, sha256)


def _write_bills(
    folder: Path, design: CommonTables, scenes: Sequence[Scene], records: Sequence[FileRecord]
) -> list[FileRecord]:
    """A bill of materials a scene as CSV and JSON: bom.csv for the array, bom-NAME.csv for other scenes."""
    from tactcad.scenes import bom

    revision, soldered = design.design.revision, _soldered(design)
    files = {r.part_no: (r.path, r.sha256) for kind in ORDERED for r in records if r.kind == kind}
    written = []
    for scene in scenes:
        rows = bom.bom_rows(scene, design.design, files)
        if scene.name == "array":
            rows = tuple(replace(r, designators=soldered.get(r.part_no, r.designators)) for r in rows)
        as_csv, as_json = bom.csv_bytes(rows), bom.json_bytes(rows, design.name, revision, scene.name)
        wrong = bom.check_bom(scene, as_csv, as_json)
        if wrong:
            raise CheckFailure(f"bill of materials of {scene.name}: {'; '.join(wrong)}")
        stem = "bom" if scene.name == "array" else f"bom-{scene.name}"
        for path, data in ((f"{stem}.csv", as_csv), (f"{stem}.json", as_json)):
            (folder / path).write_bytes(data)
            written.append(FileRecord(path, "bom", "", revision, manifests.sha256_of(data)))
    return written


def _soldered(design: CommonTables) -> dict[str, str]:
    """Designators of the array's circuit by part number, without its leads, which the bill has in metres."""
    family = family_of(design)
    if family.readout is None:
        return {}
    circuit = family.must("readout", "export").netlist(family.layout(design))
    parts = [c for c in circuit.components if c.fitted and c.kind != "lead"]
    return {p.part_no: " ".join(c.designator for c in parts if c.part_no == p.part_no) for p in parts}


def _write_element_tables(folder: Path, design: CommonTables) -> list[FileRecord]:
    """The inspection sheet to fill in, and the strength summary: tables of the numbered elements."""
    from . import inspection
    from . import strength_table as strength

    family, written = family_of(design), []
    layout = family.layout(design)
    for path, kind, data in (
        (inspection.NAME, "inspection", inspection.inspection_bytes(layout)),
        (strength.NAME, "report", family.estimate.strength(layout)),
    ):
        (folder / path).write_bytes(data)
        written.append(FileRecord(path, kind, "", design.design.revision, manifests.sha256_of(data)))
    return written


def _part_record(part: Part, plan: Plan) -> PartRecord:
    from tactcad.parts.language.stock import cut_section

    from .products import part_facts

    facts = part_facts(part, plan.shapes)
    low, high = facts["box"]
    cut = cut_section(part)
    return PartRecord(
        part_no=part.part_no,
        name=part.name,
        process=part.process,
        qty=max(scene.count(part) for scene in plan.scenes),
        volume_mm3=facts["volume"],
        area_mm2=facts["area"],
        mass_g=part.mass,
        centre_mm=tuple(facts["centre"]),
        box_mm=(tuple(low), tuple(high)),
        cut_length_mm=cut.cut_length if cut else None,
        section_area_mm2=cut.section_area if cut else None,
    )
