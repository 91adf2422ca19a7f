"""From a lab's log to readings: its rows cut into steps, each averaged, with its time.

A step is a plateau of a column (a window of `hold` seconds within which the column stays within `apart`), a
run of rows with one mark, or a span of time. A channel that never changes, or stays at a limit, is reported
and its element left out; anything that would silently give wrong readings is refused.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from math import floor

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from tactcad.design.csv_table import Table, number
from tactcad.design.messages import InputError
from tactcad.lab import readings
from tactcad.lab.column_units import VOLTAGES
from tactcad.report.plots import BLACK, GREY, MARKERS, SERIES, panels, svg
from tactcad.report.report import plain

from .log_files import LabLog
from .log_map import NEEDED, SECONDS, LogMap, MappedQuantity

GAP = 3.0  # times the longest interval of the middle step from which on rows are missing; chosen
FROM_MIDDLE = (
    4.0  # standard deviations of a plateau's middle half from which on a row belongs to the way there
)
STUCK = 8  # samples in whole steps at one value from which a channel or sensor may be saturated; chosen
COARSE = 2.0  # of its smallest changes from row to row, from which on no step is still by chance; chosen
APART = 0.1  # of its range, by which what drives a saturated channel or sensor without noise goes on; chosen
# Two channels are one where their means agree within ALIKE of their noise, though signal and first zero are
# FAR times it: no two bridges are out of balance alike. Chosen.
ALIKE, FAR = 3.0, 100.0
STATES = ("element", "run", "sample")
TIMES = "numbers, hh:mm:ss, yyyy-mm-dd hh:mm:ss, dd.mm.yyyy hh:mm:ss or m/d/yyyy h:mm:ss AM"
NO_MARK = ("", "0", "-", "nan")
# By how much more another channel changes than that of the pressed element, from which on they are swapped;
# chosen: neighbours feel each other by a few per cents through what holds them.
SWAPPED = 5.0
# Share of the middle channel's slope over the load below which a channel tells nothing; chosen: elements of
# one array differ by ten times at most.
UNMOVED = 0.01


@dataclass(frozen=True)
class LogStep:
    """Rows first to last of the log; time s, their mean; values: of every quantity, mm, N or number."""

    first: int
    last: int
    time: float
    values: Mapping[str, float]

    @property
    def rows(self) -> slice:
        return slice(self.first, self.last + 1)

    @property
    def samples(self) -> int:
        return self.last - self.first + 1


@dataclass(frozen=True)
class Taken:
    """The reading of a log: channels, steps and table.

    volts     signal of every kept element's channel, V, [element, row of the log]
    left_out  elements whose channel has no information, each with the reason
    table     the readings, as `calibrate` or `stiffness` reads them
    """

    kind: str
    log: LabLog
    time: np.ndarray
    drive: np.ndarray | None
    steps: tuple[LogStep, ...]
    columns: Mapping[int, str]
    volts: Mapping[int, np.ndarray]
    left_out: Mapping[int, str]
    noise: Mapping[int, float]
    table: str

    def as_table(self) -> Table:
        lines = [line + "\n" for line in self.table.splitlines()]
        start = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        header = lines[start].strip().split(",")
        numbers = range(start + 2, len(lines) + 1)
        return Table(f"readings of {self.log.path}", ",", start + 1, header, lines[start + 1 :], numbers)


def take(log: LabLog, by: LogMap) -> Taken:
    """The readings that a log holds.

    Raises
    ------
    InputError
        A column that the log lacks; no steps; rows missing within one; a channel twice; a driving column that
        does not change; a force or load at its limit; channels that are swapped; too few elements left.
    """
    time = _time(log, by)
    drive = _numbers(log, by.steps.column) if by.steps.column and by.steps.by == "plateau" else None
    spans = _spans(log, by, time, drive)
    volts = {c.element: _volts(log, name, by) for name, c in by.channels.items()}
    columns = {c.element: name for name, c in by.channels.items()}
    values = {name: _values(log, by, name, q, spans) for name, q in by.quantities.items()}
    steps = tuple(
        LogStep(a, b, float(time[a : b + 1].mean()), {name: float(v[i]) for name, v in values.items()})
        for i, (a, b) in enumerate(spans)
    )
    left_out = {
        n: why for n in volts if (why := _silent(volts[n], _pressed(by.log.kind, steps, n) or steps, by))
    }
    kept = {n: v for n, v in volts.items() if n not in left_out}
    used = np.concatenate([np.arange(a, b + 1) for a, b in spans])
    _refuse_doubled(log, kept, columns, used)  # only these: two channels at one limit are equal, not doubled
    for n, v in kept.items():
        for a, b in spans:
            if np.isnan(v[a : b + 1]).any():
                row = a + int(np.argmax(np.isnan(v[a : b + 1])))
                raise InputError(
                    log.where(row, columns[n]), "no number within a step", legal="a number in every row"
                )
    noise = {
        n: float(np.median([np.std(v[s.rows], ddof=1) if s.samples > 1 else 0.0 for s in steps]))
        for n, v in kept.items()
    }
    _refuse_alike(log, steps, kept, columns, noise)
    if by.log.kind == "calibration":
        _refuse_swapped(log, steps, kept, columns)
    left_out |= _unmoved(by.log.kind, steps, kept)
    kept = {n: v for n, v in kept.items() if n not in left_out}
    _refuse_limited(log, by, steps, kept)
    least = 1 if by.log.kind == "calibration" else 2
    if len(kept) < least:
        why = "; ".join(f"{n}: {w}" for n, w in left_out.items())
        raise InputError(f"{log.path}: channels", f"too few tell anything ({why})", legal=f"{least} at least")
    table = _written(by, steps, kept, log, left_out)
    return Taken(by.log.kind, log, time, drive, steps, columns, kept, left_out, noise, table)


def _pressed(kind: str, steps: tuple[LogStep, ...], element: int) -> tuple[LogStep, ...]:
    """Steps in which an element of a calibration is pressed; none of a grasp."""
    return tuple(s for s in steps if kind == "calibration" and s.values["element"] == element)


def _numbers(log: LabLog, name: str, legal: str = "numbers alone") -> np.ndarray:
    values = log.column(name)
    if values.dtype.kind == "U":
        row = next((i for i, v in enumerate(values) if v and np.isnan(number(v.replace(",", ".")))), 0)
        raise InputError(log.where(row, name), "no number", value=str(values[row]), legal=legal)
    return values


def _time(log: LabLog, by: LogMap) -> np.ndarray:
    """Seconds from the first row."""
    if by.log.time is not None:
        time = _numbers(log, by.log.time, TIMES) * SECONDS[by.log.time_unit]
    elif log.time is not None:
        time = log.time
    elif by.log.rate is not None:
        time = np.arange(len(log.line)) / by.log.rate
    else:
        raise InputError(
            f"{by.path}: log.time", "missing: the log has no time of its own", legal="log.time or log.rate"
        )
    back = np.flatnonzero(~(np.diff(time) >= 0))
    if len(back):
        raise InputError(
            log.where(int(back[0]) + 1), "time goes back, or is no number", legal="rows in their order"
        )
    if len(time) > 2 and not np.median(np.diff(time)) and not (time % 1).any():
        what = "a clock in whole seconds: most rows have the time of the one before"
        raise InputError(f"{by.path}: log.time", what, legal="log.rate (Hz) in its place")
    return time - time[0]


def _volts(log: LabLog, name: str, by: LogMap) -> np.ndarray:
    own = by.channels[name]
    raw = _numbers(log, name)
    raw = np.where(np.isfinite(raw), raw, np.nan) * VOLTAGES[by.signal.unit]
    return raw * by.signal.factor * own.factor + own.offset


def _spans(log: LabLog, by: LogMap, time: np.ndarray, drive: np.ndarray | None) -> list[tuple[int, int]]:
    """First and last row of every step, without what settles, cut to whole periods of the mains."""
    rule = by.steps
    if rule.by == "times":
        found = [
            (int(np.searchsorted(time, a)), int(np.searchsorted(time, b, "right")) - 1) for a, b in rule.times
        ]
        for (a, b), span in zip(found, rule.times):
            if b < a:
                raise InputError(f"{by.path}: steps.times", "no row of the log in it", value=list(span))
    elif rule.by == "marks":
        found = _marked(log, str(rule.column))
    else:
        assert drive is not None
        found = [
            part
            for a, b in _plateaus(time, drive, rule.apart or 0.0, rule.hold)
            for part in _of_one_state(log, by, time, a, b)
        ]
        if not found:
            what = "no plateau: it changes all the time, or never" if np.ptp(drive) else "never changes"
            legal = "plateaus of steps.hold seconds within steps.apart"
            raise InputError(f"{log.path}: {rule.column}", what, legal=legal)
        if np.nanmax(drive) - np.nanmin(drive) < (rule.apart or 0.0):
            what = "never changes by steps.apart: constant, or saturated"
            legal = f"{rule.apart:g} at least"
            raise InputError(f"{log.path}: {rule.column}", what, value=float(np.ptp(drive)), legal=legal)
    interval = np.diff(time)
    longest = sorted(float(interval[a:b].max()) for a, b in found if b > a)  # bursts: pauses in every step
    usual = longest[(len(longest) - 1) // 2] if longest else 0.0
    kept = []
    for a, b in found:
        gaps = np.flatnonzero(interval[a:b] > GAP * usual)
        if len(gaps):
            row = a + int(gaps[0])
            what = f"rows are missing within a step: {interval[row]:.3g} s without one, usually {usual:.3g} s"
            raise InputError(log.where(row + 1), what, legal="rows without gaps in every step")
        start = int(np.searchsorted(time, time[a] + rule.settle - 1e-12))
        if start > b:
            raise InputError(log.where(a), "a step shorter than steps.settle", value=float(time[b] - time[a]))
        kept.append((start, _whole_periods(time, start, b, by.log.mains)))
    return kept


def _whole_periods(time: np.ndarray, a: int, b: int, mains: float | None) -> int:
    """The last row of a step such that its samples cover whole periods of the mains."""
    if mains is None or b - a < 2:
        return b
    each = (time[b] - time[a]) / (b - a)  # a row covers its interval
    periods = floor((b - a + 1) * each * mains + 1e-6)
    return b if not periods else a + max(round(periods / mains / each), 1) - 1


def _plateaus(time: np.ndarray, drive: np.ndarray, apart: float, hold: float) -> list[tuple[int, int]]:
    """Runs of windows of `hold` seconds within each of which the column stays within `apart`."""
    n = len(time)
    width = min(max(int(np.searchsorted(time, time[0] + hold, "right")), 2), n)  # rows; usual pace
    left, right = width // 2, width - 1 - width // 2
    high = maximum_filter1d(drive, width, mode="nearest", origin=0)
    low = minimum_filter1d(drive, width, mode="nearest", origin=0)
    steady = (high - low < apart) & np.isfinite(drive)
    steady[:left] = steady[n - right :] = False  # the window leaves the log
    edges = np.flatnonzero(np.diff(np.concatenate([[0], steady.astype(int), [0]])))
    return [_trimmed(drive, int(a) - left, int(b) - 1 + right) for a, b in zip(edges[::2], edges[1::2])]


def _of_one_state(log: LabLog, by: LogMap, time: np.ndarray, a: int, b: int) -> list[tuple[int, int]]:
    """A plateau cut where its element, run or sample changes: the stage is back at zero when a run begins.
    Parts shorter than `hold` are left out."""
    names = [by.quantities[n].column for n in STATES if n in by.quantities]
    columns = [np.round(_numbers(log, name)[a : b + 1]) for name in names if name is not None]
    cuts = [a, *(i for i in range(a + 1, b + 1) if any(c[i - a] != c[i - a - 1] for c in columns)), b + 1]
    if len(cuts) == 2:
        return [(a, b)]
    return [(i, j - 1) for i, j in zip(cuts, cuts[1:]) if time[j - 1] - time[i] >= by.steps.hold]


def _trimmed(drive: np.ndarray, a: int, b: int) -> tuple[int, int]:
    """A plateau without the ends on which the column comes and goes, by its middle half."""
    core = drive[a + (b - a) // 4 : b - (b - a) // 4 + 1]
    still = np.flatnonzero(
        np.abs(drive[a : b + 1] - np.median(core)) <= max(FROM_MIDDLE * float(core.std()), 1e-12)
    )
    return (a + int(still[0]), a + int(still[-1])) if len(still) else (a, b)


def _marked(log: LabLog, column: str) -> list[tuple[int, int]]:
    marks = log.column(column)
    texts = marks if marks.dtype.kind == "U" else np.array([f"{m:g}" for m in marks])
    edges = np.flatnonzero(np.concatenate([[True], texts[1:] != texts[:-1], [True]]))
    found = [(int(a), int(b) - 1) for a, b in zip(edges[:-1], edges[1:]) if texts[a].lower() not in NO_MARK]
    if not found:
        raise InputError(f"{log.path}: {column}", "no mark in it", legal="a mark in every row of a step")
    least = min(b - a for a, b in found)
    meets = any(b + 1 == a for (_, b), (a, _) in zip(found, found[1:]))
    for a, b in zip(edges[:-1], edges[1:]):
        if meets and texts[a] == "0" and b - 1 - a >= least:
            what = "0 is no mark, but here is as long as a step, and other steps meet without it"
            raise InputError(log.where(int(a), column), what, legal="steps from 1 on; no mark between steps")
    return found


def _values(
    log: LabLog, by: LogMap, name: str, q: MappedQuantity, spans: list[tuple[int, int]]
) -> np.ndarray:
    scale = q.scale(name, by.path)
    if q.values is not None:
        cycle = np.repeat(np.array(q.values), q.each)
        once = name in ("element", "sample") and len(q.values) > 1  # the next one is another
        if len(spans) % len(cycle) or once and len(cycle) < len(spans):
            what = f"{len(cycle)} steps by its values, and {len(spans)} found in the log"
            legal = "as many" if once else "as many, or the same again and again"
            raise InputError(f"{by.path}: {name}.values", what, legal=legal)
        return _scaled(np.resize(cycle, len(spans)), q, scale)
    column = _numbers(log, str(q.column))
    found = np.array([column[a : b + 1].mean() for a, b in spans])
    if not np.isfinite(found).all():
        row = spans[int(np.argmax(~np.isfinite(found)))][0]
        raise InputError(
            log.where(row, str(q.column)), "no number within a step", legal="a number in every row"
        )
    if name in ("displacement", "force", "load"):
        if len(spans) > 1 and not np.ptp(_scaled(found, q, scale)):
            raise InputError(f"{log.path}: {q.column}", "never changes", value=float(found[0]))
        own, (_, unit, most) = _scaled(found, q, scale), readings.UNITS[name]
        least = 0.0 if name == "load" else -most
        for i in np.flatnonzero((own < least) | (own > most))[:1]:
            legal = f"{least:g} to {most:g} {unit}: see {name}.unit, .factor and .offset in {by.path}"
            where = log.where(spans[i][0], str(q.column))
            raise InputError(where, f"{name} out of range", value=f"{own[i]:.6g} {unit}", legal=legal)
        return own
    whole = np.round(found)
    if (np.abs(found - whole) > 1e-6).any():
        row = spans[int(np.argmax(np.abs(found - whole)))][0]
        raise InputError(log.where(row, str(q.column)), f"the {name} changes within a step", legal="one each")
    return whole


def _scaled(found: np.ndarray, q: MappedQuantity, scale: float) -> np.ndarray:
    """In mm or N; values below q.least become zero."""
    own = found + q.offset
    return np.where(np.abs(own) < q.least, 0.0, own) * scale


def _refuse_doubled(
    log: LabLog, volts: Mapping[int, np.ndarray], columns: Mapping[int, str], used: np.ndarray
) -> None:
    seen: dict[bytes, int] = {}
    for n, v in volts.items():
        raw = np.asarray(log.columns[columns[n]][used])
        if not np.ptp(raw):
            continue
        other = seen.setdefault(raw.tobytes(), n)
        if other != n:
            what = f"the same samples as {columns[other]}: elements {other} and {n} are one channel"
            raise InputError(f"{log.path}: {columns[n]}", what, legal="a channel of its own for each element")


def _refuse_alike(
    log: LabLog,
    steps: tuple[LogStep, ...],
    kept: Mapping[int, np.ndarray],
    columns: Mapping[int, str],
    noise: Mapping[int, float],
) -> None:
    """Refuse two channels that read one signal, in one direction or in both, each with noise of its own."""
    means = {n: np.array([v[s.rows].mean() for s in steps]) for n, v in kept.items()}
    fewest = min(s.samples for s in steps)
    for (n, a), (m, b) in combinations(means.items(), 2):
        own = (noise[n] ** 2 + noise[m] ** 2) ** 0.5 / fewest**0.5
        off = min(np.abs(a - b).max(), np.abs(a + b).max())
        if off < ALIKE * own and min(abs(a[0]), np.ptp(a)) > FAR * own:
            what = f"the same signal as {columns[n]}: elements {n} and {m} are one channel"
            raise InputError(f"{log.path}: {columns[m]}", what, legal="a channel of its own for each element")


def _silent(v: np.ndarray, steps: tuple[LogStep, ...], by: LogMap) -> str:
    """Why a channel has no information; "" if it has."""
    own = np.concatenate([v[s.rows] for s in steps])
    if np.isnan(own).all() or not np.nanmax(own) - np.nanmin(own):
        return "dead: its signal never changes"
    for limit, beyond in (
        (by.signal.least, own <= (by.signal.least or 0.0)),
        (by.signal.most, own >= (by.signal.most or 0.0)),
    ):
        if limit is not None and beyond.any():
            return f"saturated: at {limit:g} V in {int(beyond.sum())} samples"
    driven = np.array([t.values["force" if by.log.kind == "calibration" else "load"] for t in steps])
    noisy, ends = _noisy(v, steps), (np.nanmax(own), np.nanmin(own))
    still = np.array([np.nan if t.samples < 2 or np.ptp(v[t.rows]) else v[t.first] for t in steps])
    for level in np.unique(still[np.isfinite(still)]):
        stuck = still == level
        if STUCK > sum(t.samples for t, at in zip(steps, stuck) if at) or stuck.all():
            continue
        if noisy or level in ends and np.ptp(driven[stuck]) > APART * np.ptp(driven):
            what = "saturated" if level in ends else "frozen"
            return f"{what}: at {level:g} V in {int(stuck.sum())} of {len(steps)} steps"
    return ""


def _noisy(v: np.ndarray, steps: tuple[LogStep, ...]) -> bool:
    """Whether a column's noise is far above its resolution in most of the steps in which it is not still."""
    changes = [np.median(np.abs(np.diff(v[s.rows]))) for s in steps if s.samples > 1]
    moves = [change for change in changes if change]
    levels = np.unique(np.concatenate([v[s.rows] for s in steps]))
    return bool(moves) and bool(np.median(moves) > COARSE * np.diff(levels).min())


