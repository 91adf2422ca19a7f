"""Planar cells by CalculiX: benchmarks/results/calculix_cells.md, and what is said of it."""

from __future__ import annotations

from dataclasses import astuple, replace
from pathlib import Path

import calculix
import calculix_cells
import numpy as np
import pytest
from calculix_cells import (
    CELLS,
    QUANTITIES,
    SUMS,
    TABLE,
    Compared,
    Whole,
    by_calculix,
    by_closed_form,
    compared,
)

from tactcad.families.planar import beam
from tactcad.families.planar.beam import FoilBeam
from tactcad.families.planar.cell import Cell, roots

needs_ccx = pytest.mark.skipif(calculix.executable() is None, reason="CalculiX (ccx) is not installed")
DOCUMENT = (Path(__file__).parents[2] / "benchmarks" / "results" / "calculix_cells.md").read_text("utf-8")


def stored(table):
    """Cells of a table's rows, without form and dimensions."""
    block = DOCUMENT.split(f"<!-- table {table} -->\n")[1].split("\n<!-- end -->")[0]
    return [[cell.strip() for cell in row.strip("|").split("|")][2:] for row in block.splitlines()[2:]]


def share(text):
    return float(text.removesuffix(" %")) / 100.0


def quantities(cell):
    count = len(QUANTITIES)
    for name, value, *shares in stored(TABLE)[count * cell : count * (cell + 1)]:
        yield Compared(name, float(value), *map(share, shares))


def whole(cell):
    cross, *shares = stored(SUMS)[cell]
    return Whole(float(cross), *map(share, shares))


def test_the_cells_are_in_range_and_of_both_forms():
    beams = [cell.beam for cell in CELLS]
    assert len(CELLS) == 8 and not any(map(beam.out_of_range, beams))
    assert {sizes[0] for sizes in calculix_cells.SIZES} == {"straight", "pinwheel"}
    assert min(b.thickness for b in beams) == 0.03 and max(b.thickness for b in beams) == 0.5
    assert {round(b.bevel / b.thickness, 9) for b in beams} == {0.0, 0.1, 0.2}


@pytest.mark.parametrize("cell", range(len(CELLS)))
def test_closed_form_meets_calculix(cell):
    """Compliance within 1 %, cross terms within 1 % of the geometric mean, stress within 3 %, and all within
    what is stated and CalculiX's own error; the closed form is today's."""
    rows, C = list(quantities(cell)), CELLS[cell].compliance
    assert [one.quantity for one in rows] == list(QUANTITIES)
    for one, (value, stated) in zip(rows, by_closed_form(CELLS[cell]), strict=True):
        assert abs(one.closed) < (0.01 if one.quantity.startswith("compliance") else 0.03)
        assert abs(one.closed) <= one.stated + one.error and one.stated == pytest.approx(stated, rel=0.05)
        assert value / one.calculix - 1.0 == pytest.approx(one.closed, abs=2e-5, rel=0.05)
    cross = C / np.sqrt(np.outer(np.diag(C), np.diag(C))) - np.eye(6)
    assert np.abs(cross).max() < 1e-9 and whole(cell).cross < 1e-4


def test_a_cells_stress_is_at_most_its_own_error_below_the_largest():
    """And above it by as much as modes that are largest at different places add: a third at most here."""
    every = [whole(cell) for cell in range(len(CELLS))]
    assert all(one.least <= min(one.down, one.sideways) <= one.most for one in every)
    assert min(one.least for one in every) > -0.03 and 0.3 < max(one.most for one in every) < 0.4


@needs_ccx
def test_one_beam_by_a_coarse_mesh():
    """Its reactions are reciprocal, and its stiffness in each mode is the closed form's."""
    cell = Cell(CELLS[5].beam, CELLS[5].roots[:1])
    K = by_calculix(cell, 1).stiffness
    assert np.abs(K - K.T).max() < 1e-6 * np.abs(K).max()
    pure = np.linalg.inv(cell.modes[0])
    k = [beam.stiffness(cell.beam)[m] for m in beam.MODES]
    assert np.diag(pure.T @ K @ pure) == pytest.approx(k, rel=0.02)


@needs_ccx
@pytest.mark.parametrize(
    "etched", [FoilBeam(4.0, 0.4, 0.08, 0.1, 1.0, 0.3, 0.016), FoilBeam(2.2, 0.9, 0.08, 0.2, 1.0, 0.3, 0.016)]
)
def test_bevels_take_as_much_off_solids_as_off_the_closed_form(etched):
    """Of planar-array's two beams, mode by mode, what a bevel leaves of the stiffness."""

    def both(b):
        cell = Cell(b, roots("straight", 3.0, 0.0, 0.0)[:1])
        pure = np.linalg.inv(cell.modes[0])
        solid = np.diag(pure.T @ by_calculix(cell, 2).stiffness @ pure)
        return np.array([solid, [beam.stiffness(b)[m] for m in beam.MODES]])

    solid, closed = both(etched) / both(replace(etched, bevel=0.0))
    assert solid.max() < 0.99 and closed == pytest.approx(solid, rel=0.004)


@pytest.mark.nightly
@needs_ccx
@pytest.mark.parametrize("cell", range(len(CELLS)))
def test_cell_by_calculix_again(cell):
    rows, over = compared(CELLS[cell])
    for one, before in zip(rows, quantities(cell), strict=True):
        assert one.calculix == pytest.approx(before.calculix, rel=1e-4)
        assert astuple(one)[2:] == pytest.approx(astuple(before)[2:], rel=0.1, abs=2e-5)
    assert astuple(over)[1:] == pytest.approx(astuple(whole(cell))[1:], abs=2e-3)
