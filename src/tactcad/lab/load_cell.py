"""The force sensor, a spring in series with the element: its stiffness, and how well it is known."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isinf

from tactcad.design.messages import InputError
from tactcad.design.plain_numbers import as_number

# Relative half-width assumed of a load cell's stiffness that is given without limits. Chosen: what one
# measurement with weights and a micrometer reaches.
CELL_ACCURACY = 0.02
RIGID = 1e9  # N/mm: what a calibration's file gives for a rigid load cell


@dataclass(frozen=True)
class LoadCell:
    """The force sensor's own stiffness, known to lie within stiffness +- half_width; both N/mm.

    Raises
    ------
    InputError
        A stiffness not positive, or finite and above RIGID; limits that reach zero, or of a rigid one.
    """

    stiffness: float
    half_width: float = 0.0

    def __post_init__(self) -> None:
        if not 0 < self.stiffness <= RIGID and (self.stiffness, self.half_width) != (inf, 0):
            legal = f"above 0 N/mm up to {RIGID:g} N/mm, or inf without limits"
            raise InputError("load cell", "not a stiffness", value=self.stiffness, legal=legal)
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
        value, given, limits = text.strip().replace("\N{PLUS-MINUS SIGN}", "+-").partition("+-")
        try:
            stiffness = as_number(value)
            half = as_number(limits.removesuffix("%")) if given else 100 * CELL_ACCURACY
        except ValueError:
            legal = "a stiffness in N/mm with its limits, as in 57.04+-1 or 57.04+-2%, or inf"
            raise InputError("load cell", "not a stiffness", value=text, legal=legal) from None
        if isinf(stiffness) and not given:
            return cls(stiffness)
        return cls(stiffness, half if given and not limits.endswith("%") else half * stiffness / 100)

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
