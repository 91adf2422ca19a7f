"""The hinge that fits Table 1 and the paper's two strains best, and the ambiguities left.

The thickness is the paper's. Length, fillet radius and notch form, which the paper leaves out, are varied: ln
K has one unknown standard error, so the regions are those of least squares (F). The strains are weighted by
the accuracy to be expected of a plane finite-element model.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.special import fdtri

from tactcad.lab.regression import t_quantile
from tactcad.mechanics import ladder, strain
from tactcad.mechanics.section import HingeSection
from tactcad.paper.array_model import ArrayModel
from tactcad.paper.published import Published
from tactcad.paper.residuals import matched
from tactcad.report import plots as d
from tactcad.report.report import UNREPORTED, Picture, ReportSection, ReportTable

from .prose import drawn, grid, saying, section, table

LENGTHS = np.linspace(0.30, 2.0, 171)  # mm, slot length l
RADII = np.linspace(0.05, 0.60, 56)  # mm, fillet radius r
CENTRE = 1e-3  # grid length over hinge thickness that is taken as a point
# Chosen: error of the surface strain by the mesh of a plane finite-element model of that time.
STRAIN_ACCURACY = 0.01


@dataclass(frozen=True)
class Form:
    """One notch form: best fit and regions. Lengths mm; sums of squares of ln K over the grid [radius,
    length].
    """

    name: str
    two_sided: bool
    square_sum: np.ndarray = field(metadata=UNREPORTED)
    best_length: float
    best_radius: float
    best_scatter: float  # rms of ln K at the best point, degrees of freedom taken off
    length_at_radius: np.ndarray  # best length at each radius
    scatter_at_radius: np.ndarray
    design_length: float  # best length at the design's radius
    design_low: float  # its 95 % interval
    design_high: float
    effective_length: float  # mean E b t^3/(12 K L^2) of the fitted elements: what K identifies
    effective_spread: float  # over the 95 % region: (largest - least)/mean
    radius_from_strain: tuple[float, float]  # radii whose face strain agrees with the print; NaN if none


@dataclass(frozen=True)
class StrainCheck:
    """The paper's two strains at 2 N: load point and factor on 6 F L/(E b t^2) that they imply."""

    arms: tuple[float, float]
    printed: tuple[float, float]  # plain ratios
    nominal: tuple[float, float]  # with the load at the pad's centre
    offset: float  # from the tip, mm
    offset_half: float  # by rounding of the print
    factor: float
    factor_half: float
    pad_half: float


@dataclass(frozen=True)
class HingeFit:
    element: np.ndarray
    forms: tuple[Form, ...]
    strains: StrainCheck
    design_length: float
    design_radius: float
    design_two_sided: bool
    region: float  # square sum below which a hinge lies in the joint 95 % region
    f_ratio: float  # worse form's least square sum over the better one's
    f_limit: float  # 95 % point of F for it
    leave_out: dict[int, float]  # design_length's fit of the design's form without one element

    @property
    def own(self) -> Form:
        """The form that the design has."""
        return next(f for f in self.forms if f.two_sided == self.design_two_sided)

    @property
    def forms_alike(self) -> bool:
        return self.f_ratio < self.f_limit


def fit(data: Published, array: ArrayModel) -> HingeFit:
    """Both forms over the grid of lengths and radii."""
    here, s = matched(data, array)
    K = data.table1.stiffness.value[here]
    design_r, design_l = (float(np.median(v)) for v in (s.fillet_radius, s.hinge_length))
    t = float(np.median(s.hinge_thickness))
    strains = _strains(data, t, array)
    own = bool(np.any(s.two_sided))
    logs = {two: _grid(s.with_(two_sided=two)) for two in (False, True)}
    names = {False: "one-sided", True: "two-sided"}
    forms = [_form(names[two], two, log_k, K, s, design_r, strains) for two, log_k in logs.items()]
    n = len(K)
    sums = [np.nanmin(f.square_sum) for f in forms]
    region = min(sums) * (1 + 2 * fdtri(2, n - 2, 0.95) / (n - 2))
    at = int(np.argmin(np.abs(RADII - design_r)))
    leave = {}
    for i, number in enumerate(data.table1.element[here]):
        rest = np.arange(n) != i
        square = ((logs[own][at][:, rest] - np.log(K[rest])) ** 2).sum(-1)
        leave[int(number)] = float(LENGTHS[np.nanargmin(square)])
    return HingeFit(
        data.table1.element[here],
        tuple(forms),
        strains,
        design_l,
        design_r,
        own,
        float(region),
        float(max(sums) / min(sums)),
        float(fdtri(n - 2, n - 2, 0.95)),
        leave,
    )


