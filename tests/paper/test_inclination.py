"""Table 2's samples as inclined layers: angles by code of the test's own, and the F test by hand."""

from __future__ import annotations

import numpy as np
import pytest
from lab import layer_labs as labs
from scipy.optimize import least_squares
from scipy.stats import f as f_distribution

from tactcad.paper import inclination, reference_stiffness
from tactcad.paper.grasp_figures import elements_in_parallel


@pytest.fixture(scope="module")
def found(paper, array):
    return inclination.study(paper, array, reference_stiffness.study(paper))


@pytest.mark.slow  # a search with 144 patches a pad
def test_angles_agree_with_those_of_single_patches(found, paper, array):
    """Love's closed form, an integral for the layer, and a least-squares search of scipy's from a level face:
    both angles of every sample are the stated ones within a twentieth of their intervals, and so are the
    ratios at these, within 0.5 %."""
    truth, r = elements_in_parallel(paper, array)
    at = array.rows(truth.element)
    x, y = array.pad_x[at], array.pad_y[at]
    lever = -np.sign(x) * np.broadcast_to(array.section.load_arm, array.number.shape)[at]
    width = float(np.broadcast_to(array.section.width, array.number.shape)[0])
    nu, h = array.sample.poisson, found.thickness
    bench = labs.Bench(x, y, array.pad_length, width, lever, nu, h, 6, 8)
    one = labs.Bench(x[:1], y[:1], array.pad_length, width, np.full(1, 1e9), nu, h, 6, 8)
    K = truth.stiffness.copy()
    K[r] = found.inclined.reference
    rows = [int(np.argmin(np.abs(truth.stiffness - k))) for k in paper.table2.measuring_stiffness.value]
    g = array.grasping
    load = g.moving_weight + g.weight * g.weights * np.array([0.0, 0.5, 1.0])
    level = np.linalg.solve(one.C, np.ones(one.m)) @ one.area  # K_obj of a level pad at 1 MPa

    def ln_ratio(sample: int, slope: np.ndarray) -> np.ndarray:
        E = paper.table2.object_stiffness.value[sample] / level
        sink = bench.sinks(E, K, np.zeros(len(K)), tuple(slope), load).sum(1)
        return np.log(np.maximum(sink[rows], 1e-9) / sink[r])

    measured = np.log(paper.table2.ratio.value)
    assert measured.shape[1] == 8
    for sample, (stated, half) in enumerate(zip(found.inclined.slope, found.inclined.slope_half)):
        off = ln_ratio(sample, stated) - measured[:, sample]
        assert off == pytest.approx(found.inclined.left[:, sample], abs=0.005)
        own = least_squares(lambda s: ln_ratio(sample, s) - measured[:, sample], np.zeros(2))  # noqa: B023
        assert (np.abs(own.x - stated) < 0.05 * half).all()


@pytest.mark.slow  # the fit of all samples
def test_the_f_test_is_that_of_the_sums_of_squares(found):
    """Two angles a sample against none."""
    level, inclined = found.level, found.inclined
    extra = 2 * inclined.slope.shape[0]
    rest = inclined.left.size - inclined.parameters
    f = ((level.left**2).sum() - (inclined.left**2).sum()) / extra / ((inclined.left**2).sum() / rest)
    assert found.f == pytest.approx(f) and found.p == pytest.approx(f_distribution.sf(f, extra, rest))
    assert 2 < found.f < 6 and found.p < 0.01
