"""Part sheets of a design: a plan with its notes, its views, a clean layout; written as PDF and SVG, read
back with another library and compared with the part.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

from tactcad.design.family import family_of
from tactcad.design.materials import ELECTROLYSIS, family
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import CommonTables
from tactcad.parts.language.description import Characteristic, ModelFile, Part, Revolution, Vector
from tactcad.parts.language.stock import stock_of

from ..engine.ink import Curve, DrawnSheet, preliminary
from ..engine.layout_check import layout_faults
from ..engine.paper import A0, A1, A2, A3, A4, SERIES, Paper, Scale, TitleBlock, block_of, factor
from ..engine.sheet_files import Written, files_of, pdf_runs
from .broken import broken
from .compose import NoPlace, compose
from .prism import prism_plan, turned_plan
from .sheet_plan import SectionPlane, SheetPlan, View
from .tolerances import frame_of, times

LEAST_WHOLE = 1 / 2  # scale: below it a long part is drawn broken rather than smaller
SAME = 1e-9  # mm
Plans = Mapping[str, Callable[..., SheetPlan]]  # by kind of part
_VALUE = re.compile(
    r"^[⌀R]?(?P<nominal>\d+(?:\.\d+)?) (?:±(?P<both>[\d.]+)|(?P<upper>[+-]?[\d.]+)/(?P<lower>[+-]?[\d.]+))$"
)


@dataclass(frozen=True)
class MadeFrom:
    """The file that a shop makes the part from: its path in the export, and its SHA-256."""

    path: str
    sha256: str


@dataclass(frozen=True)
class Order:
    """One sheet to make: the part, its solid as the kernel's text, the files from which the shop makes it."""

    design: CommonTables
    part: Part
    shape: bytes
    files: tuple[MadeFrom, ...]
    draft: bool = False
    sample: bool = False


def part_plan(
    part: Part, files: Sequence[MadeFrom], plans: Plans, spare: bool = False, shortened: bool = False
) -> SheetPlan | None:
    """The plan of a part's sheet, and its files; `plans` are its family's own, by kind.

    `spare` asks for less: of an element as of a tall one, of any other part without section. `shortened` asks
    for broken views; None if these would leave out too little. Raises CheckFailure if the part cannot
    be drawn, or not fully dimensioned.
    """
    if isinstance(part.body, ModelFile):
        raise CheckFailure(f"drawings: {part.part_no} is a model file; no drawing was written")
    notes = notes_of(part, files)
    if plan := plans.get(part.kind):
        return None if shortened else plan(part, notes, spare)
    if isinstance(part.body, Revolution):
        return None if shortened else turned_plan(part, notes)
    return prism_plan(part, notes, not spare, shortened)


def part_sheet(order: Order) -> DrawnSheet:
    """The finished sheet, its layout clean."""
    from tactcad.solids.step import from_bytes

    from .solid_views import cut, projected

    shape = from_bytes(order.shape)

    @cache
    def curves(eye: Vector, up: Vector, section: SectionPlane | None, hidden: bool) -> list[Curve]:
        view = View("", eye, up, (0.0, 0.0, 0.0, 0.0), section=section)
        if section is None:
            return [*projected(shape, eye, view.right, hidden)]
        half, face = cut(shape, view, section)
        return [face, *projected(half, eye, view.right)]

    title = title_of(order.design, order.part, order.draft, order.sample)
    for plan, papers, scales in _attempts(order):
        drawn = {v.name: curves(v.eye, v.up, v.section, v.hidden) for v in plan.views}
        try:
            sheet = compose(*broken(plan, drawn), title, papers, scales)
        except NoPlace as error:
            refused = error
        else:
            return preliminary(sheet) if order.draft else sheet
    raise refused


def _attempts(order: Order) -> Iterator[tuple[SheetPlan, Sequence[Paper], Sequence[Scale]]]:
    """Plans to try one after another, each with its papers and scales.

    Small sheets first; whole views on them down to 1:2 before broken ones, and smaller scales only after
    these.
    """

    def plans(shortened: bool = False) -> Iterator[SheetPlan]:
        for spare in (False, True):
            plan = part_plan(order.part, order.files, family_of(order.design).plans, spare, shortened)
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


def title_of(design: CommonTables, part: Part, draft: bool, sample: bool = False) -> TitleBlock:
    block = block_of(design.design.of_part(part.part_no), part.part_no, part.name, draft, sample)
    material = str(part.material)
    return replace(block, document_type="Part drawing", material=material, mass=part.mass, finish=part.finish)


def written(order: Order) -> Written:
    """The sheet as PDF and SVG, read back. Raises CheckFailure if it differs from the part."""
    sheet, part = part_sheet(order), order.part
    of = order.design.design.of_part(part.part_no)
    made = files_of([sheet], part.part_no, part.name, of)
    wrong = drawing_faults(made.pdf, sheet, part, of.revision)
    if wrong:
        raise CheckFailure(f"drawings: {part.part_no}: {'; '.join(wrong)}; no drawing was written")
    return made


