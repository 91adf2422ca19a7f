"""A check: declared once, in its module, and run by its kind of subject.

Every module in `described`, which loads no CAD kernel, in `on_solids`, and in the folder that a family of
sensors names, declares its `CHECKS`; nothing lists them. A module without, a declaration that lacks
something, or two of one name are refused when they are imported.
"""

from __future__ import annotations

import pkgutil
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal, get_args

from tactcad.design.family import family_of
from tactcad.design.tree import CommonTables
from tactcad.parts.array.stiffness_table import Deflection
from tactcad.parts.language.description import Part
from tactcad.parts.language.finding import Finding
from tactcad.scenes import make_scene, scene_names
from tactcad.scenes.rig import rig_of
from tactcad.scenes.scene import Scene
from tactcad.solids import USUAL, Meshing

from .check_report import Report
from .shop import Shop, load_shop

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

Subject = Literal["design", "part", "scene", "pose"]
RIGS = 40  # the place of the checks that rigs declare


@dataclass
class Job:
    """What checks work on, and what they hand on to each other.

    design       keeps its rules
    names        of the scenes that are checked
    scenes       these scenes, if they are made
    shop         limits of the workshop
    meshing      of the parts
    deflections  lines of the stiffness table, filled in by the check of them
    shapes       by part number, in the part's own frame; without those that cannot be built
    envelopes    the same of parts without what is cut into them
    meetings     of pairs of parts, known from other scenes
    """

    design: CommonTables
    names: Sequence[str]
    scenes: Sequence[Scene] = ()
    shop: Shop = field(default_factory=load_shop)
    meshing: Meshing = USUAL
    deflections: list[Deflection] = field(default_factory=list)
    shapes: dict[str, TopoDS_Shape] = field(default_factory=dict)
    envelopes: dict[str, TopoDS_Shape] = field(default_factory=dict)
    meetings: dict[tuple, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Check:
    """A check's name, its kind of subject, and its function.

    name     as reports and times call it
    on       `design`, every `part`, every `scene` in its rest pose, or every further `pose` of a scene
    run      findings on the design, part or scene
    place    among the checks on the same: from low to high, those of one place by name
    quick    takes milliseconds and no virtual builds: a search for designs asks for every candidate
    applies  which parts or scenes it is for
    """

    name: str
    on: Subject
    run: Callable[[Any, Job], Iterable[Finding]]
    place: int = 100
    quick: bool = False
    applies: Callable[[Any], bool] = lambda _: True

    def __post_init__(self) -> None:
        if self.on not in get_args(Subject):
            known = ", ".join(get_args(Subject))
            raise TypeError(f"check {self.name}: `on` is {self.on}, not one of {known}")
        if not (callable(self.run) and callable(self.applies)):
            raise TypeError(f"check {self.name}: `run` and `applies` must be functions")


@cache
def declared(folder: str) -> tuple[Check, ...]:
    """The checks of a folder of this room, or of a family's folder or module by its whole name, in the order
    in which they run; `on_solids` loads the kernel."""
    package = import_module(folder if "." in folder else f"{__package__}.{folder}")
    inside = pkgutil.iter_modules(getattr(package, "__path__", ()))
    found: list[Check] = []
    for module in [import_module(f"{package.__name__}.{name}") for _, name, _ in inside] or [package]:
        checks = getattr(module, "CHECKS", ())
        if not checks or not all(isinstance(c, Check) for c in checks):
            raise TypeError(f"no CHECKS are declared in {module.__name__}")
        found += checks
    return ordered(found)


def ordered(checks: Iterable[Check]) -> tuple[Check, ...]:
    """Ordered by place, then name. Raises TypeError if two have one name."""
    found = sorted(checks, key=lambda c: (c.place, c.name))
    names = [c.name for c in found]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise TypeError(f"two checks have one name: {', '.join(twice)}")
    return tuple(found)


def described(design: CommonTables) -> tuple[Check, ...]:
    """The checks that need no solids: of all designs, and of the design's family."""
    return ordered((*declared("described"), *declared(family_of(design).checks)))


def of_rigs(design: CommonTables, scenes: Sequence[Scene]) -> list[Check]:
    """The checks that the rigs of these scenes declare."""

    def declared_on(scene: Scene, name: str, find: Callable[[CommonTables, Scene], list[Finding]]) -> Check:
        return Check(name, "design", lambda design, _: find(design, scene), RIGS)

    return [declared_on(scene, *each) for scene in scenes for each in rig_of(design, scene.name).checks]


def run_each(
    report: Report, checks: Iterable[Check], on: Subject, subject: CommonTables | Part | Scene, job: Job
) -> None:
    """Run the checks of this kind of subject on it."""
    for check in checks:
        if check.on == on and check.applies(subject):
            report.run(check.name, check.run, subject, job)


def quick_failures(design: CommonTables) -> list[Finding]:
    """Failures of the design as a whole that take milliseconds to find. It must keep its rules."""
    report = Report(design.name)
    quick = [c for c in described(design) if c.quick]
    run_each(report, quick, "design", design, Job(design, scene_names(design)))
    return report.failures


def slow_failures(design: CommonTables) -> list[Finding]:
    """Failures that take a second to find: of arrays made virtually, of every part's description, of rigs."""
    names = scene_names(design)
    scenes = [make_scene(design, name) for name in names]
    report, job = Report(design.name), Job(design, names, scenes)
    slow = [c for c in (*described(design), *of_rigs(design, scenes)) if not c.quick]
    run_each(report, slow, "design", design, job)
    for part in {part.part_no: part for scene in scenes for part in scene.parts}.values():
        run_each(report, slow, "part", part, job)
    return report.failures
