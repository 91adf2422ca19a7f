"""Notes of a part's sheet: the part's own, and those that follow from how it is made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tactcad.design.materials import ELECTROLYSIS, family
from tactcad.parts.description import Part


@dataclass(frozen=True)
class MadeFrom:
    """The file that a shop makes the part from: its path in the export, and its SHA-256."""

    path: str
    sha256: str


def notes_of(part: Part, files: Sequence[MadeFrom]) -> tuple[str, ...]:
    """Numbered notes of the part's sheet, which names the files that the part is made from."""
    keys = [f"K{n} {c.name}" for n, c in enumerate((c for c in part.characteristics if c.key), start=1)]
    lines = [_capital(note) for note in part.notes]
    if keys:
        lines.append(f"Key characteristics, framed, to be recorded on every piece: {', '.join(keys)}")
    lines += _wire_cut(part) if part.process == "wire-cut" else []
    return (
        *lines,
        *(f"{_use(part, file)} {file.path.rsplit('/', 1)[-1]}, SHA-256 {file.sha256}" for file in files),
    )


def _use(part: Part, file: MadeFrom) -> str:
    if not file.path.endswith(".dxf"):
        return "Model"
    return "Cut from" if part.process == "wire-cut" else "Blank and plain through holes, cut from"


def _wire_cut(part: Part) -> list[str]:
    lines = [
        "The DXF file holds the nominal contour, limits at their middle; wire compensation at the machine"
    ]
    if part.extrusion.openings:
        lines.append("Holes wire-cut before the outline, each from a start hole inside it; slugs removed")
    if harm := ELECTROLYSIS.get(family(part.material.density)):
        lines.append(f"Anti-electrolysis supply: without it {part.material.name} {harm}")
    return lines


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
