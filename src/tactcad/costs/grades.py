"""Methods as grades: each one's promised error, and its cost on this machine.

Checks and exports by meshing: the error of a part's volume. Builds and syntheses by the number of arrays: the
half-width of the yield's interval. Rungs of the ladder: the error of K; closed forms answer at once, so only
elements have seconds. Counted from the description; the kernel is not loaded.

`data/costs.json` is written by benchmarks/costs.py, in processor seconds of the machine that it names, with
that machine's calibration; this machine's, kept in the cache, scales them.
"""

from __future__ import annotations

import json
import platform
import re
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tactcad.design.allowance import Grade
from tactcad.design.family import family_of
from tactcad.design.tree import CommonTables
from tactcad.export.cache import Cache, default_root
from tactcad.export.inputs import digest
from tactcad.fem.mapped_mesh import layers, plane_mesh
from tactcad.fem.shape import reference_shape
from tactcad.mechanics.accuracy import (
    CANDIDATES,
    MEASURED_FOR,
    Candidate,
    accuracy_data,
    expected_error,
    zones,
)
from tactcad.mechanics.register import rungs
from tactcad.mechanics.section import Array, HingeSection
from tactcad.mechanics.validity import reasons
from tactcad.parts.language.description import Part
from tactcad.scenes import make_scene
from tactcad.solids import USUAL, Meshing

ANGULAR = (1.0, 0.5, 0.35, 0.2, 0.1, 0.05, 0.02)  # rad, largest turn between facets; 0.2 is the usual
COUNTS = tuple(first * 10**power for power in range(2, 6) for first in (1, 2, 5)) + (1_000_000,)  # arrays
YIELD = "half of the yield's 95 % interval"
VOLUME = "each meshed volume"
SIZED = 64  # designs whose meshes are counted, evenly taken from all; a count takes a millisecond
DATA = Path(__file__).parent / "data" / "costs.json"
# Of the calibration, some 10 ms each (chosen): values and sweeps of numpy, turns of a loop, equations.
TABLE, SWEEPS, LOOP, EQUATIONS = 10_000, 200, 400_000, 800
REPEATS = 5  # the shortest counts: disturbances only add time
KEPT = 24 * 3600.0  # s; chosen: a machine that was slow for hours is measured again the next day


def check_grades(checked: Sequence[tuple[CommonTables, Sequence[str]]]) -> list[Grade]:
    """Every check of these designs' scenes, the parts meshed by ANGULAR."""
    fixed = published()["check"]["start"]
    counted = [counts(*each) for each in checked]
    base = fixed + sum(linear(published()["check"], c) - fixed for c, _ in counted)
    parts = [part for _, some in counted for part in some]
    usual = _meshing_seconds(parts, USUAL.angular)
    return [_meshed(a, base - usual + _meshing_seconds(parts, a)) for a in ANGULAR]


def export_grades(
    design: CommonTables, scenes: Sequence[str], drawings: bool = False, guides: bool = False
) -> list[Grade]:
    """An export with an empty cache, including STL of the parts made, meshed by ANGULAR."""
    count, parts = counts(design, scenes)
    made = [part for part in parts if not part.bought]
    base = linear(published()["export"], count)
    base += drawings * linear(published()["drawings"], count) + guides * linear(published()["guides"], count)
    return [_meshed(a, base + _meshing_seconds(made, a)) for a in ANGULAR]


def meshing_of(grade: Grade) -> Meshing:
    """The meshing of a grade."""
    return next(Meshing(a, grade.error) for a in ANGULAR if _triangles(a) == grade.name)


def counts(design: CommonTables, scenes: Sequence[str]) -> tuple[Mapping[str, float], list[Part]]:
    """Numbers of elements, scenes, parts, parts made and placed parts; and the parts, each once."""
    made = [make_scene(design, name) for name in scenes]
    parts = list({part.part_no: part for scene in made for part in scene.parts}.values())
    numbers = {
        "element": len(family_of(design).layout(design).elements),
        "part": len(parts),
        "made": sum(not part.bought for part in parts),
        "place": sum(len(scene.placements) for scene in made),
    }
    return numbers, parts


