"""The files that parts have in every export: STEP without and with limits, DXF, a picture."""

from __future__ import annotations

from tactcad.parts.language.description import Part
from tactcad.parts.language.stock import cut_section
from tactcad.scenes.scene import Placement

from ..formats import PartFormat, always, has_limits
from ..shapes import Shapes, picture_bytes
from ..step_text import Header

SOLIDS = (
    "every part as a solid, and every assembly (AP214, millimetres); NAME-ap242.step: the same "
    "part with its limits and datums on its faces, for machines to read (AP242)"
)


def _step(part: Part, shapes: Shapes, head: Header, _: object) -> bytes:
    from ..step_file import part_step

    return part_step(part, shapes.of(part), head)


def _step_pmi(part: Part, shapes: Shapes, head: Header, _: object) -> bytes:
    from tactcad.solids.step import to_bytes

    from .. import step_pmi

    return step_pmi.part_step_pmi(part, to_bytes(shapes.of(part)), head)


def _dxf(part: Part, shapes: Shapes, head: Header, _: object) -> bytes:
    from ..dxf import checked_dxf

    return checked_dxf(part)


def _picture(part: Part, shapes: Shapes, head: Header, _: object) -> bytes:
    alone = (Placement(part.part_no, part),)
    return picture_bytes(alone, "oblique", shapes, part.name, f"{part.part_no} revision {head.revision}")


STEP = PartFormat(
    kind="step-part",
    path="step/{part_no}_{revision}.step",
    place=1,
    has=lambda part: True,
    asked=always,
    make=_step,
    released=SOLIDS,
    ordered=1,
)
STEP_PMI = PartFormat(
    kind="step-pmi",
    path="step/{part_no}_{revision}-ap242.step",
    place=2,
    has=has_limits,
    asked=always,
    make=_step_pmi,
    released=SOLIDS,
    ordered=0,
)
DXF = PartFormat(
    kind="dxf",
    path="dxf/{part_no}_{revision}.dxf",
    place=3,
    has=lambda part: cut_section(part) is not None,
    asked=always,
    make=_dxf,
    released="cut files, exact nominal contours, millimetres, one part a file: the wire-cut parts whole, of "
    "milled and ground plates the blank, larger on every edge and without holes. Compensation for wire "
    "and spark gap is "
    "yours.",
    ordered=2,  # a shop cuts by it, and makes the rest by the STEP file
)
PICTURE = PartFormat(
    kind="picture",
    path="pictures/{part_no}.svg",
    place=4,
    has=lambda part: not part.bought,
    asked=always,
    make=_picture,
    released="",
    ordered=0,
)
