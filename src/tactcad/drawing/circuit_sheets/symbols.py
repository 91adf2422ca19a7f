"""The symbols of IEC 60617 that the circuit's sheets need. They are our own few: the libraries' would have to
be turned into the sheets' lines, and their MOSFETs lack the substrate's arrow.
"""

from __future__ import annotations

from tactcad.circuit.netlist import Component

from ..engine.ink import THIN, VISIBLE, DrawnArc, Fill, Item, LineType, Point, Stroke, Text, rectangle

LINE = LineType("circuit", 0.35)
SMALL = 1.8  # height of values' letters, ISO 3098


def printed(component: Component) -> str:
    """The designator as on the board."""
    return component.designator.rpartition("-")[2]


def line(*points: Point) -> Stroke:
    """A connection through these points."""
    return Stroke(points, LINE, "symbol")


def dot(at: Point) -> Item:
    """A dot at joined connections."""
    return DrawnArc(at, 0.5, line=VISIBLE, role="symbol")


def ring(at: Point) -> Item:
    """A terminal, or a connector's pin."""
    return DrawnArc(at, 1.0, line=LINE, role="symbol")


def resistor(top: Point, bottom: Point, name: str, value: str) -> list[Item]:
    """Upright, in the middle of its connection; name and value to its right."""
    x, middle = top[0], (top[1] + bottom[1]) / 2
    return [
        line(top, (x, middle + 5.0)),
        rectangle(x - 2.0, middle - 5.0, 4.0, 10.0, LINE, "symbol"),
        line((x, middle - 5.0), bottom),
        Text((x + 3.5, middle + 0.8), name),
        Text((x + 3.5, middle - 3.0), value, SMALL),
    ]


def resistor_below(left: Point, right: Point, y: float, name: str, value: str) -> list[Item]:
    """Level at height y, hung on two connections from above; name and value below it."""
    middle = (left[0] + right[0]) / 2
    return [
        line(left, (left[0], y), (middle - 5.0, y)),
        rectangle(middle - 5.0, y - 2.0, 10.0, 4.0, LINE, "symbol"),
        line((middle + 5.0, y), (right[0], y), right),
        Text((middle, y - 6.2), name, anchor="middle"),
        Text((middle, y - 9.6), value, SMALL, "middle"),
    ]


def strain_gauge(top: Point, bottom: Point, name: str, value: str) -> list[Item]:
    """A resistor that strain varies; name and value to its left."""
    x, middle = top[0], (top[1] + bottom[1]) / 2
    lines = [item for item in resistor(top, bottom, name, value) if not isinstance(item, Text)]
    near, far = (x - 4.5, middle - 6.0), (x + 4.5, middle + 6.0)
    return [
        *lines,
        line((near[0] - 2.5, near[1]), near, far),
        Text((x - 4.5, middle + 0.8), name, anchor="end"),
        Text((x - 4.5, middle - 3.0), value, SMALL, "end"),
    ]


def diode(top: Point, bottom: Point, name: str, value: str) -> list[Item]:
    """Upright, its cathode above; name and value to its right."""
    x, middle = top[0], (top[1] + bottom[1]) / 2
    return [
        line(top, (x, middle + 2.0)),
        line((x - 2.2, middle + 2.0), (x + 2.2, middle + 2.0)),
        Fill(((x, middle + 2.0), (x - 2.2, middle - 2.0), (x + 2.2, middle - 2.0)), "symbol"),
        line((x, middle - 2.0), bottom),
        Text((x + 3.5, middle + 0.8), name),
        Text((x + 3.5, middle - 3.0), value, SMALL),
    ]


def ground(at: Point) -> list[Item]:
    x, y = at
    return [line((x - w, y - 1.0 * k), (x + w, y - 1.0 * k)) for k, w in enumerate((2.5, 1.6, 0.7))]


def capacitor(top: Point, bottom: Point, name: str, value: str, net: str) -> list[Item]:
    """Upright from a net's name to ground."""
    x, middle = top[0], (top[1] + bottom[1]) / 2
    return [
        Text((x, top[1] + 1.2), net, SMALL, "middle"),
        line(top, (x, middle + 0.7)),
        line((x - 3.0, middle + 0.7), (x + 3.0, middle + 0.7)),
        line((x - 3.0, middle - 0.7), (x + 3.0, middle - 0.7)),
        line((x, middle - 0.7), bottom),
        *ground(bottom),
        Text((x + 4.0, middle + 1.2), name),
        Text((x + 4.0, middle - 2.8), value, SMALL),
    ]


def mosfet(drain: Point, gate: Point, name: str, value: str) -> list[Item]:
    """N-channel, enhancement, to ground; the gate to the right of the channel; name and value to its left."""
    x, y = drain
    channel, middle = x + 4.0, y - 8.0
    broken = [line((channel, middle + s - 1.2), (channel, middle + s + 1.2)) for s in (-4.0, 0.0, 4.0)]
    return [
        line(drain, (x, middle + 4.0), (channel, middle + 4.0)),
        *broken,  # enhancement
        line((channel, middle), (x, middle)),
        Fill(((channel, middle), (x + 1.2, middle + 1.1), (x + 1.2, middle - 1.1)), "symbol"),
        line((channel, middle - 4.0), (x, middle - 4.0)),
        line((x, middle), (x, middle - 10.0)),
        *ground((x, middle - 10.0)),
        line((channel + 1.2, middle - 4.0), (channel + 1.2, middle + 4.0)),
        line((channel + 1.2, middle), (gate[0], middle), gate),
        Text((x - 2.5, middle + 0.8), name, anchor="end"),
        Text((x - 2.5, middle - 3.0), value, SMALL, "end"),
    ]


def amplifier(at: Point, size: float) -> list[Item]:
    """A triangle from `at`, the middle of its left side; + above, - below."""
    x, y = at
    half = size / 2
    return [
        Stroke(((x, y + half), (x, y - half), (x + size, y)), LINE, "symbol", True),
        Text((x + 1.5, y + 0.3 * half + 1.0), "+"),
        Text((x + 1.5, y - 0.3 * half - 3.2), "−"),
    ]


def box(x: float, y: float, w: float, h: float, name: str, value: str) -> list[Item]:
    """A circuit as a box; name and value above it."""
    return [
        rectangle(x, y, w, h, LINE, "symbol"),
        Text((x, y + h + 5.2), name),
        Text((x, y + h + 1.4), value, SMALL),
    ]


def stub(start: Point, text: str) -> list[Item]:
    """A connection to the right that ends at its net's name."""
    end = (start[0] + 5.0, start[1])
    return [line(start, end), Text((end[0] + 1.0, end[1] - SMALL / 2), text, SMALL)]


def dashed(x: float, y: float, w: float, h: float, name: str) -> list[Item]:
    """Frame around parts that belong together: on the array, on a board."""
    around = LineType("around", THIN.width, (3.0, 1.5))
    return [rectangle(x, y, w, h, around, "symbol"), Text((x + 2.0, y + 2.0), name)]
