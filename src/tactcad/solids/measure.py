"""What the kernel measures on a shape."""

from __future__ import annotations

from OCP.Bnd import Bnd_Box
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.TopoDS import TopoDS_Shape


def measure(shape: TopoDS_Shape) -> dict:
    """What the kernel measures on a shape.

    Returns
    -------
    dict
        `volume` (mm3), `area` of the surface (mm2), `centre` of mass (mm), and `box` as (least, largest)
        corner (mm).
    """
    solid, surface = GProp_GProps(), GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, solid)
    BRepGProp.SurfaceProperties_s(shape, surface)
    centre = solid.CentreOfMass()
    return {
        "volume": solid.Mass(),
        "area": surface.Mass(),
        "centre": [centre.X(), centre.Y(), centre.Z()],
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
