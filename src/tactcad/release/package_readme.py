"""README.txt of a supplier's package."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from tactcad.checks.shop import Shop
from tactcad.parts.description import Part
from tactcad.parts.electronic_parts import BOARD

from .archive import MANIFEST
from .ordered import SETS, SPARES
from .packages import MACHINING, ORDER, PART_INSPECTION, SHEET, WIRE, Packed, table_rows
from .plain_text import as_bytes, heading, numbered, paragraph, table
from .readme import QUOTE, contact, first_lines, how, keys, parts_table, wire_questions
from .release_contents import ReleaseContents

FILES = {
    ORDER: "what is ordered, a line each, with the files that it is made from and their SHA-256",
    "dxf/": "cut files, exact nominal contours, millimetres, one part a file; tool compensation is yours",
    "pdf/": "drawing sheets",
    "circuit/": "netlist of the boards (KiCad, and the same as a table, a row a pin)",
    "step/": "solids (AP214, millimetres); NAME-ap242.step with limits and datums on the faces (AP242)",
    "inspection.csv": "what to measure on every numbered element: fill in `measured` and send it back",
    PART_INSPECTION: "what to measure on the other parts",
    MANIFEST: f"SHA-256 of every file; `sha256sum -c {MANIFEST}` checks them",
}


BOARDS = (
    "No layout comes with this order: who makes the boards lays them out by the netlist, which names no "
    "footprints, and by the circuit sheets. The netlist holds the circuits of all boards: U, J and C of a "
    "board begin with its number, Q and R with that of the element that it reads. All boards are alike, with "
    "room for every channel of the multiplexer, and for a link from each of its inputs to GND, which the "
    "netlist has where no element is read: there Q and R stay off. Leads W, gauges B and terminals X are not "
    "on them. Keep the lines between lead header, resistors and multiplexer short, those of + and - alike."
)


def package_readme(contents: ReleaseContents, one: Packed, whole: str, shop: Shop) -> bytes:
    """The text.

    Parameters
    ----------
    contents, one
        The release, and the package.
    whole
        Name of the zip that the package was taken from, with its SHA-256.
    shop
        Whose feed the wire's time was estimated with.
    """
    lines = first_lines(contents, one.package.title)
    lines += paragraph(
        f"Taken from {whole}. What this order does not need is left out; ask for the rest if you miss it."
    )
    for head, body in (
        ("WHAT IS ORDERED", _ordered(contents, one)),
        *_sections(contents, one, shop),
        ("WHICH FILE IS WHAT", _files(one.files)),
        ("CONTACT", contact(contents)),
    ):
        if body:
            lines += [*heading(head), *body]
    return as_bytes(lines)


def _parts(one: Packed) -> list[Part]:
    return [line.part for line in one.lines if line.part is not None]


def _ordered(contents: ReleaseContents, one: Packed) -> list[str]:
    if one.package in (WIRE, MACHINING):
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
        return (("CIRCUIT BOARD", paragraph(BOARDS)),)
    if one.package is WIRE:
        return (
            ("TIME ON THE MACHINE", _wire_time(one, shop)),
            ("KEY CHARACTERISTICS", keys(contents, parts)),
            ("HOW TO MAKE IT", how(contents, parts)),
            ("WITH YOUR QUOTATION PLEASE TELL US", numbered([*wire_questions(contents), *QUOTE])),
        )
    if one.package is MACHINING:
        return (
            ("KEY CHARACTERISTICS", keys(contents, parts)),
            ("HOW TO MAKE IT", how(contents, parts)),
            (
                "WITH YOUR QUOTATION PLEASE TELL US",
                numbered(["Price and delivery for the quantities above."]),
            ),
        )
    return ()


def _wire_time(one: Packed, shop: Shop) -> list[str]:
    rows = table_rows(one.files[ORDER])
    minutes = sum(float(row["minutes"]) for row in rows)
    length = sum(float(row["cut_length_mm"]) * float(row["order"]) for row in rows)
    heights = sorted({float(row["height_mm"]) for row in rows})
    feed, source = shop.feed, shop.feed_source
    return paragraph(
        f"About {minutes / 60:.1f} h for {length / 1000:.2f} m of contour, heights "
        f"{', '.join(f'{h:g}' for h in heights)} mm, one piece at a time; {ORDER} has it by part. Estimated "
        f"with a main cut of {feed.area:g} mm2/min ({source['area']}), at most {feed.most:g} mm/min "
        f"({source['most']}), every further pass {feed.skim:g} mm/min ({source['skim']}), and "
        f"{feed.threading:g} min for each contour's start ({source['threading']}). Limits of {shop.name}; "
        "your own figures hold."
    )


def _sheet_table(one: Packed) -> list[str]:
    """Blanks by material and thickness, and how much sheet they are in all."""
    groups: dict[str, list[tuple[str, ...]]] = {}
    area: dict[str, float] = {}
    for row in table_rows(one.files[ORDER]):
        material = f"{row['material']}, {row['standard']}" if row["standard"] else row["material"]
        title = f"{row['thickness_mm']} mm {material}"
        blank = float(row["length_mm"]) * float(row["width_mm"])
        area[title] = area.get(title, 0.0) + blank * float(row["order"])
        cells = (row["part_no"], row["order"], f"{row['length_mm']} x {row['width_mm']}", _blank_for(row))
        groups.setdefault(title, []).append(cells)
    titled = [(f"{title} ({area[title] / 100:.0f} cm2 net)", rows) for title, rows in groups.items()]
    lines = table(("for part", "pieces", "at least, mm", "how"), titled)
    return lines + paragraph(
        "Sizes are the parts' own: what the cut and the clamping take comes on top, as who cuts them says. "
        "Thickness with limits: picked from rolled sheet that measures so. Plate that is milled: at least "
        "that thickness, more where the drawing asks for both faces machined. Round and block "
        "stock is its shop's."
    )


def _blank_for(row: Mapping[str, str]) -> str:
    limits = f"{row['least_mm']} to {row['most_mm']} mm thick; " if row["least_mm"] else ""
    if row["for"] != "wire-cut":
        return f"blank by its DXF (laser, water jet or saw), to be {row['for']}"
    return f"{limits}as sheet, to the wire cutter"


def _files(paths: Mapping[str, bytes]) -> list[str]:
    lines = []
    for start, text in FILES.items():
        count = sum(path.startswith(start) for path in paths)
        if count or start == MANIFEST:
            shown = f"{start} ({count} files)" if start.endswith("/") else start
            lines += paragraph(text, " " * 24, f"  {shown:22}")[:-1]
    return [*lines, ""]
