"""What the set screws do to an element that was calibrated before them: they press the stop plate on its
ledge, beside the hinge. By elements on the whole contour under a flat rigid plate; docs/rigs.md has the
figures.

A preload by itself changes no stiffness of a linear body; that the plate holds the ledge where it touches
does.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from skfem import Basis, ElementTriP2

from tactcad.fem import elasticity
from tactcad.fem.free_mesh import Fine, triangle_mesh
from tactcad.fem.space import line_load
from tactcad.parts.array import seating
from tactcad.parts.array.element import element
from tactcad.parts.array.layout import ElementPlace, Layout
from tactcad.parts.rules import load

RIGS = Path(__file__).parents[2] / "docs" / "rigs.md"
LAYOUT = Layout(load("macro-array"))
pytestmark = pytest.mark.slow  # meshes of five arms under a plate; by day test_leaf_clamp.py
PLACES = {place.arm: place for place in LAYOUT.elements}


def pressed(place: ElementPlace, finest: float = 8.0) -> tuple[float, float]:
    """By what share K rises once the plate lies pressed on the ledge, and how far the pad moves towards the
    object (mm) under the element's part of all set screws' force."""
    d, t, l = LAYOUT.design, place.hinge.t, place.hinge.l
    body = element(LAYOUT, place).extrusion
    fine = tuple(Fine((x, t), t / finest) for x in place.hinge_x + np.linspace(-l / 2, l / 2, 15))
    basis = Basis(triangle_mesh(body.outer, body.openings, fine, 0.4), ElementTriP2(), intorder=4)
    x, z = basis.doflocs
    lame = elasticity.lame(d.material.youngs_modulus, d.material.poisson, plane_stress=True)
    A = elasticity.stiffness_matrix(basis, *lame) * d.sheet.thickness
    low, high = LAYOUT.spacer_z
    clamped = np.flatnonzero((x > LAYOUT.clamp_edge - 1e-9) & (z > low - 1e-9) & (z < high + 1e-9))
    fixed = np.concatenate([2 * clamped, 2 * clamped + 1])

    def along(edge: float, x0: float, x1: float, force: float) -> np.ndarray:
        on = np.flatnonzero((np.abs(z - edge) < 1e-9) & (x > x0 - 1e-9) & (x < x1 + 1e-9))
        on = on[np.argsort(x[on])]
        f = np.zeros(A.shape[0])
        f[2 * on + 1] = line_load(x[on], lambda q: np.full_like(q, force / np.ptp(x[on])), 2)
        return f

    pad = along(-d.element.pad_height, LAYOUT.pad_inner, LAYOUT.pad_outer, 1.0)
    ledge = np.flatnonzero((np.abs(z - LAYOUT.ledge) < 1e-9) & (x < LAYOUT.clamp_edge))
    touching = ledge[x[ledge] < LAYOUT.stop_plate_half + 1e-9]
    while True:  # a flat rigid plate pressed down: nodes that it would have to pull come off
        down = np.zeros(A.shape[0])
        down[2 * touching + 1] = -1.0
        under = down + elasticity.solve(A, -(A @ down), np.union1d(fixed, 2 * touching + 1))
        force = (A @ under)[2 * touching + 1]
        if (force <= 0.0).all():
            break
        touching = touching[force <= 0.0]
    free = elasticity.solve(A, pad, fixed)
    held = elasticity.solve(A, pad, np.union1d(fixed, 2 * touching + 1))
    share = seating.force(LAYOUT) * 2 * len(LAYOUT.hold_down_y) / len(LAYOUT.elements)
    moved = -float(pad @ under) / -float(force.sum()) * share
    return float((pad @ free) / (pad @ held)) - 1.0, moved


@pytest.fixture(scope="module")
def found() -> dict[float, tuple[float, float]]:
    return {arm: pressed(place) for arm, place in sorted(PLACES.items())}


@pytest.mark.slow  # solid elements
def test_pressing_the_plate_on_makes_no_element_stiffer_than_a_calibration_tells(found):
    """A short arm's body gives way most, so its K rises most; a hinge 5 um thicker makes 5 %."""
    rises = [rise for rise, _ in found.values()]
    assert rises == sorted(rises, reverse=True) and 0.0 < rises[-1] and rises[0] < 0.01


def test_pads_move_together(found):
    """The plate is flat and touches where bodies give way least: what the pads move apart is a tenth of what
    makes them coplanar."""
    moves = [moved for _, moved in found.values()]
    assert max(moves) < LAYOUT.design.tolerance.pad_height
    assert max(moves) - min(moves) < LAYOUT.design.tolerance.pad_height / 10


def test_the_documented_figures_are_these(found):
    rows = re.findall(r"\| (\d) \| \+([\d.]+) % \| ([\d.]+) \|", RIGS.read_text("utf-8"))
    assert {float(arm): (float(rise), float(um)) for arm, rise, um in rows} == {
        arm: (float(f"{100 * rise:.1g}"), float(f"{1e3 * moved:.2g}")) for arm, (rise, moved) in found.items()
    }
