"""Sheets as files, at the paper's size: one vector PDF, the same bytes in every process, with searchable
texts; and SVG, with texts of the same width as in the PDF.
"""

from __future__ import annotations

import io
import os
import re
from calendar import timegm
from collections.abc import Sequence
from functools import cache, lru_cache
from html import escape
from typing import TYPE_CHECKING, NamedTuple

from tactcad.design.tree import Identity

from .ink import FAMILY, DrawnArc, DrawnSheet, Fill, Hatch, Item, Point, Stroke, Text, em, font_file

if TYPE_CHECKING:
    from reportlab.pdfgen.canvas import Canvas

POINT = 72 / 25.4  # PDF points in a millimetre
FONT = "DejaVuSans"
EPOCH = "SOURCE_DATE_EPOCH"
BETWEEN = 10.0  # of the sheets of one SVG file, mm
GREY = "#c9ced4"
# A page's lines and areas, their colours, widths and dashes: half of pypdf's time, and no texts.
GRAPHICS = re.compile(rb"^(?:n [-\d. mlch]*|S|f\*|[\d.]+ [Gwg]|\[[\d. ]*\] 0 d)\n", re.MULTILINE)


class Written(NamedTuple):
    """A drawing's files."""

    pdf: bytes
    svg: bytes


def pdf_bytes(sheets: Sequence[DrawnSheet], title: str, author: str, date: str) -> bytes:
    """The sheets, a page each at the paper's size, dated midnight (UTC) of `date` (YYYY-MM-DD).

    Raises CheckFailure if the font is missing.
    """
    from reportlab.pdfgen.canvas import Canvas

    _register(str(font_file()))
    out = io.BytesIO()
    # by itself reportlab takes the date of SOURCE_DATE_EPOCH, which users set for other purposes
    given = os.environ.get(EPOCH)
    os.environ[EPOCH] = str(timegm((*map(int, date.split("-")), 0, 0, 0)))
    try:
        canvas = Canvas(out, invariant=1, pageCompression=1)  # invariant: no clock, no random identifiers
    finally:
        del os.environ[EPOCH]
        if given is not None:
            os.environ[EPOCH] = given
    canvas.setTitle(title)
    canvas.setAuthor(author)
    canvas.setCreator("tactcad")
    for sheet in sheets:
        canvas.setPageSize((sheet.size[0] * POINT, sheet.size[1] * POINT))
        canvas.scale(POINT, POINT)
        canvas.setLineJoin(1)
        for item in sheet.items:
            _draw(canvas, item)
        canvas.showPage()
    canvas.save()
    return out.getvalue()


@cache
def _register(file: str) -> None:
    """Once a process: it takes a tenth of a second."""
    from reportlab.pdfbase import pdfmetrics
    from reportlab.pdfbase.ttfonts import TTFont

    pdfmetrics.registerFont(TTFont(FONT, file))


def _draw(canvas: Canvas, item: Item) -> None:
    if isinstance(item, Text):
        canvas.saveState()
        canvas.setFillGray(0.8 if item.role == "watermark" else 0)
        canvas.translate(*item.origin)
        if item.angle:
            canvas.rotate(item.angle)
        canvas.setFont(FONT, em(item.height))
        canvas.drawString(0, 0, item.text)
        canvas.restoreState()
        return
    path = canvas.beginPath()
    if isinstance(item, DrawnArc):
        (x, y), r = item.centre, item.radius
        path.arc(x - r, y - r, x + r, y + r, item.start, item.sweep)
    elif isinstance(item, Hatch):
        for a, b in item.chords():
            path.moveTo(*a)
            path.lineTo(*b)
    else:
        path.moveTo(*item.points[0])
        for point in item.points[1:]:
            path.lineTo(*point)
    if isinstance(item, Fill):
        path.close()
        canvas.setFillGray(0)
        canvas.drawPath(path, stroke=0, fill=1)
        return
    if isinstance(item, Stroke) and item.closed:
        path.close()
    canvas.setStrokeGray(0)
    canvas.setLineWidth(item.line.width)
    canvas.setDash(list(item.line.dashes))
    canvas.drawPath(path, stroke=1, fill=0)


def svg_bytes(sheet: DrawnSheet) -> bytes:
    """The sheet as SVG; units of the view box are millimetres."""
    w, h = sheet.size
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{w:g}mm" height="{h:g}mm" viewBox="0 0 {w:g} {h:g}" '
        f'font-family="{FAMILY}, Verdana, sans-serif" fill="none" stroke-linecap="butt" '
        'stroke-linejoin="round">',
        f"<title>{escape(sheet.number)}: {escape(sheet.title)}</title>",
        f'<rect width="{w:g}" height="{h:g}" fill="#ffffff"/>',
        *(_element(item, h) for item in sheet.items),
        "</svg>",
        "",
    ]
    return "\n".join(lines).encode()


