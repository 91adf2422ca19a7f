"""A rung's range of validity: named rules, each giving a mask over the designs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, reduce

import numpy as np

from tactcad.design.text_values import NINE_DIGITS

from .register import ladder_data, rungs
from .section import OPTIONAL, REQUIRED, Array, HingeSection, friction_lever

ROUNDING = 1e-12  # a design on a limit is inside, however its ratios are rounded
POSITIVE = tuple(name for name in REQUIRED if name not in ("fillet_radius", "poisson"))
# Numbers outside these limits are refused by every rung, so that no power that a rung takes of them overflows
# a double: a nanometre to a kilometre; a gel's 1 Pa to a metal's modulus mistakenly given in Pa.
LENGTH = (1e-6, 1e6)  # mm
MODULUS = (1e-6, 1e12)  # MPa
LENGTHS = tuple(name for name in POSITIVE if name != "youngs_modulus")


@dataclass(frozen=True)
class RangeRule:
    """A named rule; `broken` gives the mask of designs that break it.

    fields: parameters that it is about, as the batch's columns are called; the messages name them, of a rule
    for `each` of them by itself the first that breaks it.
    """

    name: str
    broken: Callable[[HingeSection], np.ndarray]
    fields: tuple[str, ...]
    each: Callable[[HingeSection, str], np.ndarray] | None = None


@dataclass(frozen=True)
class Reason:
    """Why a rung does not reach a design: the rule that it breaks, and the parameters to look at."""

    rule: str
    fields: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.rule} ({', '.join(self.fields)})"


def _each(name: str, fields: tuple[str, ...], breaks: Callable[[HingeSection, str], np.ndarray]) -> RangeRule:
    """A rule that every field has to keep by itself."""

    def broken(s: HingeSection) -> np.ndarray:
        return reduce(np.logical_or, (breaks(s, field) for field in fields))

    return RangeRule(name, broken, fields, breaks)


def _not_finite(s: HingeSection, field: str) -> np.ndarray:
    return ~np.isfinite(getattr(s, field))


def _not_positive(s: HingeSection, field: str) -> np.ndarray:
    return np.asarray(getattr(s, field) <= 0.0)


def _length_outside(s: HingeSection, field: str) -> np.ndarray:
    value, (low, high) = getattr(s, field), LENGTH
    return np.asarray((value > high) | ((value < low) & (field in LENGTHS)))


def _slot_depth(s: HingeSection) -> np.ndarray:
    """Height that the hinge and its fillets take up, mm."""
    return s.hinge_thickness + s.notch_sides * s.fillet_radius


SLOT = ("hinge_thickness", "fillet_radius")
GEOMETRY = (
    _each("a value is not a finite number", (*REQUIRED, *OPTIONAL), _not_finite),
    _each("a length, width or modulus is not positive", POSITIVE, _not_positive),
    _each(
        f"a length or width is outside {LENGTH[0]:g} to {LENGTH[1]:g} mm",
        (*LENGTHS, "fillet_radius", "pad_height"),
        _length_outside,
    ),
    RangeRule(
        f"youngs_modulus is outside {MODULUS[0]:g} to {MODULUS[1]:g} MPa",
        lambda s: (s.youngs_modulus < MODULUS[0]) | (s.youngs_modulus > MODULUS[1]),
        ("youngs_modulus",),
    ),
    RangeRule("fillet_radius is negative", lambda s: s.fillet_radius < 0.0, ("fillet_radius",)),
    RangeRule("poisson is outside 0 to 0.5", lambda s: (s.poisson < 0.0) | (s.poisson >= 0.5), ("poisson",)),
    RangeRule(
        "fillets longer than the slot: 2 r > l",
        lambda s: s.straight_length < -NINE_DIGITS * s.hinge_length,
        ("fillet_radius", "hinge_length"),
    ),
    RangeRule(
        "load inside the slot: L <= l/2",
        lambda s: s.load_arm <= s.hinge_length / 2.0,
        ("load_arm", "hinge_length"),
    ),
    RangeRule("fillets higher than the arm", lambda s: s.arm_height < _slot_depth(s), ("arm_height", *SLOT)),
    RangeRule(
        "fillets higher than the body", lambda s: s.body_height < _slot_depth(s), ("body_height", *SLOT)
    ),
    RangeRule(
        "pad_height or friction is negative",
        lambda s: (s.pad_height < 0.0) | (s.friction < 0.0),
        ("pad_height", "friction"),
    ),
    RangeRule(
        "friction locks the arm: mu (pad_height + t/2) >= L",
        lambda s: s.friction * friction_lever(s) >= s.load_arm,
        ("friction", "pad_height", "hinge_thickness", "load_arm"),
    ),
)


# Parameters that a dimensionless group is made of, as the batch's columns are called.
FIELDS: dict[str, tuple[str, ...]] = {
    "r/t": ("fillet_radius", "hinge_thickness"),
    "l/t": ("hinge_length", "hinge_thickness"),
    "h/t": ("arm_height", "hinge_thickness"),
    "Hb/t": ("body_height", "hinge_thickness"),
    "(L - l/2)/h": ("load_arm", "hinge_length", "arm_height"),
    "L/Hb": ("load_arm", "body_height"),
    "Lb/Hb": ("body_length", "body_height"),
    "poisson": ("poisson",),
    "b/t": ("width", "hinge_thickness"),
    "b/l": ("width", "hinge_length"),
    "b/h": ("width", "arm_height"),
    "b/Hb": ("width", "body_height"),
    "Lb/t": ("body_length", "hinge_thickness"),
    "L/t": ("load_arm", "hinge_thickness"),
    "b/r": ("width", "fillet_radius"),
}


def _group(name: str) -> Callable[[HingeSection], Array]:
    """Its value: a parameter, the ratio of two, or the arm's reach beyond the slot over its height."""
    over, *under = FIELDS[name]
    if len(under) == 2:
        return lambda s: (s.load_arm - s.hinge_length / 2.0) / s.arm_height
    return lambda s: getattr(s, over) / getattr(s, under[0]) if under else getattr(s, over)


