"""A chunk of a study's designs measured: what one task does, and the bytes it leaves in the store."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tactcad.export.inputs import Inputs, first_installed, inputs_of
from tactcad.mechanics.ladder import FINITE_ELEMENTS

from .closed_forms import closed_forms
from .designs_taken import Column, designs_taken, table_of
from .refused import Refused
from .study import BUILDS, CHECKS, EXPORT, HYPERCUBE, Study
from .whole_designs import measured_whole, numbers_of, texts_of

if TYPE_CHECKING:
    import pyarrow as pa

# Designs a task. Of closed forms as many as one vector call takes in some 100 ms, beside which a task's own
# time is small; of rules, a second's worth. All else takes long enough alone.
CLOSED_FORMS_A_TASK = 1 << 18
RULES_A_TASK = 16

ROOMS = ("", "design", "contour", "mechanics", "fem", "parts", "scenes", "assembly", "export", "lab", "sweep")
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
    """The rooms and libraries that what is measured depends on, as this process found them."""
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
    """Where the files of the design of that number go."""
    return folder / "exports" / f"{number:06}"


def measured(study: Study, start: int, stop: int, folder: Path) -> pa.Table:
    """What is found of designs `start` to `stop` (exclusive).

    Returns
    -------
    pyarrow.Table
        Results (empty where unknown), valid, and reason, null where all are valid.
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
    """Rows of the study's table: what was found, and what is known of designs from `start` without it."""
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
    """As Arrow's stream."""
    import pyarrow as pa

    sink = pa.BufferOutputStream()
    with pa.ipc.new_stream(sink, table.schema) as writer:
        writer.write_table(table)
    return sink.getvalue().to_pybytes()


def from_bytes(data: bytes) -> pa.Table:
    import pyarrow as pa

    return pa.ipc.open_stream(data).read_all()
