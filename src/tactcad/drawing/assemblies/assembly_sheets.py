"""The assembly drawing of a scene: general arrangement, views with item numbers, and the parts list; as PDF
and SVG, read back and compared with the scene and its bill of materials.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isclose
from typing import TYPE_CHECKING

from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.scenes.bom import BomRow
from tactcad.scenes.scene import Scene

from ..engine.fonts import em
from ..engine.ink import DrawnSheet, preliminary
from ..engine.layout_check import layout_faults
from ..engine.paper import A3, A4, frame
from ..engine.sheet_files import pdf_runs, pdf_texts, stacked_svg
from ..engine.title import HEIGHT, WIDTH, Page, TitleBlock, block_of, title_block
from ..engine.workers import Written
from . import parts_list
from .arrangement import arrangement
from .balloons import height
from .numbered import numbered_pages

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape



def assembly_sheets(
    design: Design,
    scene: Scene,
    rows: Sequence[BomRow],
    shapes: Mapping[str, TopoDS_Shape],
    draft: bool = False,
    sample: bool = False,
) -> list[DrawnSheet]:
    """All sheets of a scene, their layout clean.

    Parameters
    ----------
    design, scene
        What is drawn.
    rows
        The scene's bill of materials.
    shapes
        Solids by part number, each in its own frame, mm.
    draft
        Marks every sheet PRELIMINARY.
    sample
        Has every title block say that nothing is to be ordered by it.

    Raises
    ------
    CheckFailure
        Where the scene is larger than the sheet at 1:100, or a view leaves no clean layout.
    """
    name = f"Assembly: {scene.name.replace('-', ' ')}"
    block = block_of(design.design, f"{design.name}-{scene.name}", name, draft, sample)
    mass = sum(p.part.mass for p in scene.placements)
    block = replace(block, material="see parts list", mass=mass)
    arranged = arrangement(design, scene, shapes, block)
    list_ = next(
        (p for p in (parts_list.laid(rows, size) for size in parts_list.SIZES) if _fits_beside(p)), None
    )
    numbered, listed = numbered_pages(scene, rows, shapes, list_, block)
    pages = [arranged, *numbered]
    if not listed:
        pages += _list_pages(parts_list.laid(rows, parts_list.SIZES[0]))
    sheets = [_sheet(block, page, n + 1, len(pages)) for n, page in enumerate(pages)]
    for sheet in sheets:
        wrong = layout_faults(sheet)
        if wrong:
            raise CheckFailure(f"drawings: {block.number}: {'; '.join(wrong[:3])}; no drawing was written")
    return [preliminary(sheet) for sheet in sheets] if draft else sheets


def _sheet(block: TitleBlock, page: Page, number: int, count: int) -> DrawnSheet:
    own = replace(block, scale=page.scale, sheet=number, sheets=count, document_type=page.document_type)
    items = (*frame(page.paper), *title_block(page.paper, own), *page.items)
    return DrawnSheet(block.number, f"{block.title}, sheet {number} of {count}", page.paper.size, items)


def _fits_beside(list_: parts_list.Laid) -> bool:
    """Whether the whole list fits above the title block of an A3 sheet."""
    _, y0, _, y1 = A3.area
    return list_.total + parts_list.heading(list_.size) <= y1 - y0 - HEIGHT


def _list_pages(list_: parts_list.Laid) -> list[Page]:
    """One A4 page where that suffices; else A3 pages in two columns, the right one above the title block."""
    for paper, lefts in ((A4, [A4.area[2] - WIDTH]), (A3, [A3.area[0], A3.area[2] - WIDTH])):
        high = paper.area[3] - paper.area[1]
        columns = parts_list.columns(list_, [*[high] * (len(lefts) - 1), high - HEIGHT])
        if len(columns) == 1:
            break
    pages = []
    for n in range(0, len(columns), len(lefts)):
        items = [
            item
            for x, rows in zip(lefts, columns[n : n + len(lefts)])
            for item in parts_list.drawn(list_, rows, (x, paper.area[3]))[0]
        ]
        pages.append(Page(paper, "", tuple(items), "Parts list"))
    return pages


@dataclass(frozen=True)
class AssemblyOrder:
    """One scene to draw: its bill of materials, and every part's solid as the kernel's text, by part
    number."""

    design: Design
    scene: Scene
    rows: tuple[BomRow, ...]
    shapes: Mapping[str, bytes]
    draft: bool = False
    sample: bool = False

    @property
    def name(self) -> str:
        return f"{self.design.name}-{self.scene.name}"


def assembly_written(order: AssemblyOrder) -> Written:
    """All sheets of the scene as PDF and SVG.

    Raises CheckFailure where they cannot be drawn, or differ from the scene when read back.
    """
    from tactcad.solids.bytes import from_bytes  # loads the kernel

    from ..engine.sheet_files import pdf_bytes

    design = order.design.design
    shapes = {number: from_bytes(data) for number, data in order.shapes.items()}
    sheets = assembly_sheets(order.design, order.scene, order.rows, shapes, order.draft, order.sample)
    title = f"{order.name} revision {design.revision}: assembly"
    pdf = pdf_bytes(sheets, title, design.author or "", design.date)
    wrong = assembly_faults(pdf, order.name, design.revision, order.rows)
    if wrong:
        raise CheckFailure(f"drawings: {order.name}: {'; '.join(wrong[:3])}; no drawing was written")
    return Written(pdf, stacked_svg(sheets))


def assembly_faults(pdf: bytes, number: str, revision: str, rows: Sequence[BomRow]) -> list[str]:
    """What is wrong with an assembly's PDF.

    Parameters
    ----------
    pdf
        The written file.
    number, revision
        That every page has to name.
    rows
        The scene's bill of materials.

    Returns
    -------
    list of str
        Pages without number, revision or sheet count; items that have a solid and not just one balloon; rows
        that are not in the parts list as the bill has them. Empty where nothing is wrong.
    """
    pages = pdf_runs(pdf)
    wrong = []
    for n, runs in enumerate(pages, start=1):
        wrong += [f"sheet {n}: {t!r} is missing" for t in (revision, f"{n}/{len(pages)}") if t not in runs]
        wrong += (
            [f"sheet {n}: {number!r} is missing"] if number not in "".join(runs) else []
        )  # a long one is broken
    numbers = _ballooned(pdf)
    wrong += [
        f"item {row.item} ({row.part_no}) has {numbers.count(row.item)} balloons"
        for row in rows
        if numbers.count(row.item) != row.has_solid
    ]
    listed = "".join(_without_spaces(run) for page in pages for run in page)
    wrong += [
        f"{row.part_no} is not in the parts list as the bill has it"
        for row in rows
        if _without_spaces(
            f"{row.item}{row.qty:g}{'' if row.unit == 'pcs' else row.unit}{row.part_no}{row.description}"
        )
        not in listed
    ]
    return wrong


def _ballooned(pdf: bytes) -> list[int]:
    """Numbers in balloons, recognised by the height of their letters."""
    return [
        int(text)
        for page in pdf_texts(pdf)
        for text, size in page
        if text.isdecimal() and isclose(size, em(height(text)), rel_tol=1e-3)
    ]


def _without_spaces(text: str) -> str:
    """The text without spaces, since the sheet breaks texts into lines."""
    return re.sub(r"\s", "", text)
