"""The table of taxels: a row a pad, units in the names; written as CSV and JSON, and read back from JSON."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields, replace
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from tactcad.design.family import family_of
from tactcad.design.files import as_csv, read_json
from tactcad.design.messages import InputError
from tactcad.design.tree import CommonTables
from tactcad.stacks.stack import SEED
from tactcad.stacks.variables import made
from tactcad.stacks.virtual_build import sensor

SCHEMA, VERSION = "tactcad-taxels-1", "1.1"  # the version counts up where columns are added
MOST_BYTES = 50_000_000
BUILDS = 1000  # virtual arrays: a standard deviation to 2 %
POSITIVE = ("stiffness_N_per_mm", "range_mm", "stop_gap_mm", "length_mm", "width_mm", "noise_mm")
PER_JOINT = ("sink_mm_per_rad", "shear_x_N_per_rad", "shear_y_N_per_rad")  # the first always, others or none
KINDS = {"int": int, "float": (int, float), "float | None": (int, float, type(None)), "str": str}


@dataclass(frozen=True)
class Taxel:
    """One pad in the mount's frame: place, quaternion and normal (outwards, its z axis) of the pad's frame.

    range       of the pad's middle, up to the stop
    signal, noise  over the sink of the pad's middle, and standard deviation of a reading: averaged, of a
                bridge; one, of a Hall chip; None for the other kind
    joints      by name, and the sink of the pad's middle over each one's motion: mm/rad, or 1000 mm/m of a
                slide
    shear       force on the pad along x and y of its frame over each joint's motion; empty if none is felt
    neighbours  numbers of the neighbouring pads
    variance, covariance  of K and of the pad's distance below the highest, over arrays as made
    """

    number: int
    designator: str
    kind: str
    x_mm: float
    y_mm: float
    z_mm: float
    q_w: float
    q_x: float
    q_y: float
    q_z: float
    normal_x: float
    normal_y: float
    normal_z: float
    length_mm: float
    width_mm: float
    area_mm2: float
    stiffness_N_per_mm: float
    signal_V_per_mm: float | None
    noise_V: float | None
    range_mm: float
    stop_gap_mm: float
    joints: tuple[str, ...]
    sink_mm_per_rad: tuple[float, ...]
    neighbours: tuple[int, ...]
    variance_stiffness_N2_per_mm2: float = 0.0
    variance_offset_mm2: float = 0.0
    covariance_stiffness_offset_N: float = 0.0
    signal_mT_per_mm: float | None = None
    noise_mT: float | None = None
    shear_x_N_per_rad: tuple[float, ...] = ()
    shear_y_N_per_rad: tuple[float, ...] = ()

    @property
    def noise_mm(self) -> float:
        """Noise of the pad's sink, mm. Raises InputError if the table has neither volts nor teslas."""
        for signal, noise in ((self.signal_V_per_mm, self.noise_V), (self.signal_mT_per_mm, self.noise_mT)):
            if signal and noise is not None:
                return noise / abs(signal)
        raise InputError(
            f"taxel {self.number}: signal and noise", "missing", legal="both in V, or both in mT"
        )


@dataclass(frozen=True)
class Taxels:
    """The table, and its design."""

    design: str
    revision: str
    taxels: tuple[Taxel, ...]

    def column(self, name: str) -> np.ndarray:
        """A field of every taxel."""
        return np.array([getattr(t, name) for t in self.taxels])


def as_made(design: CommonTables, taxels: Iterable[Taxel]) -> Taxels:
    """The table with the covariance of K (N/mm) and pad height (mm) over virtual builds."""
    stack, array = family_of(design).stack, sensor(design, [])
    arrays = stack.built(array.layout, made(array.variables, BUILDS, "normal", np.random.default_rng(SEED)))
    figures = stack.figures(arrays)
    both = np.stack([figures["stiffness"], 1e-3 * figures["pad_height_um"]])  # [2, array, element]
    known = np.isfinite(both).all(axis=(0, 2))  # arrays within the estimator's range
    rows = []
    for t, of in zip(taxels, np.moveaxis(both[:, known], 2, 0)):
        (K, cross), (_, offset) = np.cov(of).tolist()
        rows.append(
            replace(
                t,
                variance_stiffness_N2_per_mm2=K,
                variance_offset_mm2=offset,
                covariance_stiffness_offset_N=cross,
            )
        )
    return Taxels(design.design.name, design.design.revision, tuple(rows))


