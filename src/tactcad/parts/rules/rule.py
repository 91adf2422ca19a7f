"""A rule between fields, helpers that word its findings, and the field and value that stiffen a part that
deflects too much.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from math import ceil, floor, log10
from operator import attrgetter
from typing import Any, TypeVar

from tactcad.design.fields import spec_of, with_value
from tactcad.design.tree import CommonTables

from ..array.layout import Layout
from ..array.stiffness_table import Deflection, Lines
from ..bought.electronic_parts import unread
from ..language.finding import SAME, Finding

Find = Callable[[Any], Iterable[Finding]]  # of a family's layout


@dataclass(frozen=True)
class Rule:
    """A function from a layout to findings, the most important first.

    after       name of an earlier rule: this one is tried only if that one and all before it are kept,
                because it would only repeat their findings, or could not be computed
    stands_on   kinds of electronic parts whose figures decide it: a finding names the unverified ones
    fit         a rig needs it to take the array: a design that breaks it only loses the rig's scene
    """

    find: Find
    after: str = ""
    stands_on: tuple[str, ...] = ()
    fit: bool = False

    @property
    def name(self) -> str:
        return self.find.__name__

    def __call__(self, layout: Layout) -> list[Finding]:
        """The first finding; empty if the rule is kept."""
        first = next(iter(self.find(layout)), None)
        if first is None:
            return []
        said = unread(layout.design, self.stands_on) if self.stands_on else ""
        return [replace(first, check=self.name, message=f"{first.message}{said}")]


def rule(after: str = "", stands_on: tuple[str, ...] = ()) -> Callable[[Find], Rule]:
    """Makes a function a rule that every design must keep; `after` and `stands_on` as in `Rule`."""
    return lambda find: Rule(find, after, stands_on)


def fits(find: Find) -> Rule:
    """Makes a function a rule that an array must keep for a rig to take it; the rig's declaration names it
    (scenes/rig.py)."""
    return Rule(find, fit=True)


def misfit(layout: Layout, rules: Iterable[Rule]) -> Finding | None:
    """The first finding of a rig's rules: the reason why it cannot take this array; None if it can."""
    return next((finding for rule in rules for finding in rule(layout)), None)


def wrong(path: str, what: str, value: object, legal: str) -> Finding:
    """A finding on a field; the rule's name is added by the caller.

    Parameters
    ----------
    path
        Of the field, such as "element.hinge_thickness".
    what
        Is wrong: one clause.
    value, legal
        The field's value, or the value derived from it, and the legal range in words.
    """
    found = round(value, 9) if isinstance(value, float) else value  # 3.6, not 3.5999999999999996
    return Finding("", "fail", path, (), found, legal, what)


def at_least(path: str, what: str, value: float, least: float, legal: str = "") -> Iterator[Finding]:
    """A finding where the value is below `least`; `legal` words the limit, by default in mm."""
    if value < least - SAME:
        yield wrong(path, what, value, legal or f"at least {least:g} mm")


def at_most(path: str, what: str, value: float, most: float, legal: str = "") -> Iterator[Finding]:
    """A finding where the value is above `most`; `legal` words the limit, by default in mm."""
    if value > most + SAME:
        yield wrong(path, what, value, legal or f"at most {most:g} mm")


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
        value, spec = (attrgetter(path)(design), spec_of(type(getattr(design, section)), name))
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
    changed = with_value(design, path, value)
    same = (d for d in lines(changed) if (d.part, d.model) == (line.part, line.model))
    return not next(same).too_much
