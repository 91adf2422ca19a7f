"""Choosing a rung by accuracy: the promise on designs that chose nothing, and the choice itself.

The seed of the fresh designs may be given in the environment (ACCURACY_SEED); it is printed.
"""

from __future__ import annotations

import json
import os

import numpy as np
import pytest
import samples
from exact_ladder import ORDER
from ladder_fit import accuracy_table

from tactcad.costs.grades import rung_grades
from tactcad.design.messages import CheckFailure
from tactcad.fem import fem_ladder as elements
from tactcad.fem.fem_ladder import converged_solid
from tactcad.fem.shape import reference_shape
from tactcad.lab.batch import estimate_rows_to
from tactcad.mechanics import accuracy, ladder, strain, validity
from tactcad.mechanics.accuracy import CANDIDATES, accuracy_data, choose, choose_each
from tactcad.mechanics.register import ladder_data
from tactcad.mechanics.section import REFERENCE

SEED = int(os.environ.get("ACCURACY_SEED", "57721"))


def fresh(count, seed):
    """Designs of the box, of its edges, and over the whole range, a third each."""
    tables = (
        samples.draw_box(count - 2 * (count // 3), seed),
        samples.draw_edges(count // 3, seed + 1),
        samples.draw_range(count // 3, seed + 2),
    )
    return samples.section(samples.joined(tables))


def keeps_its_promise(s, wanted, mesh):
    """Stiffness by the chosen rung against solid elements on meshes finer than any that was chosen."""
    (answer,) = estimate_rows_to(s, wanted)
    assert answer.reason == ""
    truth = converged_solid(
        reference_shape(s), float(s.youngs_modulus), float(s.poisson), float(s.width), mesh=mesh
    )
    error = abs(answer.stiffness / truth.stiffness - 1.0)
    print(answer.model, f"{error:.3g} of {answer.expected_error:g}")
    assert error <= answer.expected_error <= wanted, (answer.model, error)


@pytest.mark.by_day(1, "solid elements each")
@pytest.mark.parametrize("i", [0, 5])  # the other end of the row; sixty more by night
def test_one_per_cent_is_kept_on_fresh_designs(i):
    print("seed", SEED)
    keeps_its_promise(small(SEED, 6).rows(i), 0.01, 2)


def small(seed, count):
    """Fresh designs whose solid meshes are small enough to be refined in a test: hinges of up to 6
    thicknesses."""
    s = fresh(12 * count, seed)
    fits = (s.hinge_length / s.hinge_thickness < 6.0) & (s.width / s.hinge_thickness < 25.0)
    return s.rows(np.flatnonzero(fits)[np.linspace(0, fits.sum() - 1, count).astype(int)])


@pytest.mark.slow  # solid elements; by day tests/cli/test_accuracy_option.py
def test_a_tenth_of_a_per_cent_is_kept_by_elements():
    """Twenty more by night."""
    print("seed", SEED)
    s = small(SEED + 10, 2).rows(0)
    assert choose(s, 1e-3).candidate.rung == "fem-solid"
    keeps_its_promise(s, 1e-3, 3)


@pytest.mark.nightly
@pytest.mark.parametrize("wanted,mesh,count", [(0.2, 2, 30), (0.01, 2, 60), (0.005, 2, 30), (1e-3, 3, 20)])
def test_many_accuracies_are_kept_on_many_fresh_designs(wanted, mesh, count):
    print("seed", SEED + 100)
    s = small(SEED + 100, count)
    for i in range(count):
        keeps_its_promise(s.rows(i), wanted, mesh)


def test_mesh_of_a_tenth_of_a_per_cent_is_measured_by_refinement():
    """On its own sample fem-solid moves less than promised when refined, and by the rate that it extrapolates
    with."""
    columns = samples.shipped_table("range")
    s = samples.section(columns)
    for coarse, fine, mesh in (("solid_mesh_2", "solid_mesh_3", 2), ("solid_mesh_3", "solid_mesh_4", 3)):
        moved = np.abs(columns[coarse] / columns[fine] - 1.0)
        known = np.isfinite(moved)
        candidate = next(c for c in CANDIDATES if c.mesh == mesh)
        assert known.sum() >= 24 and {0.0, 1.0} <= set(columns["two_sided"][known])
        assert np.all(moved[known] <= accuracy.expected_error(s, candidate)[known])


@pytest.mark.parametrize("draw", [samples.draw_box, samples.draw_range], ids=["box", "whole range"])
def test_one_per_cent_is_a_closed_form_nearly_everywhere_and_a_tenth_never(draw):
    s = samples.section(draw(600, SEED + 1000))
    inside = validity.reasons(s, "solid") == ""
    one = [c for c, known in zip(choose_each(s, 0.01), inside) if known]
    closed = sum(not isinstance(c, str) and c.candidate.rung in ladder.CLOSED_FORMS for c in one)
    assert closed >= 0.95 * len(one) > 300
    tenth = [c for c, known in zip(choose_each(s, 0.001), inside) if known]
    assert all(not isinstance(c, str) and c.candidate.rung == "fem-solid" for c in tenth)


def test_the_least_work_that_is_good_enough_is_taken():
    """Over accuracies, against a plain search of the file."""
    s = REFERENCE
    zone = accuracy_data()["zones"][int(accuracy.zones(s))]
    for wanted in np.geomspace(3e-4, 0.9, 40):
        choice = choose(s, wanted)
        first = next(c.name for c in CANDIDATES if zone["promised"][c.name] <= wanted)
        assert choice.candidate.name == first and choice.expected_error == zone["promised"][first] <= wanted


def test_meshes_are_chosen_by_their_work_whatever_a_clock_said(monkeypatch):
    """Where one disturbed run made the finer of two meshes the quicker one in the file, the coarser is still
    taken."""
    disturbed = json.loads(json.dumps(accuracy_data()))
    for zone in disturbed["zones"]:
        zone["seconds"] |= {"fem-solid, mesh 2": 6.9, "fem-solid, mesh 3": 6.4}
    monkeypatch.setattr(accuracy, "accuracy_data", lambda: disturbed)
    for s in (REFERENCE, NARROW):
        assert choose(s, 1e-3).candidate.mesh == 2
        assert choose_each(s, 1e-3)[0].candidate.mesh == 2


NARROW = REFERENCE.with_(hinge_length=2.4, width=1.5)  # b/l under 0.7
NOTCH = REFERENCE.with_(
    hinge_thickness=0.3,
    hinge_length=0.11,
    fillet_radius=0.05,
    load_arm=4.0,
    arm_height=3.0,
    body_height=3.0,
    body_length=1.2,
    poisson=0.42,
    width=2.0,
    two_sided=False,
)


@pytest.mark.slow  # solid elements on two fine meshes
def test_solid_elements_keep_their_promise_at_a_thin_notch():
    """A fillet of a sixth of the thickness: mesh 2 was 0.089 % off where 0.039 % was promised, mesh 3 0.026
    and 0.0059 %; and the fillet's strain by quadratic elements several per cent low."""
    coarse, fine = (elements.solve(NOTCH, "fem-solid", 0.1, mesh=mesh) for mesh in (2, 3))
    promised = [float(accuracy.expected_error(NOTCH, c)) for c in CANDIDATES if c.mesh]
    assert 0.0 < abs(coarse.stiffness / fine.stiffness - 1.0) < promised[0] - promised[1]
    stated = strain.stated(NOTCH, 0.1, "fem-solid")
    for name in ("gauge", "fillet_strain", "fillet_stress"):
        moved = float(getattr(coarse.readings, name)) / float(getattr(fine.readings, name)) - 1.0
        assert abs(moved) < getattr(stated, name)


SHORT_ARM = REFERENCE.with_(  # drawn by benchmarks/budgets.py: mesh 2 errs by 0.045 %, mesh 3 by 0.0085
    hinge_length=1.0989244,
    fillet_radius=0.35588813,
    load_arm=1.5636555,
    arm_height=0.9650757,
    body_height=1.8544091,
    body_length=5.3475012,
    poisson=0.39249593,
    width=1.0382833,
    two_sided=False,
)


@pytest.mark.slow  # solid elements, meshed finer and finer
def test_solid_elements_keep_their_promise_at_a_short_arm():
    coarse, fine = (elements.stiffness(SHORT_ARM, "fem-solid", mesh) for mesh in (2, 3))
    promised = [float(accuracy.expected_error(SHORT_ARM, c)) for c in CANDIDATES if c.mesh]
    assert 3e-4 < abs(coarse / fine - 1.0) < promised[0] - promised[1]


@pytest.mark.nightly
@pytest.mark.parametrize("s", [NOTCH, NARROW, SHORT_ARM], ids=["notch", "narrow", "short arm"])
def test_solid_elements_keep_their_promise_against_a_higher_order(s):
    K = [elements.stiffness(s, "fem-solid", mesh) for mesh in (2, 3, 4)]
    for found, candidate in zip(K, (c for c in CANDIDATES if c.mesh)):
        assert abs(found / K[2] - 1.0) < float(accuracy.expected_error(s, candidate))


def test_a_tighter_wish_is_never_quicker():
    """No time is foretold of closed forms: they answer at once."""
    seconds = {grade.name: grade.seconds or 0.0 for grade in rung_grades(REFERENCE)}
    chosen = [choose(REFERENCE, wanted).candidate for wanted in (0.5, 0.2, 0.05, 0.01, 0.002, 5e-4, 2e-4)]
    times = [seconds[candidate.name] for candidate in chosen]
    assert times == sorted(times) and times[0] < times[-1]


def test_one_rung_for_all_is_no_better_than_the_worst_of_each():
    s = fresh(60, SEED + 5)
    for wanted in (0.3, 0.01, 0.003):
        each = choose_each(s, wanted)
        together = choose(s, wanted)
        assert all(not isinstance(c, str) for c in each)
        assert together.expected_error == max(accuracy.expected_error(s, together.candidate))
        assert together.expected_error <= wanted


def test_size_and_modulus_do_not_matter():
    lengths = [n for n in ORDER if n not in ("poisson", "youngs_modulus")]
    jaw = REFERENCE.with_(youngs_modulus=1.0, **{n: getattr(REFERENCE, n) / 25 for n in lengths})
    assert choose(jaw, 0.01) == choose(REFERENCE, 0.01)


@pytest.mark.parametrize(
    "change,rule",
    [
        (dict(hinge_length=9.0), "l/t"),
        (dict(poisson=0.1), "poisson"),
        (dict(load_arm=np.nan), "not a finite"),
        (dict(body_length=0.5), "body too short"),
    ],
)
def test_what_was_not_measured_is_refused(change, rule):
    with pytest.raises(CheckFailure, match="not measured for this design") as refusal:
        choose(REFERENCE.with_(**change), 0.01)
    assert rule in str(refusal.value)


def test_more_than_any_rung_keeps_is_refused_with_what_there_is():
    with pytest.raises(
        CheckFailure, match="no rung is known to keep 0.0001 %.*best is fem-solid, mesh 3.*measured to keep"
    ):
        choose(REFERENCE, 1e-6)


def test_a_refusal_names_the_design():
    s = REFERENCE.with_(hinge_length=[0.75, 9.0])
    with pytest.raises(CheckFailure, match=r"\(element 7\)"):
        choose(s, 0.01, ["element 3", "element 7"])
    each = choose_each(s, 0.01)
    assert each[0].candidate.rung == "solid" and "l/t" in each[1]


def test_the_shipped_table_is_that_of_the_shipped_samples():
    again, shipped = accuracy_table(samples.shipped(), ladder_data()), accuracy_data()
    assert again["reference"] == shipped["reference"] and again["samples"] == shipped["samples"]
    for a, b in zip(again["zones"], shipped["zones"], strict=True):
        assert {k: a[k] for k in ("sides", "bounds", "designs")} == {
            k: b[k] for k in ("sides", "bounds", "designs")
        }
        for name in a["worst"]:
            assert a["worst"][name] == pytest.approx(b["worst"][name], rel=0.01)
            assert a["promised"][name] == pytest.approx(b["promised"][name], rel=0.1)
    assert json.dumps(shipped)  # plain numbers, no NaN


def test_designs_over_the_range_are_drawn_again_from_their_seed():
    shipped = samples.shipped_table("range")
    refined = samples.draw_refined()
    whole = samples.draw_range(len(shipped["poisson"]) - len(refined["poisson"]))
    again = samples.joined([whole, refined])
    for name, values in again.items():
        np.testing.assert_array_equal(values, shipped[name], err_msg=name)


@pytest.mark.parametrize("row", [2, 3])
def test_results_over_the_range_are_computed_again(row):
    shipped = samples.shipped_table("range")
    found = samples.range_results(samples.section(shipped).rows(row), ())
    assert found["plane_stiffness"] == pytest.approx(shipped["plane_stiffness"][row], rel=2e-5)


def test_every_zone_was_measured_by_enough_designs_of_every_kind():
    """Counted are designs with solid elements; what is promised is further from the worst that climbs
    found.
    """
    for zone in accuracy_data()["zones"]:
        count, worst, promised = (zone[name]["solid"] for name in ("designs", "worst", "promised"))
        assert count >= 7 and promised >= 1.49 * worst
        assert zone["designs"]["fem-solid, mesh 2"] >= 36 and zone["designs"]["fem-solid, mesh 3"] >= 24
