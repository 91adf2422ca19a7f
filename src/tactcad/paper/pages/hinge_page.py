"""Section 2: which hinge fits, and what the data cannot tell apart."""

from __future__ import annotations

import numpy as np

from tactcad.paper.array_model import ArrayModel
from tactcad.paper.hinge import LENGTHS, RADII, STRAIN_ACCURACY, HingeFit, face_factor
from tactcad.paper.prose import drawn, section, table, tabulated
from tactcad.report import plots as d
from tactcad.report.report import Figure, ReportSection, ReportTable, interval, percent, sig, signed_percent


def page(h: HingeFit, array: ArrayModel) -> ReportSection:
    return section("hinge", findings(h), (_forms(h), _strains(h, array), _left_out(h)), (_map(h),), h)


def findings(h: HingeFit) -> tuple[str, ...]:
    own = h.own
    inside = own.design_low <= h.design_length <= own.design_high
    sentences = [
        f"At the design's fillet radius {h.design_radius:g} mm, t as the paper gives it, the {own.name} "
        f"hinge that fits best is {own.design_length:.2f} mm long, 95 % interval {own.design_low:.2f} to "
        f"{own.design_high:.2f} mm. The design's {h.design_length:g} mm lies "
        f"{'inside' if inside else 'OUTSIDE'} it.",
        f"Length and fillet radius cannot be told apart: along the valley from r = {_valley(h)[0]:.2f} "
        f"to {_valley(h)[1]:.2f} mm the scatter stays within {percent(_valley(h)[2])} of its least. What "
        f"K does fix is one effective length, E b t³/(12 K L²) = {sig(own.effective_length)} mm, and "
        f"that only within {percent(own.effective_spread / 2)} either way.",
        (
            f"One-sided and two-sided notches fit equally well (ratio of square sums {h.f_ratio:.3f}; "
            f"only above {sig(h.f_limit)} would they differ): Table 1 does not tell the notch form."
            if h.forms_alike
            else f"The notch forms do not fit equally well (ratio of square sums {sig(h.f_ratio)}, limit "
            f"{sig(h.f_limit)})."
        ),
        _load_point(h),
        _strain_form(h),
    ]
    moved = max(h.leave_out, key=lambda n: abs(h.leave_out[n] - own.design_length))
    change = h.leave_out[moved] / own.design_length - 1
    within = own.design_low <= h.leave_out[moved] <= own.design_high
    sentences.append(
        f"No single element decides the length: without no. {moved} it moves most, by "
        f"{signed_percent(change)}, {'inside' if within else 'to outside'} the interval."
        if within
        else f"One element decides the length: without no. {moved} it moves by {signed_percent(change)}, "
        f"out of the interval."
    )
    return tuple(sentences)


def _load_point(h: HingeFit) -> str:
    s = h.strains
    centre = abs(s.offset - s.pad_half) <= max(0.02 * s.pad_half, s.offset_half)
    return (
        f"The two printed strains put the load {s.offset:.3f} ± {s.offset_half:.3f} mm from the tip "
        "(rounding of the print), "
        + (
            f"which is the pad's centre ({s.pad_half:g} mm): L = a − {s.pad_half:g} mm."
            if centre
            else f"which is not the pad's centre ({s.pad_half:g} mm)."
        )
        + f" They are {s.factor:.4f} ± {s.factor_half:.4f} of the nominal 6FL/(E b t²)."
    )


def _strain_form(h: HingeFit) -> str:
    fits = {f.name: f.radius_from_strain for f in h.forms if np.isfinite(f.radius_from_strain[0])}
    own = f"a plane model's own strain error of {percent(STRAIN_ACCURACY)} (two of them allowed)"
    if not fits:
        return f"That factor fits no notch form and no fillet radius up to {RADII[-1]:g} mm within {own}."
    ranges = " and ".join(
        f"{name} with r from {low:.2f} to {high:.2f} mm" for name, (low, high) in fits.items()
    )
    if len(fits) == len(h.forms):
        return f"That factor fits {ranges}, within {own}: the strains do not tell the notch form either."
    return (
        f"That factor fits {ranges}, within {own}; the other form does not: the only hint at the notch "
        "form in the paper."
    )


