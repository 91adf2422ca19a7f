"""README.txt of a release, which a shop reads first. Plain ASCII apart from the design's own texts, 96
columns.
"""

from __future__ import annotations

from collections.abc import Sequence

from tactcad import __version__
from tactcad.design.materials import ELECTROLYSIS, family
from tactcad.drawing.engine.extent import part_box
from tactcad.export import inspection
from tactcad.export import strength_table as strength
from tactcad.parts.description import Characteristic, Part
from tactcad.parts.hinge_section import thickness_elasticity
from tactcad.parts.layout import Layout

from .archive import MANIFEST
from .ordered import SETS, SPARES
from .plain_text import as_bytes, heading, numbered, paragraph, table
from .release_contents import PROCESSES, ReleaseContents

MARK = "PRELIMINARY"
DRAFT = f"{MARK}: for discussion only. Do not make anything from these files."
SAMPLE = "SAMPLE, NOT FOR ORDER: nobody has asked for these parts, and nobody answers for them."
FOLDERS = {
    "dxf/": "cut files, exact nominal contours, millimetres, one part a file: the wire-cut parts whole, of "
    "milled and ground "
    "plates the blank with its plain through holes. Compensation for wire and spark gap is yours.",
    "step/": "every part as a solid, and every assembly (AP214, millimetres); NAME-ap242.step: the same "
    "part with its limits and datums on its faces, for machines to read (AP242)",
    "circuit/": "the circuit that reads the array: KiCad netlist, the same as a table and as a SPICE "
    "deck, and the list of leads to cut",
    "pdf/": "a drawing sheet for every part made, and an assembly sheet with parts list for every scene",
    "guide/": "how each scene is put together, step by step: open guide/SCENE.html in a browser",
    "bom": "bills of materials: bom.csv of the array, bom-SCENE.csv of the other scenes",
    inspection.NAME: "what to measure on every numbered element: fill in `measured` (and `uncertainty_k2`, "
    "expanded, "
    "k = 2, if you state it) and send it back. Decimal points, mm.",
    "inspection-parts.csv": "what to measure on other parts, what matters most to the assembled sensor first",
    "stack.csv": "how the limits of the parts add up; for information",
    strength.NAME: "what every element is rated for; for information",
    MANIFEST: f"SHA-256 of every file; `sha256sum -c {MANIFEST}` checks them",
}


def readme_bytes(contents: ReleaseContents, paths: Sequence[str]) -> bytes:
    """The text for a release that holds `paths`, UTF-8 with line ends that every editor shows."""
    made = contents.made
    lines = [*first_lines(contents, contents.design.design.title)]
    for head, body in (
        ("WHAT IT IS", _what(contents)),
        ("WHAT TO MAKE", _to_make(contents)),
        ("KEY CHARACTERISTICS", keys(contents, made)),
        ("HOW TO MAKE IT", how(contents, made)),
        ("WHICH FILE IS WHAT", _files(paths)),
        ("WITH YOUR QUOTATION PLEASE TELL US", numbered([*wire_questions(contents), *QUOTE])),
        ("WHAT OUR CHECKS OF CUTTING AND MACHINING FLAGGED", _flags(contents)),
        ("CONTACT", contact(contents)),
    ):
        lines += [*heading(head), *body]
    return as_bytes(lines)


def first_lines(contents: ReleaseContents, title: str) -> list[str]:
    """Name, revision and title; how far it holds; who issued it."""
    identity = contents.design.design
    lines = [*heading(f"{identity.name}, revision {identity.revision}: {title}", "="), ""]
    if contents.sample:
        lines += paragraph(SAMPLE)
    if contents.draft:
        lines += _draft(contents)
    people = ", ".join(dict.fromkeys(p for p in (identity.author, identity.organisation) if p))
    return lines + paragraph(
        f"Issued {identity.date}{f' by {people}' if people else ''}. Made with tactcad {__version__}. "
        f"Every file here is revision {identity.revision}; do not mix it with files of another."
    )


def contact(contents: ReleaseContents) -> list[str]:
    identity = contents.design.design
    people = ", ".join(dict.fromkeys(p for p in (identity.organisation, identity.contact) if p))
    return paragraph(
        f"{people}. Please ask before you change anything." if people else "None: this is a sample."
    )


def _draft(contents: ReleaseContents) -> list[str]:
    lines = paragraph(DRAFT)
    if contents.failures:
        lines += ["It could not be released because:", *numbered(contents.failures)]
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
    return paragraph(text)


