"""A zip for each way of making: what that supplier needs, out of the whole zip, and nothing else; with the
time on the wire-cutting machine."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, floor

from tactcad.checks.shop import Feed, Shop
from tactcad.design.files import as_csv
from tactcad.design.tree import CommonTables
from tactcad.export import inspection
from tactcad.export.manifest import sha256_of
from tactcad.parts.array.element import least_passes
from tactcad.parts.bought.electronic_parts import BARE_BOARD, BOARD, ELECTRONIC, MECHANICAL
from tactcad.parts.language.description import Part
from tactcad.parts.language.stock import cut_section, own_thickness, stock_of
from tactcad.scenes.bom import read_in_sheet

from .nest import Nest, nest_dxf, nest_svg, nests
from .release_contents import OrderLine, ReleaseContents

ORDER = "order.csv"
CERTIFICATE = "EN 10204 3.1"
BOARDS = "circuit/boards/"
PART_INSPECTION = "inspection-parts.csv"
Row = dict[str, object]


@dataclass(frozen=True)
class Package:
    """A way of making: the end of its zip's name, its title, the processes (column of the bill) of its
    order's lines, and the lines' rows. `folders`: the folders of its parts' files."""

    name: str
    title: str
    processes: tuple[str, ...]
    folders: tuple[str, ...]
    row: Callable[[OrderLine, Mapping[str, str], Shop], Row]


@dataclass(frozen=True)
class Packed:
    """A package of a release: its lines, and its files but README and checksums, by path."""

    package: Package
    lines: tuple[OrderLine, ...]
    files: Mapping[str, bytes]


def order_nests(contents: ReleaseContents, shop: Shop) -> dict[str, Nest]:
    """The order's sheet and plate, each material and thickness on one sheet, by its files' path without
    ending."""
    made = [
        (line.part, round(line.order), _at_once(line, shop))
        for line in contents.lines
        if line.part is not None and not line.part.bought
    ]
    name, revision = contents.design.name, contents.design.design.revision
    return {f"nest/{name}-{n.name}_{revision}": n for wire in (True, False) for n in nests(made, wire)}


def nest_files(contents: ReleaseContents, shop: Shop) -> dict[str, bytes]:
    """The nests as DXF and pictures."""
    identity, found = contents.design.design, order_nests(contents, shop)
    pictures = {f"{s}.svg": nest_svg(n, identity.name, identity.revision) for s, n in found.items()}
    return {f"{stem}.dxf": nest_dxf(n) for stem, n in found.items()} | pictures


def _at_once(line: OrderLine, shop: Shop) -> int:
    part = _made(line)
    return wire_time(part, shop.feed, round(line.order)).at_once if part.process == "wire-cut" else 1


def packed(contents: ReleaseContents, files: Mapping[str, bytes], shop: Shop) -> list[Packed]:
    """Every package that has a line; `files`: the whole zip's."""
    found = order_nests(contents, shop)
    made = (_packed(package, contents, files, shop, found) for package in PACKAGES)
    return [one for one in made if one.lines]


def _packed(
    package: Package,
    contents: ReleaseContents,
    files: Mapping[str, bytes],
    shop: Shop,
    found: Mapping[str, Nest],
) -> Packed:
    lines = tuple(line for line in contents.lines if _belongs(package, line))
    own: dict[str, bytes] = {}
    rows = []
    for line in lines:
        taken = _files_of(package, line, contents.design, files)
        row = _common(line) | package.row(line, taken, shop)
        on = (s for s, n in found.items() if any(p.part_no == line.row.part_no for p in n.pieces))
        if package in (WIRE, SHEET) and (stem := next(on, None)):
            taken |= {"nest": f"{stem}.dxf", "nest_picture": f"{stem}.svg"}
            row["nest_sheet_mm"] = f"{found[stem].width:g} x {found[stem].height:g}"
            row["nest_sheets"] = str(found[stem].high)
        own |= {path: files[path] for path in taken.values()}
        rows.append(row | _digests(taken, files))
    if package is WIRE:
        own[inspection.NAME] = files[inspection.NAME]
    if package in (WIRE, MACHINING) and (limits := _of_parts(files.get(PART_INSPECTION, b""), lines)):
        own[PART_INSPECTION] = limits
    return Packed(package, lines, {ORDER: table_bytes(rows), **dict(sorted(own.items()))})


