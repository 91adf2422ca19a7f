"""README.txt of a release, which a shop reads first, and of each supplier's package.

Plain ASCII apart from the design's own texts, 96 columns.
"""

from __future__ import annotations

import tomllib
from collections import defaultdict
from collections.abc import Mapping, Sequence
from itertools import zip_longest
from pathlib import Path
from textwrap import wrap

from tactcad import __version__
from tactcad.checks.shop import Shop
from tactcad.design.family import family_of
from tactcad.design.materials import ELECTROLYSIS, family
from tactcad.drawing.engine.paper import GENERAL_TOLERANCES
from tactcad.export import inspection
from tactcad.export.formats import part_formats
from tactcad.parts.array.hinge_section import thickness_elasticity
from tactcad.parts.array.layout import Layout
from tactcad.parts.bought.electronic_parts import BOARD
from tactcad.parts.language.description import Characteristic, Part
from tactcad.parts.language.finding import grouped
from tactcad.scenes.rig import ARRAY

from .archive import MANIFEST
from .packages import ETCHING, MACHINING, ORDER, SHEET, WIRE, Packed, table_rows
from .release_contents import PROCESSES, SETS, SPARES, ReleaseContents

_WORDS = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
FOLDERS = {
    **{f.folder: f.released for f in sorted(part_formats(), key=lambda f: -f.ordered) if f.released},
    **_WORDS["folders"],
}


def say(name: str, **blanks: object) -> str:
    """Words of readme.toml."""
    return _WORDS["say"][name].format(**blanks)


SAMPLE, DRAFT = say("sample"), say("draft")


