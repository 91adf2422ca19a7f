"""A target file: one frozen dataclass a table.

Lengths in mm, forces in N, stiffnesses in N/mm, stresses in MPa.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import ceil, floor, inf
from pathlib import Path
from typing import Any

from tactcad.contact.elastic_body import Body
from tactcad.contact.press import THINNEST, pad_stiffness
from tactcad.design.family import all_families, family_of, taken_as
from tactcad.design.fields import (
    Number,
    Numbers,
    OneOf,
    SomeOf,
    TextLine,
    Whole,
    given,
    shown_text,
    spec_of,
    with_value,
)
from tactcad.design.files import read_text
from tactcad.design.load import DEFAULT_DESIGN, MOST_BYTES, read, read_table, unknown_field
from tactcad.design.materials import ALLOYS, alloy
from tactcad.design.messages import InputError
from tactcad.design.schema import table_schema, table_text
from tactcad.design.sensing import POWERS, StrainGauge
from tactcad.design.text_values import parse_toml
from tactcad.design.tree import Array, Design, Element, Identity, Rating, Sheet, Tolerance
from tactcad.lab.calibration import RUN_SCATTER
from tactcad.lab.pads import SOFT

ARM, THICKNESS = 0.1, 0.005  # mm, steps that a drawing states and a shop's wire can tell apart
LEAST = ("width", "kinds", "room", "cut", "tolerance")
KNOWN = ("drawn", "inspected", "calibrated")
REFERENCES = ("stiffness", "modulus")


def _range(spec: Number, meaning: str) -> Numbers:
    return Numbers(spec, 2, 2, meaning)


@dataclass(frozen=True)
class Wish:
    """[target]: what the sensor is to reach."""

    name: str = given(spec_of(Identity, "name"))
    title: str = given(spec_of(Identity, "title"), "Array from a target")
    base: str = given(
        TextLine(
            r"[^\x00-\x1f]{1,200}",
            "a named design, or a path from the target file's folder",
            "design with all other values",
        ),
        DEFAULT_DESIGN,
    )
    half_width: float | None = given(
        Number("%", 0.1, 50, "half-width of the 95 % interval of K_obj over the whole range, at most"),
        None,
        "the best to be had",
    )
    share: float = given(Number("", 0.5, 0.999, "share of arrays made that meet the target, at least"), 0.95)
    least: str = given(OneOf(LEAST, "quantity to minimise once the target is met"), "width")


@dataclass(frozen=True)
class Object:
    """[object]: the object, by its stiffness under one pad, or by modulus and thickness."""

    stiffness: tuple[float, ...] | None = given(
        _range(Number("N/mm", 1e-3, 1e4, "K_obj"), "least and largest stiffness under one pad"),
        None,
        "from modulus and thickness",
    )
    modulus: tuple[float, ...] | None = given(
        _range(Number("MPa", 1e-4, 1e4, "E"), "least and largest Young's modulus"), None, "not needed"
    )
    thickness: float | None = given(
        Number("mm", 0.1, 1e3, "of the object, bonded to a rigid base"), None, "a half-space"
    )
    poisson: float = given(Number("", 0, 0.5, "Poisson's ratio of a layer or half-space"), SOFT)
    thickness_limits: float = given(Number("%", 0, 50, "half-width of the thickness in use"), 0.0)
    angle: tuple[float, ...] = given(
        _range(Number("degrees", 0, 30, "inclination"), "least and largest inclination of its face, any way"),
        (0.0, 0.0),
    )
    reference: str = given(OneOf(REFERENCES, "quantity of the half-width"), "stiffness")


@dataclass(frozen=True)
class Grip:
    """[grasp]: forces."""

    force: float = given(Number("N", 1e-3, 1e4, "largest force on the whole array"))
    overload: float = given(spec_of(Rating, "overload_force"))
    element_force: float = given(Number("N", 1e-6, 1e4, "largest force on one element"), 1e4)
    loads: int = given(Whole(4, 1000, "loads at which signals are read, evenly up to the largest"), 10)


@dataclass(frozen=True)
class Room:
    """[room]: what the array may take up."""

    rows: int = given(Whole(1, 2, "rows of elements"), 2)
    elements: tuple[float, ...] = given(
        Numbers(Whole(2, 1000, "elements"), 2, 2, "least and largest number of elements"), (2, 10)
    )
    pitch: float = given(
        Number("mm", 0.2, 50, "least distance of neighbouring pads, along and across the rows"), 0.2
    )
    length: float = given(Number("mm", 1, 2000, "along the arms, carrier and all"), 2000.0)
    width: float = given(Number("mm", 1, 2000, "along the rows, carrier and all"), 2000.0)
    height: float = given(Number("mm", 1, 500, "from the pads to the carrier's top"), 500.0)


class SomeAlloys(SomeOf):
    """Names of alloys; a refusal has what each is."""

    def read(self, value: Any, where: str) -> tuple[str, ...]:
        for i, name in enumerate(value if isinstance(value, list) else ()):
            alloy(str(name), f"{where}[{i}]")
        return super().read(value, where)


@dataclass(frozen=True)
class Stock:
    """[stock]: available sheets, alloys and gauges."""

    sheets: tuple[float, ...] = given(
        Numbers(spec_of(Sheet, "thickness"), 1, 8, "sheet thicknesses"), None, "the base design's"
    )
    alloys: tuple[str, ...] = given(
        SomeAlloys(tuple(ALLOYS), "sheet materials, names of the table"), None, "the base design's material"
    )
    hinge_tolerances: tuple[float, ...] = given(
        Numbers(
            spec_of(Tolerance, "hinge_thickness"), 1, 6, "tolerances of the hinge that the wire's passes hold"
        ),
        None,
        "the base design's",
    )
    gauges: tuple[float, ...] = given(
        Numbers(spec_of(StrainGauge, "resistance"), 1, 6, "gauges, by their resistance"),
        None,
        "the base design's",
    )
    powers: tuple[str, ...] = given(
        SomeOf(POWERS, "how a converter's bridges may be fed, as readout.power"), None, "the base design's"
    )


@dataclass(frozen=True)
class Kinds:
    """[elements]: ranges of the elements' dimensions."""

    arms: tuple[float, ...] = given(
        _range(Number("mm", 0.1, 100, "arm length"), "shortest and longest arm"), (4.0, 8.0)
    )
    hinges: tuple[float, ...] = given(
        _range(spec_of(Element, "hinge_thickness"), "thinnest and thickest hinge"), (0.15, 0.6)
    )
    pads: tuple[float, ...] | None = given(
        _range(spec_of(Element, "pad_length"), "shortest and longest pad, for a body under rigid pads"),
        None,
        "the base design's",
    )
    kinds: int = given(Whole(2, 4, "different elements, at most"), 2)
    of_a_kind: int = given(Whole(1, 500, "elements of each kind, at least"), 1)


