"""Sheet as bought: EN 485-4 against its printed values, and where a design's own value stands."""

import pytest

from tactcad.design.load import read
from tactcad.design.materials import OTHER_SHEET, sheet_tolerance

ALUMINIUM, STEEL = 2800, 7850


@pytest.mark.parametrize(
    "thickness, printed",
    [
        (0.4, 0.03),
        (0.41, 0.03),
        (1.0, 0.05),
        (1.01, 0.05),
        (2.0, 0.09),
        (3.0, 0.11),
        (3.01, 0.12),
        (50, 0.55),
    ],
)
def test_printed_values(thickness, printed):
    """EN 485-4:1994, table 1, group II, up to 1000 wide: "over" is exclusive, "up to" inclusive."""
    assert sheet_tolerance(thickness, ALUMINIUM) == printed


def test_no_thicker_sheet_is_held_closer():
    sizes = [0.1 * n for n in range(1, 200)]
    values = [sheet_tolerance(s, ALUMINIUM) for s in sizes]
    assert values == sorted(values)


def test_other_metals_are_not_in_the_standard():
    assert sheet_tolerance(3.0, STEEL) == OTHER_SHEET


def test_the_designs_own_value_stands():
    assert read("macro-array").tolerance.sheet_thickness == 0.1
    assert read("double-sample").tolerance.sheet_thickness == 0.11
    assert read("soft-tissue").tolerance.sheet_thickness == 0.09
