"""Eight planar cells, two of them beveled, by CalculiX's C3D20R and by the closed forms: compliance 6 x 6,
and the beams' stress.

    python benchmarks/calculix_cells.py benchmarks/results/calculix_cells.md    20 minutes; needs ccx

Meshes are of this file: all four beams whole, clamped at the frame, about a rigid island that is moved in
each of its six freedoms. Stresses are those that CalculiX gives at its nodes.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import calculix
import numpy as np
from foil_elements import KEEP, half_width
from numpy.typing import NDArray
from tables import lines, write_tables

from tactcad.contact.solid_face import outward
from tactcad.families.planar import beam as closed
from tactcad.families.planar.beam import MODES, FoilBeam
from tactcad.families.planar.cell import Cell, roots, wrench
from tactcad.families.planar.sensor import stiffness_error, stress_error

Array = NDArray[np.float64]
Index = NDArray[np.int64]

TABLE, SUMS = "cells by CalculiX", "cell stress by CalculiX"
DENSITIES = (1, 2)  # of whole cells; a beam alone is solved at one more
FILLET = 3  # columns from a fillet's start to KEEP radii off the clamped edge
NEAREST = 0.02  # fillet radii: the last column
LEVER = 1.0  # of the beam's length: height of the pad over the foil
DIRECTIONS = 500  # of forces on the pad
# t, w/s, s/t, r/w, nu, the island's side over s, and c/t; a pinwheel's beams leave 0.3 s from its corner and
# pass it at 0.1 s
SIZES = (
    ("straight", 0.03, 0.48, 78.0, 0.12, 0.3, 1.2, 0.0),
    ("pinwheel", 0.035, 0.11, 60.0, 0.95, 0.33, 0.6, 0.0),
    ("straight", 0.48, 0.12, 16.0, 0.5, 0.22, 0.8, 0.0),
    ("pinwheel", 0.5, 0.47, 15.5, 0.3, 0.38, 1.0, 0.0),
    ("pinwheel", 0.08, 0.25, 50.0, 0.11, 0.3, 0.6, 0.0),
    ("straight", 0.2, 0.36, 30.0, 0.97, 0.34, 1.3, 0.0),
    ("pinwheel", 0.06, 0.12, 20.0, 0.6, 0.3, 0.7, 0.2),
    ("straight", 0.1, 0.4, 25.0, 0.4, 0.34, 1.3, 0.1),
)


def cell_of(
    form: str, t: float, wide: float, slender: float, round_: float, nu: float, island: float, c: float
) -> Cell:
    """Of unit modulus, mm."""
    s = slender * t
    w, a = wide * s, island * s
    beam = FoilBeam(s, w, t, round_ * w, 1.0, nu, c * t)
    return Cell(beam, roots(form, a, 0.3 * s - a / 2.0, a / 2.0 + 0.1 * s + w / 2.0))


CELLS = tuple(cell_of(*sizes) for sizes in SIZES)


def lines_of(beam: FoilBeam, density: int) -> tuple[Array, Array, Array]:
    """Planes between elements: along the beam from its middle, mm, across it (shares of the half width), and
    through the foil, mm. They grow from fillet and edge away and shrink towards the clamped edge; a density
    divides each element's side."""
    half, r, w = beam.length / 2.0, beam.fillet, beam.width
    start, kept = half - r, half - KEEP * r
    fillet = np.linspace(start, kept, FILLET + 1)
    straight = start - outward(0.0, min(fillet[1] - start, w / 4.0), start)[::-1]
    last = half + kept - outward(kept, NEAREST * r, half)[::-1]
    along = np.concatenate([straight, fillet, last[1:], [half]])
    rows = outward(0.0, min(r / 3.0, w / 8.0, beam.thickness), w / 2.0) / (w / 2.0)
    across = np.concatenate([1.0 - rows[::-1], [1.0]])
    # a bevel starts at a plane of nodes, and twist stresses a narrow beam most in its side's middle
    two = beam.bevel > 0.0 or beam.width < 4.0 * beam.thickness
    through = np.linspace(-0.5, 0.5, 2 + two) * beam.thickness
    return tuple(
        np.interp(np.arange(density * (len(v) - 1) + 1) / density, np.arange(len(v)), v)
        for v in (along, across, through)
    )


def beam_bricks(beam: FoilBeam, density: int) -> tuple[Array, Index]:
    """Nodes (n, 3) of a beam along x about its middle, and 20-node bricks in CalculiX's order."""
    x, across, through = lines_of(beam, 2 * density)  # nodes in the middle of edges too
    x, across = (np.concatenate([-v[:0:-1], v]) for v in (x, across))
    shape = len(x), len(across), len(through)
    grid = np.stack(
        [
            np.broadcast_to(x[:, None, None], shape),
            _edge(beam, x[:, None], through)[:, None, :] * across[:, None],
            np.broadcast_to(through, shape),
        ],
        axis=-1,
    ).reshape(-1, 3)
    used, cells = calculix.bricks(shape)
    return grid[used], cells


