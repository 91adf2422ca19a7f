"""A part's mesh as 3MF, read back: closed, and its volume the solid's within a hundredth."""

from __future__ import annotations

import zipfile
from io import BytesIO
from xml.etree import ElementTree

from tactcad.design.messages import CheckFailure
from tactcad.parts.language.description import Part

from ..formats import PartFormat, always
from ..shapes import Shapes
from ..step_text import Header

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
ALLOWED = 0.01  # of the volume


def part_3mf(part: Part, shapes: Shapes, head: Header, _: object) -> bytes:
    """The file. Raises CheckFailure where its volume is further off the solid's."""
    from tactcad.solids.measure import measure
    from tactcad.solids.triangles import triangles

    points, faces = triangles(shapes.of(part), 0.05, 0.2)
    vertices = "".join(f'<vertex x="{x:.9g}" y="{y:.9g}" z="{z:.9g}"/>' for x, y, z in points)
    corners = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in faces)
    model = (
        f'<model unit="millimeter" xmlns="{CORE}"><resources><object id="1" type="model"><mesh>'
        f"<vertices>{vertices}</vertices><triangles>{corners}</triangles></mesh></object></resources>"
        '<build><item objectid="1"/></build></model>'
    )
    out = BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        archive.writestr(zipfile.ZipInfo("3D/3dmodel.model", (1980, 1, 1, 0, 0, 0)), model)
    error = abs(volume(out.getvalue()) / measure(shapes.of(part))["volume"] - 1.0)
    if error > ALLOWED:
        raise CheckFailure(f"{part.part_no}: its 3MF file is {error:.2%} off the solid's volume")
    return out.getvalue()


def volume(data: bytes) -> float:
    """Of the mesh in a file, mm3."""
    with zipfile.ZipFile(BytesIO(data)) as archive:
        tree = ElementTree.fromstring(archive.read("3D/3dmodel.model"))
    at = [[float(v.attrib[k]) for k in "xyz"] for v in tree.iter(f"{{{CORE}}}vertex")]
    total = 0.0
    for t in tree.iter(f"{{{CORE}}}triangle"):
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (at[int(t.attrib[f"v{n}"])] for n in (1, 2, 3))
        total += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    return total / 6.0


FORM = PartFormat(
    kind="3mf",
    path="3mf/{part_no}_{revision}.3mf",
    place=6,
    has=lambda part: not part.bought,
    asked=always,
    make=part_3mf,
    released="every part made as a mesh, for printers",
    ordered=3,
)
