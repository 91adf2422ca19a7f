"""Hidden-line pictures (SVG) of placed solids, from the kernel's exact hidden-line removal.

The kernel compares every edge with every face that may hide it, and its time grows faster than the number of
shapes. So a picture of many is drawn in strips, each with the shapes that reach into it, and its lines are
cut off at the strip's borders. (A plate as long as the picture reaches into every strip with all its holes;
that part of the time still grows with the square, and the exponent is 1.2 in all.)
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from html import escape
from math import ceil, hypot

import numpy as np
from numpy.typing import NDArray
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Builder
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepLib import BRepLib
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.GCPnts import GCPnts_QuasiUniformDeflection
from OCP.GeomAbs import GeomAbs_Line
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.HLRAlgo import HLRAlgo_Projector
from OCP.HLRBRep import HLRBRep_Algo, HLRBRep_HLRToShape, HLRBRep_PolyAlgo, HLRBRep_PolyHLRToShape
from OCP.TopAbs import TopAbs_EDGE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Compound, TopoDS_Shape

from tactcad.design.messages import CheckFailure
from tactcad.parts.language.description import ModelFile, Vector
from tactcad.profiling import making, under_way
from tactcad.scenes.scene import Placement
from tactcad.solids.occt import as_edge

from .boxes import Box, Chord, Point, Polyline, bounds, bounds_of, box_corners, projected_box

# Curves are drawn as chords that stay this close (mm); at 1:1 a hundredth of a line's width.
CHORD = 0.01
MARGIN = 2.0  # mm around the drawing
# Exact removal: 110 shapes take 0.8 s, 260 take 2.7 s, 2100 more than four minutes; on triangles 0.5, 1.4 and
# 18 s; on triangles and window by window the 2100 take 12 s.
EXACT_UP_TO = 300
# mm, radians: 18 chords a circle, for pictures of a hundred parts and more
MESH_LINEAR, MESH_ANGULAR = 0.05, 0.35
SAME_EXTENT = 0.05  # mm between the picture's extent and the one projected from the descriptions
Lines = tuple[list[Polyline], list[Polyline]]  # sharp, smooth
PER_WINDOW = 300  # shapes with their middle in one strip
OFF_GRID = 5e-4  # mm: points are given to a micrometre, borders lie half-way between


@dataclass(frozen=True)
class Viewpoint:
    """Eye direction (from the object to the eye) and the direction that points up in the picture."""

    name: str
    eye: Vector
    up: Vector

    @property
    def right(self) -> Vector:
        (ux, uy, uz), (ex, ey, ez) = self.up, self.eye
        r = (uy * ez - uz * ey, uz * ex - ux * ez, ux * ey - uy * ex)
        size = hypot(*r)
        return (r[0] / size, r[1] / size, r[2] / size)


ABOVE = Viewpoint("above", (1.0, -1.4, 1.0), (0.0, 0.0, 1.0))
BELOW = Viewpoint("below", (1.0, -1.4, -1.0), (0.0, 0.0, 1.0))
FRONT = Viewpoint("front", (0.0, -1.0, 0.0), (0.0, 0.0, 1.0))
BOTTOM = Viewpoint("bottom", (0.0, 0.0, -1.0), (0.0, 1.0, 0.0))
# as ABOVE, of an array that stands on an end plate, its pads to the front
ON_END = Viewpoint("on end", (1.0, -1.0, -1.4), (0.0, -1.0, 0.0))
# a part's own frame: contour in x, y, thickness along z
SIDE = Viewpoint("side", (0.0, 0.0, 1.0), (0.0, 1.0, 0.0))
OBLIQUE = Viewpoint("oblique", (0.7, 0.5, 1.4), (0.0, 1.0, 0.0))
VIEWS = {view.name: view for view in (ABOVE, BELOW, FRONT, BOTTOM, ON_END, SIDE, OBLIQUE)}


@dataclass(frozen=True)
class Drawing:
    """Visible lines in the picture plane (mm, y up): sharp edges, and smooth ones between tangent faces."""

    sharp: tuple[Polyline, ...]
    smooth: tuple[Polyline, ...]

    @property
    def box(self) -> Box:
        """Box of everything drawn, mm."""
        return bounds_of(self.sharp + self.smooth)


def drawing(shapes: Sequence[TopoDS_Shape], view: Viewpoint) -> Drawing:
    """Visible lines of placed shapes (mm, y up in the picture plane), in canonical order.

    Exact curves for up to EXACT_UP_TO shapes; beyond, the kernel's removal on triangles, window by window.
    """
    onto = projector(view.eye, view.right)
    if len(shapes) <= EXACT_UP_TO:
        sharp, smooth = _lines(exact([compound(shapes)], onto))
    else:
        # meshed once a prototype: placed copies share it
        with making("mesh", f"picture of {len(shapes)} shapes"):
            BRepMesh_IncrementalMesh(compound(shapes), MESH_LINEAR, False, MESH_ANGULAR)

        def on_triangles(some: NDArray[np.intp]) -> Lines:
            algorithm = HLRBRep_PolyAlgo()
            algorithm.Load(compound([shapes[i] for i in some]))
            algorithm.Projector(onto)
            algorithm.Update()
            result = HLRBRep_PolyHLRToShape()
            result.Update(algorithm)
            return _lines(result)

        # Least and largest corner of meshed shapes in the picture, (n, 2, 2) in mm.
        right, eye = np.array(view.right), np.array(view.eye) / np.linalg.norm(view.eye)
        plane = np.stack([right, np.cross(eye, right)], axis=1)
        boxes = np.empty((len(shapes), 2, 2))
        for n, shape in enumerate(shapes):
            box = Bnd_Box()
            BRepBndLib.Add_s(shape, box)
            low, high = ((c.X(), c.Y(), c.Z()) for c in (box.CornerMin(), box.CornerMax()))
            corners = np.array(list(box_corners((low, high)))) @ plane
            boxes[n] = corners.min(axis=0), corners.max(axis=0)
        sharp, smooth = draw_in_windows(boxes, on_triangles)
    return Drawing(tuple(sorted(sharp)), tuple(sorted(smooth)))


def projector(eye: Vector, right: Vector) -> HLRAlgo_Projector:
    return HLRAlgo_Projector(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(*eye), gp_Dir(*right)))


def exact(shapes: Sequence[TopoDS_Shape], projector: HLRAlgo_Projector) -> HLRBRep_HLRToShape:
    """Exact hidden-line removal of placed shapes, with the lines by shape.

    112 of them take 3.7 s, as one compound 1.0 s.
    """
    algorithm = HLRBRep_Algo()
    for shape in shapes:
        algorithm.Add(shape)
    algorithm.Projector(projector)
    algorithm.Update()
    algorithm.Hide()
    return HLRBRep_HLRToShape(algorithm)


def _lines(result: HLRBRep_HLRToShape | HLRBRep_PolyHLRToShape) -> Lines:
    sharp = polylines(result.VCompound()) + polylines(result.OutLineVCompound())
    return sharp, polylines(result.Rg1LineVCompound())


def compound(shapes: Sequence[TopoDS_Shape]) -> TopoDS_Compound:
    """All shapes as one: added one by one they would be compared pair by pair, for the same lines."""
    builder, whole = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(whole)
    for shape in shapes:
        builder.Add(whole, shape)
    return whole


def svg(drawn: Drawing, title: str, description: str, marked: Drawing | None = None) -> bytes:
    """A drawing at 1:1 as SVG: lines 0.35 mm, smooth ones 0.13 mm, on white; `marked` lines over it in blue.

    One smaller than a hand is shown enlarged; its lines keep their share of the width."""
    x0, y0, x1, y1 = drawn.box
    left, top = x0 - MARGIN, y1 + MARGIN
    width, height = x1 - x0 + 2 * MARGIN, y1 - y0 + 2 * MARGIN
    scale = max(1.0, ceil(120 / max(width, height)))
    pen = 0.35 / scale

    def path(name: str, colour: str, wide: float, some: Sequence[Polyline]) -> str:
        lines = ("L".join(f"{x - left:.3f},{top - y:.3f}" for x, y in line) for line in some)
        d = "".join(f"M{line}" for line in lines)
        return f'<path class="{name}" stroke="{colour}" stroke-width="{wide:.4f}" d="{d}"/>'

    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width * scale:.2f}mm" '
        f'height="{height * scale:.2f}mm" '
        f'viewBox="0 0 {width:.3f} {height:.3f}">',
        f"<title>{escape(title, quote=False)}</title>",
        f"<desc>{escape(description, quote=False)}</desc>",
        f'<rect width="{width:.3f}" height="{height:.3f}" fill="#ffffff"/>',
        '<g fill="none" stroke-linecap="round" stroke-linejoin="round">',
        path("smooth", "#8a929b", 0.4 * pen, drawn.smooth),
        path("sharp", "#10161d", pen, drawn.sharp),
        *([path("marked", "#0b62c4", 1.6 * pen, marked.sharp)] if marked else []),
        "</g>",
        "</svg>",
        "",
    ]
    return "\n".join(lines).encode()


def check_picture(data: bytes, placements: Sequence[Placement], view: Viewpoint) -> None:
    """Compare a written picture with the descriptions of its parts.

    Raises CheckFailure if its span differs from the descriptions' projection (by more than 0.05 mm); with
    models from files among them it must span at least the others, and at most all boxes.
    """
    text = data.decode()
    points = [(float(x), float(y)) for x, y in re.findall(r"[ML](-?[\d.]+),(-?[\d.]+)", text)]
    if not points:
        raise CheckFailure(f"picture {view.name}: nothing is drawn")
    x0, y0, x1, y1 = bounds(points)
    drawn = (x1 - x0, y1 - y0)
    described = [p for p in placements if not isinstance(p.part.body, ModelFile)]
    most = _span(placements, view)
    least = most if len(described) == len(placements) else _span(described, view) if described else (0.0, 0.0)
    for got, low, high, name in zip(drawn, least, most, ("width", "height")):
        if not low - SAME_EXTENT <= got <= high + SAME_EXTENT:
            meant = f"{low:.3f}" if low == high else f"{low:.3f} to {high:.3f}"
            raise CheckFailure(f"picture {view.name}: {name} {got:.3f} mm drawn, {meant} mm expected")


def _span(placements: Sequence[Placement], view: Viewpoint) -> tuple[float, float]:
    x0, y0, x1, y1 = projected_box(placements, view.right, view.eye)
    return (x1 - x0, y1 - y0)


def curves_of(compound: TopoDS_Shape | None) -> Iterator[BRepAdaptor_Curve]:
    """The edges of a removal's result, which is None or empty if there are none."""
    if compound is None or compound.IsNull():
        return
    BRepLib.BuildCurves3d_s(compound)
    explorer = TopExp_Explorer(compound, TopAbs_EDGE)
    while explorer.More():
        yield BRepAdaptor_Curve(as_edge(explorer.Current()))
        explorer.Next()


