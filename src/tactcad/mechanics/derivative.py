"""How stiffness follows one parameter, by the model's own derivative: beam theory's exponents (3 for the
leaf's thickness, -2 for the arm) hold for a leaf between rigid blocks, and no element is that."""

from __future__ import annotations

import numpy as np

from . import friction, ladder
from .section import Array, HingeSection

STEP = 1e-5  # relative; central differences then err by 1e-9 of the exponent


def elasticity(s: HingeSection, parameter: str, rung: str = ladder.DEFAULT_RUNG) -> Array:
    """dlnK/dln p of a parameter (a field's name) by a closed-form rung: 2.5 where 1 % more of it is 2.5 %
    more K.

    Raises CheckFailure where a design is out of the rung's range; the steps beside it may lie just outside.
    """
    ladder.require_range(s, rung)
    value = getattr(s, parameter)
    moved = (s.with_(**{parameter: value * (1.0 + sign * STEP)}) for sign in (1.0, -1.0))
    up, down = (friction.factor(m) / ladder.compliance(m, rung) for m in moved)
    return np.log(up / down) / (2.0 * STEP)
