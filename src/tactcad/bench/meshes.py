"""Every mesh density of the element rungs, as it is and as the rung takes it; CalculiX and CHOLMOD beside
them."""

from __future__ import annotations

import logging
import re
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from unittest.mock import patch

import numpy as np
from scipy.sparse import csc_matrix

from tactcad.design.messages import CheckFailure
from tactcad.design.present import present
from tactcad.fem import calculix, elasticity
from tactcad.fem.convergence import RATE, richardson
from tactcad.fem.mapped_mesh import plane_mesh
from tactcad.fem.plane_elements import solve_plane
from tactcad.fem.shape import ElementShape, reference_shape
from tactcad.fem.solid_elements import solve_solid

from . import truth
from .bench_tables import table
from .front import efficient, told
from .run_plan import RunPlan
from .timing import interleaved

TITLE = "Mesh densities"
QUESTION = "Which mesh is fine enough, and how does it compare with CalculiX?"
ASKED = 1e-3  # error at which the codes are compared
GOAL_SOLVE = 0.1  # of CalculiX's time for a plane problem at that error

Answer = tuple[float, int]


@dataclass(frozen=True)
class Solver:
    """One way to solve an element; `solve` gives stiffness (unit modulus) and the number of unknowns."""

    code: str
    elements: str
    density: int
    solve: Callable[[ElementShape, float, float], Answer]


def cases(plan: RunPlan) -> list[Solver]:
    plane, solid = plan.of((1, 2), (1, 2, 3, 4, 6), (1, 2, 3, 4, 6, 8)), plan.of((1,), (1, 2), (1, 2, 3))
    solvers = [Solver("tactcad", "plane", d, partial(_plane, d)) for d in plane]
    solvers += [
        Solver("tactcad", "plane, two meshes", d, partial(_extrapolated, d)) for d in plane if d % 2 == 0
    ]
    solvers += [Solver("tactcad", "solid", d, partial(_solid, d)) for d in solid]
    solvers += [Solver("tactcad", "solid, corrected", d, partial(_corrected, d)) for d in solid]
    if calculix.executable():
        solvers += [
            Solver("CalculiX", "plane", d, partial(_ccx_plane, d, plan.folder))
            for d in plan.of((1,), (1, 2, 3, 4), (1, 2, 3, 4, 6))
        ]
        solvers += [
            Solver("CalculiX", "solid", d, partial(_ccx_solid, d, plan.folder))
            for d in plan.of((), (1,), (1, 2))
        ]
    if _cholmod():
        solvers += [Solver("CHOLMOD", "solid", d, partial(_with_cholmod, d)) for d in solid]
    return solvers


def measure(plan: RunPlan) -> dict:
    logging.getLogger("skfem").setLevel(logging.ERROR)  # it warns about the order of arrays in memory
    fine = truth.of_run(plan)
    count = plan.of(2, 4, 12)
    known = zip(truth.sections(fine), fine["plane_stiffness"] * fine["width"], truth.solid_stiffness(fine))
    designs = [
        (reference_shape(one), float(one.poisson), float(one.width), flat, solid)
        for one, flat, solid in known
        if np.isfinite(solid)
    ][:count]
    rows = []
    for case in cases(plan):
        plan.say(f"{case.code}, {case.elements}, density {case.density}")
        rows.append(_error(case, designs))
    plan.say("times, in turns")
    shape, nu, width = designs[0][:3]
    actions = {i: partial(case.solve, shape, nu, width) for i, case in enumerate(cases(plan))}
    timed = interleaved(actions, plan.of(1, 2, 5))
    for i, row in enumerate(rows):
        row |= vars(timed[i])
    for against in ("plane", "solid"):
        group = [row for row in rows if row["against"] == against]
        best = efficient([(row["seconds"], row["worst"]) for row in group])
        for i, row in enumerate(group):
            row["front"] = i in best
    if calculix.executable():
        for row, own in zip(rows, [_own_clock(case, designs[0], plan.folder) for case in cases(plan)]):
            row["own clock"] = own
    columns = (
        "code; elements; density; unknowns; mean: mean error [%]; worst: worst error [%]; "
        "seconds: time [ms]; median [ms]; own clock: its own clock [ms]; front: on the front"
    )
    note = (
        f"Errors over {len(designs)} designs against converged elements of their own kind; unknowns and "
        "times of the two-sided reference "
        "element. CalculiX: a whole process, its only form, and the time that it reports itself."
    )
    missing = [] if calculix.executable() else ["CalculiX (ccx) is not installed: not compared."]
    missing += [] if _cholmod() else ["CHOLMOD (scikit-sparse) is not installed: all systems by SuperLU."]
    return {
        "tables": {"meshes": table(TITLE, columns, rows, note)},
        "findings": findings(rows),
        "missing": missing,
    }


