"""Figures 6 and 7 again: R against the grasping force, simulated, and R against K_m/K_obj, measured and by
equation (2).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import fdtrc

from tactcad.contact import springs
from tactcad.mechanics import ladder, lumped
from tactcad.paper.array_model import ArrayModel
from tactcad.paper.published import Published
from tactcad.paper.reference_stiffness import Table2Study
from tactcad.report import plots as d
from tactcad.report.report import Picture, ReportSection, ReportTable

from .prose import drawn, saying, section, table

REPEATS = 400  # simulated grasps for the error bars


@dataclass(frozen=True)
class Truth:
    """The simulated array's true values; arrays, [element]."""

    element: np.ndarray  # numbers
    stiffness: np.ndarray  # K, N/mm
    signal_per_deflection: np.ndarray  # K_v, V/mm
    zero_signal: np.ndarray  # V_0, V


def grasp_signals(
    truth: Truth,
    load: np.ndarray,
    object_stiffness: float,
    noise: float,
    rng: np.random.Generator,
    pad_height: np.ndarray | float = 0.0,
) -> np.ndarray:
    """Signals (V) of a grasp, [element, load]: of separate springs, with a standard deviation of `noise`
    (V, of the averaged reading); `pad_height` over the pads' plane, mm, [element]."""
    deflection = springs.press(truth.stiffness, object_stiffness, load, -np.asarray(pad_height))[2]
    clean = truth.zero_signal[:, None] + truth.signal_per_deflection[:, None] * deflection
    return clean + noise * rng.standard_normal(clean.shape)


@dataclass(frozen=True)
class Simulated:
    """R [measuring element, load] of one simulated array: one grasp as drawn, standard deviation over many,
    truth.
    """

    reference_stiffness: float
    ratio: np.ndarray
    deviation: np.ndarray
    true: np.ndarray  # equation (2)
    reference_deflection: np.ndarray  # um, by load


@dataclass(frozen=True)
class Figure6:
    measuring: np.ndarray  # N/mm
    object_stiffness: float
    load: np.ndarray  # N
    measured: np.ndarray  # Table 2's R of this sample, by measuring element
    as_printed: Simulated
    as_supported: Simulated
    with_pad_heights: Simulated  # supported stiffness, pads out of plane by the tolerance: R from totals
    slopes_with_pad_heights: np.ndarray  # R from slopes of the same grasps, mean over many, by element


def elements_in_parallel(data: Published, array: ArrayModel) -> tuple[Truth, int]:
    """All elements that press on the sample: Table 1's, and by the beam model those of the design that it
    leaves out.

    Returns the truth for a simulation and the index of the reference element.
    """
    t = data.table1
    K_model = ladder.stiffness(array.section)
    unread = ~np.isin(array.number, t.element)
    number = np.concatenate([t.element, array.number[unread]])
    stiffness = np.concatenate([t.stiffness.value, K_model[unread]])
    fill = np.full(int(unread.sum()), float(np.median(t.signal_per_deflection.value)))
    k_v = np.concatenate([t.signal_per_deflection.value, fill])
    zero = np.concatenate([t.zero_signal.value, np.zeros(len(fill))])
    return Truth(number, stiffness, k_v, zero), data.reference


