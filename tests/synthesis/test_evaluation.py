"""Many arrays at once are evaluated as the lab evaluates each: the same estimate, the same ends."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binom, kstest

from tactcad.lab.combine import Slopes, combine
from tactcad.synthesis.interval import Covariance, Evaluation

NOISE, LOADS = 4e-4, 10


def arrays(
    elements: int, count: int, dof: int, seed: int, spread: float | np.ndarray, wrong: float = 1.0
) -> tuple[Evaluation, list[Slopes]]:
    """Arrays of two kinds with errors of K and K_v of `spread`, and the same as the lab has them; the second
    element is believed `wrong` times as stiff."""
    rng = np.random.default_rng(seed)
    K = np.where(np.arange(elements) % 2, 4.0, 60.0) * rng.uniform(0.9, 1.1, (count, elements))
    K_v = np.where(np.arange(elements) % 2, 3.0, -8.0) * np.ones((count, 1))
    x = 3.0
    s = x / (K + x) * 0.2
    g = K_v * s + NOISE * rng.standard_normal(s.shape)
    runs = spread * rng.standard_normal((2, dof + 1, count, elements))
    mean, off = runs.mean(axis=1), runs - runs.mean(axis=1, keepdims=True)
    kk, vv, kv = ((off[a] * off[b]).sum(axis=0) / dof / (dof + 1) for a, b in ((0, 0), (1, 1), (0, 1)))
    K_hat, V_hat = K * (1.0 + mean[0]), K_v * (1.0 + mean[1])
    K_hat[:, 1] *= wrong
    signal_dof = (elements - 1) * (LOADS - 2)
    got = Evaluation(
        g / V_hat,
        g * K_hat / V_hat,
        (NOISE / V_hat, NOISE * K_hat / V_hat),
        Covariance.of(kk, vv, kv),
        (dof, signal_dof),
    )
    labs = []
    for i in range(count):
        toward = np.stack([K_hat[i] / V_hat[i], 1.0 / V_hat[i]], axis=-1)  # of (f, s) per volt
        s, f, none = g[i] / V_hat[i], g[i] * K_hat[i] / V_hat[i], np.zeros(elements)
        jacobian = np.moveaxis(np.array([[f, -f], [none, -s]]), -1, 0)  # of (f, s) in (ln K, ln K_v)
        known = np.array([[[a, c], [c, b]] for a, b, c in zip(kk[i], vv[i], kv[i])])  # relative
        labs.append(
            Slopes(
                np.arange(elements),
                s,
                f,
                NOISE**2 * toward[:, :, None] * toward[:, None, :],
                jacobian @ known @ jacobian.transpose(0, 2, 1),
                signal_dof,
                np.full(elements, float(dof)),
            )
        )
    return got, labs


@pytest.mark.parametrize(
    ("elements", "dof", "spread"), [(2, 3, 0.01), (4, 2, 0.01), (10, 2, 0.01), (10, 4, 0.05)]
)
def test_as_the_lab_array_by_array(elements, dof, spread):
    together, labs = arrays(elements, 25, dof, 1, spread)
    got = together.evaluated(3.0)
    for i, slopes in enumerate(labs):
        want = combine(slopes, 0.95)[0]
        assert got.estimate[i] == pytest.approx(want.estimate, rel=2e-4)
        half = (want.high - want.low) / 2.0
        assert got.low[i] == pytest.approx(want.low, abs=2e-3 * half)
        assert got.high[i] == pytest.approx(want.high, abs=2e-3 * half)


def test_where_elements_disagree_as_the_lab():
    """One element of ten is believed 30 % too stiff: the interval is widened, by as much as the lab's."""
    together, labs = arrays(10, 8, 2, 3, 0.003, wrong=1.3)
    want = [combine(slopes, 0.95) for slopes in labs]
    assert all(widened > 1.0 for _, _, widened in want)
    got = together.evaluated(3.0)
    assert got.low == pytest.approx([w.low for w, _, _ in want], rel=2e-4)
    assert got.high == pytest.approx([w.high for w, _, _ in want], rel=2e-4)


def test_sound_elements_of_unequal_errors_are_not_said_to_disagree():
    """One kind is known ten times worse than the other, so that weights from common covariances are far off:
    the probability of their disagreement is still even between 0 and 1."""
    spread = np.where(np.arange(10) % 2, 0.05, 0.003)
    _, labs = arrays(10, 200, 4, 7, spread)
    p = [combine(slopes, 0.95)[1] for slopes in labs]
    assert binom.ppf(1e-4, 200, 0.05) <= np.sum(np.array(p) < 0.05) <= binom.ppf(1 - 1e-4, 200, 0.05)
    assert kstest(p, "uniform").pvalue > 1e-4
