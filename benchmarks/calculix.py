"""The same problem for CalculiX (ccx): an independent code to check against, where it is installed.

Plane problems use CPS8. CalculiX expands those to solids, so that at full width a bending strip comes
out about as stiff as plane strain (+11.8 % at 3 mm); a width of 0.003 mm makes it plane stress.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from skfem import MeshQuad

from tactcad.contact.elastic_body import Body
from tactcad.fem.elements import SolidSolution, parabola
from tactcad.fem.mapped_mesh import PlaneMesh, merged
from tactcad.fem.space import AcrossSpace, PlaneSpace, line_load

Array = NDArray[np.float64]

THIN = 0.003  # mm: width of the expanded plane elements
_QUAD = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
_BRICK = (
    [(*uv, w) for w in (0, 2) for uv in _QUAD[:4]]
    + [(*uv, w) for w in (0, 2) for uv in _QUAD[4:]]
    + [(*uv, 1) for uv in _QUAD[:4]]
)


def executable() -> str | None:
    """Path of ccx, None if it is not installed."""
    return shutil.which("ccx")


def write_plane(mesh: PlaneMesh, E: float, nu: float, path: Path) -> Array:
    """Input file of the plane-stress problem, unit force per THIN width; returns nodal forces (nodes, 2)."""
    points, cells = merged(np.stack([mesh.cells[:, u, v] for u, v in _QUAD], axis=1))
    cells = _turned(points, cells, [0, 3, 2, 1, 7, 6, 5, 4])
    force = np.zeros_like(points)
    end = _on(points[:, 0], mesh.load_x)
    end = end[np.argsort(points[end, 1])]
    force[end, 1] = line_load(points[end, 1], lambda z: parabola(z, mesh), 2)
    supports = _supports(points, mesh, 2)
    _write(path, points, cells, "CPS8", f"{THIN}", E, nu, supports, force)
    return force


def run(path: Path, shape: tuple[int, int]) -> Array:
    """Displacements (nodes, directions) of that shape of the solved input file, mm."""
    job = path.with_suffix("")
    subprocess.run([executable() or "ccx", "-i", job.name], cwd=path.parent, check=True, capture_output=True)
    return _displacements(job.with_suffix(".dat"), shape)


def plane_stiffness(mesh: PlaneMesh, E: float, nu: float, width: float, folder: Path) -> float:
    """Tip stiffness by CalculiX's plane-stress elements CPS8, N/mm.

    Parameters
    ----------
    mesh
        Of order 2.
    E, nu
        Young's modulus, MPa, and Poisson's ratio.
    width
        Of the sheet, mm.
    folder
        Existing folder for CalculiX's files.
    """
    force = write_plane(mesh, E, nu, folder / "plane.inp")
    moved = np.sum(force * run(folder / "plane.inp", force.shape))
    return width / THIN / ((2.0 if mesh.half else 1.0) * float(moved))


def solve_solid(
    mesh: PlaneMesh, E: float, nu: float, width: float, across: int, folder: Path, element: str = "C3D20"
) -> SolidSolution:
    """The solid problem by CalculiX's 20-node bricks on half the width.

    The solution's places across are where bricks end. In the middle of a brick's face there is no node:
    displacements are NaN there.

    Parameters
    ----------
    mesh
        Of the plane, of order 2.
    E, nu
        Young's modulus, MPa, and Poisson's ratio.
    width
        Of the sheet, mm.
    across
        Density of the mesh over half the width.
    folder
        Existing folder for CalculiX's files.
    element
        C3D20, or C3D20R, which integrates at fewer points.
    """
    sideways = AcrossSpace.of(mesh, width / 2.0, across, 2)
    bricks = _swept(mesh, sideways)
    points, cells = merged(np.stack([bricks[:, u, v, w] for u, v, w in _BRICK], axis=1))
    flipped = [0, 3, 2, 1, 4, 7, 6, 5, 11, 10, 9, 8, 15, 14, 13, 12, 16, 19, 18, 17]
    turned = _turned(points, cells, flipped)
    force = np.zeros_like(points)
    for face, share in _end_faces(points, turned, mesh, width):
        np.add.at(force[:, 1], face, share)
    _write(folder / "solid.inp", points, turned, element, "", E, nu, _supports(points, mesh, 3), force)
    u = run(folder / "solid.inp", force.shape)
    space, ends = PlaneSpace.of(mesh), sideways.nodes[::2]
    moved = np.full((3, space.nodes.shape[1], len(ends)), np.nan)
    layers = cells.reshape(len(ends) - 1, len(mesh.cells), len(_BRICK))
    for i, (a, b, w) in enumerate(_BRICK):
        if w != 1:
            for k, layer in enumerate(layers):
                moved[:, space.elements[:, a, b], k + w // 2] = u[layer[:, i]].T
    compliance = (4.0 if mesh.half else 2.0) * float(np.sum(force * u))
    return SolidSolution(compliance, moved, space, AcrossSpace(ends, 2), mesh, u.size, E, nu)


def _swept(mesh: PlaneMesh, across: AcrossSpace) -> Array:
    """27-node hexahedra (n, 3, 3, 3, 3): coordinates x, z, y by local index."""
    count = len(across.nodes) // 2
    cells = np.empty((count, len(mesh.cells), 3, 3, 3, 3))  # layer, quad, u, v, w, coordinate
    cells[..., :2] = mesh.cells[None, :, :, :, None]
    for k in range(count):
        cells[k, ..., 2] = across.nodes[2 * k : 2 * k + 3]
    return cells.reshape(-1, 3, 3, 3, 3)


def bricks(shape: tuple[int, ...]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Of a grid of that many corners and middles of edges each way: the nodes that are used, and 20-node
    bricks of these, (n, 20), in CalculiX's order."""
    corner = np.meshgrid(*(np.arange(0, n - 2, 2) for n in shape), indexing="ij")
    first = np.ravel_multi_index([c.ravel() for c in corner], shape)
    used, cells = np.unique(
        first[:, None] + np.array(_BRICK) @ (shape[1] * shape[2], shape[2], 1), return_inverse=True
    )
    return used, cells.reshape(-1, len(_BRICK))


