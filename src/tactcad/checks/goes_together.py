"""Whether parts within their limits go together: enough of a thousand arrays meet every requirement."""

from __future__ import annotations

from tactcad.assembly.stack import SEED
from tactcad.assembly.virtual_build import LEAST_YIELD, sensor
from tactcad.design.tree import Design
from tactcad.parts.finding import Finding

COUNT = 1000


def check_assembly(design: Design, *seeds: int) -> list[Finding]:
    """A finding for each seed of chance, by default the published one, whose arrays fail too often."""
    made, found = sensor(design), []
    for seed in seeds or (SEED,):
        builds = made.built(COUNT, seed)
        if builds.share < LEAST_YIELD:
            why = made.refusal(builds)
            found.append(Finding("assembly", "fail", design.name, (), builds.share, LEAST_YIELD, why))
    return found
