"""A family of sensors, declared once: the class of its design files, and its functions.

Every module in `tactcad.families` declares one, its `FAMILY`; nothing lists them. The tables of a design's
file decide its family. A declaration names its functions as "module:function", which is imported when it is
called: reading a design loads neither models nor the CAD kernel.
"""

from __future__ import annotations

import dataclasses
import pkgutil
import typing
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import import_module
from typing import Any, TypeVar

from .messages import InputError
from .tree import NO_TABLES, CommonTables

Spec = TypeVar("Spec", bound=CommonTables)
FOLDER = "tactcad.families"  # above all rooms that it names; looked up, so that no lower room imports it


@dataclass(frozen=True)
class Late:
    """A function by "module:name", imported when it is called."""

    place: str

    @property
    def found(self) -> Callable[..., Any]:
        module, _, name = self.place.partition(":")
        return getattr(import_module(module), name)

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        return self.found(*arguments, **named)


@dataclass(frozen=True)
class FamilyEstimate:
    """Estimates of the numbered elements by closed forms or finite elements.

    rows      (layout, rung, force or None) to records by number: `number`, `stiffness` N/mm, `force`,
              `rated_force` N, `gauge_strain`, `peak_strain`; None for what is not known
    run       `tactcad estimate`: (arguments, design) to the exit status
    golden    (design) to what golden files keep, by designator; with `part_no`, `stiffness_n_per_mm` and
              `yield_force_n`
    strength  (layout) to the bytes of strength.csv, with columns `design` and `revision`
    strain    (layout, element) to the strain over its part's contour, in pictures; None: no such picture
    """

    rows: Late
    run: Late
    golden: Late
    strength: Late
    strain: Late | None


@dataclass(frozen=True)
class FamilyStack:
    """The family's tolerance stack.

    limits    (layout, scenes) to the variables by name, and the requirements
    built     (layout, deviations) to arrays that were put together from parts as made
    elements  (layout, figures) to the elements as built; with `figures`, (arrays) to figures by name
    figures   see there
    """

    limits: Late
    built: Late
    figures: Late
    elements: Late


@dataclass(frozen=True)
class FamilyReadout:
    """The electronics that read the elements.

    netlist  (layout) to the circuit
    tracks   (layout, circuit) to the circuit with the resistance of its boards' tracks
    wiring   (layout, circuit) to the bytes of the table of leads to cut
    sheets   (design, draft, sample) to the circuit's sheets as written
    signals  (design) to V/N of every element
    """

    netlist: Late
    tracks: Late
    wiring: Late
    sheets: Late
    signals: Late


@dataclass(frozen=True)
class FamilyBoards:
    """The boards that carry what reads the elements.

    made      (layout) to every different board, laid out; none: the family says why in a finding
    supplies  (layout) to the lines of the bill with what is fitted on them
    """

    made: Late
    supplies: Late


@dataclass(frozen=True)
class FamilyPads:
    """The pads' contact with an object.

    places   (design) to x, y, number, length and width of the pads, mm
    springs  (design) to those pads on their springs, `tactcad.contact.press.Pads`, and the signal of each
             element over its pad's sink, in its unit a mm
    limit    (design) to the pads' largest height above or below their plane, mm
    unit     of a signal, and of a thousandth of it
    """

    places: Late
    springs: Late
    limit: Late
    unit: tuple[str, str] = ("V", "mV")


@dataclass(frozen=True)
class FamilyReadings:
    """Evaluation of a lab's readings, in as many components as an element measures.

    calibrate  `tactcad calibrate`: (arguments, design) to the exit status
    stiffness  `tactcad stiffness`, likewise
    """

    calibrate: Late
    stiffness: Late


@dataclass(frozen=True)
class FamilyRobot:
    """The sensor as robots and their simulators take it.

    mechanism  (design) to the fixed and moving parts and joints, `tactcad.robot.mechanism.Mechanism`
    jobs       (plan of an export) to the jobs that make its files
    """

    mechanism: Late
    jobs: Late


@dataclass(frozen=True)
class FamilyTargets:
    """Target files of the family's own: those with a table of its name.

    design  `tactcad design`: (arguments, s and arrays or None, what to do next as text) to the exit status
    tables  () to the class of every table of a target file by name, all of which it must have
    """

    design: Late
    tables: Late