def figure_6(data: Published, array: ArrayModel, supported: float, rng: np.random.Generator) -> Figure6:
    """The sample of Figure 6 at the moving weight and each added weight."""
    truth, reference = elements_in_parallel(data, array)
    K_m = data.table2.measuring_stiffness.value
    rows = np.array([int(np.argmin(np.abs(truth.stiffness - k))) for k in K_m])
    x = data.figure["figure_6_sample"]
    column = int(np.argmin(np.abs(data.table2.object_stiffness.value - x)))
    load = array.grasping.moving_weight + array.grasping.weight * np.arange(array.grasping.weights + 1)
    noise = array.readout.averaged_noise
    heights = array.tolerance.pad_height / 2 * rng.standard_normal((REPEATS, len(truth.element)))

    def simulated(K_r: float, height: np.ndarray | None) -> tuple[Simulated, np.ndarray]:
        K = truth.stiffness.copy()
        K[reference] = K_r
        here = replace(truth, stiffness=K)
        ratios, slopes = [], []
        for i in range(REPEATS):
            signal = grasp_signals(here, load, x, noise, rng, 0.0 if height is None else height[i])
            d = (signal - here.zero_signal[:, None]) / here.signal_per_deflection[:, None]
            ratios.append(d[rows] / d[reference])
            g = (d - d.mean(1, keepdims=True)) @ (load - load.mean())
            slopes.append(g[rows] / g[reference])
        true = lumped.deflection_ratio(K_r, K_m, x)
        clean = springs.press(K, x, load)[2]
        result = Simulated(K_r, ratios[0], np.array(ratios).std(0), true, clean[reference] * 1e3)
        return result, np.array(slopes).mean(0)

    printed, _ = simulated(data.figure["reference_stiffness"], None)
    own, _ = simulated(supported, None)
    uneven, slopes = simulated(supported, heights)
    return Figure6(K_m, x, load, data.table2.ratio.value[:, column], printed, own, uneven, slopes)


@dataclass(frozen=True)
class Figure7:
    """Measured points [measuring element, sample] and equation (2) over K_m/K_obj for two reference
    stiffnesses.
    """

    measuring: np.ndarray
    relative: np.ndarray  # K_m/K_obj of the points
    ratio: np.ndarray
    axis: np.ndarray
    printed: np.ndarray  # [measuring element, axis]
    supported: np.ndarray
    supported_stiffness: float
    slope: np.ndarray  # of the straight line R = c + slope K_m/K_obj through each element's points
    line_rms: float  # of R about these lines
    model_rms: float  # of R about equation (2) with the supported stiffness
    line_parameters: int
    model_parameters: int
    p_lines: float  # probability that the lines fit so much better by chance (F test)


def figure_7(study: Table2Study) -> Figure7:
    """R against K_m/K_obj with the object stiffness of Table 2's header."""
    k, x, R = study.measuring, study.object_printed, study.ratio
    relative = k[:, None] / x[None, :]
    axis = np.geomspace(relative.min() * 0.8, relative.max() * 1.2, 80)
    K_r = study.supported.value[0]
    lines = [np.polyfit(a, b, 1) for a, b in zip(relative, R)]
    straight = np.array([np.polyval(p, a) for p, a in zip(lines, relative)])
    model = lumped.deflection_ratio(K_r, k[:, None], x[None, :])
    curve = lambda r: lumped.deflection_ratio(r, k[:, None], k[:, None] / axis[None, :])  # noqa: E731
    return Figure7(
        k,
        relative,
        R,
        axis,
        curve(study.reference_printed),
        curve(K_r),
        K_r,
        np.array([p[0] for p in lines]),
        float(((R - straight) ** 2).mean() ** 0.5),
        float(((R - model) ** 2).mean() ** 0.5),
        2 * len(k),
        1,
        _chance(R, straight, model, 2 * len(k)),
    )


def _chance(R: np.ndarray, straight: np.ndarray, model: np.ndarray, parameters: int) -> float:
    """F test of the lines against a one-parameter model that is not nested in them: a guide, not a proof."""
    lines, one = ((R - straight) ** 2).sum(), ((R - model) ** 2).sum()
    extra, rest = parameters - 1, R.size - parameters
    return float(fdtrc(extra, rest, max(one - lines, 0.0) / extra / (lines / rest)))


VISIBLE = 0.05  # drift of R over the load that a reader sees in Figure 6


def page(six: Figure6, seven: Figure7, array: ArrayModel) -> ReportSection:
    return section(
        "figures",
        findings(six, seven, array),
        (_table6(six), _table7(seven)),
        (_figure6(six), _figure7(seven)),
        {"figure_6": six, "figure_7": seven},
    )


