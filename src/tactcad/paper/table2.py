"""Section 5: what Table 2 supports, and other evidence on the reference element's stiffness."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.paper.published import Published
from tactcad.report import plots as d
from tactcad.report.figures import interval, listed, percent, sig, signed_percent
from tactcad.report.report import Marked, Picture, ReportSection, ReportTable

from .prose import drawn, section, table
from .reference_element import ReferenceElement
from .reference_stiffness import UNITS, Fit, Table2Study
from .residuals import EDGE, Residuals

ALIKE = 0.15  # relative difference of rms below which models count as fitting equally well
USABLE = 10.0  # an interval wider than this factor is not informative


@dataclass(frozen=True)
class Witness:
    """One source's value of the reference element's stiffness, N/mm."""

    name: str
    value: float
    low: float
    high: float


def witnesses(s: Table2Study, r: Residuals, e: ReferenceElement) -> tuple[Witness, ...]:
    """Independent answers: Table 2 in three ways, beam model, equal element, K_v in two ways."""

    def of(name: str, f: Fit) -> Witness:
        return Witness(name, f.value[0], f.low[0], f.high[0])

    i = int(np.flatnonzero(r.element == e.element)[0])
    rest = next(f for f in s.without_stiffest if f.model == "K_r free")
    collected = [
        of("Table 2, all pairs", s.supported),
        of("Table 2 without the stiffest pair", rest),
        of("Table 2, K_obj as its ratios imply", s.with_implied_object),
        Witness(
            f"beam model, a = {r.arm[i]:g} mm, cutting tolerances",
            float(r.predicted[r.rung][i]),
            *r.band_cut[:, i].tolist(),
        ),
        Witness(
            f"beam model, a = {r.arm[i]:g} mm, contact anywhere on the pad",
            float(r.predicted[r.rung][i]),
            *r.band_pad[:, i].tolist(),
        ),
    ]
    if e.twin is not None:
        K = float(r.measured[np.flatnonzero(r.element == e.twin)[0]])
        collected.append(Witness(f"Table 1's K of no. {e.twin}, of equal arm", K, K, K))
    collected.append(Witness(f"K_v of no. {e.element}, load point free", *e.from_k_v_load_point))
    collected.append(Witness(f"K_v of no. {e.element}, thickness free", *e.from_k_v_thickness))
    return tuple(collected)


def findings(s: Table2Study, data: Published, who: tuple[Witness, ...]) -> tuple[str, ...]:
    return (
        _implied(s),
        _equation(s),
        *supported(s),
        _alternatives(s),
        _left_over(s),
        other_witnesses(s, who),
        *_consequences(s, data),
    )


def _implied(s: Table2Study) -> str:
    off = s.object_implied / s.object_printed - 1
    beyond = np.abs(off) > s.implied_rounding
    if not beyond.any():
        return "The printed K_m/K_obj and the header's K_obj agree within rounding."
    return (
        f"The printed K_m/K_obj imply another K_obj than the header for {beyond.sum()} of {len(off)} "
        "samples, in every row alike: "
        + listed(
            f"{sig(a)} instead of {b:g}" for a, b in zip(s.object_implied[beyond], s.object_printed[beyond])
        )
        + f" N/mm (at most {percent(np.abs(off).max())}: too little to matter below)."
    )


def _equation(s: Table2Study) -> str:
    f = s.fit("as printed")
    ratio = np.exp(-f.bias)
    if abs(f.bias) < 0.1:
        return (
            "Equation (2) with the printed stiffnesses agrees with the measured R: mean "
            f"{signed_percent(np.exp(f.bias) - 1)}, scatter {percent(f.rms)}."
        )
    way = "too large" if ratio > 1 else "too small"
    return (
        f"Equation (2) with the printed stiffnesses gives an R that is {way} by a factor "
        f"{sig(max(ratio, 1 / ratio))} on average (from {sig((s.ratio_printed_model / s.ratio).min())} to "
        f"{sig((s.ratio_printed_model / s.ratio).max())} times the measured one)."
    )


def supported(s: Table2Study) -> list[str]:
    f, rest = s.supported, next(x for x in s.without_stiffest if x.model == "K_r free")
    K, printed = f.value[0], s.reference_printed
    outside = not f.low[0] <= printed <= f.high[0]
    head = (
        f"With only K_r free, Table 2 supports K_r = {sig(K)} N/mm (95 % {interval(f.low[0], f.high[0])}), "
        + (
            f"{sig(max(printed / K, K / printed))} times {'below' if K < printed else 'above'} the "
            f"printed {printed:g}, which lies far outside the interval"
            if outside
            else f"which agrees with the printed {printed:g}"
        )
        + f"; ln R then scatters by {percent(f.rms)} instead of {percent(s.fit('as printed').rms)}. Without "
        f"the stiffest pair: {sig(rest.value[0])} ({interval(rest.low[0], rest.high[0])})."
    )
    stiffest = int(np.argmax(s.measuring))
    R = s.ratio[stiffest]
    near = np.abs(np.log(R)) < np.log(1.25)
    if outside and K < printed and near.sum() >= len(R) / 2:
        return [
            head,
            f"The plainest sign is in the first row: against K_m = {s.measuring[stiffest]:g} N/mm, R "
            f"is near 1 for {near.sum()} of {len(R)} samples ({interval(R.min(), R.max())}). R near 1 "
            "means equal stiffness, whatever the object.",
        ]
    return [head]


def _alternatives(s: Table2Study) -> str:
    base = s.supported
    one = [f for f in s.fits if len(f.names) == 1 and f.model != base.model]
    alike = [f for f in one if f.rms <= base.rms * (1 + ALIKE)]
    worse = [f for f in one if f not in alike]
    text = ""
    if alike:
        text = (
            f"{listed(f'{_fit_text(f)} (scatter {percent(f.rms)})' for f in alike)} fits as well as a K_r of "
            f"{sig(base.value[0])} ({percent(base.rms)}): Table 2 alone cannot tell a softer reference "
            "element from a wrong scale of its deflection. "
        )
    if worse:
        text += f"{listed(f'{_fit_text(f)} (scatter {percent(f.rms)})' for f in worse)} fits worse. "
    both = next(f for f in s.fits if f.model == "K_r free, R times a factor")
    wide = both.high[0] / both.low[0] > USABLE
    text = text[:1].upper() + text[1:]
    return text + (
        "With K_r and a factor on R both free, neither is determined."
        if wide
        else f"With both free, K_r = {sig(both.value[0])} ({interval(both.low[0], both.high[0])}) N/mm."
    )


def _left_over(s: Table2Study) -> str:
    """Whether the residuals of the best one-parameter stiffness depend on the sample."""
    by_sample = np.exp(
        np.log(
            s.ratio / (s.supported.value[0] + s.object_printed) * (s.measuring[:, None] + s.object_printed)
        ).mean(0)
    )
    soft, stiff = int(np.argmin(s.object_printed)), int(np.argmax(s.object_printed))
    drift = by_sample[soft] / by_sample[stiff]
    if abs(np.log(drift)) < s.supported.rms:
        return "What is left over does not run with the sample's stiffness."
    others = np.delete(by_sample, soft)
    text = (
        "What is left over runs with the sample: measured R over equation (2) goes from "
        f"{sig(by_sample[stiff])} on the stiffest to {sig(by_sample[soft])} on the softest. "
    )
    if np.ptp(np.log(others)) >= s.supported.rms:
        return text + "The lumped pair has no term for that."
    return text + (
        f"That trend is one sample, {s.object_printed[soft]:g} N/mm: without it the ratio lies within "
        f"{interval(others.min(), others.max())}. Its face may be inclined (section 10)."
    )


def _fit_text(f: Fit) -> str:
    name = {
        "R times a factor": "a common factor of {} on R",
        "K_obj times a factor": "K_obj {} times as large",
    }[f.model]
    return name.format(sig(f.value[0]))


def other_witnesses(s: Table2Study, who: tuple[Witness, ...]) -> str:
    K, printed = s.supported.value[0], s.reference_printed
    for_supported: list[Witness] = []
    for_printed: list[Witness] = []
    silent: list[Witness] = []
    for w in who[3:]:
        if w.high > w.low * USABLE:
            silent.append(w)
            continue
        # a band's end is uncertain by EDGE; a single printed value agrees if within a tenth
        slack = EDGE if w.high > w.low else 0.1
        low, high = w.low * (1 - slack), w.high * (1 + slack)
        holds = [low <= v <= high for v in (K, printed)]
        (silent if holds[0] == holds[1] else for_supported if holds[0] else for_printed).append(w)
    say = lambda group: listed(f"{w.name} ({sig(w.value)})" for w in group)  # noqa: E731
    parts = []
    if for_supported:
        parts.append(f"{sig(K)} N/mm agrees with {say(for_supported)}")
    if for_printed:
        parts.append(f"{printed:g} agrees with {say(for_printed)}")
    if silent:
        parts.append(f"not decided by {listed(w.name for w in silent)}")
    return "Other witnesses: " + "; ".join(parts) + "."


def _consequences(s: Table2Study, data: Published) -> list[str]:
    f, proposed = s.supported, data.figure["proposed_ratio"]
    if f.low[0] <= s.reference_printed <= f.high[0]:
        return [
            f"The paper's K_r/K_m stand, from {sig(s.reference_printed / s.measuring.max())} to "
            f"{sig(s.reference_printed / s.measuring.min())}."
        ]
    own, printed = f.value[0] / s.measuring, s.reference_printed / s.measuring
    nearest = int(np.argmin(np.abs(np.log(printed / proposed))))
    top, top_high = own.max(), f.high[0] / s.measuring.min()
    text = (
        "What follows if the reference element is the cause: the paper's K_r/K_m of "
        f"{interval(printed.min(), printed.max())} are really {interval(own.min(), own.max())}. "
    )
    text += (
        f"The advice that K_r/K_m be about {proposed:g} rests on the pair printed as "
        f"{sig(printed[nearest])}, which is {sig(own[nearest])}; "
        + (
            f"no pair reached {proposed:g} (at most {sig(top)}, by the interval {sig(top_high)}), so the "
            "experiment says nothing about it."
            if top_high < proposed
            else f"the largest that was reached is {sig(top)}."
        )
    )
    factor = s.fit("R times a factor")
    other = (
        "If instead the deflection scale of the reference element is the cause (R off by "
        f"{sig(factor.value[0])}), the paper's K_r/K_m stand, but its R are not ratios of deflections, "
        "and equation (3) needs R divided by that factor. Either way the printed R and the printed "
        "stiffnesses do not belong together."
    )
    return [text, other]


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


def _ratio_plot(s: Table2Study) -> Picture:
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
                d.series(ax, i, model[i], s.ratio[i], label=f"K_m = {k:g}")
            d.log_axes(ax, x=(1, 2, 3, 4, 6, 8, 10), y=(1, 2, 3, 4, 6, 8, 10))
            ax.set(xlim=span, ylim=span, title=title, xlabel="R by equation (2)")
        axes[0].set_ylabel("R measured (Table 2)")
        axes[0].legend(loc="upper left", title="N/mm")
        return drawn(figure, "table2-ratio")


def _forest(s: Table2Study, who: tuple[Witness, ...]) -> Picture:
    with d.panels(size=(11.2, 4.3)) as (figure, ax):
        least, most = 8.0, 250.0
        y = np.arange(len(who))[::-1]
        ax.axvspan(s.supported.low[0], s.supported.high[0], color=d.SKY, alpha=0.3, lw=0)
        ax.axvline(s.reference_printed, color=d.RED, lw=2, ls="--")
        at = (s.reference_printed, len(who) - 0.42)
        d.note(ax, f"printed: {s.reference_printed:g}", at, (6, 0), color=d.RED)
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
