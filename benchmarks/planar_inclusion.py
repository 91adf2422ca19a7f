"""Draws a hard inclusion of 3 mm in a soft layer, felt by 6 x 6 cells.

    python benchmarks/planar_inclusion.py DESIGN FILE.svg    two minutes

The layer by closed forms, what the inclusion changes by solid elements under the cells around it; rigid pads
without friction on their cells' springs; readings of every chip with its noise; and then the result of
`tactcad stiffness --picture`.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementHex0, ElementHexS2, ElementVector, MeshHex
from skfem.helpers import ddot, sym_grad, trace

from tactcad.contact.elastic_body import Body
from tactcad.contact.press import pad_stiffness
from tactcad.families.planar import cell_commands, cell_grasp, cell_response
from tactcad.families.planar.cell_layout import CellPlace, PlanarLayout
from tactcad.families.planar.cell_matrices import Matrices
from tactcad.families.planar.cell_pads import side
from tactcad.families.planar.sensor import chip_matrix, pad_compliance
from tactcad.mechanics.lumped import shares_between
from tactcad.parts.rules import load

Array = NDArray[np.float64]
# A soft tissue with a lump: MPa, Poisson's ratio, mm. Chosen: as soft as the paper's softest sample, a lump
# thirty times as stiff, a cube of 3 mm half its size below the face.
SOFT, HARD, POISSON, THICK, LUMP, BELOW = 0.1, 3.0, 0.45, 10.0, 3.0, 1.5
MARGIN = 4.0  # mm of the elements beyond the outer cells' pitch
EDGE = 0.7  # mm of the elements beside a pad's edge, where the face falls off steepest
AROUND = 1  # cells each way whose forces the lump changes: what elements with and without it differ by
DEPTHS = (0.0, 0.75, 1.5, 3.0, 4.5, 7.0, THICK)
LOADS = (1.0, 2.0, 3.0)  # N on the whole array


@BilinearForm
def _elastic(u, v, w):  # type: ignore[no-untyped-def]
    e, f = sym_grad(u), sym_grad(v)
    return w.lam * trace(e) * trace(f) + 2.0 * w.mu * ddot(e, f)


def lines(middles: Array, half: float, lump: float) -> Array:
    """Mesh lines along an axis: pads' middles and edges, midway, the lump's faces, the margin."""
    pitch = float(np.diff(middles).min())
    steps = (0.0, half, half + EDGE, pitch / 2.0)
    at = [m + s * d for m in middles for d in steps for s in (-1.0, 1.0)]
    at += [middles[0] - pitch / 2.0 - MARGIN, middles[-1] + pitch / 2.0 + MARGIN]
    at += [lump - LUMP / 2.0, lump + LUMP / 2.0]
    return np.unique(np.round(at, 6))


def stiffness(x: Array, y: Array, width: float, lump: tuple[float, float], hard: float) -> Array:
    """Forces on square pads for their displacements into the layer, N/mm, [pad, pad]."""
    across = [lines(np.unique(v), width / 2.0, at) for v, at in zip((x, y), lump)]
    mesh = MeshHex.init_tensor(*across, -np.array(DEPTHS[::-1]))
    middle = mesh.p[:, mesh.t].mean(axis=1)
    inside = np.abs(middle - np.array([*lump, -BELOW - LUMP / 2.0])[:, None]) < LUMP / 2.0
    modulus = np.where(inside.all(axis=0), hard, SOFT)
    basis = Basis(mesh, ElementVector(ElementHexS2()), intorder=4)
    flat = basis.with_element(ElementHex0())
    lam, mu = modulus * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), modulus / (2 * (1 + POISSON))
    K = _elastic.assemble(basis, lam=flat.interpolate(lam), mu=flat.interpolate(mu))
    u, v, z = basis.doflocs
    down = np.concatenate([basis.nodal_dofs[2], basis.edge_dofs[2]])
    which = np.full(basis.N, -1)
    for i in range(len(x)):
        near = (np.abs(u[down] - x[i]) <= width / 2 + 1e-6) & (np.abs(v[down] - y[i]) <= width / 2 + 1e-6)
        which[down[near & (np.abs(z[down]) < 1e-9)]] = i
    free = np.flatnonzero((which < 0) & (z > -THICK + 1e-9))
    under = csc_matrix(
        (np.ones((which >= 0).sum()), (np.flatnonzero(which >= 0), which[which >= 0])), (basis.N, len(x))
    )
    on_pads = (K @ under).toarray()
    inner = splu(csc_matrix(K[free][:, free]), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    return np.asarray(under.T @ on_pads - on_pads[free].T @ inner.solve(on_pads[free]))


def without_lump(x: Array, y: Array, width: float) -> Array:
    """The same by closed forms of the layer, [pad, pad]."""
    alone = pad_stiffness(Body(SOFT, POISSON, THICK), width, width)
    return np.asarray(np.linalg.inv(shares_between(x, y, width, width, THICK, POISSON) / alone))


def pressed(layout: PlanarLayout, under: CellPlace) -> Array:
    """Forces of the pads by the array's approach over a lump under one cell, N/mm, [cell]."""
    cells, width = layout.elements, side(layout.design)
    x, y = (np.array([getattr(e, a) for e in cells]) for a in "xy")
    springs = np.array([1.0 / pad_compliance(e.kind, layout.pad_height)[2, 2] for e in cells])
    body = without_lump(x, y, width)
    near = [
        i for i, e in enumerate(cells) if max(abs(e.row - under.row), abs(e.column - under.column)) <= AROUND
    ]
    some, place = (x[near], y[near], width), (under.x, under.y)
    body[np.ix_(near, near)] += stiffness(*some, place, HARD) - stiffness(*some, place, SOFT)
    sink = np.linalg.solve(body + np.diag(springs), springs)  # of the face by an approach of 1
    return np.asarray(springs * (1.0 - sink))


