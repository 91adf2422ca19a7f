"""Benchmarks of stiffness: rungs of the ladder and mesh densities, against converged finite elements.

The reference is finer than any rung. Plane stress: Richardson's limit from densities 6 and 12, while the rung
takes 3 and 6. Three dimensions: that limit times K3D/K2D on one plane mesh (both have the same relative error
at the fillets), by Richardson's limit from densities 2 and 3, with the change that a second layer across the
width makes.
"""

from __future__ import annotations

import logging
import math
import re
import subprocess
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from unittest.mock import patch

import calculix
import numpy as np
import samples
from measuring import RunPlan, benchmark, interleaved
from samples import BOX, DATA, Columns, Row, draw_box, draw_edges, joined, section, taken
from scipy.sparse import csc_matrix
from tables import efficient, goal, table, told

from tactcad.design.messages import CheckFailure
from tactcad.fem import elasticity
from tactcad.fem.elements import solve_plane, solve_solid
from tactcad.fem.fem_ladder import RATE, richardson, stiffness
from tactcad.fem.mapped_mesh import plane_mesh
from tactcad.fem.shape import ElementShape, reference_shape
from tactcad.mechanics import ladder, register
from tactcad.mechanics.section import REFERENCE, HingeSection
from tactcad.report.figures import sig

try:
    from sksparse.cholmod import cholesky
except ImportError:
    cholesky = None

DENSITIES, SOLID_DENSITIES = (6, 12), (2, 3)
FACTOR_ORDER = 2.5  # of K3D/K2D: seen on densities 2, 3 and 4 of the envelope's thickest and shortest hinge
ORDERS_SEEN = (2.0, 4.0)  # over the envelope, on densities 1, 2 and 3; the other differences are far smaller
EDGES = 4  # one design of so many lies on the envelope's edges
TRUTH = "bench-truth.csv"
FULL_DESIGNS, FULL_SOLIDS = 120, 40  # random designs of a full run, and how many of all are solved as solids
GOAL_MILLION = 0.3  # s for a million designs by a closed form on one core
ASKED = 1e-3  # error at which the codes are compared
GOAL_SOLVE = 0.1  # of CalculiX's time for a plane problem at that error

Answer = tuple[float, int]

logging.getLogger("skfem").setLevel(logging.ERROR)  # it warns about the order of arrays in memory


# --- the reference ---


def truth(plan: RunPlan) -> Columns:
    """Designs and results for a run: in mode full solved anew, once, on designs of this run's seed; else the
    committed ones."""
    if plan.mode != "full":
        return samples.load(DATA / TRUTH)
    path = plan.folder / TRUTH
    if not path.is_file():
        plan.say("converged elements")
        drawn = designs(FULL_DESIGNS, plan.seed)
        solved = samples.solved(drawn, lambda i, s: converged(s, i < FULL_SOLIDS), "converged elements")
        samples.write(solved, path)
    return samples.load(path)


def designs(count: int, seed: int) -> Columns:
    """The two reference elements, and `count` random ones of the envelope, some of them on its edges."""
    both = {k: np.full(2, float(getattr(REFERENCE, k))) for k in BOX} | {"two_sided": np.array([1.0, 0.0])}
    edges = count // EDGES
    tables = [both, draw_box(count - edges, seed), draw_edges(edges, seed + 1)]
    order = np.concatenate([[0, 1], 2 + np.random.default_rng(seed).permutation(count)])
    return taken(joined(tables), order)


def converged(s: HingeSection, as_solid: bool) -> Row:
    """Stiffness of unit width and modulus, and K3D/K2D, NaN if not wanted; each with its estimated relative
    error: by how much the limit differs from the finer mesh; half of what the choice of the order may
    change."""
    shape, nu, b = reference_shape(s), float(s.poisson), float(s.width)
    coarse, fine = (solve_plane(shape, 1.0, nu, 1.0, density=d).compliance for d in DENSITIES)
    limit = richardson((coarse, fine), DENSITIES, RATE)
    row = {"plane_stiffness": 1.0 / limit, "plane_error": abs(limit / fine - 1.0)}
    if not as_solid:
        return row | {"width_factor": math.nan, "width_error": math.nan}

    def factor(density: int, across: int) -> float:
        flat = solve_plane(shape, 1.0, nu, b, density=density).compliance
        return flat / solve_solid(shape, 1.0, nu, b, density=density, across=across).compliance

    pair = (factor(SOLID_DENSITIES[0], 1), factor(SOLID_DENSITIES[1], 1))
    layers = factor(SOLID_DENSITIES[0], 2) - pair[0]
    value = richardson(pair, SOLID_DENSITIES, FACTOR_ORDER) + layers
    least, most = (richardson(pair, SOLID_DENSITIES, p) for p in ORDERS_SEEN)
    return row | {"width_factor": value, "width_error": abs(least - most) / 2.0 / value}


