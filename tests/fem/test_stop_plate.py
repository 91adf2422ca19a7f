"""The stop plate's bending by solid elements: a plate that its set screws' points hold at their mean height,
an arm's land pressing it up. Of the plate's own account this uses its dimensions, none of its formulas."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csc_matrix
from skfem import Basis, ElementHex2, MeshHex
from variants import variant

from tactcad.fem import elasticity
from tactcad.parts.array.layout import Layout
from tactcad.parts.array.stop_give import STEEL_MODULUS, STEEL_POISSON

HELD = 1e7  # N/mm that hold a set screw's point: a thousand times what the plate has
LONG = {"array.row_arms": [[4, 7, 6, 8, 6] * 10, [8, 5, 4, 5, 7] * 10]}
# 196 mm between set screws, 2 mm thick
WIDE = {**LONG, "clamp.stop_plate_thickness": 2.0, "clamp.hold_down_pitch": 200.0}


def lines(marks, step):
    """Coordinates through all marks, no further apart than `step`."""
    marks = sorted({round(m, 6) for m in marks})
    pieces = [
        np.linspace(a, b, 1 + max(1, int(np.ceil((b - a) / step))))[:-1] for a, b in zip(marks, marks[1:])
    ]
    return np.concatenate([*pieces, [marks[-1]]])


def rise(layout: Layout, step: float = 2.0) -> float:
    """mm that the plate rises under a land in the middle of the first span, per newton; two spans at most are
    meshed."""
    c, ys = layout.design.clamp, list(layout.hold_down_y)[:3]
    end = layout.stop_plate_width / 2 - layout.hold_down_y[-1]
    low, high = ys[0] - end, ys[-1] + end
    half, t, hx, r = layout.stop_plate_half, c.stop_plate_thickness, layout.hold_down_x, 0.9
    y, w = (ys[0] + ys[1]) / 2, layout.design.sheet.thickness / 2
    land = (layout.pad_inner, layout.pad_inner + layout.design.stop.land_length, y - w, y + w)
    x_marks = [-half, half, *land[:2]] + [s * hx + d for s in (-1, 1) for d in (-r, r)]
    y_marks = [low, high, *land[2:]] + [v + d for v in ys for d in (-r, r)]
    grid = (
        lines([m for m in x_marks if abs(m) <= half], step),
        lines([m for m in y_marks if low <= m <= high], step),
    )
    basis = Basis(MeshHex.init_tensor(*grid, np.linspace(0, t, 3)), ElementHex2(), intorder=4)
    A = elasticity.stiffness_matrix(basis, *elasticity.lame(STEEL_MODULUS, STEEL_POISSON))
    at = basis.doflocs

    def mean(x0, x1, y0, y1, z):
        """Row that takes the mean rise of the nodes in that rectangle."""
        inside = (at[0] > x0 - 1e-6) & (at[0] < x1 + 1e-6) & (at[1] > y0 - 1e-6) & (at[1] < y1 + 1e-6)
        nodes = np.flatnonzero(inside & (abs(at[2] - z) < 1e-6))
        row = np.zeros(A.shape[0])
        row[3 * nodes + 2] = 1 / len(nodes)
        return row

    points = csc_matrix([mean(s * hx - r, s * hx + r, v - r, v + r, t) for s in (-1, 1) for v in ys])
    f = mean(*land, 0.0)
    first = int(np.argmin(np.abs(at - [[-half], [low], [0]]).sum(0)))
    other = int(np.argmin(np.abs(at - [[-half], [high], [0]]).sum(0)))
    u = elasticity.solve(
        (A + HELD * points.T @ points).tocsc(), f, np.array([3 * first, 3 * first + 1, 3 * other])
    )
    return float(f @ u)


@pytest.mark.by_day(2, "solid elements each")
@pytest.mark.parametrize(
    "changes, least, most",
    [
        ({}, 1.0, 1.9),  # the shipped array: 16 mm between set screws
        ({**LONG, "clamp.stop_plate_thickness": 2.0}, 1.0, 1.9),
        (WIDE, 1.0, 1.05),
        pytest.param(LONG, 1.0, 1.9, marks=pytest.mark.nightly),
        # the plate runs on past the set screws: over two spans 23/1536 P l^3/EI, not 1/48: a ratio of 1.39
        pytest.param({**LONG, "clamp.hold_down_pitch": 100.0}, 1.0, 1.5, marks=pytest.mark.nightly),
        pytest.param({"clamp.stop_plate_thickness": 2.0}, 1.0, 1.9, marks=pytest.mark.nightly),
        # as thick as half the way between set screws: the land's own dent in the steel is part of it
        pytest.param({"clamp.stop_plate_thickness": 7.0}, 0.95, 1.15, marks=pytest.mark.nightly),
    ],
)
def test_the_beams_err_to_the_soft_side(changes, least, most):
    layout = Layout(variant(changes))
    plate = layout.stop_plate_beams()
    # long plates: 0.6 % at most from elements of 2 mm, in a fifth of their time
    of_elements = rise(layout, 4.0 if "array.row_arms" in changes else 2.0)
    ratio = (plate.one - plate.screw) / of_elements
    print(f"{changes}: beams over elements {ratio:.3f}")
    assert least < ratio < most
    assert of_elements > 0.9 * plate.along.clamped()  # nor stiffer than between clamps
    if changes == WIDE:  # 0.105 mm of gap, and 0.5 mm of plate under the 7.3 N on its stop
        assert of_elements * 7.3 > 0.3 > 0.105
