"""Stress at mid-width over the mean, and errors of the closed forms for strain and stress: strain.json.

    python benchmarks/strain_fit.py src/tactcad/mechanics/data    from the committed samples, in seconds
    python benchmarks/strain_fit.py DIR --anew                    samples drawn and solved too, some hours

The designs cover the closed forms' whole range; elements give their strains and stresses at mid-width.
"""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path

import numpy as np
import samples
from samples import Columns, Row, joined, section, taken

from tactcad.fem.elements import solve_plane, solve_solid
from tactcad.fem.face_strain import SurfaceReadings, readings
from tactcad.fem.fem_ladder import ACROSS, ORDER
from tactcad.fem.mapped_mesh import layers, plane_mesh
from tactcad.fem.shape import reference_shape
from tactcad.mechanics import accuracy, strain, validity
from tactcad.mechanics.section import HingeSection

Array = np.ndarray

SEED, COUNT = 20261122, 900
SOLVED = 182  # of them, the first: solids take long
NARROW_HELD_OUT = "narrow held out"  # of samples.DRAWS: errors are measured on them, and nothing is fitted
FILES = {"fitted": "strain-samples.csv", NARROW_HELD_OUT: "strain-narrow-heldout.csv"}
END_SHARE = 0.5  # of a corner design's groups lie at an end of their range
# Grid lengths that are read, in lengths of the slot (one-sided), or of its flat part and a fillet.
GRIDS = (0.1, 0.4, 0.7, 1.0, 1.4, 2.0, 3.0, 5.0)
PLANE_DENSITY = 2
MOST_UNKNOWNS = 40_000
SOLID_ORDER = 3  # an order less than fem-solid's: more designs in the same time
NAMES = ("face_strain", "face_stress", "fillet_strain", "fillet_stress")
READ = (*NAMES, *(f"gauge_{grid:g}" for grid in GRIDS))
COLUMNS = tuple(f"{model}_{name}" for model in ("plane", "solid") for name in READ)

# A hinge hardly wider than long curls over its whole width; one shorter than thick is two roots without a
# leaf between them.
NARROW, SHORT = strain.NARROW, 1.0
ZONES: tuple[dict[str, list[float | None]], ...] = (
    {"b/l": [0.0, samples.NARROW]},
    {"b/l": [samples.NARROW, NARROW], "r/t": [0.0, samples.DEEP]},
    {"b/l": [samples.NARROW, NARROW], "r/t": [samples.DEEP, None]},
    {"b/l": [NARROW, None], "l/t": [0.0, SHORT]},
    {"b/l": [NARROW, None], "l/t": [SHORT, None]},
)
MARGIN, MARGIN_OF_FEW, FEW = (
    1.5,
    2.5,
    20,
)  # stated error over the largest found, by climbs too: a climb of another seed found up to 1.2
FEATURES = {"grid": 5, "fillet": 4, "stress": 4}  # of `strain.narrow`
# share of the mean square: keeps coefficients small that few samples do not determine
RIDGE, RIDGE_NARROW = 1e-3, 1e-2


