"""A board's geometry: places of components, tracks, vias, planes, holes; mm, x to the right and y down from
the upper left corner, seen on the component side, as in KiCad.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import cos, pi, radians, sin

from tactcad.parts.array.board_plate import THICKNESS

from .footprints import Footprint, Pad, footprint
from .netlist import GROUND, Component, Netlist
from .read_board import EXCITATION

Point = tuple[float, float]
TOP, BOTTOM = "F.Cu", "B.Cu"
PLANES = {"In1.Cu": GROUND, "In2.Cu": EXCITATION}  # whole planes of a bridges' board: the net of each
LAYERS = (TOP, *PLANES, BOTTOM)
CLEARANCE = 0.2  # mm between copper of two nets: KiCad's default; board houses ask for 0.10 to 0.13
TRACK, WIDE = 0.2, 0.3  # mm; the wide ones carry a bridge's current
VIA, VIA_DRILL = 0.6, 0.3  # mm
EDGE = 0.5  # mm from copper to the board's edge and to holes without copper


@dataclass(frozen=True)
class Track:
    net: str
    layer: str
    start: Point
    end: Point
    width: float = TRACK


@dataclass(frozen=True)
class Via:
    net: str
    at: Point


@dataclass(frozen=True)
class Placed:
    """A component at its place, turned anticlockwise by so many degrees."""

    component: Component
    at: Point
    turn: int = 0

    @property
    def footprint(self) -> Footprint:
        return footprint(self.component.footprint)

    def point(self, x: float, y: float) -> Point:
        """A place of the footprint on the board."""
        c, s = round(cos(radians(self.turn))), round(sin(radians(self.turn)))
        return rounded((self.at[0] + c * x + s * y, self.at[1] - s * x + c * y))

    def pad_at(self, pad: Pad) -> Point:
        return self.point(pad.x, pad.y)

    def size(self, pad: Pad) -> Point:
        """Width and height of the pad on the board."""
        return (pad.h, pad.w) if self.turn % 180 else (pad.w, pad.h)

    def net(self, pad: Pad) -> str:
        """ "" of a pad that stays open."""
        return {p.number: p.net for p in self.component.pins}.get(pad.number, "")


def rounded(p: Point) -> Point:
    """To KiCad's and Gerber's last digit, 1 nm times 1000."""
    return (round(p[0], 3), round(p[1], 3))


@dataclass(frozen=True)
class BoardCopper:
    """The board of a netlist. `holes` without copper: x, y, diameter; `planes`: the net of each inner layer;
    `label`: the middle of its printed name, if not at the usual place."""

    netlist: Netlist
    width: float
    height: float
    placed: tuple[Placed, ...] = field(repr=False)
    tracks: tuple[Track, ...] = field(repr=False)
    vias: tuple[Via, ...] = field(repr=False)
    holes: tuple[tuple[float, float, float], ...] = field(repr=False)
    planes: Mapping[str, str] = field(default_factory=lambda: PLANES)
    thickness: float = THICKNESS
    label: Point | None = None

    @cached_property
    def pads(self) -> tuple[tuple[Placed, Pad, Point, str], ...]:
        """Every pad, its place, and its net."""
        return tuple((p, pad, p.pad_at(pad), p.net(pad)) for p in self.placed for pad in p.footprint.pads)

    @cached_property
    def outlines(self) -> dict[str, tuple[Point, ...]]:
        """Of each plane: one closed line around its copper, with slits of no width to its openings."""
        return {layer: self._outline(net) for layer, net in self.planes.items()}

    def corners(self, inside: bool = False) -> tuple[Point, ...]:
        """Corners of the board, or of its planes."""
        e = EDGE if inside else 0.0
        return ((e, e), (self.width - e, e), (self.width - e, self.height - e), (e, self.height - e))

    def _outline(self, net: str) -> tuple[Point, ...]:
        ring = list(self.corners(inside=True))
        openings = [_circle(v.at, VIA / 2 + CLEARANCE) for v in self.vias if v.net != net]
        openings += [_circle((x, y), d / 2 + EDGE) for x, y, d in self.holes]
        for _, pad, at, own in self.pads:
            if pad.drill:
                openings += _relief(at, pad.w / 2) if own == net else [_circle(at, pad.w / 2 + CLEARANCE)]
        for opening in sorted(openings, key=min):
            _cut(ring, opening)
        return tuple(ring)


def _circle(at: Point, r: float, count: int = 24) -> list[Point]:
    """Around a circle, anticlockwise on the board, as all openings: the plane's own edge runs clockwise."""
    around = r / cos(pi / count)
    angles = (-2 * pi * (i + 0.5) / count for i in range(count))
    return [rounded((at[0] + around * cos(a), at[1] + around * sin(a))) for a in angles]


GAP, SPOKE = 0.3, 0.5  # mm, of a plane's joint to a soldered pin: an iron's heat stays in the pin


def _relief(at: Point, r: float) -> list[list[Point]]:
    """The four openings around a pin that is joined to the plane by four spokes."""
    found = []
    for quarter in range(4):
        edges = []
        for radius in (r, r + GAP):
            half = pi / 4 - (SPOKE / 2) / radius
            angles = [pi / 4 + quarter * pi / 2 + half * (i / 4 - 1) for i in range(9)]
            edges.append([rounded((at[0] + radius * cos(a), at[1] + radius * sin(a))) for a in angles])
        found.append(edges[1][::-1] + edges[0])
    return found


def _cut(ring: list[Point], opening: list[Point]) -> None:
    """Join an opening to the ring by a slit from its leftmost point to the left."""
    at = min(opening)
    first = opening.index(at)
    y, best, where = at[1], -1.0, -1
    ax, ay = ring[0]
    for i, (bx, by) in enumerate(ring[1:] + ring[:1]):
        if (ay <= y <= by or by <= y <= ay) and ay != by:
            x = ax + (bx - ax) * (y - ay) / (by - ay)
            if best < x <= at[0]:
                best, where = x, i
        ax, ay = bx, by
    hit = (round(best, 6), y)
    ring[where + 1 : where + 1] = [hit, *opening[first:], *opening[:first], at, hit]
