"""Whether the kernel's solid is sound: valid, one solid, one closed shell, the description's volume, no
slivers, no surface through another one; and whether it still is when written as STEP and read back.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import dist, inf

from OCP.BOPAlgo import BOPAlgo_ArgumentAnalyzer
from OCP.BRep import BRep_Tool
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_ShapeEnum, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopoDS import TopoDS_Shape

from tactcad.contour import LEAST_EDGE, is_sliver
from tactcad.parts.description import Part
from tactcad.parts.finding import Finding
from tactcad.solids.explore import subshapes
from tactcad.solids.measure import measure
from tactcad.solids.occt import as_edge
from tactcad.solids.step import read_step, write_step

VOLUME_AGREES = 1e-6
# A solid read back from STEP agrees with the one written up to the last of the file's 15 digits: shares of
# volume and area, and mm.
STEP_AGREES, STEP_AGREES_MM = 1e-9, 1e-6
LEAST_FACE = LEAST_EDGE**2  # mm2


def check_brep(part: Part, shape: TopoDS_Shape) -> list[Finding]:
    """Findings on the part's shape in its own frame."""
    findings: list[Finding] = []

    def fail(check: str, value: float, limit: float, message: str) -> None:
        findings.append(Finding(check, "fail", part.part_no, (), value, limit, message))

    solids, shells = subshapes(shape, TopAbs_SOLID), subshapes(shape, TopAbs_SHELL)
    if len(solids) != 1 or len(shells) != 1:
        fail(
            "one-solid",
            len(solids),
            1,
            f"{len(solids)} solids with {len(shells)} shells instead of one of each",
        )
        return findings
    if not BRepCheck_Analyzer(shape).IsValid():
        fail("brep-valid", 0, 1, "the kernel calls the solid invalid")
    if not BRep_Tool.IsClosed_s(shells[0]):
        fail("shell-closed", 0, 1, "the solid's shell is open")
    findings += [*_tiny(part, shape, TopAbs_EDGE), *_tiny(part, shape, TopAbs_FACE)]
    if _meets_itself(shape):
        fail("self-intersection", 1, 0, "faces or edges of the solid pass through each other")
    volume = measure(shape)["volume"]
    if abs(volume - part.volume) > VOLUME_AGREES * part.volume:
        fail(
            "volume",
            volume,
            part.volume,
            f"the solid has {volume:.9g} mm3, its description {part.volume:.9g} mm3",
        )
    return findings


def check_step(part: Part, shape: TopoDS_Shape) -> list[Finding]:
    """The same findings on the part's STEP file, and where its solid is not the shape that was written."""
    try:
        return check_step_file(part, shape, write_step(shape))
    except ValueError as error:
        return [Finding("step-file", "fail", part.part_no, (), 0, 1, str(error))]


def check_step_file(part: Part, shape: TopoDS_Shape, data: bytes) -> list[Finding]:
    """Findings on a STEP file of the part's shape. Raises ValueError where it cannot be read."""
    read = read_step(data)
    findings = [replace(f, message=f"read back from STEP: {f.message}") for f in check_brep(part, read)]
    if any(f.check == "one-solid" for f in findings):
        return findings
    back, meant = measure(read), measure(shape)
    for name, unit in (("volume", "mm3"), ("area", "mm2")):
        if abs(back[name] - meant[name]) > STEP_AGREES * meant[name]:
            message = f"{name} of {back[name]:.9g} {unit} read back from STEP, {meant[name]:.9g} written"
            findings.append(
                Finding(f"step-{name}", "fail", part.part_no, (), back[name], meant[name], message)
            )
    for end, corner, wanted in zip(("least", "largest"), back["box"], meant["box"]):
        if (off := dist(corner, wanted)) > STEP_AGREES_MM:
            message = f"{end} corner {off:.3g} mm off its place, read back from STEP"
            findings.append(
                Finding("step-box", "fail", part.part_no, tuple(corner), off, STEP_AGREES_MM, message)
            )
    return findings


def _tiny(part: Part, shape: TopoDS_Shape, kind: TopAbs_ShapeEnum) -> Iterator[Finding]:
    edges = kind == TopAbs_EDGE
    name, unit, limit = ("edge", "mm", LEAST_EDGE) if edges else ("face", "mm2", LEAST_FACE)
    for sub in subshapes(shape, kind):
        size, place = _size(sub, kind)
        if is_sliver(size) if edges else size < limit:
            message = f"{name} of only {size:.3g} {unit}, under {limit:g}"
            yield Finding(f"tiny-{name}", "fail", part.part_no, place, size, limit, message)


def _size(sub: TopoDS_Shape, kind: TopAbs_ShapeEnum) -> tuple[float, tuple[float, float, float]]:
    """Length (mm) of an edge or area (mm2) of a face, and its centre; the edge at a cone's tip has no
    length.
    """
    sums = GProp_GProps()
    if kind == TopAbs_FACE:
        BRepGProp.SurfaceProperties_s(sub, sums)
    elif BRep_Tool.Degenerated_s(as_edge(sub)):
        return inf, (0.0, 0.0, 0.0)
    else:
        BRepGProp.LinearProperties_s(sub, sums)
    centre = sums.CentreOfMass()
    return sums.Mass(), (centre.X(), centre.Y(), centre.Z())


def _meets_itself(shape: TopoDS_Shape) -> bool:
    analyzer = BOPAlgo_ArgumentAnalyzer()
    analyzer.SetShape1(shape)
    analyzer.ArgumentTypeMode = False
    analyzer.SelfInterMode = True
    analyzer.SmallEdgeMode = False
    analyzer.Perform()
    return analyzer.HasFaulty()
