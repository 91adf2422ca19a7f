"""Object stiffness K_obj from grasp readings: for each pair of elements, and for all of them together.

All pads move by the same approach p(load), so signal = offset + g p: an element's pad height and tilt go into
its offset; errors of the load, friction and relaxation go into p, which all elements share. With s = g/K_v
(deflection) and f = K s (force) per unit approach, equation (1) says that f + x s is the same for all
elements, x = K_obj. A pair gives equation (3), x = (f_r - f_m)/(s_m - s_r), with Fieller's interval. All
elements together give the x that makes f + x s most equal: the generalised least squares of the pairs, which
are correlated because they share a reference element.

The stiffness of the calibration's load cell acts on all elements at once and is known within limits only: the
intervals are evaluated at these limits, and the interval given is the smallest that covers all of them.

On one body the pads feel each other, tilt and lift, and its face is inclined: `on_layers` evaluates the same
readings on layers (layer_fit), on one layer if its thickness is known, else on layers from the thinnest valid
for rigid pads to the half-space, and covers all of their intervals.
"""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import combinations
from math import inf, isinf
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.special import fdtrc

from tactcad.design.messages import InputError
from tactcad.lab.column_units import LOAD, unlikely
from tactcad.lab.combine import Interval, Slopes, combine, combine_each, hull, scatter
from tactcad.lab.readings import GraspReadings
from tactcad.lab.regression import TOLD_FROM_TIME, require_level, t_quantile
from tactcad.report.figures import aligned
from tactcad.report.report import plain

from .calibration_file import Sensitivity
from .layer_fit import WILD, LayeredArray, fit

SCHEMA = "tactcad-stiffness-1"
STRAY = 1e-4  # probability, over all elements, below which an element is reported not to follow the others
SWAPPED = 5.0  # times nearer to others' zeros than to its own, from which on a channel is swapped; chosen
EXCHANGED = 10.0  # times widened interval from which on swapped channels are looked for: on a layer elements
# disagree as well, and an exchange then makes them agree by chance, up to 3 times (80 labs, measured). Of
# four inclined by 4 degrees, one does at 10 times too: looked for among FEW elements and more.
FEW = 6
REVERSED = 0.1  # of the middle element's force, from which on one that falls is refused; chosen
SURELY = 3.0  # standard errors below zero from which an element's force is reported to fall; chosen
TOUCHES = 1e-3  # of the largest force on a pad, from which a pad counts as touching
BEARS = 0.02  # likewise, from which it tells the face's angle: four cells hold as stated where three do so
ROUNDED = 1e-9  # below which a singular value of unit columns is nought but rounding
# An element is at its stop where its deflection is at least NEAR_STOP of the nominal one there (the gap's
# tolerance and seat are up to 0.2 of it), grows with the load by less than SLOWED of what it did before, and
# by less than STANDS of that at all larger loads. Readings are averaged at LEVELS loads, so that noise does
# not count.
NEAR_STOP, SLOWED, STANDS, LEVELS = 0.75, 0.7, 0.2, 25
COUPLED = (0.25, 0.5, 1.0)  # tried shares of the coupling: K_obj need not be most extreme at the full one


@dataclass(frozen=True)
class Pair:
    """One measuring element against the reference: the deflection ratio R and K_obj, with intervals."""

    measuring: int
    reference: int
    ratio: float  # R
    ratio_low: float
    ratio_high: float
    object: Interval
    object_by_noise: Interval  # by noise and calibration alone, without what is known within limits
    condition: float  # relative change of K_obj over that of R, at the estimate


