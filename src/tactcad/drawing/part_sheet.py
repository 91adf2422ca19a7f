"""Part sheets of a design: a plan, its views, a clean layout, and the written PDF and SVG."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.parts.description import Extrusion, Part, Vector

from .broken import broken
from .compose import NoPlace, compose
from .element_plan import element_plan
from .gate import drawing_faults
from .ink import Curve, DrawnSheet, preliminary
from .notes import MadeFrom, notes_of
from .paper import A0, A1, A2, A3, A4, Paper
from .prism import prism_plan
from .scale import SERIES, Scale, factor
from .sheet_plan import SectionPlane, SheetPlan, View
from .title import TitleBlock, block_of
from .workers import Written

LEAST_WHOLE = 1 / 2  # scale: below it a long part is drawn broken rather than smaller


@dataclass(frozen=True)
class Order:
    """One sheet to make: the part, its solid as the kernel's text, and the files from which the shop makes
    it.
    """

    design: Design
    part: Part
    shape: bytes
    files: tuple[MadeFrom, ...]
    draft: bool = False
    sample: bool = False

    @property
    def name(self) -> str:
        return self.part.part_no


def part_plan(
    part: Part, files: Sequence[MadeFrom], spare: bool = False, shortened: bool = False
) -> SheetPlan | None:
    """What a part's sheet shows.

    Parameters
    ----------
    files
        What the part is made from.
    spare
        Asks for less: of an element as of a tall one, of any other part without section.
    shortened
        Asks for broken views; None where these would leave out too little.

    Raises
    ------
    CheckFailure
        Where the part cannot be drawn, or not fully dimensioned.
    """
    if not isinstance(part.body, Extrusion):
        raise CheckFailure(f"drawings: {part.part_no} is no extrusion; no drawing was written")
    names = {s.name for s in part.body.outer}
    notes = notes_of(part, files)
    if {"pad_face", "stop_land"} <= names:
        return None if shortened else element_plan(part, notes, spare)
    return prism_plan(part, notes, not spare, shortened)


def part_sheet(order: Order) -> DrawnSheet:
    """The finished sheet, its layout clean."""
    from tactcad.solids.bytes import from_bytes  # loads the kernel

    from .hidden_lines import projected
    from .section_cut import cut

    shape = from_bytes(order.shape)

    @cache
    def curves(eye: Vector, up: Vector, section: SectionPlane | None) -> list[Curve]:
        view = View("", eye, up, (0.0, 0.0, 0.0, 0.0), section=section)
        if section is None:
            return [*projected(shape, eye, view.right)]
        half, face = cut(shape, view, section)
        return [face, *projected(half, eye, view.right)]

    title = title_of(order.design, order.part, order.draft, order.sample)
    for plan, papers, scales in _attempts(order):
        drawn = {v.name: curves(v.eye, v.up, v.section) for v in plan.views}
        try:
            sheet = compose(*broken(plan, drawn), title, papers, scales)
        except NoPlace as error:
            refused = error
        else:
            return preliminary(sheet) if order.draft else sheet
    raise refused


def _attempts(order: Order) -> Iterator[tuple[SheetPlan, Sequence[Paper], Sequence[Scale]]]:
    """Plans to try in turn, each with its papers and scales.

    Small sheets first; whole views on them down to 1:2 before broken ones, and smaller scales only after
    these.
    """

    def plans(shortened: bool = False) -> Iterator[SheetPlan]:
        for spare in (False, True):
            plan = part_plan(order.part, order.files, spare, shortened)
            if plan is None:
                return
            yield plan
            if all(view.window is None and view.section is None for view in plan.views):
                return  # there is nothing to spare

    small, whole, short = (A4, A3), [*plans()], [*plans(shortened=True)]
    large = [s for s in SERIES if factor(s) >= LEAST_WHOLE] if short else SERIES
    yield from ((plan, small, large) for plan in whole)
    yield from ((plan, small, SERIES) for plan in short)
    if short:
        yield from ((plan, small, SERIES) for plan in whole)
    yield from ((plan, (paper,), SERIES) for paper in (A2, A1, A0) for plan in (*short, *whole))


def title_of(design: Design, part: Part, draft: bool, sample: bool = False) -> TitleBlock:
    block = block_of(design.design, part.part_no, part.name, draft, sample)
    material = str(part.material)
    return replace(block, document_type="Part drawing", material=material, mass=part.mass, finish=part.finish)


def written(order: Order) -> Written:
    """The sheet as PDF and SVG, read back. Raises CheckFailure where it differs from the part."""
    from .pdf import pdf_bytes
    from .svg import svg_bytes

    sheet = part_sheet(order)
    d = order.design.design
    pdf = pdf_bytes(
        [sheet], f"{order.part.part_no} revision {d.revision}: {order.part.name}", d.author or "", d.date
    )
    wrong = drawing_faults(pdf, sheet, order.part, d.revision)
    if wrong:
        raise CheckFailure(f"drawings: {order.part.part_no}: {'; '.join(wrong)}; no drawing was written")
    return Written(pdf, svg_bytes(sheet))
