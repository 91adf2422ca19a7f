"""The rungs of the model ladder, each registered once, in the order of the work they take.

Every list of rungs elsewhere is derived from this one. A new closed form is a file with its compliance and an
entry in `REGISTER`; `benchmarks/ladder_fit.py` then measures its errors (data/ladder.json,
data/accuracy.json).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from . import beams, plane, solid
from .section import Array, HingeSection


@dataclass(frozen=True)
class Rung:
    """A model of the hinge's stiffness.

    name             as `--model` takes it
    when             what it is good for, in the benchmarks' table
    compliance       tip compliance (mm/N) by a closed form, from the constants passed in or else the shipped
                     ones; None for finite elements, which tactcad.fem solves by the rung's name
    fitted           which samples its constants were fitted on, whose range therefore bounds it: "plane", and
                     "width" for solid elements; empty where nothing is fitted
    constant_moment  whether the leaf's moment is taken as the same along the slot
    meshes           halves of the elements' order that can be chosen, rising; (None,) where there is no
                     choice
    """

    name: str
    when: str
    compliance: Callable[[HingeSection, dict | None], Array] | None = None
    fitted: tuple[Literal["plane", "width"], ...] = ()
    constant_moment: bool = False
    meshes: tuple[int | None, ...] = (None,)

    @property
    def against(self) -> str:
        """The finite elements that its errors are measured against: "solid" where it models the width,
        else "plane".
        """
        return "solid" if "width" in self.fitted else "plane"


REGISTER = (
    Rung("short", "orders of magnitude, by hand", lambda s, _: beams.short_hinge(s), constant_moment=True),
    Rung("beam", "to see what beams alone explain", lambda s, _: beams.beam(s)),
    Rung("section", "notches with r/t far above 1", lambda s, _: beams.section_integral(s)),
    Rung("plane", "thin sheet; to compare with plane models", plane.compliance_by, ("plane",)),
    Rung("solid", "design: the default", solid.compliance_by, ("plane", "width")),
    Rung("fem-plane", "a contour of your own, in plane stress"),
    Rung("fem-solid", "the reference", meshes=(2, 3)),
)
BY_NAME = {rung.name: rung for rung in REGISTER}