@dataclass(frozen=True)
class Known:
    """[known]: how well each element is known in use."""

    how: str = given(
        OneOf(KNOWN, "from the drawing, from an inspection, or from a calibration"), "calibrated"
    )
    thickness: float = given(
        Number("mm", 0, 0.1, "inspected: expanded uncertainty (k = 2) of a hinge's thickness"), 0.002
    )
    runs: int = given(Whole(2, 100, "calibrated: runs of every element"), 3)
    run_scatter: float = given(
        Number("", 0, 0.2, "calibrated: standard deviation of a slope from run to run, relative"), RUN_SCATTER
    )
    force_noise: float = given(Number("N", 0, 10, "calibrated: of one reading"), 0.003)
    displacement_noise: float = given(Number("mm", 0, 0.1, "calibrated: of one reading"), 0.0005)
    gauge_factor: float = given(
        Number("", 0, 0.2, "drawn or inspected: half-width of each gauge's own sensitivity, relative"), 0.02
    )
    contact: float = given(
        Number("mm", 0, 1, "half-width of the contact's place along the arm, in use against as known"), 0.01
    )


@dataclass(frozen=True)
class Target:
    """A whole target file, with the design that it starts from; `written` has the paths of its own values.
    Where `base` was given the compact clamp, `own_clamp` has the screws that it came with."""

    target: Wish
    object: Object
    grasp: Grip
    base: Design
    room: Room = Room()
    stock: Stock = Stock(None, None, None, None, None)  # type: ignore[arg-type]
    elements: Kinds = Kinds()
    known: Known = Known()
    origin: dict[str, str] = field(default_factory=dict)
    written: frozenset[str] = frozenset()
    own_clamp: str = ""

    @property
    def on_layer(self) -> bool:
        """Whether the object is a body under rigid pads, not a spring under each."""
        return self.object.modulus is not None or self.object.thickness is not None

    @property
    def stiffness_range(self) -> tuple[float, float]:
        """Least and largest K_obj, N/mm; if the object is a body, under one level pad of the base's."""
        return self.range_of(self.base)

    def range_of(self, design: Design) -> tuple[float, float]:
        """`stiffness_range` under a design's pads."""
        if self.object.stiffness:
            return self.object.stiffness[0], self.object.stiffness[1]
        low, high = self.object.modulus or (0.0, 0.0)
        unit = self.unit(design)
        return low * unit, high * unit

    @property
    def body(self) -> Body:
        """The object at 1 MPa."""
        return Body(1.0, self.object.poisson, self.object.thickness or inf)

    def unit(self, design: Design) -> float:
        """K_obj under one of a design's pads, level and alone, for each MPa, N/mm."""
        return pad_stiffness(self.body, design.element.pad_length, design.sheet.thickness)

    def moduli(self, design: Design) -> tuple[float, float]:
        """Least and largest modulus, MPa, under a design's pads."""
        (low, high), unit = self.range_of(design), self.unit(design)
        return low / unit, high / unit

    def with_(self, path: str, value: Any) -> Target:
        """A copy with another value of one field, "grasp.force"."""
        return with_value(self, path, value)


