"""The files of parts: STEP without and with limits, DXF and a picture in every export; binary STL if asked
for, read back: closed, and of the solid's volume within the promised error."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING, Any

from tactcad.design.messages import CheckFailure
from tactcad.parts.language.description import Part
from tactcad.parts.language.stock import cut_section
from tactcad.scenes.scene import Placement
from tactcad.solids import CHORD_MM, Meshing

from ..formats import PartFormat, always, has_limits
from ..shapes import Shapes, picture_bytes
from ..step_text import Header

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

SOLIDS = (
    "every part as a solid, and every assembly (AP214, millimetres); NAME-ap242.step: the same "
    "part with its limits and datums on its faces, for machines to read (AP242)"
)


def _step(part: Part, shapes: Shapes, head: Header, _: object) -> bytes:
    from ..step_file import part_step

    return part_step(part, shapes.of(part), head)


def _step_pmi(part: Part, shapes: Shapes, head: Header, _: object) -> bytes:
    from ..step_pmi import part_step_pmi

    return part_step_pmi(part, shapes.text_of(part), head)


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

HEADING = 80  # bytes, which readers skip (3D Systems' StereoLithography interface specification, 1989)


def part_stl(part_no: str, shape: TopoDS_Shape, meshing: Meshing, mm: float = 1.0) -> bytes:
    """The file of a shape, in mm or in metres.

    Parameters
    ----------
    part_no
        Stands in the heading.
    shape
        In mm.
    meshing
        Turn between facets, and the promised relative error of the volume.
    mm
        One millimetre in the file's unit: 1, or 1e-3.

    Raises
    ------
    CheckFailure
        If the file read back is no closed surface, or its volume is further off the solid's.
    """
    import trimesh
    from trimesh.exchange.stl import export_stl

    from tactcad.profiling import making
    from tactcad.solids.measure import volume
    from tactcad.solids.triangles import triangles

    with making("mesh", part_no):
        points, faces = triangles(shape, CHORD_MM, meshing.angular)
        data = export_stl(trimesh.Trimesh(points * mm, faces, process=False))
    unit = "mm" if mm == 1.0 else "m"
    data = f"tactcad {part_no}, {unit}".encode("ascii", "replace")[:HEADING].ljust(HEADING) + data[HEADING:]
    check_stl(part_no, data, volume(shape) * mm**3, meshing.error)
    return data


def check_stl(part_no: str, data: bytes, volume: float, allowed: float | None) -> None:
    """Raises CheckFailure if a file is no closed surface, or its volume differs from that one (mm3) by more
    than allowed (relative; None: any)."""
    import trimesh

    mesh = trimesh.load_mesh(BytesIO(data), file_type="stl")
    if not mesh.is_volume:
        raise CheckFailure(f"{part_no}: the triangles of its STL file do not close, or lie inside out")
    error = abs(mesh.volume / volume - 1.0)
    if allowed is not None and error > allowed:
        raise CheckFailure(
            f"{part_no}: its STL file is {error:.2%} off the solid's volume; allowed are {allowed:.2%}"
        )


def _stl(part: Part, shapes: Shapes, head: Header, meshing: Any) -> bytes:
    return part_stl(part.part_no, shapes.of(part), meshing)


STL = PartFormat(
    kind="stl",
    path="stl/{part_no}_{revision}.stl",
    place=5,
    has=lambda part: not part.bought,
    asked=lambda options: options.meshing,
    make=_stl,
    released="",
    ordered=0,
)
