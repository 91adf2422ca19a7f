"""Time and error of every rung on the same designs in one run; CalculiX beside them where it is installed.

    python benchmarks/ladder.py [--smoke] [--out FILE.json]

Errors are against converged elements of the same run (plane: Richardson from densities 6 and 12;
solid: fem-solid's corrected value on a finer mesh than the rung's). Times are the best of several, on
one thread. Goals are the project's; what falls short is printed as it is.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from datetime import date
from pathlib import Path

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402

from tactcad.fem import calculix, elasticity  # noqa: E402
from tactcad.fem.convergence import ORDER, converged_solid, richardson  # noqa: E402
from tactcad.fem.mesh import plane_mesh  # noqa: E402
from tactcad.fem.plane import solve_plane  # noqa: E402
from tactcad.fem.shape import reference_shape  # noqa: E402
from tactcad.fem.solid import solve_solid  # noqa: E402
from tactcad.mechanics import ladder  # noqa: E402
from tactcad.mechanics.section import REFERENCE, HingeSection  # noqa: E402
from tactcad.studies.fit_samples import draw_box, section  # noqa: E402

ERROR_ASKED = 1e-3  # at which element codes are compared
GOALS = {
    "closed forms, 1e6 designs": 0.3,  # s
    "plane elements over CalculiX, whole process": 0.1,
    "plane elements over CalculiX, solving alone": 0.1,
    "tactcad estimate over python -c 'import numpy'": 3.0,
}


def best(action: Callable[[], object], repeats: int) -> float:
    """Shortest of several runs, s."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return min(times)


def process(*args: str) -> Callable[[], object]:
    return lambda: subprocess.run([sys.executable, *args], check=True, capture_output=True)


def closed_forms(designs: int, repeats: int) -> list[dict]:
    """Stiffness of many designs of the box by every closed form, range checks included."""
    rng = np.random.default_rng(0)
    u = lambda low, high: rng.uniform(low, high, designs)  # noqa: E731
    hinge_length, fillet = u(0.6, 1.5), u(0.1, 0.3)
    s = HingeSection(
        u(0.15, 0.4),
        hinge_length,
        fillet,
        u(3, 7),
        u(1.5, 3),
        u(3, 8),
        u(2, 6),
        u(0.2, 0.4),
        69000.0,
        u(1.5, 8),
        rng.random(designs) < 0.5,
    )
    return [
        {"rung": rung, "designs": designs, "seconds": best(lambda: ladder.stiffness(s, rung), repeats)}  # noqa: B023
        for rung in ladder.CLOSED_FORMS
    ]


def accuracy(designs: int) -> list[dict]:
    """Worst and rms error of every closed form against converged elements, on fresh designs of the box."""
    s = section(draw_box(designs, seed=161803))
    truth = {"plane": [], "solid": []}
    for i in range(designs):
        one = s.rows(i)
        shape, nu, b = reference_shape(one), float(one.poisson), float(one.width)
        truth["plane"].append(converged(shape, nu, b))
        truth["solid"].append(converged_solid(shape, 1.0, nu, b).stiffness)
    rows = []
    for rung in ladder.CLOSED_FORMS:
        against = "solid" if rung == "solid" else "plane"
        error = ladder.stiffness(s, rung) / truth[against] - 1.0
        rows.append(
            {
                "rung": rung,
                "against": f"converged {against} elements",
                "designs": designs,
                "rms": float(np.sqrt(np.mean(error**2))),
                "max": float(np.abs(error).max()),
            }
        )
    return rows


def converged(shape, nu: float, width: float) -> float:
    pair = [solve_plane(shape, 1.0, nu, width, density=d).compliance for d in (6, 12)]
    return 1.0 / richardson((pair[0], pair[1]), (6, 12), ORDER)


def plane_meshes(densities: tuple[int, ...], repeats: int) -> list[dict]:
    rows = []
    for sides, shape in shapes():
        truth = converged(shape, 0.33, 1.0)
        for d in densities:
            solution = solve_plane(shape, 1.0, 0.33, 1.0, density=d)
            rows.append(
                {
                    "code": "tactcad",
                    "sides": sides,
                    "density": d,
                    "unknowns": solution.unknowns,
                    "error": solution.stiffness / truth - 1.0,
                    "seconds": best(lambda: solve_plane(shape, 1.0, 0.33, 1.0, density=d), repeats),  # noqa: B023
                }
            )
    return rows


