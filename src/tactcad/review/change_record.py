"""A change page's content as plain data: every scene in pieces, and the causes with their consequences."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from typing import TYPE_CHECKING, Any

from tactcad import __version__
from tactcad.design.tree import CommonTables
from tactcad.export.difference import Change
from tactcad.export.shapes import Shapes
from tactcad.export.sides import Side, not_compared

from .changed_scene import LOOKS, ScenePiece, changed_scenes
from .consequences import Meaning
from .effect import SensorEffect
from .review_record import mesh_bytes, pack
from .summary import cause_lines, effect_lines

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

SCHEMA = "tactcad-change-1"
# Steps of the depth buffer, so that what came is seen where what went was. Chosen: with 8 the colours of a
# thicker carrier and of the plates below it still mix, with 100 they do not.
BEHIND = 100


def change_record(
    sides: tuple[Side, Side],
    designs: tuple[CommonTables, CommonTables],
    shapes: tuple[Shapes, Shapes],
    differences: Sequence[Change],
    meaning: Meaning,
    say: Callable[[int, int, str], None],
) -> tuple[dict[str, Any], bytes]:
    """The record and its block of arrays for `review_page`, equal for equal input.

    Parameters
    ----------
    sides, designs, shapes
        Each of before and after; both designs must keep their rules. The shapes' makers must be two.
    differences, meaning
        Between the sides.
    say
        Receives (done, total, text) as the work goes on.

    Raises
    ------
    CheckFailure
        If the designs have no scene in common.
    """
    scenes = {
        # what came and went first
        name: _named(sorted(pieces, key=lambda p: list(LOOKS).index(p.kind)))
        for name, pieces in changed_scenes(designs, shapes, say).items()
    }
    solids = _Solids(shapes[1])
    parts: dict[tuple[str, str, str], dict[str, Any]] = {}
    placed: dict[str, list[dict[str, Any]]] = {name: [] for name in scenes}
    for n, (name, pieces) in enumerate(scenes.items()):
        say(n, len(scenes), f"{name}: meshes")
        for label, piece in pieces.items():
            key = (solids.mesh_of(piece.shape), piece.kind, piece.part_no)
            if key not in parts:
                parts[key] = _part(piece, len(parts), solids.volumes[key[0]])
            placed[name].append(piece.row(label, parts[key]["part_no"]))
    packed = pack(solids.meshes.items())
    for (mesh, _, _), part in parts.items():
        part |= {"mesh": packed.table[mesh], "box": packed.boxes[mesh]}
    record = {
        "schema": SCHEMA,
        "tactcad": __version__,
        "design": _identity(designs),
        "parts": list(parts.values()),
        "scenes": [_scene(name, rows, scenes[name]) for name, rows in placed.items()],
        "strains": {},
        "findings": [],
        "changes": _changes(sides, scenes, differences, meaning),
    }
    say(len(scenes), len(scenes), "done")
    return record, packed.block


@dataclass
class _Solids:
    """Meshes and volumes (mm3) of shapes, each shape's once; named by its content."""

    shapes: Shapes
    meshes: dict[str, bytes] = field(default_factory=dict)
    volumes: dict[str, float] = field(default_factory=dict)
    known: dict[int, tuple[str, TopoDS_Shape]] = field(default_factory=dict)  # by id, which the shape keeps

    def mesh_of(self, shape: TopoDS_Shape) -> str:
        """The name of the shape's mesh."""
        from tactcad.solids.measure import volume
        from tactcad.solids.step import to_bytes

        if id(shape) not in self.known:
            name = sha256(to_bytes(shape)).hexdigest()
            self.known[id(shape)] = name, shape
            if name not in self.meshes:
                content = f"{self.shapes.made_by} {name}"
                self.meshes[name] = mesh_bytes(content, lambda: shape, self.shapes.cache)
                self.volumes[name] = volume(shape)
        return self.known[id(shape)][0]


def _named(pieces: Sequence[ScenePiece]) -> dict[str, ScenePiece]:
    """Pieces by designator and kind, numbered if a removed element left its designator to another one."""
    named: dict[str, ScenePiece] = {}
    for piece in pieces:
        label = alone = f"{piece.designator} {piece.kind}"
        n = 2
        while label in named:
            label, n = f"{alone} {n}", n + 1
        named[label] = piece
    return named


