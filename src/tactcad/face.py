"""The names of `import tactcad as tc`, for notebooks and scripts: docs/python.md has an example of each.

Answers are those of the commands. numpy and the CAD kernel are loaded by the first question that needs them.
"""

from __future__ import annotations

import copy
import io
import json
import re
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import redirect_stdout
from dataclasses import asdict, dataclass, field, is_dataclass, replace
from functools import wraps
from html import escape
from inspect import Parameter, signature
from math import hypot, inf, isfinite, nan
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar, get_args

from tactcad.design.design_text import design_text, started
from tactcad.design.family import family_of
from tactcad.design.files import read_text, write_whole
from tactcad.design.load import DEFAULT_DESIGN, MOST_BYTES, find, from_table, names, unknown_field
from tactcad.design.materials import alloy
from tactcad.design.messages import CheckFailure, InputError, did_you_mean, in_brackets, refusal
from tactcad.design.text_values import parse_toml

if TYPE_CHECKING:
    from tactcad.contour import Contour
    from tactcad.design.tree import CommonTables
    from tactcad.parts.language.description import Part
    from tactcad.review.show import ShownPage
    from tactcad.scenes.scene import AddedPart, Scene

Asked = ParamSpec("Asked")
Given = TypeVar("Given")
Point = tuple[float, float, float]
SLUG = "abcdefghijklmnopqrstuvwxyz0123456789-"
SHOWN, WIDEST = 11, 60  # columns of a table, characters of a cell; chosen: they fit the width of a screen
ESTIMATE = ("value", "estimate", "low", "high")


def _in_our_words(ask: Callable[Asked, Given]) -> Callable[Asked, Given]:
    """The function; missing or unknown arguments, and a library of an extra that is not installed, are
    refused as commands do."""
    taken = signature(ask)
    shown = [p.replace(annotation=Parameter.empty) for p in taken.parameters.values() if p.name != "self"]

    @wraps(ask)
    def asked(*args: Asked.args, **named: Asked.kwargs) -> Given:
        try:
            taken.bind(*args, **named)
        except TypeError as error:
            legal = f"{ask.__name__}{taken.replace(parameters=shown, return_annotation=taken.empty)}"
            raise InputError(ask.__name__, str(error), legal=legal) from None
        try:
            return ask(*args, **named)
        except ImportError as error:
            if (why := refusal(error)) is None:
                raise
            raise why from None

    return asked