def _element(item: Item, h: float) -> str:
    if isinstance(item, Text):
        x, y = item.origin
        turn = f' transform="rotate({-item.angle:g} {x:.3f} {h - y:.3f})"' if item.angle else ""
        ink = GREY if item.role == "watermark" else "#000000"
        return (
            f'<text class="{item.role}" fill="{ink}" font-size="{em(item.height):.4f}" '
            f'x="{x:.3f}" y="{h - y:.3f}" textLength="{item.width:.3f}" lengthAdjust="spacingAndGlyphs" '
            f'xml:space="preserve"{turn}>{escape(item.text)}</text>'
        )
    if isinstance(item, Fill):
        return f'<path class="{item.role}" fill="#000000" d="{_polyline(item.points, h)}Z"/>'
    if isinstance(item, DrawnArc):  # in two halves: a full circle has no one arc in SVG
        stops = [item.at(item.start + item.sweep * share) for share in (0.0, 0.5, 1.0)]
        (x0, y0), *rest = [(x, h - y) for x, y in stops]
        turns = (f"A{item.radius:.3f},{item.radius:.3f} 0 0 0 {x:.3f},{y:.3f}" for x, y in rest)
        line = f"M{x0:.3f},{y0:.3f}{''.join(turns)}"
    elif isinstance(item, Hatch):
        line = "".join(_polyline(chord, h) for chord in item.chords())
    else:
        line = _polyline(item.points, h) + ("Z" if item.closed else "")
    pen, dashes = item.line, " ".join(f"{d:g}" for d in item.line.dashes)
    dashed = f' stroke-dasharray="{dashes}"' if dashes else ""
    return f'<path class="{item.role}" stroke="#000000" stroke-width="{pen.width:g}"{dashed} d="{line}"/>'


def _polyline(points: tuple[Point, ...], h: float) -> str:
    return "M" + "L".join(f"{x:.3f},{h - y:.3f}" for x, y in points)


@lru_cache(maxsize=16)  # a release asks several things of each of its sheets
def pdf_texts(data: bytes) -> tuple[tuple[tuple[str, float], ...], ...]:
    """Texts of every page with their letters' size (points), in the order drawn, as pypdf reads them."""
    from pypdf import PdfReader
    from pypdf.generic import ContentStream, NameObject

    pages = []
    for page in PdfReader(io.BytesIO(data)).pages:
        texts: list[tuple[str, float]] = []

        def take(text: str, _matrix: object, _text_matrix: object, _font: object, size: float) -> None:
            texts.extend((run.strip(), size) for run in text.splitlines() if run.strip())

        content = ContentStream(page["/Contents"], None, "bytes")
        content.set_data(GRAPHICS.sub(b"", content.get_data()))
        page[NameObject("/Contents")] = content
        page.extract_text(visitor_text=take)
        pages.append(tuple(texts))
    return tuple(pages)


def pdf_runs(data: bytes) -> list[list[str]]:
    """Texts of every page in the order in which they were drawn."""
    return [[text for text, _ in page] for page in pdf_texts(data)]


def stacked_svg(sheets: Sequence[DrawnSheet]) -> bytes:
    """The sheets below each other in one SVG file, each at the paper's size."""
    width, y, pieces = max(s.size[0] for s in sheets), 0.0, []
    for sheet in sheets:
        w, h = sheet.size
        body = svg_bytes(sheet).decode().partition("?>\n")[2]
        place = f'x="0" y="{y:g}" width="{w:g}" height="{h:g}"'  # in millimetres of the whole
        pieces.append(body.replace(f'width="{w:g}mm" height="{h:g}mm"', place, 1))
        y += h + BETWEEN
    head = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}mm" height="{y - BETWEEN:g}mm" '
        f'viewBox="0 0 {width:g} {y - BETWEEN:g}">\n'
    )
    return (head + "".join(pieces) + "</svg>\n").encode()


def files_of(sheets: Sequence[DrawnSheet], name: str, what: str, of: Identity) -> Written:
    """Sheets of a design as PDF and SVG."""
    pdf = pdf_bytes(sheets, f"{name} revision {of.revision}: {what}", of.author or "", of.date)
    return Written(pdf, stacked_svg(sheets) if len(sheets) > 1 else svg_bytes(sheets[0]))
