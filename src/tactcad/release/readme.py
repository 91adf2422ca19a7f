"""README.txt of a release, which a shop reads first. Plain ASCII apart from the design's own texts, 96
columns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from textwrap import wrap

from tactcad import __version__
from tactcad.design.materials import family
from tactcad.design.tree import Design
from tactcad.drawing.extent import part_box
from tactcad.export import inspection
from tactcad.export import strength_table as strength
from tactcad.parts.description import Characteristic, Part
from tactcad.parts.finding import Finding
from tactcad.parts.hinge_section import thickness_elasticity
from tactcad.parts.layout import Layout
from tactcad.scenes.scene import Scene

from .archive import MANIFEST

WIDTH = 96
MARK = "PRELIMINARY"
DRAFT = f"{MARK}: for discussion only. Do not make anything from these files."
FOLDERS = {
    "dxf/": "cut files, exact nominal contours, millimetres, one part a file: the wire-cut parts whole, of "
    "milled and ground "
    "plates the blank with its plain through holes. Compensation for wire and spark gap is yours.",
    "step/": "every part as a solid, and every assembly (AP214, millimetres); NAME-ap242.step: the same "
    "part with its limits and datums on its faces, for machines to read (AP242)",
    "pdf/": "a drawing sheet for every part made, and an assembly sheet with parts list for every scene",
    "bom": "bills of materials: bom.csv of the array, bom-SCENE.csv of the other scenes",
    inspection.NAME: "what to measure on every numbered element: fill in `measured` (and `uncertainty_k2`, "
    "expanded, "
    "k = 2, if you state it) and send it back. Decimal points, mm.",
    "inspection-parts.csv": "what to measure on other parts, what matters most to the assembled sensor first",
    "stack.csv": "how the limits of the parts add up; for information",
    strength.NAME: "what every element is rated for; for information",
    MANIFEST: f"SHA-256 of every file; `sha256sum -c {MANIFEST}` checks them",
}
PROCESSES = {"wire-cut": "Wire-cut from sheet", "milled": "Milled", "turned": "Turned", "ground": "Ground"}


@dataclass(frozen=True)
class ReleaseContents:
    """Subject of a release: its scenes, what the checks flagged, and why it is only a draft (empty where
    it is not).
    """

    design: Design
    scenes: Sequence[Scene]
    flags: Sequence[Finding]
    failures: Sequence[str]
    draft: bool

    @property
    def made(self) -> list[Part]:
        """Every part that a shop makes, once; grouped by process, in the order of first placement."""
        parts = {p.part_no: p for scene in self.scenes for p in scene.parts if p.process in PROCESSES}
        return sorted(parts.values(), key=lambda p: list(PROCESSES).index(p.process))

    def quantity(self, part: Part) -> int:
        """The most that one scene needs: the array moves from set-up to set-up."""
        return max(scene.count(part) for scene in self.scenes)


def readme_bytes(contents: ReleaseContents, paths: Sequence[str]) -> bytes:
    """The text for a release that holds `paths`, UTF-8 with line ends that every editor shows."""
    design = contents.design
    identity = design.design
    title = f"{identity.name}, revision {identity.revision}: {identity.title}"
    lines = [title, "=" * len(title), ""]
    if contents.draft:
        lines += _draft(contents)
    lines += _paragraph(
        f"Issued {identity.date} by {_people(design)}. Made with tactcad {__version__}. "
        f"Every file here is revision {identity.revision}; do not mix it with files of another."
    )
    for heading, body in (
        ("WHAT IT IS", _what(contents)),
        ("WHAT TO MAKE", _table(contents)),
        ("KEY CHARACTERISTICS", _keys(contents)),
        ("HOW TO MAKE IT", _how(contents)),
        ("WHICH FILE IS WHAT", _files(paths)),
        ("WITH YOUR QUOTATION PLEASE TELL US", _questions(contents)),
        ("WHAT OUR OWN CHECKS FLAGGED", _flags(contents)),
        ("CONTACT", _paragraph(f"{_people(design)}. Please ask before you change anything.")),
    ):
        lines += [heading, "-" * len(heading), *body]
    return ("\r\n".join(lines).rstrip() + "\r\n").encode()


def _people(design: Design) -> str:
    return ", ".join(dict.fromkeys((design.design.author, design.design.organisation)))


def _paragraph(text: str, indent: str = "", first: str | None = None) -> list[str]:
    start = indent if first is None else first
    return [*wrap(text, WIDTH, initial_indent=start, subsequent_indent=indent, break_on_hyphens=False), ""]


def _listed(texts: Sequence[str]) -> list[str]:
    lines: list[str] = []
    for n, text in enumerate(texts, start=1):
        lines += _paragraph(text, "    ", f"{n:2}. ")[:-1]
    return [*lines, ""]


def _draft(contents: ReleaseContents) -> list[str]:
    lines = _paragraph(DRAFT)
    if contents.failures:
        lines += ["It could not be released because:", *_listed(contents.failures)]
    return lines


def _what(contents: ReleaseContents) -> list[str]:
    design, layout = contents.design, Layout(contents.design)
    count = len(layout.elements)
    thinnest = min(layout.elements, key=lambda place: place.hinge.t)
    per_hundredth = thickness_elasticity(layout, thinnest) * 0.01 / thinnest.hinge.t
    others = [scene.name for scene in contents.scenes if scene.name != "array"]
    text = (
        f"A tactile sensor array of {count} sensing element{'s' if count > 1 else ''}, wire-cut from "
        f"{design.sheet.thickness:g} mm "
        f"{design.material.alloy} sheet. Each has a hinge {thinnest.hinge.t:g} mm thin, whose thickness "
        f"decides its stiffness: "
        "one hundredth of a millimetre more or less is "
        f"{100 * per_hundredth:.0f} % more or less stiffness. Everything else is ordinary plate work."
    )
    if others:
        text += f" The set-ups that it is used in are here too: {', '.join(others)}."
    return _paragraph(text)


def _table(contents: ReleaseContents) -> list[str]:
    heads = ("part", "qty", "spares", "material", "size, mm", "finish")
    rows = [
        (
            part.part_no,
            str(contents.quantity(part)),
            str(part.spares or ""),
            str(part.material),
            _size(part),
            part.finish,
        )
        for part in contents.made
    ]
    widths = [max(len(row[i]) for row in (heads, *rows)) for i in range(len(heads) - 1)]
    left = "  " + " " * sum(w + 2 for w in widths)

    def line(row: Sequence[str]) -> list[str]:
        start = "  " + "".join(cell.ljust(w + 2) for cell, w in zip(row, widths))
        room = max(WIDTH - len(start), 24)
        finish = wrap(row[-1], room) or [""]
        return [(start + finish[0]).rstrip(), *(left + more for more in finish[1:])]

    lines = line(heads)
    before = ""
    for part, row in zip(contents.made, rows):
        if part.process != before:
            lines += ["", f"{PROCESSES[part.process]}:"]
            before = part.process
        lines += line(row)
    lines.append("")
    return lines + _paragraph(
        "Quantities are for one of every set-up. Bought parts (screws, pins, bearings, gauges) stand in the "
        "bills of "
        "materials with make_buy = buy; they need no quotation unless we ask for one."
    )


def _short(contents: ReleaseContents, numbers: Sequence[str]) -> str:
    """Part numbers in a sentence, without the design's name, which most of them begin with."""
    return ", ".join(number.removeprefix(f"{contents.design.name}-") for number in numbers)


