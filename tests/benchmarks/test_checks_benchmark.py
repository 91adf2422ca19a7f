"""The benchmark of interference runs, and finds the same verdicts."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.cad
def test_smoke(tmp_path):
    figures = tmp_path / "figures.json"
    script = [sys.executable, ROOT / "benchmarks" / "checks.py", "--smoke", "--json", figures]
    run = subprocess.run(script, capture_output=True, text=True, check=False, cwd=ROOT)
    assert run.returncode == 0, run.stdout + run.stderr
    found = json.loads(figures.read_text())
    assert found["same_verdicts"] and found["findings"] > found["placed"]