def _turned(points: Array, cells: NDArray[np.int64], flipped: list[int]) -> NDArray[np.int64]:
    """Cells with those that run clockwise in (x, z) reversed: CalculiX requires positive volumes."""
    a, b, d = (points[cells[:, i], :2] for i in (0, 1, 3))
    (bx, bz), (dx, dz) = (b - a).T, (d - a).T
    clockwise = bx * dz - bz * dx < 0.0
    turned = cells.copy()
    turned[clockwise] = cells[clockwise][:, flipped]
    return turned


def _on(values: Array, at: float) -> NDArray[np.int64]:
    return np.flatnonzero(np.abs(values - at) < 1e-7 * max(np.ptp(values), 1e-30))


def _supports(points: Array, mesh: PlaneMesh, dim: int) -> list[tuple[int, int]]:
    """Fixed unknowns (node, direction), as in `plane_elements.fixed_unknowns`."""
    held = [(n, i) for n in _on(points[:, 0], mesh.clamp_x) for i in range(dim)]
    if mesh.half:
        held += [(n, i) for n in _on(points[:, 1], mesh.middle) for i in range(dim) if i != 1]
    if dim == 3:
        held += [(n, 2) for n in _on(points[:, 2], 0.0)]
    return sorted(set(held))


_FACES = [
    (0, 1, 2, 3, 8, 9, 10, 11),
    (4, 5, 6, 7, 12, 13, 14, 15),
    (0, 1, 5, 4, 8, 17, 12, 16),
    (1, 2, 6, 5, 9, 18, 13, 17),
    (2, 3, 7, 6, 10, 19, 14, 18),
    (3, 0, 4, 7, 11, 16, 15, 19),
]


def _end_faces(
    points: Array, cells: NDArray[np.int64], mesh: PlaneMesh, width: float
) -> Iterator[tuple[NDArray[np.int64], Array]]:
    """Eight-node faces on the arm's end with the consistent forces of the parabolic shear."""
    end = set(_on(points[:, 0], mesh.load_x).tolist())
    xi, w = np.polynomial.legendre.leggauss(4)
    for cell in cells:
        for face in _FACES:
            nodes = cell[list(face)]
            if not all(int(n) in end for n in nodes):
                continue
            share = np.zeros(8)
            p = points[nodes][:, 1:]
            for i, r in enumerate(xi):
                for j, s in enumerate(xi):
                    N, dN = _serendipity(r, s)
                    area = abs(np.linalg.det(dN.T @ p))
                    share += w[i] * w[j] * area * N * parabola(N @ p[:, 0], mesh) / width
            yield nodes, share


