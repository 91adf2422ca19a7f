"""Table 1's stiffness against every closed-form rung: residuals, what would explain each, expected spread.

One change at a time is sought that makes the best rung give the measured K: of the hinge thickness alone, or
of the load point alone. Both are compared with what wire cutting and the pad allow. The Monte Carlo draws
every toleranced dimension.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations

import numpy as np

from tactcad.mechanics import ladder
from tactcad.mechanics.as_built import in_clamp, without_layer
from tactcad.mechanics.ladder import DEFAULT_RUNG
from tactcad.mechanics.section import HingeSection
from tactcad.paper.array_model import ArrayModel
from tactcad.paper.published import Published
from tactcad.parts.array.element import WIRE_TOLERANCE
from tactcad.report import plots as d
from tactcad.report.figures import exact, percent, signed_percent
from tactcad.report.report import Picture, ReportSection, ReportTable

from .prose import drawn, grid, marked, saying, section, table

DRAWS = 40_000  # the bands' ends repeat within 0.5 %
EDGE = 0.02  # ln K closer than this to a band's end is reported at its edge, neither inside nor outside
BAND = (0.025, 0.975)


@dataclass(frozen=True)
class Residuals:
    """Residuals for each element of Table 1 that is in the design. Stiffness N/mm, lengths mm."""

    element: np.ndarray
    arm: np.ndarray
    measured: np.ndarray
    predicted: dict[str, np.ndarray]  # by rung
    rung: str  # the one that explanations and bands use
    residual: np.ndarray  # ln(measured/predicted) of that rung
    hinge_thickness: np.ndarray  # nominal
    hinge_thickness_needed: np.ndarray  # NaN if none within the rung's range does
    load_arm: np.ndarray
    load_arm_needed: np.ndarray
    pad_half: float
    band_cut: np.ndarray  # [2, element], predicted K's 95 % band from cutting and clamping tolerances
    band_pad: np.ndarray  # the same, and the contact anywhere on the pad

    @property
    def mean(self) -> float:
        """Mean of the log residuals: the model's common factor."""
        return float(self.residual.mean())

    @property
    def scatter(self) -> float:
        """Standard deviation of the log residuals about their mean."""
        return float(self.residual.std(ddof=1))

    @property
    def furthest(self) -> int:
        """Row of the element with the largest deviation of stiffness."""
        return int(np.argmax(np.abs(self.residual)))

    @property
    def scatter_of_others(self) -> float:
        """The same without the element that is furthest off."""
        return float(np.delete(self.residual, self.furthest).std(ddof=1))

    @property
    def hinge_thickness_change(self) -> np.ndarray:
        return self.hinge_thickness_needed - self.hinge_thickness

    @property
    def load_arm_change(self) -> np.ndarray:
        return self.load_arm_needed - self.load_arm

    def outside(self, band: np.ndarray) -> np.ndarray:
        """Mask of elements with a measured stiffness outside a band by more than EDGE."""
        return np.minimum(np.log(self.measured / band[0]), np.log(band[1] / self.measured)) < -EDGE

    def at_edge(self, band: np.ndarray) -> np.ndarray:
        """Mask of elements with a measured stiffness within EDGE of an end of a band."""
        return np.abs(np.log(self.measured / band)).min(0) <= EDGE


def matched(data: Published, array: ArrayModel) -> tuple[np.ndarray, HingeSection]:
    """Rows of Table 1 whose element the design has, by number and arm length, and their hinge sections."""
    place = array.rows(data.table1.element)
    printed = data.table1.arm
    same = np.abs(array.arm[place] - printed.value) <= printed.half_step
    here = np.flatnonzero((place >= 0) & same)
    return here, array.section.rows(place[here])