@dataclass(frozen=True, repr=False)
class Reply(Sequence[Any]):
    """A result: a sequence of records, displayed as a table.

    title    its heading
    records  the lines of the table
    whole    everything, as the command's --json has it
    """

    title: str
    records: tuple[Any, ...]
    whole: Mapping[str, Any]

    def __len__(self) -> int:
        return len(self.records)

    def __getitem__(self, place: Any) -> Any:
        if isinstance(place, str):
            raise InputError(place, "a reply has records by number", legal="[0]; to_frame() has columns")
        return self.records[place]

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain data; lengths mm, forces N, stiffnesses N/mm."""
        return dict(self.whole)

    @_in_our_words
    def to_frame(self) -> Any:
        """The records as a pandas DataFrame. Raises CheckFailure if pandas is not installed."""
        try:
            from pandas import DataFrame
        except ImportError:
            raise CheckFailure("pandas is not installed: pip install pandas") from None
        return DataFrame([_plain(record) for record in self.records])

    def _table(self) -> tuple[list[str], list[list[str]]]:
        """Headings and lines of cells."""
        from tactcad.report.figures import declared

        if not self.records:
            return [], []
        if figures := declared(type(self.records[0])):
            shown = [f for f in figures if any(f.of(r) is not None for r in self.records)][:SHOWN]
            return [f.title for f in shown], [[f.text(r, "-") for f in shown] for r in self.records]
        rows = [_plain(record) for record in self.records]
        heads = [k for k, v in rows[0].items() if not isinstance(v, Mapping | list | tuple)][:SHOWN]
        return heads, [[_cell(row.get(k)) for k in heads] for row in rows]

    def __repr__(self) -> str:
        from tactcad.report.figures import aligned

        heads, lines = self._table()
        return "\n".join([self.title, *(aligned([heads, *lines]) if heads else [])])

    def _repr_html_(self) -> str:
        heads, lines = self._table()
        head = "".join(f"<th>{escape(h)}</th>" for h in heads)
        body = "".join("<tr>" + "".join(f"<td>{escape(c)}</td>" for c in line) + "</tr>" for line in lines)
        return f"<table><caption>{escape(self.title)}</caption><tr>{head}</tr>{body}</table>"


def _plain(record: Any) -> dict[str, Any]:
    if isinstance(record, LoadedDesign):
        return {"design": record.name, "size, mm": " x ".join(f"{side:.4g}" for side in record.size)}
    return asdict(record) if is_dataclass(record) and not isinstance(record, type) else dict(record)


def _cell(value: Any) -> str:
    text = "-" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
    return text if len(text) <= WIDEST else f"{text[: WIDEST - 3]}..."


@dataclass(repr=False)
class LoadedDesign:
    """A design with its questions. It never changes, but for the parts that `scene(...).add` puts in.

    table    the design file as parsed TOML
    source   its file or name
    added    parts that were added, in order
    text     the file's own text; None if `with_` changed it
    """

    table: dict[str, Any]
    source: str
    added: list[AddedPart] = field(default_factory=list)
    text: str | None = None

    def __post_init__(self) -> None:
        self._read = from_table(self.table)
        self._kept = False

    def __repr__(self) -> str:
        family = family_of(self._read).name
        return f"<design {self.name}, revision {self._read.design.revision}, {family}>"

    @property
    def name(self) -> str:
        """The design's own name."""
        return self._read.name

    @property
    def design(self) -> CommonTables:
        """The parameter tree with the parts added; the first use tries the rules between its fields."""
        if not self._kept:
            from tactcad.parts.rules import refuse_broken

            refuse_broken(self._read)
            self._kept = True
        return replace(self._read, added=tuple(self.added))

    def with_(self, changes: Mapping[str, Any] | None = None, /, **named: Any) -> LoadedDesign:
        """The design with other values, as `with_(hinge_thickness=0.3)` or `with_({"array.pitch": 4.5})`.

        Parameters
        ----------
        changes
            Values by path, as in messages. None removes a value, which then has its default. A stated value
            that can be derived, as array.spacer, is derived if it no longer fits.
        **named
            Values by a bare name, if only one table has it. A field of [tolerance] needs its path.

        Raises
        ------
        InputError
            If a name is unknown or of several tables, a value is not legal, or a rule is broken.
        """
        if not isinstance(changes, Mapping | None):
            raise InputError("with_", "not fields and values", value=changes, legal='{"array.pitch": 4.5}')
        made = copy.deepcopy(self.table)
        made["design"].pop("unchanged", None)  # nothing shows that its parts are as they were
        given = {self._path(str(name)): value for name, value in {**(changes or {}), **named}.items()}
        if "material.alloy" in given:  # a new alloy comes with its own values
            made["material"] = {}
        for path, value in given.items():
            _put(made, path.split(".", 2 if path.startswith("stop.gaps.") else -1), _as_toml(value))
        made["origin"] = {
            path: "chosen: with_ in Python" if path in given else text
            for path, text in self._read.origin.items()
            if path in given or "material.alloy" not in given or not path.startswith("material.")
        }
        while (changed := LoadedDesign(made, self.source, [*self.added])) and (
            path := changed._follows(given)
        ):
            _put(made, path.split("."), None)
        _ = changed.design  # tries the rules
        return changed

    def _follows(self, given: Mapping[str, Any]) -> str:
        """A stated field that breaks a rule but could be derived, as array.spacer; "" if there is none."""
        from tactcad.parts.rules import broken_rules

        tables = family_of(self._read).tables
        for path in (finding.part for finding in broken_rules(self._read)):
            table, _, name = path.partition(".")
            spec = getattr(tables.get(table), "__dataclass_fields__", {}).get(name)
            stated = name in self.table.get(table, {}) and path not in given
            if spec is not None and spec.metadata.get("derived") and stated:
                return path
        return ""

    def _path(self, name: str) -> str:
        """The path of a field that a bare name means. Raises InputError."""
        if "." in name:
            return name
        tables = family_of(self._read).tables
        if name in tables:
            raise InputError(name, "a table, not a field", legal=f'a path, as "{name}.FIELD"')
        here = [t for t in tables if getattr(self._read, t) is not None and name in _fields(tables[t])]
        here = [t for t in here if t != "tolerance"] or here
        if not here:
            raise unknown_field(name, sorted({f for kind in tables.values() for f in _fields(kind)}))
        if len(here) > 1:
            raise InputError(
                name, "a field of several tables", legal=" or ".join(f"{t}.{name}" for t in here)
            )
        return f"{here[0]}.{name}"

    @property
    @_in_our_words
    def size(self) -> Point:
        """Length, width and height of the array as built, mm."""
        from tactcad.scenes import overall_size

        return overall_size(self.design)

    @_in_our_words
    def estimate(self, model: str = "solid", force: float | None = None) -> Reply:
        """Stiffness, strain and strength of every element, by a rung of the ladder and at a force (N)."""
        from tactcad.design.tree import ASKED_FORCE
        from tactcad.mechanics.ladder import RUNGS

        if model not in RUNGS:
            raise InputError("model", "unknown", value=model, legal=f"one of {', '.join(RUNGS)}")
        if force is not None:
            ASKED_FORCE.read(force, "force")
        family = family_of(self.design)
        rows = tuple(family.estimate.rows(family.layout(self.design), model, force))
        whole = {"design": self.name, "model": model, "size_mm": self.size, "elements": [*map(_plain, rows)]}
        return Reply(f"{self.name} at {rows[0].force:g} N", rows, whole)

    @_in_our_words
    def check(self, *scenes: str) -> Reply:
        """The findings of every check on these scenes, or on all; `passed` in `to_dict` is true if none
        failed."""
        from tactcad.checks.check_report import as_record
        from tactcad.checks.run import run_checks

        report = run_checks(self.design, self._scenes(scenes))
        told = f"{self.name}: {len(report.failures)} failed, {len(report.findings)} findings in all"
        first = sorted(report.findings, key=lambda finding: finding.severity != "fail")
        return Reply(told, tuple(first), as_record(report))

    @_in_our_words
    def export(self, folder: str | Path, *scenes: str, drawings: bool = False, guide: bool = False) -> Reply:
        """Write every file of these scenes, or of all, to a folder, all or nothing."""
        from tactcad.export.formats import ExportOptions
        from tactcad.export.manifest import read_export
        from tactcad.export.pipeline import Quiet, export
        from tactcad.scenes.scene import REST

        for where, wish in (("drawings", drawings), ("guide", guide)):
            if not isinstance(wish, bool):
                raise InputError(where, "not a yes or no", value=wish, legal="True or False")
        options = ExportOptions(self._scenes(scenes), REST, guide, "full", drawings)
        done = export(self.design, options, _path_of(folder, "export"), Quiet())
        files = read_export(str(folder), Path(folder)).files
        whole = {"folder": str(done.folder), "files": [*map(_plain, files)], "made": list(done.made)}
        return Reply(f"{done.folder}: {len(files)} files", tuple(files), whole)

    @_in_our_words
    def show(self, scene: str = "array") -> ShownPage:
        """The review page of a scene; a notebook shows it below the cell, `.html` holds its bytes."""
        from tactcad.review.show import show

        (name,) = self._scenes((scene,))
        return show(self.design, name)

    @_in_our_words
    def scene(self, name: str) -> OpenScene:
        """One scene: its placements, its bill, and `add` for your own parts."""
        (name,) = self._scenes((name,))
        return OpenScene(self, name)

    @_in_our_words
    def save(self, file: str | Path) -> Path:
        """Write the design as a new design file; one that is there is never written over."""
        path = _path_of(file, "save")
        if path.exists():
            raise InputError(str(path), "is there already; nothing was changed", legal="a new file's name")
        if self.added:
            raise InputError("save", "a design file holds no parts added in Python", legal="export")
        write_whole(path, (self.text or design_text(self.design)).encode())
        return path

    def _scenes(self, wanted: Sequence[str]) -> tuple[str, ...]:
        from tactcad.scenes import left_out, scene_names

        known = scene_names(self.design)
        for name in wanted:
            if name not in known:
                why = next((f" ({o.reason})" for o in left_out(self.design) if o.scene == name), "")
                hint = why or in_brackets(did_you_mean(str(name), known))
                raise InputError(self.name, f"no scene {name!r}; there are {', '.join(known)}{hint}")
        return tuple(name for name in known if not wanted or name in wanted)