def calculix_plane(densities: tuple[int, ...], repeats: int, folder: Path) -> list[dict]:
    """CalculiX's CPS8 on the same corner nodes. One design is one process: that is its only form."""
    rows = []
    for sides, shape in shapes():
        truth = converged(shape, 0.33, 1.0)
        for d in densities:
            mesh = plane_mesh(shape, d)
            K = calculix.plane_stiffness(mesh, 1.0, 0.33, 1.0, folder)
            rows.append(
                {
                    "code": "CalculiX",
                    "sides": sides,
                    "density": d,
                    "unknowns": 2 * _nodes(folder / "plane.inp"),
                    "error": K / truth - 1.0,
                    "seconds": best(lambda: calculix.run(folder / "plane.inp", np.zeros((0, 2))), repeats),
                    "own clock": min(calculix_clock(folder) for _ in range(repeats)),
                }
            )
    return rows


def calculix_clock(folder: Path) -> float:
    """The time that CalculiX itself reports: its process without starting up, s."""
    done = subprocess.run(
        [calculix.executable(), "-i", "plane"], cwd=folder, capture_output=True, text=True, check=True
    )
    return float(re.search(r"Total CalculiX Time:\s*([0-9.]+)", done.stdout).group(1))


def _nodes(path: Path) -> int:
    return path.read_text("ascii").split("*ELEMENT")[0].count("\n") - 1


def shapes():
    return [(sides, reference_shape(REFERENCE.with_(two_sided=sides == "two"))) for sides in ("two", "one")]


def cheapest(rows: list[dict], sides: str) -> dict:
    """The quickest row within the asked error."""
    return min(
        (r for r in rows if r["sides"] == sides and abs(r["error"]) <= ERROR_ASKED),
        key=lambda r: r["seconds"],
    )


def against_calculix(ours: list[dict], theirs: list[dict], designs: int, repeats: int) -> list[dict]:
    """Both codes at the asked error: solving alone, and whole processes for one design and for many.

    Ours takes many designs into one process; CalculiX takes one process a design.
    """
    rows = []
    for sides in ("two", "one"):
        a, b = cheapest(ours, sides), cheapest(theirs, sides)
        code = (
            "import sys; from tactcad.fem.plane import solve_plane; from tactcad.fem.shape import reference_shape; "
            "from tactcad.mechanics.section import REFERENCE; "
            f"shape = reference_shape(REFERENCE.with_(two_sided={sides == 'two'})); "
            f"[solve_plane(shape, 69000.0, 0.33, 3.0, density={a['density']}) for _ in range(int(sys.argv[1]))]"
        )
        one, many = (best(process("-c", code, str(n)), repeats) for n in (1, designs))
        rows.append(
            {
                "sides": sides,
                "our density": a["density"],
                "our error": a["error"],
                "our solve": a["seconds"],
                "CalculiX density": b["density"],
                "CalculiX error": b["error"],
                "CalculiX process": b["seconds"],
                "CalculiX own clock": b["own clock"],
                "solving alone, ratio": a["seconds"] / b["own clock"],
                "whole process, one design": one,
                "ratio, one design": one / b["seconds"],
                f"whole process, {designs} designs": many,
                f"ratio, {designs} designs": many / (designs * b["seconds"]),
            }
        )
    return rows


def solids(densities: tuple[int, ...], repeats: int) -> list[dict]:
    """Solid elements by SuperLU: as they are, and with the plane's error on the same mesh taken off."""
    rows = []
    for sides, shape in shapes():
        truth = converged(shape, 0.33, 3.0) * width_factor(shape, max(densities))
        for d in densities:
            solution = solve_solid(shape, 1.0, 0.33, 3.0, density=d, across=1)
            correction = converged(shape, 0.33, 3.0) / solve_plane(shape, 1.0, 0.33, 3.0, density=d).stiffness
            rows.append(
                {
                    "sides": sides,
                    "density": d,
                    "unknowns": solution.unknowns,
                    "error": solution.stiffness / truth - 1.0,
                    "corrected error": solution.stiffness * correction / truth - 1.0,
                    "seconds": best(lambda: solve_solid(shape, 1.0, 0.33, 3.0, density=d, across=1), repeats),  # noqa: B023
                    "solver": "SuperLU",
                }
            )
    return rows + cholmod(densities, repeats)