def readme_bytes(contents: ReleaseContents, paths: Sequence[str]) -> bytes:
    """The text for a release that holds `paths`, UTF-8 with line ends that every editor shows."""
    made = contents.made
    flagged = numbered(grouped(contents.flags)) if contents.flags else ["Nothing.", ""]
    lines = [*first_lines(contents, contents.design.design.title)]
    for head, body in (
        ("WHAT IT IS", _what(contents)),
        ("WHAT TO MAKE", _to_make(contents)),
        ("KEY CHARACTERISTICS", keys(contents, made)),
        ("HOW TO MAKE IT", how(contents, made)),
        ("WHICH FILE IS WHAT", _files(paths, FOLDERS) + paragraph(say("agree"))),
        ("WITH YOUR QUOTATION PLEASE TELL US", numbered(wire_questions(contents))),
        ("WHAT OUR CHECKS OF CUTTING AND MACHINING FLAGGED", flagged),
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
        lines += paragraph(DRAFT)
        if contents.failures:
            lines += ["It could not be released because:", *numbered(contents.failures)]
    people = ", ".join(dict.fromkeys(p for p in (identity.author, identity.organisation) if p))
    by, version = f" by {people}" if people else "", __version__
    issued = say("issued", date=identity.date, by=by, version=version, revision=identity.revision)
    return lines + paragraph(issued)


def contact(contents: ReleaseContents) -> list[str]:
    identity = contents.design.design
    people = ", ".join(dict.fromkeys(p for p in (identity.organisation, identity.contact) if p))
    return paragraph(say("contact", people=people) if people else say("no contact"))


def _what(contents: ReleaseContents) -> list[str]:
    design = contents.design
    family = family_of(design)
    text = family.about(family.layout(design))
    others = [scene.name for scene in contents.scenes if scene.name != ARRAY]
    if others:
        text += say("set-ups", names=", ".join(others))
    return paragraph(text)


def facing_rows(layout: Layout) -> str:
    """Description of an array of facing rows, for the shop."""
    design, count = layout.design, len(layout.elements)
    thinnest = min(layout.elements, key=lambda place: place.hinge.t)
    per_hundredth = thickness_elasticity(layout, thinnest) * 0.01 / thinnest.hinge.t
    return say(
        "facing rows",
        elements=f"{count} sensing element{'s' if count > 1 else ''}",
        sheet=design.sheet.thickness,
        alloy=design.material.alloy,
        hinge=thinnest.hinge.t,
        percent=100 * per_hundredth,
    )


def _to_make(contents: ReleaseContents) -> list[str]:
    quantities = say("quantities", sets=SETS[contents.sets])
    return parts_table(contents, contents.made) + [
        line for text in (quantities, SPARES, say("bought")) for line in paragraph(text)
    ]


def parts_table(contents: ReleaseContents, parts: Sequence[Part]) -> list[str]:
    heads = ("part", "rev", "qty", "spares", "material", "size, mm", "finish")
    groups: dict[str, list[tuple[str, ...]]] = {}
    for part in parts:
        low, high = part.body.box
        row = (
            part.part_no,
            contents.design.design.of_part(part.part_no).revision,
            f"{contents.quantity(part):g}",
            str(part.spares or ""),
            str(part.material),
            " x ".join(f"{round(b - a, 3):g}" for a, b in zip(low, high)),
            part.finish,
        )
        groups.setdefault(PROCESSES[part.process], []).append(row)
    return table(heads, [*groups.items()])


def _short(contents: ReleaseContents, numbers: Sequence[str]) -> str:
    """Part numbers in a sentence, without the design's name, which most of them begin with."""
    return ", ".join(number.removeprefix(f"{contents.design.name}-") for number in numbers)


def keys(contents: ReleaseContents, parts: Sequence[Part]) -> list[str]:
    """Each distinct key characteristic with its parts; empty if there are none."""
    groups: dict[Characteristic, list[str]] = {}
    for part in parts:
        for c in part.characteristics:
            if c.key:
                groups.setdefault(c, []).append(part.part_no)
    lines = []
    for c, numbers in groups.items():
        lines.append(f"  {c.name}: {c.nominal:g} mm, {round(c.lower, 6):g} to {round(c.upper, 6):g}")
        lines += paragraph(_short(contents, numbers), "      ")[:-1]
    general = " ".join(GENERAL_TOLERANCES).replace("±", "+-")
    measured = say("keys", design=contents.design.name, sheet=inspection.NAME, general=general)
    return lines and [*lines, ""] + paragraph(measured)


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


def _files(paths: Sequence[str], known: Mapping[str, str]) -> list[str]:
    """A description of each of the files, by known folders and names."""
    lines = []
    for start, text in known.items():
        count = sum(path.startswith(start) for path in paths)
        if count or start == MANIFEST:
            shown = (
                f"{start} ({count} files)" if start.endswith("/") else "bom*.csv" if start == "bom" else start
            )
            lines += paragraph(text, " " * 24, f"  {shown:22}")[:-1]
    return [*lines, ""]


def wire_questions(contents: ReleaseContents) -> list[str]:
    """Questions to a wire-cutting shop."""
    material = contents.design.material
    harm = ELECTROLYSIS.get(family(material.density), "")
    named = {"alloy": material.alloy, "harm": harm}
    asked = [text.format(**named) for name, text in _WORDS["wire"].items() if harm or name != "supply"]
    return [*asked, say("price")]


def package_readme(contents: ReleaseContents, one: Packed, whole: str, shop: Shop) -> bytes:
    """The text.

    Parameters
    ----------
    contents, one
        The release, and the package.
    whole
        Name of the whole zip, with its SHA-256.
    shop
        The shop whose feed gave the wire's time.
    """
    lines = first_lines(contents, one.package.title)
    lines += paragraph(say("taken from", whole=whole))
    for head, body in (
        ("WHAT IS ORDERED", _to_order(contents, one)),
        *_sections(contents, one, shop),
        ("WHICH FILE IS WHAT", _files([*one.files], _WORDS["package_folders"])),
        ("CONTACT", contact(contents)),
    ):
        if body:
            lines += [*heading(head), *body]
    return as_bytes(lines)


def _parts(one: Packed) -> list[Part]:
    return [line.part for line in one.lines if line.part is not None]


def _to_order(contents: ReleaseContents, one: Packed) -> list[str]:
    if one.package in (WIRE, ETCHING, MACHINING):
        lines = parts_table(contents, _parts(one))
    elif one.package is SHEET:
        lines = _sheet_table(one)
    else:
        rows = [
            (f"{r.order:g} {r.row.unit}", f"{r.row.spares:g}", r.row.standard_designation or r.row.mpn)
            for r in one.lines
        ]
        lines = table(("order", "of these spares", "designation"), [("", rows)])
    return lines + paragraph(say("quantities", sets=SETS[contents.sets])) + paragraph(SPARES)


def _sections(contents: ReleaseContents, one: Packed, shop: Shop) -> Sequence[tuple[str, list[str]]]:
    parts = _parts(one)
    if any(line.row.part_no == BOARD for line in one.lines):
        of = contents.design.design.of_board
        return (("CIRCUIT BOARD", paragraph(say("boards", board_no=of.board_no, revision=of.revision))),)
    if one.package is WIRE:
        return (
            ("TIME ON THE MACHINE", _wire_time(one, shop)),
            ("DELIVERY", [say("dates"), "", *paragraph(say("papers")), *paragraph(say("packing"))]),
            ("KEY CHARACTERISTICS", keys(contents, parts)),
            ("HOW TO MAKE IT", how(contents, parts)),
            ("WITH YOUR QUOTATION PLEASE TELL US", numbered(wire_questions(contents))),
        )
    if one.package is MACHINING:
        return (
            ("DELIVERY", [say("dates"), ""]),
            ("KEY CHARACTERISTICS", keys(contents, parts)),
            ("HOW TO MAKE IT", how(contents, parts)),
            ("WITH YOUR QUOTATION PLEASE TELL US", numbered([say("price of these")])),
        )
    if one.package in (SHEET, ETCHING):
        return (("DELIVERY", [say("dates"), "", *paragraph(say("papers"))]),)
    return (("DELIVERY", [say("dates"), ""]),)


def _wire_time(one: Packed, shop: Shop) -> list[str]:
    rows = table_rows(one.files[ORDER])
    minutes = sum(float(row["minutes"]) for row in rows)
    length = sum(float(row["cut_length_mm"]) * float(row["order"]) for row in rows)
    heights = sorted({float(row["height_mm"]) for row in rows})
    return paragraph(
        say(
            "wire time",
            hours=minutes / 60,
            length=length / 1000,
            heights=", ".join(f"{h:g}" for h in heights),
            order=ORDER,
            feed=shop.feed,
            source=shop.feed_source,
            shop=shop.name,
        )
    )


def _sheet_table(one: Packed) -> list[str]:
    """Blanks by material and thickness, and how much sheet they are in all."""
    groups: dict[str, list[tuple[str, ...]]] = {}
    area: dict[str, float] = {}
    sheets: defaultdict[str, str] = defaultdict(str)
    for row in table_rows(one.files[ORDER]):
        material = f"{row['material']}, {row['standard']}" if row["standard"] else row["material"]
        title = f"{row['thickness_mm']} mm {material}"
        if size := row.get("nest_sheet_mm"):
            pack = "" if row["nest_sheets"] == "1" else f"a pack of {row['nest_sheets']} sheets, each "
            sheets[title] = f", nested on {pack}{size} mm"
        blank = float(row["length_mm"]) * float(row["width_mm"])
        area[title] = area.get(title, 0.0) + blank * float(row["order"])
        size = f"{row['length_mm']} x {row['width_mm']}"
        cells = (row["part_no"], row["rev"], row["order"], size, _blank_for(row))
        groups.setdefault(title, []).append(cells)
    titled = [
        (f"{title} ({area[title] / 100:.0f} cm2 net{sheets[title]})", rows) for title, rows in groups.items()
    ]
    lines = table(("for part", "rev", "pieces", "at least, mm", "how"), titled)
    return lines + paragraph(say("sheet"))


def _blank_for(row: Mapping[str, str]) -> str:
    limits = f"{row['least_mm']} to {row['most_mm']} mm thick; " if row["least_mm"] else ""
    if row["for"] not in ("wire-cut", "etched"):
        edge, face = row["over_each_edge_mm"], row["over_each_face_mm"]
        return (
            f"blank by its DXF (laser, water jet or saw), {edge} mm over on each edge, {face} or more on "
            f"each face, no holes; to be {row['for']}"
        )
    if float(row["over_each_face_mm"]):
        return f"{limits}as plate, both faces ground to the drawing, then to be {row['for']}"
    return f"{limits}as sheet, to be {row['for']}"


WIDTH = 96
WIDEST = 32  # letters in a column, or its longest word: an aluminium with its standard takes one line


def paragraph(text: str, indent: str = "", first: str | None = None) -> list[str]:
    """The text in lines, and an empty one after it; `first` begins the first line where not `indent`."""
    start = indent if first is None else first
    return [*wrap(text, WIDTH, initial_indent=start, subsequent_indent=indent, break_on_hyphens=False), ""]


def numbered(texts: Sequence[str]) -> list[str]:
    lines: list[str] = []
    for n, text in enumerate(texts, start=1):
        lines += paragraph(text, "    ", f"{n:2}. ")[:-1]
    return [*lines, ""]


def heading(text: str, line: str = "-") -> list[str]:
    return [text, line * len(text)]


def table(heads: Sequence[str], groups: Sequence[tuple[str, Sequence[Sequence[str]]]]) -> list[str]:
    """Rows below their heads, group by group, each with its title; wide cells are wrapped."""
    rows = [heads, *(row for _, group in groups for row in group)]
    widths = [min(WIDEST, max(len(row[i]) for row in rows)) for i in range(len(heads) - 1)]
    widths = [max([w, *(len(word) for row in rows for word in row[i].split())]) for i, w in enumerate(widths)]
    widths.append(max(WIDTH - sum(w + 2 for w in widths) - 2, 17))

    def line(row: Sequence[str]) -> list[str]:
        cells = [wrap(cell, w) or [""] for cell, w in zip(row, widths)]
        across = zip_longest(*cells, fillvalue="")
        return [("  " + "  ".join(map(str.ljust, texts, widths))).rstrip() for texts in across]

    lines = line(heads)
    for title, group in groups:
        lines += ["", f"{title}:"] if title else []
        for row in group:
            lines += line(row)
    return [*lines, ""]


def as_bytes(lines: Sequence[str]) -> bytes:
    """UTF-8 with line ends that every editor shows."""
    return ("\r\n".join(lines).rstrip() + "\r\n").encode()
