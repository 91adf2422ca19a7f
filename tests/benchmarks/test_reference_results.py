"""What docs/ shows of the benchmarks is made from the reference results, which say where they come from."""

from __future__ import annotations

import re
from pathlib import Path

import publish
import pytest
from bench import images, made_on
from bench_plots import figures
from measuring import BENCHMARKS
from tables import efficient
from test_bench_command import follows_schema

from tactcad.design.messages import InputError

ROOT = Path(__file__).parents[2]
RESULT = publish.load(ROOT / publish.REFERENCE)
BLOCK = re.compile(r"<!-- table (bench [^>]+?) -->\n(.*?)\n?<!-- end -->", re.DOTALL)


def test_the_reference_is_whole_and_says_machine_versions_and_date():
    follows_schema(RESULT)
    assert set(RESULT["benchmarks"]) == set(BENCHMARKS)
    said = made_on(RESULT)
    for word in (
        RESULT["date"],
        RESULT["machine"]["processor"],
        RESULT["versions"]["numpy"],
        f"seed {RESULT['seed']}",
        "CalculiX",
        "FreeCAD",
    ):
        assert str(word) in said


def test_every_block_is_the_reference_results():
    blocks = publish.blocks(RESULT)
    found = BLOCK.findall((ROOT / publish.DOCUMENT).read_text("utf-8"))
    assert found
    for name, text in found:
        assert text == blocks[name], f"{name}; `python benchmarks/publish.py` writes it"


def test_benchmarks_page_lets_one_choose():
    found = dict(BLOCK.findall((ROOT / "docs/benchmarks.md").read_text("utf-8")))
    table = found["bench choose"]
    rungs = {row["rung"]: row for row in RESULT["benchmarks"]["rungs"]["tables"]["rungs"]["rows"]}
    assert all(f"`{rung}`" in table for rung in rungs)
    for line in table.splitlines()[2:]:
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if cells[0].startswith("rung"):
            worst = rungs[cells[1].strip("`")]["solid worst"]
            assert float(cells[2].removesuffix(" %")) == pytest.approx(100 * worst, rel=0.05)  # two digits
    assert "full" in table and "envelope" in table and "rad" in table


@pytest.mark.slow  # all plots
def test_every_plot_is_made_from_the_reference_results():
    made = images(figures(RESULT))
    assert {
        f"bench-{n}.svg" for n in ("choose", "rungs", "meshes", "tessellation", "interference", "scaling")
    } == set(made)
    for name, data in made.items():
        assert (ROOT / "docs" / "images" / name).read_text("utf-8") == data, (
            f"{name}; `python benchmarks/publish.py` writes it"
        )


def test_rows_marked_as_worth_choosing_are_the_front():
    rows = [r for r in RESULT["benchmarks"]["meshes"]["tables"]["meshes"]["rows"] if r["against"] == "plane"]
    front = efficient([(r["seconds"], r["worst"]) for r in rows])
    assert [r["front"] for r in rows] == [i in front for i in range(len(rows))]


def test_a_further_run_takes_the_place_of_what_it_measured_and_is_named():
    more = {
        **RESULT,
        "mode": "full",
        "seed": 123456,
        "machine": RESULT["machine"] | {"load": 0.7},
        "benchmarks": {"scaling": {"tables": {}}},
    }
    both = publish.replaced({k: v for k, v in RESULT.items() if k != "further"}, more)
    assert (
        both["benchmarks"]["scaling"] == {"tables": {}}
        and both["benchmarks"]["rungs"] == RESULT["benchmarks"]["rungs"]
    )
    assert (
        "full run" in made_on(both)
        and "seed 123456" in made_on(both)
        and "load 0.7: scaling." in made_on(both)
    )
    with pytest.raises(InputError, match="its versions differ"):
        publish.replaced(RESULT, more | {"versions": RESULT["versions"] | {"numpy": "1.0"}})


def test_a_report_that_lacks_something_is_not_published(tmp_path):
    (tmp_path / "report.json").write_text(
        '{"schema": "tactcad-bench-1", "benchmarks": {"rungs": {"tables": {}}}}'
    )
    with pytest.raises(InputError, match="not a whole report"):
        publish.load(tmp_path / "report.json")
