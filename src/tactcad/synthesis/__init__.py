"""From a target to a design: the array that measures the target's objects, with its interval.

In: objects, room, force and tolerances (TARGET.toml). Out: a design file that keeps every rule, its predicted
interval and yield, its limits, and alternatives.
"""

from .synthesise import Synthesis, design
from .target import read_target

__all__ = ["Synthesis", "design", "read_target"]
