"""The gripper of docs/notebooks/robot.ipynb, run whole."""

from __future__ import annotations

import re
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

pytestmark = [pytest.mark.slow, pytest.mark.cad]  # starts a kernel, makes an export
NOTEBOOK = Path(__file__).parents[2] / "docs" / "notebooks" / "robot.ipynb"


def test_the_notebook_finds_the_foam(tmp_path):
    """3 N/mm, written in it, within 2 % and inside its interval; a picture is drawn."""
    notebook = nbformat.read(NOTEBOOK, 4)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in code)
    assert sum(len(cell.source.splitlines()) for cell in code) <= 40
    place = {"metadata": {"path": str(tmp_path)}}
    NotebookClient(notebook, timeout=600, kernel_name="python3", resources=place).execute()
    outputs = code[-1].outputs
    said = "".join(o.text for o in outputs if o.output_type == "stream" and o.name == "stdout")
    found, low, high, force = map(float, re.findall(r"[\d.]+", said)[:4])
    assert found == pytest.approx(3.0, rel=0.02) and low < 3.0 < high and force > 1
    assert any("image/png" in o.get("data", {}) for o in outputs)
