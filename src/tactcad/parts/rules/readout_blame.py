"""Which field of [readout] is to blame for a broken rule: one that the design sets otherwise than it comes,
with the value nearest to that one which all rules on the read-out take. Both are found by trying the rules: a
rule compares several fields and names one of them, and does not know what other rules leave of it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from itertools import combinations
from math import ceil, floor, log10
from typing import Any

from tactcad.design.sensing import Readout
from tactcad.design.tree import Design

from ..language.finding import SAME, Finding

# Fields of which all values between a legal one and their default are legal; of others, such as a gain that
# an amplifier has or not, the rules list what is legal. Where several would do, the first is blamed.
TRIED = (
    "excitation",
    "supply_negative",
    "supply_positive",
    "headroom",
    "adc_range",
    "samples",
    "sample_rate",
    "on_time",
    "period",
)
# So many of them are put back together at most; chosen: 129 trials of about 1 ms if all nine are set.
TOGETHER = 3
# Of the way from a legal value to the one set; chosen: to three digits also from 1e6 samples to 10.
HALVINGS = 40


def blamed(design: Design, finding: Finding, broken: Callable[[Design], list[Finding]]) -> Finding:
    """The finding on the field to blame; as it is where that is none of TRIED.

    Parameters
    ----------
    design
        It keeps every rule that comes before those on the read-out.
    finding
        Of the first rule on the read-out that it breaks.
    broken
        What a design breaks of the rules on the read-out.
    """
    r, came, named = design.readout, Readout(), finding.part.removeprefix("readout.")
    changed = {f.name: f for f in fields(r) if getattr(r, f.name) != getattr(came, f.name)}
    if named in changed and named not in TRIED:
        return finding

    def breaks(values: dict[str, Any]) -> set[str]:
        return {f.check for f in broken(replace(design, readout=replace(r, **values)))}

    others_broken = breaks({}) - {finding.check}
    tried = sorted((name for name in TRIED if name in changed), key=lambda name: name != named)
    together = [names for count in range(1, TOGETHER + 1) for names in combinations(tried, count)]
    for name, *others in together:
        back = {other: getattr(came, other) for other in others}
        legal, value = getattr(came, name), getattr(r, name)
        left = breaks({**back, name: legal})
        if left <= others_broken:
            bound = _nearest(value, legal, lambda v: breaks({**back, name: v}) <= left)
            unit = changed[name].metadata["spec"].unit
            limit = _inward(bound, isinstance(value, int), value > legal) + (unit and f" {unit}")
            also = "".join(f" with readout.{other} = {v:g}" for other, v in back.items())
            return replace(finding, part=f"readout.{name}", value=value, limit=limit + also)
    return finding


def _nearest(value: float, legal: float, accepted: Callable[[float], bool]) -> float:
    """The accepted one nearest to a value that is not, from a legal one on."""
    for _ in range(HALVINGS):
        middle = (legal + value) / 2
        legal, value = (middle, value) if accepted(middle) else (legal, middle)
    return legal


def _inward(bound: float, whole: bool, upper: bool) -> str:
    """A bound (not 0) in words, to three digits that lie on its legal side."""
    step = 10.0 ** max(floor(log10(abs(bound))) - 2, 0 if whole else -9)
    steps = floor(bound / step + SAME) if upper else ceil(bound / step - SAME)
    return f"at {'most' if upper else 'least'} {steps * step:g}"
