"""Mapped mesh of a hinge shape: blocks of curved quadrilaterals of any order, nodes on the contour.

Each root is a fan: the hinge strip opens under the fillet into a quarter ring about the slot's corner,
and rings grow outwards to the block's rectangle::

      +------------------+-----------+
      |  \\     top       |           |     strip  from fillet end to fillet end
      |    \\             |           |     mouth  under the fillet, out to a quarter ellipse
      |wall  \\___        |  columns  |     ring   "top" and "side", graded geometrically
      )  fillet   \\ side |           |
    strip |mouth   |     |           |
    ------+--------+-----+-----------+   mid-line, or the flat face
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil, log, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tactcad.design.messages import CheckFailure

from .shape import Block, ElementShape

Array = NDArray[np.float64]
Grid = Array  # (order nx + 1, order ny + 1, 2): nodes of a block of nx x ny elements

GROWTH = 1.8  # of successive rings on the coarsest mesh
SAME_POINT = 1e-10  # of the mesh's size: rounding, far below any element
SLIVER = 1e-4  # straight parts of the hinge shorter than this times its thickness are left out
SIDE_LAYER = 0.5  # outermost layer of the solid mesh, in hinge thicknesses, on the coarsest mesh
# Fillet radii: height of the row of elements at a slot's floor, and twice that its length, on the coarsest
# mesh.
NEAR = 1.0
MOUTH = 2  # fewest elements under a fillet, on the coarsest mesh
# Longest element next to a fillet, and half of that along it, in hinge thicknesses, on the coarsest mesh.
COLUMN = 0.6
LONGEST = 10.0  # columns: width of an element between the fillets
# fillet radius over the strip's height above which the ring's bulge, felt far inside, would fold the mouth
STEEP = 4.0
TWO_BLOCKS = 1.4  # a rectangle longer than this times its height gets columns next to the square


@dataclass(frozen=True)
class PlaneMesh:
    """Quadrilaterals. `cells` (n, order + 1, order + 1, 2): node coordinates by local (x, z) index, mm.

    `half`: only the upper half of a shape that is symmetric about the mid-line z = middle.
    """

    cells: Array
    shape: ElementShape
    half: bool
    middle: float

    @property
    def order(self) -> int:
        return self.cells.shape[1] - 1

    @property
    def load_x(self) -> float:
        return self.shape.arm.end

    @property
    def clamp_x(self) -> float:
        return self.shape.body.end


def plane_mesh(shape: ElementShape, density: int = 1, whole: bool = False, order: int = 2) -> PlaneMesh:
    """Mapped mesh of a hinge shape.

    Parameters
    ----------
    shape
        Symmetric two-sided shapes are meshed down to their mid-line only.
    density
        1, 2, 3...: elements of every block each way, over those of the coarsest mesh.
    whole
        Mesh a symmetric shape on both sides of its mid-line too.
    order
        Of the elements.

    Raises
    ------
    CheckFailure
        If slots from both faces differ in length or radius.
    """
    shape = _without_slivers(shape)
    if not shape.two_sided:
        cells = _half(shape, shape.low, True, density, order)
        return PlaneMesh(cells, shape, False, shape.low)
    middle = (shape.low + shape.high) / 2.0
    upper = _half(shape, middle, True, density, order)
    if not whole and _symmetric(shape, middle):
        return PlaneMesh(upper, shape, True, middle)
    for block in (shape.arm, shape.body):
        low, high = block.slot_corner(upper=False), block.slot_corner(upper=True)
        if abs(low.wall - high.wall) > 1e-9 or abs(low.radius - high.radius) > 1e-9:
            raise CheckFailure(
                "slots from both faces differ in length or radius; the mapped mesh cannot join them"
            )
    lower = _half(shape, middle, False, density, order)
    return PlaneMesh(np.concatenate([upper, lower]), shape, False, middle)


def layers(half_width: float, thickness: float, density: int) -> Array:
    """Ends of the elements over half the width, from y = 0 to the free side, mm.

    They get smaller towards the free side, where plane strain changes to plane stress within about a
    thickness.

    Parameters
    ----------
    half_width
        Half the sheet's thickness, mm.
    thickness
        Of the hinge, mm.
    density
        As for `plane_mesh`.
    """
    return half_width * (1.0 - _graded(half_width, SIDE_LAYER * thickness, density)[::-1])


def merged(corners: Array) -> tuple[Array, NDArray[np.int64]]:
    """Unique points of (elements, corners, dim), and each element's indices into them.

    Two points are equal if they share a cell of either of two shifted grids, so that no grid line can
    separate points that differ by rounding only. The grid's step is not a round number: with a round one,
    points of a design in decimals would lie on grid lines, one coordinate on those of the first grid, the
    other on those of the second.
    """
    from scipy.sparse import coo_matrix  # a mesh's size does not need it
    from scipy.sparse.csgraph import connected_components

    flat = corners.reshape(-1, corners.shape[-1])
    step = SAME_POINT * np.ptp(flat, axis=0).max() / np.e
    count = len(flat)
    links = [_first_of_group(np.floor(flat / step + shift).astype(np.int64)) for shift in (0.0, 0.5)]
    graph = coo_matrix(
        (np.ones(2 * count), (np.tile(np.arange(count), 2), np.concatenate(links))), shape=(count, count)
    )
    _, index = connected_components(graph, directed=False)
    _, first = np.unique(index, return_index=True)
    return flat[first], index.reshape(corners.shape[:2])


def _first_of_group(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    _, first, index = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return first[index.ravel()]


def _without_slivers(shape: ElementShape) -> ElementShape:
    """The shape without a negligible straight part, which would give sliver elements: its fillets meet
    instead.
    """

    def met(block: Block, other: Block, side: str) -> Block:
        mine, theirs = getattr(block, side), getattr(other, side)
        if mine is None:
            return block
        half = abs(mine.wall - theirs.wall) / 2.0
        near = half - mine.radius <= SLIVER * shape.hinge_thickness
        return replace(block, **{side: replace(mine, radius=half)}) if near else block

    arm, body = shape.arm, shape.body
    for side in ("low_fillet", "high_fillet"):
        arm, body = met(arm, shape.body, side), met(body, shape.arm, side)
    return replace(shape, arm=arm, body=body)


def _symmetric(shape: ElementShape, middle: float) -> bool:
    def mirrored(block: Block) -> bool:
        low, high = block.slot_corner(upper=False), block.slot_corner(upper=True)
        gaps = (block.low + block.high - 2.0 * middle, low.wall - high.wall, low.radius - high.radius)
        return max(map(abs, gaps)) < 1e-9

    return mirrored(shape.arm) and mirrored(shape.body)


def _half(shape: ElementShape, middle: float, upper: bool, density: int, order: int) -> Array:
    """Elements on one side of the line z = middle."""
    sign = 1.0 if upper else -1.0
    strip_height = (shape.high if upper else shape.low) - middle
    fillets = [(b, b.slot_corner(upper)) for b in (shape.arm, shape.body)]
    centre = sum(f.wall for _, f in fillets) / 2.0
    arm_direction = 1.0 if shape.arm.end > shape.body.end else -1.0
    column = COLUMN * shape.hinge_thickness
    to_arm, to_body = (max(0.0, abs(f.wall - centre) - f.radius) for _, f in fillets)
    straight = to_arm + to_body > 0.0
    steps, finest = density * order, NEAR * min(f.radius for _, f in fillets)
    rows = _between(_halved([0.0, 0.5, 1.0], finest / abs(strip_height)), steps)
    grids = (
        [_strip(to_arm, to_body, column, 2.0 * finest, steps, sign * strip_height * rows)] if straight else []
    )
    for block, fillet in fillets:
        face = sign * ((block.high if upper else block.low) - middle)
        heights = [abs(z - middle) for z in (block.low, block.high)] if shape.two_sided else [face]
        direction = 1.0 if block is shape.arm else -1.0
        root = _Root(
            strip_height=sign * strip_height,
            radius=fillet.radius,
            wall=abs(fillet.wall - centre),
            end=abs(block.end - centre),
            height=face,
            square_height=min(heights),
            column=column,
        )
        grids += [grid * (direction, 1.0) for grid in root.grids(steps, rows)]
    cells = np.concatenate([_cells(grid, order) for grid in grids])
    return cells * (arm_direction, sign) + (centre, middle)


def _strip(to_arm: float, to_body: float, column: float, finest: float, steps: int, z: Array) -> Grid:
    """The hinge between the fillets' ends, x from -to_body to to_arm, z at the rows' nodes."""
    middle, half = (to_arm - to_body) / 2.0, (to_arm + to_body) / 2.0
    sizes = [min(finest, column)]
    while sum(sizes) < half * (1.0 - 1e-6):
        sizes.append(min(GROWTH * sizes[-1], LONGEST * column))
    inwards = np.concatenate([[0.0], np.cumsum(sizes)]) / sum(sizes)
    x = middle + half * _between([*(inwards - 1.0), *(1.0 - inwards[-2::-1])], steps)
    return np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1)


@dataclass(frozen=True)
class _Root:
    """One root in its quadrant: x outwards from the hinge's centre, z from the mid-line, mm."""

    strip_height: float
    radius: float
    wall: float
    end: float
    height: float
    square_height: float  # the smaller height of the two halves that share the mid-line
    column: float  # longest element along the fillet

    def grids(self, steps: int, rows: Array) -> list[Grid]:
        """Node grids of the root's blocks.

        `steps`: intervals between nodes over the length of an element of the coarsest mesh. `rows`: heights
        of the strip's rows of nodes as shares of its height, 1/2 among them.
        """
        reach = self.end - self.wall
        inner = self.strip_height + self.radius
        mouth = min(inner, 0.7 * reach)
        if self.height <= inner * (1.0 + 1e-3):
            raise CheckFailure("the slot's fillet reaches the outer face of arm or body")
        side_x, side_z = self._square(reach, inner)
        angle = pi / 2.0 * rows
        ring = np.stack([self.wall + mouth * np.cos(angle), inner * np.sin(angle)], axis=-1)

        strip_end = self.wall - self.radius
        columns = max(MOUTH, _count(pi / 4.0 * self.radius / self.column))
        u = np.linspace(0.0, 1.0, columns * steps + 1)
        turn = pi / 2.0 * u
        arc = np.stack(
            [strip_end + self.radius * np.sin(turn), self.strip_height + self.radius * (1 - np.cos(turn))],
            axis=-1,
        )
        # opposite the arc's points near the strip, so that the thinnest elements are not sheared
        floor = np.stack(
            [strip_end + self.radius * np.sin(turn) + mouth * (1.0 - np.cos(turn)), np.zeros_like(u)], axis=-1
        )
        left = _edge((strip_end, 0.0), (strip_end, self.strip_height), rows)
        grids = [_coons(floor, arc, left, ring, 1.0 if self.radius <= STEEP * self.strip_height else 3.0)]

        u = _graded((side_x - mouth + side_z - inner) / 2.0, pi / 4.0 * inner, steps)
        corner = (self.wall + side_x, side_z)
        diagonal = _edge(ring[steps], corner, u)
        foot = _edge(ring[0], (self.wall + side_x, 0.0), u)
        wall = _edge(ring[-1], (self.wall, side_z), u)
        right = _edge((self.wall + side_x, 0.0), corner, 2.0 * rows[: steps + 1])
        top = _edge(corner, (self.wall, side_z), 2.0 * rows[steps:] - 1.0)
        grids += [_coons(foot, diagonal, ring[: steps + 1], right), _coons(diagonal, wall, ring[steps:], top)]

        if reach > side_x * (1.0 + 1e-12):
            columns = _count((reach - side_x) / side_z)
            x = np.linspace(self.wall + side_x, self.end, columns * steps + 1)
            grids.append(np.stack(np.meshgrid(x, right[:, 1], indexing="ij"), axis=-1))
        if self.height > side_z * (1.0 + 1e-12):
            tall = _count((self.height - side_z) / side_x)
            z = np.linspace(side_z, self.height, tall * steps + 1)
            grids.append(np.stack(np.meshgrid(top[::-1, 0], z, indexing="ij"), axis=-1))
            if reach > side_x * (1.0 + 1e-12):
                grids.append(np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1))
        return grids

    def _square(self, reach: float, inner: float) -> tuple[float, float]:
        """Size in x and z of the rectangle that the rings grow to.

        It depends only on what both halves share, so that their nodes on the mid-line agree.
        """
        tall = self.square_height
        wide = max(tall, 1.6 * inner)
        if reach > TWO_BLOCKS * wide:
            return wide, tall
        if tall > TWO_BLOCKS * reach:
            return reach, max(reach, 1.6 * inner) if 1.6 * inner < tall else tall
        return reach, tall


