"""A chunk of a study's designs measured, by closed forms together or one whole design at a time; and the
bytes that a task leaves in the store."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tactcad.design.family import taken_as
from tactcad.design.load import from_table
from tactcad.design.materials import differences
from tactcad.design.messages import CheckFailure, InputError
from tactcad.design.tree import CommonTables, Design
from tactcad.export.inputs import Inputs, first_installed, inputs_of
from tactcad.mechanics import ladder, strain, strength
from tactcad.mechanics.accuracy import expected_error_of
from tactcad.mechanics.ladder import FINITE_ELEMENTS
from tactcad.mechanics.section import HingeSection
from tactcad.parts.array.hinge_section import element_section
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import refuse_broken

from .designs_taken import Column, designs_taken, table_of, with_value
from .study import BUILDS, CHECKS, ESTIMATE, EXPORT, HYPERCUBE, STRENGTH, Study, estimated

if TYPE_CHECKING:
    import pyarrow as pa

# Designs a task. For closed forms the number of a vector call of some 100 ms, much longer than a task's
# overhead; for rules, of a second. All else takes long enough alone.
CLOSED_FORMS_A_TASK = 1 << 18
RULES_A_TASK = 16

ROOMS = ("", "design", "contour", "mechanics", "fem", "parts", "scenes", "stacks", "export", "lab", "sweep")
LIBRARIES = ("numpy", "pyarrow", "scikit-fem", "scipy")
WITH_SOLIDS = ("solids", "checks", "drawing")
KERNEL = (
    "build123d",
    first_installed("cadquery-ocp", "cadquery-ocp-novtk"),
    "ezdxf",
    "manifold3d",
    "trimesh",
)


@cache
def made_by(what: tuple[str, ...]) -> Inputs:
    """The rooms and libraries that the results depend on, as found by this process."""
    solids = bool({CHECKS, EXPORT} & set(what))
    return inputs_of({}, ROOMS + WITH_SOLIDS * solids, LIBRARIES + KERNEL * solids)


def designs_a_task(study: Study) -> int:
    if not study.measure.whole_designs:
        return CLOSED_FORMS_A_TASK
    return 1 if {*FINITE_ELEMENTS, BUILDS, CHECKS, EXPORT} & set(study.measure.what) else RULES_A_TASK


def loaded_first(study: Study) -> list[str]:
    """Modules that its tasks need, but for the CAD kernel and what needs it."""
    drawn = ["scipy.stats.qmc"] * (study.study.sampling == HYPERCUBE)
    solved = ["tactcad.lab.array_estimate"] * bool(set(FINITE_ELEMENTS) & set(study.measure.what))
    return ["pyarrow", "tactcad.sweep.on_dask", *drawn, *solved]


def export_folder(folder: Path, number: int) -> Path:
    """Folder for the files of the design of that number."""
    return folder / "exports" / f"{number:06}"


def measured(study: Study, start: int, stop: int, folder: Path) -> pa.Table:
    """Results of designs `start` to `stop` (exclusive).

    Returns
    -------
    pyarrow.Table
        Results (empty if unknown), valid, and reason, null where all are valid.
    """
    import pyarrow as pa

    columns = designs_taken(study, start, stop)
    count = stop - start
    refused = Refused(count)
    numbers = {name: np.full(count, np.nan) for name in numbers_of(study)}
    texts = {name: np.full(count, "", object) for name in texts_of(study)}
    if study.measure.whole_designs:
        for i in range(count):
            table = table_of(study, columns, i)
            found, why = measured_whole(study, table, export_folder(folder, start + i + 1))
            refused.add(np.array([i]), why)
            for name, value in found.items():
                (texts if name in texts else numbers)[name][i] = value
    closed_forms(study, columns, refused, numbers)
    table = {name: pa.array(column, from_pandas=True) for name, column in numbers.items()}
    table |= {name: pa.array(column, pa.string()) for name, column in texts.items()}
    table["valid"] = pa.array(refused.valid)
    table["reason"] = pa.nulls(count) if refused.valid.all() else pa.array(refused.reason, pa.string())
    return pa.table(table)


def as_rows(study: Study, start: int, found: pa.Table) -> pa.Table:
    """Rows of the study's table: the results, and the known columns of designs from `start` on."""
    import pyarrow as pa

    count = found.num_rows
    fields = designs_taken(study, start, start + count)
    table = {"number": pa.array(np.arange(start + 1, start + count + 1))}
    table |= {path: _field(column) for path, column in fields.items()}
    table["rung"] = pa.repeat(" ".join(study.measure.rungs), count)
    table |= zip(found.column_names, found.columns)
    if pa.types.is_null(found["reason"].type):
        table["reason"] = pa.repeat("", count)
    return pa.table(table)


def _field(column: Column) -> pa.Array:
    """Numbers as they are, words too; lists as JSON."""
    import pyarrow as pa

    if column.dtype != object:
        return pa.array(column)
    return pa.array([v if isinstance(v, str) else json.dumps(v) for v in column], pa.string())