TABLES: dict[str, type] = {
    "target": Wish,
    "object": Object,
    "grasp": Grip,
    "room": Room,
    "stock": Stock,
    "elements": Kinds,
    "known": Known,
}
REQUIRED = ("target", "object", "grasp")


def target_schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of the target file, of this family or, if it has such a table, of another."""
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "tactcad target file",
        "type": "object",
    }
    own = _file_schema(TABLES, REQUIRED)
    for name, tables in _of_others().items():
        other = _file_schema(tables, tuple(tables))
        own = {"if": {"required": [name]}, "then": other, "else": own}
    return schema | own


def _file_schema(tables: Mapping[str, type], required: Sequence[str]) -> dict[str, Any]:
    known = {name: table_schema(kind) for name, kind in tables.items()} | {"origin": {"type": "object"}}
    return {"properties": known, "required": list(required), "additionalProperties": False}


def _of_others() -> dict[str, Mapping[str, type]]:
    """Tables of the target files of families that have their own, by the family's name."""
    return {f.name: f.targets.tables() for f in all_families().values() if f.targets}


def target_text() -> str:
    """Every table of a target file with its fields: name, default, legal values, meaning."""
    lines = [line for name, kind in TABLES.items() for line in table_text(name, kind, name not in REQUIRED)]
    for name, tables in _of_others().items():
        lines += [f"A target file with [{name}] has these tables instead:", ""]
        lines += [line for own, kind in tables.items() for line in table_text(own, kind, False)]
    return "\n".join([*lines, '[origin] holds the source of any value, as "grasp.force" = "measured: ..."'])


def read_target(path: str | Path) -> Target:
    """A target file, field by field.

    Raises
    ------
    InputError
        The file is missing or no target, a value is not legal, or two contradict each other.
    """
    return parse_target(read_text(path, MOST_BYTES, "a target file (TOML)"), str(path), Path(path).parent)


def parse_target(text: str, where: str, folder: Path = Path()) -> Target:
    """A target from TOML text; `where` names the text in messages, and `target.base` as a path is one from
    `folder`. Raises as `read_target`."""
    table = parse_toml(text, where)
    values, written = tables_of(table, TABLES, REQUIRED)
    base = _base(values["target"].base, folder)
    stock = values["stock"]
    values["stock"] = Stock(
        stock.sheets or (base.sheet.thickness,),
        stock.alloys or (base.material.alloy,),
        stock.hinge_tolerances or (base.tolerance.hinge_thickness,),
        stock.gauges or (base.gauge.resistance,),
        stock.powers or (base.readout.power,),
    )
    target = Target(**values, base=base, origin=origins_of(table.get("origin", {}), values), written=written)
    _refuse_contradictions(target)
    return target


def tables_of(
    table: Mapping[str, Any], kinds: Mapping[str, type], required: Sequence[str] = ()
) -> tuple[dict[str, Any], frozenset[str]]:
    """Values of a target file's tables of these kinds, and the paths of the fields that are written. Raises
    InputError for what is unknown, missing or illegal."""
    for name, value in table.items():
        if name not in (*kinds, "origin"):
            raise unknown_field(name, [*kinds, "origin"], "tactcad schema target")
        if not isinstance(value, dict):
            raise InputError(name, "not a table", value=value, legal=f"a table [{name}]")
    for name in required:
        if name not in table:
            raise InputError(name, "missing table", legal=f"a table [{name}]")
    values = {name: read_table(kind, table.get(name, {}), name) for name, kind in kinds.items()}
    return values, frozenset(f"{name}.{field}" for name in kinds for field in table.get(name, {}))


