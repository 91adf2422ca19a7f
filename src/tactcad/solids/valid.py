"""Whether the kernel holds a solid valid, in time that grows with the solid.

The kernel compares every two wires of a face, and does so four times in a check: a foil of 144 cells takes
half a minute each time. Of a prism a plane test shows that no two edges meet and that openings lie in the
outline, side by side; the kernel then looks at one wire at a time.
"""

from __future__ import annotations

from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepCheck import BRepCheck_Analyzer, BRepCheck_NoError, BRepCheck_Shell
from OCP.BRepTools import BRepTools
from OCP.ShapeAnalysis import ShapeAnalysis_ShapeTolerance
from OCP.TopAbs import TopAbs_FACE, TopAbs_FORWARD, TopAbs_SHELL, TopAbs_WIRE
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Compound, TopoDS_Face, TopoDS_Shape

from tactcad.contour.inside import bound_one_area, keep_clear

from .occt import as_face, as_shell, subshapes
from .prism_edges import prism_edges

# Beyond the shape's own tolerances, between edges that the kernel need not compare; chosen: ten of its least.
CLEAR_MM = 1e-6


def is_clear_prism(shape: TopoDS_Shape) -> bool:
    """Whether it is a prism along z whose edges keep clear of each other, and so passes nowhere through
    itself, and whose openings lie side by side in its outline; a plane test shows it in a hundredth of the
    kernel's time for a foil of thousands of edges."""
    edges = prism_edges(shape)
    if edges is None:
        return False
    room = CLEAR_MM + 2.0 * ShapeAnalysis_ShapeTolerance().Tolerance(shape, 1)
    return keep_clear(edges, room) and bound_one_area(edges)


def is_valid(shape: TopoDS_Shape, clear_prism: bool) -> bool:
    """Whether the kernel calls a solid valid.

    Of a clear prism it is asked for the shell, for every wall, and for every wire of the two ends as a face
    of its own.
    """
    if not clear_prism:
        return BRepCheck_Analyzer(shape).IsValid()
    for shell in subshapes(shape, TopAbs_SHELL):
        check = BRepCheck_Shell(as_shell(shell))
        if {check.Closed(), check.Orientation()} != {BRepCheck_NoError.BRepCheck_NoError}:
            return False
    pieces, make = TopoDS_Compound(), BRep_Builder()
    make.MakeCompound(pieces)
    for face in map(as_face, subshapes(shape, TopAbs_FACE)):
        for piece in _by_wire(face):
            make.Add(pieces, piece)
    return BRepCheck_Analyzer(pieces).IsValid()


def _by_wire(face: TopoDS_Face) -> list[TopoDS_Face]:
    """A plane face of several wires as one face a wire, that of an opening turned over so that it bounds what
    it surrounds."""
    forward = as_face(face.Oriented(TopAbs_FORWARD))
    wires = subshapes(forward, TopAbs_WIRE)
    if len(wires) == 1:
        return [face]
    outer = BRepTools.OuterWire_s(forward)
    place, make, pieces = TopLoc_Location(), BRep_Builder(), []
    surface = BRep_Tool.Surface_s(face, place)
    for wire in wires:
        alone = TopoDS_Face()
        make.MakeFace(alone, surface, place, BRep_Tool.Tolerance_s(face))
        make.Add(alone, wire if wire.IsSame(outer) else wire.Reversed())
        pieces.append(alone)
    return pieces
