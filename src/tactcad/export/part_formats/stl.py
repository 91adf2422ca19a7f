"""A part's mesh as binary STL, read back: closed, and of the solid's volume within the promised error."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING, Any

from tactcad.design.messages import CheckFailure
from tactcad.parts.language.description import Part
from tactcad.solids import CHORD_MM, Meshing

from ..formats import PartFormat
from ..shapes import Shapes
from ..step_text import Header

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

HEADING = 80  # bytes, which readers skip (3D Systems' StereoLithography interface specification, 1989)


def part_stl(part_no: str, shape: TopoDS_Shape, meshing: Meshing) -> bytes:
    """The file of a shape.

    Parameters
    ----------
    part_no
        Stands in the heading.
    shape
        In mm.
    meshing
        Turn between facets, and the promised relative error of the volume.

    Raises
    ------
    CheckFailure
        If the file read back is no closed surface, or its volume is further off the solid's.
    """
    import trimesh
    from trimesh.exchange.stl import export_stl

    from tactcad.profiling import making
    from tactcad.solids.measure import measure
    from tactcad.solids.triangles import triangles

    with making("mesh", part_no):
        points, faces = triangles(shape, CHORD_MM, meshing.angular)
        data = export_stl(trimesh.Trimesh(points, faces, process=False))
    heading = f"tactcad {part_no}, mm".encode("ascii", "replace")[:HEADING].ljust(HEADING)
    check_stl(part_no, heading + data[HEADING:], measure(shape)["volume"], meshing.error)
    return heading + data[HEADING:]


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


def _made(part: Part, shapes: Shapes, head: Header, meshing: Any) -> bytes:
    return part_stl(part.part_no, shapes.of(part), meshing)


STL = PartFormat(
    kind="stl",
    path="stl/{part_no}_{revision}.stl",
    place=5,
    has=lambda part: not part.bought,
    asked=lambda options: options.meshing,
    make=_made,
    released="",
    ordered=0,
)