@dataclass(frozen=True)
class Grasp:
    """The evaluation of one sample's readings; K_obj in N/mm."""

    sample: int
    pairs: tuple[Pair, ...]
    combined: Interval
    combined_by_noise: Interval  # by noise and calibration alone
    combined_by_limits: tuple[tuple[str, Interval], ...]  # what is known within limits added one by one
    noise: float  # standard deviation of one signal about the common approach, V
    dof: int
    disagreement_p: float  # probability that noise alone makes the elements disagree this much
    widened: float  # factor on the combined standard error for disagreement; 1 if they agree
    loads: int  # number used
    dropped_loads: int
    notes: tuple[str, ...]
    warnings: tuple[str, ...]  # of columns that may be in another unit, of intervals that do not hold
    layer: OnLayer | None = None  # if the object was taken as a layer


@dataclass(frozen=True)
class OnLayer:
    """Results of the readings for a layer.

    modulus    MPa; None if the thickness is not known
    angle      of its face along x and y, degrees: estimate, low, high of each
    touching   numbers of all pads that press at the largest load, also those without readings
    springs    K_obj by separate springs, for comparison
    """

    modulus: Interval | None
    angle: tuple[tuple[float, ...], ...]
    touching: tuple[int, ...]
    springs: Interval


def evaluate(
    readings: GraspReadings,
    calibration: Sensitivity,
    *,
    reference: int | None = None,
    level: float = 0.95,
    coupling: np.ndarray | None = None,
    overload_force: float = inf,
    elements: int = 0,
) -> Grasp:
    """K_obj of one sample.

    Parameters
    ----------
    readings : GraspReadings
        Signals (V) of its elements at every load.
    calibration : Sensitivity
        Of these elements at least.
    reference : int, optional
        Number of the reference element; by default the stiffest of those read.
    level : float
        Confidence level of every interval, from 0.5 to below 1.
    coupling : array, [element, element], optional
        Largest displacement of a pad by the force on another, over that by the same force on itself, in the
        order of `readings.element`; the object's is taken to lie between zero and this. Without it the pads
        are taken to press on separate springs.
    overload_force : float, optional
        N on one element, the most that its stop takes: what passes it is noted.
    elements : int, optional
        Number in the whole array, which bears the load; by default those read.

    Returns
    -------
    Grasp

    Raises
    ------
    InputError
        An element without calibration or with a constant signal, a reference that was not read, fewer than
        two elements or than three loads above zero, two elements whose channels are swapped, one whose
        channel is reversed.
    """
    require_level(level)
    touching, where = readings.load > 0, f"{readings.path}: sample {readings.sample}"
    _refuse_swapped(readings, calibration)
    if touching.sum() < 3 or len(readings.element) < 2:
        value = f"{len(readings.element)} elements at {int(touching.sum())} loads above zero"
        legal = "two elements and three loads at least"
        raise InputError(where, "too little to tell a slope from noise", value=value, legal=legal)
    signal, terms = readings.signal[:, touching], None
    notes = []
    if readings.time is not None:
        terms = drift_terms(readings.load, readings.time)
        if terms is None:
            notes.append(
                "the load goes with time, so drift is not estimated; read without load before and after, "
                "or the loads up and down"
            )
        else:
            signal = readings.signal
    slopes, noise = common_slopes(readings.element, signal, calibration, terms)
    smallest = np.finfo(float).tiny ** 0.5  # its square still has digits
    for constant in slopes.element[np.abs(slopes.s) < smallest][:1]:
        raise InputError(where, f"element {constant}: its signal does not change with the load")
    number = int(readings.element[np.argmax(slopes.f / slopes.s)]) if reference is None else reference
    if number not in readings.element:
        what, legal = "was not read in this grasp", str(readings.element.tolist())
        raise InputError(f"{readings.path}: reference", what, value=number, legal=legal)
    r = int(np.flatnonzero(readings.element == number)[0])
    others = [i for i in np.argsort(-slopes.f / slopes.s, kind="stable") if i != r]
    limits = _limits(readings.element, signal, calibration, slopes, coupling, terms)
    everywhere = [at for group in limits.values() for at in group]
    cases = [slopes, *everywhere]
    found = iter(combine_each([(at, [int(m), r]) for m in others for at in cases], level))
    pairs = tuple(_pair(slopes, [next(found)[0] for _ in cases], int(m), r, level) for m in others)
    combined, p, widened = combine(slopes, level)
    if widened > EXCHANGED and len(readings.element) >= FEW:
        _refuse_exchanged(readings, signal, calibration, terms, level)
    by_limits = tuple(
        (name, hull(combined, [i for i, _, _ in combine_each([(at, None) for at in group], level)]))
        for name, group in limits.items()
    )
    dropped = int((~touching).sum())
    if terms is not None:
        notes.append(f"drift of every signal is removed, estimated from {signal.shape[1]} readings over time")
    elif dropped:
        notes.append(
            f"{dropped} of {len(touching)} loads are zero and left out: before contact the pads' heights "
            "enter"
        )
    notes += _strays(readings.element, signal, terms)
    load = readings.load[touching]
    wrong, rise = _wrong_forces(
        load, readings.signal[:, touching], calibration, slopes, noise, overload_force, where
    )
    notes += wrong
    borne = float(np.ptp(load)) * min(len(signal) / max(elements, 1), 1.0)
    sums, (load_name, signal_name) = [(abs(rise), borne)] if borne else [], readings.columns
    what = f"sample {readings.sample}: by the calibration the forces rise by"
    if widened > 1:
        notes.append(
            f"the elements disagree beyond their noise (p {p:.1g}): combined interval widened "
            f"{widened:.2g} times"
        )
    return Grasp(
        readings.sample,
        pairs,
        hull(combined, [i for _, i in by_limits]),
        combined,
        by_limits,
        noise,
        slopes.signal_dof,
        p,
        widened,
        int(touching.sum()),
        dropped,
        tuple(notes),
        tuple(unlikely(what, {load_name: -1, signal_name: 1}, sums, "N", LOAD)),
    )