def draw(count: int = COUNT, seed: int = SEED) -> Columns:
    """`count` designs (mm), half of them two-sided.

    A quarter is on the box's edges, a quarter inside the range, and half has groups at the ends of their
    ranges; the kinds alternate, so that every first part of the sample is like the whole.
    """
    quarter = count // 4
    parts = [
        samples.draw_edges(quarter, seed),
        samples.draw_range(quarter, seed + 1, 0.0),
        samples.draw_range(count - 2 * quarter, seed + 2, END_SHARE),
    ]
    places = np.concatenate([(np.arange(n) // 2 + 0.5) / n for n in (quarter, quarter, count - 2 * quarter)])
    return taken(joined(parts), np.argsort(places, kind="stable"))


def grid_lengths(s: HingeSection) -> Array:
    """mm, those of GRIDS that lie on the faces of one design (scalars)."""
    unit = float(s.straight_length + s.fillet_radius) if s.two_sided else float(s.hinge_length)
    room = 2.0 * min(float(s.body_length) + float(s.hinge_length) / 2.0, float(s.load_arm))
    lengths = unit * np.array(GRIDS)
    return lengths[lengths <= (unit * (1.0 + 1e-9) if s.two_sided else 0.9 * room)]


def results(s: HingeSection) -> Row:
    """One design (scalars) per newton and unit modulus, by plane elements and by solid ones, if they are few
    enough."""
    shape, nu, b = reference_shape(s), float(s.poisson), float(s.width)
    lengths, found = grid_lengths(s), dict.fromkeys(COLUMNS, math.nan)
    plane = solve_plane(shape, 1.0, nu, b, density=PLANE_DENSITY, order=ORDER)
    found |= named("plane", readings(plane, lengths))
    mesh = plane_mesh(shape, 1, order=SOLID_ORDER)
    ends = layers(b / 2.0, float(s.hinge_thickness), 1)
    if 3 * len(mesh.cells) * SOLID_ORDER**2 * (ACROSS * (len(ends) - 1) + 1) <= MOST_UNKNOWNS:
        fine = solve_solid(shape, 1.0, nu, b, density=1, order=SOLID_ORDER, order_across=ACROSS)
        against = readings(fine, lengths) / readings(fine.flat(), lengths)
        found |= named("solid", readings(plane, lengths) * against)
    return found


def named(model: str, strains: SurfaceReadings) -> Row:
    gauges = {f"{model}_gauge_{grid:g}": float(value) for grid, value in zip(GRIDS, strains.gauge)}
    return {f"{model}_{name}": float(getattr(strains, name)) for name in NAMES} | gauges


def shipped_samples() -> dict[str, Columns]:
    """The committed samples."""
    tables = {kind: samples.load(samples.DATA / name) for kind, name in FILES.items()}
    return tables | {samples.CLIMBED: samples.load(samples.DATA / samples.CLIMBS)}


def fit(tables: dict[str, Columns]) -> dict:
    """The contents of data/strain.json from samples by the names of FILES: fitted on the first kind, what
    holds
    of narrow leaves and errors on all."""
    known = {kind: _known(columns) for kind, columns in tables.items()}
    s, data = section(known["fitted"]), {"mid-width share": {}, "narrow": {}}
    for side, flag in strain.SIDES.items():
        own = np.flatnonzero(s.two_sided == flag)
        measured = (known["fitted"]["solid_fillet_stress"] / strain.mean_stress(s, 1.0))[own]
        q = s.rows(own)
        data["mid-width share"][side] = _fitted(strain.features(q), q.poisson**2, measured, RIDGE)
    rows = joined(list(known.values()))
    s = section(rows)
    flat = data | {"narrow": {at: dict.fromkeys(strain.SIDES, _nothing(n)) for at, n in FEATURES.items()}}
    left = {at: _narrow_cases(rows, s, errors(rows, s, flat), at) for at in FEATURES}
    for at, (which, features, measured) in left.items():
        data["narrow"][at] = {}
        for side, flag in strain.SIDES.items():
            own = s.two_sided[which] == flag
            q = s.rows(which[own])
            weight = q.poisson**2 * (q.hinge_length / q.width - 1.0 / strain.NARROW)
            data["narrow"][at][side] = _fitted(features[own], weight, measured[own], RIDGE_NARROW)
    error = errors(rows, s, data)
    groups = validity.groups(s)
    zones = [{"sides": side, "bounds": bounds} for side in strain.SIDES for bounds in ZONES]
    zones = [zone | _measured(error, accuracy.in_zone(zone, groups, s.two_sided)) for zone in zones]
    return {"seed": SEED, "designs": len(s.two_sided)} | data | {"zones": zones}


def _known(columns: Columns) -> Columns:
    """Those that solids were solved for, inside the range of rung solid, which may end elsewhere since they
    were drawn."""
    reached = validity.reasons(section(columns), "solid") == ""
    return taken(columns, np.isfinite(columns["solid_fillet_stress"]) & reached)


def _narrow_cases(
    rows: Columns, s: HingeSection, error: dict[str, list[Array]], at: str
) -> tuple[Array, Array, Array]:
    """Of every narrow design, under every grid: its row, its features, and elements over closed form."""
    names = {"grid": ("gauge", "long gauge"), "fillet": ("fillet strain",), "stress": ("fillet stress",)}
    slender = s.width < strain.NARROW * s.hinge_length
    cases = []
    for length, e in zip(GRIDS if at == "grid" else (None,), [e for n in names[at] for e in error[n]]):
        which = np.flatnonzero(slender & np.isfinite(e))
        q = s.rows(which)
        grid = None if length is None else length * _slot(q)
        cases.append((which, strain.features(q, grid), 1.0 / (1.0 + e[which])))
    which, features, measured = (np.concatenate(each) for each in zip(*cases))
    return which, features, measured


def _fitted(features: Array, weight: Array, measured: Array, ridge: float) -> dict[str, list[float]]:
    """Range of the features and coefficients of P, so that 1 + weight P is `measured`, by least squares of
    the
    relative error."""
    k = {"low": features.min(axis=0).tolist(), "high": features.max(axis=0).tolist()}
    terms = strain.terms(features, k) * (weight / measured)[:, None]
    wanted = (measured - 1.0) / measured
    normal = terms.T @ terms + ridge * np.mean(terms**2) * len(terms) * np.eye(terms.shape[1])
    constants = k | {"coefficients": np.linalg.solve(normal, terms.T @ wanted).tolist()}
    return {name: [float(f"{value:.6g}") for value in values] for name, values in constants.items()}


def _nothing(features: int) -> dict[str, list[float]]:
    """Constants of a P that is 0."""
    count = (features + 1) * (features + 2) // 2
    return {"low": [0.0] * features, "high": [1.0] * features, "coefficients": [0.0] * count}


def _slot(s: HingeSection) -> Array:
    """mm, the length that GRIDS counts in."""
    return np.where(s.two_sided, s.straight_length + s.fillet_radius, s.hinge_length)


def errors(rows: Columns, s: HingeSection, data: dict) -> dict[str, list[Array]]:
    """Relative errors of rung solid's closed forms, by the constants in `data`, against solid elements; one
    array a grid length."""
    gauges: dict[str, list[Array]] = {"gauge": [], "long gauge": []}
    for grid in GRIDS:
        known = np.flatnonzero(np.isfinite(rows[f"solid_gauge_{grid:g}"]))
        error, q = np.full(s.shape, math.nan), s.rows(known)
        if len(known):
            mean = strain.gauge(q, 1.0, grid * _slot(q) * (1.0 - 1e-9), "solid", data)
            error[known] = mean / rows[f"solid_gauge_{grid:g}"][known] - 1.0
        gauges["gauge" if grid <= strain.LONG_GRID else "long gauge"].append(error)
    stress = strain.mean_stress(s, 1.0) * np.maximum(strain.mid_width_share(s, data), 1.0)
    return gauges | {
        "fillet strain": [strain.peak(s, 1.0, "solid", data) / rows["solid_fillet_strain"] - 1.0],
        "fillet stress": [stress / rows["solid_fillet_stress"] - 1.0],
    }


def _measured(errors: dict[str, list[Array]], own: Array) -> dict:
    """Worst and stated error of each quantity in a zone, None if none was read."""
    worst: dict[str, float | None] = {}
    for name, arrays in errors.items():
        e = np.abs(np.concatenate([a[own] for a in arrays]))
        worst[name] = float(f"{np.nanmax(e):.3g}") if np.isfinite(e).any() else None
    margin = MARGIN if own.sum() >= FEW else MARGIN_OF_FEW
    stated = {n: None if e is None else math.ceil(1000.0 * margin * e) / 1000.0 for n, e in worst.items()}
    return {"designs": int(own.sum()), "worst": worst, "stated": stated}


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, help="where strain.json is written")
    parser.add_argument("--anew", action="store_true", help="draw the samples and solve them")
    asked = parser.parse_args()
    tables = shipped_samples()
    if asked.anew:
        drawn = {
            "fitted": taken(draw(), np.arange(SOLVED)),
            NARROW_HELD_OUT: samples.draw_all(NARROW_HELD_OUT),
        }
        for kind, designs in drawn.items():
            tables[kind] = samples.solved(designs, lambda i, s: results(s), kind)
            samples.write(tables[kind], asked.folder / FILES[kind])
    (asked.folder / "strain.json").write_text(json.dumps(fit(tables), indent=1) + "\n", "utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
