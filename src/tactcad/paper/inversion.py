"""Equation (3) applied to Table 2: K_obj from R, its error, and the error that the condition number
predicts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.lab.regression import t_quantile
from tactcad.mechanics import lumped
from tactcad.paper.reference_stiffness import Table2Study, solve
from tactcad.report import plots as d
from tactcad.report.figures import interval, sig
from tactcad.report.report import Cell, Picture, ReportSection, ReportTable

from .prose import drawn, grid, marked, saying, section


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
        """Mask of positive and finite estimates."""
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
    at_ends: np.ndarray  # K_obj, N/mm, with either end of the supported K_r's interval [end, element, sample]
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
    interval = lumped.ratio_interval(
        K_r - R * k, R - 1, k * k * var + K_r_se**2, var, -k * var, quantile=t_quantile(0.95, R.size - 1)
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        condition = lumped.condition_in_ratio(K_r, k, x)
    return Inverted(K_r, _estimate(study, K_r), interval.lower, interval.upper, interval.bounded, condition)


def _spearman(a: np.ndarray, b: np.ndarray) -> float:
    def rank(v: np.ndarray) -> np.ndarray:
        return np.argsort(np.argsort(v.ravel(), kind="stable"), kind="stable").astype(float)

    return float(np.corrcoef(rank(a), rank(b))[0, 1])


WELL = 5.0  # |condition number| below which a pair is called well conditioned
FACTOR = 1.5  # an estimate within this factor of the sample's K_obj is called right


def page(v: Inversion) -> ReportSection:
    sentences = findings(v)
    return section(
        "inversion",
        sentences,
        (_table(v, v.supported), _table(v, v.printed)),
        (_plot(v),),
        v,
        (sentences[0], sentences[-1]),
    )


def findings(v: Inversion) -> tuple[str, ...]:
    x, w = v.object_stiffness, v.supported
    say = saying("inversion", v=v, w=w, factor=FACTOR, well=WELL, n=x.size * len(v.measuring))
    positive = w.physical()
    right, printed, left_out = (_right(e, x) for e in (w.estimate, v.printed.estimate, v.left_out))
    ends = [_right(e, x).sum() for e in v.at_ends]
    # near R = 1 an estimate that is not positive counts as infinitely stiff
    medians = [float(np.median(np.where(i.physical(), i.estimate, np.inf) / x)) for i in (v.printed, w)]
    some = positive.any() and not positive.all()
    of_positive = float(np.median((w.estimate / x)[positive])) if some else None
    log = np.log(x)
    one = np.exp(log.mean())
    of_others = np.exp((log.sum() - log) / (len(x) - 1)) if len(x) > 1 else x
    rows_lost = ", ".join(f"{k:g}" for k, ok in zip(v.measuring, positive) if not ok.all())
    well = np.abs(w.condition) < WELL
    sentences = [
        say(
            "right",
            printed=printed.sum(),
            supported=right.sum(),
            medians=medians,
            infinite=say("infinite", median=of_positive) if some else "",
        ),
        say(
            "own readings",
            left_out=left_out.sum(),
            ends=say("same ends" if ends[0] == ends[1] else "ends", ends=ends),
        ),
        say(
            "no reading",
            one=one,
            right=len(v.measuring) * _within_factor(one, x).sum(),
            of_others=len(v.measuring) * _within_factor(of_others, x).sum(),
        ),
        say(
            "intervals",
            lost=(~positive).sum(),
            rows=say("rows lost", rows=rows_lost) if rows_lost else "",
            held=w.holds(x).sum(),
            bounded=(w.bounded & (w.low > 0)).sum(),
        ),
    ]
    if well.any() and (~well).any():
        error = np.abs(np.log(np.where(positive, w.estimate, np.inf) / x))
        least = np.abs(w.condition).min()
        sentences.append(
            say(
                "condition",
                below=right[well].sum(),
                of_below=well.sum(),
                left_out=left_out[well].sum(),
                mean=np.broadcast_to(_within_factor(one, x), well.shape)[well].sum(),
                above=right[~well].sum(),
                of_above=(~well).sum(),
                typical=[_typical(np.median(error[group])) for group in (well, ~well)],
                least=least,
                at_best=v.ratio_error * least,
            )
        )
    return tuple(sentences)


def _typical(error: float) -> str:
    """A median error of ln K_obj; without bound where half of a group has no estimate."""
    return f"a factor {np.exp(error):.2f}" if np.isfinite(error) else "without bound"


def _table(v: Inversion, w: Inverted) -> ReportTable:
    def cell(value: float, low: float, high: float, bounded: bool) -> str:
        held = interval(max(low, 0.0), high, 2) if high > 0 else "none ≥ 0"
        return f"{sig(value, 2)} ({held if bounded else 'open'})"

    rows: list[tuple[Cell, ...]] = []
    right = _right(w.estimate, v.object_stiffness)
    for i, k in enumerate(v.measuring):
        cells = map(cell, w.estimate[i], w.low[i], w.high[i], w.bounded[i])
        rows.append((f"{k:g}", *marked(cells, ~right[i])))
        rows.append(("condition", *(f"{c:.1f}" for c in w.condition[i])))
    return grid(
        "inversion table",
        (("K_m", "N/mm"), *((f"sample {x:g}", "N/mm") for x in v.object_stiffness)),
        rows,
        w=w,
        factor=FACTOR,
    )


def _within_factor(estimate: np.ndarray, x: np.ndarray) -> np.ndarray:
    return np.abs(np.log(estimate / x)) <= np.log(FACTOR)


def _right(estimate: np.ndarray, x: np.ndarray) -> np.ndarray:
    positive = np.isfinite(estimate) & (estimate > 0)
    return positive & _within_factor(np.where(positive, estimate, 1.0), x)


def _plot(v: Inversion) -> Picture:
    x = v.object_stiffness
    with d.panels(1, 3, size=(11.2, 4.9)) as (figure, axes):
        for ax, w, title in (
            (axes[0], v.printed, f"K_r = {v.printed.reference:g}, printed"),
            (axes[1], v.supported, f"K_r = {sig(v.supported.reference)}, supported"),
        ):
            span = np.array([1.6, 14.0])
            ax.plot(span, span, color=d.BLACK, lw=1.2)
            for i in range(len(v.measuring)):
                ok = w.physical()[i] & w.bounded[i]
                shift = np.exp(0.018 * (i - 2.5))
                low = np.clip(w.low[i][ok], 0.3, None)
                bars = np.maximum(np.array([w.estimate[i][ok] - low, w.high[i][ok] - w.estimate[i][ok]]), 0)
                style = {"ms": 6, "lw": 0.9, "capsize": 2, "alpha": 0.95}
                d.with_bars(ax, i, x[ok] * shift, w.estimate[i][ok], bars, **style)
                d.series(ax, i, x[~ok] * shift, np.full((~ok).sum(), 0.36), hollow=True, ms=6)
            d.log_axes(ax, x=(2, 3, 4, 5, 7, 10), y=(0.5, 1, 2, 5, 10, 20, 50, 100))
            ax.set(xlim=(2.0, 12), ylim=(0.3, 170), title=title, xlabel="K_obj of the sample, N/mm")
        axes[0].set_ylabel("K_obj by equation (3), N/mm")
        right = axes[2]
        for i in range(len(v.measuring)):
            ok = v.supported.physical()[i]
            condition = np.abs(v.supported.condition[i])
            off = np.exp(np.abs(np.log(v.supported.estimate[i][ok] / x[ok])))
            d.series(right, i, condition[ok], off)
            d.series(right, i, np.minimum(condition[~ok], 600), np.full((~ok).sum(), 8.5), hollow=True)
        grid = np.geomspace(2, np.log(9) / v.ratio_error, 50)
        right.plot(grid, np.exp(grid * v.ratio_error), "k--", lw=1.2, label="condition × scatter of R")
        d.log_axes(right, x=(2, 5, 10, 50, 200, 600), y=(1, 1.5, 2, 3, 5, 8))
        right.set(
            ylim=(0.97, 10),
            xlabel="|condition number| of K_obj in R",
            ylabel="off by this factor, supported K_r",
            title="what was to be expected",
        )
        right.legend(loc="lower right", fontsize=9)
        from matplotlib.lines import Line2D

        handles = [
            Line2D([], [], marker=d.MARKERS[i], color=d.SERIES[i], ls="", ms=7, label=f"K_m = {k:g}")
            for i, k in enumerate(v.measuring)
        ]
        d.legend_below(figure, handles)
        return drawn(figure, "inversion")
