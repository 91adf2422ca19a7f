"""From a part's description to one solid of the CAD kernel, checked against its closed form.

The kernel's own binding makes it, with build123d's steps in build123d's order: loading build123d takes longer
than making the parts of an array.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import isclose, tau

from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeVertex,
    BRepBuilderAPI_MakeWire,
)
from OCP.BRepGProp import BRepGProp_Face
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakePrism,
    BRepPrimAPI_MakeRevol,
)
from OCP.BRepTools import BRepTools
from OCP.gp import gp_Ax1, gp_Ax2, gp_Ax3, gp_Circ, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.ShapeFix import ShapeFix_Face, ShapeFix_Shape
from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain
from OCP.TopAbs import TopAbs_SOLID
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape, TopoDS_Wire

from tactcad.contour import Contour, Line, Point, circle
from tactcad.parts.language.description import (
    Extrusion,
    Feature,
    Hole,
    ModelFile,
    Part,
    Revolution,
    Vector,
    drill_point_height,
)
from tactcad.profiling import making

from .measure import volume
from .occt import TopTools_ListOfShape, as_face, as_wire, subshapes
from .step import read_step_solid
from .valid import is_clear_prism, is_valid

# The kernel's volume agrees with the closed form within this share, or the build is refused.
VOLUME_AGREES = 1e-6
# Tools of cuts start this far outside the face (mm), so that no two faces coincide.
OUTSIDE = 0.5
# Holes through a plate above which they are openings of its outline, as a cut's time grows with their square;
# chosen: more than any plate had whose files are kept.
MANY = 100


class SolidError(RuntimeError):
    """The kernel's solid differs from the description."""


def build(part: Part) -> TopoDS_Shape:
    """The part's solid in its own frame, mm.

    Raises
    ------
    SolidError
        Where the result is not one valid solid, or its volume is not the closed form's.
    """
    with making("solid", part.part_no):
        return _built(part)


def _built(part: Part) -> TopoDS_Shape:
    if isinstance(part.body, ModelFile):
        return read_step_solid(part.body)
    body, features = part.body, part.features
    if isinstance(body, Extrusion) and len(bores := _bores(body, features)) > MANY:
        openings = (circle((h.at[0], h.at[1]), h.diameter) for h in bores)
        body = replace(body, openings=(*body.openings, *openings))
        features = tuple(f for f in features if f not in bores)
    stock = _extruded(body) if isinstance(body, Extrusion) else _revolved(body)
    tools = [tool for feature in features for tool in _tools(feature)]
    solids = subshapes(_cut(stock, tools) if tools else stock, TopAbs_SOLID)
    if len(solids) != 1:
        raise SolidError(f"{part.part_no}: the description makes {len(solids)} solids")
    (solid,) = solids
    if not is_valid(solid, is_clear_prism(solid)):
        raise SolidError(f"{part.part_no}: the kernel calls the solid invalid")
    found = volume(solid)
    if abs(found - part.volume) > VOLUME_AGREES * part.volume:
        raise SolidError(
            f"{part.part_no}: the solid has {found:.9g} mm3, its description {part.volume:.9g} mm3"
        )
    return solid


def _bores(body: Extrusion, features: Sequence[Feature]) -> list[Hole]:
    """The plain holes through a plate, from face to face."""
    return [
        f
        for f in features
        if isinstance(f, Hole) and f.through and not f.counterbore and abs(f.axis[2]) == 1.0
        if isclose(f.depth, body.thickness)
    ]


def _cut(stock: TopoDS_Shape, tools: Sequence[TopoDS_Shape]) -> TopoDS_Shape:
    """Stock less all tools; the remainder of one surface is one face."""
    operation, first, others = BRepAlgoAPI_Cut(), TopTools_ListOfShape(), TopTools_ListOfShape()
    first.Append(stock)
    for tool in tools:
        others.Append(tool)
    operation.SetArguments(first)
    operation.SetTools(others)
    operation.SetRunParallel(True)
    operation.Build()
    joined = ShapeUpgrade_UnifySameDomain(operation.Shape(), True, True, True)
    joined.AllowInternalEdges(False)
    joined.Build()
    return joined.Shape()


def _axes(at: Vector, axis: Vector, x_axis: Vector | None = None) -> gp_Ax3:
    origin, z = gp_Pnt(*at), gp_Dir(*axis)
    return gp_Ax3(origin, z, gp_Dir(*x_axis)) if x_axis else gp_Ax3(origin, z)


