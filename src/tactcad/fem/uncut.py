"""Compliance of the whole part, with pad, stop land and holes, held between its spacers: how much softer it
is than the hinge model.
"""

from __future__ import annotations

import numpy as np
from skfem import Basis, ElementTriP2

from tactcad.contour import Contour

from . import elasticity
from .free_mesh import Fine, triangle_mesh
from .shape import ElementShape
from .space import line_load

LARGEST = 0.6  # mm: element size away from the hinge


def uncut_compliance(
    outer: Contour,
    holes: tuple[Contour, ...],
    shape: ElementShape,
    spacer: tuple[float, float, float],
    pad: tuple[float, float, float],
    E: float,
    nu: float,
    width: float,
    *,
    per_thickness: float = 3.0,
) -> float:
    """Plane-stress compliance of the part under 1 N spread evenly over the pad's face, mm/N.

    The deflection is the mean over the face (work-conjugate).

    Parameters
    ----------
    outer, holes
        Contours of the part, mm.
    shape
        Its hinge, where elements are t/per_thickness mm.
    spacer
        x beyond which (away from the arm) the sheet is held between spacers, and from which z to which, mm.
    pad
        x from, x to and z of the pad's face, mm.
    E, nu
        Young's modulus, MPa, and Poisson's ratio.
    width
        Of the sheet, mm.
    per_thickness
        Elements over the hinge's thickness.
    """
    fillets = [f for b in (shape.arm, shape.body) for f in (b.low_fillet, b.high_fillet) if f]
    walls = sorted({f.wall for f in fillets})
    middle = (shape.low + shape.high) / 2.0
    fine = tuple(
        Fine((x, middle), shape.thickness / per_thickness) for x in np.linspace(walls[0], walls[-1], 9)
    )
    mesh = triangle_mesh(outer, holes, fine, LARGEST)
    basis = Basis(mesh, ElementTriP2(), intorder=4)
    A = elasticity.stiffness_matrix(basis, *elasticity.lame(E, nu, plane_stress=True)) * width
    x, z = basis.doflocs
    edge, low, high = spacer
    direction = 1.0 if edge > shape.arm.end else -1.0
    held = np.flatnonzero((direction * (x - edge) > -1e-9) & (z >= low - 1e-9) & (z <= high + 1e-9))
    x0, x1, face = pad
    on_pad = np.flatnonzero((np.abs(z - face) < 1e-9) & (x > x0 - 1e-9) & (x < x1 + 1e-9))
    on_pad = on_pad[np.argsort(x[on_pad])]
    f = np.zeros(A.shape[0])
    f[2 * on_pad + 1] = line_load(x[on_pad], lambda q: np.full_like(q, 1.0 / (x1 - x0)), basis.elem.maxdeg)
    u = elasticity.solve(A, f, np.concatenate([2 * held, 2 * held + 1]))
    return float(f @ u)
