"""Labs that press an array on a layer, by code of the tests' own: Love's closed form for a rectangle of even
pressure, the layer's part by an integral over waves, and a contact loop on single patches."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import inf

import numpy as np
from scipy.interpolate import interp1d
from scipy.special import j0

from tactcad.lab.calibration_file import Sensitivity

LOAD = np.concatenate([[0.0], 3.235 + 0.980665 * np.arange(8)])  # N: before contact, then the paper's
NOISE = 2e-4  # V
EACH = 0.01  # scatter of a run's K and K_v, relative
RUNS = 3


def love(x, y, a, b):
    """Sink of the half-space's face at x, y for a pressure of 1 over a x b: times pi E*; Love 1929."""
    total = 0.0
    for u in (x + a / 2, -(x - a / 2)):
        for v in (y + b / 2, -(y - b / 2)):
            r = np.hypot(u, v)
            total = total + u * np.log((v + r) / np.abs(u)) + v * np.log((u + r) / np.abs(v))
    return total


@lru_cache(maxsize=2)  # benches of several thicknesses share it
def half_space(x, y, a, b):
    """Sink of every patch by a pressure of 1 on every one, mean over each by 2 x 2 Gauss points."""
    x, y, a, b = (np.frombuffer(v) for v in (x, y, a, b))
    dx, dy, g = x[:, None] - x, y[:, None] - y, 12**-0.5
    parts = (love(dx + s * g * a[:, None], dy + t * g * b[:, None], a, b) for s in (-1, 1) for t in (-1, 1))
    return sum(parts) / 4


def layer_part(nu, h):
    """What a bonded layer of thickness h takes from 1/r, as a function of r: by the trapezium rule."""
    c = np.linspace(1e-6, 40, 8001)
    m = 3 - 4 * nu
    e2, e4 = np.exp(-2 * c), np.exp(-4 * c)
    top = m * (1 - e4) / 2 - 2 * c * e2
    phi = top / (m * (1 + e4) / 2 + (2 * c**2 + 5 - 12 * nu + 8 * nu**2) * e2)
    r = np.linspace(0, 32, 641)
    value = np.array([np.trapezoid((phi - 1) * j0(c * at / h), c) for at in r]) / h
    return interp1d(r, value, kind="cubic")


class Bench:
    """An array on a layer, patch by patch; E* = E/(1 - nu^2).

    With 6 x 8 patches a pad is 1 % soft, and forces of inclined arrays are up to 0.9 % of their mean off;
    with
    10 x 12 these are 0.1 %.
    """

    def __init__(self, x, y, length, width, lever, nu, h, across=10, along=12):
        def cut(side, n):
            edge = -np.cos(np.linspace(0, np.pi, n + 1)) * side / 2
            return (edge[1:] + edge[:-1]) / 2, np.diff(edge)

        (px, a), (py, b) = cut(length, across), cut(width, along)
        X, Y = (v.ravel() for v in np.meshgrid(px, py))
        A, B = (v.ravel() for v in np.meshgrid(a, b))
        self.n, self.m = len(x), len(X)
        self.area = np.tile(A * B, self.n)
        self.px, self.py = (x[:, None] + X).ravel(), (y[:, None] + Y).ravel()
        dx, dy = self.px[:, None] - self.px, self.py[:, None] - self.py
        A, B = np.tile(A, self.n), np.tile(B, self.n)
        C = half_space(self.px.tobytes(), self.py.tobytes(), A.tobytes(), B.tobytes())
        if np.isfinite(h):
            C = C + layer_part(nu, h)(np.hypot(dx, dy)) * self.area
        self.C = C * (1 - nu**2) / np.pi  # of a pressure, E = 1
        self.inverse = np.linalg.inv(self.C)
        self.arm = 1 + (X[None] / lever[:, None])  # what a pad's patches sink where its middle sinks by 1

    def sinks(self, E, K, height, slope, load, stop=np.inf):
        """Of every pad's middle under each load, mm; no pad sinks beyond its stop."""
        stop, closed = np.broadcast_to(stop, self.n), np.zeros(self.n, bool)
        out = self._sinks(E, K, height, slope, load, closed, stop)
        for t in np.flatnonzero((out > stop[:, None]).any(0)):  # loads rise: a stop once closed stays so
            while True:
                closed = closed | (out[:, t] > stop)
                out[:, t] = self._sinks(E, K, height, slope, [load[t]], closed, stop)[:, 0]
                if not (out[~closed, t] > stop[~closed]).any():
                    break
        return out

    def _sinks(self, E, K, height, slope, load, closed, stop):
        """Springs are of rank one each, so that R, from pressures to what patches sink turned round, is the
        face's own and Woodbury's few rows. The gap under patches that do not press follows from R's block of
        these, or the pressures from the other block: the smaller one is solved."""
        back = np.repeat(height, self.m) + slope[0] * self.px + slope[1] * self.py
        back += np.where(np.repeat(closed, self.m), np.repeat(stop, self.m), 0.0) * self.arm.ravel()
        springs = np.flatnonzero(~closed)
        sink, bear = np.zeros((2, len(back), len(springs)))
        for column, i in enumerate(springs):
            s = slice(i * self.m, (i + 1) * self.m)
            sink[s, column], bear[s, column] = self.arm[i], self.arm[i] * self.area[s] / K[i]
        R = E * self.inverse
        across = R @ sink
        R -= across @ np.linalg.solve(np.eye(len(springs)) + bear.T @ across, bear.T @ R)
        right = np.stack([np.ones(len(back)), -back], 1)  # by an approach of 1, and by the backs
        free = R @ right
        out = []
        on = np.ones(len(back), bool)
        for total in load:
            if total == 0:
                out.append(np.zeros(self.n))
                continue
            for _ in range(60):
                a, b = np.flatnonzero(on), np.flatnonzero(~on)
                pressure, gap = np.zeros((2, len(back), 2))
                if len(b) < len(a):
                    gap[b] = np.linalg.solve(R[np.ix_(b, b)], -free[b])
                    pressure[a] = free[a] + R[np.ix_(a, b)] @ gap[b]
                else:
                    M = self.C[:, a] / E + sink @ bear[a].T
                    pressure[a] = np.linalg.solve(M[a], right[a])
                    gap[b] = M[b] @ pressure[a] - right[b]
                one, off = self.area @ pressure
                at = ((total - off) / one, 1.0)
                now = np.where(on, pressure @ at > 0, gap @ at < 0)
                if (now == on).all():
                    break
                on = now
            moment = (pressure @ at * self.area).reshape(self.n, self.m) * self.arm
            out.append(np.where(closed, stop, moment.sum(1) / K))
        return np.array(out).T