def _base(name: str, folder: Path) -> Design:
    try:
        base = read(folder / name if "/" in name or name.endswith(".toml") else name)
        family_of(base).must("variables", "target.base")
        return taken_as(base, Design, "target.base")
    except InputError as error:
        if error.where == "DESIGN":
            raise InputError("target.base", error.what, value=name, legal=error.legal) from error
        raise InputError("target.base", str(error), value=name) from error


def origins_of(table: dict[str, Any], values: dict[str, Any]) -> dict[str, str]:
    """[origin] of a target file. Raises InputError for a path that its tables do not have."""
    known = [f"{name}.{f.name}" for name, value in values.items() for f in dataclasses.fields(value)]
    for path, text in table.items():
        if path not in known:
            raise unknown_field(f"origin.{path}", [f"origin.{p}" for p in known], "tactcad schema target")
        shown_text(text, f"origin.{path}", "the value's source")
    return dict(table)


def _refuse_contradictions(target: Target) -> None:
    o, room, e = target.object, target.room, target.elements
    if (o.stiffness is None) == (o.modulus is None):
        raise InputError("object", "needs one of stiffness and modulus", legal="stiffness = [2, 10] (N/mm)")
    if o.angle[1] > 0 and not target.on_layer:
        legal = "a modulus, or a thickness with the stiffness"
        raise InputError(
            "object.angle", "needs a body that can be inclined", value=list(o.angle), legal=legal
        )
    thinnest = THINNEST * (target.base.element.pad_length * max(target.stock.sheets)) ** 0.5
    if o.thickness is not None and o.thickness < thinnest:
        legal = f"at least {thinnest:.3g} mm, {THINNEST:g} of a pad's side; left out for a half-space"
        raise InputError("object.thickness", "too thin for rigid pads", value=o.thickness, legal=legal)
    for path, values in (
        ("stock.sheets", target.stock.sheets),
        ("stock.hinge_tolerances", target.stock.hinge_tolerances),
        ("stock.gauges", target.stock.gauges),
    ):
        if len(set(values)) < len(values):
            raise InputError(path, "not a list of different numbers", value=list(values), legal="each once")
    for path, pair in (
        ("object.stiffness", o.stiffness),
        ("object.modulus", o.modulus),
        ("object.angle", o.angle),
        ("room.elements", room.elements),
        ("elements.arms", e.arms),
        ("elements.hinges", e.hinges),
        ("elements.pads", e.pads),
    ):
        if pair and pair[0] > pair[1]:
            raise InputError(path, "its first value is above its second", value=list(pair), legal="low, high")
    if 2 * e.of_a_kind > room.elements[1]:
        where, what = "elements.of_a_kind", "two kinds of so many are more than room.elements allows"
        raise InputError(where, what, value=e.of_a_kind, legal=f"at most {int(room.elements[1]) // 2}")
    if target.known.how == "calibrated" and target.base.calibration is None:
        what, value = f"design {target.base.name} has no [calibration] table", target.known.how
        raise InputError("known.how", what, value=value, legal="drawn or inspected, or another target.base")
    _refuse_between_steps(target)
    _refuse_illegal_pitch(target)


def _refuse_between_steps(target: Target) -> None:
    """Ranges that hold no value which the search can take."""
    e = target.elements
    for path, (low, high), step in (("elements.arms", e.arms, ARM), ("elements.hinges", e.hinges, THICKNESS)):
        if floor(high / step + 1e-9) < ceil(low / step - 1e-9):
            near = f"{floor(low / step) * step:g} or {ceil(high / step) * step:g} mm"
            what = f"holds no whole multiple of {step:g} mm, the step of the search"
            raise InputError(path, what, value=[low, high], legal=f"a range that holds {near}")


def _refuse_illegal_pitch(target: Target) -> None:
    """Pitches with which no design file could be written."""
    spec = spec_of(Array, "spacer")
    for sheet in target.stock.sheets:
        spacer = round(target.room.pitch - sheet, 6)
        if spacer > spec.high:
            what = f"a sheet of {sheet:g} mm would need spacers of {spacer:g} mm"
            legal = f"at most {sheet + spec.high:g} mm: array.spacer is {spec.legal}"
            raise InputError("room.pitch", what, value=target.room.pitch, legal=legal)
