"""The differences of two sides as one offline HTML page: values, contours laid over each other, pictures."""

from __future__ import annotations

import base64
import re
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path

from tactcad.contour import Arc, Contour, Point

from .difference import Change, shown
from .geometry import contour_of
from .sides import Side, not_compared

# Okabe and Ito: distinct for colour-blind readers; the old one is dashed as well
OLD, NEW = "#D55E00", "#0072B2"
SECTIONS = {
    "design": "Design",
    "revision": "Design",
    "values": "Design file",
    "parts": "Parts",
    "scenes": "Scenes: placements and bills of materials",
    "elements": "Elements: hinge, stiffness, force at yield",
}
LEAST_WINDOW = 0.015  # of the part's larger side, for the enlarged view
BEYOND = 6.0  # the enlarged view shows this many times the distance on each side


def page(old: Side, new: Side, changes: Sequence[Change], first: Iterable[str] = ()) -> bytes:
    """The page's bytes; it loads nothing from anywhere. `first` is HTML above the changes."""
    style = Path(__file__).with_suffix(".css").read_text("utf-8")
    body = [
        f"<h1>{escape(new.design)}: what changed</h1>",
        f"<p>From <b>{escape(_name(old))}</b> to <b>{escape(_name(new))}</b>: {_counted(changes)}.</p>",
        *(f'<p class="note">Not compared: {escape(text)}.</p>' for text in not_compared(old, new)),
        *first,
        *_tables(changes),
        *_overlays(old, new, changes),
        *_pictures(old, new),
    ]
    text = (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width,initial-scale=1">'
        f"<title>{escape(new.design)}: {escape(old.revision)} to {escape(new.revision)}</title>"
        f"<style>{style}</style></head><body><main>\n" + "\n".join(body) + "\n</main></body></html>\n"
    )
    return text.encode(errors="backslashreplace")  # names of files are bytes, whatever they mean


def _name(side: Side) -> str:
    return f"{side.design} revision {side.revision} ({side.kind} {side.source})"


def _counted(changes: Sequence[Change]) -> str:
    if not changes:
        return "nothing"
    kinds = [c.kind for c in changes]
    return ", ".join(f"{kinds.count(k)} {k}" for k in ("added", "removed", "changed") if k in kinds)


def _tables(changes: Sequence[Change]) -> Iterable[str]:
    titles = dict.fromkeys(SECTIONS[c.path[0]] for c in changes)
    for title in titles:
        yield f"<h2>{escape(title)}</h2>"
        yield (
            '<table><colgroup><col class="kind"><col class="path"><col><col><col class="remark"></colgroup>'
            "<tr><th></th><th>what</th><th>old</th><th>new</th><th></th></tr>"
        )
        for c in (c for c in changes if SECTIONS[c.path[0]] == title):
            where = " / ".join(c.path[1:] if len(c.path) > 1 else c.path)
            was, now = c.shown()
            yield (
                f'<tr class="{c.kind}"><td class="kind">{c.kind}</td><td>{escape(where)}</td>'
                f'<td class="old">{escape(was) if c.kind != "added" else ""}</td>'
                f'<td class="new">{escape(now) if c.kind != "removed" else ""}</td>'
                f"<td>{escape(c.remark())}</td></tr>"
            )
        yield "</table>"