def findings(six: Figure6, seven: Figure7, array: ArrayModel) -> tuple[str, ...]:
    say, own, printed = saying("figures", six=six, seven=seven), six.as_supported, six.as_printed
    own_miss, printed_miss = _miss(six, own), _miss(six, printed)
    uneven, noise = (
        float((s.deviation / s.true[:, None]).max()) for s in (six.with_pad_heights, six.as_supported)
    )
    slopes = float(np.abs(six.slopes_with_pad_heights / six.with_pad_heights.true - 1).max())
    return (
        say(
            "closer",
            own_miss=own_miss,
            printed_miss=printed_miss,
            better="supported" if own_miss < printed_miss else "printed",
        ),
        say(
            "load",
            noise=noise,
            height=array.tolerance.pad_height * 1e3,
            uneven=uneven,
            shown="would show" if uneven > VISIBLE else "would hardly show",
            slopes=slopes,
        ),
        say("deflection", own=own.reference_deflection[-1], printed=printed.reference_deflection[-1]),
        say("lines", which=say("scatter" if seven.p_lines > 0.01 else "no chance")),
    )


def _miss(six: Figure6, s: Simulated) -> float:
    return float((np.log(six.measured / s.true) ** 2).mean() ** 0.5)


def _table6(six: Figure6) -> ReportTable:
    own, printed, uneven = six.as_supported, six.as_printed, six.with_pad_heights
    return table(
        "grasp table6",
        *(six.measuring, six.measured),
        *(own.true, own.true / six.measured - 1),
        *(printed.true, printed.true / six.measured - 1),
        *(own.deviation[:, 0], uneven.deviation[:, 0], uneven.deviation[:, -1]),
        six=six,
        most=six.load[-1],
    )


def _table7(seven: Figure7) -> ReportTable:
    spans = ([(row.min(), row.max()) for row in points] for points in (seven.relative, seven.ratio))
    return table("grasp table7", seven.measuring, *spans, seven.slope)


def _figure6(six: Figure6) -> Picture:
    with d.panels(1, 3, size=(11.2, 4.9), sharey=True) as (figure, axes):
        shown = (
            (six.as_printed, f"printed K_r = {six.as_printed.reference_stiffness:g} N/mm"),
            (six.as_supported, f"supported K_r = {six.as_supported.reference_stiffness:.1f} N/mm"),
            (six.with_pad_heights, "supported K_r, pads out of plane"),
        )
        for ax, (s, title) in zip(axes, shown):
            for i, k in enumerate(six.measuring):
                bars = {"ms": 5, "lw": 1.1, "capsize": 2, "label": f"K_m = {k:g}"}
                d.with_bars(ax, i, six.load, s.ratio[i], 2 * s.deviation[i], **bars)
                d.series(ax, i, six.load[-1] + 1.1, six.measured[i], hollow=True, mew=1.6)
            ax.set_title(title, fontsize=10.5)
            ax.set(xlabel="grasping force, N", xlim=(six.load[0] - 0.7, six.load[-1] + 1.8))
        axes[0].set(ylabel="deflection ratio R", ylim=(0, None))
        d.legend_below(figure, axes[0].get_legend_handles_labels()[0])
        return drawn(figure, "figure-6", object_stiffness=six.object_stiffness)


def _figure7(seven: Figure7) -> Picture:
    with d.panels(1, 2, size=(11.2, 5.0), sharey=True) as (figure, axes):
        for ax, curves, title in (
            (axes[0], seven.printed, "equation (2), printed K_r"),
            (axes[1], seven.supported, f"equation (2), K_r = {seven.supported_stiffness:.1f} N/mm"),
        ):
            for i, k in enumerate(seven.measuring):
                least, most = seven.relative[i].min() * 0.93, seven.relative[i].max() * 1.07
                own = (seven.axis >= least) & (seven.axis <= most)
                ax.plot(seven.axis[own], curves[i][own], color=d.SERIES[i], lw=2)
                d.series(ax, i, seven.relative[i], seven.ratio[i], label=f"K_m = {k:g}")
            d.log_axes(ax, x=(0.6, 1, 2, 4, 8, 16))
            ax.set(title=title, xlabel="K_m/K_obj", ylim=(0, 11))
        axes[0].set_ylabel("deflection ratio R")
        axes[1].legend(loc="upper right", ncols=2, title="measured, N/mm")
        return drawn(figure, "figure-7")
