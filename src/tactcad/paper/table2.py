"""Section 5: what Table 2 supports, and other evidence on the reference element's stiffness."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tactcad.paper.published import Published
from tactcad.report import plots as d
from tactcad.report.figures import interval, sig, signed_percent
from tactcad.report.report import Picture, ReportSection, ReportTable

from .prose import drawn, grid, marked, saying, section, table
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


def page(s: Table2Study, data: Published, r: Residuals, e: ReferenceElement) -> ReportSection:
    who, say = witnesses(s, r, e), _saying(s)
    return section(
        "table2",
        findings(s, data, who),
        (_objects(s), _models(s), _witnesses(s, who), _ratios(s), _readings(s)),
        (_ratio_plot(s), _forest(s, who)),
        {"study": s, "witnesses": who},
        (_supported(s, say)[0], _other_witnesses(s, say, who)),
    )


def _saying(s: Table2Study) -> Callable[..., str]:
    return saying("table2", s=s, K=s.supported.value[0], fit=s.supported)


def findings(s: Table2Study, data: Published, who: tuple[Witness, ...]) -> tuple[str, ...]:
    say = _saying(s)
    return (
        _implied(s, say),
        _equation(s, say),
        *_supported(s, say),
        _alternatives(s, say),
        _left_over(s, say),
        _other_witnesses(s, say, who),
        *_consequences(s, say, data),
    )


def _implied(s: Table2Study, say: Callable[..., str]) -> str:
    off = s.object_implied / s.object_printed - 1
    beyond = np.abs(off) > s.implied_rounding
    if not beyond.any():
        return say("as header")
    pairs = zip(s.object_implied[beyond], s.object_printed[beyond])
    instead = [f"{sig(a)} instead of {b:g}" for a, b in pairs]
    return say("implied", beyond=beyond.sum(), all=len(off), instead=instead, most=np.abs(off).max())


def _equation(s: Table2Study, say: Callable[..., str]) -> str:
    f = s.fit("as printed")
    if abs(f.bias) < 0.1:
        return say("equation agrees", mean=np.exp(f.bias) - 1, scatter=f.rms)
    ratio, all_ = np.exp(-f.bias), s.ratio_printed_model / s.ratio
    return say(
        "equation",
        way="too large" if ratio > 1 else "too small",
        factor=max(ratio, 1 / ratio),
        times=(all_.min(), all_.max()),
    )


def _supported(s: Table2Study, say: Callable[..., str]) -> list[str]:
    f, rest = s.supported, next(x for x in s.without_stiffest if x.model == "K_r free")
    K, printed = f.value[0], s.reference_printed
    outside = not f.low[0] <= printed <= f.high[0]
    beyond = say("far", times=max(printed / K, K / printed), way="below" if K < printed else "above")
    stiffest = int(np.argmax(s.measuring))
    R = s.ratio[stiffest]
    near = np.abs(np.log(R)) < np.log(1.25)
    head = say(
        "supported",
        fitted=(f.low[0], f.high[0]),
        against=beyond if outside else say("agrees"),
        instead=s.fit("as printed").rms,
        rest=rest,
        rest_span=(rest.low[0], rest.high[0]),
    )
    if outside and K < printed and near.sum() >= len(R) / 2:
        first = say(
            "first row", K_m=s.measuring[stiffest], near=near.sum(), all=len(R), span=(R.min(), R.max())
        )
        return [head, first]
    return [head]


def _alternatives(s: Table2Study, say: Callable[..., str]) -> str:
    base, text = s.supported, ""
    one = [f for f in s.fits if len(f.names) == 1 and f.model != base.model]
    for name, alike in (("as well", True), ("worse", False)):
        fits = [
            say("scatters", what=say(f.model, value=f.value[0]), scatter=f.rms)
            for f in one
            if (f.rms <= base.rms * (1 + ALIKE)) == alike
        ]
        text += say(name, fits=fits) if fits else ""
    both = next(f for f in s.fits if f.model == "K_r free, R times a factor")
    wide = both.high[0] / both.low[0] > USABLE
    free = say("neither") if wide else say("both", both=both, span=(both.low[0], both.high[0]))
    return text[:1].upper() + text[1:] + free


def _left_over(s: Table2Study, say: Callable[..., str]) -> str:
    """Whether the residuals of the best one-parameter stiffness depend on the sample."""
    expected = (s.supported.value[0] + s.object_printed) / (s.measuring[:, None] + s.object_printed)
    by_sample = np.exp(np.log(s.ratio / expected).mean(0))
    soft, stiff = int(np.argmin(s.object_printed)), int(np.argmax(s.object_printed))
    if abs(np.log(by_sample[soft] / by_sample[stiff])) < s.supported.rms:
        return say("nothing left")
    others = np.delete(by_sample, soft)
    one = np.ptp(np.log(others)) < s.supported.rms
    span = (others.min(), others.max())
    return say(
        "left over",
        stiff=by_sample[stiff],
        soft=by_sample[soft],
        trend=say("one sample", softest=s.object_printed[soft], span=span) if one else say("no term"),
    )


def _other_witnesses(s: Table2Study, say: Callable[..., str], who: tuple[Witness, ...]) -> str:
    K, printed = s.supported.value[0], s.reference_printed
    groups: dict[str, list[Witness]] = {"for supported": [], "for printed": [], "silent": []}
    for w in who[3:]:
        # a band's end is uncertain by EDGE; a single printed value agrees if within a tenth
        slack = EDGE if w.high > w.low else 0.1
        low, high = w.low * (1 - slack), w.high * (1 + slack)
        own, other = (low <= v <= high for v in (K, printed))
        undecided = w.high > w.low * USABLE or own == other
        groups["silent" if undecided else "for supported" if own else "for printed"].append(w)
    parts = [
        say(name, names=[w.name for w in group], sized=[f"{w.name} ({sig(w.value)})" for w in group])
        for name, group in groups.items()
        if group
    ]
    return say("other witnesses", parts="; ".join(parts))


def _consequences(s: Table2Study, say: Callable[..., str], data: Published) -> list[str]:
    f, proposed = s.supported, data.figure["proposed_ratio"]
    own, printed = f.value[0] / s.measuring, s.reference_printed / s.measuring
    spans = {"printed": (printed.min(), printed.max()), "own": (own.min(), own.max())}
    if f.low[0] <= s.reference_printed <= f.high[0]:
        return [say("stand", **spans)]
    nearest = int(np.argmin(np.abs(np.log(printed / proposed))))
    at_most = {"top": own.max(), "top_high": f.high[0] / s.measuring.min(), "proposed": proposed}
    pair = {"pair": printed[nearest], "really": own[nearest]}
    reached = say("none reached" if at_most["top_high"] < proposed else "reached", **at_most)
    return [
        say("follows", reached=reached, proposed=proposed, **pair, **spans),
        say("instead", factor=s.fit("R times a factor").value[0]),
    ]


def _objects(s: Table2Study) -> ReportTable:
    off = s.object_implied / s.object_printed - 1
    rows = (
        ("header", *(f"{v:g}" for v in s.object_printed)),
        ("implied by K_m/(printed ratio)", *(f"{v:.3f}" for v in s.object_implied)),
        ("range over the rows", *(f"{a:.3f}–{b:.3f}" for a, b in s.object_implied_range.T)),
        ("difference", *marked(map(signed_percent, off), np.abs(off) > s.implied_rounding)),
    )
    return grid("table2 objects", (("", ""), *((f"sample {j + 1}", "") for j in range(len(off)))), rows)


def _models(s: Table2Study) -> ReportTable:
    def values(f: Fit, named: bool) -> str:
        return ", ".join(
            f"{n} = {sig(v)} ({held}){' N/mm' if UNITS[n] != '1' else ''}" if named else f"{sig(v)} ({held})"
            for n, v, a, b in zip(f.names, f.value, f.low, f.high)
            for held in ("not determined" if b / a > USABLE**2 else interval(a, b),)
        )

    return table(
        "table2 models",
        [f.model for f in s.fits],
        [values(f, True) or "nothing free" for f in s.fits],
        [f.rms for f in s.fits],
        [f.left_out_rms for f in s.fits],
        [values(f, False) or "–" for f in s.without_stiffest],
        [f.rms for f in s.without_stiffest],
    )


def _witnesses(s: Table2Study, who: tuple[Witness, ...]) -> ReportTable:
    spans = [interval(w.low, w.high) if w.high > w.low else "one printed value" for w in who]
    return table("table2 witnesses", [w.name for w in who], [w.value for w in who], spans, s=s)


def _ratios(s: Table2Study) -> ReportTable:
    f, k = s.supported, s.measuring
    spans = zip(f.low[0] / k, f.high[0] / k)
    return table("table2 ratios", k, s.reference_printed / k, f.value[0] / k, spans)


def _readings(s: Table2Study) -> ReportTable:
    rows = ((f"{k:g}", *row) for k, row in zip(s.measuring, s.reference_by_reading))
    columns = (("K_m", "N/mm"), *((f"K_obj = {x:g}", "") for x in s.object_printed))
    return grid("table2 readings", columns, rows)


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
