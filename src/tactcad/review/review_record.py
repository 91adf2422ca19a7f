"""Everything that a page shows, as plain data, with the block of arrays that it points into."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from tactcad import __version__
from tactcad.design.family import family_of
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import CommonTables
from tactcad.export.cache import Cache
from tactcad.export.inputs import digest
from tactcad.export.shapes import Shapes
from tactcad.parts.language.description import Part
from tactcad.scenes import make_scene, overall_size, stated_size
from tactcad.scenes.requirement import DimensionLimits
from tactcad.scenes.scene import Scene
from tactcad.stacks.stack import StackLine

from .facts import Facts, element_facts, finding_facts, part_facts, scene_facts

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape
from numpy.typing import NDArray

from tactcad.fem.elements import PlaneSolution, solve_plane
from tactcad.fem.shape import cut_element
from tactcad.fem.space import lagrange
from tactcad.parts.array.element import element
from tactcad.parts.array.hinge_section import design_alloy
from tactcad.parts.array.layout import ElementPlace, Layout

DENSITY = 4  # of the mesh; chosen: facets of a hundredth of a millimetre at the fillets, 3000 of them


@dataclass(frozen=True)
class StrainField:
    """Per newton on the pad, in plane stress.

    points    (n, 2) places x and z in the element's frame, mm
    moved     (n, 2) displacements there, mm/N
    strain    (n,) strain along x, 1/N; positive in tension
    quads     (q, 4) corners of the picture's facets
    """

    points: NDArray[np.float32]
    moved: NDArray[np.float32]
    strain: NDArray[np.float32]
    quads: NDArray[np.uint32]


def strain_field(layout: Layout, place: ElementPlace) -> StrainField:
    """The field of one element, clamped at its clamp edge, pressed away from the object at its load line.

    Raises
    ------
    CheckFailure
        If the mesh cannot follow its contour.
    """
    contour = element(layout, place).extrusion.outer
    shape = cut_element(contour, layout.clamp_edge, place.hinge_x - place.load_arm)
    alloy = design_alloy(layout.design)
    solution = solve_plane(
        shape, alloy.youngs_modulus, alloy.poisson, layout.design.sheet.thickness, density=DENSITY, whole=True
    )
    u = np.asarray(solution.displacement).reshape(2, -1)
    # Each element's order x order facets by their corners, round about.
    e = solution.space.elements
    corners = e[:, :-1, :-1], e[:, 1:, :-1], e[:, 1:, 1:], e[:, :-1, 1:]
    return StrainField(
        solution.space.nodes.T.astype(np.float32),
        u.T.astype(np.float32),
        strain_along(solution).astype(np.float32),
        np.stack(corners, axis=-1).reshape(-1, 4).astype(np.uint32),
    )


def strain_along(solution: PlaneSolution) -> NDArray[np.float64]:
    """du_x/dx at every node (1/N), the mean of the elements that share it."""
    space, order = solution.space, solution.space.order
    value, slope = lagrange(order, tuple(np.linspace(-1.0, 1.0, order + 1).tolist()))
    e = space.elements
    u = np.asarray(solution.displacement).reshape(2, -1)[0]

    def slopes(f: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives by both local coordinates at each element's nodes."""
        return (
            np.einsum("eab,ap,bq->epq", f[e], slope, value),
            np.einsum("eab,ap,bq->epq", f[e], value, slope),
        )

    (x1, x2), (z1, z2), (u1, u2) = slopes(space.nodes[0]), slopes(space.nodes[1]), slopes(u)
    strain = (u1 * z2 - u2 * z1) / (x1 * z2 - x2 * z1)
    total, count = np.zeros(len(u)), np.zeros(len(u))
    np.add.at(total, e, strain)
    np.add.at(count, e, 1.0)
    return total / count


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


SCHEMA = "tactcad-review-1"
IDENTITY = ("name", "title", "revision", "date", "author", "organisation")


def review_record(
    design: CommonTables,
    scene_names: Sequence[str],
    shapes: Shapes,
    say: Callable[[int, int, str], None],
    sheets: Mapping[str, str],
) -> tuple[dict[str, Any], bytes]:
    """The record and the block, equal for equal input.

    Parameters
    ----------
    design
        Must keep its rules.
    scene_names
        The scenes to show, the first one first.
    shapes
        Makes solids, or takes them from its cache.
    say
        Receives (done, total, text) as the work goes on.
    sheets
        Drawing sheets (SVG) by part number.
    """
    scenes = tuple(make_scene(design, name) for name in scene_names)
    parts = list({part.part_no: part for scene in scenes for part in scene.parts}.values())
    total = len(parts) + 2
    say(0, total, "estimates and virtual builds")
    elements, made, lines = element_facts(design, scenes)
    done = iter(range(1, total))
    pack = mesh_pack(parts, shapes, lambda part_no: say(next(done), total, part_no))
    say(total - 1, total, "checks")
    findings = finding_facts(design, scenes, shapes, lambda *_: None)
    strains, block = _strains(design, pack)
    record = record_of(design, scenes, parts, pack, elements, strains, (made.variables, lines))
    record["design"]["size"] = stated_size(overall_size(design))
    record |= {"findings": [asdict(f) for f in findings], "sheets": dict(sheets)}
    say(total, total, "done")
    return record, block


def record_of(
    design: CommonTables,
    scenes: Sequence[Scene],
    parts: Sequence[Part],
    pack: MeshPack,
    array: Facts,
    strains: dict[str, Any],
    stack: tuple[dict[str, DimensionLimits], Sequence[StackLine]],
) -> dict[str, Any]:
    """The record without findings and sheets; `stack`: the sensor's variables and its lines."""
    return {
        "schema": SCHEMA,
        "tactcad": __version__,
        "design": {name: getattr(design.design, name) or "" for name in IDENTITY},
        "parts": [
            part_facts(part, *stack) | {"mesh": pack.table[part.part_no], "box": pack.boxes[part.part_no]}
            for part in parts
        ],
        "scenes": [scene_facts(design, scene) for scene in scenes],
        "array": array,
        "strains": strains,
        "findings": [],
        "sheets": {},
    }


def _strains(design: CommonTables, pack: MeshPack) -> tuple[dict[str, Any], bytes]:
    """The strain field's arrays by element part number, appended to the block."""
    family, block = family_of(design), pack.block
    layout, strain_field = family.layout(design), family.estimate.strain
    table: dict[str, Any] = {}
    if strain_field is None:
        return table, block
    for place, number, _ in family.parts(layout):
        if number in table:
            continue
        try:
            field = strain_field(layout, place)
        except CheckFailure as error:
            table[number] = {"why_not": str(error)}
            continue
        table[number] = {"load_arm": place.load_arm, "hinge_x": place.hinge_x, "hinge": place.hinge.t}
        for name, kind in (("points", "<f4"), ("moved", "<f4"), ("strain", "<f4"), ("quads", "<u4")):
            array = np.ascontiguousarray(getattr(field, name), kind)
            table[number][name] = (len(block), int(array.size))
            block += array.tobytes()
    return table, block
