"""A closed chain of exact segments, and what can be measured on it in closed form; polygons with rounded
corners as such chains.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from math import cos, hypot, pi, sin

from .segment import Arc, Line, Point, Segment


@dataclass(frozen=True)
class Contour:
    """Closed, simple chain of segments in mm: each starts exactly at the previous one's end.

    Raises ValueError if the chain is open, a segment has no length, or there is none.
    """

    segments: tuple[Segment, ...]

    def __post_init__(self) -> None:
        if not self.segments:
            raise ValueError("a contour needs at least one segment")
        for before, after in zip((self.segments[-1], *self.segments), self.segments):
            if before.end != after.start:
                raise ValueError(f"contour is open: {before.end} is followed by {after.start}")
            if after.length == 0.0:
                raise ValueError(f"segment without length at {after.start}")

    def __iter__(self) -> Iterator[Segment]:
        return iter(self.segments)

    def __len__(self) -> int:
        return len(self.segments)

    def named(self, name: str) -> Segment:
        """The one segment of that name. Raises KeyError if there is none or more than one."""
        matches = [s for s in self.segments if s.name == name]
        if len(matches) != 1:
            raise KeyError(f"{len(matches)} segments are named {name!r}")
        return matches[0]

    @property
    def length(self) -> float:
        """Length of the whole chain in mm."""
        return sum(s.length for s in self.segments)

    @property
    def signed_area(self) -> float:
        """Area in mm2, positive if the chain runs counter-clockwise."""
        x0, y0 = self.segments[0].start
        return sum(_area_and_moments(s, x0, y0)[0] for s in self.segments)

    @property
    def area(self) -> float:
        """Enclosed area in mm2."""
        return abs(self.signed_area)

    @property
    def centroid(self) -> Point:
        """Centre of the enclosed area, mm."""
        x0, y0 = self.segments[0].start
        rows = [_area_and_moments(s, x0, y0) for s in self.segments]
        area, mx, my = (sum(row[i] for row in rows) for i in range(3))
        return (x0 + mx / area, y0 + my / area)

    @property
    def product_moment(self) -> float:
        """Integral of x y over the enclosed area, mm4 (the area counted positive)."""
        return sum(_product_moment(s) for s in self.segments) * (1.0 if self.ccw else -1.0)

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Bounding box x_min, y_min, x_max, y_max in mm, exact at the arcs' extremes."""
        points = [p for s in self.segments for p in _extreme_points(s)]
        xs, ys = zip(*points)
        return (min(xs), min(ys), max(xs), max(ys))

    @property
    def ccw(self) -> bool:
        return self.signed_area > 0.0

    def reversed(self) -> Contour:
        """The same curve run the other way round."""
        return Contour(tuple(s.reversed() for s in reversed(self.segments)))

    def as_circle(self) -> tuple[Point, float] | None:
        """Centre and radius (mm) if the whole contour is one circle, else None."""
        first = self.segments[0]
        if not isinstance(first, Arc):
            return None
        alike = all(isinstance(s, Arc) and s.centre == first.centre and s.ccw == first.ccw for s in self)
        return (first.centre, first.radius) if alike else None


def circle(centre: Point, diameter: float, name: str = "") -> Contour:
    """Counter-clockwise circle of two half turns (mm)."""
    x, y = centre
    east, west = (x + diameter / 2, y), (x - diameter / 2, y)
    return Contour((Arc(east, west, centre, True, name), Arc(west, east, centre, True, name)))


RECTANGLE = ("lower edge", "right edge", "upper edge", "left edge")


def rectangle(x0: float, y0: float, x1: float, y1: float) -> Contour:
    """Counter-clockwise rectangle with corners (x0, y0) and (x1, y1), mm; its edges are RECTANGLE's."""
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    sides = zip(corners, corners[1:] + corners[:1], RECTANGLE)
    return Contour(tuple(Line(a, b, name) for a, b, name in sides))


def chain(points: Iterable[Point]) -> Contour:
    """Closed polygon through the points, in their order (mm)."""
    corners = list(points)
    return Contour(tuple(Line(a, b) for a, b in zip(corners, corners[1:] + corners[:1])))


