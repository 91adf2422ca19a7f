"""Shear calibration: a bar between the rows pushes the pads of row one along their arms."""

from __future__ import annotations

from math import inf

from tactcad.parts.rigs.shear_bar import bar_enters_the_gap, shear_bar, shear_lines

from tactcad.design.tree import Design
from tactcad.parts.array.layout import Layout
from tactcad.parts.language.finding import Finding

from ..builder import Builder
from ..requirement import DimensionLimits, Requirement, summed, variable
from ..rig import Rig, none
from ..scene import DOWN, Motion, Pose, Rotation, Scene
from .array import array

ALONG_X: Rotation = ((0, 0, 1), (1, 0, 0), (0, 1, 0))  # local z runs along x, local x along y


def shear_calibration(design: Design, pose: Pose) -> Scene:
    """Scene `shear-calibration`: the bar lifted by pose.height."""
    b = Builder()
    b.subassembly(array(design, stops=False), DOWN, (0, 0, 0))
    b.step("Array", (0, 0, 0), "Lay the array on its carrier, pads up.", bench=True)
    b.group("bar")
    pads = design.element.pad_height
    b.place("SB", shear_bar(design), (-design.shear.thickness / 2, 0, pads - 1.0 + pose.height), ALONG_X)
    b.group(None)
    b.step("Shear bar", (0, 0, 60), "Lower the bar between the rows.")
    up = (0.0, 0.0, 5.0)
    return b.scene("shear-calibration", (Motion("bar down", (("bar", up, (0.0, 0.0, 0.0)),)),), cover=["SB1"])


def _needs(layout: Layout, known: dict[str, DimensionLimits]) -> list[Requirement]:
    known["shear bar: thickness"] = variable("shear bar: thickness", -0.05, 0.05)
    air = 2 * layout.pad_inner - layout.design.shear.thickness
    return [summed("shear bar enters between the rows", 0.0, inf, air, (("shear bar: thickness", -1.0),))]


def _travel(design: Design, scene: Scene) -> list[Finding]:
    gap = Layout(design).pad_inner - design.shear.thickness / 2
    if design.shear.travel <= gap:
        return []
    return [Finding("shear-travel", "fail", scene.name, (), design.shear.travel, gap, "travel too long")]


RIG = Rig(
    name="shear-calibration",
    tables=("shear",),
    make=shear_calibration,
    poses=lambda design: (Pose(height=2.0),),
    under_sensor=none,
    rules=(bar_enters_the_gap,),
    deflections=shear_lines,
    requirements=_needs,
    checks=(("shear travel", _travel),),
)
