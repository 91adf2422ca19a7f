"""Blanks and wire-cut parts of one order side by side on one sheet: as DXF and picture, with start holes and
tabs, and the share of the sheet that is scrap.

Pieces lie in rows, the tallest first, each in the first row that has room; of several widths of sheet the one
with the least area is taken. A saw or a shear can part such rows; rectpack packs a little closer but was last
released in 2021, and spyrrow's search ends by the clock, so that no two runs agree.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from html import escape
from math import ceil, pi

from tactcad.contour import Arc, Contour, Line, Point, circle, rectangle
from tactcad.contour.segment import mapped, turned
from tactcad.export.dxf import layered_dxf
from tactcad.parts.language.description import Extrusion, Part
from tactcad.parts.language.stock import cut_section, stock_of

BORDER = 10.0  # mm around all pieces; chosen: for clamps
LEAST_GAP = 5.0  # mm between pieces, or the stock's thickness; chosen: the web holds, a start hole has room
START = 1.0  # mm, diameter of a start hole; chosen: drilled, twice the least that a wire is threaded through
TAB = 2.0  # mm of the outline that is cut last; chosen: holds a piece of some ten grams against the flushing
WIDEST, STEP = 600.0, 10.0  # mm, widths of sheet that are tried; chosen: a wire-cutting machine's tank


@dataclass(frozen=True)
class NestedPiece:
    """A section with its corner at (x, y) on the sheet, mm; `quarter`: turned by 90 degrees."""

    part_no: str
    section: Extrusion
    x: float
    y: float
    quarter: bool = False

    @property
    def size(self) -> Point:
        x0, y0, x1, y1 = self.section.outer.box
        return (y1 - y0, x1 - x0) if self.quarter else (x1 - x0, y1 - y0)

    def _placed(self, contour: Contour) -> Contour:
        x0, y0, _, y1 = self.section.outer.box
        dx, dy = (y1, -x0) if self.quarter else (-x0, -y0)
        run = (turned(s, (0.0, 0.0), pi / 2) if self.quarter else s for s in contour)
        return Contour(tuple(mapped(s, lambda p: (p[0] + (self.x + dx), p[1] + (self.y + dy))) for s in run))

    @cached_property
    def contours(self) -> tuple[Contour, ...]:
        """Openings, and the outline last, as they lie on the sheet."""
        return tuple(self._placed(c) for c in (*self.section.openings, self.section.outer))


@dataclass(frozen=True)
class Nest:
    """Pieces on a sheet of one material; lengths in mm. `high`: sheets that are cut at once, on each
    other."""

    material: str
    thickness: float
    high: int
    wire: bool
    width: float
    height: float
    pieces: tuple[NestedPiece, ...]

    @property
    def name(self) -> str:
        way = "wire" if self.wire else "plate"
        way += f"-{self.high}x" if self.high > 1 else ""
        kept = (c if c.isalnum() or c in ".-" else "-" for c in self.material.split(",")[0])
        return f"{way}-{self.thickness:g}mm-{''.join(kept)}".replace("--", "-").strip("-")

    @property
    def scrap(self) -> float:
        """Share of the sheet that is in no piece."""
        return 1.0 - sum(p.section.section_area for p in self.pieces) / (self.width * self.height)

    @cached_property
    def tabs(self) -> list[Line]:
        """The stretch of every outline that is cut last."""
        return [_tab(p.contours[-1]) for p in self.pieces]

    @property
    def starts(self) -> list[Contour]:
        """Start holes: in the middle of every opening, and outside of every outline, at its tab."""
        holes = []
        for piece, tab in zip(self.pieces, self.tabs):
            *openings, outline = piece.contours
            holes += [circle(c.centroid, START) for c in openings]
            (x, y), (x0, y0, x1, y1), out = tab.at(0.5), outline.box, LEAST_GAP / 2
            dx, dy = ((x == x1) - (x == x0), 0) if tab.start[0] == tab.end[0] else (0, (y == y1) - (y == y0))
            holes.append(circle((x + out * dx, y + out * dy), START))
        return holes


def _tab(outline: Contour) -> Line:
    """In the middle of the longest side that lies on the outline's box: of an element its clamped body's."""
    x0, y0, x1, y1 = outline.box
    flat = [s for s in outline if isinstance(s, Line)]
    sides = [s for s in flat if s.start[0] == s.end[0] in (x0, x1) or s.start[1] == s.end[1] in (y0, y1)]
    side = max(sides or flat, key=lambda s: round(s.length, 6))
    share = min(TAB / side.length, 1.0) / 2
    return Line(side.at(0.5 - share), side.at(0.5 + share))


def nests(ordered: Iterable[tuple[Part, int, int]], wire: bool) -> list[Nest]:
    """A nest for each material and thickness of stock.

    Parameters
    ----------
    ordered
        Parts with how many pieces of each, and how many are cut at once on each other.
    wire
        Wire-cut parts, as they lie in the sheet (never turned: it is rolled along the arms); else blanks of
        plates, by laser, water jet or saw.
    """
    groups: dict[tuple[str, float, int], list[tuple[Part, int]]] = {}
    for part, count, high in ordered:
        if (
            part.process != "etched"
            and (part.process == "wire-cut") == wire
            and (stock := stock_of(part))
            and cut_section(part)
        ):
            groups.setdefault((str(part.material), stock.thickness, high), []).append(
                (part, ceil(count / high))
            )
    return [_nested(*key, wire, some) for key, some in groups.items()]


def _nested(material: str, thickness: float, high: int, wire: bool, some: Sequence[tuple[Part, int]]) -> Nest:
    gap = max(LEAST_GAP, thickness)
    pieces = []
    for part, count in some:
        section = cut_section(part)
        assert section is not None  # of nests()
        piece = NestedPiece(part.part_no, section, 0.0, 0.0)
        x, y = piece.size
        pieces += [replace(piece, quarter=not wire and y > x)] * count
    pieces.sort(key=lambda p: (-p.size[1], -p.size[0], p.part_no))
    widest = float(ceil(max(p.size[0] for p in pieces) + 2 * BORDER - 1e-9))
    widths = [widest] + [w for i in range(1, round(WIDEST / STEP) + 1) if (w := STEP * i) > widest]
    packed = [(w, *_rows(pieces, w, gap)) for w in widths]
    # of equal areas the squarer sheet
    width, height, placed = min(packed, key=lambda one: (round(one[0] * one[1], 3), abs(one[0] - one[1])))
    return Nest(material, thickness, high, wire, width, height, tuple(placed))


def _rows(pieces: Sequence[NestedPiece], width: float, gap: float) -> tuple[float, list[NestedPiece]]:
    """Height of a sheet of that width, and the pieces on it: the tallest first, each in the first row that
    has room."""
    rows: list[list[float]] = []  # y of its lower edge, x that is free
    placed, top = [], BORDER
    for piece in pieces:
        wide, high = piece.size
        row = next((r for r in rows if r[1] + wide + BORDER <= width + 1e-9), None)
        if row is None:
            row = [top, BORDER]
            rows.append(row)
            top += high + gap
        placed.append(replace(piece, x=round(row[1], 6), y=round(row[0], 6)))
        row[1] += wide + gap
    return float(ceil(top - gap + BORDER - 1e-9)), placed


def nest_dxf(nest: Nest) -> bytes:
    """The nest as DXF: SHEET its outline, CUT the contours as nominal, START the start holes, TAB the last
    cuts."""
    box = (0.0, 0.0, nest.width, nest.height)
    layers: dict[str, Sequence[Contour | Line]] = {
        "SHEET": [rectangle(*box)],
        "START": nest.starts,
        "CUT": [c for p in nest.pieces for c in p.contours],
        "TAB": nest.tabs,
    }
    return layered_dxf(layers, box)


def nest_svg(nest: Nest, design: str, revision: str) -> bytes:
    """The nest as a picture, mm: every piece with its part number, without the design's name, under it."""
    w, h, title = nest.width, nest.height, f"{design} revision {revision}: {nest.name}"
    wide = max(w, 150.0)
    drawn = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide:g}mm" height="{h + 16:g}mm" '
        f'viewBox="0 -16 {wide:g} {h + 16:g}" font-family="sans-serif" font-size="3">',
        f"<title>{escape(title)}</title>",
        *(
            f'<text x="1" y="{y:g}">{escape(line)}</text>'
            for y, line in zip((-12, -7.5, -3), (title, nest_text(nest), "blue: start holes, red: cut last"))
        ),
        f'<rect width="{w:g}" height="{h:g}" fill="#e9ecef" stroke="#868e96" stroke-width="0.3"/>',
    ]
    for piece in nest.pieces:
        *openings, outline = piece.contours
        way = " ".join(_path(c, h) for c in (outline, *openings))
        look = 'fill="#fff" fill-rule="evenodd" stroke="#212529" stroke-width="0.2"'
        drawn.append(f'<path d="{way}" {look}/>')
        at = f'x="{outline.box[0]:.3f}" y="{h - outline.box[1] + 2.2:.3f}"'
        drawn.append(f'<text {at} font-size="2">{escape(piece.part_no.removeprefix(design + "-"))}</text>')
    for (x, y), r in ((hole.centroid, START / 2) for hole in nest.starts):
        drawn.append(f'<circle cx="{x:.3f}" cy="{h - y:.3f}" r="{r:g}" fill="#1971c2"/>')
    for (ax, ay), (bx, by) in ((tab.start, tab.end) for tab in nest.tabs):
        ends = f'x1="{ax:.3f}" y1="{h - ay:.3f}" x2="{bx:.3f}" y2="{h - by:.3f}"'
        drawn.append(f'<line {ends} stroke="#e03131" stroke-width="0.8"/>')
    return ("\n".join([*drawn, "</svg>"]) + "\n").encode()


