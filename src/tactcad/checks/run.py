"""All checks of a design: every part of its scenes, then how the parts stand to each other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from OCP.TopoDS import TopoDS_Shape

from tactcad.design.tree import Design
from tactcad.parts.description import Part
from tactcad.parts.envelope import envelope
from tactcad.parts.finding import Finding, Severity
from tactcad.scenes import left_out, make_scene
from tactcad.scenes.poses import poses
from tactcad.solids.build import SolidError, build
from tactcad.solids.meshing import USUAL, Meshing

from .brep import check_brep, check_step
from .check_report import Report
from .goes_together import check_assembly
from .interference import check_interference
from .mesh import check_mesh
from .motion import check_motions
from .shop import DEFAULT, load_shop
from .tools import check_tools
from .without_solids import run_on_design, run_on_part


def run_checks(
    design: Design,
    scene_names: Sequence[str],
    shop_file: Path = DEFAULT,
    say: Callable[[int, int, str], None] = lambda done, total, text: None,
    strict: bool = False,
    meshing: Meshing = USUAL,
) -> Report:
    """Every check on every part and scene of a design.

    A part that cannot be built is a finding, and its scenes are then not checked for interference.

    Parameters
    ----------
    design
        Must keep its rules.
    scene_names
        The scenes to check.
    shop_file
        Limits of the workshop.
    say
        Receives (done, total, text) before each part and scene.
    strict
        A rig that does not take the array fails; otherwise it is flagged.
    meshing
        Of the parts, for the mesh check.

    Raises
    ------
    InputError
        Where the shop file cannot be used.
    """
    shop = load_shop(shop_file)
    report = Report(design.name, design.design.revision)
    scenes = [make_scene(design, name) for name in scene_names]
    run_on_design(report, design, scene_names, scenes)
    report.run("assembly", check_assembly, design, scenes)
    parts = list({part.part_no: part for scene in scenes for part in scene.parts}.values())
    total = len(parts) + len(scenes)
    shapes: dict[str, TopoDS_Shape] = {}
    envelopes: dict[str, TopoDS_Shape] = {}
    for n, part in enumerate(parts):
        say(n, total, part.part_no)
        report.run("build", _built, part, shapes)
        if part.part_no not in shapes:
            continue
        report.run("brep", check_brep, part, shapes[part.part_no])
        report.run("step", check_step, part, shapes[part.part_no])
        report.run("mesh", check_mesh, part, shapes[part.part_no], meshing)
        run_on_part(report, part, shop)
    report.run("scenes left out", _left_out, design, "fail" if strict else "flag")
    known: dict = {}
    for n, scene in enumerate(scenes, start=len(parts)):
        say(n, total, f"{scene.name}: interference of {len(scene.placements)} placed parts")
        if not all(part.part_no in shapes for part in scene.parts):
            continue
        report.run("interference", check_interference, scene, shapes, known)
        report.run("tools", check_tools, scene, shapes)
        if scene.motions:
            _add_envelopes(scene.parts, shapes, envelopes)
            report.run("motion", check_motions, scene, shapes, envelopes)
        for pose in poses(design, scene.name):
            posed = make_scene(design, scene.name, pose)
            for part in posed.parts:
                if part.part_no not in shapes:
                    report.run("build", _built, part, shapes)
            if all(part.part_no in shapes for part in posed.parts):
                report.run("configurations", check_interference, posed, shapes, known)
    say(total, total, "done")
    return report


def _left_out(design: Design, severity: Severity = "flag") -> list[Finding]:
    """A rig that cannot take this array is flagged with the reason."""
    return [Finding("scene", severity, design.name, (), 0, 0, str(left)) for left in left_out(design)]


def _add_envelopes(
    parts: Sequence[Part], shapes: dict[str, TopoDS_Shape], envelopes: dict[str, TopoDS_Shape]
) -> None:
    """The parts' envelopes that are not known yet; a part that nothing is cut into is its own."""
    for part in parts:
        if part.part_no not in envelopes:
            outside = replace(envelope(part), part_no=f"{part.part_no}, envelope")
            own = outside.body == part.body and not part.features
            envelopes[part.part_no] = shapes[part.part_no] if own else build(outside).wrapped


def _built(part: Part, shapes: dict[str, TopoDS_Shape]) -> list[Finding]:
    """Build the part into `shapes`; a part that cannot be built is a finding."""
    try:
        shapes[part.part_no] = build(part).wrapped
    except SolidError as error:
        return [Finding("build", "fail", part.part_no, (), 0, 0, str(error))]
    return []
