"""Eight designs in the corners of the accepted range by CalculiX's C3D20R and by the program's own rungs.

    python benchmarks/calculix_corners.py benchmarks/results/calculix_corners.md    15 minutes; needs ccx

Strain and stress are read from CalculiX's displacements as fem-solid's are.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import calculix
import numpy as np
from tables import lines, write_tables

from tactcad.fem import fem_ladder
from tactcad.fem.face_strain import readings
from tactcad.fem.mapped_mesh import layers, plane_mesh
from tactcad.fem.shape import reference_shape
from tactcad.mechanics import accuracy, ladder, strain
from tactcad.mechanics.section import REQUIRED, HingeSection

TABLE = "corners by CalculiX"
DENSITIES = (2, 3, 4)
MOST_BRICKS = 11_000  # a finer mesh of a corner would take CalculiX many minutes; two are left there
QUANTITIES = ("K", "gauge strain", "fillet strain", "fillet stress")
ORDER = tuple(name for name in REQUIRED if name != "youngs_modulus")
# The first six were found wrong, or without a word, by another code when the closed forms had polynomials.
# Then a hinge of a third of its thickness between low blocks, and fillets of 5.5 thicknesses.
SIZES = (
    ("one", 0.25, 1.504, 0.05, 5.488, 1.246, 3.13, 2.404, 0.4057, 0.8568),
    ("two", 0.2, 1.3, 0.1, 5.0, 1.2, 2.5, 1.5, 0.44, 0.75),
    ("two", 0.1, 3.3, 0.3, 6.0, 2.0, 2.0, 4.0, 0.44, 2.0),
    ("one", 0.4, 1.5, 0.1, 3.0, 3.0, 3.0, 2.0, 0.4, 1.5),
    ("one", 0.4, 1.5, 0.1, 7.0, 3.0, 8.0, 6.0, 0.4, 1.5),
    ("one", 0.3, 0.11, 0.05, 4.0, 3.0, 3.0, 1.2, 0.42, 2.0),
    ("one", 0.4, 0.14, 0.065, 2.0, 2.9, 8.0, 1.62, 0.445, 1.35),
    ("two", 0.2, 2.4, 1.1, 5.0, 3.2, 3.2, 1.0, 0.44, 1.8),
)
CORNERS = tuple(
    HingeSection.of(youngs_modulus=1.0, two_sided=sides == "two", **dict(zip(ORDER, sizes)))
    for sides, *sizes in SIZES
)


@dataclass(frozen=True)
class Compared:
    """One quantity at a corner: CalculiX's, its relative error by refinement, and the deviations of the
    program's rungs, each with its stated error."""

    quantity: str
    calculix: float
    error: float
    elements: float
    elements_stated: float
    closed: float
    closed_stated: float


def compared(s: HingeSection) -> Iterator[Compared]:
    """K (of unit modulus), the mean strain under a grid of half the slot, and strain and largest principal
    stress at the fillet, per newton at mid-width."""
    grid = float(s.hinge_length) / 2.0
    found, error = by_calculix(s, grid)
    elements = fem_ladder.solve(s, "fem-solid", grid)
    read = elements.readings
    ours = elements.stiffness, read.gauge, read.fillet_strain, read.fillet_stress
    closed = (
        ladder.stiffness(s, "solid"),
        strain.gauge(s, 1.0, grid),
        strain.peak(s, 1.0),
        strain.peak_stress(s, 1.0),
    )
    columns = found, error, ours / found - 1.0, stated(s, "fem-solid", grid)
    further = np.array(closed, dtype=float) / found - 1.0, stated(s, "solid", grid)
    for name, *numbers in zip(QUANTITIES, *columns, *further, strict=True):
        yield Compared(name, *map(float, numbers))


def stated(s: HingeSection, rung: str, grid: float) -> tuple[float, ...]:
    """Relative errors that the program states of a rung, in the order of QUANTITIES."""
    errors = strain.stated(s, grid, rung)
    every = accuracy.expected_error_of(s, rung), errors.gauge, errors.fillet_strain, errors.fillet_stress
    return tuple(map(float, every))


def by_calculix(s: HingeSection, grid: float) -> tuple[np.ndarray, np.ndarray]:
    """The quantities on the finest mesh, and their relative errors.

    K converges with about the fourth power of the density, so that the last difference bounds it. Strains and
    stresses converge unevenly: theirs is the most by which a coarser mesh differs.
    """
    fine = [density for density in DENSITIES if _bricks(s, density) <= MOST_BRICKS]
    found = np.array([_solved(s, density, grid) for density in fine])
    away = np.abs(found[:-1] / found[-1] - 1.0)
    return found[-1], np.concatenate([away[-1, :1], away[:, 1:].max(axis=0)])


def _solved(s: HingeSection, density: int, grid: float) -> tuple[float, ...]:
    mesh = plane_mesh(reference_shape(s), density)
    with tempfile.TemporaryDirectory() as folder:
        solution = calculix.solve_solid(
            mesh, 1.0, float(s.poisson), float(s.width), density, Path(folder), "C3D20R"
        )
    read = readings(solution, grid)
    return solution.stiffness, float(read.gauge), read.fillet_strain, read.fillet_stress


def _bricks(s: HingeSection, density: int) -> int:
    across = layers(float(s.width) / 2.0, float(s.hinge_thickness), density)
    return len(plane_mesh(reference_shape(s), density).cells) * (len(across) - 1)


def table() -> str:
    heads = (
        "notch | t, l, r, L, h, Hb, Lb, nu, b | quantity | CalculiX | its error | "
        "fem-solid differs | stated | solid differs | stated"
    )
    rows = []
    for sizes, s in zip(SIZES, CORNERS):
        for one in compared(s):
            shares = (one.error, one.elements, one.elements_stated, one.closed, one.closed_stated)
            cells = [sizes[0], ", ".join(f"{v:g}" for v in sizes[1:]), one.quantity, f"{one.calculix:.5g}"]
            rows.append([*cells, *(f"{100.0 * v:.2g} %" for v in shares)])
            print(*rows[-1], sep=" | ", file=sys.stderr, flush=True)
    return lines(heads, rows)


if __name__ == "__main__":
    raise SystemExit(write_tables(__doc__, {TABLE: table}))