def polylines(compound: TopoDS_Shape | None) -> list[Polyline]:
    """A removal's result as chords in the picture plane, mm."""
    lines = []
    for curve in curves_of(compound):
        rounded = [(round(p.X(), 3) + 0.0, round(p.Y(), 3) + 0.0) for p in on_curve(curve, CHORD)]
        line = tuple(p for i, p in enumerate(rounded) if i == 0 or p != rounded[i - 1])
        if len(line) > 1:
            lines.append(min(line, line[::-1]))
    return lines


def on_curve(curve: BRepAdaptor_Curve, chord: float) -> list[gp_Pnt]:
    """Points along a curve of the kernel: a line's ends, else so close that chords stay within `chord` mm."""
    first, last = curve.FirstParameter(), curve.LastParameter()
    if curve.GetType() == GeomAbs_Line:
        return [curve.Value(first), curve.Value(last)]
    sampled = GCPnts_QuasiUniformDeflection(curve, chord, first, last)
    return [sampled.Value(i) for i in range(1, sampled.NbPoints() + 1)]


def draw_in_windows(boxes: NDArray[np.float64], draw: Callable[[NDArray[np.intp]], Lines]) -> Lines:
    """Lines of all shapes. boxes (n, 2, 2) are their least and largest corners in the picture (mm), `draw`
    gives the visible lines of some of them. The strips cross the picture's longer side."""
    size = boxes[:, 1].max(axis=0) - boxes[:, 0].min(axis=0)
    axis = int(np.argmax(size))
    low, high = boxes[:, 0, axis], boxes[:, 1, axis]
    middles = np.sort((low + high) / 2)
    count = ceil(len(boxes) / PER_WINDOW)
    borders = [np.floor(middles[len(boxes) * k // count] * 1e3) / 1e3 + OFF_GRID for k in range(1, count)]
    sharp: list[Polyline] = []
    smooth: list[Polyline] = []
    for n, (left, right) in enumerate(zip([-np.inf, *borders], [*borders, np.inf]), start=1):
        if left == right:
            continue
        under_way(f"strip {n} of {count}")
        for lines, kept in zip(draw(np.flatnonzero((low <= right) & (high >= left))), (sharp, smooth)):
            kept += [piece for line in lines for piece in between_borders(line, axis, left, right)]
    return sharp, smooth


def between_borders(line: Polyline, axis: int, left: float, right: float) -> Iterator[Polyline]:
    """The pieces of a line between two borders, to a micrometre; none that is a point."""
    piece: list[Point] = []
    for a, b in zip(line, line[1:]):
        inside = _within(a, b, axis, left, right)
        if inside is None:
            continue
        start, end = inside
        if piece and piece[-1] != start:
            yield tuple(piece)
            piece = []
        piece = piece or [start]
        if end != piece[-1]:
            piece.append(end)
    if len(piece) > 1:
        yield tuple(piece)


def _within(a: Point, b: Point, axis: int, left: float, right: float) -> Chord | None:
    """Both ends of the part of segment a to b between the borders, None if there is none."""
    p, q = a[axis], b[axis]
    if max(p, q) < left or min(p, q) > right:
        return None

    def moved(c: float) -> Point:
        limit = min(max(c, left), right)
        if limit == c:
            return a if c == p else b
        share = (limit - p) / (q - p)
        x, y = (round(u + share * (v - u), 3) + 0.0 for u, v in zip(a, b))
        return (x, y)

    return moved(p), (b if p == q else moved(q))


def seen_of_each(shapes: Sequence[TopoDS_Shape], view: Viewpoint) -> list[list[Polyline]]:
    """Visible sharp edges of each shape in the picture plane (mm), by exact hidden-line removal.

    The lines are those of picture.drawing, in the same order in every process.
    """
    result = exact(shapes, projector(view.eye, view.right))
    return [
        sorted(set(polylines(result.VCompound(s)) + polylines(result.OutLineVCompound(s)))) for s in shapes
    ]
