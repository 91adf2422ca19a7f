"""Simulated logs of a lab: bursts of samples with hum, drift, jitter, a dead and a saturated channel, and
writers of five formats by other means than tactcad's reader."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from example_readings import truth

from tactcad.circuit.element_signals import design_readout
from tactcad.contact import springs
from tactcad.paper.grasp_figures import Truth
from tactcad.parts.array.bridge_figures import drift
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import load

X = 3.85  # N/mm, the object under each pad
CELL = 57.04  # N/mm
BURST, PACE = 10, 1e-4  # samples of a burst, s between them
PERIOD, JITTER = 1.013, 1e-3  # s from burst to burst: no whole number of the mains' periods
HOLD, CHANGE = 8, 2  # bursts of a step, and while it changes
STEP, RUNS = 0.025, 3
MAINS, HUM = 50.0, 1e-3  # Hz, V
OF_RUN = 0.002  # relative scatter of a run's slopes
FORCE_NOISE, STAGE_NOISE = 0.003, 0.0005  # N, mm, of a step
LOADS = np.array([0.0, *(3.235 + 0.980665 * np.arange(9))])
UP_AND_DOWN = np.concatenate([LOADS, LOADS[-2::-1]])


@lru_cache
def stated() -> tuple[float, float]:
    """Half-width of the drift's band and noise of one sample, V, by the paper's own design."""
    design = load("macro-array")
    return drift(Layout(design)), float(design_readout(design).noise)


@dataclass(frozen=True)
class Lab:
    """A log: time s, columns by name, and for every row which step it is of (-1: none)."""

    time: np.ndarray
    columns: dict[str, np.ndarray]
    step: np.ndarray
    drift: np.ndarray  # V, [channel, row]


def array() -> Truth:
    """Nine of Table 1's elements; the fifth does not work, as in the paper."""
    return truth()


