"""Shapes at their places in a scene."""

from __future__ import annotations

from OCP.gp import gp_Trsf
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape

from tactcad.parts.description import Vector
from tactcad.scenes.scene import Rotation


def location(origin: Vector, rotation: Rotation) -> TopLoc_Location:
    """The kernel's location: scene point = rotation x local point + origin (mm)."""
    (a, b, c), (x, y, z) = rotation, origin
    t = gp_Trsf()
    t.SetValues(*a, x, *b, y, *c, z)
    return TopLoc_Location(t)


def placed_shape(shape: TopoDS_Shape, origin: Vector, rotation: Rotation) -> TopoDS_Shape:
    """The same shape, shared, at a place in the scene.

    Parameters
    ----------
    shape
        In its own frame, mm.
    origin
        Of that frame in the scene, mm.
    rotation
        Rows of the matrix that turns local into scene directions.
    """
    return shape.Located(location(origin, rotation))
