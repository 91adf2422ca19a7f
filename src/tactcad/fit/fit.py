"""The fit of the ladder's constants on finite-element samples, and the report that goes with them."""

from __future__ import annotations

import platform
from collections.abc import Callable
from datetime import date
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from tactcad.mechanics import plane, solid, strain, validity
from tactcad.mechanics.register import REGISTER
from tactcad.mechanics.section import HingeSection

from .accuracy_samples import with_width_factor
from .fit_samples import BOX, GRIDS, LEAST_HEIGHT, SEEDS, Columns, joined, section

Array = NDArray[np.float64]
Constants = dict[str, float]

SIDES = {"two": 1.0, "one": 0.0}
WEIGHT_OUTSIDE = 0.3  # of samples outside the promised box, so that the box dominates the fit
NEXT_TO_NONE = 0.5  # slot length over hinge thickness below which the two roots are one
STEP_INSIDE = 1e-6  # of constants that may not be negative: a search starts inside its bounds
HALF_FILLET = 1.0  # grids on two-sided hinges are fitted up to straight part + this times r

MID_WIDTH = {"grid": "mid_grid_ratio", "fillet": "mid_peak_ratio"}

# Where the search starts: the order of magnitude that beam theory and the first look at the data gave.
START = {
    "root": {
        "two": dict(p0=0.19, p1=0.015, p2=3.0, p3=0.65, p4=0.0, p5=-0.3, p6=-0.01, p7=0.0, p8=3.0)
        | dict(v0=0.0, v1=5.0, v2=0.5, e=0.3, c=0.1, k=0.5, f0=0.0, f1=0.02),
        "one": dict(p0=0.39, p1=-0.015, p2=1.0, p3=0.6, p4=0.8, p5=-0.1, p6=-0.01, p7=-0.05, p8=2.7)
        | dict(v0=0.0, v1=3.0, v2=5.0, e=0.7, c=0.15, k=1.1, f0=0.05, f1=0.07),
    },
    "width": {
        side: dict(a=-0.2, cb=1.0, cs=1.0, ch=0.5, cl=0.5, cx=0.2, cy=1.5, cz=0.3, cxx=0.25)
        | dict.fromkeys(("cyz", "cxxy", "cxxz", "cxyy", "cyyy", "cyyz"), 1.0)
        for side in SIDES
    },
    "fillet": {
        "two": dict(a=0.4, b=0.3, c=0.15, m=0.85, d=0.2, e=20.0),
        "one": dict(a=0.6, b=0.4, c=0.2, m=0.85, d=0.15, e=20.0),
    },
    "mid-width grid": {"two": dict(a=0.0, d=0.0, e=0.0), "one": dict(a=0.0, d=0.0, e=0.0)},
    "mid-width fillet": {"two": dict(a=0.0, d=0.0, e=0.0), "one": dict(a=0.0, d=0.0, e=0.0)},
    "face": {"one": dict(a=1.0, b=0.2, c=0.05, d=0.3, e=4.0)},
    "grid": {
        "two": dict(u=3.6, v=0.9, m=0.064, x=0.24, y=5.8, z=0.12),
        "one": dict(u=3.9, v=0.77, m=0.64, x=2.2, y=2.2),
    },
}


# Constants that may not be negative, so that the forms keep the bounds of mechanics for every design,
# whatever the samples (plane.py, solid.py).
NOT_NEGATIVE = {"f0", "f1", "c", "e"} | set(START["width"]["two"]) - {"a"}


def fit(samples: dict[str, Columns], today: date) -> dict:
    """Constants, range and report, as data/ladder.json holds them.

    Stiffness is fitted on "fitted", "range" and "corners", strains on "fitted", which also defines the range.

    Parameters
    ----------
    samples
        Computed designs, by the names of fit_samples.FILES.
    today
        Date of the report.
    """
    fitted = samples["fitted"]
    over_the_range = joined([with_width_factor(samples["range"]), samples["corners"]])
    constants: dict[str, dict[str, Constants]] = {group: {} for group in START}
    for side, flag in SIDES.items():
        rows, others = (_rows(c, c["two_sided"] == flag) for c in (fitted, over_the_range))
        all_rows = joined([rows, others])
        root = constants["root"][side] = _fit_root(all_rows, START["root"][side])
        constants["width"][side] = _fit_width(
            _rows(all_rows, np.isfinite(all_rows["width_factor"])), root, START["width"][side]
        )
        with_solid = _rows(rows, np.isfinite(rows["width_factor"]))
        for at, column in MID_WIDTH.items():
            constants[f"mid-width {at}"][side] = _fit_mid_width(
                with_solid, at, column, START[f"mid-width {at}"][side]
            )
        constants["fillet"][side] = _fit_factor(
            rows, strain.fillet_factor, "slot_peak", START["fillet"][side]
        )
        if side == "one":
            constants["face"][side] = _fit_factor(rows, strain.face_factor, "flat_peak", START["face"][side])
    rounded = _rounded(constants)
    for side, flag in SIDES.items():
        rows = _rows(fitted, fitted["two_sided"] == flag)
        rounded["grid"][side] = _rounded(_fit_grid(rows, rounded["root"][side], side))
    return rounded | {
        "range": {
            "least_height": LEAST_HEIGHT,
            "least": sampled_least(joined([fitted, samples["range"]])),
            "groups": sampled_range(fitted),
        },
        "report": _report(rounded, samples, today),
    }


