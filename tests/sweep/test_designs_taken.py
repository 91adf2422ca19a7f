"""Designs by their index, against itertools and scipy's own samples and distributions."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy import stats
from scipy.stats import qmc
from small_study import SMALL, written

from tactcad.design.load import from_table, read
from tactcad.sweep.designs_taken import designs_taken, points_at_powers, stretch, table_of
from tactcad.sweep.study import read_study

T, ARM = "element.hinge_thickness", "array.row_arms[0][3]"
BOTH = ([0.2, 6.0], [0.4, 9.0])


@pytest.mark.parametrize("sampling, sampler", [("sobol", qmc.Sobol), ("latin-hypercube", qmc.LatinHypercube)])
def test_drawn_designs_are_scipys(tmp_path, sampling, sampler):
    study = read_study(written(tmp_path, sampling=f'"{sampling}"', count="64"))
    wanted = qmc.scale(sampler(2, rng=3).random(64), *BOTH)
    columns = designs_taken(study, 0, 64)
    assert np.allclose(np.column_stack([columns[T], columns[ARM]]), wanted, rtol=1e-14)


@pytest.mark.parametrize("sampling", ["sobol", "latin-hypercube"])
def test_chunks_are_the_whole(tmp_path, sampling):
    study = read_study(written(tmp_path, sampling=f'"{sampling}"'))
    whole = designs_taken(study, 0, 24)
    for start, stop in ((0, 5), (5, 6), (6, 24)):
        for path, column in designs_taken(study, start, stop).items():
            assert np.array_equal(column, whole[path][start:stop])


def test_a_grid_is_every_combination_the_last_field_fastest(tmp_path):
    text = SMALL.replace('"sobol"', '"grid"').replace("count = 24", "")
    text = text.replace("range = [0.2, 0.4]", "range = [0.2, 0.4]\nsteps = 3")
    text = text.replace("range = [6, 9]", "values = [7, 6.5]")
    text += '[vary."element.sides"]\nvalues = ["one", "two"]\n'
    study = read_study(written(tmp_path, text))
    got = list(zip(*designs_taken(study, 0, study.count).values()))
    wanted = list(itertools.product([0.2, 0.3, 0.4], [7, 6.5], ["one", "two"]))
    assert len(got) == 12 and all(a[1:] == b[1:] and a[0] == pytest.approx(b[0]) for a, b in zip(got, wanted))
    assert [v[4] for v in designs_taken(study, 3, 9).values()] == list(got[7])


def test_normal_is_cut_at_its_limits(tmp_path):
    text = SMALL.replace("range = [0.2, 0.4]", "normal = 0.02").replace("count = 24", "count = 4096")
    study = read_study(written(tmp_path, text))
    drawn = designs_taken(study, 0, 4096)[T]
    t = study.design.element.hinge_thickness
    cut = stats.truncnorm(-2, 2, loc=t, scale=0.01)
    assert stats.kstest(drawn, cut.cdf).statistic < 2e-3  # evenly spread: far below chance's 0.02
    assert drawn.min() >= t - 0.02 and drawn.max() <= t + 0.02


def test_values_are_drawn_as_often_each(tmp_path):
    text = SMALL.replace("range = [0.2, 0.4]", "values = [0.2, 0.3, 0.35, 0.4]").replace("24", "1024")
    drawn = designs_taken(read_study(written(tmp_path, text)), 0, 1024)[T]
    values, counts = np.unique(drawn, return_counts=True)
    assert values.tolist() == [0.2, 0.3, 0.35, 0.4] and set(counts) == {256}


def test_a_value_stands_where_its_path_says(tmp_path):
    text = SMALL.replace('"sobol"', '"list"').replace("count = 24", "").replace("[6, 9]", "[9.5]")
    text = text.replace("range = [0.2, 0.4]", "values = [0.3]").replace("range = [9.5]", "values = [9.5]")
    others = {
        "element.override.2.arm_height": 2.5,
        "holes.screw_offsets[1]": 14.0,
        "rating.force": 1.5,
        "design.revision": '"Z"',
    }
    text += "".join(f'[vary."{path}"]\nvalues = [{value}]\n' for path, value in others.items())
    study = read_study(written(tmp_path, text))
    design = from_table(table_of(study, designs_taken(study, 0, 1), 0))
    base = read("macro-array")
    assert design.element.hinge_thickness == 0.3 and design.element.override[2].arm_height == 2.5
    assert design.array.row_arms[0] == (*base.array.row_arms[0][:3], 9.5, *base.array.row_arms[0][4:])
    assert design.array.row_arms[1] == base.array.row_arms[1]
    assert design.holes.screw_offsets == (base.holes.screw_offsets[0], 14.0)
    assert design.rating.force == 1.5 and design.design.revision == "Z"
    assert study.design == base


@pytest.mark.parametrize("start, stop", [(0, 1), (1, 2), (5, 6), (3, 70), (4095, 4097), (999_999, 1_010_000)])
@pytest.mark.parametrize("fields", [1, 5])
def test_any_stretch_of_a_sobol_sequence_is_scipys(fields, start, stop):
    sampler = qmc.Sobol(fields, rng=7)
    wanted = (sampler.fast_forward(start) if start else sampler).random(stop - start)
    for count in (stop, 2_000_000):
        assert np.array_equal(stretch(points_at_powers(fields, count, 7), start, stop), wanted)
