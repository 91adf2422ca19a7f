"""Kinds of cells, and the place of every cell and layer.

Frame: x along a row's cells, y along a column's, both from the array's middle; z = 0 is the foil's lower
face, + towards the object. Lengths in mm.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from math import ceil, hypot

from tactcad.contour import Contour, Corner, rectangle, rounded_polygon

from .beam import FoilBeam
from .cell import Cell, roots
from .cell_tables import CHIPS, PROCESSES, CellKind, Chip, FoilProcess, PlanarDesign
from .field import Magnet

Point = tuple[tuple[float, float], float]  # of a polygon, with the radius that rounds it
# Edges of a slot from its first corner on: the frame; beside the beam that it comes from ("b") and that it
# goes to ("a"); island or ear across a beam's root; the rest of a pinwheel's island and ear.
STRAIGHT_EDGES = ("frame", "frame", "beam b", "root", "root", "beam a")
PINWHEEL_EDGES = ("frame", "frame", "beam b", "root", "island", "ear", "root", "beam a")


@dataclass(frozen=True)
class Kind:
    """A kind of cell with what follows from the design.

    opening   side of the square in the frame, mm
    bevel     of the beams' edges, in thicknesses
    """

    name: str
    table: CellKind
    opening: float
    thickness: float
    youngs_modulus: float
    poisson: float
    bevel: float

    @property
    def pinwheel(self) -> bool:
        return self.table.form == "pinwheel"

    @property
    def beam_length(self) -> float:
        """From the island's edge, or its ear's, to the frame."""
        half = self.table.island / 2.0
        start = -half + self.table.ear if self.pinwheel else half
        return self.opening / 2.0 - start

    @property
    def rim(self) -> float:
        """Height of an ear over its beam: room for the root's fillet and its own corner."""
        return 2.0 * self.table.fillet

    @property
    def beam_offset(self) -> float:
        """y of the first beam's axis; of a pinwheel's beside the island."""
        t = self.table
        return t.island / 2.0 + t.slot + t.beam_width / 2.0 if self.pinwheel else 0.0

    @property
    def reach(self) -> float:
        """Half of the island's side, ears included."""
        t = self.table
        return self.beam_offset + t.beam_width / 2.0 + self.rim if self.pinwheel else t.island / 2.0

    @property
    def corner(self) -> float:
        """From the middle to the island's corner, or its ear's, mm."""
        return hypot(self.reach, self.table.island / 2.0)

    @cached_property
    def beam(self) -> FoilBeam:
        t, metal = self.table, (self.youngs_modulus, self.poisson)
        bevel = self.bevel * self.thickness
        return FoilBeam(self.beam_length, t.beam_width, self.thickness, t.fillet, *metal, bevel)

    @cached_property
    def cell(self) -> Cell:
        t = self.table
        start = -t.island / 2.0 + t.ear
        return Cell(self.beam, roots(t.form, t.island, start, self.beam_offset))

    def _slot(self, corner: float) -> list[Point]:
        """The first opening, of a cell at the origin: three corners of the frame, then the island's."""
        t, o = self.table, self.opening / 2.0
        a, w, r = t.island / 2.0, t.beam_width / 2.0, t.fillet
        if self.pinwheel:
            low, high, top = a + t.slot, a + t.slot + 2.0 * w, a + t.slot + 2.0 * w + self.rim
            ear = -a + t.ear
            ends = [(o, high), (o, o), (-low, o), (-low, ear), (-a, ear), (-a, top), (ear, top), (ear, high)]
            return [*zip(ends, (r, corner, r, r, corner, corner, corner, r))]
        return [((o, w), r), ((o, o), corner), ((w, o), r), ((w, a), r), ((a, a), corner), ((a, w), r)]

    def named(self, *edges: str) -> tuple[str, ...]:
        """Edges of this kind of cell by their names in the foil's outline."""
        return tuple(f"{self.name} {edge}" for edge in edges)

    def slots(self, corner: float, at: tuple[float, float]) -> tuple[Contour, ...]:
        """The four openings of the cell at `at`, with fillets at the roots and radius `corner` elsewhere."""
        edges = self.named(*(PINWHEEL_EDGES if self.pinwheel else STRAIGHT_EDGES))
        return tuple(_turned(self._slot(corner), (quarter,), at, edges) for quarter in range(4))

    def parted(self, corner: float, at: tuple[float, float]) -> tuple[Contour, Contour]:
        """The island with its half of every beam, at the origin, and the frame's edge around it, at `at`."""
        points, every = self._slot(corner), range(4)
        half = self.beam_length / 2.0
        first = ((points[-1][0][0] + half, points[0][0][1]), 0.0)  # on the first beam's edge
        second = ((points[2][0][0], points[3][0][1] + half), 0.0)
        island = [first, *reversed(points[3:]), second]
        return _turned(island, every, (0.0, 0.0)), _turned([first, *points[:3], second], every, at)

    def island_outline(self, corner: float, inset: float = 0.0) -> Contour:
        """The island with its ears, `inset` inside its edge: the foot plate's outline; `corner` rounds its
        inside corners."""
        t, a = self.table, self.table.island / 2.0
        if not self.pinwheel:
            return rectangle(-a + inset, -a + inset, a - inset, a - inset)
        top = self.reach
        ear = [((-a + t.ear, a), corner), ((-a + t.ear, top), 0.0), ((-a, top), 0.0)]
        points = [(_turn(p, quarter), radius) for quarter in range(4) for p, radius in ear]
        places = [p for p, _ in points]
        return rounded_polygon([Corner(_inset(places, i, inset), r) for i, (_, r) in enumerate(points)])