@dataclass(repr=False)
class OpenScene:
    """One scene of a design."""

    of: LoadedDesign
    name: str

    @property
    def made(self) -> Scene:
        """The placements, with what was added."""
        from tactcad.scenes import make_scene

        return make_scene(self.of.design, self.name)

    def __repr__(self) -> str:
        return f"<scene {self.name} of {self.of.name}: {len(self.made.placements)} parts placed>"

    @property
    def size(self) -> Point:
        """Length, width and height of all that is placed, mm."""
        return self.made.size

    @property
    def bill(self) -> Reply:
        """The bill of materials."""
        from tactcad.scenes.bom import bom_rows

        rows = bom_rows(self.made, self.of.design.design, {})
        return Reply(f"{self.of.name}, {self.name}", rows, {"rows": [*map(_plain, rows)]})

    @_in_our_words
    def add(
        self,
        part: Part | Any,
        *,
        at: Sequence[float] = (0.0, 0.0, 0.0),
        step: str = "Own parts",
        touches: str | Sequence[str] = (),
        name: str = "",
        material: str = "6061-T6",
    ) -> OpenScene:
        """Put a part of one's own into the scene: STEP, bill, guide, review and checks then have it.

        Parameters
        ----------
        part
            A `tc.Part`, or a build123d solid (mm).
        at
            Place of its origin in the scene, mm.
        step
            Title of its assembly step: one of the scene's, or a new last one.
        touches
            Designators of the parts that it is meant to touch; without it a contact is a finding.
        name, material
            Of a solid: its name in the bill (default its label), and its alloy, which gives its mass.

        Returns
        -------
        OpenScene
            This scene.

        Raises
        ------
        InputError
            If `part` is no part, a designator is unknown, or the part's number is another part's.
        """
        from tactcad.parts.language.description import Part, vector
        from tactcad.scenes.scene import AddedPart, Placement, with_added

        made, design = self.made, self.of.design
        try:
            place = vector(map(float, at))
        except (TypeError, ValueError):
            place = (nan, nan, nan)
        if not all(map(isfinite, place)):
            raise InputError("at", "not a place", value=at, legal="x, y, z in mm")
        for where, text in (("step", step), ("name", name)):
            if not isinstance(text, str) or not (text or where == "name"):
                raise InputError(where, "not text", value=text, legal="a line of text")
        known = {p.designator for p in made.placements}
        touched = tuple(touches) if isinstance(touches, list | tuple | set) else (touches,) if touches else ()
        if unknown := [d for d in touched if d not in known]:
            legal = f"a designator of scene {self.name}{in_brackets(did_you_mean(str(unknown[0]), known))}"
            raise InputError("touches", "nothing is called so", value=unknown[0], legal=legal)
        if not isinstance(part, Part):
            part = _from_solid(part, design.name, name, material)
        _refuse_wrong(part)
        designator = next(d for n in range(1, len(known) + 2) if (d := f"OWN{n}") not in known)
        new = AddedPart(self.name, Placement(designator, part, place), step, touched)
        try:
            with_added(made, [new])
        except ValueError as error:
            raise InputError("add", str(error)) from None
        self.of.added.append(new)
        return self

    @_in_our_words
    def export(self, folder: str | Path, drawings: bool = False, guide: bool = False) -> Reply:
        """As `LoadedDesign.export`, of this scene."""
        return self.of.export(folder, self.name, drawings=drawings, guide=guide)

    @_in_our_words
    def check(self) -> Reply:
        """As `LoadedDesign.check`, of this scene."""
        return self.of.check(self.name)

    @_in_our_words
    def show(self) -> ShownPage:
        """As `LoadedDesign.show`, of this scene."""
        return self.of.show(self.name)


