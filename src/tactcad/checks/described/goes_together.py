"""Whether parts within their limits go together: enough of a thousand arrays meet every requirement."""

from __future__ import annotations

from collections.abc import Sequence

from tactcad.design.tree import CommonTables
from tactcad.parts.language.finding import Finding
from tactcad.scenes.scene import Scene
from tactcad.stacks.stack import SEED
from tactcad.stacks.virtual_build import LEAST_YIELD, sensor

from ..check import Check

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


CHECKS = (Check("assembly", "design", lambda design, job: check_assembly(design, job.scenes), place=70),)
