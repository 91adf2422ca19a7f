"""Shares of variance against functions whose Sobol indices are known; the page stands alone."""

from __future__ import annotations

import re

import numpy as np
import pyarrow.parquet as pq
import pytest
from scipy.stats import qmc
from small_study import SMALL, THREE, WORDS, finished, swept, written

from tactcad.cli.main import main
from tactcad.sweep.study_page import first_order_share


def test_shares_of_ishigamis_function():
    """a = 7, b = 0.1: S1 = 0.3139, S2 = 0.4424, S3 = 0 (Ishigami and Homma 1990)."""
    x = np.pi * (2 * qmc.Sobol(3, rng=1).random(8192) - 1)
    y = np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    shares = [first_order_share(x[:, i], y) for i in range(3)]
    assert shares == pytest.approx([0.3139, 0.4424, 0.0], abs=0.015)


def test_shares_of_a_sum():
    """y = 3 a + b, both uniform: 9/10 and 1/10; a field of few values is binned by value."""
    a, b = np.repeat(np.arange(5.0), 400), np.tile(np.arange(5.0), 400)
    assert first_order_share(a, 3 * a + b) == pytest.approx(0.9, abs=1e-3)
    assert first_order_share(b, 3 * a + b) == pytest.approx(0.1, abs=5e-3)


def test_chance_explains_nothing():
    rng = np.random.default_rng(3)
    assert first_order_share(rng.random(500), rng.random(500)) < 0.05


@pytest.mark.slow  # a sweep of 128 designs on a cluster
def test_the_page_stands_alone(tmp_path, scheduler, capsys):
    path = written(tmp_path, count="128")
    assert swept(path, "--out", tmp_path / "out", "--scheduler", scheduler).returncode == 0
    assert main(["sweep", "plot", str(tmp_path / "out")]) == 0
    page = (tmp_path / "out" / "plot.html").read_text()
    assert "element.hinge_thickness" in page and "solid.E4.stiffness" in page and page.count("<svg") == 2
    assert not re.findall(r"(?:src|href)=[\"'](?!#|data:image)", page)
    assert "solid.E9.stiffness: most by element.hinge_thickness" in page
    for name in ("results.parquet", "manifest.json"):
        file = tmp_path / "out" / name
        as_written = file.read_bytes()
        file.write_bytes(as_written.replace(b'"refused": 0', b'"refused": 7') + b"\n")
        assert main(["sweep", "plot", str(tmp_path / "out")]) == 2
        assert f"{file}: altered since " in capsys.readouterr().err
        file.write_bytes(as_written)


def test_three_designs_have_pairs(tmp_path):
    assert finished(written(tmp_path, THREE), tmp_path / "out") == 0
    assert main(["sweep", "plot", str(tmp_path / "out")]) == 0
    page = (tmp_path / "out" / "plot.html").read_text()
    assert "3 designs were measured: shares and main effects take more than 10" in page
    assert page.count("<svg") == 1 and "thickness" in page and "title" in page and "stiffness" in page


@pytest.mark.parametrize("values, measured", [("[0.3, 0.3]", 2), ("[0.3, 2.5]", 1), ("[2.5, 2.6]", 0)])
def test_what_lacks_is_said(tmp_path, capsys, values, measured):
    text = THREE.replace("[0.25, 0.3, 0.35]", values).replace(str(WORDS), '["A", "A"]')
    assert finished(written(tmp_path, text), tmp_path / "out") == (measured == 0)
    capsys.readouterr()
    assert main(["sweep", "plot", str(tmp_path / "out")]) == 1
    said = f"no varied field differs among the designs that were measured ({measured} of 2)"
    assert capsys.readouterr().err == f"tactcad: {tmp_path}/out: nothing to plot: {said}\n"


def test_another_table_than_the_manifests_is_refused(tmp_path, capsys):
    assert finished(written(tmp_path, THREE), tmp_path / "out") == 0
    table = tmp_path / "out" / "results.parquet"
    pq.ParquetWriter(table, pq.read_schema(table)).close()  # columns without rows
    assert main(["sweep", "plot", str(tmp_path / "out")]) == 2
    assert "results.parquet: altered since the sweep wrote it" in capsys.readouterr().err


@pytest.mark.slow  # a sweep of 128 designs on a cluster
def test_words_have_shares_too(tmp_path, scheduler):
    """Two forms of hinge, and a thickness that hardly varies: the form decides all."""
    words = '[vary."element.sides"]\nvalues = ["one", "two"]\n[vary."design.title"]\nvalues = ["A"]\n'
    text = SMALL.replace("[0.2, 0.4]", "[0.3, 0.3002]").replace("[6, 9]", "[8, 8.001]")
    path = written(tmp_path, text.replace("[measure]", words + "[measure]"), count="128")
    assert swept(path, "--out", tmp_path / "out", "--scheduler", scheduler).returncode == 0
    table = pq.read_table(tmp_path / "out" / "results.parquet")
    stiffness = {
        w: [r["solid.E4.stiffness"] for r in table.to_pylist() if r["element.sides"] == w]
        for w in ("one", "two")
    }
    apart = np.mean(stiffness["two"]) - np.mean(stiffness["one"])
    assert apart > 50 * max(map(np.ptp, stiffness.values()))  # so its share is 1 within 1e-3
    assert main(["sweep", "plot", str(tmp_path / "out")]) == 0
    page = (tmp_path / "out" / "plot.html").read_text()
    assert "solid.E4.stiffness: most by element.sides, 100 %" in page
    assert "so few designs: design.title." in page
