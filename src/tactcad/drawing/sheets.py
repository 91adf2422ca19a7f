"""Part sheets of a design: a plan, its views, a clean layout, and the written PDF and SVG, in parallel on all cores."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from tactcad.design.messages import CheckFailure
from tactcad.design.tree import Design
from tactcad.parts.description import Extrusion, Part, Vector

from .compose import Curve, NoPlace, compose
from .element import element_plan
from .gate import drawing_faults
from .ink import Sheet, preliminary
from .notes import MadeFrom, notes_of
from .paper import A3, A4
from .plan import Plan, Section, View
from .prism import prism_plan
from .title import TitleBlock
from .workers import end_with

if TYPE_CHECKING:
    from .assembly_file import AssemblyOrder

PARALLEL_FROM = 3  # drawings: fewer are not worth processes


@dataclass(frozen=True)
class Order:
    """One sheet to make: the part, its solid as the kernel's text, and the files that the shop makes it from."""

    design: Design
    part: Part
    shape: bytes
    files: tuple[MadeFrom, ...]
    draft: bool = False

    @property
    def name(self) -> str:
        return self.part.part_no


@dataclass(frozen=True)
class Written:
    """A drawing."""

    pdf: bytes
    svg: bytes


def part_plan(part: Part, design: Design, files: Sequence[MadeFrom], spare: bool = False) -> Plan:
    """What the part's sheet shows; `spare` asks for less: an element's as that of a tall one, a prism's without section. Raises CheckFailure where the part cannot be drawn, or not fully dimensioned."""
    if not isinstance(part.body, Extrusion):
        raise CheckFailure(f"drawings: {part.part_no} is no extrusion; no drawing was written")
    names = {s.name for s in part.body.outer}
    notes = notes_of(part, files)
    if {"pad_face", "stop_land"} <= names:
        return element_plan(part, design, notes, spare)
    return prism_plan(part, design, notes, not spare)


def part_sheet(order: Order) -> Sheet:
    """The finished sheet, its layout clean."""
    from tactcad.solids.bytes import from_bytes  # loads the kernel

    from .cut import cut
    from .hidden_lines import projected

    shape = from_bytes(order.shape)

    @cache
    def curves(eye: Vector, up: Vector, section: Section | None) -> list[Curve]:
        view = View("", eye, up, (0.0, 0.0, 0.0, 0.0), section=section)
        if section is None:
            return projected(shape, eye, view.right)
        half, face = cut(shape, view)
        return [face, *projected(half, eye, view.right)]

    def composed(plan: Plan) -> Sheet:
        return compose(plan, {v.name: curves(v.eye, v.up, v.section) for v in plan.views}, title, (A4, A3))

    design, part = order.design, order.part
    title = title_of(design, part, order.draft)
    plan = part_plan(part, design, order.files)
    try:
        sheet = composed(plan)
    except NoPlace:
        if all(view.window is None and view.section is None for view in plan.views):
            raise
        sheet = composed(part_plan(part, design, order.files, spare=True))
    return preliminary(sheet) if order.draft else sheet


def title_of(design: Design, part: Part, draft: bool) -> TitleBlock:
    d, m = design.design, part.material
    return TitleBlock(
        legal_owner=d.organisation,
        number=part.part_no,
        revision=d.revision,
        date=d.date,
        title=part.name,
        supplementary=d.title,
        creator=d.author,
        document_type="Part drawing",
        status="draft" if draft else "for manufacture",
        scale="",
        material=f"{m.name} {m.temper}".strip(),
        mass=part.mass,
        finish=part.finish,
    )


def written(order: Order) -> Written:
    """The sheet as PDF and SVG, read back. Raises CheckFailure where it does not hold."""
    from .pdf import pdf_bytes
    from .svg import svg_bytes

    sheet = part_sheet(order)
    d = order.design.design
    pdf = pdf_bytes(
        [sheet], f"{order.part.part_no} revision {d.revision}: {order.part.name}", d.author, d.date
    )
    wrong = drawing_faults(pdf, sheet, order.part, d.revision)
    if wrong:
        raise CheckFailure(f"drawings: {order.part.part_no}: {'; '.join(wrong)}; no drawing was written")
    return Written(pdf, svg_bytes(sheet))


def all_written(
    orders: Sequence[Order | AssemblyOrder],
    make: Callable[..., Written] = written,
    say: Callable[[int, int, str], None] = lambda *_: None,
) -> list[Written]:
    """What `make` makes of every order, in their order; side by side on the machine's cores where it pays.

    Raises CheckFailure for the first that cannot be drawn, or where a process was killed.
    """
    cores = min(len(os.sched_getaffinity(0)), len(orders))
    if cores < 2 or len(orders) < PARALLEL_FROM:
        return [_said(make(order), n, orders, say) for n, order in enumerate(orders)]
    # fork: the kernel is loaded already, and runs no threads of its own (its booleans and meshes are called serial)
    with ProcessPoolExecutor(cores, multiprocessing.get_context("fork"), end_with, (os.getpid(),)) as pool:
        try:
            return [_said(done, n, orders, say) for n, done in enumerate(pool.map(make, orders))]
        except BrokenProcessPool as error:
            raise CheckFailure(
                "drawings: a process that made them was killed; no drawing was written"
            ) from error


def _said(
    done: Written, n: int, orders: Sequence[Order | AssemblyOrder], say: Callable[[int, int, str], None]
) -> Written:
    say(n + 1, len(orders), f"drawing of {orders[n].name}")
    return done
