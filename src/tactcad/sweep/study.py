"""A study file: its design, varied fields and measures; one frozen dataclass a table."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from functools import cached_property
from math import prod
from pathlib import Path
from typing import Any

from tactcad.design.family import family_of
from tactcad.design.fields import Number, Numbers, OneOf, SomeOf, TextLine, Values, Whole, given, spec_of
from tactcad.design.files import read_text
from tactcad.design.load import DEFAULT_DESIGN, MOST_BYTES, find, from_table, paths, read_table, unknown_field
from tactcad.design.messages import InputError
from tactcad.design.schema import table_schema, table_text
from tactcad.design.text_values import parse_toml
from tactcad.design.tree import CommonTables, Identity
from tactcad.export.inputs import digest
from tactcad.mechanics.ladder import CLOSED_FORMS, DEFAULT_RUNG, RUNGS

from .designs_taken import GRID, HYPERCUBE, LIST, SOBOL, Points, points_at_powers, spec_at, value_at

# Chosen: ten times the largest study that was timed.
MOST_DESIGNS = 100_000_000
# A hypercube's sample is drawn whole, in every process: 80 MB for ten fields.
MOST_HYPERCUBE = 1_000_000

DRAWN = (HYPERCUBE, SOBOL)
STRENGTH, RULES, BUILDS, CHECKS, EXPORT = "strength", "rules", "builds", "checks", "export"
ESTIMATE = "estimate"


@dataclass(frozen=True)
class StudyHead:
    """[study]: which design, and how designs are taken from what varies."""

    name: str = given(spec_of(Identity, "name"))
    design: str = given(
        TextLine(
            r"[^\x00-\x1f]{1,200}",
            "a named design, or a path from the study file's folder",
            "design with all other values",
        ),
        DEFAULT_DESIGN,
    )
    sampling: str = given(
        OneOf(
            (GRID, LIST, *DRAWN),
            "every combination of values; the n-th of every list of values; or drawn, evenly spread",
        ),
        GRID,
    )
    count: int | None = given(Whole(1, MOST_DESIGNS, "designs drawn"), None, "as many as the values make")
    seed: int = given(Whole(0, 2**31 - 1, "seed of the random draw"), 0)


@dataclass(frozen=True)
class Varied:
    """[vary."PATH"]: one field of the design file by its path; one of values, range and normal."""

    values: tuple[Any, ...] | None = given(Values("the values it takes"), None, "not so varied")
    range: tuple[float, ...] | None = given(
        Numbers(
            Number("", -1e300, 1e300, "the field's unit"), 2, 2, "least and largest value, both included"
        ),
        None,
        "not so varied",
    )
    steps: int | None = given(
        Whole(2, 1_000_000, "values of range in a grid, evenly spaced"), None, "needed in a grid only"
    )
    normal: float | None = given(
        Number(
            "",
            1e-12,
            1e300,
            "plus and minus about the design's value: drawn normally, two standard deviations, cut there",
        ),
        None,
        "not so varied",
    )


@dataclass(frozen=True)
class Measures:
    """[measure]: the results for every design."""

    what: tuple[str, ...] = given(
        SomeOf(
            (*RUNGS, STRENGTH, ESTIMATE, RULES, BUILDS, CHECKS, EXPORT),
            "stiffness by these rungs, with the errors promised; strength by the same; what `tactcad "
            "estimate` says, of any family; rules between fields; arrays built virtually; every check; files",
        )
    )
    elements: tuple[float, ...] | None = given(
        Numbers(Whole(1, 1000, "element number"), 1, 1000, "elements that are measured"),
        None,
        "all elements of the design",
    )
    arrays: int = given(Whole(1, 1_000_000, "builds: arrays of each distribution"), 1000)

    @property
    def rungs(self) -> tuple[str, ...]:
        return tuple(rung for rung in RUNGS if rung in self.what)

    @property
    def whole_designs(self) -> bool:
        """Whether more than closed forms is asked for, which needs designs read whole and keeping their
        rules."""
        return not set(self.what) <= {*CLOSED_FORMS, STRENGTH}


@dataclass(frozen=True)
class Study:
    """A whole study file, with the table of the design that it varies."""

    study: StudyHead
    vary: dict[str, Varied]
    measure: Measures
    base: dict[str, Any]

    @cached_property
    def design(self) -> CommonTables:
        """The design with nothing varied."""
        return from_table(self.base)

    @cached_property
    def identity(self) -> str:
        """Digest of the study: equal for equal tables with any comments. The order of the varied fields
        counts: it is the order of running and drawing."""
        return digest([self.study, list(self.vary.items()), self.measure, self.base])

    @cached_property
    def sobol(self) -> Points:
        """Data for its Sobol points: made once, and handed on with the study."""
        return points_at_powers(len(self.vary), self.count, self.study.seed)

    @property
    def count(self) -> int:
        """Designs in all."""
        values = [v.steps or len(v.values or ()) for v in self.vary.values()]
        if self.study.sampling == GRID:
            return prod(values)
        return values[0] if self.study.sampling == LIST else self.study.count or 0

    @cached_property
    def figures(self) -> tuple[str, ...]:
        """Numbers that the family's estimate has of every element."""
        row = asdict(estimated(self.design)[0])
        return tuple(n for n, v in row.items() if type(v) in (int, float, bool) and n != "number")

    @cached_property
    def elements(self) -> tuple[int, ...]:
        """Numbers of the elements measured."""
        asked = self.measure.elements
        if asked is None:
            return tuple(p.number for p in family_of(self.design).layout(self.design).elements)
        return tuple(int(n) for n in asked)


