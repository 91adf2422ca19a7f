"""The designs of a study by their index: every process takes the same ones, chunk by chunk.

Drawn designs are any stretch of scipy's scrambled Sobol sequence, without drawing the earlier ones. A point
is linear over GF(2) in the bits of its place: with x_i its coordinates as whole numbers of 2^-30,

    x_i = x_0 ^ XOR of (x_(2^k) ^ x_0) over the bits k that are set in i

so the points at 0 and at powers of two, drawn once by scipy, hold all others. scipy itself goes to a place
step by step: for every chunk a sequence would be drawn from its beginning, and every process would load
scipy.stats, which takes as long as a million closed forms.

A field of a design is named by its path, as in messages: "element.hinge_thickness",
"element.override.3.arm_height", "array.row_arms[0][2]".
"""

from __future__ import annotations

import dataclasses
import re
import warnings
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tactcad.design.family import family_of
from tactcad.design.fields import NumberRows, Numbers, Spec
from tactcad.design.load import paths
from tactcad.design.tree import CommonTables, Hinge

if TYPE_CHECKING:
    from .study import Study, Varied

_PLACE = re.compile(r"(?P<field>[^\[\]]+)(?P<places>(?:\[(?:0|[1-9][0-9]{0,3})\])*)")
_OVERRIDE = re.compile(r"override\.(?P<number>[1-9][0-9]{0,3})\.(?P<name>\w+)")


def spec_at(design: CommonTables, path: str) -> Spec | None:
    """Spec of the field at that path; None if there is no such field, or no such place in its list."""
    found = _PLACE.fullmatch(path)
    if not found:
        return None
    field, places = found["field"], _places(path)
    spec = _spec(design, field)
    value: Any = paths(design).get(field) if places else None
    for place in places:
        if not isinstance(spec, (NumberRows, Numbers)) or value is None or place >= len(value):
            return None
        spec, value = spec.row if isinstance(spec, NumberRows) else spec.item, value[place]
    return spec


def value_at(design: CommonTables, path: str) -> Any:
    """The design's own value there, None if it gives none."""
    field = path.partition("[")[0]
    known = paths(design)
    if field not in known and field.startswith("element.override."):
        field = f"element.{field.rpartition('.')[2]}"  # what an override leaves out is [element]'s
    value: Any = known.get(field)
    for place in _places(path):
        value = value[place]
    return value


def placed(table: dict[str, Any], design: CommonTables, path: str, value: Any) -> dict[str, Any]:
    """A copy of a design's table with that value at the path; the rest is shared with the original.

    Parameters
    ----------
    table
        As TOML gives it.
    design
        The design read from it, for lists that it leaves to their default.
    path, value
        As `spec_at` knows it.
    """
    field, places = path.partition("[")[0], _places(path)
    head, *names = field.split(".", 2 if field.startswith("stop.gaps.") else -1)
    out = dict(table)
    node = out[head] = dict(out.get(head, {}))
    for name in names[:-1]:
        node[name] = dict(node.get(name, {}))
        node = node[name]
    whole = node.get(names[-1], paths(design).get(field)) if places else None
    node[names[-1]] = _replaced(whole, places, value) if places else value
    return out


def with_value(design: CommonTables, path: str, value: Any) -> CommonTables:
    """A copy of a design with that value at the path, unchecked: for arithmetic it may be an array, and then
    it is many designs. The stop's own gaps stay as they are."""
    section, _, name = path.partition(".")
    field, places, table = name.partition("[")[0], _places(path), getattr(design, section)
    if own := _OVERRIDE.fullmatch(field):
        number = int(own["number"])
        changed = replace(table.override.get(number, Hinge()), **{own["name"]: value})
        return replace(design, **{section: replace(table, override=table.override | {number: changed})})
    if "." in field:
        return design
    new = _replaced(getattr(table, field), places, value) if places else value
    return replace(design, **{section: replace(table, **{field: new})})


def _spec(design: CommonTables, field: str) -> Spec | None:
    section, _, name = field.partition(".")
    kind = family_of(design).tables.get(section)
    if kind is None:
        return None
    if section == "element" and (override := _OVERRIDE.fullmatch(name)):
        kind, name = Hinge, override["name"]
    if section == "stop" and re.fullmatch(r"gaps\.[0-9.]+", name):
        name = "gaps"
    elif (section, name) == ("stop", "gaps"):
        return None
    known = {f.name: f for f in dataclasses.fields(kind)}.get(name)
    return known.metadata.get("spec") if known else None


def _places(path: str) -> list[int]:
    return [int(place) for place in re.findall(r"\[([0-9]+)\]", path)]


