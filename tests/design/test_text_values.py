"""Numbers in keys, options, poses and tables are what people write, not all that Python reads."""

from __future__ import annotations

from math import isnan

import pytest
from variants import variant

from tactcad.cli.parser import Parser
from tactcad.design.csv_table import number
from tactcad.design.messages import InputError
from tactcad.design.text_values import as_number, as_whole
from tactcad.scenes.rig import pose_of

NONE = ["4_0", "\u0664", "", "4 0", "0x10", "1e", "--1", "4,0", "\u00a04", "1e1_0"]


@pytest.mark.parametrize("text", NONE)
def test_what_only_python_reads_is_refused(text):
    for read in (as_number, as_whole):
        with pytest.raises(ValueError):
            read(text)


@pytest.mark.parametrize(
    "text, value", [("4", 4), (" 4.0 ", 4), ("-.5e-3", -5e-4), ("+2.", 2), ("1E3", 1000)]
)
def test_a_plain_number_is_read(text, value):
    assert as_number(text) == value


@pytest.mark.parametrize("text", ["1e400", "-1e999", "1" + 400 * "0"])
def test_digits_beyond_all_numbers_are_no_infinity(text):
    with pytest.raises(ValueError, match="beyond all numbers"):
        as_number(text)
    assert as_number("-inf") == -as_number("Infinity") == float("-inf")


def test_a_cell_of_a_table_an_option_and_a_pose_are_read_by_it(capsys):
    assert isnan(number("1_0"))
    with pytest.raises(InputError):
        pose_of(["element=1_0"], variant({}))
    parser = Parser(prog="tactcad")
    parser.add_argument("--force", type=float)
    with pytest.raises(SystemExit):
        parser.parse(["--force", "4_0"])
    assert "4_0" in capsys.readouterr().err
