"""Meshes of a page: every shape tessellated once, all in one block with a table of what lies where."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from tactcad.export.cache import Cache
from tactcad.export.inputs import digest
from tactcad.export.shapes import Shapes
from tactcad.parts.language.description import Part

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

# Chord error in mm, and turn between facets in radians. Chosen: a full round of 0.3 mm is drawn by 11 facets,
# and all parts of the published array with its rigs take 0.7 MB; chords of half that cost half as much again.
LINEAR, ANGULAR = 0.01, 0.3
# The viewer's names of its arrays, with the kind of number.
ARRAYS = {
    "vertices": "<f4",
    "normals": "<f4",
    "triangles": "<u4",
    "triangles_per_face": "<u4",
    "edges": "<f4",
    "segments_per_edge": "<u4",
    "obj_vertices": "<f4",
    "face_types": "<u4",
    "edge_types": "<u4",
}


@dataclass(frozen=True)
class MeshPack:
    """The block, and by name (of a part its number) where each array starts (bytes) and how many numbers it
    has; `boxes` are each one's least and largest corner, mm."""

    block: bytes
    table: dict[str, dict[str, tuple[int, int]]]
    boxes: dict[str, tuple[tuple[float, ...], tuple[float, ...]]]


def mesh_pack(
    parts: Iterable[Part], shapes: Shapes, say: Callable[[str], None] = lambda text: None
) -> MeshPack:
    """Tessellate the parts, or take their meshes from the cache; `say` gets each part's number before."""

    def meshes() -> Iterator[tuple[str, bytes]]:
        for part in parts:
            say(part.part_no)
            content = f"{shapes.made_by} {digest(part)}"
            yield part.part_no, mesh_bytes(content, lambda: shapes.of(part), shapes.cache)

    return pack(meshes())


def mesh_bytes(content: str, shape: Callable[[], TopoDS_Shape], cache: Cache) -> bytes:
    """A mesh: a line of JSON with the arrays' lengths, then the arrays; from the cache if it holds one of
    that content."""

    def make() -> bytes:
        from tactcad.solids.triangles import facets

        f = facets(shape(), LINEAR, ANGULAR)
        found = (
            f.vertices,
            f.normals,
            f.triangles,
            f.per_face,
            f.edges,
            f.per_edge,
            f.corners,
            f.face_kinds,
            f.edge_kinds,
        )
        arrays = {
            name: np.ascontiguousarray(a, kind) for (name, kind), a in zip(ARRAYS.items(), found, strict=True)
        }
        head = json.dumps({name: int(a.size) for name, a in arrays.items()})
        return head.encode() + b"\n" + b"".join(a.tobytes() for a in arrays.values())

    return cache.get_or_make(f"facets {LINEAR} {ANGULAR} {content}", make)


def pack(meshes: Iterable[tuple[str, bytes]]) -> MeshPack:
    """Meshes, each with its name, in one block."""
    block, boxes = b"", {}
    table: dict[str, dict[str, tuple[int, int]]] = {}
    for mesh, data in meshes:
        head, _, arrays = data.partition(b"\n")
        counts: dict[str, int] = json.loads(head)
        table[mesh] = {}
        start = len(block)
        for name, count in counts.items():
            table[mesh][name] = (start, count)
            start += 4 * count
        points = np.frombuffer(arrays, "<f4", counts["vertices"]).reshape(-1, 3)
        low, high = points.min(axis=0), points.max(axis=0)
        boxes[mesh] = (tuple(map(float, low)), tuple(map(float, high)))
        block += arrays
    return MeshPack(block, table, boxes)