def _refuse_limited(
    log: LabLog, by: LogMap, steps: tuple[LogStep, ...], kept: Mapping[int, np.ndarray]
) -> None:
    """Refuse a force or load that stays at its largest value: over whole steps though it has noise elsewhere,
    or while the stage, of a grasp every channel, goes on."""
    calibration = by.log.kind == "calibration"
    name, state = ("force", "element") if calibration else ("load", "sample")
    q = by.quantities[name]
    if q.column is None:
        return
    v = log.column(q.column) * np.sign(q.scale(name, by.path))
    means = np.array([v[s.rows].mean() for s in steps])
    noise = np.array([v[s.rows].std() for s in steps])
    top = max(v[s.rows].max() for s in steps)
    at = np.array([s.samples > 1 and (v[s.rows] == top).all() for s in steps])
    if not (_noisy(v, steps) and STUCK <= sum(s.samples for s, still in zip(steps, at) if still)):
        near = means >= means.max() - np.clip(ALIKE * noise, 1e-9 * abs(top), APART / 4 * np.ptp(means))
        stage = [[s.values["displacement"] for s in steps]] if calibration else []
        driven = np.array(stage or [[u[s.rows].mean() for s in steps] for u in kept.values()])
        at = np.zeros(len(steps), bool)
        groups = [(s.values.get(state), s.values.get("run")) for s in steps]
        for group in set(groups):
            own = np.array([g == group for g in groups])
            if near[own].sum() > 1 and len(driven):
                on = np.ptp(driven[:, own & near], axis=1) > APART * np.ptp(driven[:, own], axis=1)
                at |= own & near & on.all()
    if at.any():
        much = f"{abs(means[at].mean()):.4g} in {int(at.sum())} of {len(steps)} steps"
        where = log.where(steps[int(np.argmax(at))].first, q.column)
        legal = "no step in which the sensor is at its limit"
        raise InputError(where, f"the {name} is saturated: at {much}", legal=legal)


