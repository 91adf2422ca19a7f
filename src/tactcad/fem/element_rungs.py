"""Finite-element rungs of the ladder for an array's elements: each distinct section once."""

from __future__ import annotations

import logging
from dataclasses import fields

import numpy as np

from tactcad.mechanics.section import HingeSection

PLANE_ORDER, SOLID_ORDER = 4, 3  # plane within 0.02 %, solid within 0.2 % of the converged value


def stiffnesses(s: HingeSection) -> dict[str, np.ndarray]:
    """K (N/mm) of every element by the rungs fem-plane and fem-solid, each element cut at its load line."""
    logging.getLogger("skfem").setLevel(logging.ERROR)  # it warns about the order of arrays in memory
    from tactcad.fem.shape import reference_shape

    from .elements import solve_plane, solve_solid

    columns = [np.broadcast_to(getattr(s, f.name), s.shape) for f in fields(s)]
    distinct, index = np.unique(np.column_stack(columns).astype(float), axis=0, return_inverse=True)
    K = {"fem-plane": np.empty(len(distinct)), "fem-solid": np.empty(len(distinct))}
    for i, row in enumerate(distinct):
        one = HingeSection.of(**dict(zip((f.name for f in fields(s)), row)))
        shape, material = (
            reference_shape(one),
            (float(one.youngs_modulus), float(one.poisson), float(one.width)),
        )
        K["fem-plane"][i] = solve_plane(shape, *material, density=1, order=PLANE_ORDER).stiffness
        K["fem-solid"][i] = solve_solid(
            shape, *material, density=1, order=SOLID_ORDER, order_across=2
        ).stiffness
    return {name: values[index.ravel()] for name, values in K.items()}
