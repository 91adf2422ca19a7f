"""Two triangle meshes against each other: what they share, and how far they are apart (manifold3d)."""

from __future__ import annotations

from collections.abc import Sequence

import manifold3d
import numpy as np

Mesh = tuple[np.ndarray, np.ndarray]  # vertices (n, 3) in mm, triangles (m, 3)


def closed(mesh: Mesh) -> manifold3d.Manifold:
    """The mesh as a closed surface. Raises ValueError where it is not closed."""
    made = manifold3d.Manifold(
        manifold3d.Mesh64(np.ascontiguousarray(mesh[0]), np.ascontiguousarray(mesh[1], dtype=np.uint64))
    )
    if made.status() != manifold3d.Error.NoError:
        raise ValueError(f"not a closed mesh: {made.status()}")
    return made


def placed(
    mesh: manifold3d.Manifold, origin: Sequence[float], rotation: Sequence[Sequence[float]]
) -> manifold3d.Manifold:
    """At a scene's place: rotation x local point + origin (mm)."""
    return mesh.transform(
        np.column_stack([np.asarray(rotation, dtype=float), np.asarray(origin, dtype=float)])
    )


def meeting(first: manifold3d.Manifold, second: manifold3d.Manifold, reach: float) -> tuple[float, float]:
    """Overlap and gap of two placed meshes.

    Parameters
    ----------
    first, second
        Closed meshes, mm.
    reach
        Largest gap that is measured, mm.

    Returns
    -------
    tuple of float
        Common volume, mm3, and the gap between the surfaces, mm, at most `reach`.
    """
    return (first ^ second).volume(), first.min_gap(second, reach)


def volume(mesh: Mesh) -> float:
    """Enclosed volume, mm3: a sixth of the sum of a . (b x c) over the triangles."""
    a, b, c = (mesh[0][mesh[1][:, i]] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)
