"""Stated errors of rung solid hold where a search pushes them up: two designs that others found, and climbs.

The seed of the nightly climb may be given in the environment (CLIMB_SEED); it is printed.
"""

from __future__ import annotations

import os
from itertools import islice

import hinge_climbs
import numpy as np
import pytest

from tactcad.fem.fem_ladder import solve
from tactcad.mechanics import accuracy, ladder, strain
from tactcad.mechanics.section import HingeSection

SEED = int(os.environ.get("CLIMB_SEED", "30103"))

# Found by others in under 60 steps: what was stated then was passed by K (-0.61 % for 0.41) and by the
# fillet's
# strain (10.2 % for 7.3).
PASSED_BY_STIFFNESS = HingeSection.of(
    hinge_thickness=0.2028,
    hinge_length=2.7637,
    fillet_radius=0.3934,
    load_arm=8.692,
    arm_height=1.372,
    body_height=5.657,
    body_length=2.977,
    poisson=0.4260,
    youngs_modulus=1.0,
    width=1.952,
    two_sided=True,
)
PASSED_BY_STRAIN = HingeSection.of(
    hinge_thickness=0.185,
    hinge_length=1.134,
    fillet_radius=0.549,
    load_arm=10.23,
    arm_height=2.0,
    body_height=3.34,
    body_length=1.58,
    poisson=0.448,
    youngs_modulus=1.0,
    width=1.112,
    two_sided=False,
)


@pytest.mark.slow  # a fine mesh of solid elements
def test_a_design_that_passed_the_stated_error_of_stiffness():
    s = PASSED_BY_STIFFNESS
    error = 1.0 / float(ladder.compliance(s, "solid")) / solve(s, "fem-solid", 0.1).stiffness - 1.0
    assert error == pytest.approx(-0.0061, abs=2e-4)
    assert abs(error) < float(accuracy.expected_error_of(s, "solid"))


def test_a_design_that_passed_the_stated_error_of_strain():
    """10.2 % before the forms of narrow leaves."""
    s = PASSED_BY_STRAIN
    grid = 0.4 * float(s.hinge_length)
    read, stated = solve(s, "fem-solid", grid).readings, strain.stated(s, grid, "solid")
    assert abs(float(strain.peak(s, 1.0)) / read.fillet_strain - 1.0) < float(stated.fillet_strain) < 0.073
    assert abs(float(strain.gauge(s, 1.0, grid)) / float(read.gauge) - 1.0) < float(stated.gauge)


def tried(seed: int, tries: int, most: float = np.inf) -> None:
    """So many tries of a climb, from designs up to a size; each stays below what is stated."""
    known = hinge_climbs.start()
    size = (known["width"] * known["hinge_length"]) / known["hinge_thickness"] ** 2
    climb = hinge_climbs.climb(hinge_climbs.taken(known, size < most), seed, hinge_climbs.targets())
    for goal, error, _ in islice(climb, tries):
        assert not error > hinge_climbs.stated(goal), goal


@pytest.mark.slow  # a search of its own
def test_a_small_climb_stays_below_what_is_stated():
    tried(SEED, 3, 15.0)


@pytest.mark.nightly
def test_a_climb_stays_below_what_is_stated():
    """Some half an hour."""
    print("seed", SEED + 1)
    tried(SEED + 1, 1500)


def test_climbed_designs_are_the_worst_that_is_known():
    """What is stated is 1.5 times the worst of all that were drawn and climbed to."""
    known = hinge_climbs.start()
    s, found = hinge_climbs.section(known), hinge_climbs.errors(known)
    for goal in hinge_climbs.targets():
        worst = np.nanmax(np.where(hinge_climbs.in_zone(goal, s), found[goal[0]], np.nan))
        assert 1.4 * worst < hinge_climbs.stated(goal)
