"""Ratio of the stress at mid-width to the width's mean, and errors of the closed forms for strain and stress.

`python -m tactcad.fit.strain_fit src/tactcad/mechanics/data/strain.json` fits and measures again on the
shipped samples.
"""

from __future__ import annotations

import json
import math
import sys
from importlib import resources
from pathlib import Path

import numpy as np

from tactcad.mechanics import strain, strain_errors, validity
from tactcad.mechanics.section import HingeSection

from . import corner_samples
from .fit_samples import Columns, joined, load, section
from .strain_samples import FILES, GRIDS, SEED

Array = np.ndarray

# A hinge hardly wider than long curls over its whole width; one shorter than thick is two roots without a
# leaf between them.
NARROW, SHORT = 1.5, 1.0
ZONES: tuple[dict[str, list[float | None]], ...] = (
    {"b/l": [0.0, corner_samples.NARROW]},
    {"b/l": [corner_samples.NARROW, NARROW]},
    {"b/l": [NARROW, None], "l/t": [0.0, SHORT]},
    {"b/l": [NARROW, None], "l/t": [SHORT, None]},
)
MARGIN = 2.0  # stated error over the largest measured one: zones have few designs
RIDGE = 1e-3  # share of the mean square: keeps coefficients small that few samples do not determine


def shipped_samples() -> dict[str, Columns]:
    """The samples that come with the program."""
    folder = resources.files(__package__) / "data"
    return {kind: load(folder / name) for kind, name in FILES.items()}


def fit(samples: dict[str, Columns]) -> dict:
    """The contents of data/strain.json from samples (as strain_samples.FILES names them): fitted on the first
    kind, errors measured on all."""
    known = {kind: _known(columns) for kind, columns in samples.items()}
    rows = known["fitted"]
    s = section(rows)
    share = {}
    for side, flag in strain_errors.SIDES.items():
        own = np.flatnonzero(s.two_sided == flag)
        measured = (rows["solid_fillet_stress"] / strain.mean_stress(s, 1.0))[own]
        share[side] = _fitted(s.rows(own), measured)
    rows = joined(list(known.values()))
    s = section(rows)
    errors = _errors(rows, s, share)
    zones = []
    for side, flag in strain_errors.SIDES.items():
        for bounds in ZONES:
            own = strain_errors.in_zone(bounds, s) & (s.two_sided == flag)
            zones.append({"sides": side, "bounds": bounds} | _measured(errors, own))
    return {"seed": SEED, "designs": len(s.two_sided), "mid-width share": share, "zones": zones}


def _known(columns: Columns) -> Columns:
    """Those that solids were solved for, inside the range of rung solid, which may end elsewhere since they
    were drawn."""
    solved = np.isfinite(columns["solid_fillet_stress"])
    reached = validity.reasons(section(columns), "solid") == ""
    return {name: values[solved & reached] for name, values in columns.items()}


def _fitted(s: HingeSection, measured: Array) -> dict[str, list[float]]:
    """Range of the features and coefficients of `strain.mid_width_share`, by least squares of the relative
    error."""
    features = strain.share_features(s)
    k = {"low": features.min(axis=0).tolist(), "high": features.max(axis=0).tolist()}
    terms = strain.share_terms(s, k) * (s.poisson**2 / measured)[:, None]
    wanted = (measured - 1.0) / measured
    normal = terms.T @ terms + RIDGE * np.mean(terms**2) * len(terms) * np.eye(terms.shape[1])
    constants = k | {"coefficients": np.linalg.solve(normal, terms.T @ wanted).tolist()}
    return {name: [float(f"{value:.6g}") for value in values] for name, values in constants.items()}


def _errors(rows: Columns, s: HingeSection, share: dict) -> dict[str, list[Array]]:
    """Relative errors of rung solid's closed forms against solid elements, one array a grid length."""
    slot = np.where(s.two_sided, s.straight_length + s.fillet_radius, s.hinge_length)
    gauges: dict[str, list[Array]] = {"gauge": [], "long gauge": []}
    for grid in GRIDS:
        known = np.flatnonzero(np.isfinite(rows[f"solid_gauge_{grid:g}"]))
        error = np.full(s.shape, math.nan)
        lengths = grid * slot[known] * (1.0 - 1e-9)
        mean = strain.gauge(s.rows(known), 1.0, lengths, "solid")
        error[known] = mean / rows[f"solid_gauge_{grid:g}"][known] - 1.0
        gauges["gauge" if grid <= strain_errors.LONG_GRID else "long gauge"].append(error)
    stress = strain.mean_stress(s, 1.0) * np.maximum(strain.mid_width_share(s, share), 1.0)
    return gauges | {
        "fillet strain": [strain.peak(s, 1.0, "solid") / rows["solid_fillet_strain"] - 1.0],
        "fillet stress": [stress / rows["solid_fillet_stress"] - 1.0],
    }


def _measured(errors: dict[str, list[Array]], own: Array) -> dict:
    """Worst error of each quantity in a zone and what is stated for it, None where none was read."""
    worst: dict[str, float | None] = {}
    for name, arrays in errors.items():
        e = np.abs(np.concatenate([a[own] for a in arrays]))
        worst[name] = float(f"{np.nanmax(e):.3g}") if np.isfinite(e).any() else None
    stated = {n: None if e is None else math.ceil(1000.0 * MARGIN * e) / 1000.0 for n, e in worst.items()}
    return {"designs": int(own.sum()), "worst": worst, "stated": stated}


if __name__ == "__main__":
    document = json.dumps(fit(shipped_samples()), indent=1) + "\n"
    Path(sys.argv[1]).write_text(document, "utf-8")
