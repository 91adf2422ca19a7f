"""What a synthesis tells beside its design: other designs, fields that limit it, and least changes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .search import Found


@dataclass(frozen=True)
class Alternative:
    """One design of the front.

    name, what   of the entry, and what was held beside the interval
    found        its candidate
    half_width   relative, nominal, largest over the range
    """

    name: str
    what: str
    found: Found

    @property
    def half_width(self) -> float:
        return self.found.half_width

    def record(self) -> dict[str, Any]:
        c, stand = self.found.candidate, self.found.candidate.stand
        return {
            "name": self.name,
            "what": self.what,
            "half_width": self.half_width,
            "elements": int(c.total[0]),
            "different": int(c.different[0]),
            "carrier_area_mm2": float(c.area[0]),
            "cut_length_mm": float(c.cut[0]),
            "hinge_tolerance_mm": stand.base.tolerance.hinge_thickness,
            "sheet_mm": stand.base.sheet.thickness,
            "alloy": stand.base.material.alloy,
            "arms_mm": [round(float(a), 6) for a in c.arm[0]],
            "hinges_mm": [round(float(t), 6) for t in c.thickness[0]],
            "counts": [int(n) for n in c.count[0]],
            "stiffness_N_per_mm": [float(k) for k in c.elements.stiffness[0]],
        }


@dataclass(frozen=True)
class Limit:
    """A field of the target that limits: eased by one step alone, the half-width falls to `half_width`."""

    field: str
    value: Any
    eased: Any
    half_width: float
    gain: float


@dataclass(frozen=True)
class LeastChange:
    """A field whose change alone makes the target possible, and the nearest value that does."""

    field: str
    value: Any
    needed: Any