def _unmoved(kind: str, steps: tuple[LogStep, ...], kept: Mapping[int, np.ndarray]) -> dict[int, str]:
    """Channels that have noise or drift and no signal: their slope over the load is next to none beside the
    other channels'."""
    slopes = {}
    for n, v in kept.items():
        own = _pressed(kind, steps, n) if kind == "calibration" else steps
        force = np.array([s.values["force" if kind == "calibration" else "load"] for s in own])
        if len(own) and np.ptp(force):
            means = np.array([v[s.rows].mean() for s in own])
            away = force - force.mean()
            slopes[n] = abs(float(away @ means / (away @ away)))
    middle = float(np.median([*slopes.values()])) if slopes else 0.0
    return {
        n: f"dead: its signal changes by {slope * 1e3:.2g} mV/N, the middle channel's by {middle * 1e3:.3g}"
        for n, slope in slopes.items()
        if slope < UNMOVED * middle
    }


def _refuse_swapped(
    log: LabLog, steps: tuple[LogStep, ...], kept: Mapping[int, np.ndarray], columns: Mapping[int, str]
) -> None:
    """Refuse a calibration in which another channel answers to an element's being pressed. A channel that
    only drifts meanwhile does not answer: it changes by far less than the middle element's answer."""
    changes: dict[int, dict[int, float]] = {}
    for n in sorted({int(s.values["element"]) for s in steps} & set(kept)):
        own = _pressed("calibration", steps, n)
        changes[n] = {m: float(np.ptp([v[s.rows].mean() for s in own])) for m, v in kept.items()}
    answer = float(np.median([max(change.values()) for change in changes.values()] or [0.0]))
    for n, change in changes.items():
        most = max(change, key=lambda m: change[m])
        if change[most] > max(SWAPPED * change[n], answer / SWAPPED):
            who = f"{columns[most]} (element {most}) changes, not {columns[n]}"
            what = f"while element {n} is pressed, {who}: swapped?"
            raise InputError(
                f"{log.path}: {columns[n]}", what, value=f"{change[n]:.3g} V and {change[most]:.3g} V"
            )