def _number(value: Any, least: float = -inf) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool) and least < float(value) < inf


def _place(value: Any, axes: int = 3) -> bool:
    return isinstance(value, Iterable) and len(values := [*value]) == axes and all(map(_number, values))


def _refuse_wrong(part: Part) -> None:
    """Raises InputError if a part holds what no file can."""
    from tactcad.contour import Contour
    from tactcad.parts.language.description import (
        Extrusion,
        Hole,
        Material,
        ModelFile,
        Pocket,
        Process,
        Revolution,
    )

    def drilled(feature: Any) -> bool:
        f = feature
        sizes = _number(f.diameter, 0) and _number(f.depth, 0) and _number(f.thread_depth, -1)
        unit = _place(f.at) and _place(f.axis) and abs(hypot(*f.axis) - 1) < 1e-6
        return sizes and unit and re.fullmatch(r"(M\d+(\.\d+)?)?", str(f.thread)) is not None

    body, processes = part.body, get_args(Process)
    cut = (body.outer, *body.openings) if isinstance(body, Extrusion) else ()
    whole = isinstance(body, Extrusion | Revolution | ModelFile) and all(isinstance(c, Contour) for c in cut)
    whole = whole and _number(getattr(body, "thickness", 1), 0)
    features = isinstance(part.features, Sequence) and all(
        drilled(f) if isinstance(f, Hole) else isinstance(f, Pocket) for f in part.features
    )
    dense = isinstance(part.material, Material) and _number(part.material.density, 0)
    number = re.fullmatch("[A-Za-z0-9][A-Za-z0-9_.-]{0,79}", str(part.part_no))
    good = {
        "part_no": (number, "letters, digits, _.-"),
        "name": (isinstance(part.name, str) and part.name, "a line of text"),
        "process": (part.process in processes, f"one of {', '.join(processes)}"),
        "material": (dense, "a tc.Material of a density above 0 kg/m3"),
        "features": (
            features,
            "a list of tc.Hole: at and unit axis as x, y, z; sizes above 0 mm; thread as M3",
        ),
        "body": (whole and features and part.volume > 0, "a tc.Extrusion above 0 mm3"),
    }
    for name, (fits, legal) in good.items():
        if not fits:
            raise InputError(f"part.{name}", "not usable", value=getattr(part, name), legal=legal)