def as_bytes(table: pa.Table) -> bytes:
    """The table as an Arrow stream."""
    import pyarrow as pa

    sink = pa.BufferOutputStream()
    with pa.ipc.new_stream(sink, table.schema) as writer:
        writer.write_table(table)
    return sink.getvalue().to_pybytes()


def from_bytes(data: bytes) -> pa.Table:
    import pyarrow as pa

    return pa.ipc.open_stream(data).read_all()


# Columns besides those of the elements, by measure: numbers, then texts.
NUMBERS = {BUILDS: ("yield",), CHECKS: ("checks_failed", "checks_flagged"), EXPORT: ("files",)}
TEXTS = {BUILDS: ("most_missed",), CHECKS: ("first_failure",), EXPORT: ("manifest_sha256",)}


def numbers_of(study: Study) -> list[str]:
    """Columns of numbers that a study has, in the order of its table."""
    elements = [
        name for rung in study.measure.rungs for n in study.elements for name in names_of(study, rung, n)
    ]
    if ESTIMATE in study.measure.what:
        elements += [f"{ESTIMATE}.E{n}.{name}" for n in study.elements for name in study.figures]
    return elements + [
        name for what, names in NUMBERS.items() if what in study.measure.what for name in names
    ]


def texts_of(study: Study) -> list[str]:
    """Columns of text that a study has."""
    return [name for what, names in TEXTS.items() if what in study.measure.what for name in names]


def measured_whole(study: Study, table: dict[str, Any], folder: Path) -> tuple[dict[str, Any], str]:
    """Results of one design, by column, and the reason of its refusal ("" if there was none).

    Parameters
    ----------
    study
        The study.
    table
        The design, as TOML would give it.
    folder
        Where an export goes.

    Raises
    ------
    InputError
        The export's folder cannot be written, which is no fault of the design.
    """
    found: dict[str, Any] = {}
    try:
        design = from_table(table)
        refuse_broken(design)
        for rung in study.measure.rungs:
            if rung in FINITE_ELEMENTS:
                found |= _by_elements(study, design, rung)
        for what, measure in ((ESTIMATE, _estimate), (BUILDS, _builds), (CHECKS, _checks)):
            if what in study.measure.what:
                found |= measure(study, design)
    except (InputError, CheckFailure) as refusal:
        return found, str(refusal)
    try:
        if EXPORT in study.measure.what:
            found |= _export(design, folder)
    except CheckFailure as refusal:
        return found, str(refusal)
    return found, ""


def _by_elements(study: Study, design: CommonTables, rung: str) -> dict[str, float]:
    from tactcad.lab.array_estimate import estimate

    layout = Layout(taken_as(design, Design, "measure.what: a rung"))
    if max(study.elements) > len(layout.elements):
        raise CheckFailure(f"the design has no element {max(study.elements)}")
    wanted = {e.number: e for e in estimate(layout, rung, numbers=study.elements)}
    found: dict[str, float] = {}
    for number in study.elements:
        names = names_of(study, rung, number)
        values = [getattr(wanted[number], name.rpartition(".")[2]) for name in names]
        found |= dict(zip(names, (np.nan if v is None else v for v in values)))
    return found


def _estimate(study: Study, design: CommonTables) -> dict[str, float]:
    known = {row.number: row for row in estimated(design)}
    return {
        f"{ESTIMATE}.E{n}.{name}": float(getattr(known[n], name))
        for n in study.elements
        for name in study.figures
        if n in known and getattr(known[n], name) is not None
    }


def _builds(study: Study, design: CommonTables) -> dict[str, Any]:
    from tactcad.stacks.virtual_build import sensor

    builds = sensor(design).built(study.measure.arrays)
    failures = builds.failures[builds.worse]
    worst = max(failures, key=lambda name: failures[name]) if failures else ""
    return {"yield": builds.share, "most_missed": worst}


def _checks(_: Study, design: CommonTables) -> dict[str, Any]:
    from tactcad.checks.run import run_checks
    from tactcad.scenes import scene_names

    report = run_checks(design, scene_names(design))
    flags = [f for f in report.findings if f.severity == "flag"]
    failed = report.failures
    return {
        "checks_failed": len(failed),
        "checks_flagged": len(flags),
        "first_failure": str(failed[0]) if failed else "",
    }


def _export(design: CommonTables, folder: Path) -> dict[str, Any]:
    from tactcad.export.formats import ExportOptions
    from tactcad.export.manifest import sha256_of
    from tactcad.export.pipeline import Quiet, export
    from tactcad.scenes import scene_names

    folder.parent.mkdir(parents=True, exist_ok=True)
    done = export(design, ExportOptions(tuple(scene_names(design))), folder, Quiet())
    manifest = (folder / "manifest.json").read_bytes()
    return {"files": done.files, "manifest_sha256": sha256_of(manifest)}


Floats = NDArray[np.float64]

STIFFNESS = ("stiffness", "expected_error")  # N/mm; relative, at most
FORCES = ("yield_force", "rated_force", "rated_deflection")  # N, N, mm


# Designs of a chunk: all, as views instead of copies, or those of an index.
Rows = slice | NDArray[np.int64]
ALL = slice(None)


