"""README's first picture: elements and spacers of the published array from below, in the colours of K.

`python packaging/coloured.py docs/images` writes coloured-array.svg from the descriptions, without CAD
kernel: prisms painted from the farthest to the nearest.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from math import hypot, log
from pathlib import Path

from tactcad.contour import Arc, Contour
from tactcad.design.load import read
from tactcad.drawing.engine.boxes import Point, bounds_of
from tactcad.lab.array_estimate import estimate
from tactcad.parts.array.element import mounting_holes, outline
from tactcad.parts.array.layout import ElementPlace, Layout
from tactcad.parts.array.stop_gap import stop_gap
from tactcad.parts.language.description import Vector

ROOT = Path(__file__).parents[1]
EYE, UP = (1.0, -1.4, -1.0), (0.0, 0.0, 1.0)  # as pictures "below" of an export
# As the review page has them (review/data.js), soft to stiff.
STIFFNESS = ((253, 231, 37), (94, 201, 98), (33, 145, 140), (59, 82, 139), (72, 36, 117))
METAL, GAUGE = (195, 200, 206), (214, 120, 30)
SIZE, LETTERS = 11.0, 1.8  # picture per mm of the array; letters, mm of the array


@dataclass(frozen=True)
class Face:
    """A polygon in the array's frame, its colour and whether its outline is drawn."""

    points: tuple[Vector, ...]
    colour: tuple[int, ...]
    edged: bool = True


def _unit(v: Vector) -> Vector:
    size = hypot(*v)
    return (v[0] / size, v[1] / size, v[2] / size)


def _cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


RIGHT = _unit(_cross(UP, EYE))
ABOVE = _cross(_unit(EYE), RIGHT)


def seen(p: Vector) -> Point:
    """A point in the picture, x to the right and y down."""
    x, y = (sum(a * b for a, b in zip(axis, p)) for axis in (RIGHT, ABOVE))
    return (SIZE * x, -SIZE * y)


def colour_of(share: float) -> tuple[int, ...]:
    """Of a stiffness between the softest (0) and the stiffest (1) on a logarithmic scale."""
    at = share * (len(STIFFNESS) - 1)
    n = min(int(at), len(STIFFNESS) - 2)
    return tuple(round(a + (at - n) * (b - a)) for a, b in zip(STIFFNESS[n], STIFFNESS[n + 1]))


def _shaded(colour: Sequence[int], light: float) -> tuple[int, ...]:
    return tuple(round(c * light) for c in colour)


def prism(
    contour: Contour, holes: Sequence[Contour], y: tuple[float, float], row: int, colour: Sequence[int]
) -> Iterator[tuple[str, Face]]:
    """Faces of a contour (x, z) between two heights along y that the eye sees, the farthest first, each with
    its edge's name; of row two turned by half a turn about z."""
    turn = 1 if row == 1 else -1
    near = min(turn * v for v in y)
    far = max(turn * v for v in y)

    def at(p: Point, height: float) -> Vector:
        return (turn * p[0], height, p[1])

    sides = []
    for s in contour:
        steps = 8 if isinstance(s, Arc) else 1
        points = [s.at(i / steps) for i in range(steps + 1)]
        for a, b in zip(points, points[1:]):
            out = (turn * (b[1] - a[1]), a[0] - b[0])  # counter-clockwise: outwards is to the right
            if out[0] * EYE[0] + out[1] * EYE[2] <= 0:
                continue
            light = 0.9 if abs(out[1]) > abs(out[0]) else 0.72
            middle = [(a[k] + b[k]) / 2 for k in (0, 1)]
            # what lies in the slot is behind the flat face
            depth = (not s.name.startswith("slot"), turn * middle[0] * EYE[0] + middle[1] * EYE[2])
            corners = (at(a, near), at(b, near), at(b, far), at(a, far))
            sides.append((depth, s.name, Face(corners, _shaded(colour, light), steps == 1)))
    yield from ((name, face) for _, name, face in sorted(sides, key=lambda side: side[0]))
    whole = [
        p for s in contour for p in ([s.at(i / 8) for i in range(8)] if isinstance(s, Arc) else [s.start])
    ]
    yield "cap", Face(tuple(at(p, near) for p in whole), tuple(colour))
    for hole in holes:
        ring = [s.at(i / 12) for s in hole for i in range(12)]
        yield "hole", Face(tuple(at(p, near) for p in ring), _shaded(colour, 0.35))


def gauge(layout: Layout, place: ElementPlace) -> Face:
    """The strain gauge on the hinge's flat face."""
    g, turn = layout.design.gauge, 1 if place.row == 1 else -1
    xs = (place.hinge_x - g.carrier_arm_side, place.hinge_x + g.carrier_body_side)
    half = g.carrier_width / 2
    y = turn * place.y
    corners = ((xs[0], y - half), (xs[1], y - half), (xs[1], y + half), (xs[0], y + half))
    return Face(tuple((turn * x, v, 0.0) for x, v in corners), GAUGE)


