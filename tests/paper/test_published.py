"""The paper's tables as data, and what is refused in their place."""

from __future__ import annotations

from pathlib import Path

import pytest

import tactcad.paper
from tactcad.design.messages import InputError
from tactcad.paper import published

DATA = Path(tactcad.paper.__file__).parent / "data"


def test_tables_are_as_printed(paper):
    """Column sums and corners added up from the paper by hand."""
    t1, t2 = paper.table1, paper.table2
    assert t1.element.tolist() == [1, 2, 3, 4, 6, 7, 8, 9, 10]
    assert t1.stiffness.value.sum() == pytest.approx(199.46)
    assert t1.deflection.value.sum() == pytest.approx(963.3)
    assert t1.force.value.sum() == pytest.approx(16.76)
    assert t1.arm.value.sum() == 54
    assert t1.zero_signal.value[t1.index(4)] == -2.14
    assert t2.ratio.value.shape == (6, 8)
    assert t2.ratio.value[0, 0] == 0.977 and t2.ratio.value[5, 7] == 5.451
    assert t2.printed_ratio.value[3, 4] == 2.0312
    assert t2.object_stiffness.value.tolist() == [10.01, 7.26, 6.28, 5.41, 4.51, 3.85, 3.57, 2.34]
    assert t2.measuring_stiffness.value.tolist() == [40.12, 15.25, 11.57, 9.05, 7.35, 5.78]


def test_rounding_is_half_a_unit_of_the_last_printed_digit(paper):
    assert paper.table1.stiffness.half_step[0] == pytest.approx(0.005)
    assert paper.table1.deflection.half_step[0] == pytest.approx(0.05)
    assert paper.table2.printed_ratio.half_step[3, 4] == pytest.approx(0.00005)
    assert paper.half_step["strain_short_arm"] == pytest.approx(0.00005)


def test_table_2_names_elements_of_table_1(paper):
    """Every K_m and K_r of Table 2 stands in Table 1; the reference element is the stiffest."""
    K = set(paper.table1.stiffness.value)
    assert set(paper.table2.measuring_stiffness.value) | {paper.figure["reference_stiffness"]} <= K
    assert paper.table1.stiffness.value[paper.reference] == max(K)


def changed(tmp_path, name, old, new):
    text = (DATA / name).read_text()
    assert old in text
    file = tmp_path / name
    file.write_text(text.replace(old, new, 1))
    return file


@pytest.mark.parametrize(
    "old, new, where, named",
    [
        (",zero_signal_V", ",zero", ":3:10", "'zero_signal_V' is missing"),
        ("2,11.57,", "2,soft,", ":5:2", "not a number"),
        ("2,11.57,", "2,-11.57,", ":5:2", "out of range"),
        ("2,11.57,", "2,,", ":5:2", "not a number"),
        ("2,11.57,", "2,inf,", ":5:2", "out of range"),
        ("2,11.57,", "1,11.57,", ":5:1", "element 1 is already on line 4"),
        ("2,11.57,", "2,11.57,7,", ":5:10", "another length"),
        ("1,40.12,74.3", "1,40.12,-74.3", ":4:3", "out of range"),
    ],
)
def test_a_bad_table_1_is_refused_with_file_line_and_column(tmp_path, old, new, where, named):
    file = changed(tmp_path, "table1.csv", old, new)
    with pytest.raises(InputError, match=named) as refused:
        published.load(table1=file)
    assert str(refused.value).startswith(f"{file}{where}: ")


@pytest.mark.parametrize(
    "old, new, where, named",
    [
        ("40.12,10.01,4.083,0.977", "40.12,10.01,4.083,zero", ":5:4", "not a number"),
        ("40.12,10.01,4.083,0.977", "40.12,7.26,4.083,0.977", ":6:1", "is already"),
        ("40.12,10.01,4.083,0.977\n", "", ":51:1", "not every measuring element"),
    ],
)
def test_a_bad_table_2_is_refused(tmp_path, old, new, where, named):
    file = changed(tmp_path, "table2.csv", old, new)
    with pytest.raises(InputError, match=named) as refused:
        published.load(table2=file)
    assert str(refused.value).startswith(f"{file}{where}: ")


@pytest.mark.parametrize("content", [b"\xff\xfe\x00bad", b"a\x00b\n1\n", b'"unclosed\n1\n'])
def test_what_is_not_text_or_csv_is_refused(tmp_path, content):
    file = tmp_path / "t.csv"
    file.write_bytes(content)
    with pytest.raises(InputError, match="t.csv"):
        published.load(table1=file)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        published.load(table1=tmp_path / "none.csv")
