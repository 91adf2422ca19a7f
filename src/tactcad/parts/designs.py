"""Loading a design that keeps every rule."""

from __future__ import annotations

from pathlib import Path

from tactcad.design.load import read
from tactcad.design.tree import CommonTables

from .rules import refuse_broken


def load(source: str | Path) -> CommonTables:
    """A design, checked against every rule between its fields.

    Parameters
    ----------
    source
        A path (it has a '/' or ends in .toml), or the name of a design in hardware/.

    Raises
    ------
    InputError
        If the file is missing or not a design, a value is not legal, or a rule is broken.
    """
    design = read(source)
    refuse_broken(design)
    return design