def width_factor(shape, density: int) -> float:
    across = 2
    solid = solve_solid(shape, 1.0, 0.33, 3.0, density=density, across=across).stiffness
    return solid / solve_plane(shape, 1.0, 0.33, 3.0, density=density).stiffness


def cholmod(densities: tuple[int, ...], repeats: int) -> list[dict]:
    """The same systems by CHOLMOD, where scikit-sparse is installed: shown apart."""
    try:
        from sksparse.cholmod import cholesky
    except ImportError:
        return []

    def solve(A, f, fixed):
        free = np.setdiff1d(np.arange(len(f)), fixed)
        u = np.zeros_like(f)
        u[free] = cholesky(A[free][:, free].tocsc())(f[free])
        return u

    usual, elasticity.solve = elasticity.solve, solve
    try:
        return [
            {
                "sides": sides,
                "density": d,
                "solver": "CHOLMOD",
                "seconds": best(lambda: solve_solid(shape, 1.0, 0.33, 3.0, density=d, across=1), repeats),
            }  # noqa: B023
            for sides, shape in shapes()
            for d in densities
        ]
    finally:
        elasticity.solve = usual


def start_up(repeats: int) -> dict:
    numpy, estimate = (
        best(process("-c", "import numpy"), repeats),
        best(process("-m", "tactcad", "estimate"), repeats),
    )
    return {"import numpy": numpy, "tactcad estimate": estimate, "ratio": estimate / numpy}


def run(smoke: bool) -> dict:
    repeats = 2 if smoke else 7
    ours = plane_meshes((2, 3) if smoke else (1, 2, 3, 4, 6, 8), repeats)
    result = {
        "date": date.today().isoformat(),
        "machine": {
            "processor": platform.machine(),
            "system": platform.system(),
            "python": platform.python_version(),
            "numpy": np.__version__,
            "cores": os.cpu_count(),
        },
        "closed forms": closed_forms(10_000 if smoke else 1_000_000, repeats),
        "accuracy": accuracy(2 if smoke else 40),
        "plane elements": ours,
        "solid elements": solids((1,) if smoke else (1, 2), 1 if smoke else 3),
        "start-up": start_up(repeats),
    }
    if calculix.executable():
        with tempfile.TemporaryDirectory() as folder:
            theirs = calculix_plane((2, 3) if smoke else (1, 2, 3, 4, 6), repeats, Path(folder))
        result["CalculiX"] = theirs
        result["against CalculiX"] = against_calculix(ours, theirs, 5 if smoke else 100, 1 if smoke else 3)
    return result


def goals(result: dict) -> list[str]:
    """Each goal with what was measured."""
    slowest = max(result["closed forms"], key=lambda r: r["seconds"] / r["designs"])
    measured = {
        "closed forms, 1e6 designs": slowest["seconds"] / slowest["designs"] * 1e6,
        "tactcad estimate over python -c 'import numpy'": result["start-up"]["ratio"],
    }
    for row in result.get("against CalculiX", []):
        whole = max(v for k, v in row.items() if k.startswith("ratio, ") and k != "ratio, one design")
        for name, value in (("solving alone", row["solving alone, ratio"]), ("whole process", whole)):
            key = f"plane elements over CalculiX, {name}"
            measured[key] = max(value, measured.get(key, 0.0))
    return [
        f"{'met ' if measured[k] <= goal else 'MISSED'} {k}: {measured[k]:.3g} (goal {goal:g})"
        if k in measured
        else f"not measured: {k} (CalculiX is not installed)"
        for k, goal in GOALS.items()
    ]


def show(result: dict) -> None:
    for title, rows in result.items():
        print(f"\n{title}" if not isinstance(rows, str) else f"{title} {rows}")
        for row in rows if isinstance(rows, list) else [rows] if isinstance(rows, dict) else []:
            print(
                "  "
                + ", ".join(f"{k} {v:.3g}" if isinstance(v, float) else f"{k} {v}" for k, v in row.items())
            )
    print("\ngoals")
    for line in goals(result):
        print("  " + line)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--smoke", action="store_true", help="a few designs and meshes: does everything run?")
    parser.add_argument("--out", metavar="FILE.json", help="write the figures here too")
    args = parser.parse_args()
    result = run(args.smoke)
    show(result)
    if args.out:
        Path(args.out).write_text(json.dumps(result, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main()
