"""Where a rung may be used: named rules, each giving a mask over the designs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from tactcad.design.plain_numbers import NINE_DIGITS

from . import friction
from .constants import ladder_data
from .register import BY_NAME
from .section import OPTIONAL, REQUIRED, Array, HingeSection

ROUNDING = 1e-12  # a design on a limit is inside, however its ratios are rounded
POSITIVE = tuple(name for name in REQUIRED if name not in ("fillet_radius", "poisson"))
# Numbers outside these limits are refused by every rung, so that no power that a rung takes of them overflows
# a double: a nanometre to a kilometre; a gel's 1 Pa to a metal's modulus mistakenly given in Pa.
LENGTH = (1e-6, 1e6)  # mm
MODULUS = (1e-6, 1e12)  # MPa
LENGTHS = tuple(name for name in POSITIVE if name != "youngs_modulus")


@dataclass(frozen=True)
class RangeRule:
    """A named rule; `broken` gives the mask of designs that break it."""

    name: str
    broken: Callable[[HingeSection], np.ndarray]


def _not_finite(s: HingeSection) -> np.ndarray:
    numbers = (getattr(s, name) for name in (*REQUIRED, *OPTIONAL))
    return np.logical_not(np.logical_and.reduce([np.isfinite(x) for x in np.broadcast_arrays(*numbers)]))


def _not_positive(s: HingeSection) -> np.ndarray:
    return np.logical_or.reduce(np.broadcast_arrays(*(getattr(s, name) <= 0.0 for name in POSITIVE)))


def _length_outside(s: HingeSection) -> np.ndarray:
    low, high = LENGTH
    small = [getattr(s, name) < low for name in LENGTHS]
    large = [getattr(s, name) > high for name in (*LENGTHS, "fillet_radius", "pad_height")]
    return np.logical_or.reduce(np.broadcast_arrays(*small, *large))


def _slot_depth(s: HingeSection) -> np.ndarray:
    """Height that the hinge and its fillets take up, mm."""
    return s.hinge_thickness + s.notch_sides * s.fillet_radius


GEOMETRY = (
    RangeRule("a value is not a finite number", _not_finite),
    RangeRule("a length, width or modulus is not positive", _not_positive),
    RangeRule(f"a length or width is outside {LENGTH[0]:g} to {LENGTH[1]:g} mm", _length_outside),
    RangeRule(
        f"youngs_modulus is outside {MODULUS[0]:g} to {MODULUS[1]:g} MPa",
        lambda s: (s.youngs_modulus < MODULUS[0]) | (s.youngs_modulus > MODULUS[1]),
    ),
    RangeRule("fillet_radius is negative", lambda s: s.fillet_radius < 0.0),
    RangeRule("poisson is outside 0 to 0.5", lambda s: (s.poisson < 0.0) | (s.poisson >= 0.5)),
    RangeRule(
        "fillets longer than the slot: 2 r > l", lambda s: s.straight_length < -NINE_DIGITS * s.hinge_length
    ),
    RangeRule("load inside the slot: L <= l/2", lambda s: s.load_arm <= s.hinge_length / 2.0),
    RangeRule("fillets higher than the arm", lambda s: s.arm_height < _slot_depth(s)),
    RangeRule("fillets higher than the body", lambda s: s.body_height < _slot_depth(s)),
    RangeRule("pad_height or friction is negative", lambda s: (s.pad_height < 0.0) | (s.friction < 0.0)),
    RangeRule(
        "friction locks the arm: mu (pad_height + t/2) >= L",
        lambda s: s.friction * friction.lever(s) >= s.load_arm,
    ),
)


# Dimensionless groups that bound the fits: on plane elements, and of the width.
PLANE_GROUPS: dict[str, Callable[[HingeSection], Array]] = {
    "r/t": lambda s: s.fillet_radius / s.hinge_thickness,
    "l/t": lambda s: s.hinge_length / s.hinge_thickness,
    "h/t": lambda s: s.arm_height / s.hinge_thickness,
    "Hb/t": lambda s: s.body_height / s.hinge_thickness,
    "(L - l/2)/h": lambda s: (s.load_arm - s.hinge_length / 2.0) / s.arm_height,
    "L/Hb": lambda s: s.load_arm / s.body_height,
    "Lb/Hb": lambda s: s.body_length / s.body_height,
    "poisson": lambda s: s.poisson,
}
WIDTH_GROUPS: dict[str, Callable[[HingeSection], Array]] = {
    "b/t": lambda s: s.width / s.hinge_thickness,
    "b/l": lambda s: s.width / s.hinge_length,
    "b/h": lambda s: s.width / s.arm_height,
    "b/Hb": lambda s: s.width / s.body_height,
}

# Groups with a lower bound only: what is wrong below it, the group, and whose fit it bounds.
LEAST: dict[str, tuple[str, Callable[[HingeSection], Array], str]] = {
    "Lb/t": ("body too short", lambda s: s.body_length / s.hinge_thickness, "plane"),
    "L/t": ("load arm too short", lambda s: s.load_arm / s.hinge_thickness, "plane"),
    "b/r": ("sheet too thin for its fillets", lambda s: s.width / s.fillet_radius, "width"),
}


def groups(s: HingeSection) -> dict[str, Array]:
    """Value of every group for every design."""
    return {name: value(s) for name, value in (PLANE_GROUPS | WIDTH_GROUPS).items()}


@lru_cache
def _fitted(rung: str) -> tuple[RangeRule, ...]:
    """Rules of the fit's sampled range, as data/ladder.json gives it."""
    sampled = ladder_data()["range"]
    height = sampled["least_height"]
    rules = [
        RangeRule(
            f"arm too low for the fit: h < {height:g} (t + n r)",
            lambda s: s.arm_height < height * (1.0 - ROUNDING) * _slot_depth(s),
        ),
        RangeRule(
            f"body too low for the fit: Hb < {height:g} (t + n r)",
            lambda s: s.body_height < height * (1.0 - ROUNDING) * _slot_depth(s),
        ),
    ]
    rules += [
        RangeRule(f"{what} for the fit: {name} < {least:g}", _outside(value, least, np.inf))
        for name, (what, value, of) in LEAST.items()
        if of in BY_NAME[rung].fitted
        for least in (sampled["least"][name],)
    ]
    bounding = PLANE_GROUPS | (WIDTH_GROUPS if "width" in BY_NAME[rung].fitted else {})
    for name, value in bounding.items():
        low, high = sampled["groups"][name]
        rules.append(
            RangeRule(f"{name} is outside the fit's {low:g} to {high:g}", _outside(value, low, high))
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
    return GEOMETRY + _fitted(rung) if BY_NAME[rung].fitted else GEOMETRY


def broken_rules(s: HingeSection, rung: str) -> dict[str, np.ndarray]:
    """The rung's rules that any design breaks.

    Returns
    -------
    dict of str to ndarray of bool
        By the rule's name, the mask of the designs that break it, of the section's shape.
    """
    with np.errstate(all="ignore"):
        masks = {rule.name: np.broadcast_to(rule.broken(s), s.shape) for rule in rules(rung)}
    return {name: mask for name, mask in masks.items() if mask.any()}


def reasons(s: HingeSection, rung: str) -> np.ndarray:
    """For each design the first rule it breaks, or an empty string; array of str of the section's shape."""
    reason = np.full(s.shape, "", dtype=object)
    for name, mask in reversed(broken_rules(s, rung).items()):
        reason[mask] = name
    return reason
