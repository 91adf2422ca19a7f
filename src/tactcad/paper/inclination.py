"""Section 10: was each sample inclined? Table 2's ratios by rigid pads on a layer whose face has two angles.

Every sample is the layer of the design's [sample] with Table 2's K_obj; all pads press, read or not, at the
paper's least, middle and largest load; R is the ratio of deflections summed over them. ln R is fitted with
K_r and both angles of each sample free.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import fdtrc, fdtri

from tactcad.contact.elastic_body import Body
from tactcad.contact.press import pad_stiffness
from tactcad.contact.rigid_pads import ManyPresses
from tactcad.lab.regression import t_quantile
from tactcad.paper.array_model import ArrayModel
from tactcad.paper.grasp_figures import elements_in_parallel
from tactcad.paper.published import Published
from tactcad.paper.reference_stiffness import Table2Study
from tactcad.report import plots as d
from tactcad.report.figures import sig
from tactcad.report.report import Picture, ReportSection, ReportTable

from .prose import drawn, saying, section, table

GRID = np.radians(np.linspace(-1.2, 1.2, 5))  # first tries of each angle
STEP = 1e-4  # of slopes, mm of heights and ln of stiffnesses, for derivatives
ROUNDS = 8
OTHERS = (3.0, 10.0)  # thicknesses in place of the design's


@dataclass(frozen=True)
class Fitted:
    """ln R of Table 2 by one model: K_r (N/mm), slopes of each sample's face along x and y, K_obj of each
    sample, residual, number of parameters, and half-widths (95 %) of slopes and ln K_obj."""

    reference: float
    slope: np.ndarray  # [sample, 2]
    object_: np.ndarray
    left: np.ndarray  # of ln R, [measuring, sample]
    parameters: int
    slope_half: np.ndarray
    object_half: np.ndarray

    @property
    def rss(self) -> float:
        return float((self.left**2).sum())


@dataclass(frozen=True)
class Inclination:
    """Springs with K_r free leave `springs` (sum of squares of ln R); `f` and `p` hold the inclined samples
    against the level ones."""

    springs: float
    thickness: float
    level: Fitted
    inclined: Fitted
    own_object: Fitted
    heights: Fitted
    by_thickness: tuple[float, ...]  # sums of squares of inclined samples of OTHERS
    f: float
    p: float
    object_printed: np.ndarray


class _Samples:
    """R of the elements of Table 2 on layers, [measuring, sample]."""

    def __init__(self, data: Published, array: ArrayModel, thickness: float) -> None:
        truth, self.r = elements_in_parallel(data, array)
        at = array.rows(truth.element)
        x, y = array.pad_x[at], array.pad_y[at]
        lever = np.broadcast_to(array.section.load_arm, array.number.shape)[at]
        move = np.stack([np.ones(len(at)), -np.sign(x) / lever, np.zeros(len(at))], 1)
        width = float(np.broadcast_to(array.section.width, array.number.shape)[0])
        body = Body(1.0, array.sample.poisson, thickness)
        self.contact = ManyPresses(x, y, array.pad_length, width, move, body)
        self.unit = pad_stiffness(body, array.pad_length, width)
        self.K = truth.stiffness
        k = data.table2.measuring_stiffness.value
        self.rows = np.array([int(np.argmin(np.abs(self.K - v))) for v in k])
        self.load = array.grasping.moving_weight + array.grasping.weight * array.grasping.weights * np.array(
            [0.0, 0.5, 1.0]
        )
        self.last: tuple[np.ndarray, np.ndarray] | None = None  # approach and depths to begin with

    def ln_ratio(self, K_r: float, x: np.ndarray, slope: np.ndarray, height: np.ndarray) -> np.ndarray:
        """ln R from K_r (N/mm), K_obj [sample], slopes [sample, 2] and heights of the pads (mm, [pad])."""
        S, T, n = len(x), len(self.load), len(self.K)
        K = np.broadcast_to(self.K, (S, T, n)).copy()
        K[..., self.r] = K_r
        E = np.repeat((x / self.unit)[:, None], T, 1)
        if self.last is None:
            share = x[:, None, None] / (K + x[:, None, None])
            self.last = self.load / (K * share).sum(-1) + 1e-3, np.zeros((S, T, n, 3))
        p, start = self.last
        M, slopes = self.contact.system(E, K), np.repeat(slope[:, None], T, 1)
        for _ in range(40):
            b = self.contact.approached(p, slopes, np.broadcast_to(height, K.shape))
            r, g, d, J = self.contact.rest(M, b, start)
            start = r
            by_approach = np.linalg.solve(J, d[..., 0].reshape(*J.shape[:-1], 1))
            rise = E * by_approach[..., ::3, 0].sum(-1)
            off = self.load - E * g[..., 0].sum(-1)
            if (np.abs(off) < 1e-6 * self.load).all():
                break
            p = p + np.clip(off / np.maximum(rise, 1e-9), -0.3, 0.3)
        self.last = p, start
        sink = (E[..., None] * np.einsum("stni,ni->stn", g, self.contact.move) / K).sum(1)
        return np.log(np.maximum(sink[:, self.rows], 1e-9) / sink[:, [self.r]]).T


def study(data: Published, array: ArrayModel, springs: Table2Study) -> Inclination:
    """Level and inclined samples, with K_obj as printed or free, pads of other heights, other thicknesses."""
    h = array.sample.thickness
    samples = _Samples(data, array, h)
    start = springs.supported.value[0]
    level = _fit(samples, data, start)
    inclined = _fit(samples, data, start, slopes=True)
    others = tuple(_fit(_Samples(data, array, t), data, start, slopes=True).rss for t in OTHERS)
    own = _fit(samples, data, start, slopes=True, objects=True)
    heights = _fit(samples, data, start, heights=True)
    extra = inclined.parameters - level.parameters
    rest = level.left.size - inclined.parameters
    f = (level.rss - inclined.rss) / extra / (inclined.rss / rest)
    return Inclination(
        springs.ratio.size * springs.supported.rms**2,
        h,
        level,
        inclined,
        own,
        heights,
        others,
        float(f),
        float(fdtrc(extra, rest, max(f, 0.0))),
        data.table2.object_stiffness.value,
    )


def _fit(
    samples: _Samples,
    data: Published,
    K_r: float,
    slopes: bool = False,
    objects: bool = False,
    heights: bool = False,
) -> Fitted:
    """Gauss-Newton over K_r, and the free ones of slopes, K_obj and heights."""
    measured, printed = np.log(data.table2.ratio.value), data.table2.object_stiffness.value
    S, n = len(printed), len(samples.K)
    slope, ln_x, height = np.zeros((S, 2)), np.log(printed), np.zeros(n)
    ln_K = float(np.log(K_r))

    def off(at: tuple) -> np.ndarray:
        return samples.ln_ratio(float(np.exp(at[0])), np.exp(at[2]), at[1], at[3]) - measured

    if slopes:
        tries = [np.tan([a, b]) for a in GRID for b in GRID]
        found = [(off((ln_K, np.tile(t, (S, 1)), ln_x, height)) ** 2).sum(0) for t in tries]
        slope = np.array(tries)[np.argmin(found, axis=0)]
    free = [("K", 0)] + [("s", k) for k in (0, 1) if slopes] + ([("x", 0)] if objects else [])
    free += [("h", i) for i in range(n) if heights and i != samples.r]
    at = (ln_K, slope, ln_x, height)
    left, damping = off(at), 1e-3
    for _ in range(ROUNDS):
        A, shapes = [], []
        for kind, k in free:
            moved = _moved(at, kind, k, STEP)
            change = (off(moved) - left) / STEP
            # slopes and K_obj act on their own sample only: one press of all gives all columns
            each = [change * (np.arange(S) == j) for j in range(S)] if kind in "sx" else [change]
            A += [c.ravel() for c in each]
            shapes.append((kind, k, len(each)))
        J = np.array(A).T
        N = J.T @ J
        step = np.linalg.solve(N + damping * np.diag(np.diag(N) + 1e-12), -J.T @ left.ravel())
        tried, i = at, 0
        for kind, k, count in shapes:
            most = 0.5 if kind in "Kx" else 0.01
            tried = _moved(tried, kind, k, np.clip(step[i : i + count], -most, most))
            i += count
        now = off(tried)
        if (now**2).sum() < (left**2).sum():
            gain = 1 - (now**2).sum() / (left**2).sum()
            at, left, damping = tried, now, damping / 5
            if gain < 1e-3:
                break
        else:
            damping *= 10
    count = J.shape[1]
    covariance = np.linalg.pinv(N) * (left**2).sum() / (left.size - count)
    half = t_quantile(0.95, left.size - count) * np.sqrt(np.diag(covariance))
    slope_half = half[1 : 1 + 2 * S].reshape(2, S).T if slopes else np.zeros((S, 2))
    object_half = half[1 + 2 * S : 1 + 3 * S] if objects else np.zeros(S)
    return Fitted(float(np.exp(at[0])), at[1], np.exp(at[2]), left, count, slope_half, object_half)


def _moved(at: tuple, kind: str, k: int, by: float | np.ndarray) -> tuple:
    ln_K, slope, ln_x, height = at
    if kind == "K":
        return ln_K + float(np.ravel(by)[0]), slope, ln_x, height
    if kind == "x":
        return ln_K, slope, ln_x + by, height
    moved = (slope if kind == "s" else height).copy()
    if kind == "s":
        moved[:, k] += by
        return ln_K, moved, ln_x, height
    moved[k] += float(np.ravel(by)[0])
    return ln_K, slope, ln_x, moved


def page(v: Inclination) -> ReportSection:
    sentences = findings(v)
    return section("inclination", sentences, (_table(v),), (_plot(v),), v, (sentences[0],))


def findings(v: Inclination) -> tuple[str, ...]:
    say, b, n = saying("inclination", v=v), v.inclined, v.level.left.size
    steep = np.degrees(np.hypot(*np.arctan(b.slope).T))
    rest = n - b.parameters
    unlike = b.rss * (1 + fdtri(1, rest, 0.95) / rest)  # by one more parameter
    alike = [f"{t:g} mm" for t, s in zip(OTHERS, v.by_thickness) if s < unlike]
    off = v.own_object.object_ / v.object_printed
    return (
        say(
            "taken",
            share=1 - b.rss / v.springs,
            extra=b.parameters - v.level.parameters,
            rest=rest,
            verdict=say("explains" if v.p < 0.01 else "chance"),
        ),
        say(
            "steep",
            span=(steep.min(), steep.max()),
            steepest=v.object_printed[np.argmax(steep)],
            scatter=(b.left**2).mean() ** 0.5,
        ),
        say(
            "not told",
            other=[f"{sig(s)} at {t:g} mm" for t, s in zip(OTHERS, v.by_thickness)],
            alike=say("alike", alike=alike) if alike else say("worse"),
        ),
        say("own object", off=(off.min(), off.max())),
    )


def _table(v: Inclination) -> ReportTable:
    own = v.own_object
    angle, half = np.degrees(np.arctan(v.inclined.slope)), np.degrees(v.inclined.slope_half)
    angles = ([f"{a:.2f} ± {h:.2f}" for a, h in zip(angle[:, k], half[:, k])] for k in (0, 1))
    ends = own.object_ * np.exp(np.array([[-1], [1]]) * np.minimum(own.object_half, 50))
    return table(
        "inclination angles",
        v.object_printed,
        *angles,
        *((fitted.left**2).mean(0) ** 0.5 for fitted in (v.level, v.inclined)),
        [f"{sig(x)} ({sig(low)} to {sig(high)})" for x, low, high in zip(own.object_, *ends)],
        v=v,
    )


def _plot(v: Inclination) -> Picture:
    angle, half = np.degrees(np.arctan(v.inclined.slope)), np.degrees(v.inclined.slope_half)
    with d.panels(size=(11.2, 4.3)) as (figure, ax):
        for k, what in enumerate(("along the arms", "along the rows")):
            x = v.object_printed * (0.99 + 0.02 * k)
            d.with_bars(ax, k, x, angle[:, k], half[:, k], capsize=3, label=what)
        ax.axhline(0.0, color=d.BLACK, lw=1)
        ax.set(xlabel="K_obj of the sample, N/mm", ylabel="inclination of its face, degrees")
        ax.legend(loc="lower right")
        return drawn(figure, "inclination")