def residuals(
    data: Published, array: ArrayModel, rng: np.random.Generator, more: dict[str, np.ndarray] | None = None
) -> Residuals:
    """Table 1 compared with the unchanged design; `more`: stiffnesses of slower rungs, for the matched
    elements."""
    here, s = matched(data, array)
    K = data.table1.stiffness.value[here]
    predicted = {name: ladder.evaluate(s, name).stiffness for name in ladder.CLOSED_FORMS}
    predicted |= more or {}
    t, pad_half, L = s.hinge_thickness, array.pad_length / 2, np.broadcast_to(s.load_arm, s.shape)
    return Residuals(
        data.table1.element[here],
        data.table1.arm.value[here],
        K,
        predicted,
        DEFAULT_RUNG,
        np.log(K / predicted[DEFAULT_RUNG]),
        np.broadcast_to(t, s.shape),
        solve(s, "hinge_thickness", K, 0.3, 3.0),
        L,
        solve(s, "load_arm", K, 0.2, 3.0),
        pad_half,
        *(np.nanquantile(spread(s, array, rng, contact), BAND, axis=0) for contact in (0.0, pad_half)),
    )


def solve(s: HingeSection, name: str, K: np.ndarray, least: float, most: float) -> np.ndarray:
    """Value of one dimension that gives each stiffness, searched from `least` to `most` times its own.

    NaN if there is none. A scan brackets the value nearest to the dimension's own; secant steps on ln K
    against its logarithm, which is nearly straight, then converge to it.
    """
    own = np.broadcast_to(getattr(s, name), s.shape).reshape(-1)
    factor = np.geomspace(least, most, 400)
    solution = np.full(own.shape, np.nan)
    for i in range(len(own)):
        one = s.rows([i])

        def misfit(log_factor: np.ndarray, i: int = i, one: HingeSection = one) -> np.ndarray:
            trial = one.with_(**{name: own[i] * np.exp(np.atleast_1d(log_factor))})
            return np.log(ladder.evaluate(trial).stiffness / K[i])

        scan = misfit(np.log(factor))
        cross = np.flatnonzero(np.sign(scan[:-1]) * np.sign(scan[1:]) <= 0)
        if not len(cross):
            continue
        j = cross[np.argmin(np.abs(np.log(factor[cross])))]
        slope = (scan[j + 1] - scan[j]) / np.log(factor[j + 1] / factor[j])
        root = np.log(factor[j]) - scan[j] / slope
        for _ in range(4):
            root -= misfit(root)[0] / slope
        solution[i] = own[i] * np.exp(root)
    return solution.reshape(s.shape)


def spread(s: HingeSection, array: ArrayModel, rng: np.random.Generator, contact: float) -> np.ndarray:
    """Stiffness [draw, element] with every dimension of [tolerance] drawn: half-widths are two standard
    deviations.

    NaN if a draw is out of the rung's range. `contact` is the half-width (mm) over which the load's
    position on the pad is uniform. Dimensions that one sheet and one cut share have one draw for all elements
    of an array, the others one for each. Layer and clamp only soften.
    """
    tol = array.tolerance
    shape, shared = (DRAWS, *s.shape), (DRAWS, 1)
    each = lambda half, shape=shape: half / 2 * rng.standard_normal(shape)  # noqa: E731
    length = s.hinge_length + each(tol.hinge_length)
    cut = _one_each(s).with_(
        hinge_thickness=s.hinge_thickness + each(tol.hinge_thickness),
        hinge_length=length,
        fillet_radius=np.clip(s.fillet_radius + each(tol.fillet_radius), 0.0, length / 2),
        arm_height=s.arm_height + each(tol.arm_height),
        load_arm=s.load_arm + each(tol.load_arm) + contact * rng.uniform(-1, 1, shape),
        width=s.width + each(tol.sheet_thickness, shared),
        youngs_modulus=s.youngs_modulus * (1 + each(tol.youngs_modulus, shared)),
    )
    left = without_layer(cut, np.abs(each(tol.recast_layer, shared)))
    return in_clamp(left, ladder.evaluate(left).stiffness, np.abs(each(tol.clamp_compliance)))