FLAT = _axes((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
UPRIGHT = _axes((0.0, 0.0, 0.0), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0))  # its y is the part's z


def wire(contour: Contour, plane: gp_Ax3 = FLAT) -> TopoDS_Wire:
    """The contour as a closed wire in a plane.

    Neighbours share one vertex at the contour's own point. (build123d's Wire(edges) picks either edge's end
    by memory address, and files then differ in their last digits from run to run.)
    """
    there = gp_Trsf()
    there.SetTransformation(plane, gp_Ax3())

    def in_space(point: Point) -> gp_Pnt:
        return gp_Pnt(*point, 0.0).Transformed(there)

    maker = BRepBuilderAPI_MakeWire()
    circle = contour.as_circle()
    if circle:
        centre, radius = circle
        axes = gp_Ax2(in_space(centre), plane.Direction(), plane.XDirection())
        maker.Add(BRepBuilderAPI_MakeEdge(gp_Circ(axes, radius)).Edge())
        return maker.Wire()
    corners = [BRepBuilderAPI_MakeVertex(in_space(s.start)).Vertex() for s in contour]
    for s, first, last in zip(contour, corners, corners[1:] + corners[:1]):
        if isinstance(s, Line):
            edge = BRepBuilderAPI_MakeEdge(first, last)
        else:
            up = plane.Direction() if s.ccw else plane.Direction().Reversed()
            edge = BRepBuilderAPI_MakeEdge(gp_Circ(gp_Ax2(in_space(s.centre), up), s.radius), first, last)
        maker.Add(edge.Edge())
    return maker.Wire()


def _face(plane: gp_Ax3, outer: Contour, openings: Sequence[Contour] = ()) -> TopoDS_Face:
    """Flat, with openings; it looks along the plane's normal."""
    maker = BRepBuilderAPI_MakeFace(_sound(wire(outer, plane)), True)
    for opening in openings:
        maker.Add(_sound(wire(opening, plane)))
    maker.Build()
    fix = ShapeFix_Face(maker.Face())
    fix.FixOrientation()
    fix.Perform()
    face = as_face(fix.Result())
    at, normal = gp_Pnt(), gp_Vec()
    low_u, high_u, low_v, high_v = BRepTools.UVBounds_s(face)
    BRepGProp_Face(face).Normal((low_u + high_u) / 2, (low_v + high_v) / 2, at, normal)
    looks_along = normal.Dot(gp_Vec(plane.Direction())) > 0
    return face if looks_along else as_face(face.Complemented())


def _sound(wire: TopoDS_Wire) -> TopoDS_Wire:
    fix = ShapeFix_Shape(wire)
    fix.Perform()
    return as_wire(fix.Shape())


def _along(face: TopoDS_Face, way: gp_Vec) -> TopoDS_Shape:
    return BRepPrimAPI_MakePrism(face, way).Shape()


def _extruded(body: Extrusion) -> TopoDS_Shape:
    return _along(_face(FLAT, body.outer, body.openings), gp_Vec(0, 0, body.thickness))


def _revolved(body: Revolution) -> TopoDS_Shape:
    axis = gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))
    return BRepPrimAPI_MakeRevol(_face(UPRIGHT, body.profile), axis, tau, True).Shape()


def _tools(feature: Feature) -> list[TopoDS_Shape]:
    """Solids to cut away. They reach OUTSIDE the face they start from, and a through hole beyond its end."""
    if isinstance(feature, Hole):
        return _hole_tools(feature)
    start = _axes(_on(feature.at, feature.axis, -OUTSIDE), feature.axis, feature.x_axis)
    face = _face(start, feature.contour, feature.island)
    return [_along(face, gp_Vec(*feature.axis) * (OUTSIDE + feature.depth))]


def _hole_tools(hole: Hole) -> list[TopoDS_Shape]:
    start = _axes(_on(hole.at, hole.axis, -OUTSIDE), hole.axis).Ax2()
    r = hole.diameter / 2
    beyond = OUTSIDE if hole.through else 0.0
    tools = [BRepPrimAPI_MakeCylinder(start, r, OUTSIDE + hole.depth + beyond).Shape()]
    if hole.drill_point:
        tip = _axes(_on(hole.at, hole.axis, hole.depth), hole.axis).Ax2()
        tools.append(BRepPrimAPI_MakeCone(tip, r, 0, drill_point_height(hole.diameter)).Shape())
    if hole.counterbore:
        diameter, depth = hole.counterbore
        tools.append(BRepPrimAPI_MakeCylinder(start, diameter / 2, OUTSIDE + depth).Shape())
    return tools


def _on(at: Vector, axis: Vector, way: float) -> Vector:
    """The point that far along the axis (mm)."""
    x, y, z = (a + way * b for a, b in zip(at, axis))
    return x, y, z
