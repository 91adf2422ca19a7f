"""Table 2: which reference stiffness do the measured ratios R support?

Equation (2) with one parameter freed at a time: K_r; a common factor on R; a scale on K_obj; and two at once.
ln R is fitted. Readings share elements (rows) and samples (columns), so standard errors are two-way jackknife
ones, rows and columns added: wider than for 48 independent readings, as they should be.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from tactcad.lab.regression import t_quantile
from tactcad.mechanics import lumped
from tactcad.paper.published import Published

# name -> (parameters' names, starting values, R(parameters, K_r, K_m, x))
Formula = Callable[[np.ndarray, float, np.ndarray, np.ndarray], np.ndarray]
MODELS: dict[str, tuple[tuple[str, ...], tuple[float, ...], Formula]] = {
    "as printed": ((), (), lambda p, r, m, x: lumped.deflection_ratio(r, m, x)),
    "K_r free": (("K_r",), (30.0,), lambda p, r, m, x: lumped.deflection_ratio(p[0], m, x)),
    "R times a factor": (("factor",), (0.7,), lambda p, r, m, x: p[0] * lumped.deflection_ratio(r, m, x)),
    "K_obj times a factor": (("scale",), (2.0,), lambda p, r, m, x: lumped.deflection_ratio(r, m, p[0] * x)),
    "K_r free, K_obj times a factor": (
        ("K_r", "scale"),
        (30.0, 1.5),
        lambda p, r, m, x: lumped.deflection_ratio(p[0], m, p[1] * x),
    ),
    "K_r free, R times a factor": (
        ("K_r", "factor"),
        (60.0, 0.7),
        lambda p, r, m, x: p[1] * lumped.deflection_ratio(p[0], m, x),
    ),
}
UNITS = {"K_r": "N/mm", "factor": "1", "scale": "1"}


@dataclass(frozen=True)
class Fit:
    """One model on some rows: parameters with 95 % intervals, rms of ln R, mean of ln(measured/model)."""

    model: str
    names: tuple[str, ...]
    value: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    rms: float
    bias: float
    left_out_rms: float  # rms at rows that the fit has not seen


@dataclass(frozen=True)
class Table2Study:
    """All of section 5. Matrices are [measuring element, sample]."""

    measuring: np.ndarray
    object_printed: np.ndarray
    object_implied: np.ndarray  # mean of K_m/printed ratio by column
    object_implied_range: np.ndarray  # [2, column]
    implied_rounding: np.ndarray  # relative, by column: what rounding of the print allows
    ratio: np.ndarray
    ratio_printed_model: np.ndarray  # equation (2) with the printed stiffnesses
    reference_printed: float
    reference_by_reading: np.ndarray  # K_r that each reading implies
    fits: tuple[Fit, ...]
    without_stiffest: tuple[Fit, ...]
    with_implied_object: Fit  # K_r free with the implied K_obj

    def fit(self, model: str) -> Fit:
        return next(f for f in self.fits if f.model == model)

    @property
    def supported(self) -> Fit:
        return self.fit("K_r free")


def study(data: Published) -> Table2Study:
    """Every model on all rows and without the stiffest measuring element."""
    t = data.table2
    k, x, R = t.measuring_stiffness.value, t.object_stiffness.value, t.ratio.value
    K_r = data.figure["reference_stiffness"]
    implied = k[:, None] / t.printed_ratio.value
    rounding = (
        t.printed_ratio.half_step / t.printed_ratio.value + (t.measuring_stiffness.half_step / k)[:, None]
    ).max(0)
    rounding = rounding + t.object_stiffness.half_step / x
    rest = np.arange(len(k)) != np.argmax(k)
    return Table2Study(
        k,
        x,
        implied.mean(0),
        np.array([implied.min(0), implied.max(0)]),
        rounding,
        R,
        lumped.deflection_ratio(K_r, k[:, None], x[None, :]),
        K_r,
        R * (k[:, None] + x) - x,
        tuple(_fit(name, K_r, k, x, R) for name in MODELS),
        tuple(_fit(name, K_r, k[rest], x, R[rest]) for name in MODELS),
        _fit("K_r free", K_r, k, implied.mean(0), R),
    )


def _fit(model: str, K_r: float, k: np.ndarray, x: np.ndarray, R: np.ndarray) -> Fit:
    names, start, formula = MODELS[model]
    p = solve(model, K_r, k, x, R)
    error = np.log(R / formula(p, K_r, k[:, None], x[None, :]))
    rows = [np.arange(len(k)) != i for i in range(len(k))]
    columns = [np.arange(len(x)) != j for j in range(len(x))]
    seen_not = []
    by_row = []
    for keep in rows:
        q = solve(model, K_r, k[keep], x, R[keep])
        by_row.append(np.log(q))
        seen_not.append(np.log(R[~keep] / formula(q, K_r, k[~keep, None], x[None, :])))
    by_column = [np.log(solve(model, K_r, k, x[keep], R[:, keep])) for keep in columns]
    se = (_jackknife(by_row) + _jackknife(by_column)) ** 0.5
    half = t_quantile(0.95, min(len(k), len(x)) - 1) * se
    return Fit(
        model,
        names,
        tuple(p.tolist()),
        tuple((p * np.exp(-half)).tolist()),
        tuple((p * np.exp(half)).tolist()),
        float((error**2).mean() ** 0.5),
        float(error.mean()),
        float((np.array(seen_not) ** 2).mean() ** 0.5),
    )


def solve(model: str, K_r: float, k: np.ndarray, x: np.ndarray, R: np.ndarray) -> np.ndarray:
    """Least squares of ln R over the model's parameters, kept positive by their logarithms."""
    names, start, formula = MODELS[model]
    if not names:
        return np.array([])

    def error(log_p: np.ndarray) -> np.ndarray:
        return np.log(R / formula(np.exp(log_p), K_r, k[:, None], x[None, :])).ravel()

    bounds = (np.log(1e-3), np.log(1e5))
    return np.exp(least_squares(error, np.log(start), bounds=bounds, x_scale=0.1).x)


def _jackknife(estimates: list[np.ndarray]) -> np.ndarray:
    """Variance of an estimate by leaving out one group at a time."""
    e = np.array(estimates)
    n = len(e)
    return (n - 1) / n * ((e - e.mean(0)) ** 2).sum(0)
