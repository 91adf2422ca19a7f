"""README.txt of a release, which a shop reads first, and of each supplier's package.

Plain ASCII apart from the design's own texts, 96 columns.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from itertools import zip_longest
from textwrap import wrap

from tactcad import __version__
from tactcad.checks.shop import Shop
from tactcad.design.family import family_of
from tactcad.design.materials import ELECTROLYSIS, family
from tactcad.drawing.engine.boxes import part_box
from tactcad.drawing.engine.paper import GENERAL_TOLERANCES
from tactcad.export import inspection
from tactcad.export import strength_table as strength
from tactcad.export.formats import part_formats
from tactcad.parts.array.hinge_section import thickness_elasticity
from tactcad.parts.array.layout import Layout
from tactcad.parts.bought.electronic_parts import BOARD
from tactcad.parts.language.description import Characteristic, Part
from tactcad.parts.language.finding import grouped
from tactcad.scenes.rig import ARRAY

from .archive import MANIFEST
from .packages import ETCHING, MACHINING, ORDER, PART_INSPECTION, SHEET, WIRE, Packed, table_rows
from .release_contents import PROCESSES, SETS, SPARES, ReleaseContents

MARK = "PRELIMINARY"
DRAFT = f"{MARK}: for discussion only. Do not make anything from these files."
SAMPLE = "SAMPLE, NOT FOR ORDER: nobody has asked for these parts, and nobody answers for them."
FOLDERS = {
    **{f.folder: f.released for f in sorted(part_formats(), key=lambda f: -f.ordered) if f.released},
    "nest/": "what is cut from one sheet, side by side, with start holes and tabs: DXF and picture for each "
    "material and thickness",
    "circuit/": "the circuit that reads the array as a table and as a SPICE deck, the list of leads to cut, "
    "the harness; in boards/ the boards: KiCad, Gerber, drills, bill, places",
    "pdf/": "a drawing sheet for every part made, and an assembly sheet with parts list for every scene",
    "guide/": "how each scene is put together, step by step: open guide/SCENE.html in a browser",
    "bom": "bills of materials: bom.csv of the array, bom-SCENE.csv of the other scenes",
    inspection.NAME: "what to measure on every numbered element: fill in `measured` (and `uncertainty_k2`, "
    "expanded, k = 2, if you state it) and send it back. Decimal points, mm.",
    "inspection-parts.csv": "what to measure on other parts, what matters most to the assembled sensor first",
    "stack.csv": "how the limits of the parts add up; for information",
    strength.NAME: "what every element is rated for; for information",
    MANIFEST: f"SHA-256 of every file; `sha256sum -c {MANIFEST}` checks them",
}


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
        ("WHICH FILE IS WHAT", _files(paths, FOLDERS) + paragraph(AGREE)),
        ("WITH YOUR QUOTATION PLEASE TELL US", numbered([*wire_questions(contents), *QUOTE])),
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
    return lines + paragraph(
        f"Issued {identity.date}{f' by {people}' if people else ''}. Made with tactcad {__version__}. "
        f"This is revision {identity.revision} as a whole; the tables name each part's own (rev): one that "
        "has not changed since an earlier revision keeps that letter. Do not use a file with any other "
        "letter."
    )


def contact(contents: ReleaseContents) -> list[str]:
    identity = contents.design.design
    people = ", ".join(dict.fromkeys(p for p in (identity.organisation, identity.contact) if p))
    return paragraph(
        f"{people}. Please ask before you change anything." if people else "None: this is a sample."
    )


def _what(contents: ReleaseContents) -> list[str]:
    design = contents.design
    family = family_of(design)
    text = family.about(family.layout(design))
    others = [scene.name for scene in contents.scenes if scene.name != ARRAY]
    if others:
        text += f" The set-ups that it is used in are here too: {', '.join(others)}."
    return paragraph(text)


def facing_rows(layout: Layout) -> str:
    """Description of an array of facing rows, for the shop."""
    design, count = layout.design, len(layout.elements)
    thinnest = min(layout.elements, key=lambda place: place.hinge.t)
    per_hundredth = thickness_elasticity(layout, thinnest) * 0.01 / thinnest.hinge.t
    return (
        f"A tactile sensor array of {count} sensing element{'s' if count > 1 else ''}, wire-cut from "
        f"{design.sheet.thickness:g} mm {design.material.alloy} sheet. Each has a hinge "
        f"{thinnest.hinge.t:g} mm thin, whose thickness decides its stiffness: one hundredth of a millimetre "
        f"more or less is {100 * per_hundredth:.0f} % more or less stiffness. Everything else is "
        "ordinary plate work."
    )


def _to_make(contents: ReleaseContents) -> list[str]:
    lines = parts_table(contents, contents.made)
    lines += paragraph(f"Quantities are for {SETS[contents.sets]}.")
    lines += paragraph(SPARES)
    return lines + paragraph(
        "Bought parts (screws, pins, bearings, gauges) are in the bills of materials with make_buy = buy; "
        "they need no quotation unless we ask for one. The other zips split the same order by "
        "process, each with only its own files."
    )


def parts_table(contents: ReleaseContents, parts: Sequence[Part]) -> list[str]:
    heads = ("part", "rev", "qty", "spares", "material", "size, mm", "finish")
    groups: dict[str, list[tuple[str, ...]]] = {}
    for part in parts:
        low, high = part_box(part)
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
    return lines and [*lines, ""] + paragraph(
        f"Part numbers here and below without {contents.design.name}-. Measure these on every element and "
        f"record them in {inspection.NAME}, by the element's number (E1, E2, ...: mark the "
        f"boxes, not the parts). Every other dimension: {' '.join(GENERAL_TOLERANCES).replace('±', '+-')}."
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


AGREE = (
    "A part's files carry its part number and its revision. Drawing and STEP file agree; where you find "
    "that they do not, the drawing holds and we want to know."
)
QUOTE = ("Price and delivery for the quantities above, and for twice the elements.",)
# Filled in by who orders: the design's date is its drawings'.
DATES = "Order no. ____________  of ____________ (date)   delivery wanted by ____________"
PAPERS = (
    "With the delivery: a certificate of the material, EN 10204 3.1, with its heat number, for every line "
    f"whose `certificate` in {ORDER} says so."
)
PACKING = (
    "Packing: elements bend at hinges that are tenths of a millimetre thin. Each lies by its clamped end in "
    "its own compartment of a box or in foam, its arm free of everything, the box marked with its number; "
    "none lies loose in a bag, and none is tumbled or picked up by its arm. All other parts dry, wrapped one "
    "by one."
)


def wire_questions(contents: ReleaseContents) -> list[str]:
    """Questions to a wire-cutting shop."""
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


PACKAGE_FOLDERS = {
    ORDER: "what is ordered, a line each, with the files that it is made from and their SHA-256",
    "dxf/": "cut files, exact nominal contours, millimetres, one part a file; tool compensation is yours",
    "nest/": "a sheet's parts side by side: DXF (layers CUT, START: start holes, TAB: cut last, SHEET) and "
    "picture, as a proposal; nest as your machine likes",
    "pdf/": "drawing sheets",
    "circuit/": "the boards: gerber/ for the bare board; KiCad's board and netlist, bill and places of each "
    "as it is fitted",
    "step/": "solids (AP214, millimetres); NAME-ap242.step with limits and datums on the faces (AP242)",
    "inspection.csv": "what to measure on every numbered element: fill in `measured` and send it back",
    PART_INSPECTION: "what to measure on the other parts",
    MANIFEST: f"SHA-256 of every file; `sha256sum -c {MANIFEST}` checks them",
}


BOARDS = (
    "All bare boards are alike: make them by the files in gerber/ (Gerber X2, drills in millimetres; "
    "layers by their file function) and outline.dxf; 4 layers, FR-4 as thick as ordered, copper 35 um, "
    "tracks and gaps of 0.2 mm or more, vias of 0.3 mm. To fit them, NAME-bill.csv says which part "
    "goes where, and what is left off; NAME-places.csv has the places of what a machine fits. NAME.kicad_pcb "
    "is the same board for KiCad 6, NAME.step its solid."
)


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
    lines += paragraph(
        f"Taken from {whole}. What this order does not need is left out; ask for the rest if you miss it."
    )
    for head, body in (
        ("WHAT IS ORDERED", _to_order(contents, one)),
        *_sections(contents, one, shop),
        ("WHICH FILE IS WHAT", _files([*one.files], PACKAGE_FOLDERS)),
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
    return lines + paragraph(f"Quantities are for {SETS[contents.sets]}.") + paragraph(SPARES)


def _sections(contents: ReleaseContents, one: Packed, shop: Shop) -> Sequence[tuple[str, list[str]]]:
    parts = _parts(one)
    if any(line.row.part_no == BOARD for line in one.lines):
        of = contents.design.design.of_board
        return (("CIRCUIT BOARD", paragraph(f"{of.board_no}, revision {of.revision}. {BOARDS}")),)
    if one.package is WIRE:
        return (
            ("TIME ON THE MACHINE", _wire_time(one, shop)),
            ("DELIVERY", [DATES, "", *paragraph(PAPERS), *paragraph(PACKING)]),
            ("KEY CHARACTERISTICS", keys(contents, parts)),
            ("HOW TO MAKE IT", how(contents, parts)),
            ("WITH YOUR QUOTATION PLEASE TELL US", numbered([*wire_questions(contents), *QUOTE])),
        )
    if one.package is MACHINING:
        return (
            ("DELIVERY", [DATES, ""]),
            ("KEY CHARACTERISTICS", keys(contents, parts)),
            ("HOW TO MAKE IT", how(contents, parts)),
            (
                "WITH YOUR QUOTATION PLEASE TELL US",
                numbered(["Price and delivery for the quantities above."]),
            ),
        )
    if one.package in (SHEET, ETCHING):
        return (("DELIVERY", [DATES, "", *paragraph(PAPERS)]),)
    return (("DELIVERY", [DATES, ""]),)


def _wire_time(one: Packed, shop: Shop) -> list[str]:
    rows = table_rows(one.files[ORDER])
    minutes = sum(float(row["minutes"]) for row in rows)
    length = sum(float(row["cut_length_mm"]) * float(row["order"]) for row in rows)
    heights = sorted({float(row["height_mm"]) for row in rows})
    feed, source = shop.feed, shop.feed_source
    return paragraph(
        f"About {minutes / 60:.1f} h for {length / 1000:.2f} m of contour, heights "
        f"{', '.join(f'{h:g}' for h in heights)} mm; parts whose limits one pass holds are cut in packs, "
        f"all others one at a time; {ORDER} has it by part. Estimated "
        f"with a main cut of {feed.area:g} mm2/min ({source['area']}), at most {feed.most:g} mm/min "
        f"({source['most']}), every further pass {feed.skim:g} mm/min ({source['skim']}), and "
        f"{feed.threading:g} min for each contour's start ({source['threading']}). Limits of {shop.name}; "
        "your own figures hold."
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
    return lines + paragraph(
        "Thickness is that of the stock as sold, with its limits; for closer limits, pick rolled sheet that "
        "measures within them. Sizes of blanks include what is machined off each edge. Sheet for the wire "
        "cutter is as large as its nest (nest/), or as its machine takes. The machining shop has its own "
        "round and block stock."
    )


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