def _belongs(package: Package, line: OrderLine) -> bool:
    if package is SHEET:
        return (
            line.part is not None
            and not line.part.bought
            and None not in (cut_section(line.part), stock_of(line.part))
        )
    return line.row.process in package.processes


def _files_of(
    package: Package, line: OrderLine, design: CommonTables, files: Mapping[str, bytes]
) -> dict[str, str]:
    """The part's files that the package takes, by kind; of the board all that it is made and fitted from."""
    if line.row.part_no == BOARD:
        made = {path.removeprefix(BOARDS): path for path in sorted(files) if path.startswith(BOARDS)}
        sheets = f"pdf/{design.name}-circuit_{design.design.revision}.pdf"
        return made | ({"sheets": sheets} if sheets in files else {})
    stem = f"{line.row.part_no}_{line.row.rev}"
    paths = {
        "dxf": f"dxf/{stem}.dxf",
        "pdf": f"pdf/{stem}.pdf",
        "step": f"step/{stem}.step",
        "step_limits": f"step/{stem}-ap242.step",
    }
    if package is SHEET and line.part is not None and line.part.by_contour:
        return {}  # cut from the sheet by another
    needed = {kind: path for kind, path in paths.items() if path in files and kind in package.folders}
    if package is WIRE and line.part is not None and line.part.features:  # details that no contour shows
        needed["step"] = paths["step"]
    return needed


def _digests(taken: Mapping[str, str], files: Mapping[str, bytes]) -> dict[str, object]:
    return {
        f"{kind}{end}": v
        for kind, p in taken.items()
        for end, v in (("", p), ("_sha256", sha256_of(files[p])))
    }


def _common(line: OrderLine) -> dict[str, object]:
    row = line.row
    return {
        "part_no": row.part_no,
        "rev": row.rev,
        "description": row.description,
        "qty": f"{line.qty:g}",
        "spares": f"{row.spares:g}",
        "order": f"{line.order:g}",
        "unit": row.unit,
    }


def _material(part: Part) -> dict[str, object]:
    """Material and temper, and the standard by which it is ordered."""
    return {
        "material": f"{part.material.name} {part.material.temper}".strip(),
        "standard": part.material.standard,
    }


def _after(part: Part) -> str:
    """Note for a part measured before it is ordered: its thickness is not the drawn one."""
    own = own_thickness(part)
    return f"measured: thickness is {own.remark}" if own and own.remark else ""


def _made(line: OrderLine) -> Part:
    assert line.part is not None  # parts made have a solid
    return line.part


def _wire_row(line: OrderLine, taken: Mapping[str, str], shop: Shop) -> Row:
    part = _made(line)
    time = wire_time(part, shop.feed, round(line.order))
    return _material(part) | {
        "after": _after(part),
        "at_once": time.at_once,
        "height_mm": f"{time.height:g}",
        "cut_length_mm": f"{time.length:.3f}",
        "contours": time.contours,
        "passes": time.passes,
        "minutes_each": f"{time.minutes:.1f}",
        "minutes": f"{time.minutes * line.order:.0f}",
        "certificate": CERTIFICATE,
        "finish": part.finish,
    }


def _machined_row(line: OrderLine, taken: Mapping[str, str], shop: Shop) -> Row:
    part = _made(line)
    low, high = part.body.box
    return (
        {"process": part.process}
        | _material(part)
        | {f"{axis}_mm": f"{round(b - a, 3):g}" for axis, a, b in zip("xyz", low, high)}
        | {"mass_g": f"{part.mass:.4g}", "finish": part.finish}
    )