@dataclass(frozen=True)
class Family:
    """A kind of sensor.

    name       in messages
    spec       class of its design files: a field a table
    layout     (design) to its elements' places: `design` and `elements`, each with `number`,
               `designator`, `row` and `arm`, by which elements of two designs are found again
    about      (layout) to its description, a paragraph for the shop
    parts      (layout) to every numbered element, its part number and its measurements
    scenes     name of the folder or module that declares its rigs; one is `array`
    rules      rules that every design keeps, by name
    estimate   of its elements
    plans      by kind of part, (part, notes, spare) to its sheet; other parts are drawn as prisms. `array`:
               (layout, box) to the mounting dimensions, in the plan of its assembly
    stack      its tolerance stack
    pads       their contact with an object; None: unknown
    readout    its electronics; None: it has none
    boards     its circuit boards; None: no files of boards are made
    readings   functions for `calibrate` and `stiffness`; None: they refuse the design
    variables  the search of `tactcad design`, (target, arrays, seconds, tell); None: none,
               and sweeps measure no rung
    checks     name of the folder or module that declares its checks, besides those of all families
    robot      its motion, for robots' simulators; None: unknown
    targets    its own target files; None: there are none
    """

    name: str
    spec: type[CommonTables]
    layout: Late
    about: Late
    parts: Late
    scenes: str
    rules: Late
    estimate: FamilyEstimate
    plans: Mapping[str, Late]
    stack: FamilyStack
    pads: FamilyPads | None
    readout: FamilyReadout | None
    readings: FamilyReadings | None
    variables: Late | None
    checks: str
    robot: FamilyRobot | None = None
    targets: FamilyTargets | None = None
    boards: FamilyBoards | None = None

    def __post_init__(self) -> None:
        if not (isinstance(self.spec, type) and issubclass(self.spec, CommonTables)):
            raise TypeError(f"family {self.name}: spec must have the tables of all families (CommonTables)")

    @cached_property
    def tables(self) -> dict[str, type]:
        """Class of every table of its design files, by name."""
        return section_types(self.spec)

    def must(self, what: str, command: str) -> Any:
        """The field `what`. Raises InputError if the family has none, so that `command` cannot do it."""
        found = getattr(self, what)
        if found is None:
            able = [f.name for f in all_families().values() if getattr(f, what) is not None]
            raise InputError(
                command, "does not take designs of this family", value=self.name, legal=" or ".join(able)
            )
        return found


def section_types(spec: type) -> dict[str, type]:
    """Class of every table of a design file, by name: a table that may be left out is `Kind | None`."""
    hints = typing.get_type_hints(spec)
    return {
        f.name: (typing.get_args(hints[f.name]) or (hints[f.name],))[0]
        for f in dataclasses.fields(spec)
        if f.name not in NO_TABLES
    }


def optional_tables(spec: type) -> tuple[str, ...]:
    """Tables that a design may do without: rigs."""
    return tuple(f.name for f in dataclasses.fields(spec) if f.default is None)


@cache
def all_families() -> dict[str, Family]:
    """Every family by name. Raises TypeError for a module without, and for two of one name."""
    folder = import_module(FOLDER)
    modules = [import_module(f"{FOLDER}.{name}") for _, name, _ in pkgutil.iter_modules(folder.__path__)]
    if without := [m.__name__ for m in modules if not isinstance(getattr(m, "FAMILY", None), Family)]:
        raise TypeError(f"no FAMILY is declared in {', '.join(without)}")
    by_name = {m.FAMILY.name: m.FAMILY for m in modules}
    if len(by_name) < len(modules) or len({f.spec for f in by_name.values()}) < len(modules):
        raise TypeError(f"two families have one name or one spec, of {', '.join(by_name)}")
    return by_name


def family_of(design: CommonTables) -> Family:
    """The family of a design."""
    return next(f for f in all_families().values() if f.spec is type(design))


def taken_as(design: CommonTables, spec: type[Spec], where: str) -> Spec:
    """The design, which must be of the family whose class is `spec`. Raises InputError at `where`."""
    if not isinstance(design, spec):
        able = next(f.name for f in all_families().values() if f.spec is spec)
        what = "does not take designs of this family"
        raise InputError(where, what, value=family_of(design).name, legal=able)
    return design


def family_with(tables: Iterable[str]) -> Family:
    """The family that knows most of these tables; the first one of equals."""
    names = [*tables]
    return max(all_families().values(), key=lambda family: sum(name in family.tables for name in names))