def _edge(beam: FoilBeam, x: Array, z: Array) -> Array:
    """Half the width there, mm."""
    return half_width(beam, np.abs(x)) - 2.0 * beam.bevel * np.abs(z) / beam.thickness


@dataclass(frozen=True)
class Solved:
    """A cell by CalculiX: stiffness 6 x 6, and stresses (xx, yy, zz, xy, yz, zx) by the island's six
    freedoms, (6, beam, node, 6), on the foil's surface KEEP fillet radii or more off clamped edges."""

    stiffness: Array
    stress: Array
    unknowns: int

    @property
    def compliance(self) -> Array:
        return np.asarray(np.linalg.inv(self.stiffness))

    def largest(self, motion: Array) -> Array:
        """Largest von Mises stress of each beam by motions [n, 6] of the island, (n, beam)."""
        xx, yy, zz, xy, yz, zx = np.einsum("nf,fbkc->cnbk", motion, self.stress)
        square = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * (xy**2 + yz**2 + zx**2)
        return np.asarray(np.sqrt(square.max(axis=-1)))


def by_calculix(cell: Cell, density: int) -> Solved:
    b = cell.beam
    one, bricks = beam_bricks(b, density)
    points, cells, count = [], [], len(one)
    for n, root in enumerate(cell.roots):
        (x, y), (u, v) = root.at, root.along
        out = one[:, 0] + b.length / 2.0
        points.append(
            np.stack([x + u * out - v * one[:, 1], y + v * out + u * one[:, 1], one[:, 2]], axis=-1)
        )
        cells.append(bricks + n * count)
    every = np.concatenate(points)
    ends = [np.flatnonzero(np.abs(one[:, 0] - s * b.length / 2.0) < 1e-9 * b.length) for s in (-1, 1)]
    island, frame = (np.concatenate([end + n * count for n in range(len(cell.roots))]) for end in ends)
    moves = np.zeros((len(island), 3, 6))  # displacement of the island's nodes by its freedoms
    moves[:, :, :3] = np.eye(3)
    for i, turn in enumerate(np.eye(3)):
        moves[:, :, 3 + i] = np.cross(turn, every[island])
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "cell.inp"
        _write(path, every, np.concatenate(cells), b, island, frame, moves)
        subprocess.run(
            [calculix.executable() or "ccx", "-i", "cell"], cwd=folder, check=True, capture_output=True
        )
        forces = np.array(list(_reactions(path.with_suffix(".dat"))))
        stress = np.array(list(_stresses(path.with_suffix(".frd"), len(every))))
    K = np.einsum("nci,fnc->if", moves, forces.reshape(6, len(island), 3))
    x, y, z = np.abs(one.T)
    near = 1e-9 * b.length
    surface = (z > b.thickness / 2.0 - near) | (y > _edge(b, x, z) - near)
    kept = np.flatnonzero(surface & (x <= b.length / 2.0 - KEEP * b.fillet + near))
    return Solved(K, stress.reshape(6, -1, count, 6)[:, :, kept], every.size)


def _write(
    path: Path, points: Array, cells: Index, b: FoilBeam, island: Index, frame: Index, moves: Array
) -> None:
    """One step for each freedom of the island."""
    text = ["*NODE, NSET=ALL"]
    text += [f"{i}, {x:.12g}, {y:.12g}, {z:.12g}" for i, (x, y, z) in enumerate(points, 1)]
    text.append("*ELEMENT, TYPE=C3D20R, ELSET=BODY")
    text += calculix.element_lines(cells)
    text += ["*NSET, NSET=ISLAND", *(f"{n + 1}," for n in np.sort(island))]
    text += ["*MATERIAL, NAME=FOIL", "*ELASTIC", f"{b.youngs_modulus:.12g}, {b.poisson:.12g}"]
    text += ["*SOLID SECTION, ELSET=BODY, MATERIAL=FOIL", "*BOUNDARY"]
    text += [f"{n + 1}, 1, 3, 0." for n in frame]
    for freedom in range(6):
        text += ["*STEP", "*STATIC", "*BOUNDARY"]
        text += [
            f"{n + 1}, {i + 1}, {i + 1}, {move[i, freedom]:.12g}"
            for n, move in zip(island, moves)
            for i in range(3)
        ]
        text += ["*NODE PRINT, NSET=ISLAND", "RF", "*NODE FILE", "U", "*EL FILE", "S", "*END STEP"]
    path.write_text("\n".join([*text, ""]), "ascii")


def _reactions(path: Path) -> Iterator[list[list[float]]]:
    """Of the island's nodes, in the order of their numbers, by steps."""
    for block in path.read_text("ascii").split("forces (fx,fy,fz)")[1:]:
        fields = (line.split() for line in block.splitlines()[1:])
        yield [[float(v) for v in row[1:]] for row in fields if len(row) == 4 and row[0].isdigit()]


