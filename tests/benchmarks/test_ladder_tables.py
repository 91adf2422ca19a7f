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
    rows = [line.split("|") for line in ladder_tables.papers_strains().splitlines()[2:]]
    for column in (4, 7):  # gauge over the paper's, at a = 4 and a = 8
        over = {(r[1].strip(), r[2].strip()): float(r[column]) for r in rows}
        assert over["solid", "one"] < 1.0 < over["short", "one"]
        assert over["solid", "two"] < 1.0 < over["plane", "two"]
