"""The plot of what was taken for what: the driving column and every channel over time, the steps shaded,
their means as dots."""

from __future__ import annotations

import numpy as np

from tactcad.report.plots import BLACK, GREY, MARKERS, SERIES, panels, svg

from .log_readings import Taken

POINTS = 2000  # drawn of a longer log: the least and the largest value of each stretch


def picture(taken: Taken) -> str:
    """SVG text."""
    driven = taken.drive is not None
    with panels(1 + driven, 1, (11.2, 3.2 + 4.2 * driven), sharex=True, squeeze=False) as (figure, axes):
        *above, ax = axes[:, 0]
        shown = "displacement" if taken.kind == "calibration" else "load"
        for top in above:
            top.plot(*_thinned(taken.time, taken.drive), color=GREY, lw=0.8)
            top.set(title=f"what tells the steps; above each the {shown} that was taken", ylabel="as logged")
        middle = [s.time for s in taken.steps]
        marked = above[0] if above else ax
        if len(taken.steps) <= 40:
            for s, x in zip(taken.steps, middle):
                text = f"{s.values[shown]:.4g}"
                marked.annotate(
                    text, (x, 1.0), xycoords=("data", "axes fraction"), ha="center", va="top", fontsize=7
                )
        for panel in axes[:, 0]:
            for s in taken.steps:
                panel.axvspan(taken.time[s.first], taken.time[s.last], color="#dcebf5", lw=0)
        for i, (n, volts) in enumerate(taken.volts.items()):
            own = [s for s in taken.steps if s.values.get("element", n) == n]
            base = volts[own[0].rows].mean() if own else 0.0
            color = SERIES[i % len(SERIES)]
            ax.plot(*_thinned(taken.time, volts - base), color=color, lw=0.5, alpha=0.4)
            means = [volts[s.rows].mean() - base for s in own]
            label = f"{n}: {taken.columns[n]}"
            ax.plot(
                [s.time for s in own],
                means,
                MARKERS[i // len(SERIES) % len(MARKERS)],
                color=color,
                ms=4,
                label=label,
            )
        for n, why in taken.left_out.items():
            ax.plot(
                [], [], "x", color=BLACK, label=f"{n}: {taken.columns[n]}, left out ({why.split(':')[0]})"
            )
        ax.set(
            xlabel="time, s",
            ylabel="signal less that of the first step, V",
            title="channels, and the means taken",
        )
        ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), title="element: column")
        figure.suptitle(f"{taken.kind} readings from {taken.log.path.rsplit('/', 1)[-1]}", x=0.01, ha="left")
        return svg(figure, "readings")


def _thinned(time: np.ndarray, values: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest value of each of at most POINTS/2 stretches."""
    assert values is not None
    stretch = -(-len(time) // (POINTS // 2))
    if stretch < 3:
        return time, values
    edge = np.arange(0, len(time), stretch)
    low, high = np.minimum.reduceat(values, edge), np.maximum.reduceat(values, edge)
    return np.repeat(time[edge], 2), np.column_stack([low, high]).ravel()
