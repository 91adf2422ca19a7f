"""A sheet as SVG at the paper's size. Texts stay texts; each is held to the width that it has in the PDF."""

from __future__ import annotations

from html import escape

from .fonts import FAMILY, em
from .ink import DrawnArc, DrawnSheet, Fill, Hatch, Item, LineType, Point, Text

GREY = "#c9ced4"


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
        *(_drawn(item, h) for item in sheet.items),
        "</svg>",
        "",
    ]
    return "\n".join(lines).encode()


def _drawn(item: Item, h: float) -> str:
    if isinstance(item, Text):
        return _text(item, h)
    if isinstance(item, Fill):
        return f'<path class="{item.role}" fill="#000000" d="{_polyline(item.points, h)}Z"/>'
    if isinstance(item, DrawnArc):
        return f'<path class="{item.role}" {_pen(item.line)} d="{_arc(item, h)}"/>'
    if isinstance(item, Hatch):
        lines = "".join(_polyline(chord, h) for chord in item.chords())
        return f'<path class="{item.role}" {_pen(item.line)} d="{lines}"/>'
    line = _polyline(item.points, h) + ("Z" if item.closed else "")
    return f'<path class="{item.role}" {_pen(item.line)} d="{line}"/>'


def _pen(line: LineType) -> str:
    dashes = f' stroke-dasharray="{" ".join(f"{d:g}" for d in line.dashes)}"' if line.dashes else ""
    return f'stroke="#000000" stroke-width="{line.width:g}"{dashes}'


def _polyline(points: tuple[Point, ...], h: float) -> str:
    return "M" + "L".join(f"{x:.3f},{h - y:.3f}" for x, y in points)


def _arc(arc: DrawnArc, h: float) -> str:
    """In two halves: a full circle has no one arc in SVG."""
    stops = [arc.at(arc.start + arc.sweep * share) for share in (0.0, 0.5, 1.0)]
    (x0, y0), *rest = [(x, h - y) for x, y in stops]
    turns = "".join(f"A{arc.radius:.3f},{arc.radius:.3f} 0 0 0 {x:.3f},{y:.3f}" for x, y in rest)
    return f"M{x0:.3f},{y0:.3f}{turns}"


def _text(text: Text, h: float) -> str:
    x, y = text.origin
    turn = f' transform="rotate({-text.angle:g} {x:.3f} {h - y:.3f})"' if text.angle else ""
    ink = GREY if text.role == "watermark" else "#000000"
    return (
        f'<text class="{text.role}" fill="{ink}" font-size="{em(text.height):.4f}" '
        f'x="{x:.3f}" y="{h - y:.3f}" textLength="{text.width:.3f}" lengthAdjust="spacingAndGlyphs" '
        f'xml:space="preserve"{turn}>{escape(text.text)}</text>'
    )
