"""The reference element: its printed signals compared with its printed deflections, and possible explanations
of its stiffness.

Each explanation takes Table 1's K as given and predicts K_v and K_v/K with the gain that fits the other
elements.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.mechanics import gauge_signal, ladder, lumped
from tactcad.mechanics.section import HingeSection
from tactcad.paper.array_model import ArrayModel
from tactcad.paper.grasp_figures import elements_in_parallel
from tactcad.paper.published import Published
from tactcad.paper.reference_stiffness import Table2Study
from tactcad.paper.residuals import matched, solve
from tactcad.report import plots as d
from tactcad.report.figures import sig
from tactcad.report.report import Picture, ReportSection, ReportTable

from .prose import drawn, marked, saying, section, table


@dataclass(frozen=True)
class Explanation:
    """Predictions of one cause, sized to give the printed K; V/mm and V/N."""

    name: str
    size: float  # of the cause
    unit: str
    possible: bool  # within what the geometry or the process allows
    limit: str
    stiffness: float
    signal_per_deflection: float
    signal_per_force: float
    miss_per_deflection: float  # ln(printed/predicted)
    miss_per_force: float


@dataclass(frozen=True)
class AccountReading:
    """Readings of the reference element if one account of Table 2 were true; smallest and largest over the
    samples.

    The whole load is the one that deflects the softest element by the largest deflection that the paper
    prints.
    """

    name: str
    stiffness: float
    load: float  # N
    weights: float  # added ones that make this load
    deflection: tuple[float, float]  # um, as the paper would have printed it
    signal: tuple[float, float]  # V, with Table 1's K_v
    deflection_agrees: bool  # overlaps the printed range
    signal_agrees: bool


@dataclass(frozen=True)
class ReferenceElement:
    """Signals V, deflections um, K_v V/mm, forces N."""

    element: int
    stiffness: float
    nominal_stiffness: float
    twin: int | None  # element of equal arm, measured K nearest the model's
    printed_k_v: float
    signal: tuple[float, float]
    deflection: tuple[float, float]
    implied_k_v: tuple[float, float]  # smallest over smallest, largest over largest
    deflection_from_signal: tuple[float, float]  # with the printed K_v
    softest_k_v: tuple[float, float]  # largest printed signal over largest printed deflection, and Table 1's
    readings: tuple[AccountReading, ...]  # by account of Table 2
    gain: float  # V per strain, from the other elements
    scatter: float  # of ln K_v about it
    explanations: tuple[Explanation, ...]
    from_k_v_thickness: tuple[float, float, float]  # K_r, low, high: K_v taken as true, thickness free
    from_k_v_load_point: tuple[float, float, float]

    @property
    def best(self) -> Explanation:
        """The explanation with the least deviation of K_v and K_v/K."""
        return min(self.explanations, key=lambda e: abs(e.miss_per_deflection) + abs(e.miss_per_force))


def study(data: Published, array: ArrayModel, table2: Table2Study) -> ReferenceElement:
    """Everything about Table 2's reference element, whichever it is."""
    supported = table2.supported.value[0]
    factor = table2.fit("R times a factor").value[0]
    here, s = matched(data, array)
    t1, figure = data.table1, data.figure
    own = int(np.flatnonzero(here == data.reference)[0])
    K, k_v = t1.stiffness.value[here], np.abs(t1.signal_per_deflection.value[here])
    section = s.rows([own])
    q = gauge_signal.foil_strain_per_deflection(s, array.gauge)
    others = np.arange(len(here)) != own
    log_gain = np.log(k_v / q)[others]
    gain, scatter = float(np.exp(log_gain.mean())), float(log_gain.std(ddof=1))
    nominal = float(ladder.stiffness(section)[0])
    signal = (figure["reference_signal_least"], figure["reference_signal_most"])
    deflection = (figure["reference_deflection_least"], figure["reference_deflection_most"])
    printed = (K[own], k_v[own])
    return ReferenceElement(
        int(t1.element[here[own]]),
        float(K[own]),
        nominal,
        _twin(t1.element[here], t1.arm.value[here], K, own, nominal),
        float(k_v[own]),
        signal,
        deflection,
        (signal[0] / deflection[0] * 1e3, signal[1] / deflection[1] * 1e3),
        (signal[0] / k_v[own] * 1e3, signal[1] / k_v[own] * 1e3),
        (figure["softest_signal_most"] / figure["softest_deflection_most"] * 1e3, float(k_v[np.argmin(K)])),
        tuple(
            _reading(data, array, name, K_r, share, k_v[own], deflection, signal)
            for name, K_r, share in (
                ("as printed", K[own], 1.0),
                ("softer reference element", supported, 1.0),
                ("deflection scale of the reference element off", K[own], factor),
            )
        ),
        gain,
        scatter,
        _explanations(section, array, printed, gain, nominal),
        _from_k_v("hinge_thickness", section, array, k_v[own] / gain, scatter),
        _from_k_v("load_arm", section, array, k_v[own] / gain, scatter),
    )


