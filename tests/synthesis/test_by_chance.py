"""Targets by chance, far beyond the shipped one's numbers: the design answered passes every check."""

from __future__ import annotations

import numpy as np
import pytest

from tactcad.checks.run import run_checks
from tactcad.parts.rules import load
from tactcad.scenes import scene_names
from tactcad.synthesis.synthesise import attempt
from tactcad.synthesis.target import parse_target
from tactcad.synthesis.target_report import write

SEED = 20261123
# Half a minute each, most of it for solids: one is a slow test, all others are nightly ones.
TARGETS = [pytest.param(n, marks=pytest.mark.slow if n < 1 else pytest.mark.nightly) for n in range(300)]


def drawn(rng: np.random.Generator) -> str:
    """0.3 to 600 N/mm; 0.1 to 7 N an element; sheets of 1.5 to 8 mm, arms of 3 to 21, hinges of 0.1 to 3."""

    def between(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    soft, elements, sheet = between(0.3, 60.0), int(rng.integers(4, 13)), rng.choice([1.5, 2, 3, 4, 5, 6, 8])
    force, arm, hinge = elements * sheet / 3.0 * between(0.2, 2.5), rng.uniform(3.0, 9.0), between(0.1, 0.5)
    return f"""
        target.name = "by-chance"
        target.base = "{rng.choice(["macro-array", "better-array"], p=[0.8, 0.2])}"
        object.stiffness = [{soft:.3g}, {soft * between(1.5, 10.0):.3g}]
        grasp = {{force = {force:.3g}, overload = {force * between(1.0, 3.0):.3g}}}
        room.rows = {rng.integers(1, 3)}
        room.elements = [2, {elements}]
        room.pitch = {rng.choice([0.2, 4.0, 6.0, 8.0])}
        stock.sheets = [{sheet}]
        stock.alloys = ["{rng.choice(["7075-T6", "6061-T6", "17-4PH-H900"], p=[0.7, 0.15, 0.15])}"]
        stock.hinge_tolerances = [{rng.choice([0.002, 0.005, 0.01])}]
        elements.arms = [{arm:.1f}, {arm + rng.uniform(1.0, 12.0):.1f}]
        elements.hinges = [{hinge:.2f}, {hinge * between(1.5, 6.0):.2f}]
        known.how = "{rng.choice(["calibrated", "drawn", "inspected"], p=[0.6, 0.2, 0.2])}"
        """


@pytest.mark.parametrize("n", TARGETS)
def test_a_target_met_is_met_by_a_design_that_passes_every_check(n, tmp_path):
    target = parse_target(drawn(np.random.default_rng((SEED, n))), "by chance")
    got = attempt(target, arrays=200)
    if got.met:
        write(got, tmp_path / "out")
        assert (tmp_path / "out" / "report.html").stat().st_size > 10_000
        made = load(tmp_path / "out" / "design.toml")
        assert [str(f) for f in run_checks(made, scene_names(made)).failures] == []
