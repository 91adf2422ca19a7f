"""Section 8: the uncertainty budget."""

from __future__ import annotations

import numpy as np

from tactcad.paper.budget import Budget
from tactcad.paper.prose import drawn, section, tabulated
from tactcad.report import plots as d
from tactcad.report.report import Figure, ReportSection, ReportTable, listed, percent, sig

MATTERS = 0.05


def page(b: Budget) -> ReportSection:
    return section(
        "budget",
        findings(b),
        (_table(b),),
        (_plot(b),),
        b,
        reference=sig(b.reference),
        measuring=b.measuring,
        object_stiffness=b.object_stiffness,
    )


def findings(b: Budget) -> tuple[str, ...]:
    top = b.effects[:3]
    small = next(e for e in b.effects if e.name.startswith("closed form"))
    above = [e for e in b.effects if e.on_object > small.on_object]
    left = sorted(b.effects, key=lambda e: -e.remaining)[:2]
    large = [e for e in b.effects if e.on_object > MATTERS]
    return (
        f"Largest are {listed(f'{e.name} ({percent(e.on_object)})' for e in top)}. {len(large)} of "
        f"{len(b.effects)} effects move K_obj by more than {percent(MATTERS)} each.",
        f"An error of 1 % in K_r is {abs(b.sensitivity_reference):.2f} % in K_obj here, 1 % in K_m "
        f"{abs(b.sensitivity_measuring):.2f} %, 1 % in R {abs(b.sensitivity_ratio):.2f} %.",
        f"Together (root of squares) they make {percent(b.total())} as the paper's rig stood, with K "
        f"from the drawing; with each remedy {percent(b.total(remaining=True))}. Then "
        f"{listed(f'{e.name} ({percent(e.remaining)})' for e in left)} lead.",
        f"The closed form's own error ({percent(small.short_arm)} of K, {percent(small.on_object)} of "
        f"K_obj) is smaller than {len(above)} of the other {len(b.effects) - 1} effects: it is a sharp "
        "tool, not the answer.",
    )


def _table(b: Budget) -> ReportTable:
    def part(v: float) -> str:
        return "–" if np.isnan(v) else percent(v) if v < 10 else f"× {sig(v)}"

    return tabulated(
        "budget table",
        b.effects,
        ("effect", "", lambda e: e.name),
        ("on K", "shortest arm", lambda e: part(e.short_arm)),
        ("on K", "longest arm", lambda e: part(e.long_arm)),
        ("on K_obj", "", lambda e: part(e.on_object)),
        ("how computed", "", lambda e: e.how),
        ("remedy", "", lambda e: e.remedy),
        ("remaining", "on K_obj", lambda e: part(e.remaining)),
    )


def _plot(b: Budget) -> Figure:
    shown = [e for e in b.effects if e.on_object > 0]
    with d.panels(size=(11.2, 0.31 * len(shown) + 1.3)) as (figure, ax):
        y = np.arange(len(shown))[::-1]
        least = 3e-4
        ax.barh(
            y,
            [e.on_object for e in shown],
            0.62,
            color=d.BLUE,
            label="as the paper's rig stood, K from the drawing",
            left=0,
        )
        ax.plot(
            [max(e.remaining, least) for e in shown],
            y,
            "D",
            color=d.ORANGE,
            mec=d.BLACK,
            ms=7,
            label="with the remedy",
        )
        ax.set(xscale="log", xlim=(least, max(e.on_object for e in shown) * 1.6))
        ax.set_xticks([1e-3, 1e-2, 0.1, 1.0], ["0.1 %", "1 %", "10 %", "100 %"])
        ax.set_yticks(y, [e.name for e in shown])
        ax.set(ylim=(-0.7, len(shown) - 0.3), xlabel="half-width on K_obj (left edge: 0.03 % and less)")
        ax.legend(loc="lower right")
        ax.grid(axis="y", visible=False)
        return drawn(figure, "budget")
