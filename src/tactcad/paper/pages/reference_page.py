"""Section 7: the reference element's own numbers."""

from __future__ import annotations

import numpy as np

from tactcad.paper.prose import drawn, section, table, tabulated
from tactcad.paper.reference_element import Explanation, ReferenceElement
from tactcad.report import plots as d
from tactcad.report.report import (
    Cell,
    Figure,
    Marked,
    ReportSection,
    ReportTable,
    interval,
    listed,
    percent,
    sig,
)


def page(e: ReferenceElement) -> ReportSection:
    return section(
        "reference",
        findings(e),
        (_ranges(e), _accounts(e), _explanations(e)),
        (_plot(e),),
        e,
        (_loads(e),),
        element=e.element,
    )


def findings(e: ReferenceElement) -> tuple[str, ...]:
    return (_ranges_said(e), _loads(e), *_explained(e))


def _ranges_said(e: ReferenceElement) -> str:
    low, high = min(e.implied_k_v), max(e.implied_k_v)
    head = (
        f"The printed signals of {_printed(e.signal)} V and deflections of {_printed(e.deflection)} µm go "
        f"with a K_v of {interval(low, high)} V/mm; "
    )
    if low <= e.printed_k_v <= high:
        return head + f"Table 1's {e.printed_k_v:g} V/mm lies within."
    factor = e.printed_k_v / high if e.printed_k_v > high else low / e.printed_k_v
    return (
        head + f"Table 1 has {e.printed_k_v:g}, at least {sig(factor)} times "
        f"{'more' if e.printed_k_v > high else 'less'}. With that K_v the signals would mean "
        f"{interval(*e.deflection_from_signal)} µm."
    )


def _printed(pair: tuple[float, float]) -> str:
    return f"{pair[0]:g} to {pair[1]:g}"


# account of Table 2 -> how a sentence names it, and what it means when it alone fits
ACCOUNTS = {
    "as printed": ("as printed", "Then Table 1 and the reference element's readings agree as they stand."),
    "softer reference element": (
        "with a softer reference element",
        "Then its K in Table 1 is wrong, and its deflections in Table 2 are right.",
    ),
    "deflection scale of the reference element off": (
        "with its deflection scale off",
        "Then its K and K_v in Table 1 may stand, and its deflections behind Table 2, hence every R, "
        "are wrong by one factor.",
    ),
}


def _loads(e: ReferenceElement) -> str:
    """Which account of Table 2 the printed deflections and signals go with."""
    first = e.readings[0]
    said = "; ".join(
        f"{ACCOUNTS[r.name][0]}, {interval(*r.deflection)} µm and {interval(*r.signal, 2)} V"
        for r in e.readings
    )
    text = (
        "At the grasping force that the softest element's largest deflection fixes (about "
        f"{sig(first.load, 2)} N, or {first.weights:.0f} added weights, which the paper does not count) "
        f"the reference element would show: {said}. Printed are {_printed(e.deflection)} µm and "
        f"{_printed(e.signal)} V. "
    )
    both = [r.name for r in e.readings if r.deflection_agrees and r.signal_agrees]
    if len(both) == 1:
        return text + f"Only '{ACCOUNTS[both[0]][0]}' overlaps both ranges. {ACCOUNTS[both[0]][1]}"
    if both:
        return (
            text + f"{listed(repr(ACCOUNTS[n][0]) for n in both)} overlap both ranges: these readings do not "
            f"tell them apart."
        )
    some = [
        f"'{ACCOUNTS[r.name][0]}' only the {'deflections' if r.deflection_agrees else 'signals'}"
        for r in e.readings
        if r.deflection_agrees or r.signal_agrees
    ]
    return text + (f"None overlaps both ranges; {listed(some)}." if some else "None overlaps either range.")


def _explained(e: ReferenceElement) -> list[str]:
    telling = [x for x in e.explanations if abs(x.miss_per_deflection) > 2 * e.scatter]
    open_ = [x for x in e.explanations if x not in telling]
    ratio = e.stiffness / e.nominal_stiffness
    sentences = [
        f"No. {e.element}'s K is {sig(ratio)} times the beam model's {sig(e.nominal_stiffness)} N/mm. By "
        "K_v, "
        + listed(f"{x.name} ({_size(x)}) predicts {sig(x.signal_per_deflection)}" for x in e.explanations)
        + f" V/mm, where {e.printed_k_v:g} is printed. K_v of single elements scatters by "
        f"{percent(e.scatter)}: "
        + (
            f"{listed(x.name for x in telling)} {'are' if len(telling) > 1 else 'is'} unlikely (over two "
            f"standard deviations off), {listed(x.name for x in open_)} cannot be told apart."
            if telling
            else "none can be ruled out."
        )
    ]
    best, possible = e.best, [x for x in e.explanations if x.possible]
    sentences.append(
        f"Least off in K_v is {best.name}"
        + (
            f", and it is {best.limit}."
            if best.possible
            else f", but its size is beyond the {best.limit}."
            if best.name == "hinge thickness"
            else f", though {best.limit}."
        )
        + (
            f" Possible within the geometry: {listed(x.name for x in possible)} only."
            if possible
            else " None is possible within the geometry."
        )
    )
    return sentences