def _from_solid(shape: Any, design: str, name: str, material: str) -> Part:
    """A bought part with the shape of a build123d solid, kept as a STEP file in the cache."""
    from tactcad.export.cache import LIBRARIES, default_root
    from tactcad.parts.language.description import Material, Part, Purchase

    if getattr(shape, "wrapped", None) is None:
        raise InputError("part", "no part", value=shape, legal="a tc.Part or a build123d solid")
    from tactcad.solids.step import kept_model

    row, title = alloy(material), name or getattr(shape, "label", "") or "Own part"
    body = kept_model(shape, default_root() / LIBRARIES / "own")
    slug = "".join(c if c in SLUG else "-" for c in title.lower()).strip("-") or "own"
    return Part(
        part_no=f"{design}-{slug}",
        name=title,
        process="bought",
        material=Material(row.name, row.density),
        body=body,
        purchase=Purchase(f"{title}, by its own STEP file"),
    )


def _path_of(file: Any, where: str) -> Path:
    """A path that was given. Raises InputError."""
    if not isinstance(file, str | Path) or not str(file):
        raise InputError(where, "not a path", value=file, legal="text or a pathlib.Path")
    return Path(file)


def _fields(kind: type) -> set[str]:
    return set(getattr(kind, "__dataclass_fields__"))


def _put(table: dict[str, Any], path: list[str], value: Any) -> None:
    """Set a value in nested tables, or remove it (None)."""
    *above, name = path
    for key in above:
        inner = table.setdefault(key, {})
        if not isinstance(inner, dict):
            raise InputError(".".join(path), f"{key} holds a value and is no table")
        table = inner
    if value is None:
        table.pop(name, None)
    else:
        table[name] = value


def _as_toml(value: Any) -> Any:
    """Lists for tuples and arrays, plain numbers for numpy's."""
    value = value.tolist() if hasattr(value, "tolist") else value
    return [*map(_as_toml, value)] if isinstance(value, list | tuple) else value


@_in_our_words
def load(source: str | Path = DEFAULT_DESIGN) -> LoadedDesign:
    """A design by its path, or by its name in hardware/, read field by field.

    Rules between fields are tried on its first use.
    """
    path = find(source)
    text = read_text(path, MOST_BYTES, "a design file (TOML)")
    return LoadedDesign(parse_toml(text, str(path)), str(source), text=text)


@_in_our_words
def designs() -> list[str]:
    """Names that `load` takes."""
    return names()


