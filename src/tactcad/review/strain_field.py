"""Strain along the arm of a pressed element, by plane finite elements on its own contour, for a coloured
picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tactcad.fem.elements import PlaneSolution, solve_plane
from tactcad.fem.shape import cut_element
from tactcad.fem.space import lagrange
from tactcad.parts.array.element import element
from tactcad.parts.array.hinge_section import design_alloy
from tactcad.parts.array.layout import ElementPlace, Layout

DENSITY = 4  # of the mesh; chosen: facets of a hundredth of a millimetre at the fillets, 3000 of them


@dataclass(frozen=True)
class StrainField:
    """Per newton on the pad, in plane stress.

    points    (n, 2) places x and z in the element's frame, mm
    moved     (n, 2) displacements there, mm/N
    strain    (n,) strain along x, 1/N; positive in tension
    quads     (q, 4) corners of the picture's facets
    """

    points: NDArray[np.float32]
    moved: NDArray[np.float32]
    strain: NDArray[np.float32]
    quads: NDArray[np.uint32]


def strain_field(layout: Layout, place: ElementPlace) -> StrainField:
    """The field of one element, clamped at its clamp edge, pressed away from the object at its load line.

    Raises
    ------
    CheckFailure
        If the mesh cannot follow its contour.
    """
    contour = element(layout, place).extrusion.outer
    shape = cut_element(contour, layout.clamp_edge, place.hinge_x - place.load_arm)
    alloy = design_alloy(layout.design)
    solution = solve_plane(
        shape, alloy.youngs_modulus, alloy.poisson, layout.design.sheet.thickness, density=DENSITY, whole=True
    )
    u = np.asarray(solution.displacement).reshape(2, -1)
    # Each element's order x order facets by their corners, round about.
    e = solution.space.elements
    corners = e[:, :-1, :-1], e[:, 1:, :-1], e[:, 1:, 1:], e[:, :-1, 1:]
    return StrainField(
        solution.space.nodes.T.astype(np.float32),
        u.T.astype(np.float32),
        strain_along(solution).astype(np.float32),
        np.stack(corners, axis=-1).reshape(-1, 4).astype(np.uint32),
    )


def strain_along(solution: PlaneSolution) -> NDArray[np.float64]:
    """du_x/dx at every node (1/N), the mean of the elements that share it."""
    space, order = solution.space, solution.space.order
    value, slope = lagrange(order, tuple(np.linspace(-1.0, 1.0, order + 1).tolist()))
    e = space.elements
    u = np.asarray(solution.displacement).reshape(2, -1)[0]

    def slopes(f: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives by both local coordinates at each element's nodes."""
        return (
            np.einsum("eab,ap,bq->epq", f[e], slope, value),
            np.einsum("eab,ap,bq->epq", f[e], value, slope),
        )

    (x1, x2), (z1, z2), (u1, u2) = slopes(space.nodes[0]), slopes(space.nodes[1]), slopes(u)
    strain = (u1 * z2 - u2 * z1) / (x1 * z2 - x2 * z1)
    total, count = np.zeros(len(u)), np.zeros(len(u))
    np.add.at(total, e, strain)
    np.add.at(count, e, 1.0)
    return total / count
