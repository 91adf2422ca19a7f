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
    """The same shape, shared, at that place."""
    return shape.Located(location(origin, rotation))
