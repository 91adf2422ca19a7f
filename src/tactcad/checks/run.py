"""All checks of a design: every part of its scenes, then how the parts stand to each other."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from OCP.TopoDS import TopoDS_Shape

from tactcad.design.tree import Design
from tactcad.scenes import make_scene
from tactcad.scenes.poses import poses
from tactcad.solids.build import SolidError, build, envelope

from .brep import check_brep
from .finding import Finding
from .interference import check_interference
from .machining import MACHINED, check_machining
from .mesh import check_mesh
from .motion import check_motions
from .shop import DEFAULT, load_shop
from .wirecut import check_wirecut


@dataclass
class Report:
    """Findings in the order found, how many times each check ran, and how long it took in all (s)."""

    findings: list[Finding] = field(default_factory=list)
    runs: dict[str, int] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)

    @property
    def failures(self) -> list[Finding]:
        return [f for f in self.findings if f.severity == "fail"]

    def run(self, name: str, check: Callable[..., list[Finding]], *args: object) -> None:
        """Run one check and keep what it says."""
        start = time.perf_counter()
        self.findings += check(*args)
        self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start
        self.runs[name] = self.runs.get(name, 0) + 1


def run_checks(
    design: Design, scene_names: Sequence[str], shop_file: Path = DEFAULT,
    say: Callable[[int, int, str], None] = lambda done, total, text: None,
) -> Report:
    """Every check on every part and scene of a design that keeps its rules; `say` hears how far it is.

    A part that cannot be built is a finding, and its scenes are then not checked for interference.
    Raises InputError where the shop file cannot be used.
    """
    shop = load_shop(shop_file)
    report = Report()
    scenes = [make_scene(design, name) for name in scene_names]
    parts = list({part.part_no: part for scene in scenes for part in scene.parts}.values())
    total = len(parts) + len(scenes)
    shapes: dict[str, TopoDS_Shape] = {}
    for n, part in enumerate(parts):
        say(n, total, part.part_no)
        try:
            shapes[part.part_no] = build(part).wrapped
        except SolidError as error:
            report.findings.append(Finding("build", "fail", part.part_no, (), 0, 0, str(error)))
            continue
        report.run("brep", check_brep, part, shapes[part.part_no])
        report.run("mesh", check_mesh, part, shapes[part.part_no])
        if part.process == "wire-cut":
            report.run("wire-cut", check_wirecut, part, shop)
        if part.process in MACHINED:
            report.run("machining", check_machining, part)
    known: dict = {}
    for n, scene in enumerate(scenes, start=len(parts)):
        say(n, total, f"{scene.name}: interference of {len(scene.placements)} placed parts")
        if not all(part.part_no in shapes for part in scene.parts):
            continue
        report.run("interference", check_interference, scene, shapes, known)
        if scene.motions:
            envelopes = {part.part_no: envelope(part).wrapped for part in scene.parts}
            report.run("motion", check_motions, scene, shapes, envelopes)
        for pose in poses(design, scene.name):
            posed = make_scene(design, scene.name, pose)
            for part in posed.parts:
                if part.part_no not in shapes:
                    shapes[part.part_no] = build(part).wrapped
            report.run("configurations", check_interference, posed, shapes, known)
    say(total, total, "done")
    return report
