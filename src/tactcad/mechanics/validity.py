"""Where a rung may be used: named rules, each a mask over the designs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np

from . import friction
from .constants import ladder_data
from .section import HingeSection

POSITIVE = (
    "hinge_thickness", "hinge_length", "load_arm", "arm_height", "body_height", "body_length",
    "youngs_modulus", "width",
)


@dataclass(frozen=True)
class Rule:
    """A named rule; `broken` gives the mask of designs that break it."""

    name: str
    broken: Callable[[HingeSection], np.ndarray]


def _not_finite(s: HingeSection) -> np.ndarray:
    numbers = (getattr(s, f.name) for f in fields(s) if f.name != "two_sided")
    return np.logical_not(np.logical_and.reduce([np.isfinite(x) for x in np.broadcast_arrays(*numbers)]))


def _not_positive(s: HingeSection) -> np.ndarray:
    return np.logical_or.reduce(np.broadcast_arrays(*(getattr(s, name) <= 0.0 for name in POSITIVE)))


def _slot_depth(s: HingeSection) -> np.ndarray:
    """Height that the hinge and its fillets take up, mm."""
    return s.hinge_thickness + s.notch_sides * s.fillet_radius


# lc = l - 2 r may come out a few ulp below zero where the radius is written as half the length
GEOMETRY = (
    Rule("a value is not a finite number", _not_finite),
    Rule("a length, width or modulus is not positive", _not_positive),
    Rule("fillet_radius is negative", lambda s: s.fillet_radius < 0.0),
    Rule("poisson is outside 0 to 0.5", lambda s: (s.poisson < 0.0) | (s.poisson >= 0.5)),
    Rule("fillets longer than the slot: 2 r > l", lambda s: s.straight_length < -1e-12 * s.hinge_length),
    Rule("load inside the slot: L <= l/2", lambda s: s.load_arm <= s.hinge_length / 2.0),
    Rule("fillets higher than the arm", lambda s: s.arm_height < _slot_depth(s)),
    Rule("fillets higher than the body", lambda s: s.body_height < _slot_depth(s)),
    Rule("pad_height or friction is negative", lambda s: (s.pad_height < 0.0) | (s.friction < 0.0)),
    Rule("friction locks the arm: mu (pad_height + t/2) >= L",
         lambda s: s.friction * friction.lever(s) >= s.load_arm),
)


def _min_height() -> float:
    return ladder_data()["range"]["min_height_ratio"]


FITTED = (
    Rule("arm too low for the fit: h < 1.25 (t + n r)",
         lambda s: s.arm_height < _min_height() * _slot_depth(s)),
    Rule("body too low for the fit: Hb < 1.25 (t + n r)",
         lambda s: s.body_height < _min_height() * _slot_depth(s)),
)

RULES = {
    "short": GEOMETRY,
    "beam": GEOMETRY,
    "section": GEOMETRY,
    "plane": GEOMETRY + FITTED,
    "solid": GEOMETRY + FITTED,
    "fem-plane": GEOMETRY,
    "fem-solid": GEOMETRY,
}


def broken_rules(s: HingeSection, rung: str) -> dict[str, np.ndarray]:
    """Masks (of the section's shape) of the designs that break each of the rung's rules."""
    with np.errstate(invalid="ignore", over="ignore"):
        masks = {rule.name: np.broadcast_to(rule.broken(s), s.shape) for rule in RULES[rung]}
    return {name: mask for name, mask in masks.items() if mask.any()}


def reasons(s: HingeSection, rung: str) -> np.ndarray:
    """For each design the first rule it breaks, or an empty string; array of str of the section's shape."""
    found = np.full(s.shape, "", dtype=object)
    for name, mask in reversed(broken_rules(s, rung).items()):
        found[mask] = name
    return found