def _size(x: Explanation) -> str:
    return f"{x.size:+.2f} mm".replace("-", "−") if x.unit == "mm" else f"factor {sig(x.size)}"


def _ranges(e: ReferenceElement) -> ReportTable:
    rows = (
        ("printed signal, V", *e.signal),
        ("printed deflection, µm", *e.deflection),
        ("K_v that they imply, V/mm", *e.implied_k_v),
        (f"deflection by Table 1's K_v of {e.printed_k_v:g} V/mm, µm", *e.deflection_from_signal),
    )
    return table(
        "reference ranges",
        (("", ""), ("least", ""), ("largest", "")),
        rows,
        softest_k_v=sig(e.softest_k_v[0]),
        softest_k_v_2=sig(e.softest_k_v[1]),
    )


def _accounts(e: ReferenceElement) -> ReportTable:
    def pick(text: str, agrees: bool) -> Cell:
        return text if agrees else Marked(text)

    return tabulated(
        "reference accounts",
        e.readings,
        ("account", "", lambda r: r.name),
        ("K_r", "N/mm", lambda r: r.stiffness),
        ("load", "N", lambda r: r.load),
        ("added weights", "", lambda r: f"{r.weights:.1f}"),
        ("deflection as printed", "µm", lambda r: pick(interval(*r.deflection), r.deflection_agrees)),
        ("signal by K_v", "V", lambda r: pick(interval(*r.signal), r.signal_agrees)),
        deflection=_printed(e.deflection),
        signal=_printed(e.signal),
    )


def _explanations(e: ReferenceElement) -> ReportTable:
    def mark(v: float) -> Cell:
        text = f"{np.expm1(v) * 100:+.0f} %".replace("-", "−")
        return Marked(text) if abs(v) > 2 * e.scatter else text

    return tabulated(
        "reference explanations",
        e.explanations,
        ("explanation", "", lambda x: x.name),
        ("its size", "", _size),
        ("possible", "", lambda x: "yes" if x.possible else "no"),
        ("limit", "", lambda x: x.limit),
        ("K_v", "V/mm", lambda x: x.signal_per_deflection),
        ("printed is off by", "", lambda x: mark(x.miss_per_deflection)),
        ("K_v/K", "V/N", lambda x: x.signal_per_force),
        ("printed is off by", "", lambda x: mark(x.miss_per_force)),
        stiffness=e.stiffness,
        gain=sig(e.gain),
        scatter=percent(e.scatter),
    )


def _plot(e: ReferenceElement) -> Figure:
    with d.panels(size=(11.2, 3.1)) as (figure, ax):
        y = np.arange(len(e.explanations))[::-1]
        for place, x in zip(y, e.explanations):
            v = x.signal_per_deflection
            colour = d.BLUE if x.possible else d.GREY
            ax.errorbar(
                v,
                place,
                xerr=[[v * (1 - np.exp(-2 * e.scatter))], [v * (np.exp(2 * e.scatter) - 1)]],
                fmt="o",
                ms=8,
                color=colour,
                capsize=4,
                lw=2,
            )
        ax.axvline(e.printed_k_v, color=d.RED, ls="--", lw=2)
        d.note(ax, f"printed: {e.printed_k_v:g}", (e.printed_k_v, len(y) - 0.45), (6, 0), color=d.RED)
        ax.axvspan(min(e.implied_k_v), max(e.implied_k_v), color=d.ORANGE, alpha=0.35, lw=0)
        d.note(
            ax,
            "printed signals over\nprinted deflections",
            (max(e.implied_k_v), len(y) - 0.62),
            (6, 0),
            fontsize=9.5,
        )
        ax.set_yticks(y, [x.name for x in e.explanations])
        ax.set(
            ylim=(-0.6, len(y) - 0.05),
            xlim=0,
            xlabel=f"K_v of no. {e.element}, V/mm (bars: two standard deviations; blue: possible within the "
            "geometry)",
        )
        return drawn(figure, "reference-element", element=e.element)
