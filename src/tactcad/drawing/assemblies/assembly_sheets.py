"""The assembly drawing of a scene: general arrangement, views with item numbers, and the parts list; as PDF
and SVG, read back and compared with the scene and its bill of materials.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isclose
from typing import TYPE_CHECKING

from tactcad.design.messages import CheckFailure
from tactcad.design.tree import CommonTables
from tactcad.scenes.bom import BomRow
from tactcad.scenes.scene import Scene

from ..engine.ink import DrawnSheet, em
from ..engine.layout_check import sheets_of
from ..engine.paper import A3, A4, HEIGHT, WIDTH, Page, block_of
from ..engine.sheet_files import Written, files_of, pdf_runs, pdf_texts
from .arrangement import arrangement
from .balloons import SIZES, Laid, heading, height, laid, laid_columns, list_drawn
from .numbered import numbered_pages

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape


def assembly_sheets(
    design: CommonTables,
    scene: Scene,
    rows: Sequence[BomRow],
    shapes: Mapping[str, TopoDS_Shape],
    draft: bool = False,
    sample: bool = False,
) -> list[DrawnSheet]:
    """All sheets of a scene, their layout clean: `rows` are its bill of materials, `shapes` the solids by
    part number, each in its own frame (mm).

    Raises CheckFailure if the scene is larger than the sheet at 1:100, or a view leaves no clean layout.
    """
    name = f"Assembly: {scene.name.replace('-', ' ')}"
    block = block_of(design.design, f"{design.name}-{scene.name}", name, draft, sample)
    mass = sum(p.part.mass for p in scene.placements)
    block = replace(block, material="see parts list", mass=mass)
    arranged = arrangement(design, scene, shapes, block)
    above_block = A3.area[3] - A3.area[1] - HEIGHT
    lists = [laid(rows, size) for size in SIZES]
    beside = [p for p in lists if p.total + heading(p.size) <= above_block]
    numbered, listed = numbered_pages(scene, rows, shapes, beside[0] if beside else None, block)
    pages = [arranged, *numbered, *([] if listed else _list_pages(lists[0]))]
    return sheets_of(block, pages, draft, name)


def _list_pages(list_: Laid) -> list[Page]:
    """One A4 page where that suffices; else A3 pages in two columns, the right one above the title block."""
    for paper, lefts in ((A4, [A4.area[2] - WIDTH]), (A3, [A3.area[0], A3.area[2] - WIDTH])):
        high = paper.area[3] - paper.area[1]
        columns = laid_columns(list_, [*[high] * (len(lefts) - 1), high - HEIGHT])
        if len(columns) == 1:
            break
    pages = []
    for n in range(0, len(columns), len(lefts)):
        items = [
            item
            for x, rows in zip(lefts, columns[n : n + len(lefts)])
            for item in list_drawn(list_, rows, (x, paper.area[3]))[0]
        ]
        pages.append(Page(paper, "", tuple(items), "Parts list"))
    return pages


def assembly_written(
    sheets: Sequence[DrawnSheet], design: CommonTables, scene: Scene, rows: Sequence[BomRow]
) -> Written:
    """The sheets of a scene (`assembly_sheets`) as PDF and SVG.

    Raises CheckFailure if they differ from the scene when read back.
    """
    name = f"{design.name}-{scene.name}"
    made = files_of(sheets, name, "assembly", design.design)
    wrong = assembly_faults(made.pdf, name, design.design.revision, rows)
    if wrong:
        raise CheckFailure(f"drawings: {name}: {'; '.join(wrong[:3])}; no drawing was written")
    return made


def assembly_faults(pdf: bytes, number: str, revision: str, rows: Sequence[BomRow]) -> list[str]:
    """Faults of an assembly's PDF: pages without number, revision or sheet count; solid items without exactly
    one balloon; rows of the bill that differ in the parts list."""
    pages = pdf_runs(pdf)
    wrong = []
    for n, runs in enumerate(pages, start=1):
        wrong += [f"sheet {n}: {t!r} is missing" for t in (revision, f"{n}/{len(pages)}") if t not in runs]
        if number not in "".join(runs):  # a long one is broken
            wrong.append(f"sheet {n}: {number!r} is missing")
    numbers = [  # in balloons, recognised by the height of their letters
        int(text)
        for page in pdf_texts(pdf)
        for text, size in page
        if text.isdecimal() and isclose(size, em(height(text)), rel_tol=1e-3)
    ]
    wrong += [
        f"item {row.item} ({row.part_no}) has {numbers.count(row.item)} balloons"
        for row in rows
        if numbers.count(row.item) != row.has_solid
    ]
    listed = _without_spaces("".join(run for page in pages for run in page))
    for row in rows:
        unit = "" if row.unit == "pcs" else row.unit
        if _without_spaces(f"{row.item}{row.qty:g}{unit}{row.part_no}{row.description}") not in listed:
            wrong.append(f"{row.part_no} is not in the parts list as the bill has it")
    return wrong


def _without_spaces(text: str) -> str:
    """The text without spaces, since the sheet breaks texts into lines."""
    return re.sub(r"\s", "", text)
