"""Table 1 against itself: its products, its ratios, and the load cell in series.

K d should be the force and |K_v| d the signal, apart from the intercepts of the lines, which are not printed;
K_v/K is printed along with its two terms. Stage travel = d + F/K_c for every element, so d over F is one line
whose slope is the true compliance in series and whose intercept is the travel.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from tactcad.lab.regression import fit_lines, t_quantile
from tactcad.paper.published import Column, Published
from tactcad.report import plots as d
from tactcad.report.figures import sig, signed_percent
from tactcad.report.report import Cell, Picture, ReportSection, ReportTable

from .prose import drawn, marked, saying, section, table


@dataclass(frozen=True)
class ColumnProduct:
    """A printed value and the same value computed from other columns; relative difference, and what
    rounding allows.
    """

    printed: np.ndarray
    computed: np.ndarray
    difference: np.ndarray
    rounding: np.ndarray

    @property
    def beyond_rounding(self) -> np.ndarray:
        return np.abs(self.difference) > self.rounding


@dataclass(frozen=True)
class SeriesSpring:
    """The compliance in series: travel (um) from the printed deflections and forces, stiffness (N/mm) with 95
    % interval.
    """

    travel: np.ndarray  # by element, d + F/K_c
    nearest_step: np.ndarray  # um
    line_stiffness: float
    line_low: float
    line_high: float
    line_travel: float
    line_travel_half: float
    stiffness_at_full_travel: np.ndarray  # K_c that makes each element's travel the stated one


@dataclass(frozen=True)
class Table1Check:
    element: np.ndarray
    force: ColumnProduct  # N
    signal: ColumnProduct  # V
    ratio: ColumnProduct  # V/N
    series: SeriesSpring


def check(data: Published) -> Table1Check:
    """All of Table 1's internal relations."""
    t = data.table1
    d, slope = t.deflection, t.signal_per_deflection
    mm = 1e-3

    def relative(c: Column) -> np.ndarray:
        return c.half_step / np.abs(c.value)

    force = _product(t.force, t.stiffness.value * d.value * mm, relative(t.stiffness) + relative(d))
    signal = _product(t.signal, np.abs(slope.value) * d.value * mm, relative(slope) + relative(d))
    ratio = _product(
        t.signal_per_force, slope.value / t.stiffness.value, relative(slope) + relative(t.stiffness)
    )
    return Table1Check(t.element, force, signal, ratio, _series(data))


def _product(printed: Column, computed: np.ndarray, rounding: np.ndarray) -> ColumnProduct:
    return ColumnProduct(
        printed.value,
        computed,
        computed / printed.value - 1,
        rounding + printed.half_step / np.abs(printed.value),
    )


def _series(data: Published) -> SeriesSpring:
    t, figure = data.table1, data.figure
    d, force = t.deflection.value, t.force.value
    cell, travel, step = (
        figure["load_cell_stiffness"],
        figure["calibration_travel"],
        figure["calibration_step"],
    )
    reached = d + force / cell * 1e3
    line = fit_lines(force, d[:, None], np.zeros(len(d), int))
    half = t_quantile(0.95, line.dof) * line.covariance[0, 0] ** 0.5
    low, high = -line.slope[0] - half, -line.slope[0] + half  # compliance, um/N
    sxx = ((force - force.mean()) ** 2).sum()
    travel_se = (line.covariance[0, 0] * (sxx / len(d) + force.mean() ** 2)) ** 0.5
    with np.errstate(divide="ignore"):
        full = np.where(d < travel, force / np.maximum(travel - d, 1e-9) * 1e3, np.inf)
    return SeriesSpring(
        reached,
        np.round(reached / step) * step,
        1e3 / -line.slope[0] if line.slope[0] < 0 else np.inf,
        1e3 / high if high > 0 else np.inf,
        1e3 / low if low > 0 else np.inf,
        float(line.intercept[0]),
        float(t_quantile(0.95, line.dof) * travel_se),
        full,
    )


def page(c: Table1Check, data: Published) -> ReportSection:
    sentences = findings(c, data)
    return section(
        "table1", sentences, (_products(c), _series_table(c, data)), (_plot(c, data),), c, (sentences[3],)
    )