def _one_each(s: HingeSection) -> HingeSection:
    """The same sections, repeated in DRAWS rows."""
    many = {n: v for n in s.__dataclass_fields__ if (v := getattr(s, n)).size > 1}
    return s.with_(**{n: np.broadcast_to(v, (DRAWS, *s.shape)) for n, v in many.items()})


SMALL_FACTOR = 0.05  # a common factor closer to 1 than this is not reported


def page(r: Residuals, array: ArrayModel) -> ReportSection:
    sentences = findings(r, array)
    return section(
        "stiffness",
        sentences,
        (_rungs(r), _explained(r, array)),
        (_bands(r), _needed(r)),
        r,
        (sentences[0], sentences[2]),
    )


def findings(r: Residuals, array: ArrayModel) -> tuple[str, ...]:
    """Sentences chosen by the residuals and the bands."""
    say, n, worst = saying("stiffness", r=r), r.element, r.furthest
    out_cut, out_pad = n[r.outside(r.band_cut)], n[r.outside(r.band_pad)]
    edge = n[r.at_edge(r.band_pad)]
    t, dt, dl = r.hinge_thickness_needed[worst], r.hinge_thickness_change[worst], r.load_arm_change[worst]
    wide = [name for name, half in WIRE_TOLERANCE.items() if abs(dt) <= half]
    passes = say("in passes", passes=wide[-1]) if wide else ""
    hinge = say(
        "hinge",
        t=t,
        change=dt * 1e3,
        wire=passes or say("beyond passes", times=abs(dt) / max(WIRE_TOLERANCE.values())),
    )
    load = say(
        "load point",
        change=abs(dl),
        way="nearer to" if dl < 0 else "further from",
        pad="still on the pad" if abs(dl) <= r.pad_half else "off the pad",
    )
    pairs = [(i, j) for i, j in permutations(range(len(n)), 2) if r.arm[i] == r.arm[j]]
    i, j = max(pairs, key=lambda pair: r.measured[pair[0]] / r.measured[pair[1]], default=(0, 0))
    return (
        say(
            "scatter",
            design=array.name,
            common=say("no factor" if abs(r.mean) < SMALL_FACTOR else "factor", mean=np.expm1(r.mean)),
            others=say("others", worst=n[worst]) if len(n) > 2 else "",
        ),
        say(
            "furthest",
            worst=n[worst],
            times=np.exp(r.residual[worst]),
            hinge=hinge if np.isfinite(t) else say("no hinge"),
            load=load if np.isfinite(dl) else say("no load point"),
        ),
        say(
            "outside",
            count=len(out_cut),
            all=len(n),
            cut=out_cut,
            pad=say("still outside", pad=out_pad)
            if len(out_pad)
            else say("none outside", edge=say("at edge", edge=edge) if len(edge) else ""),
        )
        if len(out_cut)
        else say("all inside", all=len(n)),
        *(
            [say("equal arms", ratio=r.measured[i] / r.measured[j], i=n[i], j=n[j])]
            if r.measured[i] > r.measured[j]
            else []
        ),
    )


def _rungs(r: Residuals) -> ReportTable:
    logs = [np.log(r.measured / values) for values in r.predicted.values()]
    columns = (
        ("element", ""),
        ("arm a", "mm"),
        ("measured K", "N/mm"),
        *((name, "N/mm") for name in r.predicted),
        (f"measured over {r.rung}", "−1"),
    )
    off = map(signed_percent, np.expm1(r.residual))
    rows = zip(r.element, map(exact, r.arm), map(exact, r.measured), *r.predicted.values(), off)
    mean = ("mean", "", "", *(signed_percent(np.expm1(v.mean())) for v in logs), "")
    scatter = ("scatter", "", "", *(percent(v.std(ddof=1)) for v in logs), "")
    return grid("stiffness rungs", columns, (*rows, mean, scatter))


