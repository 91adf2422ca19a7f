"""Limits of a synthesis: each field of the target eased alone, and the best result then."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields
from typing import Any

from .target import TABLES, Target

# Sheets, alloys, gauges, powers, known.how and target.base are not tried: they have no order. For each field
# that can be eased, the direction of an easing step: 10 %, or 1 for a count, or 0.01 mm for a hinge.
STEP, HINGE_STEP = 0.10, 0.01
FURTHEST = 8.0  # largest factor by which a field is eased before it is reported not to help alone
CLOSE = 0.02  # relative; the least change is found to within this


NOT_NARROWING = ("target.half_width", "target.share", "room.height")  # eased, they change no interval

Ease = Callable[[Target, float], Target | None]


def _get(target: Target, path: str) -> Any:
    table, name = path.split(".")
    return getattr(getattr(target, table), name)


def _legal(path: str, value: float) -> float:
    """The value, no further than a target file may say it."""
    table, name = path.split(".")
    spec = next(f for f in fields(TABLES[table]) if f.name == name).metadata["spec"]
    spec = getattr(spec, "item", spec)
    return min(max(value, spec.low), spec.high)


def _scaled(path: str, up: bool) -> Ease:
    def ease(target: Target, by: float) -> Target | None:
        value = _get(target, path)
        return target.with_(path, _legal(path, value * by if up else value / by)) if value else None

    return ease


def _whole(path: str, up: bool = True) -> Ease:
    def ease(target: Target, by: float) -> Target | None:
        value = _get(target, path)
        if by <= 1.0:
            return target
        other = max(value + 1, round(value * by)) if up else min(value - 1, round(value / by))
        return target.with_(path, int(_legal(path, other)))

    return ease


def _end(path: str, end: int, up: bool, whole: bool = False) -> Ease:
    """One end of a range."""

    def ease(target: Target, by: float) -> Target | None:
        pair = list(_get(target, path) or ())
        if not pair:
            return None
        pair[end] = pair[end] * by if up else pair[end] / by
        if whole:
            one_more = _get(target, path)[end] + (1 if up else -1) * (by > 1.0)
            pair[end] = max(round(pair[end]), one_more) if up else min(round(pair[end]), one_more)
        pair[end] = _legal(path, pair[end])
        return target.with_(path, tuple(pair)) if pair[0] <= pair[1] else None

    return ease


def _share(target: Target, by: float) -> Target:
    """Arrays that need not meet the target: by so much more."""
    return target.with_("target.share", _legal("target.share", 1.0 - (1.0 - target.target.share) * by))


def _tolerances(target: Target, by: float) -> Target:
    finest = _legal("stock.hinge_tolerances", min(target.stock.hinge_tolerances) / by)
    finer = tuple(sorted({*target.stock.hinge_tolerances, finest}))
    return target.with_("stock.hinge_tolerances", finer)


EASES: dict[str, Ease] = {
    "target.half_width": _scaled("target.half_width", True),
    "target.share": _share,
    "object.stiffness[0]": _end("object.stiffness", 0, True),
    "object.stiffness[1]": _end("object.stiffness", 1, False),
    "object.modulus[0]": _end("object.modulus", 0, True),
    "object.modulus[1]": _end("object.modulus", 1, False),
    "grasp.force": _scaled("grasp.force", True),
    "grasp.element_force": _scaled("grasp.element_force", True),
    "grasp.overload": _scaled("grasp.overload", False),
    "grasp.loads": _whole("grasp.loads"),
    "room.rows": _whole("room.rows"),
    "room.elements[0]": _end("room.elements", 0, False, whole=True),
    "room.elements[1]": _end("room.elements", 1, True, whole=True),
    "room.pitch": _scaled("room.pitch", False),
    "room.length": _scaled("room.length", True),
    "room.width": _scaled("room.width", True),
    "room.height": _scaled("room.height", True),
    "elements.kinds": _whole("elements.kinds"),
    "elements.of_a_kind": _whole("elements.of_a_kind", False),
    "elements.arms[0]": _end("elements.arms", 0, False),
    "elements.arms[1]": _end("elements.arms", 1, True),
    "elements.hinges[0]": _end("elements.hinges", 0, False),
    "elements.hinges[1]": _end("elements.hinges", 1, True),
    "stock.hinge_tolerances": _tolerances,
    "known.thickness": _scaled("known.thickness", False),
    "known.gauge_factor": _scaled("known.gauge_factor", False),
    "known.runs": _whole("known.runs"),
    "known.run_scatter": _scaled("known.run_scatter", False),
    "known.force_noise": _scaled("known.force_noise", False),
    "known.displacement_noise": _scaled("known.displacement_noise", False),
    "known.contact": _scaled("known.contact", False),
}
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


def value_of(target: Target, name: str) -> Any:
    """The value of a field by the name that `eased` gives it."""
    path, _, end = name.partition("[")
    table, field = path.split(".")
    value = getattr(getattr(target, table), field)
    return value[int(end[:-1])] if end else value


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