def _refuse_swapped(readings: GraspReadings, calibration: Sensitivity) -> None:
    """Refuse signals without load that are the calibration's zeros in another order."""
    zero, resting = calibration.of(readings.element).zero, readings.load == 0
    if zero is None or not np.isfinite(zero).all() or not resting.any() or len(zero) < 3:
        return
    read = readings.signal[:, resting].mean(1)
    away = np.abs(read[:, None] - zero)  # [element read, element calibrated]
    own, nearest = np.diag(away), linear_sum_assignment(away)[1]
    moved = np.flatnonzero(nearest != np.arange(len(zero)))
    if not len(moved) or own[moved].min() < SWAPPED * away[np.arange(len(zero)), nearest].max():
        return
    if own[moved].max() > np.ptp(readings.signal, axis=1).max() / SWAPPED:
        a, b = moved[0], nearest[moved[0]]
        n, m = readings.element[[a, b]].tolist()
        raise InputError(
            f"{readings.path}: sample {readings.sample}",
            f"without load, element {n} has the zero of element {m} in the calibration, and all others have "
            "one of their own: channels swapped?",
            value=round(float(read[a]), 4),
            legal=f"{zero[a]:.4g} V",
        )


def below_stops(
    readings: GraspReadings, calibration: Sensitivity, at: LayeredArray
) -> tuple[GraspReadings, tuple[str, ...]]:
    """The readings at loads below that at which the first element reaches its stop, and a note where that
    leaves some out. A stopped pad bears more than its spring says, so the others' readings err as well.

    Raises
    ------
    InputError
        Fewer than three loads are left.
    """
    place = {int(n): i for i, n in enumerate(at.number)}
    stop = at.stop[[place[int(n)] for n in readings.element]]
    touching = readings.load > 0
    sink = readings.signal / calibration.of(readings.element).signal_per_deflection[:, None]
    apart = readings.load.max(initial=1e-300) / LEVELS
    level = np.rint(readings.load[touching] / apart)
    load, *sinks = (
        np.array([v[touching][level == one].mean() for one in np.unique(level)])
        for v in (readings.load, *sink)
    )
    if len(load) < 3:
        return readings, ()
    rate = np.diff(sinks, axis=1) / np.diff(load)
    # where no reading is without load, from where the first two loads lead back to
    resting = np.array(sinks)[:, 0] - rate[:, 0] * load[0]
    deep = np.array(sinks) - (resting if touching.all() else sink[:, ~touching].mean(1))[:, None]
    first, who = inf, 0
    for e, t in zip(*np.nonzero((deep >= NEAR_STOP * stop[:, None])[:, 2:])):
        before, after = rate[e, t], rate[e, t + 1 :]
        if after[0] < SLOWED * before and (after[1:] < STANDS * before).all():
            # closed one load earlier, it has not moved since
            closed = t + 1 if after[0] < STANDS * before and deep[e, t + 1] >= NEAR_STOP * stop[e] else t + 2
            if load[closed] < first:
                first, who = float(load[closed]), int(readings.element[e])
    if first == inf:
        return readings, ()
    kept = readings.load < first - apart / 2
    what = f"element {who} is at its stop from {first:.4g} N on: these loads are left out"
    if (readings.load[kept] > 0).sum() < 3:
        where = f"{readings.path}: sample {readings.sample}"
        raise InputError(where, what, legal="three smaller loads at least")
    time = None if readings.time is None else readings.time[kept]
    fewer = replace(
        readings, load=readings.load[kept], run=readings.run[kept], signal=readings.signal[:, kept], time=time
    )
    return fewer, (what,)


