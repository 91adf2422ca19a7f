"""Sheets as one vector PDF: the same bytes in every process, texts with an embedded font that readers find
again."""

from __future__ import annotations

import io
import os
from calendar import timegm
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from .fonts import em, font_file
from .ink import DrawnArc, DrawnSheet, Fill, Hatch, Item, LineType, Stroke, Text

if TYPE_CHECKING:
    from reportlab.pdfgen.canvas import Canvas

POINT = 72 / 25.4  # PDF points in a millimetre
FONT = "DejaVuSans"
EPOCH = "SOURCE_DATE_EPOCH"


def pdf_bytes(sheets: Sequence[DrawnSheet], title: str, author: str, date: str) -> bytes:
    """The sheets, a page each at the paper's size, dated midnight (UTC) of `date` (YYYY-MM-DD).

    Raises CheckFailure where the font is missing.
    """
    from reportlab.pdfbase import pdfmetrics
    from reportlab.pdfbase.ttfonts import TTFont
    from reportlab.pdfgen.canvas import Canvas

    pdfmetrics.registerFont(TTFont(FONT, str(font_file())))
    out = io.BytesIO()
    with _dated(date):
        canvas = Canvas(out, invariant=1, pageCompression=1)  # invariant: no clock, no random identifiers
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


@contextmanager
def _dated(date: str) -> Iterator[None]:
    """Make reportlab use this date only: by itself it takes that of SOURCE_DATE_EPOCH, which users set for
    other purposes.
    """
    given = os.environ.pop(EPOCH, None)
    os.environ[EPOCH] = str(timegm((*map(int, date.split("-")), 0, 0, 0)))
    try:
        yield
    finally:
        del os.environ[EPOCH]
        if given is not None:
            os.environ[EPOCH] = given


def _draw(canvas: Canvas, item: Item) -> None:
    if isinstance(item, Text):
        _write(canvas, item)
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
    _pen(canvas, item.line)
    canvas.drawPath(path, stroke=1, fill=0)


def _pen(canvas: Canvas, line: LineType) -> None:
    canvas.setStrokeGray(0)
    canvas.setLineWidth(line.width)
    canvas.setDash(list(line.dashes))


def _write(canvas: Canvas, text: Text) -> None:
    x, y = text.origin
    canvas.saveState()
    canvas.setFillGray(0.8 if text.role == "watermark" else 0)
    canvas.translate(x, y)
    if text.angle:
        canvas.rotate(text.angle)
    canvas.setFont(FONT, em(text.height))
    canvas.drawString(0, 0, text.text)
    canvas.restoreState()
