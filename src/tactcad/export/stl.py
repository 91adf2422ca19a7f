"""A part's mesh as binary STL, read back: closed, and its volume the solid's within what is promised.

80 bytes of heading, the number of triangles, and for each its normal, its corners and two bytes of nothing;
little-endian, single precision (3D Systems' StereoLithography interface specification, 1989).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tactcad.design.messages import CheckFailure
from tactcad.solids.meshing import CHORD_MM, Meshing

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

HEADING = 80
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("nothing", "<u2")])


def part_stl(part_no: str, shape: TopoDS_Shape, meshing: Meshing) -> bytes:
    """The file of a shape.

    Parameters
    ----------
    part_no
        Stands in the heading.
    shape
        In mm.
    meshing
        Turn between facets, and the relative error of the volume that is promised.

    Raises
    ------
    CheckFailure
        Where the file read back is no closed surface, or its volume is further off the solid's.
    """
    from tactcad.account import making
    from tactcad.solids.measure import measure
    from tactcad.solids.triangles import triangles

    with making("mesh", part_no):
        points, faces = triangles(shape, CHORD_MM, meshing.angular)
    data = stl_bytes(part_no, points[faces])
    corners = read_stl(data)
    if open_edges(corners):
        raise CheckFailure(
            f"{part_no}: {open_edges(corners)} edges of its STL file are not shared by two triangles"
        )
    exact, off = measure(shape)["volume"], meshing.error or np.inf
    error = abs(volume_of(corners) / exact - 1.0)
    if not error <= off:
        raise CheckFailure(
            f"{part_no}: its STL file is {error:.2%} off the solid's volume; allowed are {off:.2%}"
        )
    return data


def stl_bytes(name: str, corners: np.ndarray) -> bytes:
    """Triangles (n, 3 corners, 3) in mm as a file."""
    table = np.zeros(len(corners), TRIANGLE)
    along = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(along, axis=1, keepdims=True)
    table["normal"] = np.divide(along, lengths, out=np.zeros_like(along), where=lengths > 0.0)
    table["corners"] = corners
    heading = f"tactcad {name}, mm".encode("ascii", "replace")[:HEADING].ljust(HEADING)
    return heading + np.array(len(corners), "<u4").tobytes() + table.tobytes()


def read_stl(data: bytes) -> np.ndarray:
    """Corners (n, 3, 3), mm, single precision. Raises CheckFailure where the file has another length."""
    count = int(np.frombuffer(data, "<u4", 1, HEADING)[0]) if len(data) >= HEADING + 4 else 0
    if len(data) != HEADING + 4 + count * TRIANGLE.itemsize:
        raise CheckFailure(f"an STL file of {len(data)} bytes cannot hold {count} triangles")
    return np.frombuffer(data, TRIANGLE, count, HEADING + 4)["corners"]


def open_edges(corners: np.ndarray) -> int:
    """Directed edges whose opposite is not there just once."""
    _, at = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    at = at.reshape(-1, 3)
    edges = np.concatenate([at[:, [0, 1]], at[:, [1, 2]], at[:, [2, 0]]])
    own, counts = np.unique(edges, axis=0, return_counts=True)
    opposite = np.unique(edges[:, ::-1], axis=0)
    return int((counts > 1).sum()) + len(np.setdiff1d(_paired(own), _paired(opposite)))


def _paired(edges: np.ndarray) -> np.ndarray:
    """Each edge as one number."""
    return edges[:, 0].astype(np.int64) << 32 | edges[:, 1].astype(np.int64)


def volume_of(corners: np.ndarray) -> float:
    """Enclosed volume, mm3: a sixth of the sum of a . (b x c)."""
    a, b, c = np.moveaxis(corners.astype(float), 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)
