"""Export of a design: every file of its scenes, made once, checked, and published in one step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from tactcad.account import listening
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.solids.meshing import Meshing

from . import manifest as manifests
from .cache import Cache, default_root
from .contents import Contents
from .inputs import Inputs, digest, first_installed, inputs_from_json, inputs_of, reasons
from .manifest import FileRecord, Manifest, PartRecord
from .publication import REFUSE, Work, left_unfinished, looked_at, turn

if TYPE_CHECKING:
    from tactcad.parts.description import Part
    from tactcad.scenes.scene import Pose, Scene

    from .products import Output
    from .shapes import Shapes

# Rooms and libraries that an exported file may depend on: a change in any of them rebuilds.
ROOMS = (
    "",
    "design",
    "contour",
    "mechanics",
    "parts",
    "scenes",
    "assembly",
    "circuit",
    "solids",
    "drawing",
    "export",
)
# The kernel's binding comes with VTK or, as the extra `cad` of PyPI has it, without; in a checkout the second
# is an empty stand-in for the first.
KERNEL = first_installed("cadquery-ocp", "cadquery-ocp-novtk")
LIBRARIES = ("build123d", KERNEL, "ezdxf", "numpy", "scipy")
DRAWN_WITH = ("matplotlib", "reportlab")  # where drawings are asked for: font and PDF


class Progress(Protocol):
    """Receives the messages of an export."""

    def line(self, text: str) -> None:
        """A line that is kept on a terminal."""

    def step(self, done: int, total: int, text: str) -> None:
        """`done` of `total` pieces of work are finished; `text` is the next one."""


@dataclass(frozen=True)
class Exported:
    """Result of an export: its folder, how many files it holds, which were made anew, which parts the kernel
    built, and why (empty where nothing had changed).
    """

    folder: Path
    files: int
    made: tuple[str, ...]
    built: tuple[str, ...]
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class ExportOptions:
    """What of a design is exported, and how. With the design, this is all that an export is made from.

    `pose`: a rig's configuration, None for its rest pose. `guides`: with assembly guides. `detail`: `full` or
    `envelope`. `drawings`: with sheets, marked PRELIMINARY where a `draft`, not for order
    where a `sample`. `meshing`: with the mesh of every part made, as STL, so fine.
    """

    scenes: tuple[str, ...]
    pose: Pose | None = None
    guides: bool = False
    detail: str = "full"
    drawings: bool = False
    draft: bool = False
    sample: bool = False
    meshing: Meshing | None = None


def export(
    design: Design, options: ExportOptions, out: str | Path, progress: Progress, others: str = REFUSE
) -> Exported:
    """Write a design's scenes to a folder, all or nothing.

    Nothing is written where the folder already holds just this; the rules between fields, which the earlier
    export kept, are tried only where something has to be made.

    Parameters
    ----------
    design
        Read field by field.
    options
        Which scenes, in which pose and detail, with what besides.
    out
        The folder.
    progress
        Receives what is done, and why.
    others
        What to do with files in the folder that tactcad did not write (publication.py).

    Returns
    -------
    Exported
        What was made, and why; nothing where nothing had changed.

    Raises
    ------
    InputError
        Where the design breaks a rule, or `out` is not ours to replace or cannot be written.
    CheckFailure
        Where a file does not read back as it should, or where something in `out` had changed meanwhile and
        was kept.
    """
    inputs = inputs_of(
        {"design": design, "options": options}, ROOMS, LIBRARIES + (DRAWN_WITH if options.drawings else ())
    )
    earlier = looked_at(out, manifests.SCHEMA, others)
    why = _reasons(earlier, inputs)
    if why:
        _refuse_broken(design)  # before anything is written to the disk
        if options.drawings:
            _refuse_unprintable(design)
    elif not left_unfinished(out):
        return _unchanged(out, earlier, progress)
    cache = Cache(default_root(), progress.line)
    with turn(out, manifests.SCHEMA, others, progress.line) as work:
        why = _reasons(work.earlier, inputs)
        if not why:
            return _unchanged(out, work.earlier, progress)
        for reason in why:
            progress.line(f"{out}: {reason}")
        return _rebuild(design, options, Path(out), work, cache, inputs, tuple(why), progress)


def _unchanged(out: str | Path, earlier: Contents, progress: Progress) -> Exported:
    assert earlier.record  # otherwise there would have been reasons
    count = len(earlier.record["files"]) + 1
    progress.line(f"{out}: nothing changed, {count} files are up to date; nothing was rebuilt")
    return Exported(Path(out), count, (), (), ())


def _refuse_broken(design: Design) -> None:
    from tactcad.parts.rules import refuse_broken  # loads numpy: not needed where nothing changed

    refuse_broken(design)


def _refuse_unprintable(design: Design) -> None:
    from tactcad.drawing.engine.fonts import refuse_letters_it_lacks

    texts = design.design
    refuse_letters_it_lacks(
        {
            f"design.{name}": getattr(texts, name) or ""
            for name in ("title", "author", "organisation", "revision")
        }
    )


def _reasons(earlier: Contents, now: Inputs) -> list[str]:
    """Why the export has to be made anew; empty where it need not."""
    wrong = [f"{path}: {why}" for path, why in earlier.foreign.items()]
    wrong += [f"{path}: missing" for path in earlier.missing]
    if wrong:
        return [f"the earlier export was altered: {wrong[0]}"]
    if earlier.record is None:
        return ["there is no earlier export"]
    return reasons(inputs_from_json(earlier.record.get("inputs")), now)


def _rebuild(
    design: Design,
    options: ExportOptions,
    out: Path,
    work: Work,
    cache: Cache,
    inputs: Inputs,
    why: tuple[str, ...],
    progress: Progress,
) -> Exported:
    from tactcad.scenes import make_scene
    from tactcad.scenes.detail import at_detail

    from .products import (
        assembly_products,
        circuit_drawing,
        circuit_products,
        drawing_products,
        guide_products,
        mesh_products,
        part_products,
        scene_products,
        stack_products,
    )
    from .shapes import Shapes

    shapes = Shapes(cache, digest((inputs.sources, inputs.libraries)))
    scenes = [at_detail(make_scene(design, name, options.pose), options.detail) for name in options.scenes]
    parts = list({part.part_no: part for s in scenes for part in s.parts}.values())
    products = [p for part in parts for p in part_products(design, part, shapes)]
    if options.meshing:
        products += mesh_products(design, parts, shapes, options.meshing)
    products += [p for s in scenes for p in scene_products(design, s, shapes)]
    products += stack_products(design, options.scenes, shapes)
    products += circuit_products(design, shapes) if "array" in options.scenes else []
    products += [p for s in scenes if options.guides for p in guide_products(design, s, shapes)]
    if options.drawings:
        products += drawing_products(
            design, parts, shapes, products, progress.step, options.draft, options.sample
        )
        products += assembly_products(design, scenes, shapes, progress.step, options.draft, options.sample)
        if "array" in options.scenes:
            products += circuit_drawing(design, shapes, progress.step, options.draft, options.sample)
    folder = work.folder
    made = _write_products(folder, products, cache, progress)
    records = [_record(folder, p, design) for p in products]
    records += _write_bills(folder, design, scenes, records)
    records += _write_element_tables(folder, design)
    part_records = tuple(_part_record(part, scenes, shapes, cache) for part in parts)
    record = Manifest(design.name, design.design.revision, tuple(records), part_records, inputs.as_json())
    (folder / manifests.NAME).write_bytes(manifests.manifest_bytes(record))
    wrong = manifests.check_manifest(folder)
    if wrong:
        raise CheckFailure(f"the finished export does not hold: {'; '.join(wrong)}")
    work.publish()
    cache.trim()
    count = len(records) + 1
    progress.line(f"{out}: {count} files, {len(made)} made, {len(products) - len(made)} taken from the cache")
    return Exported(out, count, made, tuple(shapes.built), why)


def _write_products(
    folder: Path, products: Sequence[Output], cache: Cache, progress: Progress
) -> tuple[str, ...]:
    """Write every product's bytes, from the cache where it has them; returns the paths that were made
    anew."""
    made = []
    for n, product in enumerate(products):
        data = cache.get(product.key)
        progress.step(n, len(products), f"{product.path} ({'kept' if data is not None else 'making'})")
        if data is None:

            def hear(how_far: str, n: int = n, path: str = product.path) -> None:
                progress.step(n, len(products), f"{path} ({how_far})")

            with listening(hear):
                data = product.make()
            cache.put(product.key, data)
            made.append(product.path)
        path = folder / product.path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    progress.step(len(products), len(products), "done")
    return tuple(made)


def _record(folder: Path, product: Output, design: Design) -> FileRecord:
    sha256 = manifests.sha256_of((folder / product.path).read_bytes())
    return FileRecord(product.path, product.kind, product.part_no, design.design.revision, sha256)


def _write_bills(
    folder: Path, design: Design, scenes: Sequence[Scene], records: Sequence[FileRecord]
) -> list[FileRecord]:
    """A bill of materials a scene as CSV and JSON: bom.csv for the array, bom-NAME.csv for other scenes."""
    from tactcad.scenes import bom

    revision = design.design.revision
    # a shop cuts from the DXF where there is one, and makes the rest from the STEP file
    files = {
        r.part_no: (r.path, r.sha256) for kind in ("step-part", "dxf") for r in records if r.kind == kind
    }
    written = []
    for scene in scenes:
        rows = bom.bom_rows(scene, revision, files)
        as_csv, as_json = bom.csv_bytes(rows), bom.json_bytes(rows, design.name, revision, scene.name)
        wrong = bom.check_bom(scene, as_csv, as_json)
        if wrong:
            raise CheckFailure(f"bill of materials of {scene.name}: {'; '.join(wrong)}")
        stem = "bom" if scene.name == "array" else f"bom-{scene.name}"
        for path, data in ((f"{stem}.csv", as_csv), (f"{stem}.json", as_json)):
            (folder / path).write_bytes(data)
            written.append(FileRecord(path, "bom", "", revision, manifests.sha256_of(data)))
    return written


def _write_element_tables(folder: Path, design: Design) -> list[FileRecord]:
    """The inspection sheet to fill in, and the strength summary: tables of the numbered elements."""
    from tactcad.parts.layout import Layout

    from . import inspection
    from . import strength_table as strength

    layout = Layout(design)
    written = []
    for path, kind, data in (
        (inspection.NAME, "inspection", inspection.inspection_bytes(layout)),
        (strength.NAME, "report", strength.strength_bytes(layout)),
    ):
        (folder / path).write_bytes(data)
        written.append(FileRecord(path, kind, "", design.design.revision, manifests.sha256_of(data)))
    return written


def _part_record(part: Part, scenes: Sequence[Scene], shapes: Shapes, cache: Cache) -> PartRecord:
    from tactcad.parts.cut_section import cut_section

    from .products import part_facts

    facts = part_facts(part, shapes, cache)
    low, high = facts["box"]
    cut = cut_section(part)
    return PartRecord(
        part_no=part.part_no,
        name=part.name,
        process=part.process,
        qty=max(scene.count(part) for scene in scenes),
        volume_mm3=facts["volume"],
        area_mm2=facts["area"],
        mass_g=part.mass,
        centre_mm=tuple(facts["centre"]),
        box_mm=(tuple(low), tuple(high)),
        cut_length_mm=cut.cut_length if cut else None,
        section_area_mm2=cut.section_area if cut else None,
    )