def _twin(number: np.ndarray, arm: np.ndarray, K: np.ndarray, own: int, nominal: float) -> int | None:
    same = [i for i in range(len(arm)) if arm[i] == arm[own] and i != own]
    return int(number[min(same, key=lambda i: abs(np.log(K[i] / nominal)))]) if same else None


def _reading(
    data: Published,
    array: ArrayModel,
    name: str,
    K_r: float,
    factor: float,
    k_v: float,
    deflection: tuple[float, float],
    signal: tuple[float, float],
) -> AccountReading:
    """`factor`: the reference element's true deflection over the printed one, the factor by which R is
    wrong.
    """
    truth, reference = elements_in_parallel(data, array)
    K = truth.stiffness.copy()
    K[reference] = K_r
    d = lumped.element_deflection(K[:, None], data.table2.object_stiffness.value[None, :], 1.0)
    per_newton = d / (K[:, None] * d).sum(0)
    softest = int(np.argmin(data.table1.stiffness.value))
    load = data.figure["softest_deflection_most"] * 1e-3 / per_newton[softest].max()
    true = per_newton[reference] * load
    shown = (float(true.min() / factor * 1e3), float(true.max() / factor * 1e3))
    volts = (float(true.min() * k_v), float(true.max() * k_v))
    overlap = lambda a, b: bool(a[0] <= b[1] and b[0] <= a[1])  # noqa: E731
    return AccountReading(
        name,
        float(K_r),
        float(load),
        float((load - array.grasping.moving_weight) / array.grasping.weight),
        shown,
        volts,
        overlap(shown, deflection),
        overlap(volts, signal),
    )


def _explanations(
    s: HingeSection, array: ArrayModel, printed: tuple[float, float], gain: float, nominal: float
) -> tuple[Explanation, ...]:
    K, k_v = printed
    q0 = float(gauge_signal.foil_strain_per_deflection(s, array.gauge)[0])
    L0, t0 = float(s.load_arm[0]), float(s.hinge_thickness[0])
    L = float(solve(s, "load_arm", np.array([K]), 0.2, 3.0)[0])
    t = float(solve(s, "hinge_thickness", np.array([K]), 0.3, 3.0)[0])
    # Strain and deflection are both taken at the load point, which a calibration's roller also is.
    q_load = float(gauge_signal.foil_strain_per_deflection(s.with_(load_arm=[L]), array.gauge)[0])
    q_thick = float(gauge_signal.foil_strain_per_deflection(s.with_(hinge_thickness=[t]), array.gauge)[0])
    scale = K / nominal
    pad, wire = array.pad_length / 2, array.tolerance.hinge_thickness
    on_pad, as_cut = f"within the pad, {pad:g} mm either way", f"cutting tolerance {wire:g} mm"
    one_rig = "one rig calibrated all elements"
    candidates = [
        ("load point", L - L0, "mm", bool(abs(L - L0) <= pad), on_pad, gain * q_load),
        ("hinge thickness", t - t0, "mm", bool(abs(t - t0) <= wire), as_cut, gain * q_thick),
        ("deflection scale of its calibration", 1 / scale, "1", False, one_rig, gain * q0 * scale),
        ("force scale of its calibration", scale, "1", False, one_rig, gain * q0),
    ]
    ln = lambda x: float(np.log(x))  # noqa: E731
    return tuple(
        Explanation(name, size, unit, possible, limit, K, v, v / K, ln(k_v / v), ln(k_v / K / (v / K)))
        for name, size, unit, possible, limit, v in candidates
    )