def on_layers(
    grasp: Grasp, readings: GraspReadings, calibration: Sensitivity, layers: list[LayeredArray], level: float
) -> Grasp:
    """The same readings on layers: K_obj of a single level pad, of all elements and of every pair.

    Parameters
    ----------
    grasp
        Of the same readings, by `evaluate` on separate springs.
    readings, calibration, level
        As of `evaluate`.
    layers
        One if the thickness is known, else all that the intervals are to cover.

    Raises
    ------
    InputError
        Fewer than two pads that are read touch, or no modulus explains the readings.
    """
    number = readings.element
    known = calibration.of(number)
    reference = grasp.pairs[0].reference
    where = f"{readings.path}: sample {readings.sample}"
    explained, one, lean = [], len(layers) == 1, False
    time = readings.time
    if time is not None and drift_terms(readings.load, time) is None:
        time = None  # as noted
    for at in layers if one or not grasp.warnings else ():  # in another unit, no layer explains them
        with suppress(np.linalg.LinAlgError):  # of readings in a wrong unit, say
            found = fit(at, number, readings.load, readings.signal[None], known, level, reference, time)
            pressing = found.force[0] > TOUCHES * found.force[0].max()
            touching = tuple(int(n) for n in at.number[pressing])
            read = sorted(set(touching) & set(number.tolist()))
            if one and len(read) < 2:
                raise InputError(where, "too few pads touch that are read", value=read, legal="two at least")
            bearing = (found.force[0] > BEARS * found.force[0].max()) & np.isin(at.number, number)
            sound = np.isfinite(found.dof[0]) and found.widened[0] < WILD
            if sound and len(read) > 1:  # layers that contradict the readings do not count
                explained.append((found, touching))
                lean = one and bearing.sum() < 3 <= len(number)
    if not explained and one:
        raise InputError(
            where,
            "no modulus explains the readings",
            legal=f"elements that agree within {WILD:g} times their calibration's errors; are loads, units, "
            "design and calibration those of this grasp?",
        )
    if not explained:
        note = "no layer explains the readings: K_obj and its intervals are those of separate springs"
        return replace(grasp, notes=(*grasp.notes, note))
    fits = [f for f, _ in explained]
    best = int(np.argmin([f.widened[0] for f in fits]))
    touching = explained[best][1]

    def over(ends: list[np.ndarray]) -> Interval:
        middle = [e[0] for e in ends]
        estimate = 0.0 if min(middle) <= 0 else float(np.exp(np.log(middle).mean()))  # infinite where one is
        return Interval(estimate, float(min(e[1] for e in ends)), float(max(e[2] for e in ends)))

    place = {int(n): i for i, n in enumerate(number)}
    pairs = tuple(
        pair
        if np.isnan(fits[0].pairs[0, place[pair.measuring], 0])
        else replace(pair, object=over([f.pairs[0, place[pair.measuring]] for f in fits]))
        for pair in grasp.pairs
    )
    first = fits[best] if one else fits[0]
    what = "with the load cell's limits" if one else "on any layer, from the thinnest to a half-space"
    combined = over([f.object_[0] for f in fits])
    noted = tuple(n for n in grasp.notes if "disagree beyond" not in n and "does not follow" not in n)
    if one and (widened := float(first.widened[0])) > 1:
        noted += (
            f"the elements disagree beyond their calibration (p {first.disagree[0]:.1g}): combined interval "
            f"widened {widened:.2g} times",
        )
    angle = tuple(
        tuple(float(f([g.angle[0, k, e] for g in fits])) for e, f in ((0, np.mean), (1, np.min), (2, np.max)))
        for k in (0, 1)
    )
    leaning = (
        "fewer than three pads that are read bear: the face's angle stays open, and intervals hold less "
        "often than stated; incline it less, or load it more"
    )
    return replace(
        grasp,
        warnings=(*grasp.warnings, leaning) if lean else grasp.warnings,
        pairs=pairs,
        combined=combined,
        combined_by_noise=over([f.object_by_noise[0] for f in fits]) if one else grasp.combined_by_noise,
        combined_by_limits=((what, combined),),
        noise=float(first.noise[0]),
        dof=int(first.dof[0]),
        disagreement_p=float(max(f.disagree[0] for f in fits)),
        widened=float(min(f.widened[0] for f in fits)),
        notes=noted,
        layer=OnLayer(over([first.modulus[0]]) if one else None, angle, touching, grasp.combined),
    )


