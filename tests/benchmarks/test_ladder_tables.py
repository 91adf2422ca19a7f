"""The tables in docs/mechanics.md and docs/accuracy.md are the computed ones."""

from __future__ import annotations

from pathlib import Path

import ladder_tables
import pytest

DOCUMENTS = "".join(
    (Path(__file__).parents[2] / "docs" / f"{name}.md").read_text("utf-8")
    for name in ("mechanics", "accuracy")
)
BY_ELEMENTS = "paper's strains by elements"


@pytest.mark.parametrize("name", [n for n in ladder_tables.TABLES if n != BY_ELEMENTS])
def test_document_holds_the_computed_table(name):
    assert ladder_tables.TABLES[name]() in DOCUMENTS


@pytest.mark.nightly
def test_document_holds_the_table_by_elements():
    assert ladder_tables.TABLES[BY_ELEMENTS]() in DOCUMENTS


def test_papers_strains_lie_between_the_rungs():
    """0.2711 % and 0.6316 %: the solid rung's gauge strain is below, the nominal one above, for both arms."""
    rows = [line.strip("|").split("|") for line in ladder_tables.papers_strains().splitlines()[2:]]
    over = {row[0].strip(): [float(cell) for cell in row[1:]] for row in rows}  # two-sided at 4, 8; one-sided
    for column in (2, 3):
        assert over["solid"][column] < 1.0 < over["short"][column]
    for column in (0, 1):
        assert over["solid"][column] < 1.0 < over["plane"][column]