def _from_k_v(
    name: str, s: HingeSection, array: ArrayModel, q: float, scatter: float
) -> tuple[float, float, float]:
    """K (N/mm) when one dimension is what makes strain per deflection q, and for q a 95 % scatter lower and
    higher.

    0 or inf if no value of that dimension within the rung's range does.
    """
    factor = np.geomspace(0.35, 2.5, 800)
    grid = s.rows(np.zeros(len(factor), int)).with_(**{name: float(getattr(s, name)[0]) * factor})
    result = ladder.evaluate(grid)
    usable = grid.rows(np.flatnonzero(result.valid))
    q_grid = gauge_signal.foil_strain_per_deflection(usable, array.gauge)
    order = np.argsort(q_grid)
    log_q, log_k = np.log(q_grid[order]), np.log(result.stiffness[result.valid][order])
    stiffness = [
        float(np.exp(np.interp(np.log(q) + shift * scatter, log_q, log_k, left=-np.inf, right=np.inf)))
        for shift in (0.0, -1.96, 1.96)
    ]
    return stiffness[0], stiffness[1], stiffness[2]


def page(e: ReferenceElement) -> ReportSection:
    return section(
        "reference",
        findings(e),
        (_ranges(e), _accounts(e), _explanation_table(e)),
        (_plot(e),),
        e,
        (_loads(e),),
        element=e.element,
    )


def findings(e: ReferenceElement) -> tuple[str, ...]:
    say = saying("reference", e=e)
    low, high = min(e.implied_k_v), max(e.implied_k_v)
    more, less = e.printed_k_v / high, low / e.printed_k_v
    way, factor = ("more", more) if more > 1 else ("less", less)
    inside = say("inside") if max(more, less) <= 1 else say("outside", way=way, factor=factor)
    telling = [x.name for x in e.explanations if abs(x.miss_per_deflection) > 2 * e.scatter]
    open_ = [x.name for x in e.explanations if x.name not in telling]
    possible = [x.name for x in e.explanations if x.possible]
    predicted = [
        say("predicts", name=x.name, size=_size(x), k_v=x.signal_per_deflection) for x in e.explanations
    ]
    beyond = "possible" if e.best.possible else "beyond" if e.best.name == "hinge thickness" else "though"
    return (
        say("ranges", implied=(low, high), inside=inside),
        _loads(e),
        say(
            "explained",
            ratio=e.stiffness / e.nominal_stiffness,
            predicted=predicted,
            told=say("told", telling=telling, verb="are" if len(telling) > 1 else "is", open=open_)
            if telling
            else say("not told"),
        ),
        say(
            "best",
            best=e.best,
            but=say(beyond, limit=e.best.limit),
            which=say("geometry", possible=possible) if possible else say("no geometry"),
        ),
    )


