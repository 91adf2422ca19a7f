"""First reasons stand, whichever rows are given."""

from __future__ import annotations

import numpy as np

from tactcad.sweep.measured import ALL, Refused


def test_the_first_reason_of_each_row_stands():
    refused = Refused(4)
    assert refused.left(ALL) == ALL
    refused.add(np.array([2, 0]), np.array(["b", ""], object))
    refused.add(ALL, np.array(["x", "", "y", "z"], object))
    assert refused.reason.tolist() == ["x", "", "b", "z"] and refused.valid.tolist() == [
        False,
        True,
        False,
        False,
    ]
    assert list(refused.left(ALL)) == [1] and list(refused.left(np.array([3, 1]))) == [1]
    refused.add(refused.left(ALL), "all")
    assert not refused.valid.any() and refused.reason[1] == "all"
