"""Measurements by the kernel on shapes: size, the faces near a box, the distance of two sets of faces."""

from __future__ import annotations

from math import inf

import numpy as np
from numpy.typing import ArrayLike
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepGProp import BRepGProp
from OCP.GeomAbs import GeomAbs_Cylinder
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_FACE, TopAbs_VERTEX
from OCP.TopoDS import TopoDS_Compound, TopoDS_Shape

from tactcad.parts.language.description import Vector
from tactcad.scenes.scene import Placement

from .occt import as_face, as_vertex, location, subshapes


def measure(shape: TopoDS_Shape) -> dict:
    """The kernel's measurements on a shape.

    Returns
    -------
    dict
        `volume` (mm3), `area` of the surface (mm2), `centre` of mass (mm), `inertia` about that at density
        1, 3 x 3 (mm5), and `box` as (least, largest) corner (mm).
    """
    solid, surface = GProp_GProps(), GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, solid)
    BRepGProp.SurfaceProperties_s(shape, surface)
    centre, matrix = solid.CentreOfMass(), solid.MatrixOfInertia()
    return {
        "volume": solid.Mass(),
        "area": surface.Mass(),
        "centre": [centre.X(), centre.Y(), centre.Z()],
        "inertia": [[matrix.Value(i, j) for j in (1, 2, 3)] for i in (1, 2, 3)],
        "box": bounding_box(shape),
    }


def volume(shape: TopoDS_Shape) -> float:
    """mm3"""
    solid = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, solid)
    return solid.Mass()


def bounding_box(shape: TopoDS_Shape) -> list[list[float]]:
    """Least and largest corner, mm, of the exact surfaces."""
    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(shape, box, False, False)
    low, high, gap = box.CornerMin(), box.CornerMax(), box.GetGap()
    return [[low.X() + gap, low.Y() + gap, low.Z() + gap], [high.X() - gap, high.Y() - gap, high.Z() - gap]]


def holes_through(shape: TopoDS_Shape) -> list[tuple[float, float, float]]:
    """Every round hole along z, once: x, y and diameter, mm."""
    found = set()
    for face in subshapes(shape, TopAbs_FACE):
        surface = BRepAdaptor_Surface(as_face(face))
        if surface.GetType() == GeomAbs_Cylinder:
            cylinder = surface.Cylinder()
            axis = cylinder.Axis()
            if abs(axis.Direction().Z()) > 1 - 1e-9:
                at = axis.Location()
                found.add((round(at.X(), 6), round(at.Y(), 6), round(2 * cylinder.Radius(), 6)))
    return sorted(found)


class Faces:
    """A shape's faces, and a box (n, 2, 3) around each in the shape's own frame, mm; the kernel's boxes are a
    little too large, never too small."""

    def __init__(self, shape: TopoDS_Shape) -> None:
        self.faces = subshapes(shape, TopAbs_FACE)
        self.boxes = np.array([_box(face) for face in self.faces])


def faces_within(faces: Faces, place: Placement, box: np.ndarray, reach: float) -> TopoDS_Compound | None:
    """The faces of a placed shape that come near a box.

    Parameters
    ----------
    faces
        In the shape's own frame.
    place
        The shape's place.
    box : ndarray, shape (2, 3)
        Least and largest corner in the scene, mm.
    reach
        Largest distance of a face's own box, mm.

    Returns
    -------
    TopoDS_Compound or None
        The faces at their place; None if none comes near.
    """
    low, high = np.moveaxis(boxed(faces.boxes, np.array(place.rotation), np.array(place.origin)), -2, 0)
    near = np.flatnonzero(np.all((low <= box[1] + reach) & (high >= box[0] - reach), axis=1))
    if not len(near):
        return None
    compound, make = TopoDS_Compound(), BRep_Builder()
    make.MakeCompound(compound)
    for i in near:
        make.Add(compound, faces.faces[i])
    return compound.Located(location(place.origin, place.rotation))


MOST_VERTICES = 6  # of each set that are tried; chosen: of two layers the first one meets


def met_at_vertex(
    first: TopoDS_Shape | None, second: TopoDS_Shape | None, within: float
) -> tuple[float, Vector] | None:
    """A vertex of one set of faces that lies within that distance (mm) of the other set: its distance and
    place, as of `nearest`; None if the vertices tried are further off, though the sets may not be.

    Fast for faces with thousands of edges, whose pairs `nearest` would all measure.
    """
    for own, other in ((first, second), (second, first)):
        if own is None or other is None:
            return None
        low, high = np.array(_box(other)) + [[-within], [within]]
        vertices = [
            v for v in subshapes(own, TopAbs_VERTEX) if np.all((low <= (p := _point(v))) & (p <= high))
        ]
        for vertex in vertices[:: max(1, len(vertices) // MOST_VERTICES)]:
            distance, place = nearest(vertex, other)
            if distance < within:
                return distance, place
    return None


def _point(vertex: TopoDS_Shape) -> np.ndarray:
    return np.array(BRep_Tool.Pnt_s(as_vertex(vertex)).Coord())


def nearest(first: TopoDS_Shape | None, second: TopoDS_Shape | None) -> tuple[float, Vector]:
    """Distance between two sets of faces.

    Parameters
    ----------
    first, second
        As `faces_within` gives them; None for an empty set.

    Returns
    -------
    tuple
        The distance, mm, infinite if a set is empty; and its point on the first set.
    """
    if first is None or second is None:
        return inf, (0.0, 0.0, 0.0)
    nearest_points = BRepExtrema_DistShapeShape(first, second)
    point = nearest_points.PointOnShape1(1)
    return nearest_points.Value(), (point.X(), point.Y(), point.Z())


def boxed(boxes: ArrayLike, rotation: np.ndarray, origin: np.ndarray) -> np.ndarray:
    """Boxes around turned and moved boxes.

    The middle moves along; each half extent becomes the sum of what the turned edges reach along an axis.

    Parameters
    ----------
    boxes : ndarray, shape (..., 2, 3)
        Least and largest corners, mm.
    rotation : ndarray, shape (3, 3)
        Scene direction = rotation x local direction.
    origin : ndarray, shape (3,)
        mm.

    Returns
    -------
    ndarray, shape (..., 2, 3)
        Least and largest corners in the scene, mm.
    """
    ends = np.asarray(boxes)
    middle, half = ends.mean(axis=-2), (ends[..., 1, :] - ends[..., 0, :]) / 2
    centre, reach = middle @ rotation.T + origin, half @ np.abs(rotation).T
    return np.stack([centre - reach, centre + reach], axis=-2)


def _box(face: TopoDS_Shape) -> list[list[float]]:
    box = Bnd_Box()
    BRepBndLib.Add_s(face, box, False)
    low, high = box.CornerMin(), box.CornerMax()
    return [[low.X(), low.Y(), low.Z()], [high.X(), high.Y(), high.Z()]]
