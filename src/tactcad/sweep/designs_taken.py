"""The designs of a study by their index: every process takes the same ones, chunk by chunk."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import sobol
from .field_paths import placed, value_at
from .study import GRID, LIST, SOBOL, Study, Varied

Column = NDArray[Any]  # one field's values: floats, or objects where it is no number


def designs_taken(study: Study, start: int, stop: int) -> dict[str, Column]:
    """By the path of each varied field, its values in designs `start` to `stop` (exclusive)."""
    if study.study.sampling in (GRID, LIST):
        return _counted(study, np.arange(start, stop))
    shares = _shares(study, start, stop)
    return {path: _drawn(study, path, one, share) for (path, one), share in zip(study.vary.items(), shares.T)}


def prepared(study: Study) -> None:
    """What all designs are drawn from, made once; it goes with the study wherever that is sent."""
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

    from tactcad.assembly.virtual_shop import within_limits

    return value_at(study.design, path) + (one.normal or 0.0) * within_limits(ndtri(share), "normal")


def _shares(study: Study, start: int, stop: int) -> NDArray[np.float64]:
    """Points of the unit cube, one column a field."""
    if study.study.sampling == SOBOL:
        return sobol.stretch(study.sobol, start, stop)
    return _hypercube(len(study.vary), study.count, study.study.seed)[start:stop]


@lru_cache(maxsize=1)
def _hypercube(fields: int, count: int, seed: int) -> NDArray[np.float64]:
    from scipy.stats import qmc

    return qmc.LatinHypercube(fields, rng=seed).random(count)
