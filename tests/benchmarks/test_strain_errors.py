"""Strain and stress at mid-width: what is stated of the closed forms holds, and the shipped data are the
fit's.

The seed of the fresh designs may be given in the environment (STRAIN_SEED); it is printed.
"""

from __future__ import annotations

import os

import calculix_corners
import numpy as np
import pytest
import strain_fit
from samples import section

from tactcad.fem import fem_ladder
from tactcad.mechanics import strain
from tactcad.mechanics.register import strain_data
from tactcad.mechanics.section import REFERENCE

SEED = int(os.environ.get("STRAIN_SEED", "161803"))
CORNER = REFERENCE.with_(
    hinge_thickness=0.4,
    hinge_length=1.5,
    fillet_radius=0.1,
    load_arm=3.0,
    arm_height=3.0,
    body_height=3.0,
    body_length=2.0,
    poisson=0.4,
    width=1.5,
    two_sided=False,
)


def errors(s, grids):
    """Relative errors of the closed forms for one design against fem-solid, and what is stated: of the gauge
    with each of the grids, of strain and stress at the fillet."""
    read = fem_ladder.solve(s, "fem-solid", grids).readings
    for grid, gauge in zip(grids, read.gauge, strict=True):
        stated = strain.stated(s, grid, "solid")
        yield float(strain.gauge(s, 1.0, grid)) / gauge - 1.0, float(stated.gauge)
    yield float(strain.peak(s, 1.0)) / read.fillet_strain - 1.0, float(stated.fillet_strain)
    yield float(strain.peak_stress(s, 1.0)) / read.fillet_stress - 1.0, float(stated.fillet_stress)


def test_what_is_stated_holds_where_width_and_length_are_equal():
    for error, stated in errors(CORNER, np.array([0.75])):
        assert abs(error) <= stated


def test_stress_at_mid_width_passes_the_widths_mean():
    """12 to 13 % at this corner, by elements of order up to 7: the mean alone made Goodman's factor that
    much unsafe."""
    share = float(strain.peak_stress(CORNER, 1.0) / strain.mean_stress(CORNER, 1.0))
    assert share == pytest.approx(1.125, abs=0.03)


def test_a_sheet_without_poissons_effect_carries_the_mean_everywhere():
    assert float(strain.mid_width_share(CORNER.with_(poisson=0.0))) == 1.0


@pytest.mark.nightly
def test_what_is_stated_of_elements_is_at_most_three_times_what_a_finer_mesh_changes():
    """At the corner where it changes most."""
    s = calculix_corners.CORNERS[1]
    coarse, fine = (fem_ladder.solve(s, "fem-solid", 0.65, mesh=mesh).readings for mesh in (2, 4))
    of_elements = strain.stated(s, 0.65, "fem-solid")
    for name in ("fillet_strain", "fillet_stress"):
        moved = abs(getattr(coarse, name) / getattr(fine, name) - 1.0)
        assert moved < getattr(of_elements, name) <= 3.0 * moved


@pytest.mark.nightly
@pytest.mark.parametrize("slot", ["shorter than the hinge is thick", "longer"])
def test_what_is_stated_under_a_grid_is_at_most_three_times_what_a_finer_mesh_changes(slot):
    """Where it changes most of the eight corners and of ten designs drawn with seed 7."""
    s = calculix_corners.CORNERS[6] if slot != "longer" else section(strain_fit.draw(200, 7)).rows(23)
    grids = strain_fit.grid_lengths(s) * (1.0 - 1e-9)
    coarse, fine = (fem_ladder.solve(s, "fem-solid", grids, mesh=mesh).readings.gauge for mesh in (2, 3))
    worst = float(np.abs(np.asarray(coarse) / np.asarray(fine) - 1.0).max())
    assert worst < float(strain.stated(s, 0.1, "fem-solid").gauge) <= 3.0 * worst


def test_shipped_data_are_the_fits():
    again, shipped = strain_fit.fit(strain_fit.shipped_samples()), strain_data()
    assert again["designs"] == shipped["designs"] and len(again["zones"]) == len(shipped["zones"])
    s = section(strain_fit.draw(100, SEED))
    np.testing.assert_allclose(strain.mid_width_share(s, again), strain.mid_width_share(s), rtol=1e-4)
    for a, b in zip(again["zones"], shipped["zones"]):
        for name, stated in b["stated"].items():
            assert a["stated"][name] == (stated if stated is None else pytest.approx(stated, abs=2e-3))


def test_stated_errors_are_at_most_three_times_the_worst_that_was_found():
    for zone in strain_data()["zones"]:
        for name, worst in zone["worst"].items():
            assert worst is None or worst < zone["stated"][name] <= 3.0 * worst


@pytest.mark.nightly
def test_what_is_stated_holds_on_designs_drawn_anew():
    print("seed", SEED + 1)
    s = section(strain_fit.draw(200, SEED + 1))
    small = (s.width < 12.0 * s.hinge_thickness) & (s.hinge_length < 8.0 * s.hinge_thickness)
    for i in np.flatnonzero(small)[:20]:
        one = s.rows(int(i))
        grids = strain_fit.grid_lengths(one)[:3] * (1.0 - 1e-9)
        for what, (error, stated) in enumerate(errors(one, grids)):
            print(i, what, f"{error:.4f} of {stated:g}")
            assert abs(error) <= stated, (i, what)
