"""The ladder's constants and every rung's worst errors from samples by elements: ladder.json, accuracy.json.

    python benchmarks/ladder_fit.py src/tactcad/mechanics/data    from the committed samples, in a minute
    python benchmarks/ladder_fit.py DIR --anew                    samples drawn and solved too: half an hour

New samples are written to DIR; moved to benchmarks/data they are the committed ones.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import time
from collections.abc import Callable
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np
import samples as drawn
import scipy
import skfem
from numpy.typing import NDArray
from samples import BOX, GRIDS, LEAST_HEIGHT, SEEDS, Columns, joined, section, taken, with_width_factor
from scipy.optimize import least_squares

from tactcad import __version__
from tactcad.mechanics import accuracy, strain, validity
from tactcad.mechanics.accuracy import CANDIDATES, Candidate
from tactcad.mechanics.register import rungs
from tactcad.mechanics.rungs import plane, solid
from tactcad.mechanics.rungs.plane import compliance_by
from tactcad.mechanics.section import HingeSection

Array = NDArray[np.float64]
Constants = dict[str, float]

SIDES = {"two": 1.0, "one": 0.0}
WEIGHT_OUTSIDE = 0.3  # of samples outside the promised box, so that the box dominates the fit
NEXT_TO_NONE = 0.5  # slot length over hinge thickness below which the two roots are one
STEP_INSIDE = 1e-6  # of constants that may not be negative: a search starts inside its bounds
HALF_FILLET = 1.0  # grids on two-sided hinges are fitted up to straight part + this times r

MID_WIDTH = {"grid": "mid_grid_ratio", "fillet": "mid_peak_ratio"}
PEAKS = {"fillet": (strain.fillet_factor, "slot_peak"), "face": (strain.face_factor, "flat_peak")}

# Start of the search: orders of magnitude by beam theory and a first look at the data.
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


def fit(samples: dict[str, Columns]) -> dict:
    """Constants, range and report, as data/ladder.json holds them.

    Stiffness is fitted on "fitted", "range" and "corners" (of samples.FILES), strains on "fitted", which also
    defines the range.
    """
    fitted = samples["fitted"]
    over_the_range = joined([with_width_factor(samples["range"]), samples["corners"]])
    found: dict[str, dict[str, Constants]] = {group: {} for group in START}
    for side, flag in SIDES.items():
        rows, others = (taken(c, c["two_sided"] == flag) for c in (fitted, over_the_range))
        all_rows, start = joined([rows, others]), {group: sides.get(side) for group, sides in START.items()}
        even = np.ones(len(all_rows["width"]))
        root = found["root"][side] = _search(lambda k: plane_error(all_rows, k), start["root"], even)
        solids = taken(all_rows, np.isfinite(all_rows["width_factor"]))
        flat, s = plane.parts(section(solids), root), section(solids)
        # equal weights, except for very short slots, which have a promise of their own
        weights = np.where(s.hinge_length < NEXT_TO_NONE * s.hinge_thickness, 0.5, 1.0)
        width = _search(lambda k: solid_error(solids, flat, k), start["width"], weights)
        found["width"][side] = width
        solids = taken(rows, np.isfinite(rows["width_factor"]))
        for at in MID_WIDTH:
            name = f"mid-width {at}"
            error = lambda k, at=at: mid_width_error(solids, at, k)  # noqa: E731
            found[name][side] = _search(error, start[name], _weights(solids), worst_case=False)
        for at in PEAKS if side == "one" else ("fillet",):
            error = lambda k, at=at: peak_error(rows, at, k)  # noqa: E731
            found[at][side] = _search(error, start[at], _weights(rows), worst_case=False)
    data = _rounded(found)
    for side, flag in SIDES.items():
        rows, root = taken(fitted, fitted["two_sided"] == flag), data["root"][side]
        weights = np.concatenate([_weights(r) for r in _grid_cases(rows, side).values()])
        error = lambda k: grid_error(rows, side, root, k)  # noqa: E731
        data["grid"][side] = _rounded(_search(error, START["grid"][side], weights, worst_case=False))
    ranges, least = validity.groups(section(fitted)), section(joined([fitted, samples["range"]]))
    return data | {
        "range": {
            "least_height": LEAST_HEIGHT,
            # with a small margin, of each group that has a lower bound only
            "least": {
                n: _digits(f(least).min() * (1.0 - 5e-3), 3) for n, (_, f, _) in validity.LEAST.items()
            },
            "groups": {n: [_digits(v.min(), 3), _digits(v.max(), 3)] for n, v in ranges.items()},
        },
        "report": _report(data, samples),
    }


def in_box(columns: Columns) -> NDArray[np.bool_]:
    """Which designs lie in the promised box."""
    return np.logical_and.reduce(
        [(columns[k] >= low) & (columns[k] <= high) for k, (low, high) in BOX.items()]
    )


def _weights(rows: Columns) -> Array:
    return np.where(in_box(rows), 1.0, WEIGHT_OUTSIDE)


# --- relative errors of each form over the rows, as they are fitted and as they are reported ---


def plane_error(rows: Columns, root: Constants) -> Array:
    """Of the plane rung's stiffness, of unit width."""
    return 1.0 / (plane.compliance(section(rows).with_(width=1.0), root) * rows["plane_stiffness"]) - 1.0


