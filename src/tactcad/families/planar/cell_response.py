"""Every chip's response to forces on the pads: on its own cell, also nonlinear, and on others.

Forces as readings give them (N, [..., 3]): along x and y of the design, and z down on the pad. Fields are
changes from rest, mT.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot

import numpy as np

from .beam import Array
from .cell import unit_loads
from .cell_layout import CellPlace, Kind, PlanarLayout
from .field import felt, sensitivity
from .sensor import NEIGHBOURS, chip_matrix, magnet_lever

DOWN = np.array([1.0, 1.0, -1.0])  # a pressing force is along -z of the design


def bend(layout: PlanarLayout, kind: Kind, force: Array) -> Array:
    """Difference of the field from the matrix at rest times forces, [n, 3]: the cell stiffens as it sinks,
    and a magnet's field is nonlinear."""
    gap, lever = layout.design.hall.gap, magnet_lever(layout)
    change = felt(layout.magnet, gap, lever, _motion(layout, kind, force))
    change -= sensitivity(layout.magnet, gap, lever)[0]
    return np.asarray(change - force * DOWN @ chip_matrix(layout, kind).T)


def _motion(layout: PlanarLayout, kind: Kind, force: Array) -> Array:
    """Of the island, mm and rad, [n, 6]."""
    motion = np.asarray(force * DOWN @ (kind.cell.compliance @ unit_loads(layout.pad_height)).T)
    motion[:, 2] = kind.cell.sunk(motion[:, 2])
    return motion


def bow_variance(layout: PlanarLayout, kind: Kind, full: Array) -> Array:
    """Of c of `cell_calibration` before any reading, mT^2/N^4, [field, axis]: by a magnet that is tilted or
    off its chip and by the foil's thickness, within the design's limits, two standard deviations each.

    The loads along each axis reach `full` (N, [3]).
    """
    gap, lever, tol = layout.design.hall.gap, magnet_lever(layout), layout.design.tolerance
    force = np.array([share * np.diag(full) for share in (0.0, 0.5, 1.0)])
    motion = _motion(layout, kind, force.reshape(-1, 3)).reshape(3, 3, 6)

    def bow(tilt: Array, aside: Array, softer: float) -> Array:
        about_its_face = np.concatenate([-np.cross(tilt, [0.0, 0.0, -lever]), tilt])
        moved = (1.0 + softer) * motion + about_its_face
        rest, middle, most = felt(layout.magnet, gap, lever, moved, (aside[0], aside[1]))
        return np.asarray((2.0 * (most - 2.0 * middle + rest) / full[:, None] ** 2).T)

    none, drawn = np.zeros(3), bow(np.zeros(3), np.zeros(3), 0.0)
    tilt, off = np.radians(tol.magnet_tilt) / 2.0, np.hypot(tol.magnet_place, tol.chip_place) / 2.0
    axes = np.eye(3)[:2]
    causes = [bow(tilt * a, none, 0.0) for a in axes] + [bow(none, off * a, 0.0) for a in axes]
    causes.append(bow(none, none, stiffness_limit(layout) / 2.0))
    return np.asarray(sum((c - drawn) ** 2 for c in causes))


def stiffness_limit(layout: PlanarLayout) -> float:
    """Relative deviation of a cell's stiffness by its foil's thickness and its cut, at their limits: two
    standard deviations of each."""
    t = layout.design.planar.thickness
    foil, cut = (1.0 + layout.design.foil_tolerance / t) ** 3 - 1.0, layout.process.tolerance(t)
    beams = (kind.beam for kind in layout.used)
    return max(hypot(foil, cut / (b.width - 1.5 * b.bevel) + 3.0 * cut / b.length) for b in beams)


def all_bends(layout: PlanarLayout, kinds: Sequence[Kind], force: Array) -> Array:
    """`bend` of a force (or several, [..., 3]) on each of these kinds of cells, one after another."""
    out, names = np.empty_like(force), np.array([kind.name for kind in kinds])
    for kind in layout.used:
        own = names == kind.name
        out[own] = bend(layout, kind, force[own].reshape(-1, 3)).reshape(force[own].shape)
    return out


def neighbours(layout: PlanarLayout, cells: Sequence[CellPlace]) -> Array:
    """The field at every chip by forces on the other pads, mT/N, [3 cell, 3 cell]; its own pad left out."""
    p, gap, lever = layout.design.planar, layout.design.hall.gap, magnet_lever(layout)
    load = unit_loads(layout.pad_height)
    moves = {kind.name: kind.cell.compliance @ load * DOWN for kind in layout.used}
    slopes: dict[tuple[int, int], Array] = {}
    out = np.zeros((len(cells), 3, len(cells), 3))
    for i, own in enumerate(cells):
        for j, other in enumerate(cells):
            away = (own.column - other.column, own.row - other.row)
            if away == (0, 0) or max(map(abs, away)) > NEIGHBOURS:
                continue
            if away not in slopes:
                beside = (away[0] * p.pitch, away[1] * p.pitch)
                slopes[away] = sensitivity(layout.magnet, gap, lever, beside)[1]
            out[i, :, j] = slopes[away] @ moves[other.kind.name]
    return out.reshape(3 * len(cells), 3 * len(cells))
