"""A rig: a scene with everything that depends on it, declared once, next to the function that makes it.

A family of sensors names the folder or module of its rigs (facing rows: scenes/rigs). Every module there
declares one, its `RIG`, or several, `RIGS`; nothing lists them. A module without, a declaration that lacks
something, or two of one name are refused when they are imported. Its poses are those that are checked, and
what an option asks for.
"""

from __future__ import annotations

import pkgutil
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any

from tactcad.design.family import all_families
from tactcad.design.tree import CommonTables
from tactcad.parts.array.stiffness_table import Lines
from tactcad.parts.rules.rule import Rule

if TYPE_CHECKING:
    from tactcad.parts.language.finding import Finding

    from .requirement import DimensionLimits, Requirement
    from .scene import Pose, Scene
from collections.abc import Sequence

from tactcad.design.family import family_of
from tactcad.design.messages import InputError, one_of
from tactcad.design.text_values import as_number, as_whole

from .scene import Pose

ARRAY = "array"  # the rig that every design has: the sensor itself


@dataclass(frozen=True)
class Rig:
    """A scene's declaration: tables, parts, rules and requirements.

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
    make: Callable[[Any, Pose], Scene]
    poses: Callable[[Any], Iterable[Pose]]
    under_sensor: Callable[[Any], Iterable[Pose]]
    rules: tuple[Rule, ...]
    deflections: Lines
    requirements: Callable[[Any, dict[str, DimensionLimits]], list[Requirement]]
    checks: tuple[tuple[str, Callable[[Any, Scene], list[Finding]]], ...]

    def __post_init__(self) -> None:
        if wrong := [r.name for r in self.rules if not (isinstance(r, Rule) and r.fit)]:
            raise TypeError(f"rig {self.name}: {', '.join(wrong)} must be marked @fits")


def none(*_: Any) -> tuple[()]:
    """For a rig without poses or deflections of its own."""
    return ()


def plain_rig(
    name: str,
    make: Callable[[Any, Pose], Scene],
    rules: tuple[Rule, ...] = (),
    requirements: Callable[[Any, dict[str, DimensionLimits]], list[Requirement]] = lambda *_: [],
) -> Rig:
    """A rig that needs no table, has one pose, and neither a part that deflects nor checks of its own."""
    return Rig(name, (), make, none, none, rules, lambda _design: iter(()), requirements, ())


def all_rigs(spec: type[CommonTables]) -> dict[str, Rig]:
    """Every rig of the family whose designs are of that class, by name: the array, then in the order of their
    tables in a design."""
    return _rigs(next(f.name for f in all_families().values() if f.spec is spec))


@cache
def _rigs(name: str) -> dict[str, Rig]:
    family = all_families()[name]
    folder = import_module(family.scenes)
    inside = pkgutil.iter_modules(getattr(folder, "__path__", ()))
    modules = [import_module(f"{folder.__name__}.{name}") for _, name, _ in inside] or [folder]
    found: list[Rig] = []
    for module in modules:
        declared: tuple[Any, ...] = getattr(module, "RIGS", (getattr(module, "RIG", None),))
        if not all(isinstance(rig, Rig) for rig in declared):
            raise TypeError(f"no RIG is declared in {module.__name__}")
        found += declared
    sections = [*family.tables]
    for rig in found:
        if wrong := [table for table in rig.tables if table not in sections]:
            raise TypeError(f"rig {rig.name}: a design has no table {', '.join(wrong)}")
    found.sort(key=lambda rig: max(map(sections.index, rig.tables), default=-1))
    by_name = {rig.name: rig for rig in found}
    if len(by_name) < len(found):
        raise TypeError(f"two rigs have one name, of {', '.join(rig.name for rig in found)}")
    if ARRAY not in by_name:
        raise TypeError(f"family {family.name}: none of its rigs is called {ARRAY}")
    return by_name


def rig_of(design: CommonTables, scene: str) -> Rig:
    """The rig that declares a scene of this design."""
    return all_rigs(type(design))[scene]


def require_element(pose: Pose, count: int) -> None:
    """Raise InputError if an array of so many elements has none of the pose's number."""
    if not 1 <= pose.element <= count:
        what = "the array has none of that number"
        raise InputError("element", what, value=pose.element, legal=f"1 to {count}")


LEAST = 1e-3  # mm; less is more likely a typing error, and the CAD kernel drops edges that short


def poses(design: CommonTables, name: str) -> tuple[Pose, ...]:
    """Every pose of a scene that is checked, apart from its rest pose."""
    return tuple(rig_of(design, name).poses(design))


def pose_of(given: Sequence[str], design: CommonTables) -> Pose | None:
    """The pose that KEY=VALUE texts describe; None if there are none. Raises InputError if they
    describe none.
    """
    grasping, cart = (getattr(design, table, None) for table in ("grasping", "cart"))
    limits = {
        "element": (1, len(family_of(design).layout(design).elements)),
        "deflection": (0.0, 5.0),
        "weights": (0, grasping.weights if grasping else 0),
        "height": (0.0, max(grasping.lift if grasping else 0.0, 5.0)),
        "cart": (-cart.roll, cart.roll) if cart else (0.0, 0.0),
    }
    values: dict[str, Any] = {}
    for text in given:
        key, _, value = text.partition("=")
        if key not in limits:
            raise InputError("--pose", "unknown key", value=text, legal=one_of(key, limits))
        low, high = limits[key]
        legal = f"{key} from {low:g} to {high:g}"
        try:
            number = as_whole(value) if isinstance(low, int) else as_number(value)
        except ValueError:
            raise InputError("--pose", "not a number", value=text, legal=legal) from None
        if not low <= number <= high:
            raise InputError("--pose", "out of range", value=text, legal=legal)
        if 0 < abs(number) < LEAST:
            raise InputError("--pose", "below a micrometre", value=text, legal=f"0, or {LEAST:g} mm and more")
        values[key] = number
    return Pose(**values) if values else None