def _sheet_row(line: OrderLine, taken: Mapping[str, str], shop: Shop) -> Row:
    part = _made(line)
    stock, section = stock_of(part), cut_section(part)
    assert stock is not None and section is not None  # _belongs
    x0, y0, x1, y1 = section.outer.box
    return _material(part) | {
        "for": part.process,
        "thickness_mm": f"{stock.thickness:g}",
        "least_mm": f"{round(stock.lower, 6):g}",
        "most_mm": f"{round(stock.upper, 6):g}",
        "thickness_standard": stock.standard,
        "length_mm": f"{round(x1 - x0, 3):g}",
        "width_mm": f"{round(y1 - y0, 3):g}",
        "over_each_edge_mm": f"{stock.edge:g}",
        "over_each_face_mm": f"{stock.face:g}",
        "after": _after(part),
        "certificate": CERTIFICATE,
    }


def _bought_row(line: OrderLine, taken: Mapping[str, str], shop: Shop) -> Row:
    row = line.row
    texts = ("material", "manufacturer", "mpn", "supplier", "alternates")
    told = {"designation": row.standard_designation} | {name: getattr(row, name) for name in texts}
    return told | {
        "consumable": str(row.consumable).lower(),
        "source_verified": str(read_in_sheet(row)).lower(),
    }


WIRE = Package("wire-cutting", "wire cutting", ("wire-cut",), ("dxf", "pdf"), _wire_row)
ETCHING = Package("etching", "photo-etching", ("etched",), ("dxf", "pdf"), _sheet_row)
MACHINING = Package(
    "milling-and-turning",
    "milling, turning and grinding",
    ("milled", "turned", "ground"),
    ("dxf", "pdf", "step", "step_limits"),
    _machined_row,
)
SHEET = Package("sheet", "sheet and plate", (), ("dxf",), _sheet_row)
PACKAGES = (
    WIRE,
    ETCHING,
    MACHINING,
    SHEET,
    Package("purchase-mechanical", "purchase, mechanical", (MECHANICAL,), (), _bought_row),
    Package("purchase-electronic", "purchase, electronic", (ELECTRONIC,), (), _bought_row),
    Package("circuit-boards", "circuit boards", (BARE_BOARD,), (), _bought_row),
)


def table_bytes(rows: Sequence[Mapping[str, object]]) -> bytes:
    """The rows as CSV (RFC 4180, UTF-8), their columns in order of first appearance."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    return as_csv([names, *([row.get(name, "") for name in names] for row in rows)])


def table_rows(data: bytes) -> list[dict[str, str]]:
    """The rows of a written table."""
    return list(csv.DictReader(io.StringIO(data.decode(), newline="")))


def _of_parts(table: bytes, lines: Iterable[OrderLine]) -> bytes:
    """Rows of the inspection list for these parts; empty if there are none."""
    numbers = {line.row.part_no for line in lines}
    rows = [row for row in table_rows(table) if row["part_no"] in numbers]
    return table_bytes(rows) if rows else b""


PASSES = {"one pass": 1, "three passes": 3, "four passes": 4}


@dataclass(frozen=True)
class WireTime:
    """Wire time of one piece: length of all contours mm, height mm of the stack cut at once, and its pieces,
    contours, passes, minutes."""

    length: float
    height: float
    at_once: int
    contours: int
    passes: int
    minutes: float


# mm; chosen: the room for a low machine's clamps and flushing.
PACK = 40.0


def wire_time(part: Part, feed: Feed, pieces: int = 1) -> WireTime:
    """The time of one of the pieces.

    Every contour is cut in as many passes as the closest limit on it asks for; the main cut advances by
    feed.area over the height, at most feed.most, further passes by feed.skim; every contour is threaded once.
    What one pass holds is cut as packs, as many pieces in each as are no higher than PACK; all else alone.
    """
    section = cut_section(part)
    if section is None:
        raise TypeError(f"{part.part_no} is not wire-cut")
    limits = [c.upper - c.lower for c in part.characteristics if c != own_thickness(part)]
    passes = PASSES[least_passes(min(limits, default=2.0) / 2)]
    most = max(1, floor(PACK / section.thickness)) if passes == 1 else 1
    packs = ceil(pieces / min(most, pieces))
    at_once = ceil(pieces / packs)
    length, height, contours = section.cut_length, section.thickness * at_once, 1 + len(section.openings)
    main = length / min(feed.area / height, feed.most)
    minutes = main + (passes - 1) * length / feed.skim + contours * feed.threading
    return WireTime(length, height, at_once, contours, passes, minutes * packs / pieces)
