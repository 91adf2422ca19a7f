"""A rig: a scene with all that hangs on it, declared once, beside the function that makes it.

Every module in scenes/rigs declares one, its `RIG`; nothing lists them. A module without, a declaration that
lacks something, or two of one name are refused when they are imported.
"""

from __future__ import annotations

import pkgutil
from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any

from tactcad.design.tree import Design
from tactcad.parts.layout import Layout
from tactcad.parts.rules.rule import Rule
from tactcad.parts.stiffness_table import Lines

if TYPE_CHECKING:
    from tactcad.parts.finding import Finding

    from .requirement import DimensionLimits, Requirement
    from .scene import Pose, Scene

ARRAY = "array"  # the rig that every design has: the sensor itself


@dataclass(frozen=True)
class Rig:
    """What a scene consists of, and what must hold for it.

    name          of the scene
    tables        of the design that it needs
    make          the placements, with the steps that put them there; raises InputError for an impossible pose
    poses         that are checked besides the rest pose
    under_sensor  poses with each element under the force sensor, by number; none without such a sensor
    rules         that the array keeps for the rig to take it
    deflections   its lines of the stiffness table: parts that are taken as rigid
    requirements  on its parts within their limits; adds the variables that they depend on to those known
    checks        name and function: findings on a design and the scene in its rest pose
    """

    name: str
    tables: tuple[str, ...]
    make: Callable[[Design, Pose], Scene]
    poses: Callable[[Design], Iterable[Pose]]
    under_sensor: Callable[[Design], Iterable[Pose]]
    rules: tuple[Rule, ...]
    deflections: Lines
    requirements: Callable[[Layout, dict[str, DimensionLimits]], list[Requirement]]
    checks: tuple[tuple[str, Callable[[Design, Scene], list[Finding]]], ...]

    def __post_init__(self) -> None:
        sections = [f.name for f in fields(Design)]
        if wrong := [table for table in self.tables if table not in sections]:
            raise TypeError(f"rig {self.name}: a design has no table {', '.join(wrong)}")
        if wrong := [r.name for r in self.rules if not (isinstance(r, Rule) and r.fit)]:
            raise TypeError(f"rig {self.name}: {', '.join(wrong)} must be marked @fits")


def none(*_: Any) -> tuple[()]:
    """For a rig without poses or deflections of its own."""
    return ()


@cache
def all_rigs() -> dict[str, Rig]:
    """Every rig by name: the array, then in the order in which their tables stand in a design."""
    from . import rigs as folder

    modules = [
        import_module(f"{folder.__name__}.{name}") for _, name, _ in pkgutil.iter_modules(folder.__path__)
    ]
    if without := [m.__name__ for m in modules if not isinstance(getattr(m, "RIG", None), Rig)]:
        raise TypeError(f"no RIG is declared in {', '.join(without)}")
    found = [m.RIG for m in modules]
    sections = [f.name for f in fields(Design)]
    found.sort(key=lambda rig: max(map(sections.index, rig.tables), default=-1))
    by_name = {rig.name: rig for rig in found}
    if len(by_name) < len(found):
        raise TypeError(f"two rigs have one name, of {', '.join(rig.name for rig in found)}")
    return by_name
