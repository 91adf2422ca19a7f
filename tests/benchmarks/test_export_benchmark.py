"""The benchmark compares like with like: same number of solids and files, and designs that are legal."""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from pathlib import Path

import pytest

from tactcad.design.load import parse
from tactcad.parts.rules import refuse_broken
from tactcad.scenes.array import array

FOLDER = Path(__file__).parents[2] / "benchmarks"
spec = importlib.util.spec_from_file_location("benchmark_export", FOLDER / "export.py")
benchmark = importlib.util.module_from_spec(spec)
spec.loader.exec_module(benchmark)


@pytest.mark.parametrize("elements", benchmark.SIZES)
@pytest.mark.parametrize("changed", [False, True])
def test_its_designs_are_legal_and_of_the_size_they_say(elements, changed):
    design = parse(benchmark.design_text(elements, changed), "benchmark")
    refuse_broken(design)
    assert sum(map(len, design.array.row_arms)) == elements


def test_ten_elements_are_the_published_design():
    text = benchmark.DESIGN.read_text()
    assert parse(benchmark.design_text(10), "a") == parse(text, "a")
    assert parse(benchmark.design_text(10, changed=True), "a") != parse(text, "a")


def test_the_baseline_imports_no_tactcad():
    assert "import tactcad" not in benchmark.BASELINE.read_text()
    assert "from tactcad" not in benchmark.BASELINE.read_text()


@pytest.mark.nightly
def test_the_smoke_run(tmp_path):
    run = subprocess.run(
        [sys.executable, FOLDER / "export.py", "--smoke", "--json", tmp_path / "times.json"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    (row,) = json.loads((tmp_path / "times.json").read_text())["rows"]
    assert row["cold"] > row["unchanged"]


@pytest.mark.nightly
def test_baseline_and_export_write_the_same_number_of_solids(tmp_path):
    run = subprocess.run(
        [sys.executable, benchmark.BASELINE, "10", tmp_path / "plain"], capture_output=True, text=True, check=True
    )
    design = parse(benchmark.design_text(10), "benchmark")
    assert f"{len(array(design).parts)} distinct parts, {len(array(design).placements)} solids" in run.stdout
