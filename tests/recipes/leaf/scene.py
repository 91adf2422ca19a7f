"""The leaf on its block: places, what must hold for them, and the check of its strength."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf

from tactcad.checks.check import Check
from tactcad.parts.language.finding import Finding
from tactcad.scenes.builder import Builder
from tactcad.scenes.requirement import Deviations, summed, variable
from tactcad.scenes.rig import ARRAY, Rig, none
from tactcad.scenes.scene import Scene

from .parts import BLOCK, block, leaf, rows
from .tables import LeafDesign, LeafLayout


def scene(design: LeafDesign, _pose) -> Scene:
    b, layout = Builder(), LeafLayout(design)
    base = b.place("B", block(layout), (0, 0, 0))
    b.step("Block", (0, 0, 0), "Lay the block down.")
    b.meet(b.place("E", leaf(layout), (0, 0, BLOCK)), base)
    b.step("Leaf", (0, 0, 30), "Bond the leaf on the block, flush with its rear end.", elements=True)
    return b.scene(ARRAY)


@dataclass(frozen=True)
class Laid:
    """Leaves as made, on their blocks."""

    layout: LeafLayout
    made: Deviations


def figures(_arrays: Laid) -> dict:
    return {}  # nothing of a leaf as built but its thickness


def limits(layout: LeafLayout, _scenes):
    of = ((f"{layout.design.name}-leaf", "thickness"),)
    known = {"leaf: thickness": variable("leaf: thickness", -0.02, 0.02, stated=of)}
    thick = layout.design.sheet.thickness
    return known, [summed("leaf as thick as drawn", thick - 0.03, inf, thick, (("leaf: thickness", 1.0),))]


def check_strength(design: LeafDesign) -> Iterator[Finding]:
    (row,) = rows(LeafLayout(design), "", None)
    if row.yield_force < design.rating.force:
        message = "the leaf yields under its rated force"
        yield Finding("leaf-strength", "fail", "E1", (), design.rating.force, row.yield_force, message)


CHECKS = (Check("leaf strength", "design", lambda design, _: check_strength(design), place=10, quick=True),)
RIG = Rig(
    name=ARRAY,
    tables=(),
    make=scene,
    poses=none,
    under_sensor=none,
    rules=(),
    deflections=none,
    requirements=lambda *_: [],
    checks=(),
)