@_in_our_words
def new(source: str = DEFAULT_DESIGN, name: str = "my-sensor") -> LoadedDesign:
    """A design of one's own, started from another; `save(FILE)` writes it."""
    from datetime import date

    text = started(source, name, date.today())
    return LoadedDesign(parse_toml(text, source), name, text=text)


@_in_our_words
def rectangle(x0: float, y0: float, x1: float, y1: float) -> Contour:
    """A rectangle with the corners (x0, y0) and (x1, y1), mm."""
    from tactcad.contour import rectangle

    sides = {"x0": x0, "y0": y0, "x1": x1, "y1": y1}
    for where, value in sides.items():
        if not _number(value):
            raise InputError(where, "not a number", value=value, legal="a length in mm")
    if not (x0 < x1 and y0 < y1):
        raise InputError("rectangle", "no area", value=tuple(sides.values()), legal="x0 < x1 and y0 < y1")
    return rectangle(x0, y0, x1, y1)


@_in_our_words
def circle(centre: Sequence[float], diameter: float) -> Contour:
    """A circle about its centre (x, y), mm."""
    from tactcad.contour import circle

    if not _place(centre, 2):
        raise InputError("centre", "not a place", value=centre, legal="(x, y) in mm")
    if not _number(diameter, 0):
        raise InputError("diameter", "not a size", value=diameter, legal="above 0 mm")
    x, y = centre
    return circle((x, y), diameter)


@_in_our_words
def design(target: str | Path, **options: Any) -> Reply:
    """From a target file to the design that feels it; options are those of `tactcad design`, as
    `within="1%"`.

    The result's records are the designs found: one, or none.
    """
    _path_of(target, "target")
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "found"
        whole = _command("design", target, out=out, **{"best": True} | options)
        file = out / "design.toml"
        text = file.read_text("utf-8") if file.exists() else ""
        found = (LoadedDesign(parse_toml(text, str(file)), whole["name"], text=text),) if text else ()
    met = {True: "met", False: "not met", None: "the best to be had, no half-width was asked"}[whole["met"]]
    return Reply(f"target {whole['name']}: {met}", found, whole)


@_in_our_words
def calibrate(file: str | Path, **options: Any) -> Reply:
    """Readings to stiffness and sensitivity, with intervals; options are those of `tactcad calibrate`, as
    `load_cell="57.04+-1"`."""
    whole = _command("calibrate", _path_of(file, "file"), **options)
    return Reply(f"calibration of {Path(file).name}", tuple(map(_estimates, whole["elements"])), whole)


@_in_our_words
def stiffness(file: str | Path, calibration: str | Path | Reply, **options: Any) -> Reply:
    """Grasp readings and a calibration (a file, or what `calibrate` gave) to the object's stiffness; options
    are those of `tactcad stiffness`, as `thickness=6`."""
    with tempfile.TemporaryDirectory() as folder:
        if isinstance(calibration, Reply):
            kept = Path(folder) / "calibration.json"
            kept.write_text(json.dumps(calibration.to_dict()), "utf-8")
            calibration = kept
        given = _path_of(calibration, "calibration")
        whole = _command("stiffness", _path_of(file, "file"), calibration=given, **options)
    return Reply(f"object of {Path(file).name}", tuple(map(_estimates, whole["samples"])), whole)


def _estimates(record: Mapping[str, Any]) -> dict[str, Any]:
    """A record with its estimates as columns: value, low, high."""
    flat: dict[str, Any] = {}
    for key, value in record.items():
        if isinstance(value, Mapping):
            flat |= {f"{key} {k}": v for k, v in value.items() if k in ESTIMATE}
        elif not isinstance(value, list):
            flat[key] = value
    return flat


def _command(command: str, *subject: object, **options: Any) -> dict[str, Any]:
    """A command's JSON. Raises InputError for an option that it does not take."""
    from importlib import import_module

    from tactcad.cli.main import parser_of

    words = [str(s) for s in subject] + ["--json"]
    for name, value in options.items():
        option = f"--{name.replace('_', '-')}"
        words += [option] if value is True else [] if value in (None, False) else [f"{option}={value}"]
    args = parser_of(command, raises=True).parse(words)
    said = io.StringIO()
    with redirect_stdout(said):
        import_module(f"tactcad.cli.{command}").run(args)
    whole: dict[str, Any] = json.loads(said.getvalue())
    return whole