def _limits(
    element: np.ndarray,
    signal: np.ndarray,
    calibration: Sensitivity,
    slopes: Slopes,
    coupling: np.ndarray | None,
    terms: np.ndarray | None,
) -> dict[str, list[Slopes]]:
    """The slopes at the limits of each quantity that acts on all elements, by its name; each entry also
    includes the limits of the entries before it."""
    at: dict[str, list[Slopes]] = {}
    cells = [slopes]
    if (calibration.load_cell_half_width > 0).any():
        cells += [
            common_slopes(element, signal, calibration.at_load_cell_limit(sign), terms)[0]
            for sign in (-1.0, 1.0)
        ]
        at["with the load cell's limits"] = cells[1:]
    if coupling is not None:
        at["with coupling of the pads too"] = coupled(cells, coupling)
    return at


def coupled(slopes: list[Slopes], coupling: np.ndarray) -> list[Slopes]:
    """The slopes at shares of a coupling, [element, element], and at the same of an even one."""
    n = len(coupling)
    even = np.full((n, n), (coupling.sum() - np.trace(coupling)) / (n * (n - 1)))  # between any two the mean
    shapes = (coupling, even)
    return [each.coupled(share * shape) for shape in shapes for share in COUPLED for each in slopes]


def drift_terms(load: np.ndarray, time: np.ndarray) -> np.ndarray | None:
    """Terms of every signal besides the approach, an orthonormal basis [term, state]: offsets in contact and
    before contact, and time; None if the load goes with time, so that no drift can be estimated."""
    touching = load > 0
    terms = np.array([touching, ~touching, time - time.mean()], dtype=float)[[True, not touching.all(), True]]
    rising = np.where(touching, load - load[touching].mean(), 0.0)
    _, size, basis = np.linalg.svd(terms / np.linalg.norm(terms, axis=1)[:, None], full_matrices=False)
    left = rising - (rising @ basis.T) @ basis
    told = size[-1] > ROUNDED and len(load) > len(terms) + 1
    return basis if told and rising @ rising < TOLD_FROM_TIME * (left @ left) else None