def _times(steps: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    bursts = steps * (HOLD + CHANGE) - CHANGE
    start = PERIOD * np.arange(bursts) + JITTER * rng.random(bursts)
    step = np.where(np.arange(bursts) % (HOLD + CHANGE) < HOLD, np.arange(bursts) // (HOLD + CHANGE), -1)
    return (start[:, None] + PACE * np.arange(BURST)).ravel(), np.repeat(step, BURST)


def _moving(values: np.ndarray, step: np.ndarray) -> np.ndarray:
    """A value a step for every row, on its way in between."""
    known = np.flatnonzero(step >= 0)
    return np.interp(np.arange(len(step)), known, values[step[known]])


def _channels(clean: np.ndarray, time: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    half, noise = stated()
    rate = half / 2 * rng.standard_normal(len(clean)) / (time[-1] - time[0])
    away = rate[:, None] * (time - time[0])
    hum = HUM * np.sin(2 * np.pi * MAINS * time + 2 * np.pi * rng.random())
    return clean + away + hum + noise * rng.standard_normal(clean.shape), away


def grasp(rng: np.random.Generator, x: float = X, loads: np.ndarray = UP_AND_DOWN) -> Lab:
    """A grasp with the loads up and down, no load before and after; a force column with the scale's noise."""
    a = array()
    time, step = _times(len(loads), rng)
    force = _moving(loads, step)
    deflection = springs.press(a.stiffness, x, force)[2]
    clean = a.zero_signal[:, None] + a.signal_per_deflection[:, None] * deflection
    volts, away = _channels(clean, time, rng)
    columns = {f"ai{n}": v for n, v in zip(a.element, volts)}
    return Lab(time, columns | {"load": force + 0.002 * rng.standard_normal(len(force))}, step, away)


def calibration(rng: np.random.Generator) -> Lab:
    """Every element's runs, the stage up and down, one element behind the other; stage and force as
    columns."""
    a, up = array(), STEP * np.arange(7)
    stroke = np.concatenate([up, up[-2::-1]])
    shape = (len(a.element), RUNS, len(stroke))
    x = np.broadcast_to(stroke, shape)
    share = CELL / (CELL + a.stiffness)[:, None, None]
    slip = 1 + OF_RUN * rng.standard_normal((2, *shape[:2], 1))
    d = share * (x + STAGE_NOISE * rng.standard_normal(shape))
    force = a.stiffness[:, None, None] * d * slip[0] + FORCE_NOISE * rng.standard_normal(shape)
    change = a.signal_per_deflection[:, None, None] * d * slip[1]
    time, step = _times(x.size, rng)
    which = np.broadcast_to(np.arange(len(a.element))[:, None, None], shape).ravel()
    pressed = _moving(change.ravel(), step)
    here = np.round(_moving(which.astype(float), step)).astype(int)
    clean = a.zero_signal[:, None] + np.where(here == np.arange(len(a.element))[:, None], pressed, 0.0)
    volts, away = _channels(clean, time, rng)
    columns = {f"ai{n}": v for n, v in zip(a.element, volts)}
    number = np.broadcast_to(np.arange(1, RUNS + 1)[None, :, None], shape).ravel()
    held = np.maximum(step, 0)
    more = {
        "stage": _moving(x.ravel(), step) * 1e3,
        "force": _moving(force.ravel(), step),
        "element": a.element[which.ravel()[held]].astype(float),
        "run": number[held].astype(float),
        "mark": np.where(step >= 0, step + 1, 0).astype(float),
    }
    return Lab(time, columns | more, step, away)


def comma_csv(path, lab: Lab) -> None:
    with open(path, "w", newline="") as file:
        out = csv.writer(file)
        out.writerow(["Time (s)", *lab.columns])
        out.writerows([f"{v:.9g}" for v in row] for row in zip(lab.time, *lab.columns.values()))


def semicolon_csv(path, lab: Lab) -> None:
    """A preamble, units under the names, decimal commas, a date and time in every row, Windows' code page."""
    from datetime import datetime, timedelta

    start = datetime(2026, 11, 24, 23, 59, 0)
    with open(path, "w", newline="", encoding="cp1252") as file:
        out = csv.writer(file, delimiter=";")
        out.writerow(["Messung von Prüfstand 3 in µV und N"])
        out.writerow(["Time (s)", *lab.columns])
        out.writerow(["", *("V" for _ in lab.columns)])
        for t, *row in zip(lab.time, *lab.columns.values()):
            stamp = (start + timedelta(seconds=float(t))).isoformat(sep=" ", timespec="microseconds")
            out.writerow([stamp, *(f"{v:.9g}".replace(".", ",") for v in row)])


def blanks(path, lab: Lab) -> None:
    names = "Time " + " ".join(lab.columns)
    np.savetxt(
        path, np.column_stack([lab.time, *lab.columns.values()]), fmt="%.9g", header=names, comments=""
    )


def lvm(path, lab: Lab) -> None:
    """As LabVIEW's Write To Measurement File writes it: tabs, one header, a comment column."""
    head = ["LabVIEW Measurement\t", "Writer_Version\t2", "Reader_Version\t2", "Separator\tTab"]
    head += ["Decimal_Separator\t,", "Multi_Headings\tNo", "X_Columns\tOne", "Time_Pref\tRelative"]
    head += ["Date\t2026/11/24", "Time\t10:11:12,5", "***End_of_Header***\t", "\t"]
    n = len(lab.columns)
    head += [
        f"Channels\t{n}" + "\t" * n,
        "Samples\t" + f"{len(lab.time)}\t" * n,
        "Date\t" + "2026/11/24\t" * n,
    ]
    head += ["Time\t" + "10:11:12,5\t" * n, "Y_Unit_Label\t" + "Volts\t" * n, "X_Dimension\t" + "Time\t" * n]
    head += ["X0\t" + "0,0E+0\t" * n, "Delta_X\t" + "1,0E-4\t" * n, "***End_of_Header***" + "\t" * (n + 1)]
    head.append("\t".join(["X_Value", *lab.columns, "Comment"]))
    rows = (
        "\t".join(f"{v:.9E}".replace(".", ",") for v in row) for row in zip(lab.time, *lab.columns.values())
    )
    path.write_text("\r\n".join([*head, *rows]) + "\r\n", "utf-8", newline="")


def tdms(path, lab: Lab) -> None:
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(path) as file:
        named = {"Time": lab.time, **lab.columns}
        file.write_segment([ChannelObject("Log", name, values) for name, values in named.items()])


FORMATS = {
    "a.csv": (comma_csv, "Time (s)"),
    "b.csv": (semicolon_csv, "Time (s)"),
    "c.txt": (blanks, "Time"),
    "d.lvm": (lvm, None),
    "e.tdms": (tdms, "Time"),
}


def map_text(lab: Lab, kind: str, time: str | None, numbers=None) -> str:
    """The mapping file of such a log."""
    lines = ["[log]", f'kind = "{kind}"', *([f'time = "{time}"'] if time else []), "[channels]"]
    lines += [f"ai{n} = {n}" for n in (array().element if numbers is None else numbers)]
    if kind == "grasp":
        lines += [
            "[steps]",
            'by = "plateau"',
            'column = "load"',
            "apart = 0.3",
            "hold = 4.0",
            "settle = 0.01",
        ]
        return "\n".join([*lines, "[load]", 'column = "load"', 'unit = "N"', "least = 0.05"])
    lines += ["[steps]", 'by = "marks"', 'column = "mark"']
    for name, unit in (("element", ""), ("run", ""), ("displacement", "um"), ("force", "N")):
        column = "stage" if name == "displacement" else name
        lines += [f"[{name}]", f'column = "{column}"', *([f'unit = "{unit}"'] if unit else [])]
    return "\n".join(lines)