def nest_text(nest: Nest) -> str:
    """Sheet and scrap in one line."""
    on = f", {nest.high} sheets on each other" if nest.high > 1 else ""
    return (
        f"{nest.material}, {nest.thickness:g} mm{on}: at least {nest.width:g} x {nest.height:g} mm, "
        f"{len(nest.pieces)} cut out, {nest.scrap:.0%} scrap"
    )


def _path(contour: Contour, height: float) -> str:
    """SVG's path of a contour, y downwards from a height (mm)."""
    if whole := contour.as_circle():
        (x, y), r = whole
        half = f"a{r:.4f} {r:.4f} 0 1 0"
        return f"M{x - r:.4f} {height - y:.4f}{half} {2 * r:.4f} 0{half} {-2 * r:.4f} 0z"
    way = [f"M{contour.segments[0].start[0]:.4f} {height - contour.segments[0].start[1]:.4f}"]
    for s in contour:
        end = f"{s.end[0]:.4f} {height - s.end[1]:.4f}"
        if isinstance(s, Arc):
            turns = f"{int(abs(s.sweep) > pi)} {int(not s.ccw)}"
            way.append(f"A{s.radius:.4f} {s.radius:.4f} 0 {turns} {end}")
        else:
            way.append(f"L{end}")
    return "".join(way) + "z"