def _without(signal: np.ndarray, terms: np.ndarray | None) -> np.ndarray:
    """The signals less their offsets, and less their drifts if there are terms."""
    return signal - (signal.mean(1, keepdims=True) if terms is None else (signal @ terms.T) @ terms)


def common_slopes(
    element: np.ndarray, signal: np.ndarray, calibration: Sensitivity, terms: np.ndarray | None = None
) -> tuple[Slopes, float]:
    """Slopes of all elements over their common approach, and the noise of one signal (V).

    signal[element, state] less each element's mean is g p + noise, with equal noise in every channel: g p is
    its best rank-one approximation. An error of p scales all g alike, and K_obj does not depend on it.

    Parameters
    ----------
    element : array, [element]
        Numbers.
    signal : array, [element, state]
        V, in contact.
    calibration : Sensitivity
        Of these elements at least.
    terms : array, [term, state], optional
        Of `drift_terms`; the signals are then those of all states.

    Returns
    -------
    slopes : Slopes
    noise : float
        Standard deviation, V.

    Raises
    ------
    InputError
        An element without calibration.
    """
    centred = _without(signal, terms)
    u, size, vt = np.linalg.svd(centred, full_matrices=False)
    dof = (len(element) - 1) * (signal.shape[1] - 1 - _count(terms))
    variance = float((size[1:] ** 2).sum()) / dof
    k_v = calibration.of(element).signal_per_deflection
    p = vt[0] * np.sign((u[:, 0] / k_v).sum() or 1.0)
    g = centred @ p  # V per unit approach; p has unit length, so each g has the variance of one signal
    return slopes_of(element, g, calibration, variance, dof), variance**0.5


def _refuse_exchanged(
    readings: GraspReadings,
    signal: np.ndarray,
    calibration: Sensitivity,
    terms: np.ndarray | None,
    level: float,
) -> None:
    """Refuse signals that agree once those of two elements are exchanged, and by one exchange alone."""
    number, agree = readings.element, []
    for i, j in combinations(range(len(number)), 2):
        order = np.arange(len(number))
        order[[i, j]] = j, i
        if combine(common_slopes(number, signal[order], calibration, terms)[0], level)[2] == 1.0:
            agree.append((int(number[i]), int(number[j])))
    if len(agree) == 1:
        n, m = agree[0]
        what = f"elements disagree, but not once the signals of {n} and {m} are exchanged: swapped channels?"
        legal = "each element's own signal"
        raise InputError(f"{readings.path}: sample {readings.sample}", what, legal=legal)


def _count(terms: np.ndarray | None) -> int:
    return 1 if terms is None else len(terms)


def slopes_of(
    element: np.ndarray, g: np.ndarray, calibration: Sensitivity, variance: float, dof: int
) -> Slopes:
    """Slopes of force and deflection from those of the signals, g (V per unit approach), each with that
    variance (V2) and its degrees of freedom. Raises InputError for an element without calibration."""
    own = calibration.of(element)
    k_v, k = own.signal_per_deflection, own.stiffness
    s, f = g / k_v, g * k / k_v
    signal_part = np.array([[[b * b, b * a], [a * b, a * a]] for a, b in zip(1 / k_v, k / k_v)]) * variance
    se_k, se_v = own.stiffness_se, own.signal_per_deflection_se
    cross = own.correlation * se_k * se_v
    part = np.empty_like(signal_part)
    for i in range(len(element)):
        jacobian = np.array([[g[i] / k_v[i], -f[i] / k_v[i]], [0.0, -s[i] / k_v[i]]])  # of (f, s) in (K, K_v)
        part[i] = jacobian @ np.array([[se_k[i] ** 2, cross[i]], [cross[i], se_v[i] ** 2]]) @ jacobian.T
    return Slopes(element, s, f, signal_part, part, dof, own.dof)