def notes_of(part: Part, files: Sequence[MadeFrom]) -> tuple[str, ...]:
    """Numbered notes: the part's own, what follows from how it is made, the files that it is made from."""
    keys = [f"K{n} {c.name}" for n, c in enumerate((c for c in part.characteristics if c.key), start=1)]
    lines = [note[:1].upper() + note[1:] for note in part.notes]
    if keys:
        lines.append(f"Key characteristics, framed, to be recorded on every piece: {', '.join(keys)}")
    stock = stock_of(part)
    cut = "Blank by"
    if stock and stock.edge:
        lines.append(
            f"Blank from {stock.thickness:g} plate, {stock.edge:g} larger on each edge, no holes; at least "
            f"{stock.face:g} off each face; all edges finished"
        )
    if part.process == "wire-cut":
        cut = "Cut by"
        if stock and stock.face:
            lines.append(f"From {stock.thickness:g} plate: both faces ground before it is cut")
        # drawn where neighbours touch it: the model has its nominal size, outside its limits
        off = [c.name for c in part.characteristics if not c.lower <= c.nominal <= c.upper]
        but = f", but for the {' and the '.join(off)}: these as dimensioned" if off else ""
        lines.append(
            f"Wire path: the DXF's contour as it is, in the middle of all limits{but}; offset by your wire's "
            "radius and spark gap"
        )
        if part.extrusion.openings:
            lines.append("Holes wire-cut before the outline, each from a start hole inside it; slugs removed")
        if harm := ELECTROLYSIS.get(family(part.material.density)):
            lines.append(f"Anti-electrolysis supply: without it {part.material.name} {harm}")
    elif part.by_contour:
        cut = "Etched by"
        lines.append(
            "The DXF file holds the nominal contour, limits at their middle; the photo tool allows for "
            "undercut"
        )
    for file in files:
        use = cut if file.path.endswith(".dxf") else "Model"
        lines.append(f"{use} {file.path.rsplit('/', 1)[-1]}, SHA-256 {file.sha256}")
    return tuple(lines)


def drawing_faults(data: bytes, sheet: DrawnSheet, part: Part, revision: str) -> list[str]:
    """Faults of a part's PDF: pages, number and revision, layout, or a key characteristic."""
    pages = pdf_runs(data)
    if len(pages) != 1:
        return [f"{len(pages)} pages instead of 1"]
    runs = pages[0]
    wrong = [f"{text!r} is missing" for text in (revision, "1/1") if text not in runs]
    if part.part_no not in "".join(runs):  # a long one is broken
        wrong.append(f"{part.part_no!r} is missing")
    texts = [t.text for t in sheet.texts if t.role != "watermark"]
    lost = [t for t in set(texts) if runs.count(t) < texts.count(t)]
    wrong += [f"{t!r} is not found again" for t in sorted(lost)]
    wrong += key_faults(runs, [c for c in part.characteristics if c.key])
    elsewhere = Counter(t.text for t in sheet.texts if t.role != "symbol")
    return wrong + geometric_faults(runs, part, elsewhere) + layout_faults(sheet)


def geometric_faults(runs: Sequence[str], part: Part, elsewhere: Mapping[str, int]) -> list[str]:
    """Tolerance frames and datum letters that are not on a sheet exactly once for each of the part's
    features.

    `runs` are the page's texts in the order in which they were drawn, `elsewhere` the number of a text
    outside of frames and datum symbols, such as the letters of the paper's zones.
    """
    frames = Counter(frame_of(part, g).cells for g in part.geometric for _ in range(times(part, g)))
    wrong = []
    for cells, meant in sorted(frames.items()):
        n = len(cells)
        found = sum(tuple(runs[i : i + n]) == cells for i in range(len(runs) - n + 1))
        found -= elsewhere.get(cells[0], 0) if n == 1 else 0
        longer = sum(k for other, k in frames.items() if len(other) > n and other[:n] == cells)
        if found - longer != meant:
            wrong.append(f"tolerance frame {' '.join(cells)} appears {found - longer} times, not {meant}")
    wanted = Counter(d.letter for d in part.datums)
    wanted.update(x for cells in frames.elements() for x in cells[1:])
    for letter in sorted({*wanted, *(run for run in runs if len(run) == 1 and run.isupper())}):
        found = runs.count(letter) - elsewhere.get(letter, 0)
        if found != wanted[letter]:
            wrong.append(f"datum {letter} appears {found} times in frames, not {wanted[letter]}")
    return wrong


def key_faults(runs: Sequence[str], keys: Sequence[Characteristic]) -> list[str]:
    """Key characteristics, in the part's order, that are not exactly once on a sheet (its texts in the order
    in which they were drawn), framed with their number, or that differ from the model's value."""
    wrong, shown = [], []
    for n, c in enumerate(keys, start=1):
        at = [i for i, run in enumerate(runs) if run == f"K{n}"]
        if len(at) != 1 or at[0] + 1 >= len(runs):
            wrong.append(f"key characteristic K{n} ({c.name}) appears {len(at)} times")
            continue
        text = runs[at[0] + 1]
        shown.append(text)
        match = _VALUE.match(text)
        if not match:
            wrong.append(f"K{n}: {text!r} is no value with limits")
            continue
        nominal, both = float(match["nominal"]), match["both"]
        upper, lower = float(both or match["upper"]), -float(both) if both else float(match["lower"])
        read, meant = (nominal, nominal + upper, nominal + lower), (c.nominal, c.upper, c.lower)
        if max(abs(a - b) for a, b in zip(read, meant)) > SAME:
            has = f"{c.nominal:g} in {c.lower:g} to {c.upper:g}"
            wrong.append(f"K{n} ({c.name}) says {text}, the model has {has}")
    wrong += [
        f"{text!r} appears {runs.count(text)} times, for {shown.count(text)} key characteristics"
        for text in sorted(set(shown))
        if runs.count(text) != shown.count(text)
    ]
    return wrong