def plane_error(s: HingeSection, stiffness: Array, k: Constants) -> Array:
    """Relative error of the plane rung's stiffness (unit width)."""
    return 1.0 / (plane.compliance(s.with_(width=1.0), k) * stiffness) - 1.0


def in_box(columns: Columns) -> NDArray[np.bool_]:
    """Which designs lie in the promised box."""
    return np.logical_and.reduce(
        [(columns[k] >= low) & (columns[k] <= high) for k, (low, high) in BOX.items()]
    )


def sampled_range(samples: Columns) -> dict[str, list[float]]:
    """Least and largest value of each group over the samples, to three digits."""
    return {
        k: [_digits(v.min(), 3), _digits(v.max(), 3)] for k, v in validity.groups(section(samples)).items()
    }


def sampled_least(samples: Columns) -> dict[str, float]:
    """Smallest value over the samples, with a small margin, of each group that has a lower bound only."""
    s = section(samples)
    return {
        name: float(f"{value(s).min() * (1.0 - 5e-3):.3g}") for name, (_, value, _) in validity.LEAST.items()
    }


def _fit_root(rows: Columns, start: Constants) -> Constants:
    s, stiffness = section(rows), rows["plane_stiffness"]
    return _search(lambda k: plane_error(s, stiffness, k), start, np.ones(len(stiffness)))


def _fit_width(rows: Columns, root: Constants, start: Constants) -> Constants:
    """Fitted on the whole stiffness: the width's constants compensate for part of the error of the root's."""
    s = section(rows)
    flat, stiffness = plane.parts(s, root), rows["plane_stiffness"] * rows["width"] * rows["width_factor"]
    return _search(lambda k: 1.0 / (solid.curled(s, flat, k) * stiffness) - 1.0, start, _width_weights(s))


def _fit_mid_width(rows: Columns, at: str, column: str, start: Constants) -> Constants:
    s, measured = section(rows), rows[column] * rows["width_factor"]
    return _search(
        lambda k: strain.mid_width(s, at, k) / measured - 1.0, start, _weights(rows), worst_case=False
    )


def _fit_factor(rows: Columns, factor: Callable, column: str, start: Constants) -> Constants:
    s = section(rows)
    return _search(lambda k: factor(s, k) / rows[column] - 1.0, start, _weights(rows), worst_case=False)


def _mean_root(s: HingeSection, root: Constants) -> Array:
    """Mean length (in thicknesses) that the leaf's two roots add."""
    to_arm, to_body = plane.root_lengths(s, root)
    return (to_arm + to_body) / 2.0


def _fit_grid(rows: Columns, root: Constants, side: str) -> Constants:
    cases = _grid_cases(rows, side)
    lengths = {grid: _mean_root(section(r), root) for grid, r in cases.items()}
    form = strain.two_sided_grid if side == "two" else strain.one_sided_grid

    def error(k: Constants) -> Array:
        return np.concatenate(
            [
                form(section(r), grid * r["hinge_length"], k, lengths[grid]) / r[f"grid_{grid:g}"] - 1.0
                for grid, r in cases.items()
            ]
        )

    weights = np.concatenate([_weights(r) for r in cases.values()])
    return _search(error, START["grid"][side], weights, worst_case=False)


def _grid_cases(rows: Columns, side: str) -> dict[float, Columns]:
    cases = {}
    for grid in GRIDS:
        usable = np.isfinite(rows[f"grid_{grid:g}"])
        if side == "two":
            straight = rows["hinge_length"] - 2.0 * rows["fillet_radius"]
            usable &= grid * rows["hinge_length"] <= straight + HALF_FILLET * rows["fillet_radius"]
        if usable.any():
            cases[grid] = _rows(rows, usable)
    return cases


def _search(
    error: Callable[[Constants], Array], start: Constants, weights: Array, worst_case: bool = True
) -> Constants:
    """Least squares, then least fourth and eighth powers from there, so that the largest errors count
    most.
    """
    names = list(start)

    def residual(values: Array, power: int) -> Array:
        with np.errstate(all="ignore"):
            e = 1e3 * weights * error(dict(zip(names, values)))
        return (
            np.abs(np.nan_to_num(e, nan=100.0, posinf=100.0, neginf=-100.0)) ** power
            if power > 1
            else np.nan_to_num(e, nan=100.0, posinf=100.0, neginf=-100.0)
        )

    x = np.array(list(start.values()))
    least = np.array([0.0 if name in NOT_NEGATIVE else -np.inf for name in names])
    for power in (1, 2, 4) if worst_case else (1,):
        scale = np.maximum(np.abs(x), 0.05)
        x = np.maximum(x, least + STEP_INSIDE)
        x = least_squares(residual, x, x_scale=scale, max_nfev=1000, args=(power,), bounds=(least, np.inf)).x
    return dict(zip(names, x.tolist()))


