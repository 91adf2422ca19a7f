"""Section 4: Table 1 against itself."""

from __future__ import annotations

import numpy as np

from tactcad.paper.prose import drawn, section, table
from tactcad.paper.published import Published
from tactcad.paper.table1_check import ColumnProduct, Table1Check
from tactcad.report import plots as d
from tactcad.report.report import (
    Figure,
    Marked,
    ReportSection,
    ReportTable,
    exact,
    interval,
    listed,
    sig,
    signed_percent,
)


def page(c: Table1Check, data: Published) -> ReportSection:
    sentences = findings(c, data)
    return section(
        "table1", sentences, (_products(c), _series(c, data)), (_plot(c, data),), c, (sentences[3],)
    )


def findings(c: Table1Check, data: Published) -> tuple[str, ...]:
    cell, travel, step = (
        data.figure[k] for k in ("load_cell_stiffness", "calibration_travel", "calibration_step")
    )
    s = c.series
    agrees = s.line_low <= cell <= s.line_high
    sentences = [
        _product(
            "K × deflection",
            "the printed force",
            c.force,
            c.element,
            "a line that does not pass through zero would do that (the intercepts are not printed)",
        ),
        _product(
            "|K_v| × deflection",
            "the printed signal",
            c.signal,
            c.element,
            "again an intercept would do that",
        ),
        _product(
            "K_v/K from its two columns",
            "the printed K_v/K",
            c.ratio,
            c.element,
            "one of the three is misprinted",
        ),
        f"With {cell:g} N/mm in series, the printed deflections and forces add up to travels of "
        f"{interval(s.travel.min(), s.travel.max(), 4)} µm, not {travel:g}. Deflection against force over "
        f"all elements is a line of {sig(s.line_stiffness)} N/mm in series (95 % "
        f"{interval(s.line_low, s.line_high)}) from a travel of {s.line_travel:.0f} ± "
        f"{s.line_travel_half:.0f} µm: "
        + (
            "the printed load cell is compatible with that."
            if agrees
            else f"{'softer' if s.line_stiffness < cell else 'stiffer'} than the load cell alone. "
            + (
                "Something else gave way, or the stiffest elements were not taken to the full travel."
                if s.line_stiffness < cell
                else ""
            )
        ),
    ]
    early = s.nearest_step < travel
    if early.any():
        sentences.append(
            f"Nos. {listed(c.element[early])} come nearest to a travel of "
            f"{listed(sorted({f'{v:g}' for v in s.nearest_step[early]}))} µm, a whole number of {step:g} "
            f"µm steps below {travel:g}: they may have been stopped early"
            + (
                f", as no. {_over(c, data)} had to be, which at full travel would pass the force sensor's "
                f"{data.figure['load_cell_range']:g} N."
                if _over(c, data) is not None
                else "."
            )
        )
    return tuple(sentences)


def _over(c: Table1Check, data: Published) -> int | None:
    """The element that would exceed the force sensor's range at full travel, if one does."""
    K, cell = data.table1.stiffness.value, data.figure["load_cell_stiffness"]
    force = K * cell / (K + cell) * data.figure["calibration_travel"] * 1e-3
    i = int(np.argmax(force))
    return int(c.element[i]) if force[i] > data.figure["load_cell_range"] else None


def _product(name: str, against: str, p: ColumnProduct, element: np.ndarray, reason: str) -> str:
    beyond = p.beyond_rounding
    if not beyond.any():
        return f"{name} agrees with {against} within rounding for all {len(element)} elements."
    worst = int(np.argmax(np.abs(p.difference)))
    sign = "All are low: " if (p.difference[beyond] < 0).all() and beyond.sum() > 1 else ""
    return (
        f"{name} differs from {against} by more than rounding for {beyond.sum()} of {len(element)} "
        f"elements, most for no. {element[worst]} ({signed_percent(p.difference[worst])}). "
        f"{sign}{reason[0].upper() + reason[1:] if not sign else reason}."
    )