def _replaced(whole: Any, places: list[int], value: Any) -> list:
    """A copy of a list, or of a list of lists, with the value at its place."""
    out = list(whole)
    first, *rest = places
    out[first] = _replaced(out[first], rest, value) if rest else value
    return out


GRID, LIST, HYPERCUBE, SOBOL = "grid", "list", "latin-hypercube", "sobol"
BITS = 30  # scipy's own: a place is below 2^30
Points = NDArray[np.uint32]
Column = NDArray[Any]  # one field's values: floats, or objects if they are no numbers


def designs_taken(study: Study, start: int, stop: int) -> dict[str, Column]:
    """Values in designs `start` to `stop` (exclusive), by the path of each varied field."""
    if study.study.sampling in (GRID, LIST):
        return _counted(study, np.arange(start, stop))
    shares = _shares(study, start, stop)
    return {path: _drawn(study, path, one, share) for (path, one), share in zip(study.vary.items(), shares.T)}


def prepared(study: Study) -> None:
    """Data for drawing all designs, made once and sent along with the study."""
    if study.study.sampling == SOBOL:
        _ = study.sobol


def table_of(study: Study, columns: dict[str, Column], i: int) -> dict[str, Any]:
    """The table of the i-th of these designs, as TOML would give it."""
    table = study.base
    for path, column in columns.items():
        value = column[i]
        table = placed(table, study.design, path, value.item() if isinstance(value, np.generic) else value)
    return table


def _counted(study: Study, index: NDArray[np.int64]) -> dict[str, Column]:
    """In a grid the last field runs fastest; in a list all run together."""
    columns, left = {}, index
    for path, one in reversed(study.vary.items()):
        low, high = one.range or (0.0, 0.0)
        values = np.linspace(low, high, one.steps or 2) if one.range else _column(one.values or ())
        columns[path] = values[left % len(values)]
        left = left // len(values) if study.study.sampling == GRID else left
    return {path: columns[path] for path in study.vary}


def _column(values: tuple[Any, ...]) -> Column:
    if all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in values):
        return np.array(values, float)
    column = np.empty(len(values), object)
    column[:] = values
    return column


def _drawn(study: Study, path: str, one: Varied, share: NDArray[np.float64]) -> Column:
    """Values of which those shares of the whole lie below; of a list, each is as likely."""
    if one.values is not None:
        return _column(one.values)[np.minimum((share * len(one.values)).astype(int), len(one.values) - 1)]
    if one.range is not None:
        low, high = one.range
        return low + (high - low) * share
    from scipy.special import ndtri

    from tactcad.stacks.variables import within_limits

    return value_at(study.design, path) + (one.normal or 0.0) * within_limits(ndtri(share), "normal")


def _shares(study: Study, start: int, stop: int) -> NDArray[np.float64]:
    """Points of the unit cube, one column a field."""
    if study.study.sampling == SOBOL:
        return stretch(study.sobol, start, stop)
    return _hypercube(len(study.vary), study.count, study.study.seed)[start:stop]


@lru_cache(maxsize=1)
def _hypercube(fields: int, count: int, seed: int) -> NDArray[np.float64]:
    from scipy.stats import qmc

    return qmc.LatinHypercube(fields, rng=seed).random(count)


def points_at_powers(fields: int, count: int, seed: int) -> Points:
    """scipy's points at 0, 1, 2, 4, ... below `count`, one row each, a column a field, in units of 2^-30."""
    from scipy.stats import qmc

    sampler = qmc.Sobol(fields, bits=BITS, rng=seed)
    rows = []
    with warnings.catch_warnings():  # it wants powers of two; a study of any size is spread well enough
        warnings.simplefilter("ignore", UserWarning)
        for place in (0, *(1 << k for k in range((count - 1).bit_length()))):
            if ahead := place - sampler.num_generated:
                sampler.fast_forward(ahead)
            rows.append(sampler.random(1)[0])
    return (np.array(rows) * (1 << BITS)).astype(np.uint32)


def stretch(at_powers: Points, start: int, stop: int) -> NDArray[np.float64]:
    """Points of the unit cube at places `start` to `stop` (exclusive)."""
    first, directions = at_powers[0], at_powers[1:] ^ at_powers[0]
    bits = (stop - start - 1).bit_length()
    low = np.zeros((1, len(first)), np.uint32)
    for direction in directions[:bits]:
        low = np.concatenate([low, low ^ direction])
    blocks = []
    for block in range(start >> bits, ((stop - 1) >> bits) + 1):
        high = [d for k, d in enumerate(directions[bits:]) if block >> k & 1]
        blocks.append(low ^ np.bitwise_xor.reduce([first, *high]))
    skipped = start & ((1 << bits) - 1)
    return np.concatenate(blocks)[skipped : skipped + stop - start] * 2.0**-BITS
