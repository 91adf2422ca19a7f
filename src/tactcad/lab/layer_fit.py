"""Modulus of a layer from all elements' signals at all loads, with the inclination of its face.

Signal of element i at load t = offset_i + K_v,i sink_i(t), and + rate_i time(t) where times are known. The
sinks are those of rigid pads at rest on the layer (contact.rigid_pads) at an approach of their own for each
load. Free: modulus, both slopes of the face, offsets, approaches. Known within limits, and fitted with these
as priors: K and K_v by the calibration's covariance, heights of the pads, the layer's thickness, and the
stiffness of pads that press unread. Readings before contact fix the offsets. The load has little weight:
friction and relaxation go into the approaches.

Least squares by Gauss-Newton; the noise is the residual of a fit with K and K_v nearly free. Errors of the
estimate are traced to each element and use its own covariance and degrees of freedom, as in `combine`. An
interval is even in ln R of two elements, R = (K_r + x)/(K_m + x), of which equation (3) makes K_obj: as
Fieller's, it opens where R comes to 1 or to K_r/K_m. A pair's interval is the same fit with a free modulus
under every other pad, so that those give their forces only.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import inf

import numpy as np
from scipy.special import fdtrc

from tactcad.contact.elastic_body import Body
from tactcad.contact.press import Pads, pad_stiffness
from tactcad.contact.rigid_pads import CLOSE, ManyPresses, pressing
from tactcad.lab.combine import DISAGREE, PRIOR_DOF
from tactcad.lab.regression import KNOWN, t_quantile

from .calibration_file import Sensitivity

LEVEL = 0.95  # of expected intervals
UNIFORM = 3**-0.5  # standard deviation over half-width of a uniform distribution
# Of each element's force by the layer rung, against the others': 0.2 % of the mean force where pads have
# lifted, 0.06 %
# where all press whole. The common part (0.4 % of punches) is an error of the modulus.
MODEL, COMMON = 0.002, 0.004
# Standard deviation of ln K of a pad that presses and is not read: equal elements of Table 1 differ by a
# factor of up to two.
UNREAD = 0.35
# Of the largest load, standard deviation of every sum of forces: only keeps the approach in bounds.
LOAD = 0.1
STEEP = 0.3  # standard deviation of the face's slopes: 17 degrees, far beyond what is set up
WILD = 10.0  # disagreement of the elements, in their errors, above which no modulus explains the readings
# Thicknesses over a pad's side that are tried if none is known.
LAYERS = (0.25, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 3.0, 5.0, 10.0, inf)
STEPS = 40
# Of a cost in squared standard errors: what a last step would gain, which is taken without a look at its end;
# of the first stage, which only gives a start; and steps in a row that gain no more before a fit gives up.
SETTLED, ROUGHLY, IDLE = 0.1, 10.0, 3
# Each stage finds the noise and what lifting changes between pads anew; one that gained more than MOVED has
# another after it. Without, the modulus on faces at 5 degrees was 0.13 half-widths (median, at most 1.4) away
# from where further stages lead; with, 0.02, at most 0.3.
STAGES, MOVED = 4, 10.0
# The first stage's noise over the law's error; in it all but modulus, slopes, offsets and approaches keep
# their expected values: with all free from the start, one fit in ten missed the best, with an unread pad
# lifted.
ROUGH = 20.0
# Error of the law of pads that lift, of the largest change of a signal: what it leaves (rms) of signals by
# single patches at 1 MPa and 5 degrees. It is much the same at every load, so loads do not average it as they
# do the readings' noise, and on every layer (3.4e-5 at 2 mm, 4.9e-5 on a half-space); what counts is how much
# lifts: 0.4e-5 to 1.9e-5 at 0.3 MPa, 6e-5 to 10e-5 at 3 MPa; a climb found 44e-5 (10 mm, 3 MPa, 4.3 degrees,
# a row lifted), which the fit finds as noise. The modulus of exact readings is up to 2.8 % high, by a climb
# (half-space, 0.8 MPa, 3.9 degrees); in labs there intervals are 4.9 % wide each way, and 96 of 100 hold.
SHAPE = 4e-5
# Of the weight of the pads' heights in a pair's fit. The readings give heights over the approach; taken as
# known, their size would tell the approach and so K_obj, by as much as one pair does.
FREE_HEIGHTS = 0.01
SAME = 1e-6  # relative difference of stiffness below which two elements are no pair
LOOSE = 1e-4  # share of a prior's weight that leaves the parameter practically free
THICKER = 0.02  # relative step by which the layer's part in the sinks is found
BATCH = 50  # grasps at once: more leave the processor's cache
# steps at most to the approach of a load, halvings of one, and the load's relative error
NEWTON, HALVINGS, LOADED = 30, 12, 1e-6


@dataclass(frozen=True)
class LayeredArray:
    """An array on one layer of 1 MPa, set up for any number of fits; arrays, [pad].

    thickness and its half-width, mm; drawn: stiffness by the design, N/mm; height: standard deviation, mm;
    unit: K_obj of a single level pad for each MPa, N/mm, and d ln unit/d ln thickness.
    """

    number: np.ndarray
    drawn: np.ndarray
    stop: np.ndarray
    height: float
    contact: ManyPresses
    thicker: ManyPresses | None
    thickness: float
    spread: float  # of ln thickness
    unit: float
    unit_by_thickness: float


def layer(
    number: np.ndarray, pads: Pads, height: float, poisson: float, thickness: float, half_width: float = 0.0
) -> LayeredArray:
    """Set up; `pads` is the family's `Pads`, `height` the tolerance of their heights (plus and minus, mm)."""
    K = 1 / pads.compliance[:, 0, 0]
    move = pads.compliance[:, :, 0] * K[:, None]
    fixed = (pads.x.tobytes(), pads.y.tobytes(), move.tobytes(), pads.length, pads.width)
    contact = _contact(*fixed, Body(1.0, poisson, thickness))
    unit = pad_stiffness(contact.body, pads.length, pads.width)
    spread = half_width / thickness * UNIFORM
    thicker, steeper = None, 0.0
    if spread:
        body = Body(1.0, poisson, thickness * (1 + THICKER))
        thicker = _contact(*fixed, body)
        steeper = float(np.log(pad_stiffness(body, pads.length, pads.width) / unit) / np.log1p(THICKER))
    return LayeredArray(
        number, K, pads.stop, height * UNIFORM, contact, thicker, thickness, spread, unit, steeper
    )