def plane_of(columns: Columns) -> np.ndarray:
    """K in plane stress, of unit modulus, at the design's width."""
    return columns["plane_stiffness"] * columns["width"]


def solid_of(columns: Columns) -> np.ndarray:
    """K of unit modulus; NaN if no solid was solved."""
    return plane_of(columns) * columns["width_factor"]


# --- rungs ---


@benchmark(
    "rungs",
    "Rungs of the model ladder",
    "How wrong is each rung against converged finite elements, and what does it cost?",
    kernel=False,
)
def rungs(plan: RunPlan) -> dict:
    held_out, fine = samples.shipped_table("held out"), truth(plan)
    rows = [_closed_form(rung, joined([held_out, fine])) for rung in ladder.CLOSED_FORMS]
    rows += [
        _elements("fem-plane", fine, plan, plan.of(1, 20, 120)),
        _elements("fem-solid", fine, plan, plan.of(1, 4, 40)),
    ]
    seconds = _times(plan)
    for row in rows:
        row |= seconds[row["rung"]] | {"when": register.rungs()[row["rung"]].when}
        row["time ratio"] = row["seconds"] / seconds[ladder.DEFAULT_RUNG]["seconds"]
    columns = (
        "rung; solid mean: solid: mean error [%]; solid worst: worst [%]; solid designs: designs; plane "
        "mean: plane stress: mean error [%]; plane worst: worst [%]; plane designs: designs; seconds: time "
        "per element [us]; median [us]; alone: one element alone [us]; time ratio: time over solid's"
    )
    worst = max(float(np.nanmax(fine["plane_error"])), float(np.nanmax(fine["width_error"])))
    note = (
        "Errors of stiffness against converged elements, in three dimensions and in plane stress. These are "
        f"themselves within about {worst:.1g} on the {len(fine['width'])} designs solved for this (largest "
        "estimate), within 1e-4 on the held-out ones; no error of finite elements smaller than that estimate "
        "is claimed."
    )
    by = {row["rung"]: row for row in rows}
    slowest = max(by[r]["seconds"] for r in ladder.CLOSED_FORMS) * 1e6
    default, plane, solid = by["solid"], by["fem-plane"], by["fem-solid"]
    findings = [
        "Against solid elements: "
        + told([r["rung"] for r in rows], [(r["seconds"], r["solid worst"]) for r in rows]),
        goal(
            f"a million designs by the slowest closed form in {slowest:.2f} s (goal {GOAL_MILLION} s).",
            slowest <= GOAL_MILLION,
        ),
        f"The solid rung errs by {100 * default['solid worst']:.2f} % at worst, fem-plane by "
        f"{100 * plane['solid worst']:.0f} % at {sig(plane['seconds'] / default['seconds'], 2)} times the "
        "time: for a real sheet plane elements are dominated by a closed form.",
        f"fem-solid errs by {sig(100 * solid['solid worst'], 2)} % at worst, at "
        f"{sig(solid['seconds'] / default['seconds'], 2)} times the solid rung's time.",
    ]
    return {"tables": {"rungs": table(columns, rows, note)}, "findings": findings}


def errors(K: np.ndarray, exact: np.ndarray, label: str, own: np.ndarray | float = 0.0) -> dict:
    """Mean and worst size of the relative error, over the designs that have a result; none smaller than the
    `own` estimated error of the reference."""
    error = np.maximum(np.abs(K / exact - 1.0), own)
    error = error[np.isfinite(error)]
    mean, worst = (float(error.mean()), float(error.max())) if len(error) else (None, None)
    return {f"{label} mean": mean, f"{label} worst": worst, f"{label} designs": len(error)}


def _closed_form(rung: str, columns: Columns) -> dict:
    K = ladder.evaluate(section(columns), rung).stiffness
    row = {"rung": rung} | errors(K, solid_of(columns), "solid")
    # what models the width is not comparable with plane stress
    return row if register.rungs()[rung].against == "solid" else row | errors(K, plane_of(columns), "plane")


def _elements(rung: str, fine: Columns, plan: RunPlan, count: int) -> dict:
    K, s = np.full(len(fine["width"]), np.nan), section(fine)
    for i in range(min(count, len(K))):
        plan.say(f"{rung}, design {i + 1} of {count}")
        K[i] = stiffness(s.rows(i), rung)
    flat = fine["plane_error"]
    row = {"rung": rung} | errors(K, solid_of(fine), "solid", flat + fine["width_error"])
    return row | (errors(K, plane_of(fine), "plane", flat) if rung == "fem-plane" else {})


