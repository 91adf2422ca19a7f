"""Export of a design: every file of its scenes, made once, checked, and published in one step."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from tactcad.account import listening
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design

from . import manifest as manifests
from .cache import Cache, default_root
from .inputs import Inputs, digest, inputs_from_json, inputs_of, reasons
from .manifest import FileRecord, Manifest, PartRecord
from .publish import Published, locked, new_build, published

if TYPE_CHECKING:
    from tactcad.parts.description import Part
    from tactcad.scenes.scene import Pose, Scene

    from .products import Product, Shapes

# What an exported file may depend on: a change in any of them rebuilds.
ROOMS = ("", "design", "contour", "mechanics", "parts", "scenes", "solids", "drawing", "export")
LIBRARIES = ("build123d", "cadquery-ocp", "ezdxf", "numpy")
DRAWN_WITH = ("matplotlib", "reportlab")  # where drawings are asked for: font and PDF


class Progress(Protocol):
    """Where an export says what it does."""

    def line(self, text: str) -> None:
        """One line worth keeping."""

    def step(self, done: int, total: int, text: str) -> None:
        """`done` of `total` pieces of work are finished, `text` is the one that comes."""


@dataclass(frozen=True)
class Exported:
    """What an export did: its folder, how many files it holds, which were made anew, which parts the
    kernel built, and why (empty where nothing had changed)."""

    folder: Path
    files: int
    made: tuple[str, ...]
    built: tuple[str, ...]
    reasons: tuple[str, ...]


def export(
    design: Design,
    scene_names: Sequence[str],
    out: str | os.PathLike[str],
    progress: Progress,
    pose: Pose | None = None,
    guides: bool = False,
    detail: str = "full",
    drawings: bool = False,
    draft: bool = False,
) -> Exported:
    """Write the scenes of a design to the folder `out`, all or nothing; in another pose than the rest's where
    given, with the assembly guides and the drawings where asked for (as a draft: marked PRELIMINARY), and at the
    detail level `full` or `envelope`.

    Nothing is written where the folder already holds just this; the rules between fields, which the
    earlier export kept, are tried only where something has to be made. Raises InputError where the
    design breaks a rule, or `out` is not ours to replace or cannot be written, CheckFailure where a
    file does not read back as it should.
    """
    wanted = (
        {"design": design, "scenes": tuple(scene_names)}
        | ({"pose": pose} if pose else {})
        | ({"guides": True} if guides else {})
    )
    wanted |= {"detail": detail} if detail != "full" else {}
    sheets = ("draft" if draft else "final") if drawings else ""
    wanted |= {"drawings": sheets} if drawings else {}
    inputs = inputs_of(wanted, ROOMS, LIBRARIES + (DRAWN_WITH if drawings else ()))
    if published(out).current is None:
        _refuse_broken(design)  # before a lock, or a folder for it, appears on the disk
    with locked(out, say=progress.line) as place:
        why, count = _reasons(place, inputs)
        if not why:
            progress.line(f"{out}: nothing changed, {count} files are up to date; nothing was rebuilt")
            return Exported(Path(out), count, (), (), ())
        _refuse_broken(design)
        if drawings:
            _refuse_unprintable(design)
        for reason in why:
            progress.line(f"{out}: {reason}")
        return _rebuild(
            design, scene_names, Path(out), place, inputs, tuple(why), progress, pose, guides, detail, sheets
        )


def _refuse_broken(design: Design) -> None:
    from tactcad.parts.rules import refuse_broken  # loads numpy: not needed where nothing changed

    refuse_broken(design)


def _refuse_unprintable(design: Design) -> None:
    from tactcad.drawing.fonts import refuse_letters_it_lacks  # loads matplotlib

    texts = design.design
    refuse_letters_it_lacks(
        {f"design.{name}": getattr(texts, name) for name in ("title", "author", "organisation", "revision")}
    )


def _reasons(place: Published, now: Inputs) -> tuple[list[str], int]:
    """Why the export has to be made anew (empty: it need not), and how many files it holds."""
    if place.current is None:
        return ["there is no earlier export"], 0
    wrong = manifests.check_manifest(place.current)
    if wrong:
        return [f"the earlier export was altered: {wrong[0]}"], 0
    earlier = manifests.read_manifest(place.current)
    return reasons(inputs_from_json(earlier.inputs), now), len(earlier.files) + 1


def _rebuild(
    design: Design,
    scene_names: Sequence[str],
    out: Path,
    place: Published,
    inputs: Inputs,
    why: tuple[str, ...],
    progress: Progress,
    pose: Pose | None,
    guides: bool,
    detail: str,
    sheets: str,
) -> Exported:
    from tactcad.scenes import make_scene
    from tactcad.scenes.detail import at_detail

    from .products import (
        Shapes,
        assembly_products,
        drawing_products,
        guide_products,
        part_products,
        scene_products,
    )

    cache = Cache(default_root(), progress.line)
    shapes = Shapes(cache, digest((inputs.sources, inputs.libraries)))
    scenes = [at_detail(make_scene(design, name, pose), detail) for name in scene_names]
    parts = list({part.part_no: part for s in scenes for part in s.parts}.values())
    products = [p for part in parts for p in part_products(design, part, shapes)]
    products += [p for s in scenes for p in scene_products(design, s, shapes)]
    products += [p for s in scenes if guides for p in guide_products(design, s, shapes)]
    if sheets:
        products += drawing_products(design, parts, shapes, products, progress.step, sheets == "draft")
        products += assembly_products(design, scenes, shapes, progress.step, sheets == "draft")
    with new_build(place) as folder:
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
    cache.trim()
    count = len(records) + 1
    progress.line(f"{out}: {count} files, {len(made)} made, {len(products) - len(made)} taken from the cache")
    return Exported(out, count, made, tuple(shapes.built), why)


def _write_products(
    folder: Path, products: Sequence[Product], cache: Cache, progress: Progress
) -> tuple[str, ...]:
    """Write every product's bytes, from the cache where it has them; returns the paths that were made anew."""
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


def _record(folder: Path, product: Product, design: Design) -> FileRecord:
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

    from . import inspection, strength

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
    from tactcad.parts.section import cut_section

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