def felt(layout: PlanarLayout, rise: Array, seed: int = 1) -> cell_commands.CellGrasp:
    """What the readings of chips with noise tell, of a calibration without error."""
    cells, rng = layout.elements, np.random.default_rng(seed)
    n, loads = len(cells), np.array(LOADS)
    force = np.zeros((n, len(loads), 3))
    force[..., 2] = np.outer(rise / rise.sum(), loads)
    own = np.stack([chip_matrix(layout, e.kind) * cell_response.DOWN for e in cells])
    others = cell_response.neighbours(layout, cells).reshape(n, 3, n, 3)
    field = np.einsum("nij,nsj->nsi", own, force) + np.einsum("nimj,msj->nsi", others, force)
    field += cell_response.all_bends(layout, [e.kind for e in cells], force)
    noise = 1e-3 * np.array([layout.chip.noise_xy, layout.chip.noise_xy, layout.chip.noise_z])
    field += noise * (rng.standard_normal(field.shape) + rng.standard_normal((n, 1, 3)))
    number, none = np.array([e.number for e in cells]), np.zeros((n, 3, 3))
    k = np.array([1.0 / pad_compliance(e.kind, layout.pad_height)[2, 2] for e in cells])
    known = Matrices(
        number, own, none, none, np.zeros((n, 3)), np.zeros((n, 3, 3, 3)), np.ones((n, 3)), k, 0 * k, 0 * k
    )
    read = cell_grasp.CellFields(1, number, loads, np.ones(len(loads), int), field, noise, "simulated")
    found = cell_grasp.forces(layout, read, known, 0.95)
    return cell_commands.CellGrasp(
        read, found, cell_grasp.by_neighbours(layout, read, found, known, 0.95), None
    )


def main(design: str, out: str) -> None:
    layout = PlanarLayout(load(design))
    e = layout.elements[len(layout.elements) // 2 + layout.design.planar.columns // 2]
    seen = felt(layout, pressed(layout, e))
    Path(out).write_text(cell_commands.picture(layout, seen), "utf-8")
    print(f"lump under cell {e.number}, a {e.kind.name} one, at {e.x:g}, {e.y:g} mm; {out}")


if __name__ == "__main__":
    main(*sys.argv[1:])
