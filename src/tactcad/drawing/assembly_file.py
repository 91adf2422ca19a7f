"""The assembly drawing of a scene as PDF and SVG, read back and compared with the scene and its bill of
materials."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isclose

from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.scenes.bom import BomRow
from tactcad.scenes.scene import Scene

from .assembly import assembly_sheets
from .balloons import height
from .fonts import em
from .gate import pdf_runs, pdf_texts
from .ink import DrawnSheet
from .workers import Written

BETWEEN = 10.0  # of the sheets of one SVG file, mm


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

    from .pdf import pdf_bytes

    design = order.design.design
    shapes = {number: from_bytes(data) for number, data in order.shapes.items()}
    sheets = assembly_sheets(order.design, order.scene, order.rows, shapes, order.draft, order.sample)
    title = f"{order.name} revision {design.revision}: assembly"
    pdf = pdf_bytes(sheets, title, design.author or "", design.date)
    wrong = assembly_faults(pdf, order.name, design.revision, order.rows)
    if wrong:
        raise CheckFailure(f"drawings: {order.name}: {'; '.join(wrong[:3])}; no drawing was written")
    return Written(pdf, stacked_svg(sheets))


def stacked_svg(sheets: Sequence[DrawnSheet]) -> bytes:
    """The sheets below each other in one SVG file, each at the paper's size."""
    from .svg import svg_bytes

    width, y, pieces = max(s.size[0] for s in sheets), 0.0, []
    for sheet in sheets:
        w, h = sheet.size
        body = svg_bytes(sheet).decode().partition("?>\n")[2]
        # in millimetres of the whole, not of the window
        pieces.append(
            body.replace(
                f'width="{w:g}mm" height="{h:g}mm"', f'x="0" y="{y:g}" width="{w:g}" height="{h:g}"', 1
            )
        )
        y += h + BETWEEN
    head = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}mm" height="{y - BETWEEN:g}mm" '
        f'viewBox="0 0 {width:g} {y - BETWEEN:g}">\n'
    )
    return (head + "".join(pieces) + "</svg>\n").encode()


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
