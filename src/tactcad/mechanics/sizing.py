"""Which hinge gives a wanted stiffness: one parameter solved for, within the rung's range."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tactcad.design.messages import CheckFailure

from . import ladder
from .section import HingeSection

SEARCHED = {
    "hinge_thickness": (0.005, 5.0),
    "hinge_length": (0.01, 50.0),
}  # mm, as a design file may have them
GRID = 4001  # points, by logarithm, on which the rung's range is looked for


def size(s: HingeSection, stiffness: float, parameter: str, rung: str = ladder.DEFAULT_RUNG) -> float:
    """The hinge thickness or length that gives a stiffness, mm.

    Stiffness grows with thickness and falls with length, so there is at most one answer.

    Parameters
    ----------
    s
        One design (scalars); its own value of the parameter is not used.
    stiffness
        Wanted at the tip, N/mm.
    parameter
        "hinge_thickness" or "hinge_length".
    rung
        A closed-form rung.

    Raises
    ------
    CheckFailure
        Where the rung's range holds no such design; says which stiffnesses can be reached.
    """
    low, high = SEARCHED[parameter]
    values = np.geomspace(low, high, GRID)
    result = ladder.evaluate(s.with_(**{parameter: values}), rung)
    if not result.valid.any():
        raise CheckFailure(f"no {parameter} lies in the range of rung {rung}: {result.reason[GRID // 2]}")
    reached, reachable = values[result.valid], result.stiffness[result.valid]
    if not reachable.min() <= stiffness <= reachable.max():
        raise CheckFailure(
            f"{stiffness:g} N/mm is out of reach: with {parameter} from {reached[0]:.3g} to "
            f"{reached[-1]:.3g} mm, the range of rung {rung}, "
            f"stiffness goes from {reachable.min():.4g} to {reachable.max():.4g} N/mm"
        )
    at = np.flatnonzero(np.diff(np.sign(reachable - stiffness)) != 0)[0] if reachable[0] != stiffness else 0
    return _bisect(
        lambda v: float(ladder.stiffness(s.with_(**{parameter: v}), rung)) - stiffness,
        reached[at],
        reached[at + 1],
    )


def _bisect(excess: Callable[[float], float], low: float, high: float) -> float:
    """Root between low and high, where excess changes sign, to the last bit."""
    rising = excess(high) > 0.0
    while True:
        middle = (low + high) / 2.0
        if not low < middle < high:
            return middle
        if (excess(middle) > 0.0) == rising:
            high = middle
        else:
            low = middle