def _loads(e: ReferenceElement) -> str:
    """The explanation of Table 2 that agrees with the printed deflections and signals."""
    say, first = saying("reference", e=e), e.readings[0]
    names = {r.name: say(f"account {r.name}") for r in e.readings}
    readings = "; ".join(say("reading", name=names[r.name], r=r) for r in e.readings)
    both = [r.name for r in e.readings if r.deflection_agrees and r.signal_agrees]
    some = [
        f"'{names[r.name]}' only the {'deflections' if r.deflection_agrees else 'signals'}"
        for r in e.readings
        if r.deflection_agrees or r.signal_agrees
    ]
    return say("loads", first=first, readings=readings) + (
        say("only", name=names[both[0]], meaning=say(f"meaning {both[0]}"))
        if len(both) == 1
        else say("several", names=[repr(names[n]) for n in both])
        if both
        else say("one range", some=some)
        if some
        else say("no range")
    )


def _size(x: Explanation) -> str:
    return f"{x.size:+.2f} mm".replace("-", "−") if x.unit == "mm" else f"factor {sig(x.size)}"


def _ranges(e: ReferenceElement) -> ReportTable:
    ranges = np.array([e.signal, e.deflection, e.implied_k_v, e.deflection_from_signal])
    by_k_v = f"deflection by Table 1's K_v of {e.printed_k_v:g} V/mm, µm"
    names = ("printed signal, V", "printed deflection, µm", "K_v that they imply, V/mm", by_k_v)
    return table("reference ranges", names, *ranges.T, e=e)


def _accounts(e: ReferenceElement) -> ReportTable:
    return table(
        "reference accounts",
        [r.name for r in e.readings],
        [r.stiffness for r in e.readings],
        [r.load for r in e.readings],
        [r.weights for r in e.readings],
        marked([r.deflection for r in e.readings], [not r.deflection_agrees for r in e.readings]),
        marked([r.signal for r in e.readings], [not r.signal_agrees for r in e.readings]),
        e=e,
    )


def _explanation_table(e: ReferenceElement) -> ReportTable:
    miss = np.array([(x.miss_per_deflection, x.miss_per_force) for x in e.explanations]).T
    by_k_v, by_force = (marked(np.expm1(m), np.abs(m) > 2 * e.scatter) for m in miss)
    return table(
        "reference explanations",
        [x.name for x in e.explanations],
        [_size(x) for x in e.explanations],
        ["yes" if x.possible else "no" for x in e.explanations],
        [x.limit for x in e.explanations],
        [x.signal_per_deflection for x in e.explanations],
        by_k_v,
        [x.signal_per_force for x in e.explanations],
        by_force,
        e=e,
    )


# explanation of Table 2 -> its name in a sentence, and its meaning if only it fits
def _plot(e: ReferenceElement) -> Picture:
    with d.panels(size=(11.2, 3.1)) as (figure, ax):
        y = np.arange(len(e.explanations))[::-1]
        for place, x in zip(y, e.explanations):
            v = x.signal_per_deflection
            colour = d.BLUE if x.possible else d.GREY
            bars = [[v * (1 - np.exp(-2 * e.scatter))], [v * (np.exp(2 * e.scatter) - 1)]]
            ax.errorbar(v, place, xerr=bars, fmt="o", ms=8, color=colour, capsize=4, lw=2)
        ax.axvline(e.printed_k_v, color=d.RED, ls="--", lw=2)
        d.note(ax, f"printed: {e.printed_k_v:g}", (e.printed_k_v, len(y) - 0.45), (6, 0), color=d.RED)
        ax.axvspan(min(e.implied_k_v), max(e.implied_k_v), color=d.ORANGE, alpha=0.35, lw=0)
        over = "printed signals over\nprinted deflections"
        d.note(ax, over, (max(e.implied_k_v), len(y) - 0.62), (6, 0), fontsize=9.5)
        ax.set_yticks(y, [x.name for x in e.explanations])
        ax.set(
            ylim=(-0.6, len(y) - 0.05),
            xlim=0,
            xlabel=f"K_v of no. {e.element}, V/mm (bars: two standard deviations; blue: possible within the "
            "geometry)",
        )
        return drawn(figure, "reference-element", element=e.element)