def findings(c: Table1Check, data: Published) -> tuple[str, ...]:
    s, figure, K = c.series, data.figure, data.table1.stiffness.value
    cell, travel = figure["load_cell_stiffness"], figure["calibration_travel"]
    say = saying("table1", c=c, s=s, figure=figure, count=len(c.element))
    agrees = s.line_low <= cell <= s.line_high
    softer = s.line_stiffness < cell
    early = s.nearest_step < travel
    force = K * cell / (K + cell) * travel * 1e-3  # at full travel
    most = int(np.argmax(force))
    over = force[most] > figure["load_cell_range"]
    return (
        *(_product_finding(say, name, c) for name in ("force", "signal", "ratio")),
        say(
            "series",
            travel=(s.travel.min(), s.travel.max()),
            line=(s.line_low, s.line_high),
            verdict=say("compatible" if agrees else "softer" if softer else "stiffer"),
        ),
        *(
            [
                say(
                    "early",
                    early=c.element[early],
                    steps=sorted({f"{v:g}" for v in s.nearest_step[early]}),
                    over=say("over", most=c.element[most]) if over else ".",
                )
            ]
            if early.any()
            else []
        ),
    )


def _product_finding(say: Callable[..., str], name: str, c: Table1Check) -> str:
    p: ColumnProduct = getattr(c, name)
    names = {"name": say(f"{name} product"), "against": say(f"{name} printed")}
    beyond, worst = p.beyond_rounding, int(np.argmax(np.abs(p.difference)))
    if not beyond.any():
        return say("agrees", **names)
    reason = say(f"{name} reason")
    low = beyond.sum() > 1 and (p.difference[beyond] < 0).all()
    return say(
        "differs",
        **names,
        beyond=beyond.sum(),
        worst=c.element[worst],
        off=p.difference[worst],
        reason=say("all low", reason=reason) if low else reason[0].upper() + reason[1:],
    )


def _products(c: Table1Check) -> ReportTable:
    columns: list[Iterable[Cell]] = []
    for p in (c.force, c.signal, c.ratio):
        off = (
            f"{signed_percent(d).removesuffix(' %')} ± {sig(r * 100, 2)}"
            for d, r in zip(p.difference, p.rounding)
        )
        columns += [p.printed, p.computed, marked(off, p.beyond_rounding)]
    return table("table1 products", c.element, *columns)


def _series_table(c: Table1Check, data: Published) -> ReportTable:
    t, s = data.table1, c.series
    return table(
        "table1 series",
        *(c.element, t.deflection.value, t.force.value, s.travel, s.nearest_step, s.stiffness_at_full_travel),
        figure=data.figure,
    )


def _plot(c: Table1Check, data: Published) -> Picture:
    t, s, figure_ = data.table1, c.series, data.figure
    with d.panels(1, 2, size=(11.2, 4.6)) as (figure, (left, right)):
        force = np.array([0, t.force.value.max() * 1.05])
        cell, travel = figure_["load_cell_stiffness"], figure_["calibration_travel"]
        as_printed = f"{travel:g} µm, {cell:g} N/mm in series, as printed"
        fitted = f"fitted: {s.line_travel:.0f} µm, {s.line_stiffness:.3g} N/mm"
        for start, stiffness, style, colour, label in (
            (travel, cell, "--", d.BLUE, as_printed),
            (s.line_travel, s.line_stiffness, "-", d.BLACK, fitted),
        ):
            left.plot(force, start - force / stiffness * 1e3, style, color=colour, lw=1.8, label=label)
        left.plot(t.force.value, t.deflection.value, "o", color=d.RED, ms=8, mec="white")
        by_force = np.argsort(t.force.value)
        shift = {int(c.element[i]): ((7, 5), (-9, -17))[place % 2] for place, i in enumerate(by_force)}
        for n, x, y in zip(c.element, t.force.value, t.deflection.value):
            d.note(left, f"{n}", (x, y), shift[int(n)], fontsize=10)
        left.set(xlim=(0, force[1] * 1.03), ylim=0, xlabel="largest force, N", ylabel="deflection at it, µm")
        left.set_title("what stood in series (by element number)")
        left.legend(loc="lower left")
        y = np.arange(len(c.element))[::-1]
        for offset, p, name, colour, marker in (
            (0.24, c.force, "K × d against force", d.BLUE, "o"),
            (0, c.signal, "|K_v| × d against signal", d.RED, "s"),
            (-0.24, c.ratio, "K_v/K against its column", d.GREEN, "^"),
        ):
            bars = {"xerr": p.rounding * 100, "ms": 6, "lw": 1.4, "capsize": 3, "label": name}
            right.errorbar(p.difference * 100, y + offset, fmt=marker, color=colour, **bars)
        right.axvline(0, color=d.BLACK, lw=1)
        right.set_yticks(y, [f"no. {n}" for n in c.element])
        right.set(ylim=(-0.6, len(y) - 0.4), xlabel="difference, % (bars: what rounding allows)")
        close = {"ncols": 3, "fontsize": 9, "columnspacing": 1, "handletextpad": 0.4}
        right.legend(loc="lower center", bbox_to_anchor=(0.45, 1.0), **close)
        return drawn(figure, "table1")