def _area_and_moments(s: Segment, x0: float, y0: float) -> tuple[float, float, float]:
    """Green's theorem: the segment's share of area, and of its first moments about (x0, y0).

    The chord's triangle with (x0, y0), and for an arc the circular segment between chord and arc: area r^2 (w
    - sin w)/2, its centroid 4 r sin^3(w/2) / (3 (w - sin w)) from the centre (w = sweep).
    """
    ax, ay = s.start[0] - x0, s.start[1] - y0
    bx, by = s.end[0] - x0, s.end[1] - y0
    area = (ax * by - bx * ay) / 2
    mx, my = area * (ax + bx) / 3, area * (ay + by) / 3
    if isinstance(s, Arc):
        r, w = s.radius, s.sweep
        cap = r * r * _w_minus_sin(w) / 2
        # moment of the cap along the bisector, about the arc's centre: r^3 (2/3) sin^3(w/2)
        bow = 2 / 3 * r**3 * abs(sin(w / 2)) ** 3 * (1 if w > 0 else -1)
        middle = s.start_angle + w / 2
        area += cap
        mx += cap * (s.centre[0] - x0) + bow * cos(middle)
        my += cap * (s.centre[1] - y0) + bow * sin(middle)
    return area, mx, my


def _product_moment(s: Segment) -> float:
    """Green's theorem: the integral of x^2 y/2 dy along the segment (its curl is x y).

    Exact: a cubic in the line's parameter, and a trigonometric polynomial on the arc.
    """
    if isinstance(s, Line):
        (x0, y0), (x1, y1) = s.start, s.end
        dy = y1 - y0
        return (
            dy
            / 24
            * (y0 * (3 * x0 * x0 + 2 * x0 * x1 + x1 * x1) + y1 * (x0 * x0 + 2 * x0 * x1 + 3 * x1 * x1))
        )
    (a, b), r = s.centre, s.radius
    first, last = s.start_angle, s.start_angle + s.sweep

    def antiderivative(w: float) -> float:
        # integrand (a + r c)^2 (b + r s) r c / 2 with c = cos w, s = sin w
        c, n = cos(w), sin(w)
        i_c = n
        i_cc = w / 2 + n * c / 2
        i_ccc = n - n**3 / 3
        i_cs = n * n / 2
        i_ccs = -(c**3) / 3
        i_cccs = -(c**4) / 4
        return (
            r
            / 2
            * (
                b * (a * a * i_c + 2 * a * r * i_cc + r * r * i_ccc)
                + r * (a * a * i_cs + 2 * a * r * i_ccs + r * r * i_cccs)
            )
        )

    return antiderivative(last) - antiderivative(first)


def _w_minus_sin(w: float) -> float:
    """w - sin(w), by its series if the difference would lose digits."""
    if abs(w) > 0.5:
        return w - sin(w)
    term = total = w**3 / 6
    for k in range(2, 12):
        term *= -w * w / ((2 * k) * (2 * k + 1))
        total += term
    return total


def _extreme_points(s: Segment) -> list[Point]:
    points = [s.start, s.end]
    if isinstance(s, Arc):
        (x, y), r = s.centre, s.radius
        axes = ((0.0, (x + r, y)), (pi / 2, (x, y + r)), (pi, (x - r, y)), (-pi / 2, (x, y - r)))
        points += [p for angle, p in axes if s.spans(angle)]
    return points


# Lengths below this are the rounding of coordinates of the order of 100 mm, not geometry.
ROUNDING_MM = 1e-9


@dataclass(frozen=True)
class Corner:
    """A polygon's corner (mm), its fillet radius (mm, 0 for sharp), and names.

    `edge` names the line that leaves the corner, `fillet` the arc that rounds it.
    """

    at: Point
    radius: float = 0.0
    edge: str = ""
    fillet: str = ""


