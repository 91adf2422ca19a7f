"""The shipped constants are the ones that the committed command writes from the shipped samples."""

from __future__ import annotations

import json

import numpy as np
import pytest
import samples
from exact_ladder import section
from ladder_fit import main

from tactcad.mechanics.register import ladder_data
from tactcad.mechanics.rungs import plane, solid


@pytest.fixture(scope="module")
def shipped():
    return samples.shipped()


@pytest.mark.slow  # half a minute of fitting
def test_command_gives_the_shipped_constants_again(tmp_path, capsys):
    assert main([str(tmp_path)]) == 0
    again, data = json.loads((tmp_path / "ladder.json").read_text()), ladder_data()
    assert again["range"] == data["range"]
    rng = np.random.default_rng(1)
    t, r, h = (rng.uniform(*ends, 200) for ends in ((0.15, 0.4), (0.1, 0.3), (1.5, 3)))
    s = section((t, 0.9, r, 5.0, h, 4.0, 3.0, 0.3, 1.0, 3.0), True)
    for group, f in (("root", plane.compliance), ("width", lambda s, k: solid.curled(s, plane.parts(s), k))):
        # the search's last digits may differ between machines; what it gives may not
        np.testing.assert_allclose(f(s, again[group]["two"]), f(s, data[group]["two"]), rtol=2e-5)
    for name, errors in again["report"]["relative_error"]["held out, box"]["one"].items():
        assert errors["max"] == pytest.approx(
            data["report"]["relative_error"]["held out, box"]["one"][name]["max"], rel=0.02
        ), name


def test_report_says_what_it_is_made_of():
    report = ladder_data()["report"]
    assert {"tactcad", "numpy", "scipy", "scikit-fem", "python"} <= set(report["versions"])
    assert report["samples"]["held out"]["seed"] != report["samples"]["fitted"]["seed"]
    for side in ("one", "two"):
        held_out = report["relative_error"]["held out, box"][side]
        for rung in ("plane, against plane elements", "solid, against solid elements"):
            assert held_out[rung]["max"] < 3.5e-3


def test_designs_are_drawn_again_from_their_seeds(shipped):
    for kind, said in ladder_data()["report"]["samples"].items():
        inside = said["designs"] * samples.EDGE_PART // (samples.EDGE_PART + 1)
        designs = samples.joined(samples.designs(kind, inside))
        for name, values in designs.items():
            np.testing.assert_array_equal(values, shipped[kind][name], err_msg=name)


@pytest.mark.parametrize("row", [0, 1, 17, 500])
def test_plane_samples_are_computed_again(shipped, row):
    columns = shipped["fitted"]
    again = samples.plane_results(samples.section(columns).rows(row))
    assert again["plane_stiffness"] == pytest.approx(columns["plane_stiffness"][row], rel=2e-5)
    assert again["grid_0.5"] == pytest.approx(columns["grid_0.5"][row], rel=2e-3)
    # the shipped peaks were read off quadratic elements, which leave up to a per cent of a fillet's
    assert 0.998 < again["slot_peak"] / columns["slot_peak"][row] < 1.012


def test_solid_sample_is_computed_again(shipped):
    columns = shipped["fitted"]
    again = samples.solid_results(samples.section(columns).rows(5))
    assert again["width_factor"] == pytest.approx(columns["width_factor"][5], rel=1e-5)


@pytest.mark.parametrize("kind", samples.DRAWS)
def test_corners_are_drawn_again_from_their_seeds(shipped, kind):
    for name, values in samples.draw_all(kind).items():
        np.testing.assert_array_equal(values, shipped[kind][name], err_msg=name)


def test_a_corner_is_computed_again(shipped):
    """By whatever mesh: what is stored of it is right to a tenth of what is claimed."""
    columns = shipped["corners"]
    narrow = np.isfinite(columns["width_factor"]) & (columns["hinge_length"] > columns["hinge_thickness"])
    i = int(np.argmin(np.where(narrow, columns["width"] * columns["hinge_length"], np.inf)))
    one = samples.section(columns).rows(i)
    found = samples.corner_results(one, True)
    for name in ("plane_stiffness", "width_factor"):
        assert found[name] == pytest.approx(columns[name][i], rel=3.5e-4)


def test_range_holds_the_small_version_and_the_box():
    groups = ladder_data()["range"]["groups"]
    assert groups["l/t"][0] < 0.1 / 0.3 and groups["l/t"][1] > 1.5 / 0.15
    assert groups["h/t"][1] > 3.0 / 0.05  # hinge of 0.05 mm under a full-size arm
    assert groups["r/t"][1] > 0.25 / 0.05


@pytest.mark.nightly
def test_whole_command_runs_on_few_samples(tmp_path):
    assert main([str(tmp_path), "--few"]) == 0
    assert {p.name for p in tmp_path.iterdir()} == {"ladder.json", "accuracy.json", *samples.FILES.values()}