def json_bytes(taxels: Taxels, timestep: float) -> bytes:
    """With the schema, and the time step of the MJCF file, s."""
    about = {"schema": SCHEMA, "version": VERSION, "frame": "mount", "timestep_s": timestep}
    return (json.dumps(about | asdict(taxels), indent=1, allow_nan=False) + "\n").encode()


def csv_bytes(taxels: Taxels) -> bytes:
    """A row a taxel; lists are parted by blanks."""
    rows: list[list[object]] = [[*(f.name for f in fields(Taxel)), "schema", "version"]]
    for t in taxels.taxels:
        # None: empty
        cells = (" ".join(map(str, v)) if isinstance(v, tuple) else v for v in vars(t).values())
        rows.append([*cells, SCHEMA, VERSION])
    return as_csv(rows, "\n")


def read_taxels(path: str | Path) -> Taxels:
    """The table of an export's robot/taxels.json; `path` may be the folder.

    Raises InputError if it is no such file or another version's, or a taxel lacks a field, has no
    stiffness, no way to its stop, or the number or a joint of another one.
    """
    path = Path(path)
    path = path / "taxels.json" if path.is_dir() else path
    data = read_json(path, MOST_BYTES, "a table of taxels")
    schema = data.get("schema") if isinstance(data, dict) else None
    if schema != SCHEMA:
        raise InputError(f"{path}: schema", "not a table of taxels", value=schema, legal=SCHEMA)
    if data.get("version") != VERSION:
        raise InputError(
            f"{path}: version", "another one", value=data.get("version"), legal=f"{VERSION}: export again"
        )
    rows = data.get("taxels")
    if not isinstance(rows, list) or not rows:
        raise InputError(f"{path}: taxels", "no taxel", value=rows, legal="one at least")
    taxels = tuple(_read(f"{path}: taxels[{i}]", row) for i, row in enumerate(rows))
    each_once: dict[str, list[Any]] = {
        "number": [t.number for t in taxels],
        "joints": [j for t in taxels for j in t.joints],
    }
    for name, of in each_once.items():
        ((most, count),) = Counter(of).most_common(1)
        if count > 1:
            raise InputError(f"{path}: {name}", "of two taxels", value=most, legal="each once")
    return Taxels(str(data.get("design", "")), str(data.get("revision", "")), taxels)


def _read(where: str, row: Any) -> Taxel:
    if not isinstance(row, Mapping):
        raise InputError(where, "not a taxel", value=row, legal="an object with a field a column")
    values: dict[str, Any] = {}
    for f in fields(Taxel):
        value, kind = row.get(f.name), KINDS.get(str(f.type), list)
        if not isinstance(value, kind) or isinstance(value, bool):  # type: ignore[arg-type]
            raise InputError(
                f"{where}: {f.name}", "missing or of another kind", value=value, legal=str(f.type)
            )
        values[f.name] = tuple(value) if isinstance(value, list) else value
    for name in PER_JOINT:
        numbers, many = values[name], len(values["joints"])
        short = len(numbers) != many and (numbers or name == PER_JOINT[0])
        if short or not many or any(isinstance(v, bool) or not isinstance(v, int | float) for v in numbers):
            raise InputError(f"{where}: {name}", "out of range", value=numbers, legal="one for each joint")
    taxel = Taxel(**values)
    require_positive(where, {name: getattr(taxel, name) for name in POSITIVE})
    require_positive(where, {PER_JOINT[0]: max(taxel.sink_mm_per_rad)})
    for name in ("variance_stiffness_N2_per_mm2", "variance_offset_mm2"):
        if not getattr(taxel, name) >= 0:
            raise InputError(f"{where}: {name}", "below zero", value=getattr(taxel, name), legal="0 or more")
    return taxel


def require_positive(where: str, values: Mapping[str, float]) -> None:
    """Raise InputError for the first value that is not above zero and finite."""
    for field, value in values.items():
        if not (isfinite(value) and value > 0):
            raise InputError(f"{where}: {field}", "out of range", value=value, legal="above 0")