def _count(lengths: float) -> int:
    """Number of elements for that many element lengths, independent of rounding in the last digits."""
    return max(1, ceil(lengths - 1e-6))


def _edge(start: ArrayLike, end: ArrayLike, u: Array) -> Array:
    start, end = np.asarray(start), np.asarray(end)
    return start + u[:, None] * (end - start)


def _halved(ends: list[float], finest: float) -> list[float]:
    """Elements' ends with the last element halved towards its end until it is no longer than `finest`."""
    ends = list(ends)
    while ends[-1] - ends[-2] > finest * (1.0 + 1e-6):
        ends.insert(-1, (ends[-1] + ends[-2]) / 2.0)
    return ends


def _between(ends: list[float], steps: int) -> Array:
    """The elements' ends with each element in that many steps."""
    return np.interp(np.arange(steps * (len(ends) - 1) + 1) / steps, np.arange(len(ends)), ends)


def _graded(length: float, step: float, steps: int) -> Array:
    """0 to 1 in elements that grow geometrically from about step/length, each in that many steps."""
    rings = max(1, round(1e-9 + log(1.0 + max(length, step) / step * (GROWTH - 1.0)) / log(GROWTH)))
    rate = rings * log(GROWTH)
    return np.expm1(rate * np.linspace(0.0, 1.0, rings * steps + 1)) / np.expm1(rate)


