"""The closed forms of strain against 50 digits of mpmath, and their limits."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from tactcad.design.messages import CheckFailure
from tactcad.mechanics import strain
from tactcad.mechanics.register import ladder_data
from tactcad.mechanics.rungs import plane
from tactcad.mechanics.section import REFERENCE

EPS = np.finfo(float).eps


def designs():
    rng = np.random.default_rng(9)
    for i in range(40):
        t = 10 ** rng.uniform(-1.3, -0.4)
        r = t * 10 ** rng.uniform(-0.7, 0.7)
        length = 2 * r + t * 10 ** rng.uniform(-2, 1.0)
        yield dict(
            hinge_thickness=t,
            fillet_radius=r,
            hinge_length=length,
            load_arm=rng.uniform(3, 9),
            arm_height=3 * (t + 2 * r),
            body_height=5 * (t + 2 * r),
            two_sided=bool(i % 2),
        )


@pytest.fixture(autouse=True)
def fifty_digits():
    with mp.workdps(50):
        yield


def constants(group, two):
    return {n: mp.mpf(v) for n, v in ladder_data()[group]["two" if two else "one"].items()}


@pytest.mark.parametrize("changes", list(designs()))
def test_fillet_and_face_factors(changes):
    s, two = REFERENCE.with_(**changes), changes["two_sided"]
    t, r, length, L = (
        mp.mpf(changes[n]) for n in ("hinge_thickness", "fillet_radius", "hinge_length", "load_arm")
    )
    lc, rho = length - 2 * r, r / t
    # lc loses digits where the fillets nearly fill the slot; the factors see it as lc/t
    lost = EPS * float(length / t)
    k = constants("fillet", two)
    where = lc / 2 + k["a"] * mp.sqrt(r * t) - k["b"] * r
    peak = (1 + where / L) * (1 + k["c"] * rho ** -k["m"] * (1 + k["d"] * mp.exp(-k["e"] * lc / t)))
    assert abs(float(strain.fillet_factor(s)) / peak - 1) < 16 * EPS + 2 * float(k["e"]) * lost
    if not two:
        k = constants("face", False)
        flat = (1 + (k["a"] * lc / 2 - k["b"] * t) / L) * (
            1 - k["c"] / (k["d"] + rho) * mp.exp(-k["e"] * lc / t)
        )
        assert abs(float(strain.face_factor(s)) / flat - 1) < 16 * EPS + 2 * float(k["e"]) * lost


@pytest.mark.parametrize("share", [1e-9, 1e-3, 0.1, 0.9, 40.0])
@pytest.mark.parametrize("changes", list(designs())[:16])
def test_grid_factor(changes, share):
    """The integral's two ends are near each other for a small grid; no digit may be lost to that."""
    s, two = REFERENCE.with_(**changes), changes["two_sided"]
    grid = share * float(s.straight_length if two else s.hinge_length)
    if two and share > 1:
        with pytest.raises(CheckFailure, match="longer than the flat part"):
            strain.grid_factor(s, 2 * changes["hinge_length"])
        return
    t, length, r = (mp.mpf(changes[n]) for n in ("hinge_thickness", "hinge_length", "fillet_radius"))
    g = mp.mpf(float(sum(plane.root_lengths(s)) / 2))
    lc, rho, k = length - 2 * r, r / t, constants("grid", two)
    step = max(mp.mpf(grid) / t, mp.mpf(1e-3))
    f = lambda u, v, z: mp.log1p(mp.exp(u * (z - v))) / u  # noqa: E731

    def X(w):
        if two:
            bump = k["m"] * rho ** -k["x"] * (1 + mp.tanh(k["y"] * (w / mp.sqrt(rho) - k["z"]))) / 2
            return bump - g * f(k["u"], k["v"], w / g)
        return -g * (k["m"] * f(k["u"], k["v"], w / g) + (1 - k["m"]) * f(k["x"], k["y"], w / g))

    truth = 1 + 2 * (X(step / 2 - lc / (2 * t)) - X(-step / 2 - lc / (2 * t))) / step
    found = float(strain.grid_factor(s, grid))
    assert abs(found - truth) < 64 * EPS * (1 + float(length / t)) * (1 + abs(float(truth)))


def test_limit_short_grid_on_a_long_leaf_reads_the_nominal_strain():
    for two in (True, False):
        s = REFERENCE.with_(hinge_length=3.0, load_arm=9.0, two_sided=two)
        assert float(strain.grid_factor(s, 0.1)) == pytest.approx(1.0, abs=0.01)


def test_limit_long_grid_reads_what_the_hinge_bends():
    """Beyond the mouth hardly any strain is added: the mean falls as one over the length."""
    s = REFERENCE.with_(two_sided=False)
    product = [float(strain.grid_factor(s, grid)) * grid for grid in (4.0, 8.0)]
    assert product[1] == pytest.approx(product[0], rel=0.02)