@lru_cache(maxsize=64)
def _contact(x: bytes, y: bytes, move: bytes, length: float, width: float, body: Body) -> ManyPresses:
    return ManyPresses(
        np.frombuffer(x), np.frombuffer(y), length, width, np.frombuffer(move).reshape(-1, 3), body
    )


@dataclass(frozen=True)
class LayerFit:
    """Grasps on one layer; arrays with one entry a grasp first.

    modulus     MPa; low, high: its interval (0 and inf if it is not bounded)
    object_     K_obj of a single level pad, N/mm, [estimate, low, high]; object_by_noise without the limits
                of the load cell
    pairs       K_obj by each element other than the reference alone, [grasp, element, 3]
    angle       of the face along x and y, degrees, [grasp, 2, 3]
    force       on each pad at the largest load, N, [grasp, pad]
    noise       V; dof its degrees of freedom
    disagree    probability that errors alone make the elements disagree this much; widened: factor on the
                interval where it is small
    """

    modulus: np.ndarray
    object_: np.ndarray
    object_by_noise: np.ndarray
    pairs: np.ndarray
    angle: np.ndarray
    force: np.ndarray
    noise: np.ndarray
    dof: np.ndarray
    disagree: np.ndarray
    widened: np.ndarray


class _Model:
    """Signals and forces of many grasps by the parameters, and their derivatives."""

    def __init__(
        self,
        at: LayeredArray,
        rows: np.ndarray,
        calibration: Sensitivity,
        load: np.ndarray,
        time: np.ndarray | None,
    ) -> None:
        self.at, self.rows, self.load, self.time = at, rows, load, time
        self.K = at.drawn.copy()
        self.K[rows] = calibration.stiffness
        self.K_v = calibration.signal_per_deflection
        n, m, t = len(at.number), len(rows), len(load)
        sizes = {"E": 1, "slope": 2, "offset": m, "rate": 0 if time is None else m, "approach": t}
        sizes |= {"height": n, "K": n, "K_v": m, "thickness": 1, "own": m}
        ends = np.cumsum([0, *sizes.values()])
        self.part = {name: slice(a, b) for name, a, b in zip(sizes, ends, ends[1:])}
        self.size = int(ends[-1])

    def signals(
        self,
        q: np.ndarray,
        start: np.ndarray | None = None,
        lifted: np.ndarray | None = None,
        as_stated: bool = False,
    ) -> tuple:
        """For parameters q [grasp, parameter]: signal [grasp, element, load], total force [grasp, load],
        depths, forces [grasp, load, pad], and the derivatives of the first two. `as_stated`: the thickness
        stays as it is."""
        at, part, rows = self.at, self.part, self.rows
        thicker = None if as_stated else at.thicker
        G, T, n, m = len(q), len(self.load), len(at.number), len(rows)
        spread = lambda v: np.repeat(v[:, None], T, 1)  # noqa: E731
        E = spread(np.exp(q[:, 0]))
        K = spread(self.K * np.exp(q[:, part["K"]]))
        K_v = self.K_v * np.exp(q[:, part["K_v"]])
        contact = at.contact
        b = contact.approached(
            q[:, part["approach"]], spread(q[:, part["slope"]]), spread(q[:, part["height"]])
        )
        M = contact.system(E, K, lifted)
        r, g, d, J = contact.rest(M, b, b if start is None else start)
        over = E[..., None] / K
        sinks = lambda g: over * np.einsum("gtni,ni->gtn", g, contact.move)  # noqa: E731
        laid = g  # on the layer of this thickness
        if thicker is not None:
            grown = (thicker.near(thicker.system(E, K, lifted), b, r) - g) / np.log1p(THICKER)
            laid = g + q[:, part["thickness"], None, None] * grown
        sink, force = sinks(laid), E[..., None] * laid[..., 0]
        resting = q[:, part["offset"], None]
        if self.time is not None:
            resting = resting + q[:, part["rate"], None] * self.time
        signal = resting + K_v[..., None] * sink[..., rows].swapaxes(1, 2)
        # sinks and load by more of the law's forces, then by depths of each pad in the undisturbed face (its
        # middle's, and slopes), by its hinge's motion, and by its forces
        t, e = np.arange(T), np.arange(m)
        seen = np.zeros((n, 3, m + 1))
        seen[rows, :, e], seen[:, 0, m] = contact.move[rows], 1.0
        more = np.linalg.solve(
            J.swapaxes(-1, -2), np.broadcast_to(seen.reshape(3 * n, -1), (*J.shape[:-1], m + 1))
        )
        more *= np.concatenate([over[..., rows], E[..., None]], -1)[:, :, None]
        ways = np.concatenate([d, d @ contact.move[..., None], g[..., None]], -1).swapaxes(-1, -2)
        back = np.moveaxis(
            ways @ more.reshape(G, T, n, 3, m + 1), (3, 4), (0, 3)
        )  # [way, grasp, load, seen, pad]
        by = np.zeros((G, T, m + 1, self.size))
        by[:, t, :, part["approach"].start + t] = back[0].sum(-1).swapaxes(0, 1)
        for k, along in enumerate((contact.x, contact.y)):
            by[..., part["slope"].start + k] = -back[0] @ along - back[k + 1].sum(-1)
        by[..., part["height"]], by[..., part["own"]] = -back[0], back[4][..., rows]
        by[..., part["K"]] = back[3] * sink[:, :, None]
        by[:, :, e, part["K"].start + rows] -= sink[..., rows]
        # all springs softer alike is a stiffer body, but for the size of the forces
        by[..., 0] = -by[..., part["K"]].sum(-1)
        by[:, :, m, 0] += force.sum(-1)
        if thicker is not None:
            by[:, :, :m, part["thickness"].start] = sinks(grown)[..., rows]
            by[:, :, m, part["thickness"].start] = E * grown[..., 0].sum(-1)
            by[:, :, e, part["own"].start + e] += sinks(laid - g)[..., rows]
            by[:, :, m, part["own"]] += (E[..., None] * (laid - g)[..., 0])[..., rows]
        A, B = by[:, :, :m].swapaxes(1, 2) * K_v[..., None, None], by[:, :, m]
        A[:, e, :, part["offset"].start + e] = 1.0
        if self.time is not None:
            A[:, e, :, part["rate"].start + e] = self.time
        A[:, e, :, part["K_v"].start + e] = (signal - resting).swapaxes(0, 1)
        return signal, force.sum(-1), r, force, A, B


