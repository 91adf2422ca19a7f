"""The subject of a review: a design, or an export's folder, whose manifest has its design."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tactcad.design.load import find, from_table
from tactcad.design.messages import InputError
from tactcad.design.tree import CommonTables
from tactcad.export.cache import Cache, default_root
from tactcad.export.formats import ExportOptions
from tactcad.export.inputs import Inputs, digest, inputs_from_json, inputs_of, nested, reasons
from tactcad.export.manifest import read_export
from tactcad.export.pipeline import DRAWN_WITH, LIBRARIES, ROOMS, made_files
from tactcad.export.products import Plan, part_sheets
from tactcad.export.shapes import Shapes
from tactcad.export.workers import relayed
from tactcad.parts.rules import load
from tactcad.scenes.scene import Scene


@dataclass(frozen=True)
class Subject:
    """A design that keeps its rules, its file or folder, the scenes of an export (None: all of the design's),
    and the export's sheets, SVG by part number."""

    design: CommonTables
    path: Path
    scenes: tuple[str, ...] | None
    sheets: Mapping[str, str]


def subject(source: str) -> Subject:
    """The subject named by `source`: a design (a path, or a name in hardware/), or an export's folder.

    Raises InputError if it is neither, or the export is damaged or was made by another version.
    """
    if os.path.isdir(source):  # False also for texts that are not paths
        return _exported(source, Path(source))
    return Subject(load(source), find(source), None, {})


def _exported(source: str, folder: Path) -> Subject:
    manifest = read_export(source, folder)
    before = inputs_from_json(manifest.inputs)
    again = "export it again, or review the design file"
    if before is None:
        raise InputError(source, "its manifest does not name its design", legal=again)
    values = {k.removeprefix("design."): v for k, v in before.values.items() if k.startswith("design.")}
    try:
        design = from_table(nested(values))
        # The libraries that an export depended on.
        differ = reasons(
            Inputs(values, before.sources, before.libraries),
            inputs_of(design, ROOMS, [name for name in before.libraries if name != "python"]),
        )
    except (InputError, LookupError, TypeError, AttributeError) as error:
        raise InputError(source, f"made by another version of tactcad: {error}", legal=again) from None
    if differ:
        raise InputError(source, f"made by another version of tactcad: {differ[0]}", legal=again)
    scenes = [v for k, v in before.values.items() if k.startswith("options.scenes[")]
    drawn = [f for f in manifest.files if f.kind == "drawing" and f.part_no and f.path.endswith(".svg")]
    sheets = {f.part_no: (folder / f.path).read_text("utf-8") for f in drawn}
    return Subject(design, folder, tuple(scenes), sheets)


def shapes_of(design: CommonTables, say: Callable[[str], None]) -> Shapes:
    """Makes solids, or takes them from the cache that a full export fills; `say` hears of damaged entries."""
    inputs = inputs_of(design, ROOMS, (*LIBRARIES, *DRAWN_WITH))
    return Shapes(Cache(default_root(), relayed(say)), digest((inputs.sources, inputs.libraries)))


def drawn_sheets(
    design: CommonTables, scenes: Sequence[Scene], shapes: Shapes, say: Callable[[int, int, str], None]
) -> dict[str, str]:
    """The drawing sheet of every part made here, as SVG by part number."""
    plan = Plan(design, ExportOptions(tuple(scene.name for scene in scenes)), scenes, shapes)
    made = made_files(plan, [*part_sheets(plan)], say, shapes.cache.say)
    return {file.part_no: data.decode() for file, data, _ in made if file.path.endswith(".svg")}
