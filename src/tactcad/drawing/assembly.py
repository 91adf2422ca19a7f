"""The assembly drawing of a scene: general arrangement, views with item numbers, and the parts list."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.scenes.bom import BomRow
from tactcad.scenes.scene import Scene

from . import parts_list
from .arrangement import arrangement
from .ink import DrawnSheet, preliminary
from .layout_check import layout_faults
from .numbered import numbered_pages
from .page import Page
from .paper import A3, A4, frame
from .title import HEIGHT, WIDTH, TitleBlock, block_of, title_block

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