def _grid(s: HingeSection) -> np.ndarray:
    """ln K over [radius, length, element]; NaN outside the rung's range."""
    r, l = np.meshgrid(RADII, LENGTHS, indexing="ij")  # noqa: E741
    wide = {name: np.broadcast_to(getattr(s, name), s.shape) for name in s.__dataclass_fields__}
    clamp = wide["body_length"] + wide["hinge_length"] / 2  # the clamp's edge stays in place
    grid = HingeSection.of(**wide).with_(
        fillet_radius=np.broadcast_to(r[..., None], (*r.shape, *s.shape)),
        hinge_length=np.broadcast_to(l[..., None], (*r.shape, *s.shape)),
        body_length=clamp - l[..., None] / 2,
    )
    return np.log(ladder.evaluate(grid).stiffness)


def _form(
    name: str,
    two: bool,
    log_k: np.ndarray,
    K: np.ndarray,
    s: HingeSection,
    design_r: float,
    strains: StrainCheck,
) -> Form:
    n = len(K)
    square = ((log_k - np.log(K)) ** 2).sum(-1)
    i, j = np.unravel_index(np.nanargmin(square), square.shape)
    with np.errstate(invalid="ignore"):
        filled = np.where(np.isnan(square), np.inf, square)
    best_j = filled.argmin(1)
    at_radius = np.where(np.isinf(filled.min(1)), np.nan, LENGTHS[best_j])
    own = filled[int(np.argmin(np.abs(RADII - design_r)))]
    inside = own <= own.min() * (1 + t_quantile(0.95, n - 1) ** 2 / (n - 1))
    region = filled <= filled.min() * (1 + 2 * fdtri(2, n - 2, 0.95) / (n - 2))
    effective = s.youngs_modulus * s.width * s.hinge_thickness**3 / (12 * np.exp(log_k) * s.load_arm**2)
    effective = effective.mean(-1)
    fitted = (s.with_(fillet_radius=r, hinge_length=l, two_sided=two) for r, l in zip(RADII, at_radius))
    factor = np.array([float(np.median(face_factor(hinge))) for hinge in fitted])
    agrees = np.abs(factor / strains.factor - 1) <= 2 * STRAIN_ACCURACY
    radii = (float(RADII[agrees].min()), float(RADII[agrees].max())) if agrees.any() else (np.nan, np.nan)
    return Form(
        name,
        two,
        square,
        float(LENGTHS[j]),
        float(RADII[i]),
        float((square[i, j] / (n - 2)) ** 0.5),
        at_radius,
        np.sqrt(filled.min(1) / (n - 1)),
        float(LENGTHS[own.argmin()]),
        float(LENGTHS[inside].min()),
        float(LENGTHS[inside].max()),
        float(effective[i, j]),
        float((effective[region].max() - effective[region].min()) / effective[i, j]),
        radii,
    )


def face_factor(s: HingeSection) -> np.ndarray:
    """Strain on the gauge face at the hinge's centre over 6 F L/(E b t^2), plane stress: a grid of no
    length."""
    return strain.grid_factor(s, CENTRE * s.hinge_thickness, "plane")


def _strains(data: Published, t: float, array: ArrayModel) -> StrainCheck:
    """eps = f 6 F (a - c)/(E b t^2) at two arms gives offset c and factor f."""
    figure = data.figure
    arms = (figure["short_arm"], figure["long_arm"])
    eps = np.array([figure["strain_short_arm"], figure["strain_long_arm"]]) / 100
    half = np.array([data.half_step["strain_short_arm"], data.half_step["strain_long_arm"]]) / 100
    unit = 6 * figure["fem_force"] / (figure["youngs_modulus"] * figure["sheet_thickness"] * t * t)

    def solve(e: np.ndarray) -> tuple[float, float]:
        slope = (e[1] - e[0]) / (arms[1] - arms[0])
        return arms[0] - e[0] / slope, slope / unit

    offset, factor = solve(eps)
    corners = [solve(eps + half * np.array(sign)) for sign in ((1, -1), (-1, 1), (1, 1), (-1, -1))]
    pad_half = array.pad_length / 2
    return StrainCheck(
        arms,
        (float(eps[0]), float(eps[1])),
        (unit * (arms[0] - pad_half), unit * (arms[1] - pad_half)),
        float(offset),
        float(max(abs(c[0] - offset) for c in corners)),
        float(factor),
        float(max(abs(c[1] - factor) for c in corners)),
        pad_half,
    )