def solid_error(rows: Columns, flat: plane.Parts, width: Constants) -> Array:
    """Of the whole stiffness: the width's constants compensate for part of the error of the root's."""
    stiffness = rows["plane_stiffness"] * rows["width"] * rows["width_factor"]
    return 1.0 / (solid.curled(section(rows), flat, width) * stiffness) - 1.0


def mid_width_error(rows: Columns, at: str, k: Constants) -> Array:
    measured = rows[MID_WIDTH[at]] * rows["width_factor"]
    return strain.mid_width(section(rows), at, k) / measured - 1.0


def peak_error(rows: Columns, at: str, k: Constants) -> Array:
    factor, column = PEAKS[at]
    return factor(section(rows), k) / rows[column] - 1.0


def grid_error(rows: Columns, side: str, root: Constants, k: Constants) -> Array:
    """Of the mean strain under every grid that lies on the face, one after the other."""
    form = strain.two_sided_grid if side == "two" else strain.one_sided_grid
    errors = [np.empty(0)]
    for grid, r in _grid_cases(rows, side).items():
        s = section(r)
        mean_root = sum(plane.root_lengths(s, root)) / 2.0  # that the leaf's two roots add, in thicknesses
        errors.append(form(s, grid * r["hinge_length"], k, mean_root) / r[f"grid_{grid:g}"] - 1.0)
    return np.concatenate(errors)


def _grid_cases(rows: Columns, side: str) -> dict[float, Columns]:
    cases = {}
    for grid in GRIDS:
        usable = np.isfinite(rows[f"grid_{grid:g}"])
        if side == "two":
            straight = rows["hinge_length"] - 2.0 * rows["fillet_radius"]
            usable &= grid * rows["hinge_length"] <= straight + HALF_FILLET * rows["fillet_radius"]
        if usable.any():
            cases[grid] = taken(rows, usable)
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
        e = np.nan_to_num(e, nan=100.0, posinf=100.0, neginf=-100.0)
        return np.abs(e) ** power if power > 1 else e

    x = np.array(list(start.values()))
    least = np.array([0.0 if name in NOT_NEGATIVE else -np.inf for name in names])
    for power in (1, 2, 4) if worst_case else (1,):
        scale = np.maximum(np.abs(x), 0.05)
        x = np.maximum(x, least + STEP_INSIDE)
        x = least_squares(residual, x, x_scale=scale, max_nfev=1000, args=(power,), bounds=(least, np.inf)).x
    return dict(zip(names, x.tolist()))


def _report(data: dict, samples: dict[str, Columns]) -> dict:
    inside = in_box(samples["fitted"])
    over_the_range = joined([with_width_factor(samples["range"]), samples["corners"]])
    parts = {  # and whether strains were read of them
        "held out, box": (samples["held out"], True),
        "held out, corners": (samples["corners held out"], False),
        "fitted, box": (taken(samples["fitted"], inside), True),
        "fitted, beyond the box": (taken(samples["fitted"], ~inside), True),
        "fitted, whole range": (over_the_range, False),
    }
    libraries = {"numpy": np, "scipy": scipy, "scikit-fem": skfem}
    return {
        "date": date.today().isoformat(),
        "versions": {"tactcad": __version__, "python": platform.python_version()}
        | {name: library.__version__ for name, library in libraries.items()},
        "samples": {
            name: {
                "seed": seed,
                "designs": len(samples[name]["poisson"]),
                "with solid elements": int(np.isfinite(samples[name]["width_factor"]).sum()),
            }
            for name, seed in SEEDS.items()
        },
        "box": {k: list(v) for k, v in BOX.items()},
        "relative_error": {
            name: {
                side: _errors(data, taken(c, c["two_sided"] == flag), side, strains)
                for side, flag in SIDES.items()
            }
            for name, (c, strains) in parts.items()
        },
    }