def _overlays(old: Side, new: Side, changes: Sequence[Change]) -> Iterable[str]:
    contours = [c for c in changes if c.path[0] == "parts" and c.path[-1] == "contours"]
    alone = [
        c for c in changes if c.path[0] == "parts" and len(c.path) == 2 and (c.old or c.new).get("contours")
    ]
    if not contours and not alone:
        return
    yield "<h2>Contours</h2>"
    yield (
        f'<p class="note"><span style="color:{OLD}">&#9476;&#9476;&#9476; old</span> &nbsp; '
        f'<span style="color:{NEW}">&#9472;&#9472;&#9472; new</span>; mm</p>'
    )
    for c in contours:
        yield f"<h3>{escape(c.path[1])}</h3>"
        before, after = _contours(c.old or ()), _contours(c.new or ())
        box = _box([*before, *after])
        drawing = _drawing(before, after, box)
        yield f'<div class="pair"><figure>{drawing}<figcaption>the whole part</figcaption></figure>'
        if c.at is not None and c.moved is not None:
            half = max(BEYOND * c.moved, LEAST_WINDOW * max(box[2] - box[0], box[3] - box[1]))
            window = (c.at[0] - half, c.at[1] - half * 0.6, c.at[0] + half, c.at[1] + half * 0.6)
            caption = (
                f"where they are furthest apart: {c.moved:.6g} mm at ({shown(c.at[0])}, {shown(c.at[1])})"
            )
            yield f"<figure>{_drawing(before, after, window)}<figcaption>{caption}</figcaption></figure>"
        yield "</div>"
    for c in alone:
        before, after = (_contours(part["contours"] if part else ()) for part in (c.old, c.new))
        yield f"<h3>{escape(c.path[1])}: {c.kind}</h3>"
        yield f'<div class="pair"><figure>{_drawing(before, after, _box([*before, *after]))}</figure></div>'


def _contours(rows: Iterable[list[list[float]]]) -> list[Contour]:
    return [contour_of(r) for r in rows]


def _box(contours: Sequence[Contour]) -> tuple[float, float, float, float]:
    boxes = [c.box for c in contours]
    x0, y0 = (min(b[i] for b in boxes) for i in (0, 1))
    x1, y1 = (max(b[i] for b in boxes) for i in (2, 3))
    margin = 0.04 * max(x1 - x0, y1 - y0)
    return (x0 - margin, y0 - margin, x1 + margin, y1 + margin)


def _drawing(
    old: Sequence[Contour], new: Sequence[Contour], window: tuple[float, float, float, float]
) -> str:
    x0, y0, x1, y1 = window
    pen = 'fill="none" stroke-width="1.6" vector-effect="non-scaling-stroke"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{x0:.6f} {-y1:.6f} {x1 - x0:.6f} {y1 - y0:.6f}">'
        f'<path class="new" {pen} stroke="{NEW}" d="{_path(new)}"/>'
        f'<path class="old" {pen} stroke="{OLD}" stroke-dasharray="7 5" d="{_path(old)}"/></svg>'
    )


def _path(contours: Sequence[Contour]) -> str:
    """SVG path data, exact lines and arcs; SVG's y points down."""
    parts = []
    for contour in contours:
        parts.append("M" + _xy(contour.segments[0].start))
        for s in contour:
            if not isinstance(s, Arc):
                parts.append("L" + _xy(s.end))
                continue
            # a full turn has equal ends, which SVG would leave out: always two halves
            turn = 0 if s.ccw else 1
            for end in (s.at(0.5), s.end):
                parts.append(f"A{s.radius:.6f},{s.radius:.6f},0,0,{turn},{_xy(end)}")
        parts.append("Z")
    return "".join(parts)


def _xy(p: Point) -> str:
    return f"{p[0]:.6f},{-p[1]:.6f}"


def _pictures(old: Side, new: Side) -> Iterable[str]:
    before, after = old.pictures or {}, new.pictures or {}
    if not before and not after:
        return
    both = old.pictures is not None and new.pictures is not None
    names = [n for n in dict.fromkeys([*after, *before]) if _drawn(before.get(n)) != _drawn(after.get(n))]
    yield "<h2>Pictures</h2>"
    same = len(set(before) | set(after)) - len(names)
    if both:
        yield f'<p class="note">{len(names)} differ, {same} are the same.</p>'
    for name in names:
        yield f'<h3>{escape(name)}</h3><div class="pair">'
        for side, pictures, label in ((old, before, "old"), (new, after, "new")):
            if name in pictures:
                data = base64.b64encode(pictures[name]).decode()
                caption = f"{label}: revision {escape(side.revision)}"
                yield (
                    f'<figure><img alt="{escape(name)}, {label}" src="data:image/svg+xml;base64,{data}">'
                    f"<figcaption>{caption}</figcaption></figure>"
                )
        yield "</div>"


def _drawn(picture: bytes | None) -> bytes | None:
    """A picture's content without its caption, which has the revision."""
    return picture and re.sub(rb"<(title|desc)>.*?</\1>", b"", picture)