def _valley(h: HingeFit) -> tuple[float, float, float]:
    """Radii over which some length fits, and how much the scatter changes along them."""
    scatter = h.own.scatter_at_radius
    ok = np.isfinite(scatter)
    return float(RADII[ok][0]), float(RADII[ok][-1]), float(scatter[ok].max() / scatter[ok].min() - 1)


def _forms(h: HingeFit) -> ReportTable:
    own = h.own
    return tabulated(
        "hinge forms",
        h.forms,
        ("notch", "", lambda f: f.name),
        (f"length at r = {h.design_radius:g} mm", "mm", lambda f: f.design_length),
        ("95 % interval", "mm", lambda f: interval(f.design_low, f.design_high)),
        ("least square sum at l", "mm", lambda f: f.best_length),
        ("and r", "mm", lambda f: f.best_radius),
        ("scatter left in K", "ln", lambda f: percent(f.best_scatter)),
        ("E b t³/(12 K L²)", "mm", lambda f: f.effective_length),
        count=len(h.element),
        design_length=own.design_length,
        design_low=own.design_low,
        design_high=own.design_high,
        design_radius=h.design_radius,
        form=own.name,
    )


def _strains(h: HingeFit, array: ArrayModel) -> ReportTable:
    s = h.strains
    section = array.section.rows([0])
    rows = []
    for arm, printed, nominal in zip(s.arms, s.printed, s.nominal):
        forms = [
            float(face_factor(section.with_(two_sided=two)).item()) * nominal * 100 for two in (False, True)
        ]
        rows.append((arm, printed * 100, nominal * 100, f"{printed / nominal:.4f}", *forms))
    return table(
        "hinge strains",
        (
            ("arm a", "mm"),
            ("printed", "%"),
            ("6FL/(E b t²), L = a − 1", "%"),
            ("printed over nominal", ""),
            ("one-sided, gauge face", "%"),
            ("two-sided, gauge face", "%"),
        ),
        tuple(rows),
        design_radius=h.design_radius,
    )


def _left_out(h: HingeFit) -> ReportTable:
    return table(
        "hinge left_out",
        (("left out", ""), *((f"no. {n}", "") for n in h.leave_out)),
        (("l, mm", *(f"{v:.2f}" for v in h.leave_out.values())),),
    )


def _map(h: HingeFit) -> Figure:
    with d.panels(1, 2, size=(11.2, 4.6), sharey=True) as (figure, axes):
        for ax, f in zip(axes, h.forms):
            least = np.nanmin(f.square_sum)
            scatter = np.sqrt(f.square_sum / (len(h.element) - 2))
            levels = np.nanmin(scatter) * np.array([1.0, 1.02, 1.05, 1.1, 1.2, 1.4, 1.8])
            shown = ax.contourf(
                RADII,
                LENGTHS,
                np.clip(scatter.T, None, levels[-1] * 0.9999),
                levels,
                cmap="cividis_r",
                alpha=0.9,
            )
            ax.contour(
                RADII,
                LENGTHS,
                np.nan_to_num(f.square_sum.T, nan=1e3),
                [h.region],
                colors=[d.RED],
                linewidths=2,
            )
            ax.plot(RADII, f.length_at_radius, "--", color=d.BLACK, lw=1.6)
            ax.plot(RADII, 2 * RADII, ":", color=d.BLACK, lw=2)
            if f.two_sided == h.design_two_sided:
                ax.plot(h.design_radius, h.design_length, "*", color="white", mec=d.BLACK, ms=17)
                d.note(ax, "design", (h.design_radius, h.design_length), (10, 10), fontsize=10)
            ax.set(
                title=f"{f.name}: least scatter {np.sqrt(least / (len(h.element) - 2)):.2f}",
                xlabel="fillet radius r, mm",
                ylim=(LENGTHS[0], LENGTHS[-1]),
            )
        axes[0].set_ylabel("slot length l, mm")
        bar = figure.colorbar(shown, ax=axes, pad=0.01)
        bar.set_label("scatter of ln K")
        bar.set_ticks(levels[1:], labels=[f"{v:.3f}" for v in levels[1:]])
        return drawn(figure, "hinge-map")