def _errors(data: dict, rows: Columns, side: str, strains: bool) -> dict[str, dict[str, float | None]]:
    """rms, worst and number of each quantity's relative error over the rows."""
    k = {group: sides.get(side) for group, sides in data.items()}
    s, K2 = section(rows), rows["plane_stiffness"] * rows["width"]
    flat = plane.parts(s, k["root"])
    errors = {
        f"{rung.name}, against plane elements": 1.0 / (rung.compliance(s, data) * K2) - 1.0
        for rung in rungs().values()
        if rung.compliance and not rung.fitted
    }
    errors["plane, against plane elements"] = 1.0 / (flat.whole * K2) - 1.0
    errors["plane, against solid elements"] = 1.0 / (flat.whole * K2 * rows["width_factor"]) - 1.0
    errors["solid, against solid elements"] = solid_error(rows, flat, k["width"])
    errors["width factor"] = flat.whole / solid.curled(s, flat, k["width"]) / rows["width_factor"] - 1.0
    if strains:
        errors["peak strain at the fillet"] = peak_error(rows, "fillet", k["fillet"])
        if side == "one":
            errors["peak strain on the flat face"] = peak_error(rows, "face", k["face"])
        errors["mean strain under a grid"] = grid_error(rows, side, k["root"], k["grid"])
        for at in MID_WIDTH:
            name = f"strain per deflection at mid-width, {at}"
            errors[name] = mid_width_error(rows, at, k[f"mid-width {at}"])
    return {name: _summary(e[np.isfinite(e)]) for name, e in errors.items()}


def _summary(e: Array) -> dict[str, float | None]:
    if not len(e):
        return {"rms": None, "max": None, "n": 0}
    return {"rms": _digits(np.sqrt(np.mean(e * e)), 3), "max": _digits(np.abs(e).max(), 3), "n": len(e)}


def _rounded(data: Any) -> Any:
    """Constants to six digits: far below what the samples determine."""
    return {k: _rounded(v) for k, v in data.items()} if isinstance(data, dict) else _digits(data, 6)


def _digits(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}")


# --- worst errors by zone of the envelope, against solid elements ---

# The promised error is the largest measured one times this: a new design can always be somewhat worse, the
# more so the fewer were measured. The closed forms are fitted to least eighth powers, corners included, so
# that many designs have errors near the largest.
# Of designs drawn later (benchmarks/budgets.py) one erred 1.54 times the largest by rung solid. Refined
# meshes, on which the fewest were solved, erred 3.7 and 8.7 times it where an arm is hardly longer than high.
MARGIN, MARGIN_OF_FEW, FEW, MARGIN_OF_REFINED = 2.0, 2.5, 60, 7.0
MARGIN_OF_CLIMBED = 1.5  # of rung solid, whose errors hinge_climbs.py pushes up
# Below l/t = 0.5 the hinge is so short that its two roots act as one; from 2 on they are independent.
Bounds = dict[str, list[float | None]]


def _zones(*deep: list[float | None]) -> tuple[Bounds, ...]:
    """Bounds of a notch form's zones; `deep`: of b/l, where fillets are deep."""
    return (
        {"b/l": [drawn.NARROW, None], "l/t": [0.0, NEXT_TO_NONE]},
        {"b/l": [drawn.NARROW, None], "l/t": [NEXT_TO_NONE, 2.0]},
        {"b/l": [drawn.LESS_NARROW, None], "l/t": [2.0, None], "r/t": [0.0, drawn.DEEP]},
        {"b/l": [drawn.NARROW, drawn.LESS_NARROW], "l/t": [2.0, None], "r/t": [0.0, drawn.DEEP]},
        *({"b/l": widths, "l/t": [2.0, None], "r/t": [drawn.DEEP, None]} for widths in deep),
        {"b/l": [0.0, drawn.NARROW], "r/t": [0.0, drawn.DEEP]},
        {"b/l": [0.0, drawn.NARROW], "r/t": [drawn.DEEP, None]},
    )


# Of one-sided hinges with deep fillets too few were measured to tell widths apart, and they err less.
ZONES = {
    "two": _zones([drawn.LESS_NARROW, None], [drawn.NARROW, drawn.LESS_NARROW]),
    "one": _zones([drawn.NARROW, None]),
}
TIMED = 10_000  # designs in the table that closed forms are timed on
REFERENCE = (
    "three-dimensional linear elasticity of the element cut at load line and clamp edge, "
    "by solid elements refined to their limit (fem-solid)"
)

