"""From a part's description to one solid of the CAD kernel (build123d), checked against its closed form."""

from __future__ import annotations

from typing import Any

from build123d import Axis, Edge, Face, Plane, Solid, Vector, Wire
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeVertex, BRepBuilderAPI_MakeWire
from OCP.gp import gp_Ax2, gp_Circ, gp_Pnt

from tactcad.contour import Contour, Line, Point
from tactcad.parts.language.description import (
    Extrusion,
    Feature,
    Hole,
    ModelFile,
    Part,
    Revolution,
    drill_point_height,
)
from tactcad.profiling import making

from .step import read_step_solid

# The kernel's volume agrees with the closed form within this share, or the build is refused.
VOLUME_AGREES = 1e-6
# Tools of cuts start this far outside the face (mm), so that no two faces coincide.
OUTSIDE = 0.5


class SolidError(RuntimeError):
    """The kernel made something other than the description says."""


def build(part: Part) -> Solid:
    """The part's solid in its own frame, mm.

    Raises
    ------
    SolidError
        Where the result is not one valid solid, or its volume is not the closed form's.
    """
    with making("solid", part.part_no):
        return _built(part)


def _built(part: Part) -> Solid:
    if isinstance(part.body, ModelFile):
        return read_step_solid(part.body)
    stock = _extruded(part.body) if isinstance(part.body, Extrusion) else _revolved(part.body)
    tools = [tool for feature in part.features for tool in _tools(feature)]
    solid = _only_solid(stock.cut(*tools) if tools else stock, part)
    if not solid.is_valid:
        raise SolidError(f"{part.part_no}: the kernel calls the solid invalid")
    if abs(solid.volume - part.volume) > VOLUME_AGREES * part.volume:
        raise SolidError(
            f"{part.part_no}: the solid has {solid.volume:.9g} mm3, its description {part.volume:.9g} mm3"
        )
    return solid


def _only_solid(shape: Any, part: Part) -> Solid:
    pieces = [shape] if hasattr(shape, "solids") else shape
    solids = [solid for piece in pieces for solid in piece.solids()]
    if len(solids) != 1:
        raise SolidError(f"{part.part_no}: the description makes {len(solids)} solids")
    return solids[0]


def wire(contour: Contour, plane: Plane = Plane.XY) -> Wire:
    """The contour as a closed wire in a plane.

    Neighbours share one vertex at the contour's own point. (build123d's Wire(edges) picks either edge's end
    by memory address, and files then differ in their last digits from run to run.)
    """

    def in_space(point: Point) -> gp_Pnt:
        return plane.from_local_coords(Vector(*point, 0)).to_pnt()

    circle = contour.as_circle()
    if circle:
        centre, radius = circle
        axes = gp_Ax2(in_space(centre), plane.z_dir.to_dir(), plane.x_dir.to_dir())
        return Wire([Edge(BRepBuilderAPI_MakeEdge(gp_Circ(axes, radius)).Edge())])
    corners = [BRepBuilderAPI_MakeVertex(in_space(s.start)).Vertex() for s in contour]
    maker = BRepBuilderAPI_MakeWire()
    for s, first, last in zip(contour, corners, corners[1:] + corners[:1]):
        if isinstance(s, Line):
            edge = BRepBuilderAPI_MakeEdge(first, last)
        else:
            up = plane.z_dir.to_dir() if s.ccw else (-plane.z_dir).to_dir()
            edge = BRepBuilderAPI_MakeEdge(gp_Circ(gp_Ax2(in_space(s.centre), up), s.radius), first, last)
        maker.Add(edge.Edge())
    return Wire(maker.Wire())


def _extruded(body: Extrusion) -> Solid:
    face = Face(wire(body.outer), [wire(opening) for opening in body.openings])
    return Solid.extrude(face if face.normal_at().Z > 0 else -face, Vector(0, 0, body.thickness))


def _revolved(body: Revolution) -> Solid:
    profile = Face(wire(body.profile, Plane.XZ))
    return Solid.revolve(profile, 360, Axis.Z)


def _tools(feature: Feature) -> list[Solid]:
    """Solids to cut away. They reach OUTSIDE the face they start from, and a through hole beyond its end."""
    if isinstance(feature, Hole):
        return _hole_tools(feature)
    axis = Vector(*feature.axis)
    start = Plane(Vector(*feature.at) - axis * OUTSIDE, x_dir=Vector(*feature.x_axis), z_dir=axis)
    face = Face(wire(feature.contour, start), [wire(island, start) for island in feature.island])
    if face.normal_at().dot(axis) < 0:
        face = -face
    return [Solid.extrude(face, axis * (OUTSIDE + feature.depth))]


def _hole_tools(hole: Hole) -> list[Solid]:
    at, axis = Vector(*hole.at), Vector(*hole.axis)
    start = Plane(at - axis * OUTSIDE, z_dir=axis)
    r = hole.diameter / 2
    beyond = OUTSIDE if hole.through else 0.0
    tools = [Solid.make_cylinder(r, OUTSIDE + hole.depth + beyond, start)]
    if hole.drill_point:
        tip = Plane(at + axis * hole.depth, z_dir=axis)
        tools.append(Solid.make_cone(r, 0, drill_point_height(hole.diameter), tip))
    if hole.counterbore:
        diameter, depth = hole.counterbore
        tools.append(Solid.make_cylinder(diameter / 2, OUTSIDE + depth, start))
    return tools