def _written(
    by: LogMap,
    steps: tuple[LogStep, ...],
    kept: Mapping[int, np.ndarray],
    log: LabLog,
    left_out: Mapping[int, str],
) -> str:
    calibration = by.log.kind == "calibration"
    lines = [f"# {by.log.kind} readings from {log.path} by {by.path}: means of {len(steps)} steps"]
    lines += [f"# element {n} left out: {why}" for n, why in left_out.items()]
    if calibration:
        lines.append("element,run,displacement_mm,force_N,signal_V,time_s")
    else:
        given = [name for name in ("sample", "run") if name in by.quantities]
        lines.append(",".join([*given, "load_N", "element", "signal_V", "time_s"]))
    for s in steps:
        v = s.values
        if calibration:
            n = int(v["element"])
            if n in left_out:
                continue
            if n not in kept:
                legal = f"elements {', '.join(map(str, kept))}"
                raise InputError(
                    f"{by.path}: channels", f"element {n} is pressed and has no channel", legal=legal
                )
            row = [str(n), f"{v['run']:.0f}", f"{v['displacement']:.9g}", f"{v['force']:.9g}"]
            lines.append(",".join([*row, f"{kept[n][s.rows].mean():.9g}", f"{s.time:.9g}"]))
            continue
        states = [f"{v[name]:.0f}" for name in given] + [f"{v['load']:.9g}"]
        for n, volts in kept.items():
            lines.append(",".join([*states, str(n), f"{volts[s.rows].mean():.9g}", f"{s.time:.9g}"]))
    return "\n".join(lines) + "\n"


