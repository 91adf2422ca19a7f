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

from dataclasses import MISSING, dataclass, fields, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class HingeSection:
    """Parameters of one element or of many: scalars or arrays that broadcast together.

    Lengths in mm, youngs_modulus in MPa. `two_sided` is a bool or an array of bools. `pad_height`
    (mm, from the hinge's face towards the object to the contact) and `friction` there only act
    together, see `friction.factor`.
    """

    hinge_thickness: ArrayLike
    hinge_length: ArrayLike
    fillet_radius: ArrayLike
    load_arm: ArrayLike
    arm_height: ArrayLike
    body_height: ArrayLike
    body_length: ArrayLike
    poisson: ArrayLike
    youngs_modulus: ArrayLike
    width: ArrayLike
    two_sided: ArrayLike
    pad_height: ArrayLike = 0.0
    friction: ArrayLike = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            kind = bool if field.name == "two_sided" else float
            object.__setattr__(self, field.name, np.asarray(getattr(self, field.name), dtype=kind))
        np.broadcast_shapes(*(getattr(self, f.name).shape for f in fields(self)))

    @property
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
        """How many faces the slot is cut from: 1 or 2."""
        return np.where(self.two_sided, 2.0, 1.0)

    def with_(self, **changes: ArrayLike) -> HingeSection:
        """A copy with some parameters replaced."""
        return replace(self, **changes)

    def rows(self, index: object) -> HingeSection:
        """The designs at `index` of the flattened common shape; what is one for all stays one."""
        shape = self.shape
        picked = {}
        for field in fields(self):
            value = getattr(self, field.name)
            if value.size == 1:
                picked[field.name] = value.reshape(())
            else:
                picked[field.name] = np.broadcast_to(value, shape).reshape(-1)[index]
        return HingeSection(**picked)


# Names of the numbers that make a section: those without which there is none, and the others' defaults.
REQUIRED = tuple(f.name for f in fields(HingeSection) if f.default is MISSING and f.name != "two_sided")
OPTIONAL = {f.name: f.default for f in fields(HingeSection) if f.default is not MISSING}

# The element that three independent codes were compared on, mm and MPa.
REFERENCE = HingeSection(
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
