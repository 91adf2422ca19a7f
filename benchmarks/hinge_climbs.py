"""Designs that push rung solid's errors up, zone by zone: benchmarks/data/hinge-climbs.csv.

    python benchmarks/hinge_climbs.py benchmarks/data/hinge-climbs.csv --seconds 600
    python benchmarks/strain_fit.py src/tactcad/mechanics/data
    python benchmarks/ladder_fit.py src/tactcad/mechanics/data

The errors are those of stiffness, and of strain and stress at mid-width, against fem-solid. A climb starts
at the
worst design known, of the samples and of earlier climbs, changes it at random and keeps larger errors. The
file grows by those designs; strain_fit.py and ladder_fit.py derive the stated errors from it.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import samples
import strain_fit
from samples import Columns, Row, joined, section, taken

from tactcad.fem.face_strain import readings, solid_readings
from tactcad.fem.fem_ladder import converged_plane, converged_solid
from tactcad.fem.mapped_mesh import plane_mesh
from tactcad.fem.shape import reference_shape
from tactcad.mechanics import accuracy, ladder, validity
from tactcad.mechanics.register import strain_data
from tactcad.mechanics.section import HingeSection

SEED = 20261125
STEP = (0.01, 0.4)  # least and largest standard deviation of a try's ln of each size
OVER = 1.3  # of the last success's way that a try goes on with at most
HALVINGS = 12  # of a step that leaves zone or range: the worst often lies on their edges
CELLS = 320  # elements in the plane at most, times elements across: a few seconds a design
SIZES = tuple(samples.BOX)
Target = tuple[str, int]  # what errs, and the index of a zone of accuracy.json (K) or strain.json


def solved(s: HingeSection) -> Row:
    """One design (scalars) of unit modulus by fem-solid, as ladder_fit.py and strain_fit.py take it."""
    shape, nu, b = reference_shape(s), float(s.poisson), float(s.width)
    solid, plane = converged_solid(shape, 1.0, nu, b), converged_plane(shape, 1.0, nu, b)
    lengths, found = strain_fit.grid_lengths(s), dict.fromkeys(strain_fit.COLUMNS, math.nan)
    found |= strain_fit.named("plane", readings(plane.plane, lengths))
    found |= strain_fit.named("solid", solid_readings(plane.plane, solid.solids, lengths))
    ratio = solid.stiffness / plane.stiffness
    return found | {"plane_stiffness": plane.stiffness / b, "width_factor": ratio}


def errors(rows: Columns) -> dict[str, np.ndarray]:
    """Largest |relative error| of the shipped closed forms for every design, by what errs; NaN if
    unknown.
    """
    s = section(rows)
    found = strain_fit.errors(rows, s, strain_data()) if "solid_fillet_strain" in rows else {}
    worst = {name: np.fmax.reduce([np.abs(a) for a in arrays]) for name, arrays in found.items()}
    if "width_factor" in rows:
        truth = rows["plane_stiffness"] * rows["width"] * rows["width_factor"]
        worst["K"] = np.abs(1.0 / (ladder.compliance(s, "solid") * truth) - 1.0)
    return worst


def targets() -> list[Target]:
    kinds = [("K", i) for i in range(len(accuracy.accuracy_data()["zones"]))]
    zones = enumerate(strain_data()["zones"])
    return kinds + [(name, i) for i, zone in zones for name, worst in zone["worst"].items() if worst]


def in_zone(target: Target, s: HingeSection) -> np.ndarray:
    """Which designs lie in the target's zone and in the range of rung solid."""
    what, i = target
    zone = (accuracy.accuracy_data() if what == "K" else strain_data())["zones"][i]
    inside = accuracy.in_zone(zone, validity.groups(s), s.two_sided)
    return np.asarray(inside & validity.within(s, "solid"))


def stated(target: Target) -> float:
    what, i = target
    return float(
        accuracy.accuracy_data()["zones"][i]["promised"]["solid"]
        if what == "K"
        else strain_data()["zones"][i]["stated"][what]
    )


