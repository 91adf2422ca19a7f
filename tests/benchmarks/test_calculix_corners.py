"""Corners of the accepted range by CalculiX: benchmarks/results/calculix_corners.md, and what it says."""

from __future__ import annotations

from dataclasses import astuple
from pathlib import Path

import calculix
import calculix_corners
import pytest
from calculix_corners import CORNERS, QUANTITIES, Compared, compared, stated

from tactcad.mechanics import ladder, validity

DOCUMENT = (Path(__file__).parents[2] / "benchmarks" / "results" / "calculix_corners.md").read_text("utf-8")


def stored(corner):
    """The rows of one corner as the document has them."""
    block = DOCUMENT.split(f"<!-- table {calculix_corners.TABLE} -->\n")[1].split("\n<!-- end -->")[0]
    count = len(QUANTITIES)
    for row in block.splitlines()[2:][count * corner : count * (corner + 1)]:
        _, _, quantity, value, *shares = (cell.strip(" %") for cell in row.strip("|").split("|"))
        yield Compared(quantity, float(value), *(float(share) / 100.0 for share in shares))


def agree(one):
    """The program's rungs differ from CalculiX by no more than both state of themselves."""
    assert abs(one.elements) <= one.elements_stated + one.error, one
    assert abs(one.closed) <= one.closed_stated + one.error, one


@pytest.mark.parametrize("corner", range(len(CORNERS)))
def test_stored_table_agrees_and_is_of_todays_closed_forms(corner):
    s, rows = CORNERS[corner], list(stored(corner))
    assert [one.quantity for one in rows] == list(QUANTITIES) and validity.reasons(s, "solid") == ""
    for one in rows:
        agree(one)
    grid = float(s.hinge_length) / 2.0
    for column, rung in (("elements_stated", "fem-solid"), ("closed_stated", "solid")):
        assert [getattr(one, column) for one in rows] == pytest.approx(stated(s, rung, grid), rel=0.05)
    now = float(ladder.stiffness(s, "solid")) / rows[0].calculix - 1.0
    assert now == pytest.approx(rows[0].closed, abs=2e-5, rel=0.05)


def test_errors_of_calculix_are_smaller_than_what_is_stated_of_the_default_rung():
    """Else agreement would say nothing. It says nothing of the second corner's fillet: since its zone was
    fitted anew, less is stated of it than these bricks reach."""
    blind = {
        (corner, one.quantity)
        for corner in range(len(CORNERS))
        for one in stored(corner)
        if one.error > (0.1 if one.quantity == "K" else 0.5) * one.closed_stated
    }
    assert blind == {(1, "fillet strain"), (1, "fillet stress")}


@pytest.mark.nightly
@pytest.mark.skipif(calculix.executable() is None, reason="CalculiX (ccx) is not installed")
@pytest.mark.parametrize("corner", range(len(CORNERS)))
def test_corner_by_calculix_again(corner):
    for one, before in zip(compared(CORNERS[corner]), stored(corner), strict=True):
        agree(one)
        assert astuple(one)[1] == pytest.approx(before.calculix, rel=1e-4)
        assert astuple(one)[2:] == pytest.approx(astuple(before)[2:], rel=0.1, abs=2e-5)