# Groups that bound the fits: on plane elements, and of the width.
PLANE_GROUPS = {
    name: _group(name) for name in ("r/t", "l/t", "h/t", "Hb/t", "(L - l/2)/h", "L/Hb", "Lb/Hb", "poisson")
}
WIDTH_GROUPS = {name: _group(name) for name in ("b/t", "b/l", "b/h", "b/Hb")}
# Groups with a lower bound only: the fault below it, the group, and the bounded fit.
LEAST = {
    "Lb/t": ("body too short", _group("Lb/t"), "plane"),
    "L/t": ("load arm too short", _group("L/t"), "plane"),
    "b/r": ("sheet too thin for its fillets", _group("b/r"), "width"),
}


def groups(s: HingeSection) -> dict[str, Array]:
    """Value of every group for every design."""
    return {name: value(s) for name, value in (PLANE_GROUPS | WIDTH_GROUPS).items()}


def in_bounds(bounds: Mapping[str, Sequence[float | None]], values: Mapping[str, Array]) -> np.ndarray:
    """Mask of the designs with low <= group < high for each of a zone's bounds; None: no end."""
    inside: np.ndarray = np.ones((), bool)
    for name, (low, high) in bounds.items():
        inside = inside & (values[name] >= (low or 0.0)) & (values[name] < (np.inf if high is None else high))
    return inside


@lru_cache
def _fitted(rung: str) -> tuple[RangeRule, ...]:
    """Rules of the fit's sampled range, as data/ladder.json gives it."""
    sampled = ladder_data()["range"]
    height = sampled["least_height"]
    rules = [
        RangeRule(
            f"arm too low for the fit: h < {height:g} (t + n r)",
            lambda s: s.arm_height < height * (1.0 - ROUNDING) * _slot_depth(s),
            ("arm_height", *SLOT),
        ),
        RangeRule(
            f"body too low for the fit: Hb < {height:g} (t + n r)",
            lambda s: s.body_height < height * (1.0 - ROUNDING) * _slot_depth(s),
            ("body_height", *SLOT),
        ),
    ]
    rules += [
        RangeRule(f"{what} for the fit: {name} < {least:g}", _outside(value, least, np.inf), FIELDS[name])
        for name, (what, value, of) in LEAST.items()
        if of in rungs()[rung].fitted
        for least in (sampled["least"][name],)
    ]
    bounding = PLANE_GROUPS | (WIDTH_GROUPS if "width" in rungs()[rung].fitted else {})
    for name, value in bounding.items():
        low, high = sampled["groups"][name]
        rules.append(
            RangeRule(
                f"{name} is outside the fit's {low:g} to {high:g}", _outside(value, low, high), FIELDS[name]
            )
        )
    return tuple(rules)


def _outside(
    value: Callable[[HingeSection], Array], low: float, high: float
) -> Callable[[HingeSection], np.ndarray]:
    low, high = low * (1.0 - ROUNDING), high * (1.0 + ROUNDING)

    def broken(s: HingeSection) -> np.ndarray:
        v = value(s)
        return ~((v >= low) & (v <= high))

    return broken


def rules(rung: str) -> tuple[RangeRule, ...]:
    """The rung's rules in the order in which they are looked at."""
    return GEOMETRY + _fitted(rung) if rungs()[rung].fitted else GEOMETRY


def broken_rules(s: HingeSection, rung: str) -> dict[str, np.ndarray]:
    """The rung's rules that any design breaks.

    Returns
    -------
    dict of str to ndarray of bool
        By the rule's name, the mask of the designs that break it, of the section's shape.
    """
    known = s.__dict__.setdefault("broken_rules", {})  # used by every formula of the section
    if rung not in known:
        with np.errstate(all="ignore"):
            masks = {rule.name: rule.broken(s) for rule in rules(rung)}
        known[rung] = {name: np.broadcast_to(mask, s.shape) for name, mask in masks.items() if mask.any()}
    return known[rung]


def within(s: HingeSection, rung: str) -> np.ndarray:
    """Mask of the designs that keep every rule of the rung, of the section's shape."""
    broken = broken_rules(s, rung)
    return ~np.logical_or.reduce([*broken.values(), np.zeros(s.shape, bool)])


def reasons(s: HingeSection, rung: str) -> np.ndarray:
    """For each design the first rule it breaks and the fields to look at, "rule (field, field)", or an empty
    string; array of str of the section's shape."""
    return in_words(first_broken(s, rung))


def in_words(broken: np.ndarray) -> np.ndarray:
    """`first_broken` in the words of `reasons`."""
    words = np.empty(broken.shape, dtype=object)
    words.reshape(-1)[:] = ["" if one is None else str(one) for one in broken.reshape(-1)]
    return words


def first_broken(s: HingeSection, rung: str) -> np.ndarray:
    """For each design the `Reason` of the first rule it breaks, or None; array of the section's shape."""
    reason = np.full(s.shape, None, dtype=object)
    broken = broken_rules(s, rung)
    for rule in reversed([rule for rule in rules(rung) if rule.name in broken]):
        if rule.each is None:
            reason[broken[rule.name]] = Reason(rule.name, rule.fields)
            continue
        for field in reversed(rule.fields):
            with np.errstate(all="ignore"):
                reason[np.broadcast_to(rule.each(s, field), s.shape)] = Reason(rule.name, (field,))
    return reason
