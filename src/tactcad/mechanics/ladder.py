"""The closed-form rungs by name: stiffness of many designs at once, or a refusal."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactcad.design.messages import CheckFailure

from . import friction, validity
from .register import BY_NAME, REGISTER
from .section import Array, HingeSection

CLOSED_FORMS = tuple(rung.name for rung in REGISTER if rung.compliance)
FITTED = tuple(rung.name for rung in REGISTER if rung.fitted)  # they know the fillets and the hinge's roots
FINITE_ELEMENTS = tuple(rung.name for rung in REGISTER if not rung.compliance)
RUNGS = CLOSED_FORMS + FINITE_ELEMENTS
DEFAULT_RUNG = "solid"

BLOCK = 8192  # designs evaluated together: their intermediate arrays stay in the second-level cache


@dataclass(frozen=True)
class Result:
    """Stiffness (N/mm, NaN where refused), and why refused ("" where not), for each design."""

    stiffness: Array
    valid: np.ndarray
    reason: np.ndarray


def evaluate(s: HingeSection, rung: str = DEFAULT_RUNG) -> Result:
    """Tip stiffness of every design by a closed-form rung.

    Parameters
    ----------
    s
        One design or many.
    rung
        One of `CLOSED_FORMS`.

    Returns
    -------
    Result
        Arrays of the section's shape; out of the rung's range NaN and the first rule that is broken.
    """
    reason = validity.reasons(s, rung)
    valid = reason == ""
    stiffness = np.full(s.shape, np.nan)
    if valid.any():
        stiffness[valid] = _stiffness(s.rows(valid.reshape(-1)), rung)
    return Result(stiffness, valid, reason)


def stiffness(s: HingeSection, rung: str = DEFAULT_RUNG) -> Array:
    """Tip stiffness by a closed-form rung, friction at the pad included, N/mm.

    Parameters
    ----------
    s
        One design or many.
    rung
        One of `CLOSED_FORMS`.

    Returns
    -------
    Array
        Of the section's shape.

    Raises
    ------
    CheckFailure
        Where any design is out of the rung's range; names the rule and the design.
    """
    require_range(s, rung)
    return _stiffness(s, rung)


def require_range(s: HingeSection, rung: str) -> None:
    """Raise CheckFailure with the first broken rule and the design that breaks it."""
    for mask in validity.broken_rules(s, rung).values():
        first = np.flatnonzero(mask)[0]
        where = f" (design {first + 1} of {mask.size})" if mask.size > 1 else ""
        why = validity.reasons(s, rung).ravel()[first]
        raise CheckFailure(f"rung {rung} does not reach this design: {why}{where}")


def compliance(s: HingeSection, rung: str) -> Array:
    """Tip compliance of the elastic element by a closed-form rung, mm/N.

    Friction is left out, and the rung's range is not checked.
    """
    form = BY_NAME[rung].compliance
    if form is None:
        raise ValueError(f"{rung} is no closed form")
    return form(s, None)


def _stiffness(s: HingeSection, rung: str) -> Array:
    size = int(np.prod(s.shape))
    if size <= BLOCK:
        return np.broadcast_to(friction.factor(s) / compliance(s, rung), s.shape)
    result = np.empty(size)
    for start in range(0, size, BLOCK):
        block = slice(start, start + BLOCK)
        part = s.rows(block)
        result[block] = friction.factor(part) / compliance(part, rung)
    return result.reshape(s.shape)
