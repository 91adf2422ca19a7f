"""The read-outs side by side in docs/circuit.md are what the program says, and what a count by hand gives."""

from __future__ import annotations

from pathlib import Path

import pytest
from read_outs import read_outs
from tables import renewed

DOCUMENT = Path(__file__).parents[2] / "docs" / "circuit.md"


def test_the_document_has_the_table_as_it_is():
    text = DOCUMENT.read_text("utf-8")
    assert "<!-- table read-outs -->" in text and renewed(text, {"read-outs": read_outs}) == text


def test_chips_parts_and_heat_by_hand():
    """Two boards: amplifier, multiplexer, decoder and regulator, or converter and two regulators. Three arms
    and a switch a channel, or a capacitor. All grids bear the same heat: EXC grows as the root of ohms."""
    rows = [[cell.strip() for cell in row.split("|")[1:-1]] for row in read_outs().splitlines()[2:]]
    assert [row[5].split(", ")[0] for row in rows] == ["8", "6", "6", "6", "6"]
    assert {row[6] for row in rows} == {"4"}
    volts = [float(row[1]) for row in rows]
    assert volts[3] / volts[1] == pytest.approx((350 / 120) ** 0.5, rel=0.02)
    assert volts[4] / volts[1] == pytest.approx((1000 / 120) ** 0.5, rel=0.02)
    assert volts[2] / volts[1] == pytest.approx(0.358**-0.5, rel=0.02)