Errors = dict[str, np.ndarray]


def accuracy_table(samples: dict[str, Columns], ladder_data: dict) -> dict:
    """The contents of data/accuracy.json, from computed designs by the names of samples.FILES."""
    clock = closed_form_seconds(ladder_data)
    columns = joined(list((samples | {"range": with_width_factor(samples["range"])}).values()))
    errors = candidate_errors(columns, ladder_data)
    groups, two_sided = validity.groups(section(columns)), columns["two_sided"] == 1.0
    zones = []
    for sides, bounds in ((sides, bounds) for sides, all_ in ZONES.items() for bounds in all_):
        zone = {"sides": sides, "bounds": bounds}
        narrow = bounds["b/l"][0] == 0.0  # too few to tell the notch forms apart
        form = np.full_like(two_sided, sides == "two") if narrow else two_sided
        inside = accuracy.in_zone(zone, groups, form)
        zones.append(zone | _measured(columns, errors, inside, clock))
    margins = (MARGIN, MARGIN_OF_FEW, MARGIN_OF_REFINED, MARGIN_OF_CLIMBED)
    return {
        "reference": REFERENCE,
        "margin": dict(
            zip(("usual", f"of fewer than {FEW} designs", "of refined meshes", "climbed"), margins)
        ),
        "date": date.today().isoformat(),
        "machine": f"{platform.machine()}, {platform.system()}, Python {platform.python_version()}, numpy "
        f"{np.__version__}, {os.cpu_count()} cores, one used",
        "samples": {name: len(c["poisson"]) for name, c in samples.items()}
        | {"seed of range": drawn.RANGE_SEED}
        | {f"seeds of {name}": [draw.seed for draw in draws] for name, draws in drawn.DRAWS.items()},
        "seconds a call": {c.name: clock.get(c.name, (0.0, 0.0))[0] for c in CANDIDATES},
        "zones": zones,
    }


def candidate_errors(columns: Columns, ladder_data: dict) -> Errors:
    """|K/K_solid - 1| of every candidate for every design, NaN if it was not measured.

    K_solid is that of fem-solid on the finest meshes on which the design was solved. A closed form that
    models the width is made of the plane rung's parts; where only the plane was solved, the error of these
    counts.
    """
    s = section(columns)
    plane = columns["plane_stiffness"] * columns["width"]
    truth = plane * columns["width_factor"]
    errors = {
        rung.name: np.abs(1.0 / (rung.compliance(s, ladder_data) * truth) - 1.0)
        for rung in rungs().values()
        if rung.compliance
    }
    flat = np.abs(1.0 / (compliance_by(s, ladder_data) * plane) - 1.0)
    for rung in rungs().values():
        if rung.compliance and "width" in rung.fitted:
            errors[rung.name] = np.fmax(errors[rung.name], flat)
    errors["fem-plane"] = np.abs(plane / truth - 1.0)
    finest = np.where(np.isfinite(columns["solid_mesh_4"]), columns["solid_mesh_4"], np.nan)
    errors["fem-solid, mesh 3"] = np.abs(columns["solid_mesh_3"] / finest - 1.0)
    finer = np.where(np.isfinite(finest), finest, columns["solid_mesh_3"])
    errors["fem-solid, mesh 2"] = np.abs(columns["solid_mesh_2"] / finer - 1.0)
    return errors


def closed_form_seconds(ladder_data: dict, repeats: int = 7) -> dict[str, tuple[float, float]]:
    """(seconds of a call, seconds a design in a long table) of every closed form, shortest of several
    runs."""
    many = section(drawn.draw_box(200, seed=0)).rows(np.arange(TIMED) % 200)
    one = many.rows(0)
    seconds = {}
    for rung in rungs().values():
        if form := rung.compliance:
            call, table = (min(_seconds(form, s, ladder_data) for _ in range(repeats)) for s in (one, many))
            seconds[rung.name] = (call, table / TIMED)
    return {rung: (float(f"{alone:.2g}"), float(f"{each:.2g}")) for rung, (alone, each) in seconds.items()}


def _seconds(form: Callable[[HingeSection, dict], Array], s: HingeSection, ladder_data: dict) -> float:
    start = time.perf_counter()
    form(s, ladder_data)
    return time.perf_counter() - start