def _size(part: Part) -> str:
    low, high = part_box(part)
    return " x ".join(f"{round(b - a, 3):g}" for a, b in zip(low, high))


def _keys(contents: ReleaseContents) -> list[str]:
    """Each distinct key characteristic with the parts that have it."""
    groups: dict[Characteristic, list[str]] = {}
    for part in contents.made:
        for c in part.characteristics:
            if c.key:
                groups.setdefault(c, []).append(part.part_no)
    lines = []
    for c, numbers in groups.items():
        lines.append(f"  {c.name}: {c.nominal:g} mm, {round(c.lower, 6):g} to {round(c.upper, 6):g}")
        lines += _paragraph(_short(contents, numbers), "      ")[:-1]
    return [*lines, ""] + _paragraph(
        f"Part numbers here and below without {contents.design.name}-. Measure these on every element and "
        f"record them in {inspection.NAME}, by the element's number (E1, E2, ...: mark the "
        "bags, not the parts). Every other dimension without its own tolerance: ISO 2768-1:1989-m, ISO "
        "2768-2:1989-K."
    )


def _how(contents: ReleaseContents) -> list[str]:
    """The parts' own notes, each once, with the parts that it holds for."""
    groups: dict[str, list[str]] = {}
    for part in contents.made:
        for note in part.notes:
            groups.setdefault(note, []).append(part.part_no)
    notes = []
    for note, numbers in groups.items():
        which = "" if len(numbers) == len(contents.made) else f" ({_short(contents, numbers)})"
        notes.append(f"{note[:1].upper()}{note[1:]}{which}.")
    return _listed(notes)


def _files(paths: Sequence[str]) -> list[str]:
    lines = []
    for start, text in FOLDERS.items():
        count = sum(path.startswith(start) for path in paths)
        if count or start == MANIFEST:
            shown = (
                f"{start} ({count} files)" if start.endswith("/") else "bom*.csv" if start == "bom" else start
            )
            lines += _paragraph(text, " " * 22, f"  {shown:20}")[:-1]
    return [*lines, ""] + _paragraph(
        "A part's files carry its part number and the revision. Drawing and STEP file agree; where you find "
        "that they do "
        "not, the drawing holds and we want to know."
    )


def _questions(contents: ReleaseContents) -> list[str]:
    material = contents.design.material
    supply = f"Whether your machine has an anti-electrolysis supply: {material.alloy} pits without it."
    return _listed(
        [
            "Wire diameter, and how many passes you give the hinge; the surface (Ra) and recast layer that "
            "they leave.",
            "Whether you hold the hinge thickness as toleranced, and with what you measure it.",
            "The order of cuts, and how the hinge is kept from bending when the slug drops (tab, adhesive, "
            "order).",
            "How the holes of the elements are made: wire-cut from a start hole (as drawn), or reamed.",
            *([supply] if family(material.density) == "aluminium" else []),
            "Price and delivery for the quantities above, and for twice the elements.",
        ]
    )


def _flags(contents: ReleaseContents) -> list[str]:
    if not contents.flags:
        return ["Nothing.", ""]
    return _listed(list(dict.fromkeys(str(f).removeprefix("flag: ") for f in contents.flags)))