def _turn(p: tuple[float, float], quarter: int) -> tuple[float, float]:
    x, y = p
    for _ in range(quarter):
        x, y = -y, x
    return x, y


def _turned(
    points: list[Point], quarters: Iterable[int], at: tuple[float, float], edges: Sequence[str] = ()
) -> Contour:
    """The polygon of these points, turned by each of these quarters one after another; its edges' names."""
    corners = []
    for quarter, (n, (point, radius)) in product(quarters, enumerate(points)):
        x, y = _turn(point, quarter)
        name = edges[n] if edges else ""
        corners.append(Corner((round(x + at[0], 9), round(y + at[1], 9)), radius, name))
    return rounded_polygon(corners)


def _inset(points: list[tuple[float, float]], i: int, d: float) -> tuple[float, float]:
    """A corner of a counter-clockwise right-angled polygon, moved d to the inside of both its edges."""
    (x0, y0), (x, y), (x1, y1) = points[i - 1], points[i], points[(i + 1) % len(points)]

    def left(dx: float, dy: float) -> tuple[float, float]:
        length = abs(dx) + abs(dy)
        return (-dy / length * d, dx / length * d)

    a, b = left(x - x0, y - y0), left(x1 - x, y1 - y)
    return (round(x + a[0] + b[0], 9), round(y + a[1] + b[1], 9))


@dataclass(frozen=True)
class CellPlace:
    """A cell: x and y of its middle, mm. `arm` is its beams' length, by which cells are told apart."""

    number: int
    row: int
    column: int
    x: float
    y: float
    kind: Kind = field(repr=False)

    @property
    def designator(self) -> str:
        return f"E{self.number}"

    @property
    def arm(self) -> float:
        return self.kind.beam_length


def beside(e: CellPlace) -> tuple[tuple[int, int], ...]:
    """Row and column of the places beside a cell."""
    return (e.row - 1, e.column), (e.row, e.column - 1), (e.row, e.column + 1), (e.row + 1, e.column)