def fit(
    at: LayeredArray,
    element: np.ndarray,
    load: np.ndarray,
    signal: np.ndarray,
    calibration: Sensitivity,
    level: float = 0.95,
    reference: int | None = None,
    time: np.ndarray | None = None,
) -> LayerFit:
    """Evaluate grasps that were read in the same way.

    Parameters
    ----------
    at
        The array on its layer.
    element
        Numbers of the elements read, [element].
    load
        N, [load]; where it is zero nothing touches.
    signal
        V, [grasp, element, load].
    calibration
        Of these elements, in this order.
    level
        Of the intervals.
    reference
        Number of the element that pairs refer to; by default the stiffest.
    time
        Of the loads, in any unit; if given, every signal has a drift rate of its own.
    """
    if time is not None:  # from 0 to 1, so that rates are volts
        time = (time - time.min()) / max(float(np.ptp(time)), 1e-300)
    with np.errstate(all="ignore"):  # readings that nothing explains run out of the numbers' range
        parts = [
            _fit(at, element, load, signal[i : i + BATCH], calibration, level, reference, time)
            for i in range(0, len(signal), BATCH)
        ]
    return LayerFit(*(np.concatenate([getattr(p, name) for p in parts]) for name in vars(parts[0])))


def _fit(
    at: LayeredArray,
    element: np.ndarray,
    load: np.ndarray,
    signal: np.ndarray,
    calibration: Sensitivity,
    level: float,
    reference: int | None,
    time: np.ndarray | None,
) -> LayerFit:
    place = {int(n): i for i, n in enumerate(at.number)}
    rows = np.array([place[int(n)] for n in element])
    touching = load > 0
    model = _Model(at, rows, calibration, load[touching], None if time is None else time[touching])
    resting = np.zeros(0) if time is None else time[~touching]
    part, size, m = model.part, model.size, len(rows)
    free = np.arange(part["own"].start)
    plain = np.r_[part["E"], part["slope"], part["offset"], part["rate"], part["approach"]]
    priors = _priors(model, calibration)
    weigh, loose = priors.weigh, priors.loose
    before, pressed = signal[:, :, ~touching], signal[:, :, touching]
    rests, G = before.shape[2], len(signal)
    unloaded = before.mean(2) if rests else np.zeros((G, m))
    count = pressed.shape[1] * pressed.shape[2] + m * rests
    load_weight = 1 / (LOAD * load.max()) ** 2
    by_law = np.maximum(SHAPE * pressed.shape[2] ** 0.5 * np.ptp(signal, axis=2).max(1), 1e-12)
    noise = ROUGH * by_law

    def cost_of(i: np.ndarray, q: np.ndarray, state: tuple) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Cost of grasps i, and the residuals of signals and loads."""
        off, over = pressed[i] - state[0], load[touching] - state[1]
        zero = before[i] - q[:, part["offset"], None]
        if time is not None:
            zero = zero - q[:, part["rate"], None] * resting
        squares = (off**2).sum((1, 2)) + (zero**2).sum((1, 2))
        known = np.einsum("gi,ij,gj->g", q, weigh, q) + (over**2).sum(1) * load_weight
        return squares / noise[i] ** 2 + known, off, over

    def normal(i: np.ndarray, q: np.ndarray, state: tuple) -> tuple[np.ndarray, np.ndarray]:
        """Matrix without priors, and downhill direction of half the cost."""
        _, off, over = cost_of(i, q, state)
        sigma = noise[i]
        A = state[4].reshape(len(i), -1, size) / sigma[:, None, None]
        B = state[5] * load_weight**0.5
        N = A.swapaxes(1, 2) @ A + B.swapaxes(1, 2) @ B
        down = (A.swapaxes(1, 2) @ (off.reshape(len(i), -1, 1) / sigma[:, None, None]))[..., 0]
        down += (B.swapaxes(1, 2) @ (over[..., None] * load_weight**0.5))[..., 0]
        o = np.arange(part["offset"].start, part["offset"].stop)
        N[:, o, o] += rests / sigma[:, None] ** 2
        if time is None:
            down[:, o] += rests * (unloaded[i] - q[:, part["offset"]]) / sigma[:, None] ** 2
        else:
            p = np.arange(part["rate"].start, part["rate"].stop)
            left = before[i] - q[:, part["offset"], None] - q[:, part["rate"], None] * resting
            down[:, o] += left.sum(2) / sigma[:, None] ** 2
            down[:, p] += left @ resting / sigma[:, None] ** 2
            N[:, p, p] += resting @ resting / sigma[:, None] ** 2
            N[:, o, p] += resting.sum() / sigma[:, None] ** 2
            N[:, p, o] += resting.sum() / sigma[:, None] ** 2
        return N, down - q @ weigh

    def follow(i: np.ndarray, q: np.ndarray, state: tuple) -> np.ndarray:
        """Steps of the approaches alone, [grasp, load]."""
        _, off, over = cost_of(i, q, state)
        a, t = np.arange(part["approach"].start, part["approach"].stop), np.arange(len(model.load))
        A, B = state[4][:, :, t, a] / noise[i, None, None], state[5][:, t, a]
        downhill = (A * off / noise[i, None, None]).sum(1) + B * over * load_weight
        return downhill / ((A**2).sum(1) + B**2 * load_weight)

    q = _start(model, pressed, before, load[touching])
    state = model.signals(q, as_stated=True)
    lifted = at.contact.lifted(state[2])
    every = unsettled = np.arange(G)
    cost, noise_now, dof = np.ones((3, G))
    for stage in range(STAGES):
        chosen = free if stage else plain
        if stage:
            lifted[unsettled] = at.contact.lifted(state[2][unsettled])
            again = model.signals(q[unsettled], state[2][unsettled], lifted[unsettled])
            for old, new in zip(state, again):
                old[unsettled] = new
        cost[unsettled] = cost_of(unsettled, q[unsettled], tuple(a[unsettled] for a in state))[0]
        first = cost.copy()
        damping, idle, at_work = np.full(G, 1e-6), np.zeros(G, int), unsettled
        settled = SETTLED if stage else ROUGHLY
        for _ in range(STEPS):
            i = at_work
            now = tuple(a[i] for a in state)
            N, down = normal(i, q[i], now)
            N = (N + weigh)[:, chosen[:, None], chosen]
            diagonal = np.einsum("gii->gi", N)
            N = N + damping[i, None, None] * diagonal[:, None, :] * np.eye(len(chosen))
            step = np.zeros((len(i), size))
            step[:, chosen] = _solve(N, down[:, chosen, None])[..., 0]
            far = np.maximum(np.abs(step[:, 0]) / 0.7, np.abs(step[:, part["slope"]]).max(1) / 0.05)
            # such a step is left to the results, or to the next stage; a damped one does not mean convergence
            close = (np.einsum("gi,gi->g", step, down) < settled) & (far < 1.0) & (damping[i] < 1e-3)
            if not stage:  # evaluated by the next one
                q[i[close]] += step[close]
            if close.all():
                break
            i, step, far, now = i[~close], step[~close], far[~close], tuple(a[~close] for a in now)
            tried_q = q[i] + step / np.maximum(far, 1.0)[:, None]
            tried = model.signals(tried_q, now[2], lifted[i], not stage)
            gain = cost[i] - cost_of(i, tried_q, tried)[0]
            if (bent := np.flatnonzero(gain < 0)).size:
                # along a valley that bends, approaches follow what else has moved
                followed_q = tried_q[bent]
                followed_q[:, part["approach"]] += follow(i[bent], followed_q, tuple(a[bent] for a in tried))
                followed = model.signals(followed_q, tried[2][bent], lifted[i[bent]], not stage)
                gain_by_it = cost[i[bent]] - cost_of(i[bent], followed_q, followed)[0]
                up = gain_by_it > gain[bent]
                tried_q[bent[up]], gain[bent[up]] = followed_q[up], gain_by_it[up]
                for old, new in zip(tried, followed):
                    old[bent[up]] = new[up]
            better = gain >= 0
            q[i[better]] = tried_q[better]
            for old, new in zip(state, tried):
                old[i[better]] = new[better]
            cost[i[better]] -= gain[better]
            idle[i] = np.where(gain >= settled, 0, idle[i] + 1)
            done = idle[i] >= IDLE
            damping[i] = np.where(better, 0.1 * damping[i], np.maximum(10.0 * damping[i], 1e-4))
            at_work = i[~done]
            if not len(at_work):
                break
        if not stage:
            noise = 2 * by_law  # from once, fits on inclined faces run out of steps
            continue
        i = unsettled
        N, down = normal(i, q[i], tuple(a[i] for a in state))
        down_loose = (down + q[i] @ (weigh - loose))[:, free]
        N_loose = (N + loose)[:, free[:, None], free]
        gain = np.einsum("gi,gi->g", down_loose, _solve(N_loose, down_loose[..., None])[..., 0])
        quiet = cost[i] - np.einsum("gi,ij,gj->g", q[i], weigh - loose, q[i]) - gain
        inverse = _solve(N_loose, np.broadcast_to(np.eye(len(free)), N_loose.shape))
        # loads are met far better than their weight says: as readings they would make the noise too small
        by_load = state[5][i][..., free] * load_weight**0.5
        known = loose[free[:, None], free] + by_load.swapaxes(1, 2) @ by_load
        dof[i] = np.maximum(count - len(free) + np.einsum("gij,gji->g", inverse, known), 1.0)
        noise_now[i] = noise[i] * np.maximum(quiet, 1e-18 * count) ** 0.5 / dof[i] ** 0.5
        before_ = noise[i]
        noise[i] = np.hypot(noise_now[i], by_law[i])
        # each grasp by its own noise, so that in a stream it is what it is alone
        moved = first[i] - cost[i] > MOVED
        unsettled = i[~((noise[i] < 1.5 * before_) & (noise[i] > before_ / 1.5)) | moved]
        if not len(unsettled):
            break
    K = model.K[rows]
    r = int(np.argmax(K)) if reference is None else int(np.flatnonzero(element == reference)[0])
    last = state[3][:, int(np.argmax(model.load))]
    return _results(
        at, model, calibration, q, last, *normal(every, q, state), priors, noise_now, dof, level, r
    )


def _solve(N: np.ndarray, right: np.ndarray) -> np.ndarray:
    """N of parameters in very different units."""
    unit = np.einsum("...ii->...i", N) ** -0.5
    return unit[..., None] * np.linalg.solve(
        N * unit[..., None] * unit[..., None, :], unit[..., None] * right
    )


@dataclass(frozen=True)
class _Priors:
    """Weights of all parameters beforehand (`loose`: with K and K_v as good as free; `others`: without them);
    places of ln K and ln K_v of each element, their weights, own covariances, and how the load cell's limits
    shift them."""

    weigh: np.ndarray
    loose: np.ndarray
    others: np.ndarray
    calibrated: np.ndarray
    of_element: np.ndarray
    own: np.ndarray
    shift: list[np.ndarray]


def _priors(model: _Model, c: Sensitivity) -> _Priors:
    part, at, m = model.part, model.at, len(model.rows)
    others = np.zeros((model.size, model.size))
    unread = np.setdiff1d(np.arange(len(at.number)), model.rows)
    for where, deviation in (
        (np.r_[part["slope"]], STEEP),
        (np.r_[part["height"]], at.height),
        (part["K"].start + unread, UNREAD),
        (np.r_[part["thickness"]], max(at.spread, 1e-6)),
    ):
        others[where, where] = deviation**-2
    k, v = c.stiffness_se / c.stiffness, c.signal_per_deflection_se / np.abs(c.signal_per_deflection)
    both = c.correlation * k * v * np.sign(c.signal_per_deflection)
    own = np.moveaxis(np.array([[k * k, both], [both, v * v]]), 2, 0)
    dof = c.dof[:, None, None]
    common = (dof * own).sum(0) / dof.sum()
    model_part = np.diag([MODEL**2, 1e-12])
    of_element = np.linalg.inv((dof * own + PRIOR_DOF * common) / (dof + PRIOR_DOF) + model_part)
    calibrated = np.stack([part["K"].start + model.rows, part["K_v"].start + np.arange(m)], -1)
    weigh, loose = others.copy(), others.copy()
    for pair, weight in zip(calibrated, of_element):
        weigh[np.ix_(pair, pair)], loose[np.ix_(pair, pair)] = weight, LOOSE * weight
    shift = []
    if (c.load_cell_half_width > 0).any():
        for other in (c.at_load_cell_limit(-1.0), c.at_load_cell_limit(1.0)):
            ratios = other.stiffness / c.stiffness, other.signal_per_deflection / c.signal_per_deflection
            shift.append(np.log(np.stack(ratios, -1)))
    return _Priors(weigh, loose, others, calibrated, of_element, own + model_part, shift)


def _start(model: _Model, pressed: np.ndarray, before: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Parameters to begin with: equation (1) with coupled pads, linear in 1/E, slopes and approaches."""
    at, part, rows = model.at, model.part, model.rows
    G, m, T = pressed.shape
    q = np.zeros((G, model.size))
    away = load - load.mean()
    rise = pressed @ away / max(away @ away, 1e-300)
    offset = before.mean(2) if before.shape[2] else pressed.mean(2) - rise * load.mean()
    q[:, part["offset"]] = offset
    s = (pressed - offset[..., None]) / model.K_v[:, None]
    s = np.maximum(s, 0.0)
    n = len(at.number)
    face = at.contact.between.reshape(n, 3, n, 3)[:, 0, :, 0][np.ix_(rows, rows)].copy()
    face[np.arange(m), np.arange(m)] = 1 / at.unit
    phi = np.einsum("ij,gjt->git", face, s * model.K[rows][:, None])
    touch = s > 0.05 * s.max((1, 2), initial=1e-300)[:, None, None]
    A = np.zeros((G, m, T, 3 + T))
    A[..., 0] = phi
    A[..., 1] = at.contact.x[rows][:, None]
    A[..., 2] = at.contact.y[rows][:, None]
    A[:, :, np.arange(T), 3 + np.arange(T)] = -1.0
    A *= touch[..., None]
    N = np.einsum("gitp,gitq->gpq", A, A)
    N[:, np.arange(3 + T), np.arange(3 + T)] *= 1 + 1e-9
    N[:, np.arange(3 + T), np.arange(3 + T)] += 1e-12 * np.einsum("gii->g", N)[:, None]
    # slopes only as far as the readings say them
    N[:, [1, 2], [1, 2]] += (np.ptp(s, axis=(1, 2)) ** 2 * 1e-2 / STEEP**2)[:, None]
    found = np.linalg.solve(N, -np.einsum("gitp,git->gp", A, s * touch)[..., None])[..., 0]
    softest = float(np.median(model.K[rows])) / at.unit
    compliance = np.where(found[:, 0] > 1e-3 / softest, found[:, 0], 1 / softest)
    q[:, 0] = -np.log(np.minimum(compliance, 1e3 / softest))
    good = found[:, 0] > 1e-3 / softest
    q[:, part["slope"]] = np.where(good[:, None], np.clip(found[:, 1:3], -0.2, 0.2), 0.0)
    least = (s + phi * np.exp(-q[:, 0])[:, None, None]).max(1)
    q[:, part["approach"]] = np.where(good[:, None], np.maximum(found[:, 3:], 0.2 * least), least)
    return q