def _coons(bottom: Grid, top: Grid, left: Grid, right: Grid, power: float = 1.0) -> Grid:
    """Transfinite interpolation between four edges that share their ends.

    Blending follows arc length, so that graded edges grade the inside too. How far left and right edge bulge
    from their chords is felt inside by the share of the way to the other one, to that power.
    """
    u = (_share(bottom) + _share(top))[:, None, None] / 2.0
    v = (_share(left) + _share(right))[None, :, None] / 2.0
    bulges = [side - ((1 - v[0]) * side[0] + v[0] * side[-1]) for side in (left, right)]
    return (1 - v) * bottom[:, None] + v * top[:, None] + (1 - u) ** power * bulges[0] + u**power * bulges[1]


def _share(edge: Grid) -> Array:
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(edge, axis=0).T))])
    return lengths / lengths[-1] if lengths[-1] > 0.0 else np.linspace(0.0, 1.0, len(edge))


def _cells(grid: Grid, order: int) -> Array:
    """(n, order + 1, order + 1, 2) elements of a block's node grid."""
    side = order + 1
    windows = np.lib.stride_tricks.sliding_window_view(grid, (side, side), axis=(0, 1))[::order, ::order]
    return np.moveaxis(windows.reshape(-1, 2, side, side), 1, -1)