def rounded_polygon(corners: list[Corner]) -> Contour:
    """The closed contour through corners, each rounded by its radius.

    Where two fillets use up a whole edge the edge vanishes and the arcs meet; two that then share their
    centre (a full round) become one arc.

    Parameters
    ----------
    corners
        In their order, mm; a radius of 0 is a sharp corner.

    Returns
    -------
    Contour
        Lines and tangent arcs, in the corners' order.

    Raises
    ------
    ValueError
        If fillets do not fit an edge, two corners coincide, or the edges at a rounded corner are parallel.
    """
    count = len(corners)
    arcs = [_fillet(corners[i - 1].at, corners[i], corners[(i + 1) % count].at) for i in range(count)]
    pieces: list[Segment] = []
    for i, corner in enumerate(corners):
        after = (i + 1) % count
        arc, next_arc = arcs[i], arcs[after]
        start = arc.end if arc else corner.at
        end = next_arc.start if next_arc else corners[after].at
        # Distance from start to end, counted positive in the direction from a to b
        ux, uy = _unit(corner.at, corners[after].at)
        room = (end[0] - start[0]) * ux + (end[1] - start[1]) * uy
        if room < -ROUNDING_MM:
            raise ValueError(f"fillets overlap by {-room:.6g} mm on the edge {corner.edge!r}")
        if arc:
            pieces.append(arc)
        if room > ROUNDING_MM:
            pieces.append(Line(start, end, corner.edge))
        elif next_arc and arc:  # the edge is used up: both arcs end at the same point
            arcs[after] = longer = replace(next_arc, start=start)
            if after == 0:
                pieces[0] = longer
        elif next_arc:
            arcs[after] = longer = replace(next_arc, start=corner.at)
            if after == 0:
                pieces[0] = longer
        elif arc:
            pieces[-1] = replace(arc, end=corners[after].at)
    return Contour(tuple(_merged(pieces)))


def _fillet(before: Point, corner: Corner, after: Point) -> Arc | None:
    """The arc tangent to both edges at the corner, from the one that comes in to the one that leaves."""
    if corner.radius == 0.0:
        return None
    x, y = corner.at
    ux, uy = _unit(before, corner.at)
    vx, vy = _unit(corner.at, after)
    cross, dot = ux * vy - uy * vx, ux * vx + uy * vy
    if abs(cross) < 1e-12:
        raise ValueError(f"no corner to round at {corner.at}: the edges are parallel")
    # tangent length r tan(turn/2), with tan(turn/2) = |cross|/(1 + dot), 1 for a right angle
    reach = corner.radius * abs(cross) / (1.0 + dot)
    side = 1.0 if cross > 0 else -1.0
    start = (x - ux * reach, y - uy * reach)
    end = (x + vx * reach, y + vy * reach)
    centre = (start[0] - side * uy * corner.radius, start[1] + side * ux * corner.radius)
    return Arc(start, end, centre, cross > 0, corner.fillet)


def _merged(pieces: list[Segment]) -> list[Segment]:
    """Join neighbouring arcs of one circle (a full round is one arc, not two)."""
    merged: list[Segment] = []
    for piece in pieces:
        if merged and (joined := _joined(merged[-1], piece)):
            merged[-1] = joined
        else:
            merged.append(piece)
    if len(merged) > 1 and (joined := _joined(merged[-1], merged[0])):
        merged.pop()
        merged[0] = joined
    return merged


def _joined(a: Segment, b: Segment) -> Arc | None:
    """Two neighbouring arcs joined to one if they are of one circle, else None."""
    if not (isinstance(a, Arc) and isinstance(b, Arc)):
        return None
    near = hypot(a.centre[0] - b.centre[0], a.centre[1] - b.centre[1]) < ROUNDING_MM
    same = near and abs(a.radius - b.radius) < ROUNDING_MM and a.ccw == b.ccw
    return Arc(a.start, b.end, a.centre, a.ccw, a.name) if same else None


def _unit(a: Point, b: Point) -> Point:
    dx, dy = b[0] - a[0], b[1] - a[1]
    size = hypot(dx, dy)
    if size == 0.0:
        raise ValueError(f"two corners coincide at {a}")
    # axis-parallel edges, the rule here, give exact units
    return (dx / size, dy / size)