def _errors(
    priors: _Priors,
    calibration_dof: np.ndarray,
    dof: np.ndarray,
    level: float,
    row: np.ndarray,
    variance: np.ndarray,
    known: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """For a quantity with covariance `row` [grasp, parameter] with all parameters: standard error, Student's
    quantile, and how far the load cell's limits shift it."""
    pull = np.einsum("eij,gej->gei", priors.of_element, row[:, priors.calibrated])
    stated = np.einsum("gei,gei->g", pull, row[:, priors.calibrated])
    actual = np.einsum("gei,eij,gej->ge", pull, priors.own, pull)
    others = np.einsum("gi,ij,gj->g", row, known, row)
    by_noise = np.maximum(variance - stated - others, 0.0)
    total = by_noise + others + actual.sum(1)
    bottom = by_noise**2 / dof + (actual**2 / calibration_dof).sum(1)
    freedom = np.clip(total**2 / np.maximum(bottom, 1e-300), 1.0, KNOWN)
    moved = np.array([np.einsum("gei,ei->g", pull, s) for s in priors.shift] or [np.zeros(len(row))])
    quantile = np.array([t_quantile(level, float(f)) for f in freedom])
    return total**0.5, quantile, np.abs(moved).max(0)


def _results(
    at: LayeredArray,
    model: _Model,
    c: Sensitivity,
    q: np.ndarray,
    force: np.ndarray,
    N: np.ndarray,
    down: np.ndarray,
    priors: _Priors,
    noise: np.ndarray,
    dof: np.ndarray,
    level: float,
    r: int,
) -> LayerFit:
    part, G, K = model.part, len(q), model.K[model.rows]
    free = np.arange(part["own"].start)

    def covariance(weigh: np.ndarray, keep: np.ndarray, of: np.ndarray) -> np.ndarray:
        """Of all parameters with the combinations `of` them, [grasp, combination, parameter]."""
        found = np.zeros((G, len(of), model.size))
        part_of = (N + weigh)[:, keep[:, None], keep]
        right = np.broadcast_to(of[:, keep].T, (G, len(keep), len(of)))
        found[..., keep] = _solve(part_of, right).swapaxes(-1, -2)
        return found

    def errors(row: np.ndarray, variance: np.ndarray, known: np.ndarray) -> tuple[np.ndarray, ...]:
        return _errors(priors, c.dof, dof, level, row, variance, known)

    each = np.eye(model.size)
    loose = covariance(priors.loose, free, each)
    # what the priors of K and K_v cost against as many freedoms as they take
    gone = priors.weigh - priors.loose
    taken = np.count_nonzero(np.diag(priors.weigh)) - np.einsum("gij,ji->g", loose, priors.loose)
    uphill = down + q @ gone
    cost = np.einsum("gi,ij,gj->g", q, gone, q) + np.einsum("gi,gij,gj->g", uphill, loose, uphill)
    taken = np.maximum(taken, 1e-9)
    p = fdtrc(taken, max(float(c.dof.sum()), 1.0), np.maximum(cost / taken, 0.0))
    widened = np.where(p < DISAGREE, np.maximum(cost / taken, 1.0) ** 0.5, 1.0)

    modulus, stiffness = each[0], each[0] + at.unit_by_thickness * each[part["thickness"].start]
    slopes = range(part["slope"].start, part["slope"].stop)
    full = covariance(priors.weigh, free, np.array([modulus, stiffness, *each[part["slope"]]]))
    soft = float(K.min()) if K.min() < K[r] else float(K.max())
    found = []
    for combination, row in zip((modulus, stiffness), full.swapaxes(0, 1)):
        se, t, moved = errors(row, row @ combination, priors.others)
        se = np.hypot(se, COMMON)
        x = q @ combination + np.log(at.unit)
        away = np.einsum("gi,gi->g", row, down)
        found.append(_even_in_ratio(x, away, t * se * widened + moved, K[r], soft))
        by_noise = _even_in_ratio(x, away, t * se, K[r], soft)
    pairs = np.full((G, len(K), 3), np.nan)
    own = part["own"].start + np.setdiff1d(np.arange(len(K)), r)
    weigh, known = priors.weigh.copy(), priors.others.copy()
    weigh[own, own] = LOOSE
    for of in (weigh, known):
        of[part["height"], part["height"]] *= FREE_HEIGHTS
    row, *others = covariance(weigh, np.r_[free, own], np.array([stiffness, *each[own]])).swapaxes(0, 1)
    pull = down + q @ (priors.weigh - weigh)
    for e, other in zip(own - part["own"].start, others):
        if abs(K[e] / K[r] - 1) > SAME:  # with this pad's own modulus fixed
            i = part["own"].start + e
            alone = row - (row[:, i] / other[:, i])[:, None] * other
            se, t, moved = errors(alone, alone @ stiffness, known)
            away = np.einsum("gi,gi->g", alone, pull)
            pairs[:, e] = _even_in_ratio(q @ stiffness + np.log(at.unit), away, t * se + moved, K[r], K[e])
    angle = np.empty((G, 2, 3))
    for k, i in enumerate(slopes):
        se, t, moved = errors(full[:, 2 + k], full[:, 2 + k, i], priors.others)
        half = t * se * widened + moved
        slope = q[:, i] + np.einsum("gi,gi->g", full[:, 2 + k], down)
        angle[:, k] = np.degrees(np.arctan(np.stack([slope, slope - half, slope + half], -1)))
    return LayerFit(found[0] / at.unit, found[1], by_noise, pairs, angle, force, noise, dof, p, widened)


def _even_in_ratio(
    ln_x: np.ndarray, away: np.ndarray, half: np.ndarray, K_r: float, K_m: float
) -> np.ndarray:
    """K_obj and its interval, [grasp, 3], from ln K_obj, a step away from it and a half-width, all taken to
    ln R of two elements, where errors are even."""
    K_r, K_m, x = max(K_r, K_m), min(K_r, K_m), np.exp(ln_x)
    steep = x * (K_r - K_m) / ((K_r + x) * (K_m + x))
    middle = np.log1p((K_r - K_m) / (K_m + x)) - steep * away

    def object_(ln_R: np.ndarray) -> np.ndarray:
        R = np.exp(np.clip(ln_R, 1e-15, np.log(K_r / K_m)))
        value = (K_r - R * K_m) / (R - 1)
        return np.where(ln_R <= 1e-15, inf, np.maximum(value, 0.0))

    return np.stack([object_(middle), object_(middle + steep * half), object_(middle - steep * half)], -1)


@dataclass(frozen=True)
class Expected:
    """Expected results of `fit` before any grasp; arrays with one entry a grasp first.

    object_     K_obj, N/mm, [estimate, low, high]; modulus: E, MPa, likewise
    force       on each pad at the largest load, N; sink of its middle, mm, [grasp, pad]
    first       force on the pad that bears least at the first load, N
    """

    object_: np.ndarray
    modulus: np.ndarray
    force: np.ndarray
    sink: np.ndarray
    first: np.ndarray


def expected(
    at: LayeredArray,
    load: np.ndarray,
    calibration: Sensitivity,
    modulus: np.ndarray,
    slope: np.ndarray,
    noise: float,
    *,
    readings: int | None = None,
    shared: tuple[np.ndarray, ...] = (),
    stiffness: np.ndarray | None = None,
    height: np.ndarray | None = None,
) -> Expected:
    """The intervals that `fit` gives on average, by its own equations made linear about the truth.

    Parameters
    ----------
    at
        The array on its layer, all of whose elements are read.
    load
        N, [load], above zero; one reading without load comes before.
    calibration
        As expected, all elements in their order.
    modulus, slope
        True, MPa, [grasp], and of the face, [grasp, 2].
    noise
        Of a reading, V.
    readings
        Number of loads that are read, if `load` has only a few representatives.
    shared
        ln K and ln K_v of every element, [element, 2], for one standard deviation of each error common to
        all.
    stiffness, height
        True, if they are not as drawn and level: N/mm and mm, [grasp, pad].
    """
    n, G, T = len(at.number), len(modulus), len(load)
    rows, several = np.arange(n), (readings or T) / T
    model = _Model(at, rows, calibration, load, None)
    part, free = model.part, np.arange(model.part["own"].start)
    q = np.zeros((G, model.size))
    q[:, 0], q[:, part["slope"]] = np.log(modulus), slope
    q[:, part["height"]] = 0.0 if height is None else height
    q[:, part["K"]] = 0.0 if stiffness is None else np.log(stiffness / model.K)
    depth = _approaches(model, q)
    signal, _, _, force, A, B = model.signals(q, depth)
    by_law = SHAPE * T**0.5 * np.ptp(signal, axis=2).max(1)
    sigma = np.hypot(noise / several**0.5, by_law)
    A = A.reshape(G, n * T, model.size) / sigma[:, None, None]
    N = A.swapaxes(1, 2) @ A + B.swapaxes(1, 2) @ B * (several / (LOAD * load.max()) ** 2)
    o = np.arange(part["offset"].start, part["offset"].stop)
    N[:, o, o] += 1 / np.hypot(noise, by_law)[:, None] ** 2
    priors = _priors(model, calibration)
    N = (N + priors.weigh)[:, free[:, None], free]
    dof = np.full(G, max(n * (several * T + 1) - n - several * T - 3.0, 1.0))
    K = model.K
    soft, stiff = float(K.min()), float(K.max())
    found = []
    for by_thickness in (at.unit_by_thickness, 0.0):
        quantity = np.zeros(len(free))
        quantity[0], quantity[part["thickness"].start] = 1.0, by_thickness
        row = np.zeros((G, model.size))
        row[:, free] = _solve(N, np.broadcast_to(quantity[:, None], (G, len(free), 1)))[..., 0]
        se, t, moved = _errors(
            priors, calibration.dof, dof, LEVEL, row, row[:, free] @ quantity, priors.others
        )
        pull = np.einsum("eij,gej->gei", priors.of_element, row[:, priors.calibrated])
        alike = sum(np.einsum("gei,ei->g", pull, each) ** 2 for each in shared)
        x = np.log(modulus * at.unit)
        half = t * np.sqrt(se**2 + COMMON**2 + alike) + moved
        found.append(_even_in_ratio(x, np.zeros(G), half, stiff, soft))
    sink = (signal / model.K_v[:, None])[:, :, -1]
    return Expected(found[0], found[1] / at.unit, force[:, -1], sink, force[:, 0].min(1))


def _approaches(model: _Model, q: np.ndarray) -> np.ndarray:
    """Sets the approaches at which the pads bear the loads; the pads' depths there.

    Newton's method for depths and approach at once, [pose], a pose that is solved left out. Where no step
    lessens what is left, as between two cells of the pads' law, a pose keeps its place.
    """
    at, part, contact = model.at, model.part, model.at.contact
    G, T, n = len(q), len(model.load), len(model.at.number)
    each = lambda v: np.repeat(v, T, 0)  # noqa: E731
    E, K = each(np.exp(q[:, 0])), each(model.K * np.exp(q[:, part["K"]]))
    slope, height, load = each(q[:, part["slope"]]), each(q[:, part["height"]]), np.tile(model.load, G)
    M, level = contact.system(E, K), contact.approached(np.zeros(G * T), slope, height)
    alone = 1 / (1 / (E * at.unit) + 1 / K.mean(-1))
    # the approach on separate, equal springs
    ready = np.sort(-level[..., 0], -1)
    springs = ((load / alone)[:, None] + np.cumsum(ready, -1)) / np.arange(1, n + 1)
    last = np.maximum((springs > ready).sum(-1, keepdims=True) - 1, 0)
    approach = np.take_along_axis(springs, last, -1)[:, 0]
    depth = level.copy()
    depth[..., 0] += approach[:, None]

    def state(i: np.ndarray, depth: np.ndarray, approach: np.ndarray) -> list[np.ndarray]:
        """Derivatives of the law's forces, what is left of depths (mm) and load (N), and both by one."""
        g, d = contact.law(depth)
        off = level[i] - depth - (M[i] @ g.reshape(len(i), 3 * n, 1)).reshape(depth.shape)
        off[..., 0] += approach[:, None]
        miss = load[i] - E[i] * g[..., 0].sum(-1)
        return [d, off, miss, (off**2).sum((-1, -2)) + (miss / alone[i]) ** 2]

    todo = np.arange(G * T)
    now, close = state(todo, depth, approach), CLOSE * np.abs(depth).max((-1, -2))
    for _ in range(NEWTON):
        d, off, miss, size = now
        rough = (np.abs(off).max((-1, -2)) > close[todo]) | (np.abs(miss) > LOADED * load[todo])
        todo, d, off, miss, size = todo[rough], d[rough], off[rough], miss[rough], size[rough]
        if not len(todo):
            break
        right = np.stack([(d @ off[..., None])[..., 0], d[..., 0]], -1)  # as is, and by the approach
        more = np.linalg.solve(pressing(M[todo], d), right.reshape(-1, 3 * n, 2))
        step = -(M[todo] @ more).reshape(*off.shape, 2)
        step[..., 0] += off
        step[..., 0, 1] += 1.0
        bears = E[todo, None] * more[:, ::3].sum(1)
        by = (miss - bears[:, 0]) / np.maximum(bears[:, 1], 1e-3 * alone[todo])
        deeper, share, left = step[..., 0] + by[:, None, None] * step[..., 1], 1.0, np.arange(len(todo))
        now = [d, off, miss, size]
        for _ in range(HALVINGS):
            i = todo[left]
            tried = depth[i] + share * deeper[left], approach[i] + share * by[left]
            found = state(i, *tried)
            better = found[3] <= size[left]
            depth[i[better]], approach[i[better]] = (v[better] for v in tried)
            for old, new in zip(now, found):
                old[left[better]] = new[better]
            left, share = left[~better], share / 2
            if not len(left):
                break
        todo, now = np.delete(todo, left), [np.delete(v, left, 0) for v in now]
    q[:, part["approach"]] = approach.reshape(G, T)
    return depth.reshape(G, T, n, 3)