def affordable(s: HingeSection) -> bool:
    across = max(1.0, math.log1p(0.8 * float(s.width / s.hinge_thickness)) / math.log(1.8))
    return len(plane_mesh(reference_shape(s), 1).cells) * across <= CELLS


def start() -> Columns:
    """All committed designs inside the range of rung solid."""
    tables = [t for kind, t in samples.shipped().items() if kind != samples.CLIMBED]
    tables += strain_fit.shipped_samples().values()
    tables = [samples.with_width_factor(t) if "solid_mesh_2" in t else t for t in tables]
    known = [taken(t, validity.within(section(t), "solid")) for t in tables]
    return joined(known)


def varied(parent: Row, way: dict[str, float], rng: np.random.Generator, target: Target) -> Row | None:
    """Another design of the target's zone, as far from `parent` as the zone lets it; None if it stays."""
    sigma = math.exp(rng.uniform(*np.log(STEP)))
    chosen = rng.random(len(SIZES)) < rng.choice([0.2, 0.5, 1.0])
    step = np.where(chosen, rng.normal(0.0, sigma, len(SIZES)), 0.0)
    step += rng.uniform(0.0, OVER) * np.array([way.get(name, 0.0) for name in SIZES])
    along = 0.5 ** np.arange(HALVINGS)
    tried = {name: parent[name] * np.exp(step[i] * along) for i, name in enumerate(SIZES)}
    tried["two_sided"] = np.full(HALVINGS, parent["two_sided"])
    # exactly as the file holds them
    tried = {name: np.array([float(f"{v:.8g}") for v in values]) for name, values in tried.items()}
    inside = np.flatnonzero(in_zone(target, section(tried)))
    if not step.any() or not len(inside):
        return None
    row = {name: float(values[inside[0]]) for name, values in tried.items()}
    one = section({name: np.array([value]) for name, value in row.items()}).rows(0)
    return row if affordable(one) else None


def climb(known: Columns, seed: int, goals: list[Target]) -> Iterator[tuple[Target, float, Row | None]]:
    """Tries without end, of one goal after the other: the goal, the try's error, and the solved design if its
    error exceeds all known ones."""
    rng = np.random.default_rng(seed)
    best: dict[Target, tuple[float, Row]] = {}
    ways: dict[Target, dict[str, float]] = {}
    found, s = errors(known), section(known)
    for goal in goals:
        error = np.where(in_zone(goal, s), found[goal[0]], np.nan)
        if np.isfinite(error).any():
            i = int(np.nanargmax(error))
            best[goal] = float(error[i]), {name: float(values[i]) for name, values in known.items()}
    while True:
        for goal in [g for g in goals if g in best]:
            error, parent = best[goal]
            design = varied(parent, ways.get(goal, {}), rng, goal)
            if design is None:
                continue
            one = {name: np.array([value]) for name, value in design.items()}
            try:
                row = design | solved(section(one).rows(0))
            except (ValueError, RuntimeError):  # a mesh that cannot follow it
                continue
            table = {name: np.array([float(f"{value:.8g}")]) for name, value in row.items()}
            errs, at, raised = errors(table), section(table), False
            for other in goals:  # a solved design may be the worst of several
                e = float(errs[other[0]][0])
                if other in best and e > best[other][0] and bool(in_zone(other, at)[0]):
                    before = best[other][1]
                    ways[other] = {name: math.log(row[name] / before[name]) for name in SIZES}
                    best[other], raised = (e, row), True
            if not raised:
                ways.pop(goal, None)
            yield goal, float(errs[goal[0]][0]), row if raised else None


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("file", type=Path, help="the designs found, and where new ones are added")
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--seed", type=int, default=SEED)
    asked = parser.parse_args()
    begun, rows = time.monotonic(), list[Row]()
    for goal, error, row in climb(start(), asked.seed, targets()):
        if row is not None:
            print(f"{goal[0]}, zone {goal[1]}: {error:.4g} of {stated(goal):.4g}", flush=True)
            rows.append(row)
        if time.monotonic() - begun > asked.seconds:
            break
    if rows:
        known = [samples.load(asked.file)] if asked.file.exists() else []
        samples.write(joined([*known, samples.as_written(rows)]), asked.file)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
