"""Is the kernel's solid a good one: valid, one solid, one closed shell, the description's volume."""

from __future__ import annotations

from OCP.BRep import BRep_Tool
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.TopAbs import TopAbs_SHELL, TopAbs_SOLID
from OCP.TopoDS import TopoDS_Shape

from tactcad.parts.description import Part
from tactcad.solids.explore import subshapes
from tactcad.solids.measure import measure

from .finding import Finding

VOLUME_AGREES = 1e-6


def check_brep(part: Part, shape: TopoDS_Shape) -> list[Finding]:
    """Findings on the part's shape in its own frame."""
    found: list[Finding] = []

    def fail(check: str, value: float, limit: float, message: str) -> None:
        found.append(Finding(check, "fail", part.part_no, (), value, limit, message))

    solids, shells = subshapes(shape, TopAbs_SOLID), subshapes(shape, TopAbs_SHELL)
    if len(solids) != 1 or len(shells) != 1:
        fail("one-solid", len(solids), 1, f"{len(solids)} solids with {len(shells)} shells instead of one of each")
        return found
    if not BRepCheck_Analyzer(shape).IsValid():
        fail("brep-valid", 0, 1, "the kernel calls the solid invalid")
    if not BRep_Tool.IsClosed_s(shells[0]):
        fail("shell-closed", 0, 1, "the solid's shell is open")
    volume = measure(shape)["volume"]
    if abs(volume - part.volume) > VOLUME_AGREES * part.volume:
        fail("volume", volume, part.volume, f"the solid has {volume:.9g} mm3, its description {part.volume:.9g} mm3")
    return found
