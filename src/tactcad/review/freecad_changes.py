"""What changed between two designs as a document of FreeCAD, material by colour."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any

from tactcad.design.tree import Design
from tactcad.export.shapes import Shapes

from .changed_scene import LOOKS, PieceKind, ScenePiece, changed_scenes
from .freecad_file import made_by_freecad, program
from .freecad_record import Row, part_file


def freecad_changes(
    designs: tuple[Design, Design],
    shapes: tuple[Shapes, Shapes],
    changes: Sequence[Row],
    say: Callable[[int, int, str], None],
) -> bytes:
    """The document.

    Parameters
    ----------
    designs
        Before and after; both must keep their rules.
    shapes
        Makers of their solids.
    changes
        Rows of the spreadsheet of changes, the first its heading.
    say
        Receives (done, total, text) as the work goes on.

    Raises
    ------
    CheckFailure
        Where FreeCAD is not installed or ends without a document, or the designs have no scene in common.
    """
    command = program()
    scenes = changed_scenes(designs, shapes, say)
    record, texts = changes_record(designs, scenes, changes)
    return made_by_freecad(command, record, texts, lambda done, what: say(done, len(texts) + 1, what))


def changes_record(
    designs: tuple[Design, Design], scenes: dict[str, list[ScenePiece]], changes: Sequence[Row]
) -> tuple[dict[str, Any], list[bytes]]:
    """The record, and the shapes (BREP) of its parts; equal shapes stand in it once."""
    from tactcad.solids.bytes import to_bytes

    parts: dict[tuple[bytes, PieceKind], dict[str, Any]] = {}
    texts: list[bytes] = []
    placed: dict[str, list[dict[str, Any]]] = {name: [] for name in scenes}
    for name, pieces in scenes.items():
        for piece in pieces:
            key = (to_bytes(piece.shape), piece.kind)
            if key not in parts:
                parts[key] = _part(piece, len(parts))
                texts.append(key[0])
            placed[name].append(_placed(piece, parts[key]["part_no"]))
    a, b = (design.design for design in designs)
    record = {
        "label": f"{a.name} {a.revision} to {b.name} {b.revision}",
        "about": [
            ("before", f"{a.name}, revision {a.revision}"),
            ("after", f"{b.name}, revision {b.revision}"),
            *(
                (f"{name}: {kind}", str(count))
                for name, pieces in scenes.items()
                for kind, count in sorted(Counter(p.kind for p in pieces).items())
            ),
        ],
        "tables": {"Changes": changes},
        "parts": list(parts.values()),
        "scenes": [{"name": name, "placed": rows, "findings": []} for name, rows in placed.items()],
    }
    return record, texts


def _part(piece: ScenePiece, number: int) -> dict[str, Any]:
    colour, transparency = LOOKS[piece.kind]
    remark = f"{piece.kind}, {piece.remark}" if piece.remark else piece.kind
    return {
        "part_no": f"{piece.part_no} {piece.kind} {number}",
        "file": part_file(number),
        "colour": colour,
        "transparency": transparency,
        "properties": [("PartNumber", piece.part_no), ("Material", remark)],
    }


def _placed(piece: ScenePiece, part: str) -> dict[str, Any]:
    return {
        "designator": piece.designator,
        "part_no": part,
        "origin": piece.origin,
        "rotation": piece.rotation,
        "way": (0.0, 0.0, 0.0),
        "under": (piece.kind,),
    }