def _serendipity(r: float, s: float) -> tuple[Array, Array]:
    """Eight-node shape functions and their derivatives at (r, s) in [-1, 1]^2."""
    corner = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], dtype=float)
    N, dN = np.empty(8), np.empty((8, 2))
    for i, (a, b) in enumerate(corner):
        N[i] = (1 + a * r) * (1 + b * s) * (a * r + b * s - 1) / 4
        dN[i] = a * (1 + b * s) * (2 * a * r + b * s) / 4, b * (1 + a * r) * (a * r + 2 * b * s) / 4
    for i, (a, b) in zip((4, 5, 6, 7), ((0, -1), (1, 0), (0, 1), (-1, 0))):
        if a == 0:
            N[i] = (1 - r * r) * (1 + b * s) / 2
            dN[i] = -r * (1 + b * s), b * (1 - r * r) / 2
        else:
            N[i] = (1 - s * s) * (1 + a * r) / 2
            dN[i] = a * (1 - s * s) / 2, -s * (1 + a * r)
    return N, dN


def _write(
    path: Path,
    points: Array,
    cells: NDArray[np.int64],
    kind: str,
    section: str,
    E: float,
    nu: float,
    supports: Sequence[tuple[int, int]],
    force: Array,
) -> None:
    """ccx's input file; `section`: the line below *SOLID SECTION, "" for none."""
    coordinates = np.zeros((len(points), 3))
    coordinates[:, : points.shape[1]] = points
    lines = ["*NODE, NSET=ALL"]  # ccx reads 20 characters a field and drops the rest, even of an exponent
    lines += [f"{i}, {x:.12g}, {y:.12g}, {z:.12g}" for i, (x, y, z) in enumerate(coordinates, 1)]
    lines.append(f"*ELEMENT, TYPE={kind}, ELSET=BODY")
    for i, cell in enumerate(cells, 1):
        numbers = [str(i), *(str(n + 1) for n in cell)]
        lines += [
            ", ".join(numbers[k : k + 10]) + ("," if k + 10 < len(numbers) else "")
            for k in range(0, len(numbers), 10)
        ]
    lines += [
        "*MATERIAL, NAME=SHEET",
        "*ELASTIC",
        f"{E:.12g}, {nu:.12g}",
        "*SOLID SECTION, ELSET=BODY, MATERIAL=SHEET",
    ]
    lines += [section] if section else []
    lines.append("*BOUNDARY")
    lines += [f"{n + 1}, {i + 1}, {i + 1}, 0." for n, i in supports]
    lines += ["*STEP", "*STATIC", "*CLOAD"]
    lines += [f"{n + 1}, 2, {v:.12g}" for n, v in enumerate(force[:, 1]) if v != 0.0]
    lines += ["*NODE PRINT, NSET=ALL", "U", "*END STEP", ""]
    path.write_text("\n".join(lines), "ascii")


def punch_force(mesh: MeshQuad, body: Body, radius: float, depth: float, path: Path) -> float:
    """Force (N) of a rigid round punch, under which the face does not slide, at a depth in a bonded
    neo-Hookean layer: rings of eight nodes with reduced integration, CAX8R, finite strain."""
    corners = mesh.p.T[mesh.t.T[:, ::-1]]  # ccx counts against the clock
    cells = np.concatenate([corners, (corners + np.roll(corners, -1, axis=1)) / 2], axis=1)
    points, nodes = merged(cells)
    r, z = points.T
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{i}, {x:.12g}, {y:.12g}, 0." for i, (x, y) in enumerate(points, 1)]
    lines.append("*ELEMENT, TYPE=CAX8R, ELSET=BODY")
    lines += [f"{i}, " + ", ".join(str(n + 1) for n in cell) for i, cell in enumerate(nodes, 1)]
    lines += _soft(body)
    under, bottom = np.flatnonzero((z > -1e-9) & (r < radius + 1e-9)), np.flatnonzero(z < z.min() + 1e-9)
    lines += [f"{n + 1}, 1, 2, 0." for n in bottom]
    lines += [f"{n + 1}, 1, 1, 0." for n in np.union1d(np.flatnonzero(r < 1e-9), under)]
    lines += ["*NSET, NSET=PUNCHED", *(f"{n + 1}," for n in under)]
    lines += ["*STEP, NLGEOM, INC=200", "*STATIC", "0.05, 1., 1e-4, 0.1", "*BOUNDARY"]
    lines += [f"{n + 1}, 2, 2, {-depth:.12g}" for n in under]
    return -180 * float(_pushed(path, lines)[1])  # ccx solves a wedge of two degrees


