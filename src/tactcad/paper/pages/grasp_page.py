"""Section 6: Figures 6 and 7 redrawn."""

from __future__ import annotations

import numpy as np

from tactcad.paper.array_model import ArrayModel
from tactcad.paper.grasp_figures import Figure6, Figure7, Simulated
from tactcad.paper.prose import drawn, section, tabulated
from tactcad.report import plots as d
from tactcad.report.report import Figure, ReportSection, ReportTable, interval, percent, sig, signed_percent

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
    better = _miss(six, six.as_supported) < _miss(six, six.as_printed)
    uneven = float((six.with_pad_heights.deviation / six.with_pad_heights.true[:, None]).max())
    noise = float((six.as_supported.deviation / six.as_supported.true[:, None]).max())
    sentences = [
        f"For the {six.object_stiffness:g} N/mm sample the simulation with K_r = "
        f"{sig(six.as_supported.reference_stiffness)} N/mm is {percent(_miss(six, six.as_supported))} "
        f"(rms) from Table 2's R; with the printed {six.as_printed.reference_stiffness:g} it is "
        f"{percent(_miss(six, six.as_printed))}. "
        + ("The supported one is closer." if better else "The printed one is closer."),
        "R does not depend on the load as long as pads are in one plane: read-out noise moves it by at "
        f"most {percent(noise)} (one standard deviation, at {six.load[0]:g} N). Pads out of plane by "
        f"±{array.tolerance.pad_height * 1e3:g} µm move an R made of totals by {percent(uneven)} there, "
        f"{'which Figure 6 would show' if uneven > VISIBLE else 'which Figure 6 would hardly show'}; "
        "made of slopes, R keeps to "
        f"{percent(float(np.abs(six.slopes_with_pad_heights / six.with_pad_heights.true - 1).max()))}.",
        "At the largest load the simulated reference element deflects by "
        f"{sig(six.as_supported.reference_deflection[-1])} µm with the supported and by "
        f"{sig(six.as_printed.reference_deflection[-1])} µm with the printed stiffness (section 7 holds "
        "both against the printed range).",
    ]
    sentences.append(
        f"The paper's six straight lines of R over K_m/K_obj leave {sig(seven.line_rms)} (rms of R) with "
        f"{seven.line_parameters} parameters; equation (2) leaves {sig(seven.model_rms)} with "
        f"{seven.model_parameters}, and bends: R levels off at K_r/K_m. "
        + (
            "The points scatter too much to tell which is right."
            if seven.p_lines > 0.01
            else f"The lines fit better than chance allows (F test, p {seven.p_lines:.0e}): one reference "
            f"stiffness alone does not carry all of Table 2."
        )
    )
    return tuple(sentences)


def _miss(six: Figure6, s: Simulated) -> float:
    return float((np.log(six.measured / s.true) ** 2).mean() ** 0.5)


def _table6(six: Figure6) -> ReportTable:
    least, most = six.load[0], six.load[-1]

    def off(s: Simulated, i: int) -> str:
        return signed_percent(s.true[i] / six.measured[i] - 1)

    return tabulated(
        "grasp table6",
        range(len(six.measuring)),
        ("K_m", "N/mm", lambda i: f"{six.measuring[i]:g}"),
        ("R measured", "", lambda i: six.measured[i]),
        ("R, supported K_r", "", lambda i: six.as_supported.true[i]),
        ("off", "", lambda i: off(six.as_supported, i)),
        ("R, printed K_r", "", lambda i: six.as_printed.true[i]),
        ("off", "", lambda i: off(six.as_printed, i)),
        ("s of R by noise", f"{least:g} N", lambda i: six.as_supported.deviation[i, 0]),
        ("s of R by pad heights", f"{least:g} N", lambda i: six.with_pad_heights.deviation[i, 0]),
        ("the same", f"{most:.4g} N", lambda i: six.with_pad_heights.deviation[i, -1]),
        object_stiffness=six.object_stiffness,
    )


def _table7(seven: Figure7) -> ReportTable:
    return tabulated(
        "grasp table7",
        range(len(seven.measuring)),
        ("K_m", "N/mm", lambda i: f"{seven.measuring[i]:g}"),
        ("K_m/K_obj", "", lambda i: interval(seven.relative[i].min(), seven.relative[i].max())),
        ("R", "", lambda i: interval(seven.ratio[i].min(), seven.ratio[i].max())),
        ("slope of the line", "", lambda i: seven.slope[i]),
    )


def _figure6(six: Figure6) -> Figure:
    with d.panels(1, 3, size=(11.2, 4.9), sharey=True) as (figure, axes):
        shown = (
            (six.as_printed, f"printed K_r = {six.as_printed.reference_stiffness:g} N/mm"),
            (six.as_supported, f"supported K_r = {six.as_supported.reference_stiffness:.1f} N/mm"),
            (six.with_pad_heights, "supported K_r, pads out of plane"),
        )
        for ax, (s, title) in zip(axes, shown):
            for i, k in enumerate(six.measuring):
                ax.errorbar(
                    six.load,
                    s.ratio[i],
                    yerr=2 * s.deviation[i],
                    fmt=d.MARKERS[i],
                    color=d.SERIES[i],
                    ms=5,
                    lw=1.1,
                    capsize=2,
                    label=f"K_m = {k:g}",
                )
                d.series(ax, i, six.load[-1] + 1.1, six.measured[i], hollow=True, mew=1.6)
            ax.set_title(title, fontsize=10.5)
            ax.set(xlabel="grasping force, N", xlim=(six.load[0] - 0.7, six.load[-1] + 1.8))
        axes[0].set(ylabel="deflection ratio R", ylim=(0, None))
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(
            handles,
            labels,
            loc="outside lower center",
            ncols=len(labels),
            columnspacing=1.2,
            handletextpad=0.3,
        )
        return drawn(figure, "figure-6", object_stiffness=six.object_stiffness)


def _figure7(seven: Figure7) -> Figure:
    with d.panels(1, 2, size=(11.2, 5.0), sharey=True) as (figure, axes):
        for ax, curves, title in (
            (axes[0], seven.printed, "equation (2), printed K_r"),
            (axes[1], seven.supported, f"equation (2), K_r = {seven.supported_stiffness:.1f} N/mm"),
        ):
            for i, k in enumerate(seven.measuring):
                own = (seven.axis >= seven.relative[i].min() * 0.93) & (
                    seven.axis <= seven.relative[i].max() * 1.07
                )
                ax.plot(seven.axis[own], curves[i][own], color=d.SERIES[i], lw=2)
                d.series(ax, i, seven.relative[i], seven.ratio[i], label=f"K_m = {k:g}")
            d.log_axes(ax, x=(0.6, 1, 2, 4, 8, 16))
            ax.set(title=title, xlabel="K_m/K_obj", ylim=(0, 11))
        axes[0].set_ylabel("deflection ratio R")
        axes[1].legend(loc="upper right", ncols=2, title="measured, N/mm")
        return drawn(figure, "figure-7")