def _error(case: Solver, designs: list[tuple]) -> dict:
    against = "plane" if case.elements.startswith("plane") else "solid"
    unknowns, errors = 0, []
    for shape, nu, width, plane, solid in designs:
        stiffness, count = case.solve(shape, nu, width)
        unknowns = unknowns or count
        errors.append(abs(stiffness / (plane if against == "plane" else solid) - 1.0))
    return {
        "code": case.code,
        "elements": case.elements,
        "against": against,
        "density": case.density,
        "unknowns": unknowns,
        "mean": float(np.mean(errors)),
        "worst": float(np.max(errors)),
        "designs": len(errors),
    }


def findings(rows: list[dict]) -> list[str]:
    lines = []
    for against, title in (("plane", "Plane stress"), ("solid", "Three dimensions")):
        group = [r for r in rows if r["against"] == against]
        names = [
            f"{'' if r['code'] == 'tactcad' else r['code'] + ' '}{r['elements'].replace(',', '')} at "
            f"{r['density']}"
            for r in group
        ]
        lines.append(f"{title}. " + told(names, [(r["seconds"], r["worst"]) for r in group]))
    ours, theirs = (_cheapest(rows, code) for code in ("tactcad", "CalculiX"))
    if ours and theirs:
        ratio = ours["seconds"] / theirs["own clock"]
        lines.append(
            f"{'met' if ratio <= GOAL_SOLVE else 'MISSED'}: plane elements within {100 * ASKED:g} %: "
            f"{1e3 * ours['seconds']:.1f} ms (density {ours['density']}) against CalculiX's own "
            f"{1e3 * theirs['own clock']:.0f} ms (density {theirs['density']}), {ratio:.2f} of its time "
            f"(goal {GOAL_SOLVE:g}); {1e3 * theirs['seconds']:.0f} ms as a process."
        )
    return lines


def _cheapest(rows: list[dict], code: str) -> dict | None:
    """The quickest plane mesh of a code within the asked error."""
    fit = [r for r in rows if r["code"] == code and r["elements"] == "plane" and r["worst"] <= ASKED]
    return min(fit, key=lambda r: r["seconds"], default=None)


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
    stiffness, unknowns = _solid(density, shape, nu, width)
    limit, _ = _extrapolated(6, shape, nu, width)
    return stiffness * limit / _plane(density, shape, nu, width)[0], unknowns


def _ccx_plane(density: int, folder: Path, shape: ElementShape, nu: float, width: float) -> Answer:
    stiffness = calculix.plane_stiffness(plane_mesh(shape, density), 1.0, nu, width, folder)
    return stiffness, 2 * _nodes(folder / "plane.inp")


def _ccx_solid(density: int, folder: Path, shape: ElementShape, nu: float, width: float) -> Answer:
    solution = calculix.solve_solid(plane_mesh(shape, density), 1.0, nu, width, 1, folder)
    return solution.stiffness, solution.unknowns


def _nodes(path: Path) -> int:
    return path.read_text("ascii").split("*ELEMENT")[0].count("\n") - 1


def _own_clock(case: Solver, design: tuple, folder: Path) -> float | None:
    """Seconds that CalculiX itself reports: its process without starting up."""
    if case.code != "CalculiX":
        return None
    case.solve(*design[:3])  # its input file lies in the folder now
    run = subprocess.run(
        [str(calculix.executable()), "-i", case.elements],
        cwd=folder,
        capture_output=True,
        text=True,
        check=True,
    )
    match = re.search(r"Total CalculiX Time:\s*([0-9.]+)", run.stdout)
    if not match:
        raise CheckFailure("CalculiX did not report its time")
    return float(match[1])


def _cholmod() -> Callable | None:
    try:
        from sksparse.cholmod import cholesky
    except ImportError:
        return None
    return cholesky


def _with_cholmod(density: int, shape: ElementShape, nu: float, width: float) -> Answer:
    """Solid elements with every system solved by CHOLMOD."""
    cholesky = present(_cholmod())

    def other(A: csc_matrix, f: np.ndarray, fixed: np.ndarray) -> np.ndarray:
        free = np.setdiff1d(np.arange(len(f)), fixed)
        u = np.zeros_like(f)
        u[free] = cholesky(A[free][:, free].tocsc())(f[free])
        return u

    with patch.object(elasticity, "solve", other):
        return _solid(density, shape, nu, width)