def _part(piece: ScenePiece, number: int, volume: float) -> dict[str, Any]:
    """A piece in the form of a part for view and tree, with its panel's text."""
    colour, transparency = LOOKS[piece.kind]
    return {
        "part_no": f"{piece.part_no} {piece.kind} {number}",
        "name": piece.part_no,
        "colour": colour,
        "alpha": 1.0 - transparency / 100.0,
        "behind": BEHIND * list(LOOKS).index(piece.kind),
        "kind": piece.kind,
        "volume_mm3": volume,
        "remark": piece.remark,
    }


def _scene(name: str, placed: Sequence[dict[str, Any]], pieces: Mapping[str, ScenePiece]) -> dict[str, Any]:
    """A scene without motions or steps; what its button takes away is what stayed the same."""
    same = [label for label, piece in pieces.items() if piece.kind == "same"]
    nothing: dict[str, Any] = {"steps": (), "motions": (), "poses": (), "bill": ()}
    return {"name": name, "placed": placed, "cover": same, **nothing}


def _identity(designs: tuple[CommonTables, CommonTables]) -> dict[str, str]:
    before, after = (design.design for design in designs)

    def both(a: str, b: str) -> str:
        return a if a == b else f"{a} to {b}"

    return {
        "name": both(before.name, after.name),
        "title": f"What changed: {after.title}",
        "revision": both(before.revision, after.revision),
        "date": after.date,
        "author": after.author or "",
        "organisation": after.organisation or "",
    }


def _changes(
    sides: tuple[Side, Side],
    scenes: Mapping[str, Mapping[str, ScenePiece]],
    differences: Sequence[Change],
    meaning: Meaning,
) -> dict[str, Any]:
    """The causes, largest consequence first, each with the pieces of the parts it names in every scene."""
    causes: list[dict[str, Any]] = [
        {"what": c.what, "lines": cause_lines(c), "pieces": _all_about(scenes, c.effect)}
        for c in meaning.consequences
    ]
    notes = [*not_compared(*sides), *meaning.untold]
    if any(side.own_code for side in sides):
        notes.append("material by a revision's own code: both designs are built by the present one")
    return {
        "sides": [
            {"source": side.source, "design": side.design, "revision": side.revision} for side in sides
        ],
        "causes": causes,
        "together": list(effect_lines(meaning.together)) if meaning.together else [],
        "others": {
            name: [
                label
                for label, piece in pieces.items()
                if piece.kind != "same" and not any(label in cause["pieces"][name] for cause in causes)
            ]
            for name, pieces in scenes.items()
        },
        "counts": {name: Counter(p.kind for p in pieces.values()) for name, pieces in scenes.items()},
        "interactions": meaning.interactions,
        "remarks": _remarks(scenes),
        "not_compared": notes,
        "differences": [str(change) for change in differences],
    }


def _remarks(scenes: Mapping[str, Mapping[str, ScenePiece]]) -> list[str]:
    """Designators for each remark."""
    about: dict[str, dict[str, None]] = {}
    for piece in (p for pieces in scenes.values() for p in pieces.values() if p.remark):
        about.setdefault(piece.remark, {})[piece.designator] = None
    return [f"{' '.join(designators)}: {remark}" for remark, designators in about.items()]


def _all_about(scenes: Mapping[str, Mapping[str, ScenePiece]], effect: SensorEffect) -> dict[str, list[str]]:
    return {
        name: [label for label, piece in pieces.items() if piece.kind != "same" and _about(piece, effect)]
        for name, pieces in scenes.items()
    }


def _about(piece: ScenePiece, effect: SensorEffect) -> bool:
    """Whether the piece is of a part or an element that the effect names."""
    parts = {*effect.parts_added, *effect.parts_removed, *effect.parts_revised, *effect.bill}
    elements = {*(e.new for e in effect.elements), *effect.elements_added}
    if piece.kind == "removed":
        elements |= set(effect.elements_removed)
    return piece.part_no in parts or piece.designator in elements
