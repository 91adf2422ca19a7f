"""Limits of a synthesis: each field of the target eased alone, and the best result then."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from tactcad.design.fields import Whole, spec_of

from .target import TABLES, Target

# Sheets, alloys, gauges, powers, known.how and target.base are not tried: they have no order. For each field
# that can be eased, the direction of an easing step: 10 %, or 1 for a count, or 0.01 mm for a hinge.
STEP, HINGE_STEP = 0.10, 0.01
FURTHEST = 8.0  # largest factor by which a field is eased before it is reported not to help alone
CLOSE = 0.02  # relative; the least change is found to within this


NOT_NARROWING = ("target.half_width", "target.share", "room.height")  # eased, they change no interval

Ease = Callable[[Target, float], Target | None]


def value_of(target: Target, name: str) -> Any:
    """The value of a field, or of one end of a range, by the name that `eased` gives it."""
    path, _, end = name.partition("[")
    table, field = path.split(".")
    value = getattr(getattr(target, table), field)
    return value[int(end[:-1])] if end and value else value


def _spec(path: str) -> Any:
    """Of one value of a field."""
    table, name = path.split(".")
    spec = spec_of(TABLES[table], name)
    return getattr(spec, "item", spec)


def _legal(path: str, value: float) -> float:
    """The value, no further than a target file may say it."""
    spec = _spec(path)
    return min(max(value, spec.low), spec.high)


def _scaled(name: str, up: bool) -> Ease:
    """The value made larger or smaller by a factor; a count by one at least."""
    path, _, end = name.partition("[")

    def ease(target: Target, by: float) -> Target | None:
        value = value_of(target, name)
        if not value:
            return None
        other = value * by if up else value / by
        if isinstance(_spec(path), Whole):
            one = value + (1 if up else -1) * (by > 1.0)
            other = max(round(other), one) if up else min(round(other), one)
        other = _legal(path, other)
        if not end:
            return target.with_(path, other)
        pair = list(value_of(target, path))
        pair[int(end[:-1])] = other
        return target.with_(path, tuple(pair)) if pair[0] <= pair[1] else None

    return ease


def _share(target: Target, by: float) -> Target:
    """Arrays that need not meet the target: by so much more."""
    return target.with_("target.share", _legal("target.share", 1.0 - (1.0 - target.target.share) * by))


def _tolerances(target: Target, by: float) -> Target:
    finest = _legal("stock.hinge_tolerances", min(target.stock.hinge_tolerances) / by)
    finer = tuple(sorted({*target.stock.hinge_tolerances, finest}))
    return target.with_("stock.hinge_tolerances", finer)


# By field: the ease, or whether a larger value is easier.
EASIER: dict[str, Ease | bool] = {
    "target.half_width": True,
    "target.share": _share,
    "object.stiffness[0]": True,
    "object.stiffness[1]": False,
    "object.modulus[0]": True,
    "object.modulus[1]": False,
    "grasp.force": True,
    "grasp.element_force": True,
    "grasp.overload": False,
    "grasp.loads": True,
    "room.rows": True,
    "room.elements[0]": False,
    "room.elements[1]": True,
    "room.pitch": False,
    "room.length": True,
    "room.width": True,
    "room.height": True,
    "elements.kinds": True,
    "elements.of_a_kind": False,
    "elements.arms[0]": False,
    "elements.arms[1]": True,
    "elements.hinges[0]": False,
    "elements.hinges[1]": True,
    "stock.hinge_tolerances": _tolerances,
    "known.thickness": False,
    "known.gauge_factor": False,
    "known.runs": True,
    "known.run_scatter": False,
    "known.force_noise": False,
    "known.displacement_noise": False,
    "known.contact": False,
}
EASES = {name: _scaled(name, way) if isinstance(way, bool) else way for name, way in EASIER.items()}
# Fields that matter to one kind of knowledge only.
ONLY = {
    "drawn": ("stock.hinge_tolerances", "known.gauge_factor"),
    "inspected": ("known.thickness", "known.gauge_factor"),
    "calibrated": ("known.runs", "known.run_scatter", "known.force_noise", "known.displacement_noise"),
}


def eased(target: Target, by: float = 1.0 + STEP) -> Iterator[tuple[str, Target]]:
    """The target with each of its fields eased alone, by a factor."""
    unused = {name for how, names in ONLY.items() if how != target.known.how for name in names}
    unused -= set(ONLY[target.known.how])
    for name, ease in EASES.items():
        if name not in unused:
            other = ease(target, by)
            if other is not None and other != target:
                yield name, other


def least_change(target: Target, name: str, possible: Callable[[Target], bool]) -> tuple[Any, Target] | None:
    """The value nearest to the present one with which a target is possible, found by halving.

    Parameters
    ----------
    target
        An impossible target.
    name
        The field, of EASES.
    possible
        Whether a target is possible; called for each value tried.

    Returns
    -------
    tuple or None
        The value and the target with it, for which `possible` holds, but not for one nearer by CLOSE; None if
        FURTHEST times the value does not suffice.
    """
    low, high = 1.0, FURTHEST
    furthest = EASES[name](target, high)
    if furthest is None or furthest == target or not possible(furthest):
        return None
    best = furthest
    while high / low > 1.0 + CLOSE:
        middle = (low * high) ** 0.5
        tried = EASES[name](target, middle)
        if tried is not None and (tried == best or possible(tried)):
            high, best = middle, tried
        else:
            low = middle
    return value_of(best, name), best
