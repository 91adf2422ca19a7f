"""The elements behind the picture of a hard lump, against the layer's closed forms and by reciprocity."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import planar_inclusion as lump
import pytest

from tactcad.families.planar.cell_layout import PlanarLayout
from tactcad.parts.rules import load

X, Y, WIDTH = np.array([0.0, 8.0, 0.0, 8.0]), np.array([0.0, 0.0, 8.0, 8.0]), 2.127


@pytest.mark.nightly
def test_elements_with_and_without_a_lump():
    """Half a minute: two solves with elements, which too few of them and a near side leave 15 % off."""
    soft, hard = (lump.stiffness(X, Y, WIDTH, (0.0, 0.0), E) for E in (lump.SOFT, lump.HARD))
    closed = lump.without_lump(X, Y, WIDTH)
    assert np.diag(soft) == pytest.approx(np.diag(closed), rel=0.2)
    for K in (soft, hard):
        assert pytest.approx(K.T, abs=1e-9) == K
        assert (np.linalg.eigvalsh(K) > 0.0).all()
    assert np.linalg.eigvalsh(hard - soft).min() > -1e-9  # a stiffer body never softens: Rayleigh
    assert 1.2 < hard[0, 0] / soft[0, 0] < 2.0 and abs(hard[3, 3] / soft[3, 3] - 1.0) < 0.01


def test_mesh_lines_hold_pads_and_lump():
    lines = lump.lines(np.array([-4.0, 4.0]), 1.0, 4.0)
    assert {-5.0, -3.0, 3.0, 5.0, 2.5, 5.5, 0.0, -12.0, 12.0} <= set(lines.tolist())


def test_readings_behind_the_picture_hold_the_forces():
    layout = PlanarLayout(load(str(Path(__file__).parents[2] / "hardware" / "planar-array.toml")))
    seen = lump.felt(layout, np.ones(36))
    sums = seen.forces.force[..., 2].sum(axis=0)
    assert sums == pytest.approx(lump.LOADS, rel=0.05)
