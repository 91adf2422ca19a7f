"""Whether parts within their limits go together: enough of a thousand arrays meet every requirement, and
every part of the array and its rigs that is taken as rigid keeps its allowed deflection.

Rigs' rules (`remedy` of parts/rules/rule.py) use the same lines and leave the scene out that fails here; so
flags remain.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from tactcad.design.tree import CommonTables
from tactcad.parts.array.stiffness_table import Deflection
from tactcad.parts.language.finding import Finding
from tactcad.parts.rules.rule import remedy
from tactcad.scenes.rig import all_rigs, rig_of
from tactcad.scenes.scene import Scene
from tactcad.stacks.stack import LEAST_YIELD, SEED
from tactcad.stacks.virtual_build import sensor

from ..check import Check


def deflections(design: CommonTables, scenes: Collection[str]) -> tuple[Deflection, ...]:
    """The stiffness table of a design: the lines of these scenes, all of which it must have."""
    return tuple(
        line
        for name, rig in all_rigs(type(design)).items()
        if name in scenes
        for line in rig.deflections(design)
    )


def check_rigidity(design: CommonTables, scenes: Collection[str], table: list[Deflection]) -> list[Finding]:
    """Findings on the lines that give way by more than is allowed; all lines into `table`."""
    table += deflections(design, scenes)
    return [
        Finding("deflection", line.severity, line.part, (), line.gives, line.allowed, _message(design, line))
        for line in table
        if line.too_much
    ]


def _message(design: CommonTables, line: Deflection) -> str:
    path, value, legal = remedy(design, line, rig_of(design, line.scene).deflections)
    return f"{line} ({path} = {value:g}; legal: {legal})"


COUNT = 1000


def check_assembly(
    design: CommonTables, scenes: Sequence[Scene] | None = None, seed: int = SEED
) -> list[Finding]:
    """A finding where too many arrays fail, of the rigs those of `scenes` (by default all).

    `seed` of chance is the published one.
    """
    made = sensor(design, scenes)
    builds = made.built(COUNT, seed)
    if builds.share >= LEAST_YIELD:
        return []
    return [Finding("assembly", "fail", design.name, (), builds.share, LEAST_YIELD, made.refusal(builds))]


CHECKS = (
    Check(
        "rigidity",
        "design",
        lambda design, job: check_rigidity(design, job.names, job.deflections),
        place=30,
        quick=True,
    ),
    Check("assembly", "design", lambda design, job: check_assembly(design, job.scenes), place=70),
)
