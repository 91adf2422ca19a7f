"""The formats that a part is exported in: one entry of PART_FORMATS each, made by a module of its own.

A maker gets the part, the shapes and the file's header, returns bytes that it has read back and compared with
the part, and raises CheckFailure where they differ. It imports what it needs when it runs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from tactcad.parts.description import NOT_MADE, Part

from .shapes import Shapes, picture_bytes

if TYPE_CHECKING:
    from .step_text import Header


@dataclass(frozen=True)
class PartFormat:
    """`kind` in the manifest, `path` below the export's folder, which parts have such a file, and its
    maker."""

    kind: str
    path: str
    has: Callable[[Part], bool]
    make: Callable[[Part, Shapes, Header], bytes]


def _step(part: Part, shapes: Shapes, head: Header) -> bytes:
    from .step_file import part_step

    return part_step(part, shapes.of(part), head)


def has_limits(part: Part) -> bool:
    """Whether it is made here and states any limit."""
    made = part.process not in NOT_MADE
    return made and any((part.characteristics, part.geometric, part.datums))


def _step_pmi(part: Part, shapes: Shapes, head: Header) -> bytes:
    from tactcad.drawing.engine.workers import made_apart
    from tactcad.solids.bytes import to_bytes

    from .step_pmi import part_step_pmi

    shape = to_bytes(shapes.of(part))
    return made_apart(f"{part.part_no}: model with limits (AP242)", part_step_pmi, part, shape, head)


def _has_cut_file(part: Part) -> bool:
    """Whether it is cut from sheet or plate."""
    from tactcad.parts.cut_section import cut_section

    return cut_section(part) is not None


def _dxf(part: Part, shapes: Shapes, head: Header) -> bytes:
    from .dxf import checked_dxf

    return checked_dxf(part)


def _picture(part: Part, shapes: Shapes, head: Header) -> bytes:
    from tactcad.scenes.scene import Placement

    alone = (Placement(part.part_no, part),)
    return picture_bytes(alone, "oblique", shapes, part.name, f"{part.part_no} revision {head.revision}")


PART_FORMATS = (
    PartFormat("step-part", "step/{part_no}_{revision}.step", lambda part: True, _step),
    PartFormat("step-pmi", "step/{part_no}_{revision}-ap242.step", has_limits, _step_pmi),
    PartFormat("dxf", "dxf/{part_no}_{revision}.dxf", _has_cut_file, _dxf),
    PartFormat("picture", "pictures/{part_no}.svg", lambda part: not part.bought, _picture),
)