def pad_force(
    lines: Sequence[Array],
    body: Body,
    x: tuple[float, float],
    y: tuple[float, float],
    depth: float,
    fall: float,
    path: Path,
) -> float:
    """Force (N) on the part inside the mesh of a rigid pad, under which the face does not slide, on a bonded
    neo-Hookean layer: C3D20R, finite strain. A mesh that begins at x = 0 or y = 0 is mirrored there.

    Parameters
    ----------
    lines
        Planes between bricks along x, y and z, rising; z from the base to the face at 0, mm.
    body
        The layer.
    x, y
        From where to where the pad reaches, mm.
    depth
        To which the pad's middle is pressed, mm.
    fall
        By which its right edge is deeper than its middle, mm.
    path
        Of the input file.
    """
    nodes = [np.interp(np.arange(2 * len(v) - 1) / 2.0, np.arange(len(v)), v) for v in lines]
    used, cells = bricks(tuple(len(v) for v in nodes))
    px, py, pz = np.stack(np.meshgrid(*nodes, indexing="ij")).reshape(3, -1)[:, used]
    text = ["*NODE, NSET=ALL"]
    text += [f"{i}, {u:.12g}, {v:.12g}, {w:.12g}" for i, (u, v, w) in enumerate(zip(px, py, pz), 1)]
    text += ["*ELEMENT, TYPE=C3D20R, ELSET=BODY", *element_lines(cells), *_soft(body)]
    on = (pz > -1e-9) & (px > x[0] - 1e-9) & (px < x[1] + 1e-9) & (py > y[0] - 1e-9) & (py < y[1] + 1e-9)
    under, free = np.flatnonzero(on), ~on & (pz > pz.min() + 1e-9)
    text += [f"{n + 1}, 1, 3, 0." for n in np.flatnonzero(pz < pz.min() + 1e-9)]
    text += [f"{n + 1}, 1, 2, 0." for n in under]
    for i, at in ((1, px), (2, py)):
        if at.min() == 0.0:
            text += [f"{n + 1}, {i}, {i}, 0." for n in np.flatnonzero(free & (at < 1e-9))]
    text += ["*NSET, NSET=PUNCHED", *(f"{n + 1}," for n in under)]
    text += ["*STEP, NLGEOM, INC=200", "*STATIC", "0.1, 1., 1e-4, 0.2", "*BOUNDARY"]
    down = depth + fall * (px[under] - sum(x) / 2.0) / (np.ptp(x) / 2.0)
    text += [f"{n + 1}, 3, 3, {-d:.12g}" for n, d in zip(under, down)]
    return -float(_pushed(path, text)[2])


def element_lines(cells: NDArray[np.int64]) -> Iterator[str]:
    """Lines of 20-node bricks."""
    for i, cell in enumerate(cells, 1):
        names = [str(n + 1) for n in cell]
        yield from (f"{i}, " + ", ".join(names[:9]) + ",", ", ".join(names[9:]))


def _soft(body: Body) -> list[str]:
    """The neo-Hookean material of all elements."""
    shear, bulk = body.modulus / (2 * (1 + body.poisson)), body.modulus / (3 * (1 - 2 * body.poisson))
    return [
        "*MATERIAL, NAME=SOFT",
        "*HYPERELASTIC, NEO HOOKE",
        f"{shear / 2:.12g}, {2 / bulk:.12g}",
        "*SOLID SECTION, ELSET=BODY, MATERIAL=SOFT",
        "*BOUNDARY",
    ]


def _pushed(path: Path, lines: list[str]) -> Array:
    """The punched nodes' total force at the end of the step that lines of input end with, N."""
    asked = ["*NODE PRINT, NSET=PUNCHED, TOTALS=ONLY, FREQUENCY=1000", "RF", "*END STEP", ""]
    path.write_text("\n".join([*lines, *asked]), "ascii")
    job = path.with_suffix("")
    subprocess.run([executable() or "ccx", "-i", job.name], cwd=path.parent, check=True, capture_output=True)
    rows = [line.split() for line in job.with_suffix(".dat").read_text("ascii").splitlines() if line.strip()]
    return np.array(rows[-1], dtype=float)


def _displacements(path: Path, shape: tuple[int, int]) -> Array:
    """U as the .dat file prints it, for nodes 1 to shape[0]."""
    u = np.zeros(shape)
    for line in path.read_text("ascii").splitlines():
        fields = line.split()
        if len(fields) == 4 and fields[0].isdigit() and int(fields[0]) <= shape[0]:
            u[int(fields[0]) - 1] = [float(v) for v in fields[1 : 1 + shape[1]]]
    return u
