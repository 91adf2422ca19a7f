"""A part's solid cut by the plane of a section: what is left of it, and the face that the plane has cut."""

from __future__ import annotations

from OCP.Bnd import Bnd_Box
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.BRepTools import BRepTools_WireExplorer
from OCP.GeomAbs import GeomAbs_Plane
from OCP.gp import gp_Pnt
from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED, TopAbs_WIRE
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape, TopoDS_Wire

from tactcad.design.messages import CheckFailure
from tactcad.solids.explore import subshapes
from tactcad.solids.occt import as_face, as_wire

from .hidden_lines import CHORD
from .ink import Hatch, Point
from .picture import on_curve
from .sheet_plan import SectionPlane, View, seen

AROUND = 1.0  # mm: the box that is kept stands out of the part
SAME = 1e-7  # mm: the kernel's own tolerance


def cut(shape: TopoDS_Shape, view: View, section: SectionPlane) -> tuple[TopoDS_Shape, Hatch]:
    """What lies behind the plane of a section, and its cut face in the view's plane (mm of the part).

    Raises CheckFailure where the plane misses the part.
    """
    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box)
    low, high = ([p.X(), p.Y(), p.Z()] for p in (box.CornerMin(), box.CornerMax()))
    low, high = [v - AROUND for v in low], [v + AROUND for v in high]
    k, at = section.axis, section.at
    (low if view.eye[k] < 0 else high)[k] = at
    kept = BRepPrimAPI_MakeBox(gp_Pnt(*low), gp_Pnt(*high)).Shape()
    half = BRepAlgoAPI_Common(shape, kept).Shape()
    loops = [
        _loop(as_wire(wire), view) for face in _faces(half, k, at) for wire in subshapes(face, TopAbs_WIRE)
    ]
    if not loops:
        raise CheckFailure(
            f"drawings: the section at {'xy'[k]} = {at:g} mm cuts nothing; no drawing was written"
        )
    return half, Hatch(tuple(sorted(loops)))


def _faces(shape: TopoDS_Shape, k: int, at: float) -> list[TopoDS_Face]:
    """Faces in the plane across axis k."""
    faces = []
    for face in map(as_face, subshapes(shape, TopAbs_FACE)):
        surface = BRepAdaptor_Surface(face)
        if surface.GetType() == GeomAbs_Plane:
            plane = surface.Plane()
            # OCC counts coordinates from 1
            off = abs(plane.Location().Coord(k + 1) - at)
            if abs(abs(plane.Axis().Direction().Coord(k + 1)) - 1.0) < SAME and off < SAME:
                faces.append(face)
    return faces


def _loop(wire: TopoDS_Wire, view: View) -> tuple[Point, ...]:
    """The wire as a polygon in the view; curved edges as chords."""
    points: list[Point] = []
    explorer = BRepTools_WireExplorer(wire)
    while explorer.More():
        edge = explorer.Current()
        run = on_curve(BRepAdaptor_Curve(edge), CHORD)
        if edge.Orientation() == TopAbs_REVERSED:
            run.reverse()
        flat = [seen(view, (p.X(), p.Y(), p.Z())) for p in run[:-1]]
        points += [(round(u, 6) + 0.0, round(v, 6) + 0.0) for u, v in flat]
        explorer.Next()
    start = points.index(min(points))
    return tuple(points[start:] + points[:start])
