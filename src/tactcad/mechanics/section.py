"""The hinged element as the closed forms see it: ten numbers, or ten arrays of numbers.

Side view, in the plane that the wire cuts; the width b is the sheet's thickness::

      body (clamped at its far edge)     slot       arm
     +------------------------------+           +-------------------------+
     |                              |___________|                         | <- load
     |  Hb                          |___________|                      h  |
     |                              |  hinge t  |                         |
     +------------------------------+           +-------------------------+
     |<------------ Lb ------------>|<--- l --->|
                                          |<------- load arm L ---------->|

One-sided: one slot, the hinge lies at the flat face. Two-sided: slots from both faces, body, hinge
and arm on one mid-line. Both slot corners are rounded by the fillet radius r.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import MISSING, dataclass, field, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def _none() -> Array:
    return np.zeros(())


@dataclass(frozen=True)
class HingeSection:
    """Parameters of one element or of many: arrays (of no dimension for one element) that broadcast together.

    Numbers and lists are converted to arrays; type-checked code passes them to `HingeSection.of`. The sketch
    is at the top of the module.

    Parameters
    ----------
    hinge_thickness, hinge_length, fillet_radius
        t, l and r of the slot, mm.
    load_arm
        L from the hinge's centre to the load line, mm.
    arm_height, body_height, body_length
        h, Hb and Lb, mm.
    poisson, youngs_modulus
        Of the sheet; MPa.
    width
        b, the sheet's thickness, mm.
    two_sided
        Whether the slot is cut from both faces: a bool or an array of bools.
    pad_height, friction
        From the hinge's face towards the object to the contact, mm, and the coefficient of friction there;
        they matter only together, see `friction_factor`.
    """

    hinge_thickness: Array
    hinge_length: Array
    fillet_radius: Array
    load_arm: Array
    arm_height: Array
    body_height: Array
    body_length: Array
    poisson: Array
    youngs_modulus: Array
    width: Array
    two_sided: NDArray[np.bool_]
    pad_height: Array = field(default_factory=_none)
    friction: Array = field(default_factory=_none)

    def __post_init__(self) -> None:
        for each in fields(self):
            kind = bool if each.name == "two_sided" else float
            object.__setattr__(self, each.name, np.asarray(getattr(self, each.name), dtype=kind))
        self.shape  # raises ValueError if they do not broadcast

    @classmethod
    def of(cls, **parameters: ArrayLike) -> HingeSection:
        """A section from numbers, lists or arrays."""
        return cls(**{name: np.asarray(value) for name, value in parameters.items()})

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Common shape of all parameters."""
        return np.broadcast_shapes(*(getattr(self, f.name).shape for f in fields(self)))

    @property
    def straight_length(self) -> Array:
        """lc = l - 2 r, the slot's length between its fillets, mm."""
        return self.hinge_length - 2.0 * self.fillet_radius

    @property
    def shear_modulus(self) -> Array:
        """G = E/(2(1 + nu)), MPa."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poisson))

    @property
    def notch_sides(self) -> Array:
        """Number of faces from which the slot is cut: 1 or 2."""
        return np.where(self.two_sided, 2.0, 1.0)

    def with_(self, **changes: ArrayLike) -> HingeSection:
        """A copy with some parameters replaced."""
        return replace(self, **{name: np.asarray(value) for name, value in changes.items()})

    def rows(self, index: int | slice | Sequence[int] | NDArray[Any]) -> HingeSection:
        """The designs at `index` of the flattened common shape; a parameter that is one number for all
        stays so.
        """
        shape = self.shape
        picked = {}
        for each in fields(self):
            value = getattr(self, each.name)
            if value.size == 1:
                picked[each.name] = value.reshape(())
            else:
                picked[each.name] = np.broadcast_to(value, shape).reshape(-1)[index]
        return HingeSection(**picked)


# Names of the parameters that must be given, and of the optional ones with their defaults.
REQUIRED = tuple(
    f.name for f in fields(HingeSection) if f.default_factory is MISSING and f.name != "two_sided"
)
OPTIONAL = {f.name: 0.0 for f in fields(HingeSection) if f.default_factory is not MISSING}

# The element that three independent codes were compared on, mm and MPa.
REFERENCE = HingeSection.of(
    hinge_thickness=0.25,
    hinge_length=0.75,
    fillet_radius=0.15,
    load_arm=6.0,
    arm_height=2.0,
    body_height=4.0,
    body_length=4.0,
    poisson=0.33,
    youngs_modulus=69000.0,
    width=3.0,
    two_sided=True,
)


def friction_lever(s: HingeSection) -> Array:
    """H = pad_height + t/2, distance from the hinge's mid-plane to the contact, mm."""
    return s.pad_height + s.hinge_thickness / 2.0


def friction_factor(s: HingeSection) -> Array:
    """L/(L - mu H): the contact slides by H d/L, and friction against it adds moment mu F H.

    Only meaningful where mu H < L; beyond that the arm locks itself (`validity` refuses it).
    """
    L = s.load_arm
    return L / (L - s.friction * friction_lever(s))