def _stresses(path: Path, count: int) -> Iterator[Array]:
    """At every node (xx, yy, zz, xy, yz, zx), by steps."""
    inside, found = False, np.zeros((count, 6))
    with path.open(encoding="ascii") as file:
        for line in file:
            if line.startswith(" -4"):
                inside = line.split()[1] == "STRESS"
            elif inside and line.startswith(" -1"):
                values = [float(line[13 + 12 * i : 25 + 12 * i]) for i in range(6)]
                found[int(line[3:13]) - 1] = values
            elif inside and line.startswith(" -3"):
                yield found.copy()
                inside = False


@dataclass(frozen=True)
class Compared:
    """One quantity of a cell: CalculiX's, its relative change by the last refinement, the closed form's
    relative deviation, and the error stated of that."""

    quantity: str
    calculix: float
    error: float
    closed: float
    stated: float


COMPLIANCES = {"compliance x": 0, "compliance z": 2, "compliance tilt": 3, "compliance turn": 5}
QUANTITIES = (*COMPLIANCES, *(f"stress {mode}" for mode in MODES))


def by_closed_form(cell: Cell) -> list[tuple[float, float]]:
    """The QUANTITIES, each with its stated relative error."""
    C, stress = np.diag(cell.compliance), closed.stress(cell.beam)
    bevel = cell.beam.bevel
    found = [(float(C[i]), stiffness_error(bevel)) for i in COMPLIANCES.values()]
    return found + [(stress[m], stress_error(bevel)) for m in MODES]


@dataclass(frozen=True)
class Whole:
    """Of a cell by CalculiX: its largest cross term over the geometric mean of the diagonal ones; and
    `Cell.stress` over the largest stress, less 1: pressed down, sideways, and the least and the most of
    DIRECTIONS forces."""

    cross: float
    down: float
    sideways: float
    least: float
    most: float


def compared(cell: Cell) -> tuple[list[Compared], Whole]:
    """Compliance of the whole cell by two meshes; a beam's stress in each mode by a finer one yet."""
    coarse, fine = (by_calculix(cell, density) for density in DENSITIES)
    alone = by_calculix(Cell(cell.beam, cell.roots[:1]), max(DENSITIES) + 1)
    pure = np.linalg.inv(cell.modes[0]).T  # motions of the island that bend the first beam in one mode
    rows = []
    at = list(COMPLIANCES.values())
    found = np.concatenate([np.diag(fine.compliance)[at], alone.largest(pure)[:, 0]])
    before = np.concatenate([np.diag(coarse.compliance)[at], fine.largest(pure)[:, 0]])
    for name, value, rough, (own, stated) in zip(
        QUANTITIES, found, before, by_closed_form(cell), strict=True
    ):
        rows.append(
            Compared(name, float(value), float(abs(rough / value - 1)), float(own / value - 1), stated)
        )
    C = fine.compliance
    cross = C / np.sqrt(np.outer(np.diag(C), np.diag(C)))
    over = cell_stress(cell, fine)
    return rows, Whole(
        float(np.abs(cross - np.eye(6)).max()), *map(float, (*over[:2], over.min(), over.max()))
    )


def cell_stress(cell: Cell, solved: Solved) -> Array:
    """`Cell.stress` over CalculiX's largest, less 1, by forces on the pad: down, sideways, DIRECTIONS."""
    drawn = np.random.default_rng(47).normal(size=(DIRECTIONS, 3))
    forces = np.concatenate([[[0.0, 0.0, -1.0], [1.0, 0.0, 0.0]], drawn])
    loads = np.array([wrench(f, LEVER * cell.beam.length) for f in forces])
    true = np.array([solved.largest((solved.compliance @ load)[None]).max() for load in loads])
    return np.array([cell.stress(load) for load in loads]) / true - 1.0


@cache
def made() -> dict[str, str]:
    """Both tables, of one run."""
    rows, wholes = [], []
    for sizes, cell in zip(SIZES, CELLS):
        named = [sizes[0], ", ".join(f"{v:g}" for v in sizes[1:])]
        every, whole = compared(cell)
        for one in every:
            shares = (f"{100.0 * v:.2g} %" for v in (one.error, one.closed, one.stated))
            rows.append([*named, one.quantity, f"{one.calculix:.6g}", *shares])
            print(*rows[-1], sep=" | ", file=sys.stderr, flush=True)
        over = (f"{100.0 * v:.3g} %" for v in (whole.down, whole.sideways, whole.least, whole.most))
        wholes.append([*named, f"{whole.cross:.1g}", *over])
        print(*wholes[-1], sep=" | ", file=sys.stderr, flush=True)
    heads = "form | t, w/s, s/t, r/w, nu, island/s, c/t"
    return {
        TABLE: lines(f"{heads} | quantity | CalculiX | its error | closed form differs | stated", rows),
        SUMS: lines(f"{heads} | largest cross term | down | sideways | least | most", wholes),
    }


if __name__ == "__main__":
    raise SystemExit(write_tables(__doc__, {name: lambda name=name: made()[name] for name in (TABLE, SUMS)}))