def estimated(design: CommonTables) -> list[Any]:
    """What `tactcad estimate` says of every element, a record each."""
    family = family_of(design)
    return list(family.estimate.rows(family.layout(design), DEFAULT_RUNG, None))


TABLES: dict[str, type] = {"study": StudyHead, "vary": Varied, "measure": Measures}


def study_schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of the study file."""
    fields = {"type": "object", "minProperties": 1, "additionalProperties": table_schema(Varied)}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "tactcad study file",
        "type": "object",
        "properties": {"study": table_schema(StudyHead), "vary": fields, "measure": table_schema(Measures)},
        "required": list(TABLES),
        "additionalProperties": False,
    }


def study_text() -> str:
    """Every table of a study file with its fields: name, default, legal values, meaning."""
    names = {"study": "study", "vary": 'vary."element.hinge_thickness"', "measure": "measure"}
    lines = [line for name, kind in TABLES.items() for line in table_text(names[name], kind, False)]
    return "\n".join([*lines, "[vary] takes any field of a design file by its path: see `tactcad schema`"])


def read_study(path: str | Path) -> Study:
    """A study file, field by field.

    Raises
    ------
    InputError
        The file is missing or no study, a value is not legal, or two contradict each other.
    """
    table = _plain_toml(path, "a study file (TOML)")
    for name, value in table.items():
        if name not in TABLES:
            raise unknown_field(name, list(TABLES), "tactcad schema study")
        if not isinstance(value, dict):
            raise InputError(name, "not a table", value=value, legal=f"a table [{name}]")
    for name in TABLES:
        if not table.get(name):
            raise InputError(name, "missing table", legal=f"a table [{name}]")
    head = read_table(StudyHead, table["study"], "study")
    base = _base(head.design, Path(path).parent)
    study = Study(head, _varied(table["vary"], base), read_table(Measures, table["measure"], "measure"), base)
    for name, one in study.vary.items():
        _refuse_contradiction(study, name, one)
        # Refuse a list together with a place in it: one would overwrite the other
        if whole := next((other for other in study.vary if name.startswith(f"{other}[")), None):
            raise InputError("vary", f"{whole} and {name} vary the same value", legal="one of the two")
    _refuse_count(study)
    _refuse_measures(study)
    return study


def _plain_toml(path: str | Path, kind: str) -> dict[str, Any]:
    """A file's table, as JSON holds it: TOML's dates become text, which the fields take too."""
    table = parse_toml(read_text(path, MOST_BYTES, kind), str(path))
    return json.loads(json.dumps(table, default=str))


def _base(name: str, folder: Path) -> dict[str, Any]:
    try:
        source = find(folder / name if "/" in name or name.endswith(".toml") else name)
        table = _plain_toml(source, "a design file (TOML)")
        from_table(table)
    except InputError as error:
        raise InputError("study.design", str(error), value=name) from error
    return table


def _varied(table: dict[str, Any], base: dict[str, Any]) -> dict[str, Varied]:
    design = from_table(base)
    varied = {}
    for path, how in table.items():
        where = f"vary.{path}"
        spec = spec_at(design, path)
        nested = spec is None and isinstance(how, dict) and any(isinstance(v, dict) for v in how.values())
        if not isinstance(how, dict) or not how or nested:
            legal = '[vary."element.hinge_thickness"] with values, range or normal; with the path in quotes'
            raise InputError(where, "not a table of values", value=how, legal=legal)
        if spec is None:
            raise unknown_field(path, list(paths(design)))
        one = read_table(Varied, how, where)
        for i, value in enumerate(one.values or ()):
            spec.read(value, f"{where}.values[{i}]")
        if one.values is None and not isinstance(spec, Number):
            raise InputError(where, "takes no numbers between two", legal=f"values, each {spec.legal}")
        for i, end in enumerate(one.range or ()):
            spec.read(end, f"{where}.range[{i}]")
        if one.normal:
            middle = value_at(design, path)
            if middle is None:
                what = "the design gives no value to vary about"
                raise InputError(f"{where}.normal", what, legal="a range")
            for end in (middle - one.normal, middle + one.normal):
                spec.read(end, f"{where}.normal")
        varied[path] = one
    return varied


def _refuse_contradiction(study: Study, path: str, one: Varied) -> None:
    where, sampling = f"vary.{path}", study.study.sampling
    given_ = [name for name in ("values", "range", "normal") if getattr(one, name) is not None]
    if len(given_) != 1:
        found = " and ".join(given_) or "none"
        raise InputError(
            where, "needs one of values, range and normal", value=found, legal="range = [0.2, 0.4]"
        )
    if one.range and not one.range[0] < one.range[1]:
        raise InputError(f"{where}.range", "is empty", value=list(one.range), legal="[low, high], low < high")
    if one.steps and (sampling != GRID or not one.range):
        raise InputError(f"{where}.steps", "belongs to a range in a grid", value=one.steps, legal="left out")
    if sampling == GRID and one.range and not one.steps:
        raise InputError(where, "a range in a grid needs steps", legal="steps = 11")
    if sampling == LIST and one.values is None or sampling == GRID and one.normal:
        legal = "values" + (", or range with steps" if sampling == GRID else "")
        raise InputError(where, f"{given_[0]} cannot be taken as a {sampling}", legal=legal)


def _refuse_count(study: Study) -> None:
    head = study.study
    if head.sampling in DRAWN and head.count is None:
        raise InputError(
            "study.count", f"missing: a {head.sampling} sample needs it", legal="how many designs"
        )
    if head.sampling not in DRAWN and head.count is not None:
        raise InputError(
            "study.count", f"belongs to drawn designs, not to a {head.sampling}", legal="left out"
        )
    lengths = {path: len(one.values or ()) for path, one in study.vary.items()}
    if head.sampling == LIST and len(set(lengths.values())) > 1:
        said = ", ".join(f"{path}: {n}" for path, n in lengths.items())
        raise InputError(
            "vary", f"lists of different lengths ({said})", legal="as many values of every field"
        )
    most = MOST_HYPERCUBE if head.sampling == HYPERCUBE else MOST_DESIGNS
    if study.count > most:
        legal = f"at most {most}" + (", or sampling sobol" if head.sampling == HYPERCUBE else "")
        raise InputError("study", "too many designs", value=study.count, legal=legal)


def _refuse_measures(study: Study) -> None:
    what = study.measure.what
    if STRENGTH in what and not study.measure.rungs:
        raise InputError("measure.what", "strength goes with a rung", legal='what = ["solid", "strength"]')
    if study.measure.elements is not None and not study.measure.rungs and ESTIMATE not in what:
        raise InputError("measure.elements", "belongs to a rung or to estimate", legal="left out")
    family = family_of(study.design)
    if study.measure.rungs:
        family.must("variables", "measure.what: a rung")
    arrays = study.vary["array.row_arms"].values if "array.row_arms" in study.vary else None
    counts = [sum(map(len, rows)) for rows in arrays or ()]
    most = max([len(family.layout(study.design).elements), *counts])
    for path in study.vary:
        override = path.startswith("element.override.") and int(path.split(".")[2])
        if override and override > most:
            raise InputError(f"vary.{path}", "no such element", value=override, legal=f"1 to {most}")
    if study.elements and max(study.elements) > most:
        raise InputError(
            "measure.elements", "no such element", value=max(study.elements), legal=f"1 to {most}"
        )
    if len(set(study.elements)) < len(study.elements):
        raise InputError("measure.elements", "an element twice", legal="each once")
