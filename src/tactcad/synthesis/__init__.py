"""From a target to a design: the array that feels what is to be felt, and how surely.

In: what is to be felt, with how much room, force and tolerance (TARGET.toml). Out: a design file that every
rule accepts, its predicted interval and yield, what limits it, and alternatives.
"""

from .synthesise import Synthesis, design
from .target import read_target

__all__ = ["Synthesis", "design", "read_target"]
