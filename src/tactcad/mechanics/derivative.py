"""How stiffness follows one parameter, by the model's own derivative.

Beam theory's exponents (3 for the leaf's thickness, -2 for the arm) hold for a leaf between rigid blocks;
body and arm of a real element give way too.
"""

from __future__ import annotations

import numpy as np

from . import friction, ladder
from .section import Array, HingeSection

STEP = 1e-5  # relative; central differences then err by 1e-9 of the exponent


def elasticity(s: HingeSection, parameter: str, rung: str = ladder.DEFAULT_RUNG) -> Array:
    """Relative change of stiffness per relative change of a parameter: dln K/dln p.

    Parameters
    ----------
    s
        One design or many.
    parameter
        Name of a field of `HingeSection`.
    rung
        A closed-form rung.

    Returns
    -------
    Array
        Of the section's shape; 2.5 where 1 % more of the parameter gives 2.5 % more K.

    Raises
    ------
    CheckFailure
        Where a design is out of the rung's range; the steps beside it may lie just outside.
    """
    ladder.require_range(s, rung)
    value = getattr(s, parameter)
    moved = (s.with_(**{parameter: value * (1.0 + sign * STEP)}) for sign in (1.0, -1.0))
    up, down = (friction.factor(m) / ladder.compliance(m, rung) for m in moved)
    return np.log(up / down) / (2.0 * STEP)
