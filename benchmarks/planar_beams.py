"""Fits the stiffness of planar cells' beams on solid elements, and measures them on designs that the fit has
not seen.

    python benchmarks/planar_beams.py src/tactcad/families/planar/data    five minutes
    python benchmarks/planar_beams.py DIR --few                           a tenth of it, to try

Sampled: w/s 0.1 to 0.5, s/t 15 to 80, r/w 0.1 to 1 (r at most 0.45 s), nu 0.2 to 0.4, a third of them on an
end of each range. Then a climb from the worst design of every mode pushes its error further.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
from foil_elements import solved
from numpy.typing import NDArray
from scipy.stats import qmc

from tactcad.families.planar import beam as closed
from tactcad.families.planar.beam import MODES, FoilBeam

Array = NDArray[np.float64]
LOW, HIGH = np.array([0.1, 15.0, 0.1, 0.2]), np.array([0.5, 80.0, 1.0, 0.4])  # w/s, s/t, r/w, nu
WIDEST_FILLET = 0.45  # of the length
DENSITY = 2
CLIMB = 25


def beam_at(unit: Array) -> FoilBeam:
    """The beam at a place of the unit cube; s = 1 mm, E = 1 MPa."""
    w, slender, r, nu = LOW + unit * (HIGH - LOW)
    return FoilBeam(1.0, float(w), float(1.0 / slender), float(min(r * w, WIDEST_FILLET)), 1.0, float(nu))


def places(count: int, seed: int) -> Array:
    """In the unit cube: two thirds anywhere, the others with each coordinate at an end with odds one in
    two."""
    rng = np.random.default_rng(seed)
    found = qmc.LatinHypercube(4, seed=seed).random(count)
    edge = rng.random((count, 4)) < 0.5
    edge[count // 3 :] = False
    return np.where(edge, np.round(found), found)


def measured(units: Array) -> Array:
    """Logarithms of what solid elements say over the closed form without factors, (n, 6)."""
    rows = []
    for unit in units:
        beam = beam_at(unit)
        stiffness, base = solved(beam, DENSITY), closed.base(beam)
        rows.append([stiffness[m] / base[m] for m in MODES])
    return np.log(np.array(rows))


def fitted(units: Array, values: Array) -> Array:
    """Coefficients (terms, modes) of least fourth powers, by reweighted least squares."""
    terms = closed.terms(*zip(*(closed.groups(beam_at(u)) for u in units)))
    weight = np.ones_like(values)
    for _ in range(8):
        c = np.column_stack(
            [np.linalg.lstsq(terms * w[:, None], v * w, rcond=None)[0] for w, v in zip(weight.T, values.T)]
        )
        rest = np.abs(values - terms @ c)
        weight = np.sqrt((rest / rest.max(0)) ** 2 + 1e-2)
    return c


def errors(units: Array, found: Array, c: Array) -> Array:
    """Relative errors (design, mode)."""
    terms = closed.terms(*zip(*(closed.groups(beam_at(u)) for u in units)))
    return np.expm1(terms @ c - found)


def climbed(unit: Array, mode: int, c: Array, rng: np.random.Generator) -> float:
    """Largest error found by small steps from there."""
    best = abs(errors(unit[None], measured(unit[None]), c)[0, mode])
    size = 0.15
    for _ in range(CLIMB):
        near = np.clip(unit + size * rng.normal(size=4), 0.0, 1.0)
        error = abs(errors(near[None], measured(near[None]), c)[0, mode])
        unit, best, size = (near, error, size) if error > best else (unit, best, 0.9 * size)
    return float(best)


def main(folder: Path, few: bool) -> None:
    share = 10 if few else 1
    train, held = places(420 // share, 34), places(150 // share, 35)
    c = fitted(train, measured(train))
    rest = np.abs(errors(held, measured(held), c))
    rng, report = np.random.default_rng(36), {}
    for i, mode in enumerate(MODES):
        worst = int(rest[:, i].argmax())
        climb = climbed(held[worst], i, c, rng) if not few else float(rest[:, i].max())
        report[mode] = {
            "rms": round(float(np.sqrt((rest[:, i] ** 2).mean())), 5),
            "held_out": round(float(rest[:, i].max()), 5),
            "climbed": round(climb, 5),
        }
        print(mode, report[mode], flush=True)
    data = {
        "source": "python benchmarks/planar_beams.py, solid elements of order 4, density 2",
        "range": {"w/s": [0.1, 0.5], "s/t": [15, 80], "r/w": [0.1, 1.0], "nu": [0.2, 0.4]},
        "designs": {"fitted": len(train), "held_out": len(held), "climb_steps": CLIMB},
        "errors": report,
        "stiffness": {m: [float(f"{v:.8g}") for v in c[:, i]] for i, m in enumerate(MODES)},
    }
    (folder / "beam.json").write_text(json.dumps(data, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), "--few" in sys.argv)