class Refused:
    """Mask of the `valid` ones of `count` designs, and `reason` of the others ("" for a valid one)."""

    def __init__(self, count: int) -> None:
        self.valid = np.ones(count, bool)
        self._reason: NDArray[Any] | None = None  # made only when one is refused, which is rare

    @property
    def reason(self) -> NDArray[Any]:
        if self._reason is None:
            self._reason = np.full(len(self.valid), "", object)
        return self._reason

    def add(self, rows: Rows, why: NDArray[Any] | str) -> None:
        """Refuse those of the rows that are not refused yet and have a reason that is not ""."""
        index = np.arange(len(self.valid))[rows]
        first = self.valid[index]
        self.reason[index[first]] = np.broadcast_to(why, len(index))[first]
        self.valid[index] = self.reason[index] == ""

    def left(self, rows: Rows) -> Rows:
        """Those of the rows that are not refused."""
        if isinstance(rows, slice) and self.valid.all():
            return rows
        index = np.arange(len(self.valid))[rows]
        return index[self.valid[index]]


def names_of(study: Study, rung: str, number: int) -> list[str]:
    """Columns of one element's results by one rung."""
    return [f"{rung}.E{number}.{name}" for name in STIFFNESS + FORCES * (STRENGTH in study.measure.what)]


def closed_forms(
    study: Study, columns: dict[str, Column], refused: Refused, results: Mapping[str, Floats]
) -> None:
    """Fill in what closed forms say of these designs.

    Parameters
    ----------
    study
        The study.
    columns
        The designs.
    refused
        Mask of those not to be measured; those refused by closed forms are added.
    results
        By column, NaN if nothing is known: filled in.
    """
    rungs = [rung for rung in study.measure.rungs if rung in ladder.CLOSED_FORMS]
    if not rungs:
        return
    for rows, number, d, section in sections(study, columns, refused):
        for rung in rungs:
            result = ladder.evaluate(section, rung)
            all_valid = result.valid.all()
            if not all_valid:
                said = [why and f"{rung} E{number}: {why}" for why in result.reason.flat]
                refused.add(rows, np.array(said, object))
            values = [result.stiffness, expected_error_of(section, rung)]
            if STRENGTH in study.measure.what:
                values += _forces(d, section, rung, result)
            for name, column in zip(names_of(study, rung, number), values):
                results[name][rows] = column if all_valid else np.where(result.valid, column, np.nan)


def sections(
    study: Study, columns: dict[str, Column], refused: Refused
) -> Iterator[tuple[Rows, int, Design, HingeSection]]:
    """Every element that is measured, of many designs at once: their rows, its number, the designs, and its
    section. Designs without it are refused, as `alike` refuses."""
    for rows, many in alike(study, columns, refused):
        for number in study.elements:
            if number > len(many.elements):
                refused.add(rows, f"the design has no element {number}")
            else:
                yield rows, number, many.design, element_section(many, many.elements[number - 1])


def _forces(d: Design, section: HingeSection, rung: str, result: ladder.Result) -> list[Floats]:
    """In the order of FORCES, each over all designs; NaN if out of the rung's range."""
    per_newton = np.full(section.shape, np.nan)
    if result.valid.any():
        per_newton[result.valid] = strain.leaf_stress(section.rows(result.valid.reshape(-1)), 1.0, rung)
    at_yield = d.material.yield_strength / per_newton
    deflection = strength.rated_deflection(at_yield, result.stiffness, d.rating)
    return [at_yield, strength.rated_force(at_yield, d.rating), deflection]


def alike(study: Study, columns: dict[str, Column], refused: Refused) -> Iterator[tuple[Rows, Layout]]:
    """Rows that differ in numbers only, and the layout of all of them at once. Designs that cannot be read
    are refused."""
    numbers = {path: column for path, column in columns.items() if column.dtype != object}
    others = {path: column for path, column in columns.items() if column.dtype == object}
    alike: dict[str, list[int]] = {}
    for i, row in enumerate(zip(*others.values())):
        alike.setdefault(json.dumps(row), []).append(i)
    groups: list[Rows] = [np.array(rows) for rows in alike.values()] if others else [ALL]
    for rows in groups:
        try:
            first = {path: column[rows] for path, column in others.items()}
            design = from_table(table_of(study, first, 0)) if others else study.design
        except InputError as error:
            refused.add(rows, str(error))
            continue
        material = {path: column[rows] for path, column in numbers.items() if path.startswith("material.")}
        if material:
            refused.add(rows, _misnamed(design, material))
        rows = refused.left(rows)
        if refused.valid[rows].any():
            for path, column in numbers.items():
                design = with_value(design, path, column[rows])
            yield rows, Layout(taken_as(design, Design, "measure.what: a rung"))


def _misnamed(design: CommonTables, material: dict[str, Floats]) -> Column:
    """Why these values may not bear the material's name, as when their file is read; "" if they may."""
    why = []
    for values in zip(*material.values()):
        own = {path.partition(".")[2]: float(value) for path, value in zip(material, values)}
        try:
            differences(design.material.alloy, vars(design.material) | own, design.origin)
            why.append("")
        except InputError as error:
            why.append(str(error))
    return np.array(why, object)