def _strays(element: np.ndarray, signal: np.ndarray, terms: np.ndarray | None) -> list[str]:
    """A note for each element whose signal does not follow the approach that the others share: an F test of
    its residual against the others' noise."""
    n, each = len(element), signal.shape[1] - 1 - _count(terms)
    if n < 3:
        return []
    centred = _without(signal, terms)
    notes = []
    for i, number in enumerate(element):
        rest = np.delete(centred, i, 0)
        _, size, vt = np.linalg.svd(rest, full_matrices=False)
        noise = (size[1:] ** 2).sum() / (each * (n - 2))
        g = centred[i] @ vt[0]
        # the others' approach is known to noise/size[0] at each load; g carries that error into this residual
        own = ((centred[i] - g * vt[0]) ** 2).sum() / each / (1 + (g / size[0]) ** 2)
        if noise > 0 and fdtrc(each, each * (n - 2), own / noise) < STRAY / n:
            notes.append(
                f"element {number} does not follow the approach of the others: late contact, a limit of "
                "the read-out, or a bad gauge"
            )
    return notes


def _wrong_forces(
    load: np.ndarray,
    signal: np.ndarray,
    calibration: Sensitivity,
    slopes: Slopes,
    noise: float,
    most: float,
    where: str,
) -> tuple[list[str], float]:
    """A note if elements' forces fall as the load grows, and one if they pass `most` (N); then the rise of
    all elements' force (N). A force rises from the least load to the largest by K/K_v times the signal's
    slope over the load. K_obj is made of ratios and shows neither. Raises InputError if some fall and others
    rise, each by more than REVERSED of the middle one.
    """
    span = float(np.ptp(load))
    if not span:
        return [], 0.0
    away = (load - load.mean()) / span
    own = calibration.of(slopes.element)
    per_signal = own.stiffness / own.signal_per_deflection / (away @ away)
    rise, error = per_signal * (signal @ away), np.abs(per_signal) * noise * (away @ away) ** 0.5
    telling = np.abs(rise) > np.maximum(SURELY * error, REVERSED * np.median(np.abs(rise)))
    if (falls := telling & (rise < 0)).any() and (telling & (rise > 0)).any():
        i = int(np.flatnonzero(falls == (2 * falls.sum() <= telling.sum()))[0])
        raise InputError(
            where,
            f"with {span:.4g} N more load the force on element {slopes.element[i]} goes the other way than "
            "most others': is its channel reversed?",
            value=f"{rise[i]:.3g} N",
            legal="the sign of the calibration",
        )
    notes = []
    for wrong, what in (
        (rise < -SURELY * error, "falls: are signal and calibration of one sign?"),
        (rise > most, f"rises beyond the design's overload force of {most:g} N: are the units right?"),
    ):
        if wrong.any():
            worst = int(np.argmax(np.where(wrong, np.abs(rise), -inf)))
            numbers = ", ".join(map(str, slopes.element[wrong]))
            notes.append(
                f"with {span:.4g} N more load the force on element {numbers} {what} "
                f"(no. {slopes.element[worst]}: {rise[worst]:.3g} N)"
            )
    return notes, float(rise.sum())


def _pair(slopes: Slopes, found: list[Interval], m: int, r: int, level: float) -> Pair:
    """`found`: K_obj by the two, of the slopes as they are and at their limits."""
    object_, *others = found
    everywhere = hull(object_, others)
    ratio = slopes.s[m] / slopes.s[r]
    k_m, k_r = slopes.f[m] / slopes.s[m], slopes.f[r] / slopes.s[r]
    var = [slopes.covariance[i][1, 1] / slopes.s[i] ** 2 for i in (m, r)]
    _, dof = scatter(slopes, [m, r], slopes.covariance[[m, r]], 0.0)
    half = t_quantile(level, dof) * sum(var) ** 0.5 * abs(ratio)
    x = object_.estimate
    open_ = x == 0 or isinf(x) or k_r == k_m
    condition = inf if open_ else abs((k_r + x) * (k_m + x) / (x * (k_r - k_m)))
    return Pair(
        int(slopes.element[m]),
        int(slopes.element[r]),
        float(ratio),
        float(ratio - half),
        float(ratio + half),
        everywhere,
        object_,
        float(condition),
    )


