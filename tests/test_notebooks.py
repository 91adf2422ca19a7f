"""Every notebook of docs/notebooks is committed as it was written, and every one runs whole."""

from __future__ import annotations

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

ROOT = Path(__file__).parents[1]
ELSEWHERE = ("review", "robot")  # run, with what they show, by tests/review and tests/robot
NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"), key=lambda path: path.stem)
SAID = {
    "family": ("exponent", ("{4.0: 2.", "8.0: 2.")),
    "own-part": ("collision", ("OWN1", "CA1")),
    "readings": ("object", ("sample", "3.84")),
    "sweep": ("read", ("K of element 4: 7.", "standard deviation 2.9")),
    "target": ("estimate", ("K N/mm",)),
}  # by notebook: the cell whose output holds these


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_is_committed_without_outputs(path):
    notebook = nbformat.read(path, 4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert code and all(cell.execution_count is None and not cell.outputs for cell in code)
    assert path.stem in {*SAID, *ELSEWHERE}


@pytest.mark.slow  # starts a Jupyter kernel
@pytest.mark.cad
@pytest.mark.parametrize("name", SAID)
def test_it_runs_and_says_what_it_is_about(name, tmp_path):
    folder = tmp_path / "docs" / "notebooks"  # a copy, so that nothing is written beside the pages
    folder.mkdir(parents=True)
    (tmp_path / "hardware").symlink_to(ROOT / "hardware")
    notebook = nbformat.read(ROOT / "docs" / "notebooks" / f"{name}.ipynb", 4)
    place = {"metadata": {"path": str(folder)}}
    NotebookClient(notebook, timeout=600, kernel_name="python3", resources=place).execute()
    cell, parts = SAID[name]
    outputs = next(c.outputs for c in notebook.cells if c.id == cell)
    text = "".join(o.get("text", "") or o["data"]["text/plain"] for o in outputs)
    assert all(part in text for part in parts), text
