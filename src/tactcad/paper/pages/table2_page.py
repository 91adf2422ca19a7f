"""Section 5: Table 2, and the reference stiffness that it supports."""

from __future__ import annotations

import numpy as np

from tactcad.paper.prose import drawn, section, table
from tactcad.paper.published import Published
from tactcad.paper.reference_element import ReferenceElement
from tactcad.paper.reference_stiffness import UNITS, Table2Study
from tactcad.paper.residuals import Residuals
from tactcad.report import plots as d
from tactcad.report.report import (
    Figure,
    Marked,
    ReportSection,
    ReportTable,
    interval,
    percent,
    sig,
    signed_percent,
)

from .table2_findings import USABLE, Witness, findings, other_witnesses, supported, witnesses


def page(s: Table2Study, data: Published, r: Residuals, e: ReferenceElement) -> ReportSection:
    who = witnesses(s, r, e)
    sentences = findings(s, data, who)
    return section(
        "table2",
        sentences,
        (_objects(s), _models(s), _witnesses(s, who), _ratios(s), _readings(s)),
        (_ratio_plot(s), _forest(s, who)),
        {"study": s, "witnesses": who},
        (supported(s)[0], other_witnesses(s, who)),
    )


def _objects(s: Table2Study) -> ReportTable:
    off = s.object_implied / s.object_printed - 1
    rows = (
        ("header", *(f"{v:g}" for v in s.object_printed)),
        ("implied by K_m/(printed ratio)", *(f"{v:.3f}" for v in s.object_implied)),
        ("range over the rows", *(f"{a:.3f}–{b:.3f}" for a, b in s.object_implied_range.T)),
        (
            "difference",
            *(
                Marked(signed_percent(v)) if abs(v) > lim else signed_percent(v)
                for v, lim in zip(off, s.implied_rounding)
            ),
        ),
    )
    return table("table2 objects", (("", ""), *((f"sample {j + 1}", "") for j in range(len(off)))), rows)


def _models(s: Table2Study) -> ReportTable:
    rows = []
    for f, g in zip(s.fits, s.without_stiffest):
        value = (
            ", ".join(
                f"{n} = {sig(v)} ({_range(a, b)}){' N/mm' if UNITS[n] != '1' else ''}"
                for n, v, a, b in zip(f.names, f.value, f.low, f.high)
            )
            or "nothing free"
        )
        again = ", ".join(f"{sig(v)} ({_range(a, b)})" for v, a, b in zip(g.value, g.low, g.high)) or "–"
        rows.append((f.model, value, percent(f.rms), percent(f.left_out_rms), again, percent(g.rms)))
    return table(
        "table2 models",
        (
            ("model", ""),
            ("parameters, 95 % intervals", "all pairs"),
            ("scatter of ln R", ""),
            ("at rows left out", ""),
            ("parameters", "without the stiffest pair"),
            ("scatter of ln R", ""),
        ),
        tuple(rows),
    )


def _range(low: float, high: float) -> str:
    return "not determined" if high / low > USABLE**2 else interval(low, high)


def _witnesses(s: Table2Study, who: tuple[Witness, ...]) -> ReportTable:
    rows = tuple(
        (w.name, w.value, interval(w.low, w.high) if w.high > w.low else "one printed value") for w in who
    )
    return table(
        "table2 witnesses",
        (("source", ""), ("K_r", "N/mm"), ("95 % interval", "N/mm")),
        rows,
        reference_printed=s.reference_printed,
    )


def _ratios(s: Table2Study) -> ReportTable:
    K = s.supported
    rows = tuple(
        (f"{k:g}", s.reference_printed / k, K.value[0] / k, interval(K.low[0] / k, K.high[0] / k))
        for k in s.measuring
    )
    return table(
        "table2 ratios",
        (("K_m, N/mm", ""), ("printed", ""), ("supported by Table 2", ""), ("95 % interval", "")),
        rows,
    )


def _readings(s: Table2Study) -> ReportTable:
    rows = tuple((f"{k:g}", *row) for k, row in zip(s.measuring, s.reference_by_reading))
    return table(
        "table2 readings", (("K_m", "N/mm"), *((f"K_obj = {x:g}", "") for x in s.object_printed)), rows
    )


def _ratio_plot(s: Table2Study) -> Figure:
    K = s.supported.value[0]
    own = (K + s.object_printed) / (s.measuring[:, None] + s.object_printed)
    with d.panels(1, 2, size=(11.2, 4.9), sharey=True) as (figure, axes):
        for ax, model, title in (
            (axes[0], s.ratio_printed_model, f"K_r = {s.reference_printed:g} N/mm, as printed"),
            (axes[1], own, f"K_r = {K:.1f} N/mm, as Table 2 supports"),
        ):
            span = np.array([0.7, 11.5])
            ax.plot(span, span, color=d.BLACK, lw=1.2)
            for i, k in enumerate(s.measuring):
                ax.plot(
                    model[i],
                    s.ratio[i],
                    d.MARKERS[i],
                    color=d.SERIES[i],
                    ms=7,
                    mec="white",
                    mew=0.6,
                    label=f"K_m = {k:g}",
                )
            d.log_axes(ax, x=(1, 2, 3, 4, 6, 8, 10), y=(1, 2, 3, 4, 6, 8, 10))
            ax.set(xlim=span, ylim=span, title=title, xlabel="R by equation (2)")
        axes[0].set_ylabel("R measured (Table 2)")
        axes[0].legend(loc="upper left", title="N/mm")
        return drawn(figure, "table2-ratio")


def _forest(s: Table2Study, who: tuple[Witness, ...]) -> Figure:
    with d.panels(size=(11.2, 4.3)) as (figure, ax):
        least, most = 8.0, 250.0
        y = np.arange(len(who))[::-1]
        ax.axvspan(s.supported.low[0], s.supported.high[0], color=d.SKY, alpha=0.3, lw=0)
        ax.axvline(s.reference_printed, color=d.RED, lw=2, ls="--")
        ax.annotate(
            f"printed: {s.reference_printed:g}",
            (s.reference_printed, len(who) - 0.42),
            (6, 0),
            textcoords="offset points",
            color=d.RED,
        )
        for place, w in zip(y, who):
            low, high = max(w.low, least), min(w.high, most)
            ax.plot([low, high], [place, place], color=d.BLUE, lw=2.2)
            for end, limit, marker in ((w.low, least, "<"), (w.high, most, ">")):
                if not least < end < most:
                    ax.plot(limit, place, marker, color=d.BLUE, ms=8)
            if least < w.value < most:
                ax.plot(w.value, place, "o", color=d.BLUE, ms=8, mec="white")
        ax.set_yticks(y, [w.name for w in who])
        ax.set(ylim=(-0.6, len(who) - 0.1), xscale="log")
        d.log_ticks(ax.xaxis, (10, 20, 30, 40, 60, 80, 120, 200))
        ax.set(
            xlim=(least * 0.97, most * 1.03),
            xlabel="stiffness of the reference element, N/mm (95 % intervals; arrows: further than shown)",
        )
        return drawn(figure, "reference-stiffness")