def picture(layout: Layout) -> str:
    """The whole picture as SVG."""
    rows = estimate(layout, "solid")
    low, high = (f(r.stiffness for r in rows) for f in (min, max))
    thick, holes = layout.design.sheet.thickness, mounting_holes(layout)
    bodies: list[tuple[float, float, list[Face]]] = []  # y, x of the middle, faces
    for place, row in zip(layout.elements, rows):
        turn = 1 if place.row == 1 else -1
        contour = outline(layout, place.arm, place.hinge, stop_gap(layout, place))
        colour = colour_of(log(row.stiffness / low) / log(high / low))
        faces: list[Face] = []
        for name, face in prism(
            contour, holes, (place.y - thick / 2, place.y + thick / 2), place.row, colour
        ):
            faces.append(face)
            if name == "flat_face":
                faces.append(gauge(layout, place))
        bodies.append((turn * place.y, float(turn), faces))
    bodies += _spacers(layout, holes)
    order = sorted(bodies, key=lambda body: (-body[0], body[1]))  # the eye is at -y and +x
    painted = [face for _, _, faces in order for face in faces]
    x0, y0, x1, y1 = bounds_of([[seen(p) for p in face.points] for face in painted])
    said = _words(layout, low, high, (x0, y0, x1, y1))
    left, top, wide, tall = x0 - 20, y0 - 20, x1 - x0 + 40, y1 - y0 + 65
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide:.0f}" height="{tall:.0f}" '
            f'viewBox="{left:.1f} {top:.1f} {wide:.1f} {tall:.1f}" '
            'font-family="DejaVu Sans, Verdana, sans-serif">',
            "<title>The published array from below, its elements in the colours of their stiffness</title>",
            f'<rect x="{left:.1f}" y="{top:.1f}" width="{wide:.1f}" height="{tall:.1f}" fill="#fff"/>',
            *map(_drawn, painted),
            *said,
            "</svg>\n",
        ]
    )


def _spacers(layout: Layout, holes: Sequence[Contour]) -> Iterator[tuple[float, float, list[Face]]]:
    from tactcad.contour import rectangle

    low, high = layout.spacer_z
    contour = rectangle(layout.clamp_edge, low, layout.rear_end, high)
    for row, turn in ((1, 1), (2, -1)):
        for index in range(layout.positions + 1):
            y = layout.position_y(0) + (index - 0.5) * layout.design.array.pitch
            ends = (y - layout.spacer / 2, y + layout.spacer / 2)
            yield turn * y, float(turn), [f for _, f in prism(contour, holes, ends, row, METAL)]


def _drawn(face: Face) -> str:
    points = " ".join(f"{x:.2f},{y:.2f}" for x, y in map(seen, face.points))
    fill = "#" + "".join(f"{c:02x}" for c in face.colour)
    edge = "#1b2530" if face.edged else fill
    line = f'stroke="{edge}" stroke-width="0.8" stroke-linejoin="round"'
    return f'<polygon points="{points}" fill="{fill}" {line}/>'


def _words(layout: Layout, low: float, high: float, box: tuple[float, float, float, float]) -> list[str]:
    """The scale of K, a length of 10 mm, and the names of pad, gauge, element and spacer."""
    x0, y0, x1, y1 = box
    size = SIZE * LETTERS
    found = []
    stops = "".join(
        f'<stop offset="{n / (len(STIFFNESS) - 1):g}" stop-color="rgb{c}"/>' for n, c in enumerate(STIFFNESS)
    )
    found.append(f'<defs><linearGradient id="k">{stops}</linearGradient></defs>')
    found.append(f'<rect x="{x0:.1f}" y="{y0 + size * 1.4:.1f}" width="200" height="16" fill="url(#k)"/>')
    found.append(_text(x0, y0 + size, "stiffness K, N/mm"))
    for share, anchor in ((0.0, "start"), (0.5, "middle"), (1.0, "end")):
        k = low * (high / low) ** share
        found.append(_text(x0 + 200 * share, y0 + 16 + size * 2.4, f"{k:.3g}", anchor))
    (ax, ay), (bx, by) = seen((0.0, 0.0, 0.0)), seen((10.0, 0.0, 0.0))
    start = (x1 - 230, y1 + 10)
    end = (start[0] + bx - ax, start[1] + by - ay)
    found.append(_line(start, end, 2.5))
    found.append(_text((start[0] + end[0]) / 2 + 8, (start[1] + end[1]) / 2 + size * 1.1, "10 mm"))
    soft = max(layout.elements, key=lambda p: (p.row == 1, p.arm))
    last = layout.elements[len(layout.design.array.row_arms[0]) - 1]
    pad = (layout.pad_inner + 1.0, last.y, -layout.design.element.pad_height)
    foot, hinge = seen(pad), seen((last.hinge_x, last.y, 0.0))
    found += _called("pad", pad, (foot[0] - 20, foot[1] + 60))
    found += _called("strain gauge", (last.hinge_x + 0.8, last.y, 0.0), (hinge[0] + 20, hinge[1] + 60))
    end = (layout.rear_end - 4, soft.y, layout.design.element.recess_depth)
    found += _called(f"element E{soft.number}", end, (seen(end)[0] - 60, seen(end)[1] + 85))
    return found


def _called(name: str, at: Vector, to: Point, anchor: str = "start") -> list[str]:
    tip = seen(at)
    return [
        _line(tip, to, 1.4),
        f'<circle cx="{tip[0]:.1f}" cy="{tip[1]:.1f}" r="3" fill="#1b2530"/>',
        _text(to[0] + 5, to[1] + SIZE * LETTERS * 0.35, name, anchor),
    ]


def _line(a: Point, b: Point, wide: float) -> str:
    return (
        f'<path d="M{a[0]:.1f},{a[1]:.1f}L{b[0]:.1f},{b[1]:.1f}" stroke="#1b2530" stroke-width="{wide:g}"/>'
    )


def _text(x: float, y: float, text: str, anchor: str = "start") -> str:
    size = SIZE * LETTERS
    place = f'x="{x:.1f}" y="{y:.1f}" font-size="{size:.1f}" text-anchor="{anchor}"'
    return f'<text {place} fill="#1b2530">{escape(text)}</text>'


if __name__ == "__main__":
    layout = Layout(read(ROOT / "hardware" / "macro-array.toml"))
    (Path(sys.argv[1]) / "coloured-array.svg").write_text(picture(layout), "utf-8")
