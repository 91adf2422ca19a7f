"""Checks that need no solid: `run` begins with them, and a search for designs is limited by them."""

from __future__ import annotations

from collections.abc import Sequence

from tactcad.design.tree import Design
from tactcad.parts.description import Part
from tactcad.parts.finding import Finding
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.scene import Scene

from .check_report import Report
from .clearance import check_clearance
from .goes_together import check_assembly
from .hinge_strength import check_strength
from .machining import MACHINED, check_machining
from .rigidity import check_rigidity, check_rigs
from .shop import Shop, load_shop
from .signals import check_signals
from .wirecut import check_wirecut
from .wired import check_circuit


def run_on_design(
    report: Report, design: Design, scene_names: Sequence[str], scenes: Sequence[Scene] = ()
) -> None:
    """What is checked on the design as a whole, in milliseconds; and what the rigs of `scenes` declare."""
    report.run("strength", check_strength, design)
    report.run("clearance", check_clearance, design)
    report.run("rigidity", check_rigidity, design, scene_names, report.deflections)
    check_rigs(report, design, scenes)
    report.run("circuit", check_circuit, design)
    report.run("signals", check_signals, design)


def run_on_part(report: Report, part: Part, shop: Shop) -> None:
    """Whether the shop can make the part."""
    if part.process == "wire-cut":
        report.run("wire-cut", check_wirecut, part, shop)
    if part.process in MACHINED:
        report.run("machining", check_machining, part, shop.machining)


def quick_failures(design: Design) -> list[Finding]:
    """Failures of the design as a whole. It must keep its rules."""
    report = Report(design.name)
    run_on_design(report, design, scene_names(design))
    return report.failures


def slow_failures(design: Design) -> list[Finding]:
    """Failures that take a second to find: of arrays made virtually, and of every part's description."""
    report, shop = Report(design.name), load_shop()
    scenes = [make_scene(design, name) for name in scene_names(design)]
    report.run("assembly", check_assembly, design, scenes)
    for part in {part.part_no: part for scene in scenes for part in scene.parts}.values():
        run_on_part(report, part, shop)
    check_rigs(report, design, scenes)
    return report.failures