def promised(angular: float) -> float:
    """Largest relative error of a part's volume: the largest measured share of w^2/24, a chord's of a turn w,
    with its margin."""
    return float(f"{published()['mesh']['share'] * angular**2 / 24.0:.2g}")


def _meshed(angular: float, seconds: float) -> Grade:
    return Grade(_triangles(angular), promised(angular), here(seconds))


def _triangles(angular: float) -> str:
    return f"triangles of {angular:g} rad"


def _meshing_seconds(parts: Sequence[Part], angular: float) -> float:
    """Seconds of meshing by each part's features: a face with many holes costs more than as many faces."""
    features = np.array([1.0 + len(part.features) for part in parts])
    return float(power_law(published()["mesh"]["seconds"][f"{angular:g}"], features).sum())


def build_grades(design: CommonTables) -> list[Grade]:
    """`tactcad build` of so many arrays of each distribution, its stack included."""
    elements = {"element": len(family_of(design).layout(design).elements)}
    return _built(linear(published()["build"], elements), linear(published()["array"], elements))


def yield_grades() -> list[Grade]:
    """`tactcad design` by the arrays made for its yield; its time is the clock's."""
    return [Grade(grade.name, grade.error, None) for grade in _built(0.0, 0.0)]


def arrays_of(grade: Grade) -> int:
    """The number of arrays of a grade."""
    return next(count for count in COUNTS if _arrays(count) == grade.name)


def _built(fixed: float, each: float) -> list[Grade]:
    from tactcad.stacks.virtual_build import widest  # loads scipy

    return [Grade(_arrays(n), widest(n), here(fixed + n * each)) for n in COUNTS]


def _arrays(count: int) -> str:
    return f"{count} arrays"


def rung_grades(s: HingeSection) -> list[Grade]:
    """One candidate of `mechanics.accuracy` for all designs, each: the error of the worst one.

    Parameters
    ----------
    s
        One design or many, all where errors were measured (`accuracy.require_measured`).

    Returns
    -------
    list of Grade
        In the order of work, for `design.allowance.pick`.
    """
    count, each = int(np.prod(s.shape)), seconds_each(s)
    return [
        Grade(c.name, float(expected_error(s, c).max()), _by_elements(count * each[c] if c in each else 0.0))
        for c in CANDIDATES
    ]


def row_grades(s: HingeSection, within: float | None = None) -> list[Grade]:
    """A candidate for every design, its own: the one of least work that keeps an error, for every error that
    makes a difference.

    Parameters
    ----------
    s
        Many designs in a row; those without measured errors are left out.
    within
        The error asked for; designs without a candidate within it are also left out.

    Returns
    -------
    list of Grade
        Empty if all designs are left out.
    """
    inside = np.flatnonzero(reasons(s, MEASURED_FOR).ravel() == "")
    zone = zones(s).ravel()[inside]
    data = accuracy_data()["zones"]
    promised = {z: [data[z]["promised"][c.name] for c in CANDIDATES] for z in np.unique(zone).tolist()}
    promised = {z: errors for z, errors in promised.items() if within is None or min(errors) <= within}
    counts = {z: int((zone == z).sum()) for z in promised}
    each = {z: seconds_each(s.rows(inside[zone == z])) for z in promised}
    least = max((min(errors) for errors in promised.values()), default=0.0)
    levels = sorted({e for errors in promised.values() for e in errors if e >= least}, reverse=True)
    grades = []
    for level in levels:
        taken = {z: next(i for i, e in enumerate(errors) if e <= level) for z, errors in promised.items()}
        by = {c: sum(counts[z] for z, i in taken.items() if CANDIDATES[i] == c) for c in CANDIDATES}
        seconds = sum(counts[z] * each[z].get(CANDIDATES[i], 0.0) for z, i in taken.items())
        names = [
            f"{c.name} for {n}" if len(taken) > 1 and n < len(zone) else c.name for c, n in by.items() if n
        ]
        error = max(promised[z][i] for z, i in taken.items())
        grades.append(Grade(" and ".join(names), error, _by_elements(seconds)))
    return grades