def _products(c: Table1Check) -> ReportTable:
    def cells(p: ColumnProduct, i: int) -> tuple:
        shown = f"{signed_percent(p.difference[i]).removesuffix(' %')} ± {sig(p.rounding[i] * 100, 2)}"
        return (exact(p.printed[i]), p.computed[i], Marked(shown) if p.beyond_rounding[i] else shown)

    rows = tuple(
        (int(n), *cells(c.force, i), *cells(c.signal, i), *cells(c.ratio, i)) for i, n in enumerate(c.element)
    )

    def head(name: str, unit: str) -> tuple:
        return ((f"{name} printed", unit), ("from columns", unit), ("difference", "% ± rounding"))

    return table(
        "table1 products",
        (("element", ""), *head("force", "N"), *head("signal", "V"), *head("K_v/K", "V/N")),
        rows,
    )


def _series(c: Table1Check, data: Published) -> ReportTable:
    s = c.series
    rows = tuple(
        (
            int(n),
            exact(data.table1.deflection.value[i]),
            exact(data.table1.force.value[i]),
            f"{s.travel[i]:.1f}",
            f"{s.nearest_step[i]:.0f}",
            s.stiffness_at_full_travel[i],
        )
        for i, n in enumerate(c.element)
    )
    return table(
        "table1 series",
        (
            ("element", ""),
            ("deflection printed", "µm"),
            ("force printed", "N"),
            (f"d + F/{data.figure['load_cell_stiffness']:g}", "µm"),
            ("nearest step", "µm"),
            (f"series stiffness for {data.figure['calibration_travel']:g} µm", "N/mm"),
        ),
        rows,
    )


def _plot(c: Table1Check, data: Published) -> Figure:
    t, s, figure_ = data.table1, c.series, data.figure
    with d.panels(1, 2, size=(11.2, 4.6)) as (figure, (left, right)):
        force = np.array([0, t.force.value.max() * 1.05])
        cell, travel = figure_["load_cell_stiffness"], figure_["calibration_travel"]
        left.plot(
            force,
            travel - force / cell * 1e3,
            "--",
            color=d.BLUE,
            lw=1.8,
            label=f"{travel:g} µm, {cell:g} N/mm in series, as printed",
        )
        left.plot(
            force,
            s.line_travel - force / s.line_stiffness * 1e3,
            "-",
            color=d.BLACK,
            lw=1.8,
            label=f"fitted: {s.line_travel:.0f} µm, {s.line_stiffness:.3g} N/mm",
        )
        left.plot(t.force.value, t.deflection.value, "o", color=d.RED, ms=8, mec="white")
        by_force = np.argsort(t.force.value)
        shift = {int(c.element[i]): ((7, 5), (-9, -17))[place % 2] for place, i in enumerate(by_force)}
        for n, x, y in zip(c.element, t.force.value, t.deflection.value):
            d.note(left, f"{n}", (x, y), shift[int(n)], fontsize=10)
        left.set(
            xlim=(0, force[1] * 1.03),
            ylim=0,
            xlabel="largest force, N",
            ylabel="deflection at it, µm",
            title="what stood in series (by element number)",
        )
        left.legend(loc="lower left")
        y = np.arange(len(c.element))[::-1]
        for offset, p, name, colour, marker in (
            (0.24, c.force, "K × d against force", d.BLUE, "o"),
            (0, c.signal, "|K_v| × d against signal", d.RED, "s"),
            (-0.24, c.ratio, "K_v/K against its column", d.GREEN, "^"),
        ):
            right.errorbar(
                p.difference * 100,
                y + offset,
                xerr=p.rounding * 100,
                fmt=marker,
                color=colour,
                ms=6,
                lw=1.4,
                capsize=3,
                label=name,
            )
        right.axvline(0, color=d.BLACK, lw=1)
        right.set_yticks(y, [f"no. {n}" for n in c.element])
        right.set(ylim=(-0.6, len(y) - 0.4), xlabel="difference, % (bars: what rounding allows)")
        right.legend(
            loc="lower center",
            bbox_to_anchor=(0.45, 1.0),
            ncols=3,
            fontsize=9,
            columnspacing=1,
            handletextpad=0.4,
        )
        return drawn(figure, "table1")
