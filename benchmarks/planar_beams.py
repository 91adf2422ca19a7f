"""Fits the stiffness of planar cells' beams on solid elements, and measures them on designs that the fit has
not seen.

    python benchmarks/planar_beams.py src/tactcad/families/planar/data    half an hour
    python benchmarks/planar_beams.py DIR --few                           a tenth of it, to try

Sampled: w/s 0.1 to 0.5, s/t 15 to 80, r/w 0.1 to 1 (r at most 0.45 s), nu 0.2 to 0.4, a third of them on an
end of each range, and all of the range's corners. Then climbs from the worst designs of every mode, fitted or
not, push its error further.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from itertools import product
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
CLIMB, STARTS = 40, 3  # steps, from each of so many of the worst designs


def beam_at(unit: Array) -> FoilBeam:
    """The beam at a place of the unit cube; s = 1 mm, E = 1 MPa."""
    w, slender, r, nu = LOW + unit * (HIGH - LOW)
    return FoilBeam(1.0, float(w), float(1.0 / slender), float(min(r * w, WIDEST_FILLET)), 1.0, float(nu))


def places(count: int, seed: int, ways: int = 4) -> Array:
    """In the unit cube: two thirds anywhere, the others with each coordinate at an end with odds one in
    two."""
    rng = np.random.default_rng(seed)
    found = qmc.LatinHypercube(ways, seed=seed).random(count)
    edge = rng.random((count, ways)) < 0.5
    edge[count // 3 :] = False
    return np.where(edge, np.round(found), found)


def corners() -> Array:
    """Of the unit cube."""
    return np.array([*product((0.0, 1.0), repeat=4)])


def measured(units: Array, modes: Sequence[str] = MODES) -> Array:
    """Logarithms of what solid elements say over the closed form without factors, (n, modes)."""
    rows = []
    for unit in units:
        beam = beam_at(unit)
        stiffness, base = solved(beam, modes=modes), closed.base(beam)
        rows.append([stiffness[m] / base[m] for m in modes])
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
    """Relative errors (design, mode) by coefficients c of these modes."""
    terms = closed.terms(*zip(*(closed.groups(beam_at(u)) for u in units)))
    return np.abs(np.expm1(terms @ c - found))


def climbed(error: Callable[[Array], float], starts: Array, rng: np.random.Generator) -> float:
    """Largest error found by small steps from each start."""
    most = 0.0
    for unit in starts:
        best, size = error(unit), 0.15
        for _ in range(CLIMB):
            near = np.clip(unit + size * rng.normal(size=len(unit)), 0.0, 1.0)
            found = error(near)
            unit, best, size = (near, found, size) if found > best else (unit, best, 0.9 * size)
        most = max(most, best)
    return most


def pushed(
    units: Array, rest: Array, held: int, error: Callable[[Array, int], float] | None, seed: int
) -> dict[str, dict[str, float]]:
    """By mode: rms and largest of errors [design, mode] over the last designs, so many are held out, and the
    largest that climbs from the worst of all find; without `error`, no climbs."""
    rng, report = np.random.default_rng(seed), {}
    for i, mode in enumerate(MODES):
        own, worst = rest[-held:, i], units[np.argsort(-rest[:, i])[:STARTS]]
        climb = climbed(lambda unit, i=i: error(unit, i), worst, rng) if error else rest[:, i].max()
        found = {"rms": np.sqrt((own**2).mean()), "held_out": own.max(), "climbed": climb}
        report[mode] = {name: round(float(v), 5) for name, v in found.items()}
        print(mode, report[mode], flush=True)
    return report


def main(folder: Path, few: bool) -> None:
    share = 10 if few else 1
    train, held = np.concatenate([places(420 // share, 34), corners()]), places(150 // share, 35)
    units = np.concatenate([train, held])
    values = measured(units)
    c = fitted(train, values[: len(train)])

    def error(unit: Array, i: int) -> float:
        return float(errors(unit[None], measured(unit[None], MODES[i : i + 1]), c[:, i : i + 1])[0, 0])

    data = {
        "source": "python benchmarks/planar_beams.py, solid elements of order 4, density 2",
        "range": {
            "w/s": [0.1, 0.5],
            "s/t": [15, 80],
            "r/w": [0.1, 1.0],
            "r/s": [0, WIDEST_FILLET],
            "nu": [0.2, 0.4],
        },
        "designs": {"fitted": len(train), "held_out": len(held), "climb_steps": CLIMB, "climbs": STARTS},
        "errors": pushed(units, errors(units, values, c), len(held), None if few else error, 36),
        "stiffness": {m: [float(f"{v:.8g}") for v in c[:, i]] for i, m in enumerate(MODES)},
    }
    (folder / "beam.json").write_text(json.dumps(data, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), "--few" in sys.argv)
