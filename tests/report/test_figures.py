"""Figures of records: declared once, refused where a declaration lacks something."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from tactcad.report.figures import Figure, Figures, csv_lines, text_table


@dataclass(frozen=True)
class Spring:
    name: str
    stiffness: float  # N/mm
    deflection: float | None  # mm


K = Figure("stiffness", "K", "N/mm", 1.0, ".4g")
D = Figure("deflection", "deflection", "um", 1e3, ".1f")


@pytest.mark.parametrize(
    "declare, missing",
    [
        (lambda: Figures(Spring, K), "no figure is declared for deflection"),
        (lambda: Figures(Spring, K, D, K), "declared twice: stiffness"),
        (lambda: Figures(Spring, K, D, Figure("force", "F", "N", 1.0, "g")), "has no number force"),
        (lambda: Figure("stiffness", "", "N/mm", 1.0, ".4g"), "lacks its heading"),
        (lambda: Figure("stiffness", "K", "N/mm", 0.0, ".4g"), "a scale of 0"),
        (lambda: Figure("stiffness", "K", "N/mm", 1.0, "four"), "digits 'four'"),
    ],
)
def test_an_incomplete_or_doubled_declaration_is_refused(declare, missing):
    with pytest.raises(TypeError, match=missing):
        declare()


def test_text_and_csv_follow_from_the_declaration():
    figures = Figures(Spring, K, D).some("stiffness", "deflection")
    rows = [Spring("soft", 1.23456, 0.5), Spring("stiff", 100.0, None)]
    assert text_table(figures, rows) == [
        "    K  deflection",
        " N/mm          um",
        "1.235       500.0",
        "  100           -",
    ]
    assert csv_lines(figures, rows) == [
        ["stiffness_N_per_mm", "deflection_um"],
        ["1.235", "500.0"],
        ["100", ""],
    ]
    assert csv_lines(figures, rows, ".9g")[1] == ["1.23456", "500"]