@dataclass(frozen=True)
class PlanarLayout:
    """Places of all cells and layers; cells are numbered along x, row by row from the least y."""

    design: PlanarDesign

    @cached_property
    def kinds(self) -> dict[str, Kind]:
        d, m, p = self.design, self.design.material, self.design.planar
        metal = m.youngs_modulus, m.poisson
        same = round(p.pitch - p.web, 9), p.thickness, *metal, self.process.bevel
        return {name: Kind(name, getattr(d, name), *same) for name in ("measuring", "reference")}

    @cached_property
    def elements(self) -> tuple[CellPlace, ...]:
        p = self.design.planar
        other = "measuring" if p.first == "reference" else "reference"
        kinds = self.kinds[p.first], self.kinds[other]
        xs, ys = ([round((i - (n - 1) / 2.0) * p.pitch, 9) for i in range(n)] for n in (p.columns, p.rows))
        places = enumerate(product(enumerate(ys), enumerate(xs)), start=1)
        return tuple(CellPlace(n, j + 1, i + 1, x, y, kinds[(i + j) % 2]) for n, ((j, y), (i, x)) in places)

    @property
    def places(self) -> tuple[tuple[float, float], ...]:
        """x and y of every cell."""
        return tuple((e.x, e.y) for e in self.elements)

    @property
    def used(self) -> tuple[Kind, ...]:
        """Kinds of which there are cells, the first one first."""
        return tuple({e.kind.name: e.kind for e in self.elements}.values())

    @property
    def process(self) -> FoilProcess:
        return PROCESSES[self.design.planar.process]

    def sheet_process(self, thickness: float) -> FoilProcess:
        """Process for a steel sheet of that thickness: as the foil, or by wire if too thick for that."""
        return self.process if thickness <= self.process.thickest else PROCESSES["wire-cut"]

    @property
    def corner(self) -> float:
        """Radius of the foil's other inside corners, mm."""
        return self.sheet_corner(self.design.planar.thickness)

    def sheet_corner(self, thickness: float) -> float:
        """Radius of a steel sheet's inside corners, mm: the least that its process leaves, to 0.01."""
        return ceil(100.0 * self.sheet_process(thickness).inside_radius(thickness) - 1e-6) / 100.0

    @property
    def half(self) -> tuple[float, float]:
        """Half length and half width of foil, spacers, base, cover and board, mm."""
        p = self.design.planar
        counts = zip((p.columns, p.rows), self.borders)
        x, y = (round(n * p.pitch / 2.0 - p.web / 2.0 + border, 9) for n, border in counts)
        return x, y

    @property
    def borders(self) -> tuple[float, float]:
        """Beyond the outer openings along x and y, mm."""
        h = self.design.housing
        return h.border, h.border if h.side is None else h.side

    @property
    def screwed(self) -> bool:
        return self.design.housing.joint == "screwed"

    @property
    def chip(self) -> Chip:
        return CHIPS[self.design.hall.chip]

    @property
    def magnet(self) -> Magnet:
        m = self.design.magnet
        return Magnet(m.diameter / 2.0, m.height, m.remanence)

    # --- heights, mm ---

    @property
    def upper_spacer(self) -> float:
        """Thickness: foot plate and room over it."""
        return round(self.design.post.foot + self.design.housing.lift, 9)

    @property
    def cover_z(self) -> float:
        return round(self.design.planar.thickness + self.upper_spacer, 9)

    @property
    def pad_z(self) -> float:
        return round(self.cover_z + self.design.housing.cover_thickness + self.design.post.stand_out, 9)

    @property
    def pad_height(self) -> float:
        """Pad over the foil's mid-plane, mm: the lever by which shear tips a cell."""
        return self.pad_z - self.design.planar.thickness / 2.0

    @property
    def base_z(self) -> float:
        """The base's upper face: the stop of the kind with the shorter way; the other's lies deeper."""
        return -min(kind.table.stop_gap for kind in self.used)

    @property
    def board_z(self) -> float:
        """The board's upper face, which carries the chips."""
        return round(-self.design.magnet.height - self.design.hall.gap - self.chip.height, 9)

    @property
    def base_thickness(self) -> float:
        return round(self.base_z - self.board_z, 9)
