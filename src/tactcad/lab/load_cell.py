"""The force sensor, a spring in series with the element: its stiffness, and how well it is known."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isinf

from tactcad.design.messages import InputError

# Relative half-width assumed of a load cell's stiffness that is given without limits. Chosen: what one
# measurement with weights and a micrometer reaches.
CELL_ACCURACY = 0.02


@dataclass(frozen=True)
class LoadCell:
    """The force sensor's own stiffness, known to lie within stiffness +- half_width; both N/mm.

    Raises
    ------
    InputError
        A stiffness that is not positive, limits that reach zero.
    """

    stiffness: float
    half_width: float = 0.0

    def __post_init__(self) -> None:
        if not self.stiffness > 0:
            raise InputError(
                "load cell", "stiffness must be positive", value=self.stiffness, legal="above 0 N/mm, or inf"
            )
        if not 0 <= self.half_width < self.stiffness:
            legal = f"from 0 to below {self.stiffness:g} N/mm"
            raise InputError(
                "load cell", "its limits must leave it a stiffness", value=self.half_width, legal=legal
            )

    @classmethod
    def parse(cls, text: str) -> LoadCell:
        """From "57.04", "57.04+-1", "57.04+-2%" or "inf"; without limits `CELL_ACCURACY` is assumed.

        Raises
        ------
        InputError
            The text is none of these.
        """
        value, _, limits = text.replace("\N{PLUS-MINUS SIGN}", "+-").partition("+-")
        try:
            stiffness = float(value)
            half = float(limits.removesuffix("%")) if limits else 100 * CELL_ACCURACY
        except ValueError:
            legal = "a stiffness in N/mm with its limits, as in 57.04+-1 or 57.04+-2%, or inf"
            raise InputError("load cell", "not a stiffness", value=text, legal=legal) from None
        if isinf(stiffness):
            return cls(stiffness)
        return cls(stiffness, half if limits and not limits.endswith("%") else half * stiffness / 100)

    @property
    def ends(self) -> tuple[float, float]:
        """Softest and stiffest, N/mm."""
        if isinf(self.stiffness):
            return self.stiffness, self.stiffness
        return self.stiffness - self.half_width, self.stiffness + self.half_width


def series_removed(slope: float, load_cell: float) -> float:
    """Stiffness of the element alone, k K_c/(K_c - k), from that of element and load cell in series.

    Parameters
    ----------
    slope : float
        k: force over the stage's displacement, N/mm.
    load_cell : float
        K_c, N/mm; inf for a rigid one.

    Returns
    -------
    float
        N/mm; inf where k is no less than K_c.
    """
    if isinf(load_cell):
        return slope
    return slope * load_cell / (load_cell - slope) if slope < load_cell else inf
