"""Whether the part's mesh is a closed surface of the solid's size, as printers and simulators require."""

from __future__ import annotations

import numpy as np
import trimesh
from OCP.TopoDS import TopoDS_Shape

from tactcad.account import making
from tactcad.parts.description import Part
from tactcad.parts.finding import Finding
from tactcad.solids.measure import measure
from tactcad.solids.meshing import CHORD_MM, USUAL, Meshing
from tactcad.solids.triangles import triangles


def check_mesh(part: Part, shape: TopoDS_Shape, meshing: Meshing = USUAL) -> list[Finding]:
    """Findings on the mesh of the part's shape: every edge used twice, windings alike, volume and area in
    bounds, the volume within what is promised where anything is."""
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