def _report(data: dict, samples: dict[str, Columns], today: date) -> dict:
    import scipy
    import skfem

    from tactcad import __version__

    inside = in_box(samples["fitted"])
    over_the_range = joined([with_width_factor(samples["range"]), samples["corners"]])
    parts = {
        "held out, box": (samples["held out"], True),
        "held out, corners": (samples["corners held out"], False),
        "fitted, box": (_rows(samples["fitted"], inside), True),
        "fitted, beyond the box": (_rows(samples["fitted"], ~inside), True),
        "fitted, whole range": (over_the_range, False),
    }
    return {
        "date": today.isoformat(),
        "versions": {
            "tactcad": __version__,
            "python": platform.python_version(),
            "numpy": np.__version__,
            "scipy": scipy.__version__,
            "scikit-fem": skfem.__version__,
        },
        "samples": {
            name: {
                "seed": SEEDS[name],
                "designs": len(c["poisson"]),
                "with solid elements": int(np.isfinite(c["width_factor"]).sum()),
            }
            for name, c in ((name, samples[name]) for name in SEEDS)
        },
        "box": {k: list(v) for k, v in BOX.items()},
        "relative_error": {
            name: {
                side: _errors(data, _rows(c, c["two_sided"] == flag), side, strains)
                for side, flag in SIDES.items()
            }
            for name, (c, strains) in parts.items()
        },
    }


def _errors(data: dict, rows: Columns, side: str, strains: bool) -> dict[str, dict[str, float | None]]:
    """rms, worst and number of each quantity's relative error over the rows; strains only where they were
    read."""
    errors = _stiffness_errors(data, rows, side) | (_strain_errors(data, rows, side) if strains else {})
    return {name: _summary(e) for name, e in errors.items()}


def _stiffness_errors(data: dict, rows: Columns, side: str) -> dict[str, Array]:
    s, K2 = section(rows), rows["plane_stiffness"] * rows["width"]
    K3, flat = K2 * rows["width_factor"], plane.parts(s, data["root"][side])
    errors = {
        f"{rung.name}, against plane elements": 1.0 / (rung.compliance(s, data) * K2) - 1.0
        for rung in REGISTER
        if rung.compliance and not rung.fitted
    }
    errors["plane, against plane elements"] = 1.0 / (flat.whole * K2) - 1.0
    errors["plane, against solid elements"] = 1.0 / (flat.whole * K3) - 1.0
    curled = solid.curled(s, flat, data["width"][side])
    errors["solid, against solid elements"] = 1.0 / (curled * K3) - 1.0
    errors["width factor"] = flat.whole / curled / rows["width_factor"] - 1.0
    return errors


def _strain_errors(data: dict, rows: Columns, side: str) -> dict[str, Array]:
    s, root, errors = section(rows), data["root"][side], {}
    errors["peak strain at the fillet"] = (
        strain.fillet_factor(s, data["fillet"][side]) / rows["slot_peak"] - 1.0
    )
    if side == "one":
        errors["peak strain on the flat face"] = (
            strain.face_factor(s, data["face"]["one"]) / rows["flat_peak"] - 1.0
        )
    form = strain.two_sided_grid if side == "two" else strain.one_sided_grid
    errors["mean strain under a grid"] = np.concatenate(
        [np.empty(0)]
        + [
            form(section(r), grid * r["hinge_length"], data["grid"][side], _mean_root(section(r), root))
            / r[f"grid_{grid:g}"]
            - 1.0
            for grid, r in _grid_cases(rows, side).items()
        ]
    )
    for at, column in MID_WIDTH.items():
        measured = rows[column] * rows["width_factor"]
        errors[f"strain per deflection at mid-width, {at}"] = (
            strain.mid_width(s, at, data[f"mid-width {at}"][side]) / measured - 1.0
        )
    return errors


def _summary(error: Array) -> dict[str, float | None]:
    e = error[np.isfinite(error)]
    if not len(e):
        return {"rms": None, "max": None, "n": 0}
    return {"rms": _digits(np.sqrt(np.mean(e * e)), 3), "max": _digits(np.abs(e).max(), 3), "n": len(e)}


def _width_weights(s: HingeSection) -> Array:
    """Equal weights, except for very short slots, which have a promise of their own."""
    return np.where(s.hinge_length < NEXT_TO_NONE * s.hinge_thickness, 0.5, 1.0)


def _weights(rows: Columns) -> Array:
    return np.where(in_box(rows), 1.0, WEIGHT_OUTSIDE)


def _rows(columns: Columns, mask: NDArray[np.bool_]) -> Columns:
    return {k: v[mask] for k, v in columns.items()}


def _rounded(data: Any) -> Any:
    """Constants to six digits: far below what the samples determine."""
    return {k: _rounded(v) for k, v in data.items()} if isinstance(data, dict) else _digits(data, 6)


def _digits(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}")