def _explained(r: Residuals, array: ArrayModel) -> ReportTable:
    def places(band: np.ndarray) -> list[str]:
        out, edge = r.outside(band), r.at_edge(band)
        return ["at its edge" if e else "outside" if o else "inside" for o, e in zip(out, edge)]

    um, mm = r.hinge_thickness_change * 1e3, r.load_arm_change
    return table(
        "stiffness explained",
        *(r.element, r.arm, r.measured),
        *(r.band_cut.T, places(r.band_cut), r.band_pad.T, places(r.band_pad)),
        marked(um, np.abs(um) > WIRE_TOLERANCE["1 pass"] * 1e3),
        marked(mm, ~(np.abs(mm) <= r.pad_half)),
        pad_length=array.pad_length,
        wire=", ".join(f"{name} ±{half * 1e3:g} µm" for name, half in WIRE_TOLERANCE.items()),
    )


def _bands(r: Residuals) -> Picture:
    order = np.lexsort((r.element, r.arm))
    x = np.arange(len(order))
    with d.panels(size=(11.2, 4.7)) as (figure, ax):
        pad, cut = r.band_pad[:, order], r.band_cut[:, order]
        for (low, high), colour, alpha, what in (
            (pad, d.SKY, 0.35, "contact anywhere on the pad"),
            (cut, d.BLUE, 0.55, "cutting and clamping tolerances"),
        ):
            ax.bar(x, high - low, 0.5, low, color=colour, alpha=alpha, label=f"95 %: {what}")
        predicted, style = r.predicted[r.rung][order], {"color": d.BLACK, "lw": 1.6}
        ax.hlines(predicted, x - 0.25, x + 0.25, label=f"predicted, rung {r.rung}", **style)
        ax.plot(x, r.measured[order], "o", color=d.RED, ms=9, mec="white", label="Table 1", zorder=5)
        for i, k in zip(x, order):
            d.note(ax, f"{r.measured[k]:g}", (i + 0.25, r.measured[k]), (4, -3), fontsize=9.5, color=d.RED)
        d.log_axes(ax, y=(5, 10, 20, 40, 80))
        ax.set_ylim(min(pad[0].min(), r.measured.min()) * 0.85, max(pad[1].max(), r.measured.max()) * 1.15)
        ax.set_xticks(x, [f"no. {r.element[k]}\na = {r.arm[k]:g} mm" for k in order])
        ax.set(xlim=(-0.6, len(x) - 0.2), ylabel="stiffness K, N/mm")
        ax.legend(loc="upper right")
        ax.grid(axis="x", visible=False)
        return drawn(figure, "stiffness-bands")


def _needed(r: Residuals) -> Picture:
    order = np.lexsort((r.element, r.arm))[::-1]
    y = np.arange(len(order))
    with d.panels(1, 2, size=(11.2, 4.2), sharey=True) as (figure, (left, right)):
        for half, shade in zip(WIRE_TOLERANCE.values(), (0.18, 0.28, 0.42)):
            left.axvspan(-half * 1e3, half * 1e3, color=d.BLUE, alpha=shade, lw=0)
        left.plot(r.hinge_thickness_change[order] * 1e3, y, "o", color=d.RED, ms=8)
        left.set_xlabel("change of hinge thickness that gives the measured K, µm")
        left.set_title("hinge thickness alone (bands: wire tolerance, 1, 2–3, 4+ passes)", fontsize=10.5)
        right.axvspan(-r.pad_half, r.pad_half, color=d.BLUE, alpha=0.18, lw=0)
        right.plot(r.load_arm_change[order], y, "s", color=d.RED, ms=8)
        right.set_xlabel("change of load arm that gives the measured K, mm")
        right.set_title("load point alone (band: the pad)", fontsize=10.5)
        left.set_yticks(y, [f"no. {r.element[k]}, a = {r.arm[k]:g}" for k in order])
        for ax in (left, right):
            ax.axvline(0, color=d.BLACK, lw=1)
        return drawn(figure, "stiffness-needed")