def to_text(samples: list[Grasp], level: float) -> str:
    """For each sample K_obj of all elements, a table of its pairs, then limits and notes; `level` is that of
    the intervals."""
    lines, held = [], f"{100 * level:.10g}% interval"
    for g in samples:
        c = g.combined
        lines += [
            *(f"warning: {warning}" for warning in g.warnings),
            f"sample {g.sample}: K_obj = {_number(c.estimate)} N/mm, {held} {_interval(c)} ({c.verdict})",
            "",
        ]
        held = f"{100 * level:.10g}% interval"
        head = ("measuring", "reference", "R", held, "K_obj N/mm", held, "condition", "verdict")
        body = [
            (
                str(p.measuring),
                str(p.reference),
                f"{p.ratio:.4f}",
                f"{p.ratio_low:.4f} to {p.ratio_high:.4f}",
                _number(p.object.estimate),
                _interval(p.object),
                f"{p.condition:.1f}",
                p.object.verdict,
            )
            for p in g.pairs
        ]
        lines += aligned([head, *body], left=7)
        lines += [
            "",
            f"slopes over {g.loads} loads; noise of one signal {g.noise * 1e3:.3g} mV ({g.dof} degrees "
            "of freedom); the combined value uses all elements at once, with the covariance of pairs "
            "that share the reference",
            f"K_obj of all elements by noise and calibration alone: {_interval(g.combined_by_noise)} N/mm",
            *(f"  {name}: {_interval(i)} N/mm" for name, i in g.combined_by_limits),
        ]
        lines += _layer_text(g.layer) if g.layer else []
        lines += [*g.notes, ""]
    return "\n".join(lines)


def _layer_text(layer: OnLayer) -> list[str]:
    lines = [f"separate springs would have said {_interval(layer.springs)} N/mm"]
    if layer.modulus:
        m = layer.modulus
        lines.append(f"Young's modulus {_number(m.estimate)} MPa, interval {_interval(m)} MPa ({m.verdict})")
        for axis, (estimate, low, high) in zip("xy", layer.angle):
            lines.append(
                f"face inclined along {axis} by {estimate:.2f} degrees, interval {low:.2f} to {high:.2f}"
            )
    return [*lines, f"pads that touch at the largest load: {', '.join(map(str, layer.touching))}"]


def to_json(samples: list[Grasp], level: float) -> str:
    """All fields of every sample as JSON; an end that is not bounded is 'inf'."""
    records: list[Any] = [plain(g) for g in samples]
    for record, g in zip(records, samples):
        record["combined"]["verdict"] = g.combined.verdict
        if layer := record.pop("layer"):
            record |= {"touching": layer["touching"], "springs": layer["springs"]}
            record["angle"] = {
                name: [axis[i] for axis in layer["angle"]]
                for i, name in enumerate(("estimate", "low", "high"))
            }
            if g.layer and g.layer.modulus:
                record["modulus_MPa"] = layer["modulus"] | {"verdict": g.layer.modulus.verdict}
        for pair, p in zip(record["pairs"], g.pairs):
            pair["object"]["verdict"] = p.object.verdict
    data = {"schema": SCHEMA, "level": level, "units": "mm, N, V", "samples": records}
    return json.dumps(data, indent=1, allow_nan=False) + "\n"


def _number(value: float) -> str:
    return "infinite" if isinf(value) else f"{value:.4g}"


def _interval(i: Interval) -> str:
    return "none" if i.empty else f"{i.low:.4g} to {'no bound' if isinf(i.high) else f'{i.high:.4g}'}"
