"""All checks of a design: every part of its scenes, then the parts' relations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from tactcad.design.load import stale_origins
from tactcad.design.tree import CommonTables
from tactcad.parts.language.description import Part
from tactcad.parts.language.finding import Finding, Severity
from tactcad.scenes import left_out, make_scene, overall_size
from tactcad.scenes.rig import poses
from tactcad.solids import USUAL, Meshing
from tactcad.solids.build import SolidError, build

from .check import Job, declared, described, of_rigs, ordered, run_each
from .check_report import Report
from .shop import DEFAULT, load_shop


def run_checks(
    design: CommonTables,
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
        If the shop file cannot be used.
    """
    scenes = [make_scene(design, name) for name in scene_names]
    report = Report(design.name, design.design.revision, size=overall_size(design))
    job = Job(design, scene_names, scenes, load_shop(shop_file), meshing, report.deflections)
    checks = ordered((*described(design), *declared("on_solids")))
    of_design = sorted((*checks, *of_rigs(design, scenes)), key=lambda check: check.place)
    run_each(report, of_design, "design", design, job)
    parts = list({part.part_no: part for scene in scenes for part in scene.parts}.values())
    total = len(parts) + len(scenes)
    for n, part in enumerate(parts):
        say(n, total, part.part_no)
        report.run("build", _built, part, job)
        if part.part_no in job.shapes:
            run_each(report, checks, "part", part, job)
    report.run("origins", _stale, design)
    report.run("scenes left out", _left_out, design, "fail" if strict else "flag")
    for n, scene in enumerate(scenes, start=len(parts)):
        say(n, total, f"{scene.name}: interference of {len(scene.placements)} placed parts")
        if not all(part.part_no in job.shapes for part in scene.parts):
            continue
        run_each(report, checks, "scene", scene, job)
        for pose in poses(design, scene.name):
            posed = make_scene(design, scene.name, pose)
            for part in posed.parts:
                if part.part_no not in job.shapes:
                    report.run("build", _built, part, job)
            if all(part.part_no in job.shapes for part in posed.parts):
                run_each(report, checks, "pose", posed, job)
    say(total, total, "done")
    return report


def _left_out(design: CommonTables, severity: Severity = "flag") -> list[Finding]:
    """A rig that cannot take this array is flagged with the reason."""
    return [Finding("scene", severity, design.name, (), 0, 0, str(left)) for left in left_out(design)]


def _stale(design: CommonTables) -> list[Finding]:
    """Sources of values that were changed since."""
    return [Finding("origin", "flag", design.name, (), 0, 0, said) for said in stale_origins(design)]


def _built(part: Part, job: Job) -> list[Finding]:
    """Build the part into the job's shapes; a part that cannot be built is a finding."""
    try:
        job.shapes[part.part_no] = build(part)
    except SolidError as error:
        return [Finding("build", "fail", part.part_no, (), 0, 0, str(error))]
    return []