def _times(plan: RunPlan) -> dict[str, dict]:
    """Seconds per element: closed forms among many, element rungs one after the other."""
    many = section(draw_box(plan.of(1_000, 20_000, 200_000), plan.seed))
    few = [many.rows(i) for i in range(plan.of(1, 3, 10))]
    plan.say("times, in turns")
    closed: dict[Hashable, Callable] = {r: partial(ladder.stiffness, many, r) for r in ladder.CLOSED_FORMS}
    closed |= {("alone", r): partial(ladder.stiffness, few[0], r) for r in ladder.CLOSED_FORMS}
    elements = {r: lambda r=r: [stiffness(one, r) for one in few] for r in ladder.FINITE_ELEMENTS}
    per = dict.fromkeys(ladder.CLOSED_FORMS, many.shape[0]) | dict.fromkeys(ladder.FINITE_ELEMENTS, len(few))
    timed = interleaved(closed, plan.of(1, 5, 9)) | interleaved(elements, plan.of(1, 2, 3))
    return {
        r: {
            "seconds": timed[r].seconds / n,
            "median": timed[r].median / n,
            "runs": timed[r].runs,
            "alone": timed["alone", r].seconds if ("alone", r) in timed else timed[r].seconds / n,
        }
        for r, n in per.items()
    }


# --- meshes ---


@dataclass(frozen=True)
class Solver:
    """One way to solve an element; `solve` gives stiffness (unit modulus) and the number of unknowns."""

    code: str
    elements: str
    density: int
    solve: Callable[[ElementShape, float, float], Answer]

    @property
    def against(self) -> str:
        return "plane" if self.elements.startswith("plane") else "solid"


def cases(plan: RunPlan) -> list[Solver]:
    plane, solid = plan.of((1, 2), (1, 2, 3, 4, 6), (1, 2, 3, 4, 6, 8)), plan.of((1,), (1, 2), (1, 2, 3))
    even = tuple(d for d in plane if d % 2 == 0)
    ways = [
        ("tactcad", "plane", plane, _plane),
        ("tactcad", "plane, two meshes", even, _extrapolated),
        ("tactcad", "solid", solid, _solid),
        ("tactcad", "solid, corrected", solid, _corrected),
    ]
    if calculix.executable():
        flat, thick = plan.of((1,), (1, 2, 3, 4), (1, 2, 3, 4, 6)), plan.of((), (1,), (1, 2))
        ways += [
            ("CalculiX", "plane", flat, partial(_ccx_plane, plan.folder)),
            ("CalculiX", "solid", thick, partial(_ccx_solid, plan.folder)),
        ]
    if cholesky:
        ways.append(("CHOLMOD", "solid", solid, _with_cholmod))
    return [Solver(code, elements, d, partial(way, d)) for code, elements, some, way in ways for d in some]


@benchmark(
    "meshes",
    "Mesh densities",
    "Which mesh is fine enough, and how does it compare with CalculiX?",
    kernel=False,
)
def meshes(plan: RunPlan) -> dict:
    fine = truth(plan)
    fine = taken(fine, np.flatnonzero(np.isfinite(fine["width_factor"]))[: plan.of(2, 4, 12)])
    s, exact = section(fine), {"plane": plane_of(fine), "solid": solid_of(fine)}
    known = [
        (reference_shape(one), float(one.poisson), float(one.width)) for one in map(s.rows, range(s.shape[0]))
    ]
    solvers, rows = cases(plan), []
    for case in solvers:
        plan.say(f"{case.code}, {case.elements}, density {case.density}")
        answers = [case.solve(*design) for design in known]
        error = np.abs(np.array([K for K, _ in answers]) / exact[case.against] - 1.0)
        rows.append(
            {"code": case.code, "elements": case.elements, "against": case.against, "density": case.density}
            | {"unknowns": answers[0][1], "mean": float(error.mean()), "worst": float(error.max())}
            | {"designs": len(error)}
        )
    plan.say("times, in turns")
    timed = interleaved({c: partial(c.solve, *known[0]) for c in solvers}, plan.of(1, 2, 5))
    for case, row in zip(solvers, rows):
        row |= vars(timed[case])
        if case.code == "CalculiX":
            case.solve(*known[0])  # its input file lies in the folder now
            row["own clock"] = _own_clock(case.elements, plan.folder)
    for against in ("plane", "solid"):
        group = [row for row in rows if row["against"] == against]
        best = efficient([(row["seconds"], row["worst"]) for row in group])
        for i, row in enumerate(group):
            row["front"] = i in best
    columns = (
        "code; elements; density; unknowns; mean: mean error [%]; worst: worst error [%]; "
        "seconds: time [ms]; median [ms]; own clock: its own clock [ms]; front: on the front"
    )
    note = (
        f"Errors over {len(known)} designs against converged elements of their own kind; unknowns and "
        "times of the two-sided reference "
        "element. CalculiX: a whole process, its only form, and the time that it reports itself."
    )
    missing = [] if calculix.executable() else ["CalculiX (ccx) is not installed: not compared."]
    missing += [] if cholesky else ["CHOLMOD (scikit-sparse) is not installed: all systems by SuperLU."]
    return {
        "tables": {"meshes": table(columns, rows, note)},
        "findings": _mesh_findings(rows),
        "missing": missing,
    }