def _to_make(contents: ReleaseContents) -> list[str]:
    lines = parts_table(contents, contents.made)
    lines += paragraph(f"Quantities are for {SETS[contents.sets]}.")
    lines += paragraph(SPARES)
    return lines + paragraph(
        "Bought parts (screws, pins, bearings, gauges) stand in the bills of materials with make_buy = buy; "
        "they need no quotation unless we ask for one. The zips beside this one hold the same order by way "
        "of making, each with its own files alone."
    )


def parts_table(contents: ReleaseContents, parts: Sequence[Part]) -> list[str]:
    heads = ("part", "qty", "spares", "material", "size, mm", "finish")
    groups: dict[str, list[tuple[str, ...]]] = {}
    for part in parts:
        row = (
            part.part_no,
            f"{contents.quantity(part):g}",
            str(part.spares or ""),
            str(part.material),
            size_text(part),
            part.finish,
        )
        groups.setdefault(PROCESSES[part.process], []).append(row)
    return table(heads, [*groups.items()])


def _short(contents: ReleaseContents, numbers: Sequence[str]) -> str:
    """Part numbers in a sentence, without the design's name, which most of them begin with."""
    return ", ".join(number.removeprefix(f"{contents.design.name}-") for number in numbers)


def size_text(part: Part) -> str:
    low, high = part_box(part)
    return " x ".join(f"{round(b - a, 3):g}" for a, b in zip(low, high))


def keys(contents: ReleaseContents, parts: Sequence[Part]) -> list[str]:
    """Each distinct key characteristic with the parts that have it; empty where they have none."""
    groups: dict[Characteristic, list[str]] = {}
    for part in parts:
        for c in part.characteristics:
            if c.key:
                groups.setdefault(c, []).append(part.part_no)
    lines = []
    for c, numbers in groups.items():
        lines.append(f"  {c.name}: {c.nominal:g} mm, {round(c.lower, 6):g} to {round(c.upper, 6):g}")
        lines += paragraph(_short(contents, numbers), "      ")[:-1]
    return lines and [*lines, ""] + paragraph(
        f"Part numbers here and below without {contents.design.name}-. Measure these on every element and "
        f"record them in {inspection.NAME}, by the element's number (E1, E2, ...: mark the "
        "bags, not the parts). Every other dimension without its own tolerance: ISO 2768-1:1989-m, ISO "
        "2768-2:1989-K."
    )


def how(contents: ReleaseContents, parts: Sequence[Part]) -> list[str]:
    """The parts' own notes, each once, with the parts that it holds for."""
    groups: dict[str, list[str]] = {}
    for part in parts:
        for note in part.notes:
            groups.setdefault(note, []).append(part.part_no)
    notes = []
    for note, numbers in groups.items():
        which = "" if len(numbers) == len(parts) else f" ({_short(contents, numbers)})"
        notes.append(f"{note[:1].upper()}{note[1:]}{which}.")
    return numbered(notes)


def _files(paths: Sequence[str]) -> list[str]:
    lines = []
    for start, text in FOLDERS.items():
        count = sum(path.startswith(start) for path in paths)
        if count or start == MANIFEST:
            shown = (
                f"{start} ({count} files)" if start.endswith("/") else "bom*.csv" if start == "bom" else start
            )
            lines += paragraph(text, " " * 24, f"  {shown:22}")[:-1]
    return [*lines, ""] + paragraph(
        "A part's files carry its part number and the revision. Drawing and STEP file agree; where you find "
        "that they do "
        "not, the drawing holds and we want to know."
    )


QUOTE = ("Price and delivery for the quantities above, and for twice the elements.",)


def wire_questions(contents: ReleaseContents) -> list[str]:
    """What a wire-cutting shop is asked."""
    material = contents.design.material
    harm = ELECTROLYSIS.get(family(material.density), "")
    supply = f"Whether your machine has an anti-electrolysis supply: {material.alloy} {harm} without it."
    return [
        "Wire diameter, and how many passes you give the hinge; the surface (Ra) and recast layer that "
        "they leave.",
        "Whether you hold the hinge thickness as toleranced, and with what you measure it.",
        "The order of cuts, and how the hinge is kept from bending when the slug drops "
        "(tab, adhesive, order).",
        "How the holes of the elements are made: wire-cut from a start hole (as drawn), or reamed.",
        *([supply] if harm else []),
    ]


def _flags(contents: ReleaseContents) -> list[str]:
    if not contents.flags:
        return ["Nothing.", ""]
    return numbered(list(dict.fromkeys(str(f).removeprefix("flag: ") for f in contents.flags)))