def page(h: HingeFit, array: ArrayModel) -> ReportSection:
    return section("hinge", findings(h), (_forms(h), _strain_table(h, array), _left_out(h)), (_map(h),), h)


def findings(h: HingeFit) -> tuple[str, ...]:
    own, s = h.own, h.strains
    say = saying("hinge", h=h, own=own, s=s, allowed=STRAIN_ACCURACY, largest=RADII[-1])
    inside = own.design_low <= h.design_length <= own.design_high
    ok = np.isfinite(own.scatter_at_radius)  # radii over which some length fits: the valley
    valley, scatter = RADII[ok], own.scatter_at_radius[ok]
    centre = abs(s.offset - s.pad_half) <= max(0.02 * s.pad_half, s.offset_half)
    fits = {f.name: f.radius_from_strain for f in h.forms if np.isfinite(f.radius_from_strain[0])}
    ranges = " and ".join(f"{name} with r from {a:.2f} to {b:.2f} mm" for name, (a, b) in fits.items())
    moved = max(h.leave_out, key=lambda n: abs(h.leave_out[n] - own.design_length))
    within = own.design_low <= h.leave_out[moved] <= own.design_high
    return (
        say("best", where="inside" if inside else "OUTSIDE"),
        say(
            "valley",
            least=valley[0],
            most=valley[-1],
            change=scatter.max() / scatter.min() - 1,
            half=own.effective_spread / 2,
        ),
        say("alike" if h.forms_alike else "unlike"),
        say("load point", where=say("centre" if centre else "not centre")),
        say("both forms" if len(fits) == len(h.forms) else "one form" if fits else "no form", ranges=ranges),
        say(
            "all decide" if within else "one decides",
            moved=moved,
            change=h.leave_out[moved] / own.design_length - 1,
        ),
    )


def _forms(h: HingeFit) -> ReportTable:
    return table(
        "hinge forms",
        [f.name for f in h.forms],
        [f.design_length for f in h.forms],
        [(f.design_low, f.design_high) for f in h.forms],
        [f.best_length for f in h.forms],
        [f.best_radius for f in h.forms],
        [f.best_scatter for f in h.forms],
        [f.effective_length for f in h.forms],
        h=h,
        own=h.own,
        count=len(h.element),
    )


def _strain_table(h: HingeFit, array: ArrayModel) -> ReportTable:
    s, one = h.strains, array.section.rows([0])
    printed, nominal = np.array(s.printed) * 100, np.array(s.nominal) * 100
    forms = [float(face_factor(one.with_(two_sided=two)).item()) * nominal for two in (False, True)]
    return table("hinge strains", s.arms, printed, nominal, printed / nominal, *forms, h=h)


def _left_out(h: HingeFit) -> ReportTable:
    return grid(
        "hinge left_out",
        (("left out", ""), *((f"no. {n}", "") for n in h.leave_out)),
        (("l, mm", *(f"{v:.2f}" for v in h.leave_out.values())),),
    )


def _map(h: HingeFit) -> Picture:
    with d.panels(1, 2, size=(11.2, 4.6), sharey=True) as (figure, axes):
        for ax, f in zip(axes, h.forms):
            least = np.nanmin(f.square_sum)
            scatter = np.sqrt(f.square_sum / (len(h.element) - 2))
            levels = np.nanmin(scatter) * np.array([1.0, 1.02, 1.05, 1.1, 1.2, 1.4, 1.8])
            clipped, sums = (
                np.clip(scatter.T, None, levels[-1] * 0.9999),
                np.nan_to_num(f.square_sum.T, nan=1e3),
            )
            shown = ax.contourf(RADII, LENGTHS, clipped, levels, cmap="cividis_r", alpha=0.9)
            ax.contour(RADII, LENGTHS, sums, [h.region], colors=[d.RED], linewidths=2)
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