def _mesh_findings(rows: list[dict]) -> list[str]:
    found = []
    for against, title in (("plane", "Plane stress"), ("solid", "Three dimensions")):
        group = [r for r in rows if r["against"] == against]
        names = [
            f"{'' if r['code'] == 'tactcad' else r['code'] + ' '}{r['elements'].replace(',', '')} at "
            f"{r['density']}"
            for r in group
        ]
        found.append(f"{title}. " + told(names, [(r["seconds"], r["worst"]) for r in group]))
    plane = [r for r in rows if r["elements"] == "plane" and r["worst"] <= ASKED]
    ours, theirs = (
        min((r for r in plane if r["code"] == code), key=lambda r: r["seconds"], default=None)
        for code in ("tactcad", "CalculiX")
    )
    if ours and theirs:
        ratio = ours["seconds"] / theirs["own clock"]
        words = (
            f"plane elements within {100 * ASKED:g} %: "
            f"{1e3 * ours['seconds']:.1f} ms (density {ours['density']}) against CalculiX's own "
            f"{1e3 * theirs['own clock']:.0f} ms (density {theirs['density']}), {ratio:.2f} of its time "
            f"(goal {GOAL_SOLVE:g}); {1e3 * theirs['seconds']:.0f} ms as a process."
        )
        found.append(goal(words, ratio <= GOAL_SOLVE))
    return found


def _plane(density: int, shape: ElementShape, nu: float, width: float) -> Answer:
    solution = solve_plane(shape, 1.0, nu, width, density=density)
    return solution.stiffness, solution.unknowns


def _extrapolated(density: int, shape: ElementShape, nu: float, width: float) -> Answer:
    """Richardson's limit from this density and half of it, as fem-plane takes it from 6 and 3."""
    coarse, fine = (solve_plane(shape, 1.0, nu, width, density=d) for d in (density // 2, density))
    limit = richardson((coarse.compliance, fine.compliance), (density // 2, density), RATE)
    return 1.0 / limit, fine.unknowns


def _solid(density: int, shape: ElementShape, nu: float, width: float) -> Answer:
    solution = solve_solid(shape, 1.0, nu, width, density=density, across=1)
    return solution.stiffness, solution.unknowns


def _corrected(density: int, shape: ElementShape, nu: float, width: float) -> Answer:
    """The solid with the plane problem's error on the same mesh removed, as fem-solid does."""
    K, unknowns = _solid(density, shape, nu, width)
    limit, _ = _extrapolated(6, shape, nu, width)
    return K * limit / _plane(density, shape, nu, width)[0], unknowns


def _ccx_plane(folder: Path, density: int, shape: ElementShape, nu: float, width: float) -> Answer:
    K = calculix.plane_stiffness(plane_mesh(shape, density), 1.0, nu, width, folder)
    nodes = (folder / "plane.inp").read_text("ascii").split("*ELEMENT")[0].count("\n") - 1
    return K, 2 * nodes


def _ccx_solid(folder: Path, density: int, shape: ElementShape, nu: float, width: float) -> Answer:
    solution = calculix.solve_solid(plane_mesh(shape, density), 1.0, nu, width, 1, folder)
    return solution.stiffness, solution.unknowns


def _own_clock(name: str, folder: Path) -> float:
    """Seconds that CalculiX itself reports: its process without starting up."""
    command = [str(calculix.executable()), "-i", name]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    match = re.search(r"Total CalculiX Time:\s*([0-9.]+)", run.stdout)
    if not match:
        raise CheckFailure("CalculiX did not report its time")
    return float(match[1])


def _with_cholmod(density: int, shape: ElementShape, nu: float, width: float) -> Answer:
    """Solid elements with every system solved by CHOLMOD."""

    def other(A: csc_matrix, f: np.ndarray, fixed: np.ndarray) -> np.ndarray:
        free = np.setdiff1d(np.arange(len(f)), fixed)
        u = np.zeros_like(f)
        u[free] = cholesky(A[free][:, free].tocsc())(f[free])
        return u

    with patch.object(elasticity, "solve", other):
        return _solid(density, shape, nu, width)