def _measured(
    columns: Columns, errors: Errors, inside: np.ndarray, clock: dict[str, tuple[float, float]]
) -> dict:
    """A zone's largest errors, the errors promised for it, and the seconds of an element."""
    worst, counts, seconds = {}, {}, {}
    for candidate in CANDIDATES:
        # few designs are solved on refined meshes: every zone uses those of all zones
        e = errors[candidate.name][inside] if candidate.mesh is None else errors[candidate.name]
        e = e[np.isfinite(e)]
        worst[candidate.name] = float(f"{e.max():.3g}")
        counts[candidate.name] = (
            len(e) if candidate.mesh else int(np.isfinite(errors["fem-plane"][inside]).sum())
        )
        closed = clock.get(candidate.name)
        seconds[candidate.name] = closed[1] if closed else _median(candidate, columns, inside)
    own = worst["fem-solid, mesh 3"]  # possible error of the reference itself
    promised = {}
    for c in CANDIDATES:
        margin = MARGIN if counts[c.name] >= FEW else MARGIN_OF_FEW
        if c.mesh or c.name == accuracy.MEASURED_FOR:
            margin = MARGIN_OF_REFINED if c.mesh else MARGIN_OF_CLIMBED
        promised[c.name] = _rounded_up(margin * (worst[c.name] + own))
    return {"designs": counts, "worst": worst, "promised": promised, "seconds": seconds}


def _rounded_up(value: float) -> float:
    """To two digits, upwards."""
    step = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.ceil(value / step - 1e-9) * step:.2g}")


def _median(candidate: Candidate, columns: Columns, inside: np.ndarray) -> float:
    """Of the zone's designs, or of all where none of the zone was timed."""
    seconds = columns[drawn.SECONDS[candidate.name]]
    timed = seconds[inside] if np.isfinite(seconds[inside]).any() else seconds
    return float(f"{np.nanmedian(timed):.2g}")


# --- the command ---

# designs that are fitted, of them with solid elements too; the same of those held out; over the
# range; in each draw of the corners at most
WHOLE, LEAST = (1200, 400, 300, 120, 240, 240), (60, 40, 10, 5, 240, 40)


def solve_samples(folder: Path, counts: tuple[int, ...]) -> dict[str, Columns]:
    """Samples drawn and solved, written to the folder and read back: the fit sees the files' digits."""
    fitted, solids, held_out, held_out_solids, over_range, corners = counts

    def results(solids: int) -> Callable[[int, HingeSection], drawn.Row]:
        return lambda i, s: drawn.plane_results(s) | (drawn.solid_results(s) if i < solids else {})

    tables: dict[str, list[Columns]] = {}
    for kind, count, some in (("fitted", fitted, solids), ("held out", held_out, held_out_solids)):
        inside, edges = drawn.designs(kind, count)
        tables[kind] = [
            drawn.solved(inside, results(some), kind),
            drawn.solved(edges, results(some // 5), kind),
        ]
    tables["range"] = [
        drawn.solved(
            drawn.draw_range(over_range), lambda i, s: drawn.range_results(s, drawn.meshes_of(i)), "range"
        ),
        drawn.solved(drawn.draw_refined(), lambda i, s: drawn.range_results(s, (2, 3, 4)), "refined"),
    ]
    for kind, draws in drawn.DRAWS.items():
        tables[kind] = [
            drawn.solved(d.designs(corners), lambda i, s, d=d: drawn.corner_results(s, i < d.solids), kind)
            for d in draws
        ]
    for kind, made in tables.items():
        drawn.write(joined(made), folder / drawn.FILES[kind])
    return {kind: drawn.load(folder / name) for kind, name in drawn.FILES.items()}


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, help="where ladder.json and accuracy.json are written")
    parser.add_argument("--anew", action="store_true", help="draw the samples and solve them")
    parser.add_argument("--few", action="store_true", help="as few samples as can be fitted, to try it")
    asked = parser.parse_args(arguments)
    asked.folder.mkdir(parents=True, exist_ok=True)
    counts = LEAST if asked.few else WHOLE
    samples = solve_samples(asked.folder, counts) if asked.anew or asked.few else drawn.shipped()
    ladder = fit(samples)
    for name, document in (("ladder", ladder), ("accuracy", accuracy_table(samples, ladder))):
        (asked.folder / f"{name}.json").write_text(json.dumps(document, indent=1) + "\n", "utf-8")
    for side, errors in ladder["report"]["relative_error"]["held out, box"].items():
        for rung in ("plane", "solid"):
            worst = errors[f"{rung}, against {rung} elements"]["max"]
            print(f"{side}-sided, held out: {rung}, max {100 * worst:.2f} %")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
