"""How many passes of wire cutting hold a limit."""

from __future__ import annotations

# Half-width in mm by number of passes, the coarser figure of vendors' pages (mecvil.com, tongrencnc.com): one
# pass 0.015 to 0.025, two to three 0.010, four and more 0.002 to 0.005.
WIRE_TOLERANCE = {"1 pass": 0.025, "2-3 passes": 0.010, "4 or more passes": 0.005}
_ENOUGH = (("one pass", "1 pass"), ("three passes", "2-3 passes"))


def least_passes(tolerance: float) -> str:
    """In words, the passes that hold that limit (mm, plus and minus): of two or three, three; more than four
    are promised nowhere."""
    return next((words for words, key in _ENOUGH if tolerance >= WIRE_TOLERANCE[key]), "four passes")
