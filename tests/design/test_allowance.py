"""Picking a grade: against a plain search of the list, and what is refused."""

from __future__ import annotations

from itertools import product

import pytest

from tactcad.design.allowance import Allowance, Grade, pick, read_seconds, read_within, seconds_text
from tactcad.design.messages import CheckFailure, InputError

GRADES = [Grade("a", 0.5, 1.0), Grade("b", 0.2, 2.0), Grade("b2", 0.3, 2.5), Grade("c", 0.01, 30.0)]
USEFUL = [GRADES[0], GRADES[1], GRADES[3]]  # b2 errs more than b, for more time


@pytest.mark.parametrize(
    "within,seconds", list(product((None, 0.6, 0.3, 0.2, 0.05, 0.01), (None, 0.5, 1.0, 2.2, 40.0)))
)
def test_what_is_picked_keeps_both_wishes_and_nothing_better_does(within, seconds):
    asked = Allowance(within, seconds)
    keeps = [
        g
        for g in USEFUL
        if (within is None or g.error <= within) and (seconds is None or g.seconds <= seconds)
    ]
    if not keeps:
        with pytest.raises(CheckFailure, match="too short"):
            pick(GRADES, asked, "K")
        return
    best = min(keeps, key=lambda g: g.error if within is None else g.seconds)
    picked = pick(GRADES, asked, "K")
    assert picked.grade == best
    at = USEFUL.index(best)
    assert picked.coarser == (USEFUL[at - 1] if at else None)
    assert picked.finer == (USEFUL[at + 1] if at + 1 < len(USEFUL) else None)


def test_a_finer_grade_that_a_clock_found_quicker_is_taken_where_only_it_is_in_time():
    grades = [Grade("coarse", 0.1, 9.0), Grade("fine", 0.01, 5.0)]
    assert pick(grades, Allowance(0.2, None), "K").grade.name == "coarse"
    assert pick(grades, Allowance(0.2, 6.0), "K").grade.name == "fine"


def test_what_cannot_be_had_is_refused_with_what_can():
    with pytest.raises(CheckFailure) as refused:
        pick(GRADES, Allowance(0.05, 10.0), "K")
    assert str(refused.value) == (
        "10 s are too short for K within 5 %: needs about 30 s (c, 1 % in about 30 s); "
        "in 10 s at best b, 20 % in about 2 s"
    )
    with pytest.raises(CheckFailure, match="needs about 1 s .a, 50 % in about 1 s.$"):
        pick(GRADES, Allowance(None, 0.5), "K")
    with pytest.raises(CheckFailure, match="nothing keeps K within 0.1 %: the best is c, 1 %"):
        pick(GRADES, Allowance(0.001, 1e6), "K")


def test_text_and_record_say_the_same():
    picked = pick(GRADES, Allowance(0.2), "K")
    assert picked.text() == (
        "budget: b: K within 20 % in about 2 s; a step less: a, 50 % in about 1 s; "
        "a step more: c, 1 % in about 30 s"
    )
    assert picked.record() == {
        "within": 0.2,
        "in_s": None,
        "of": "K",
        "chosen": {"name": "b", "error": 0.2, "seconds": 2.0},
        "less": {"name": "a", "error": 0.5, "seconds": 1.0},
        "more": {"name": "c", "error": 0.01, "seconds": 30.0},
    }
    assert pick(GRADES, Allowance(0.01), "K").text().endswith("a step more: none")
    assert not Allowance() and Allowance(0.1) and Allowance(None, 1.0)


@pytest.mark.parametrize("text,value", [("1%", 0.01), (" 0.1 % ", 0.001), ("0.02", 0.02), ("99.9%", 0.999)])
def test_an_error_is_read_as_a_share_or_in_per_cent(text, value):
    assert read_within(text, "--within") == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize("text", ["0", "-1%", "1", "2", "100%", "nan", "inf%", "1 percent", "%", "", "1_0%"])
def test_what_is_no_error_is_refused(text):
    with pytest.raises(InputError, match="--within: not an accuracy.*legal"):
        read_within(text, "--within")


@pytest.mark.parametrize("text", ["0", "-1", "nan", "inf", "1e10", "soon", "", "1_0"])
def test_what_is_no_time_is_refused(text):
    with pytest.raises(InputError, match="--in: no time.*legal"):
        read_seconds(text, "--in")
    assert read_seconds(" 1.5 ", "--in") == 1.5


def test_times_are_told_in_a_unit_that_suits():
    told = [seconds_text(s) for s in (0.123, 45.0, 110.0, 240.0, 7000.0, 36000.0)]
    assert told == ["0.12 s", "45 s", "110 s", "4 min", "117 min", "10 h"]
