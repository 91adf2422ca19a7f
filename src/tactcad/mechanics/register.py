"""A rung of the model ladder: declared once, in a module of its own.

Every module in mechanics/rungs declares one or more, each a `Rung`; nothing lists them, and every list of
rungs elsewhere is derived from them. A module without a rung, an incomplete declaration, or two with one name
or place are refused on import. `benchmarks/ladder_fit.py` measures their errors (data/ladder.json,
data/accuracy.json).
"""

from __future__ import annotations

import json
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib import import_module
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tactcad.design.family import Late

from .section import Array, HingeSection


@dataclass(frozen=True)
class Rung:
    """A model of the hinge's stiffness: a closed form, or elements.

    name             as `--model` takes it
    place            among the rungs, by the work that they take
    when             what it is good for, in the benchmarks' table
    compliance       tip compliance (mm/N) by a closed form, from the constants passed in or else the shipped
                     ones
    elements         (shape, E, nu, width, and `mesh` if there is a choice) to `fem_ladder.Converged`
    fitted           which samples its constants were fitted on, whose range therefore bounds it: "plane", and
                     "width" for solid elements; empty if nothing is fitted
    constant_moment  whether the leaf's moment is taken as the same along the slot
    meshes           halves of the elements' order that can be chosen, rising; (None,) if there is no
                     choice
    """

    name: str
    place: int
    when: str
    compliance: Callable[[HingeSection, dict | None], Array] | None = None
    elements: Late | None = None
    fitted: tuple[Literal["plane", "width"], ...] = ()
    constant_moment: bool = False
    meshes: tuple[int | None, ...] = (None,)

    def __post_init__(self) -> None:
        if callable(self.compliance) == callable(self.elements):
            raise TypeError(f"rung {self.name}: it must have a compliance or elements, and not both")

    @property
    def against(self) -> str:
        """The finite elements that its errors are measured against: "solid" where it models the width,
        else "plane".
        """
        return "solid" if "width" in self.fitted else "plane"


@cache
def rungs() -> dict[str, Rung]:
    """Every rung by name, in the order of the work they take."""
    from . import rungs as folder

    found: list[Rung] = []
    for _, name, _ in pkgutil.iter_modules(folder.__path__):
        module = import_module(f"{folder.__name__}.{name}")
        if not (own := [r for r in vars(module).values() if isinstance(r, Rung)]):
            raise TypeError(f"no Rung is declared in {module.__name__}")
        found += own
    found.sort(key=lambda rung: rung.place)
    for attribute in ("name", "place"):
        if len({getattr(rung, attribute) for rung in found}) < len(found):
            raise TypeError(f"two rungs have one {attribute}, of {', '.join(rung.name for rung in found)}")
    return {rung.name: rung for rung in found}


@lru_cache(maxsize=1)
def ladder_data() -> dict:
    """data/ladder.json as written by the fit."""
    # not importlib.resources, which takes longer to import than all of this room
    return json.loads((Path(__file__).parent / "data" / "ladder.json").read_text("utf-8"))


@lru_cache(maxsize=1)
def strain_data() -> dict:
    """data/strain.json as written by the fit."""
    return json.loads((Path(__file__).parent / "data" / "strain.json").read_text("utf-8"))


def by_sides(
    group: str, two_sided: NDArray[np.bool_] | np.bool_, data: dict | None = None
) -> dict[str, Array | float]:
    """Constants of a group ("root", "width", ...) for each design's notch form.

    From `data` (as data/ladder.json), by default the shipped ones. Plain floats if all designs have one form,
    so that the common case needs no array.
    """
    table = (data or ladder_data())[group]
    if np.all(two_sided):
        return table["two"]
    if not np.any(two_sided):
        return table["one"]
    return {k: np.where(two_sided, table["two"][k], table["one"][k]) for k in table["two"]}