def calibration(taken: Taken) -> readings.CalibrationReadings:
    """For `calibrate`; as of a table. Raises InputError."""
    _require_kind(taken, "calibration")
    return readings.calibration_of(taken.as_table())


def grasps(taken: Taken) -> list[readings.GraspReadings]:
    """For `stiffness`; as of a table. Raises InputError."""
    _require_kind(taken, "grasp")
    return readings.grasps_of(taken.as_table())


def _require_kind(taken: Taken, kind: str) -> None:
    if taken.kind != kind:
        raise InputError("--map", f"maps a {taken.kind}", legal=f'log.kind = "{kind}"')


def to_text(taken: Taken) -> str:
    """The reading of the log as text."""
    steps = taken.steps
    names = [n for n in NEEDED[taken.kind] if n in steps[0].values]
    lines = [
        f"{taken.kind}: {len(taken.time)} rows over {taken.time[-1]:.6g} s, {len(steps)} steps of "
        f"{min(s.samples for s in steps)} to {max(s.samples for s in steps)} samples",
        "",
    ]
    for n, column in taken.columns.items():
        if n in taken.left_out:
            lines.append(f"element {n:3}  {column}: LEFT OUT, {taken.left_out[n]}")
        else:
            means = [taken.volts[n][s.rows].mean() for s in steps]
            lines.append(
                f"element {n:3}  {column}: {min(means):.6g} to {max(means):.6g} V, one sample "
                f"+-{taken.noise[n] * 1e3:.3g} mV"
            )
    lines += ["", "step    from s      to s  samples  " + "  ".join(f"{n:>12}" for n in names)]
    for i, s in enumerate(steps, 1):
        values = "  ".join(f"{s.values[n]:12.6g}" for n in names)
        a, b = taken.time[s.first], taken.time[s.last]
        lines.append(f"{i:4}  {a:8.6g}  {b:8.6g}  {s.samples:7}  {values}")
    return "\n".join(lines) + "\n"


def to_json(taken: Taken) -> str:
    """The same as JSON."""
    data = {
        "schema": "tactcad-log-1",
        "kind": taken.kind,
        "units": "mm, N, V, s",
        "channels": [
            {"element": n, "column": c, "noise": taken.noise.get(n)} for n, c in taken.columns.items()
        ],
        "left_out": [{"element": n, "why": why} for n, why in taken.left_out.items()],
        "steps": [
            {"from": taken.time[s.first], "to": taken.time[s.last], "samples": s.samples, **s.values}
            for s in taken.steps
        ],
    }
    return json.dumps(plain(data), indent=1, allow_nan=False) + "\n"


POINTS = 2000  # drawn of a longer log: the least and the largest value of each stretch


def picture(taken: Taken) -> str:
    """SVG of what was taken for what: driving column and channels over time, steps shaded, means as dots."""
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