@dataclass(frozen=True)
class Array:
    """What the tests take from a design: places, levers and stiffnesses of its elements as drawn."""

    number: np.ndarray
    x: np.ndarray
    y: np.ndarray
    length: float
    width: float
    lever: np.ndarray
    K: np.ndarray
    K_v: np.ndarray


def least_half_width(of, h, E, K, K_v, read, height, slope, unread, thickness, load_known=False, runs=RUNS):
    """1.96 standard errors of ln E of a lab that knows every other quantity's true variance: Cramer and Rao's
    bound, all distributions taken as normal; derivatives are differences of sinks.

    of(h)      the bench of a layer; h and its uniform half-width `thickness`, relative
    height     uniform half-width of the pads' heights; `unread` of ln K of pads that are not read
    """
    load, n = LOAD[1:], len(K)
    benches = {0.0: of(h)} | {e: of(h * (1 + e)) for e in (0.01, -0.01) if thickness}

    def sinks(e=0.0, k=None, up=0.0, tilt=0.0, more=None, off=0.0):
        k, more = (np.zeros(m) if v is None else v for v, m in ((k, n), (more, len(load))))
        at = (
            E * np.exp(e),
            K * np.exp(k),
            np.full(n, height) + up,
            np.array(slope) + tilt,
            load * np.exp(more),
        )
        return benches[off].sinks(*at)[read]

    def slopes(name, size, step=1e-3):
        each = np.eye(size) * step if size else [step]
        return [(sinks(**{name: v}) - sinks(**{name: -v})) / 2 / step for v in each]

    sink, signal = sinks(), K_v[read, None]
    by_calibration = EACH / runs**0.5
    own = np.eye(len(sink))[:, :, None]
    columns = slopes("e", 0) + slopes("tilt", 2, 1e-5) + slopes("up", n, 1e-4) + slopes("k", n)
    known = [inf] * 3 + [height * 3**-0.5] * n + list(np.where(read, by_calibration, unread * 3**-0.5))
    columns += [*(own * sink), *(own / signal * np.ones_like(sink))]  # K_v, and offsets, read once before
    known += [by_calibration] * len(sink) + [NOISE] * len(sink)
    if thickness:
        columns += slopes("off", 0, 0.01)
        known.append(thickness * 3**-0.5)
    if not load_known:
        columns += slopes("more", len(load))
        known += [inf] * len(load)
    A = np.array([(signal * c).ravel() for c in columns]).T / NOISE
    N = A.T @ A + np.diag(np.array(known) ** -2.0)
    unit = np.diag(N) ** -0.5
    return 1.96 * float(unit[0] * np.linalg.inv(N * unit * unit[:, None])[0, 0] ** 0.5)


def calibration(array, K, K_v, rng, runs=RUNS, each=EACH):
    """What a lab finds of the true K and K_v by as many runs."""
    k = K * (1 + each * rng.standard_normal((runs, len(K))))
    v = K_v * (1 + each * rng.standard_normal((runs, len(K))))
    se = [a.std(0, ddof=1) / runs**0.5 for a in (k, v)]
    dk, dv = k - k.mean(0), v - v.mean(0)
    correlation = (dk * dv).sum(0) / np.sqrt((dk**2).sum(0) * (dv**2).sum(0))
    full = np.full(len(K), 1.0)
    return Sensitivity(
        array.number,
        k.mean(0),
        se[0],
        v.mean(0),
        se[1],
        correlation,
        full * (runs - 1),
        57.04 * full,
        0 * full,
    )