def _by_elements(seconds: float) -> float | None:
    """Seconds of a command by elements on this machine; None without any, since closed forms answer at
    once."""
    start = published()["start"]
    return here(start["numpy"] + start["elements"] + seconds) if seconds else None


def seconds_each(s: HingeSection) -> dict[Candidate, float]:
    """Seconds of one design by elements, mean over them, on the published machine."""
    sizes = mesh_sizes(s)
    return {
        c: float(power_law(published()["elements"][c.name], *sizes).mean())
        for c in CANDIDATES
        if not rungs()[c.rung].compliance
    }


def mesh_sizes(s: HingeSection) -> tuple[Array, Array]:
    """Elements of the coarsest mesh in the plane, and layers over half the width: of SIZED designs at most,
    evenly taken."""
    count = int(np.prod(s.shape))
    taken = np.unique(np.linspace(0, count - 1, min(count, SIZED)).round().astype(int))
    return tuple(np.array([_mesh_size(s.rows(int(i))) for i in taken], float).T)


def _mesh_size(one: HingeSection) -> tuple[int, int]:
    mesh = plane_mesh(reference_shape(one), order=1)
    return len(mesh.cells), len(layers(float(one.width) / 2.0, mesh.shape.hinge_thickness, 1)) - 1


@cache
def published() -> dict[str, Any]:
    """data/costs.json: s, and dimensionless exponents."""
    return json.loads(DATA.read_text("utf-8"))


@cache
def slowness() -> float:
    """This machine's seconds over the published machine's."""
    return calibrated() / published()["calibration_s"]


def here(seconds: float) -> float:
    """Published seconds as this machine's, to three digits."""
    return float(f"{slowness() * seconds:.3g}")


def power_law(fitted: Sequence[float], *sizes: NDArray[np.float64]) -> NDArray[np.float64]:
    """a x^p y^q ... from [a, p, q, ...]."""
    return fitted[0] * np.prod([x**p for x, p in zip(sizes, fitted[1:], strict=True)], axis=0)


def linear(fitted: Mapping[str, float], counts: Mapping[str, float]) -> float:
    """Sum of each count times its cost; `start` counts once."""
    return sum(each * counts.get(name, 1.0 if name == "start" else 0.0) for name, each in fitted.items())


def calibration() -> float:
    """Processor seconds that a fixed piece of work takes here: a table by numpy, a loop in Python, dense
    equations. Nothing of tactcad's own, which may become faster while other costs stay."""
    table = np.linspace(0.1, 1.0, TABLE)
    equations = np.diag(np.full(EQUATIONS, 2.0)) + np.tri(EQUATIONS) / EQUATIONS

    def once() -> float:
        start = time.process_time()
        values, total = table, 0
        for _ in range(SWEEPS):
            values = np.sqrt(np.sin(values) + table)
        for i in range(LOOP):
            total += i % 7
        np.linalg.solve(equations, table[:EQUATIONS])
        return time.process_time() - start

    return min(once() for _ in range(REPEATS))


def calibrated() -> float:
    """`calibration`, from the cache if it was measured here within a day."""
    cache = Cache(default_root())
    key = f"calibration {digest([processor(), np.__version__, TABLE, SWEEPS, LOOP, EQUATIONS])}"
    with suppress(TypeError, ValueError):  # absent, or another machine's
        seconds, at = json.loads(cache.get(key) or b"")
        if 0.0 <= time.time() - at <= KEPT and seconds > 0.0:
            return float(seconds)
    seconds = calibration()
    cache.put(key, json.dumps([seconds, time.time()]).encode())
    return seconds


def processor() -> str:
    """Its model."""
    info = Path("/proc/cpuinfo")
    match = re.search(r"model name\s*:\s*(.+)", info.read_text()) if info.is_file() else None
    return match[1].strip() if match else platform.processor() or platform.machine()
