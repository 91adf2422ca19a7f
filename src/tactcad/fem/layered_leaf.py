"""The leaf with what is bonded on it, by plane elements: adhesive, backing and foil as layers of their own.

Each layer carries in shear what the next one takes along, as far as it reaches: what the closed form of
`mechanics.gauge_signal.composite`, where plane sections stay plane over the whole hinge, cannot know.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tactcad.mechanics.section import HingeSection

from . import elasticity
from .mapped_mesh import PlaneMesh, plane_mesh
from .plane_elements import end_load, fixed_unknowns
from .shape import reference_shape
from .space import PlaneSpace

Array = NDArray[np.float64]

ORDER, DENSITY = 3, 2  # stiffening within 3 % of itself of finer meshes (tests/fem/test_layered_leaf.py)
SLIVER = 1e-6  # of an element: less is rounding
POLYMER = 0.35  # Poisson's ratio of layers: of polyimide and cured adhesives; it hardly matters


@dataclass(frozen=True)
class Layer:
    """A layer on the gauge's face, over the one before: thickness (mm), Young's modulus (MPa), width across
    the element (mm), and how far it reaches from the hinge's middle towards pad and clamp (mm)."""

    thickness: float
    modulus: float
    width: float
    reach: tuple[float, float]


def stiffness(s: HingeSection, layers: Sequence[Layer]) -> float:
    """Tip stiffness of one element (scalars) with layers on it, N/mm, in plane stress.

    An element in which a layer ends carries by the share of it that the layer covers.
    """
    bare = plane_mesh(reference_shape(s), DENSITY, whole=True, order=ORDER)
    b = float(s.width)
    groups = [(bare.cells, float(s.youngs_modulus), float(s.poisson))]
    face = bare.shape.low
    edges = _face_edges(bare)
    for layer in layers:
        covered = _covered(edges, layer.reach)
        for share in np.unique(covered[covered > 0.0]):
            cells = _cells(edges[covered == share], face, layer.thickness)
            groups.append((cells, float(share) * layer.modulus * layer.width / b, POLYMER))
        face -= layer.thickness
    mesh = replace(bare, cells=np.concatenate([cells for cells, _, _ in groups]))
    space = PlaneSpace.of(mesh)
    parts = np.split(space.elements, np.cumsum([len(cells) for cells, _, _ in groups])[:-1])
    A = sum(
        PlaneSpace(space.nodes, own).stiffness(*elasticity.lame(E, nu, plane_stress=True)) * b
        for own, (_, E, nu) in zip(parts, groups, strict=True)
    )
    f = np.zeros(A.shape[0])
    end, load = end_load(space, mesh)
    f[2 * end + 1] = load
    u = elasticity.solve(A, f, fixed_unknowns(space.nodes, mesh, 2))
    return float(1.0 / (f @ u))


def _face_edges(mesh: PlaneMesh) -> Array:
    """x of the nodes of every element's edge on the gauge's face, (edges, order + 1), rising."""
    sides = np.concatenate([mesh.cells[:, :, 0], mesh.cells[:, :, -1], mesh.cells[:, 0], mesh.cells[:, -1]])
    on = np.all(np.abs(sides[..., 1] - mesh.shape.low) < 1e-9 * np.ptp(mesh.cells[..., 0]), axis=1)
    x = sides[on][..., 0]
    x = np.where((x[:, 0] > x[:, -1])[:, None], x[:, ::-1], x)
    return x[np.argsort(x[:, 0])]


def _covered(edges: Array, reach: tuple[float, float]) -> Array:
    """Share of each edge that lies within reach."""
    to_arm, to_body = reach
    x0, x1 = edges[:, 0], edges[:, -1]
    over = np.minimum(x1, to_arm) - np.maximum(x0, -to_body)
    share = np.clip(over / (x1 - x0), 0.0, 1.0)
    return np.where(share > SLIVER, share, 0.0)


def _cells(edges: Array, face: float, thickness: float) -> Array:
    """One element under each edge, (edges, order + 1, order + 1, 2)."""
    z = face - thickness * np.linspace(0.0, 1.0, edges.shape[1])
    return np.stack(np.broadcast_arrays(edges[:, :, None], z), axis=-1)
