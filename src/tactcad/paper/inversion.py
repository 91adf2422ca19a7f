"""Equation (3) applied to Table 2: K_obj from R, its error, and the error that the condition number
predicts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.lab.regression import t_quantile
from tactcad.mechanics import fieller, lumped
from tactcad.paper.reference_stiffness import Table2Study, solve


@dataclass(frozen=True)
class Inverted:
    """K_obj (N/mm) [measuring element, sample] with one reference stiffness; low, high by Fieller, 95 %."""

    reference: float
    estimate: np.ndarray
    low: np.ndarray
    high: np.ndarray
    bounded: np.ndarray
    condition: np.ndarray  # of K_obj in R, at the sample's own K_obj

    def error(self, x: np.ndarray) -> np.ndarray:
        """estimate/K_obj - 1"""
        return self.estimate / x[None, :] - 1

    def physical(self) -> np.ndarray:
        """Where the estimate is positive and finite."""
        return np.isfinite(self.estimate) & (self.estimate > 0)

    def holds(self, x: np.ndarray) -> np.ndarray:
        """Whether the interval, cut to positive values, contains the sample's K_obj."""
        outside = (x <= self.low) | (x >= self.high) | np.isinf(self.low)  # two rays, or every value
        return np.where(self.bounded, (self.low <= x) & (x <= self.high), outside)


@dataclass(frozen=True)
class Inversion:
    measuring: np.ndarray
    object_stiffness: np.ndarray
    ratio_error: float  # standard deviation of ln R, from the spread about equation (2)
    printed: Inverted
    supported: Inverted
    left_out: np.ndarray  # K_obj, N/mm, with the K_r that all rows and columns but the reading's own support
    at_ends: (
        np.ndarray
    )  # K_obj, N/mm, with either end of the supported K_r's interval, [end, element, sample]
    rank_correlation: float  # of |condition| and |error| with the supported stiffness (Spearman)


def invert(study: Table2Study) -> Inversion:
    """With the printed reference stiffness and with the one that Table 2 supports; the same noise of R
    for both.
    """
    spread = study.supported.rms
    fit = study.supported
    half = np.log(fit.high[0] / fit.value[0]) / t_quantile(0.95, min(study.ratio.shape) - 1)
    printed = _invert(study, study.reference_printed, 0.0, spread)
    supported = _invert(study, fit.value[0], fit.value[0] * half, spread)
    error = np.abs(np.log(np.where(supported.physical(), supported.estimate, np.nan) / study.object_printed))
    return Inversion(
        study.measuring,
        study.object_printed,
        spread,
        printed,
        supported,
        _left_out(study),
        np.array([_estimate(study, K_r) for K_r in (fit.low[0], fit.high[0])]),
        _spearman(np.abs(supported.condition), np.where(np.isnan(error), np.inf, error)),
    )


def _left_out(study: Table2Study) -> np.ndarray:
    """K_obj by a K_r that is fitted without the reading's own element and sample."""
    k, x, R = study.measuring, study.object_printed, study.ratio
    K_obj = np.empty_like(R)
    for i, j in np.ndindex(R.shape):
        rows, columns = np.arange(len(k)) != i, np.arange(len(x)) != j
        K_r = solve("K_r free", study.reference_printed, k[rows], x[columns], R[np.ix_(rows, columns)])[0]
        K_obj[i, j] = lumped.object_stiffness(K_r, k[i], R[i, j])
    return K_obj


def _estimate(study: Table2Study, K_r: float) -> np.ndarray:
    return lumped.object_stiffness(K_r, study.measuring[:, None], study.ratio)


def _invert(study: Table2Study, K_r: float, K_r_se: float, spread: float) -> Inverted:
    k, x, R = study.measuring[:, None], study.object_printed[None, :], study.ratio
    var = (spread * R) ** 2
    interval = fieller.ratio_interval(
        K_r - R * k, R - 1, k * k * var + K_r_se**2, var, -k * var, quantile=t_quantile(0.95, R.size - 1)
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        condition = lumped.condition_in_ratio(K_r, k, x)
    return Inverted(K_r, _estimate(study, K_r), interval.lower, interval.upper, interval.bounded, condition)


def _spearman(a: np.ndarray, b: np.ndarray) -> float:
    def rank(v: np.ndarray) -> np.ndarray:
        return np.argsort(np.argsort(v.ravel(), kind="stable"), kind="stable").astype(float)

    return float(np.corrcoef(rank(a), rank(b))[0, 1])
