"""Whether the kernel's solid is sound: valid, one solid, one closed shell, the description's volume, no
slivers, no surface through another one; whether it still is when written as STEP and read back; and whether
its mesh is a closed surface of its size, as printers and simulators require.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import dist, inf

import numpy as np
import trimesh
from OCP.BOPAlgo import BOPAlgo_ArgumentAnalyzer
from OCP.BRep import BRep_Tool
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_ShapeEnum, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopoDS import TopoDS_Shape

from tactcad.contour import LEAST_EDGE, is_sliver
from tactcad.parts.language.description import Part
from tactcad.parts.language.finding import Finding
from tactcad.profiling import making
from tactcad.solids import CHORD_MM, USUAL, Meshing
from tactcad.solids.measure import measure
from tactcad.solids.occt import as_edge, subshapes
from tactcad.solids.step import read_step, write_step
from tactcad.solids.triangles import triangles
from tactcad.solids.valid import is_clear_prism, is_valid

from ..check import Check

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
    clear = is_clear_prism(shape)
    if not is_valid(shape, clear):
        fail("brep-valid", 0, 1, "the kernel calls the solid invalid")
    if not BRep_Tool.IsClosed_s(shells[0]):
        fail("shell-closed", 0, 1, "the solid's shell is open")
    findings += [*_tiny(part, shape, TopAbs_EDGE), *_tiny(part, shape, TopAbs_FACE)]
    if not clear and meets_itself(shape):
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
    """The same findings on the part's STEP file, and one if its solid is not the shape that was written."""
    try:
        return check_step_file(part, shape, write_step(shape))
    except ValueError as error:
        return [Finding("step-file", "fail", part.part_no, (), 0, 1, str(error))]


def check_step_file(part: Part, shape: TopoDS_Shape, data: bytes) -> list[Finding]:
    """Findings on a STEP file of the part's shape. Raises ValueError if it cannot be read."""
    read = read_step(data, mended=False)
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


def meets_itself(shape: TopoDS_Shape) -> bool:
    """Whether faces or edges of a valid solid pass through each other."""
    analyzer = BOPAlgo_ArgumentAnalyzer()
    analyzer.SetShape1(shape)
    analyzer.ArgumentTypeMode = False
    analyzer.SelfInterMode = True
    analyzer.SmallEdgeMode = False
    analyzer.Perform()
    return analyzer.HasFaulty()


def check_mesh(part: Part, shape: TopoDS_Shape, meshing: Meshing = USUAL) -> list[Finding]:
    """Findings on the mesh of the part's shape: every edge used twice, windings alike, volume and area in
    bounds, the volume within its promised error, if any."""
    with making("mesh", part.part_no):
        vertices, faces = triangles(shape, CHORD_MM, meshing.angular)
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    findings = check_triangles(part.part_no, mesh)
    if findings:
        return findings
    exact = measure(shape)
    bound, why = chord_bound(exact["area"]), "tessellation explains"
    if meshing.error is not None:
        bound, why = meshing.error * exact["volume"], "allowed are"
    for check, value, meant, limit, by in (
        ("mesh-volume", mesh.volume, exact["volume"], bound, why),
        ("mesh-area", mesh.area, exact["area"], area_share(meshing) * exact["area"], "tessellation explains"),
    ):
        if abs(value - meant) > limit:
            message = f"mesh has {value:.6g}, the solid {meant:.6g}; {by} {limit:.3g}"
            findings.append(Finding(check, "fail", part.part_no, (), value, meant, message))
    return findings


def area_share(meshing: Meshing) -> float:
    """A chord of a turn w is shorter than its arc by w^2/24: 0.17 % at 0.2 rad; twice that where both
    directions curve."""
    return 2 * meshing.angular**2 / 24


def chord_bound(area: float) -> float:
    """Most that facets can take off or add: every face moved by the chord error (mm3)."""
    return area * CHORD_MM


def check_triangles(part_no: str, mesh: trimesh.Trimesh) -> list[Finding]:
    """Every edge is used by exactly two triangles, in opposite directions; nothing is inside out."""
    findings = []
    uses = np.unique(mesh.edges_sorted, axis=0, return_counts=True)
    bad = uses[0][uses[1] != 2]
    if len(bad):
        where = tuple(float(v) for v in mesh.vertices[bad[0]].mean(axis=0))
        message = f"{len(bad)} edges are not shared by exactly two triangles"
        findings.append(Finding("mesh-watertight", "fail", part_no, where, len(bad), 0, message))
    elif not mesh.is_winding_consistent:
        findings.append(
            Finding("mesh-winding", "fail", part_no, (), 0, 1, "neighbouring triangles face opposite ways")
        )
    elif mesh.volume <= 0:
        findings.append(
            Finding("mesh-winding", "fail", part_no, (), mesh.volume, 0, "the mesh is inside out")
        )
    return findings


CHECKS = (
    Check("brep", "part", lambda part, job: check_brep(part, job.shapes[part.part_no]), place=10),
    Check("step", "part", lambda part, job: check_step(part, job.shapes[part.part_no]), place=20),
    Check(
        "mesh", "part", lambda part, job: check_mesh(part, job.shapes[part.part_no], job.meshing), place=30
    ),
)
