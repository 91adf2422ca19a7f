"""The field and value that stiffen a part that deflects too much; the rule that refuses it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import ceil, floor, log10
from operator import attrgetter
from typing import TypeVar

from tactcad.design.tree import CommonTables

from ..array.layout import Layout
from ..array.stiffness_table import Deflection, Lines
from ..language.finding import Finding
from .rule import wrong

STEPS = 40  # halvings of a field's range
V = TypeVar("V", int, float)


def too_much(layout: Layout, lines: Lines) -> Iterator[Finding]:
    """Lines of a rig's stiffness table that its rule refuses; flagged lines do not count."""
    for line in lines(layout.design):
        if line.too_much and line.severity == "fail":
            path, value, legal = remedy(layout.design, line, lines)
            yield wrong(path, str(line), value, legal)


def remedy(design: CommonTables, line: Deflection, lines: Lines) -> tuple[str, object, str]:
    """The first field that alone brings a deflection, one of `lines`, below its allowance.

    Returns
    -------
    tuple
        The field's path, its value now, and in words the values that suffice.
    """
    for path in line.fields:
        section, name = path.split(".")
        value, spec = (
            attrgetter(path)(design),
            getattr(design, section).__dataclass_fields__[name].metadata["spec"],
        )
        for end, words in ((spec.high, "at least"), (spec.low, "at most")):
            if _helps(design, line, lines, path, end):
                return (
                    path,
                    value,
                    f"{words} {_nearest(design, line, lines, path, value, end):.10g} {spec.unit}".rstrip(),
                )
    path = line.fields[0]
    return (path, attrgetter(path)(design), f"no value alone; change {', '.join(line.fields)} together")


def _nearest(design: CommonTables, line: Deflection, lines: Lines, path: str, far: V, near: V) -> V:
    """The value nearest to `far` (which does not suffice) that still suffices, as `near` does; whole, or of
    four digits.
    """
    good, bad = near, far
    for _ in range(STEPS):
        middle = (good + bad) // 2 if isinstance(far, int) else (good + bad) / 2
        if middle in (good, bad):
            break
        good, bad = (middle, bad) if _helps(design, line, lines, path, middle) else (good, middle)
    if isinstance(far, int) or good == 0.0:
        return good
    digit = 10.0 ** (floor(log10(abs(good))) - 3)
    away = ceil(good / digit) * digit if near > far else floor(good / digit) * digit
    return min(away, near) if near > far else max(away, near)


def _helps(design: CommonTables, line: Deflection, lines: Lines, path: str, value: float) -> bool:
    section, name = path.split(".")
    changed = replace(design, **{section: replace(getattr(design, section), **{name: value})})
    same = (d for d in lines(changed) if (d.part, d.model) == (line.part, line.model))
    return not next(same).too_much
