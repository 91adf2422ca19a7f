"""The notes on an assembly sheet."""

from __future__ import annotations

from tactcad.design.tree import Design
from tactcad.parts import seating
from tactcad.parts.layout import Layout
from tactcad.scenes.array_steps import COPLANAR
from tactcad.scenes.scene import Scene

from .guide import page_path, torque

LONGEST_ROW = 8  # elements named on the sheet


def notes_of(design: Design, scene: Scene) -> tuple[str, ...]:
    """Numbered notes: order, torques, the pads' coplanarity, what the numbers mean."""
    lines = []
    if scene.steps:
        lines.append(
            f"Assemble in the {len(scene.steps)} steps of the assembly guide, {page_path(scene)} "
            "(tactcad export --guide)"
        )
    lines += _rows(design, scene)
    if torques := _torques(design, scene, "ISO4762-"):
        lines.append(f"Tighten cap screws of property class A2-70, lubricated, to {torques}")
    if torques := _torques(design, scene, "ISO4032-"):
        lines.append(f"Tighten nuts of property class A2-70, lubricated, to {torques}")
    if any(part.part_no.startswith("ISO4026-") for part in scene.parts):
        torques = _torques(design, scene, "ISO4026-")
        how = f"to {torques}" if torques else seating.words(Layout(design))
        lines.append(f"Turn set screws in {how}, locked with thread lacquer")
    for step in scene.steps:
        if step.title == COPLANAR:
            lines.append(f"All pads in one plane within {2 * design.tolerance.pad_height:g} mm. {step.text}")
    lines.append("Item numbers are those of the bill of materials; what has no solid has no balloon")
    lines.append(
        "Dimensions in parentheses are for information; "
        "in the front view x points to the right, y away from the viewer"
    )
    return tuple(lines)


def _rows(design: Design, scene: Scene) -> list[str]:
    """Which element stands where; for long rows only the bill's designators."""
    layout = Layout(design)
    placed = {p.designator for p in scene.placements}
    lines = []
    for row, side in ((1, "+"), (2, "-")):
        own = [p for p in layout.elements if p.row == row and p.designator in placed]
        if 0 < len(own) <= LONGEST_ROW:
            order = ", ".join(f"{p.designator} arm {p.arm:g}" for p in own)
            lines.append(f"Row {row}, its bodies on the side of {side}x, from -y to +y: {order}")
    return lines


def _torques(design: Design, scene: Scene, standard: str) -> str:
    """ "M3 0.55 N·m, M4 1.2 N·m" of the screws of that standard placed."""
    torques = {}
    for part in scene.parts:
        if part.part_no.startswith(standard) and (tight := torque(part, design)):
            torques[part.part_no.split("-")[1].split("x")[0]] = tight
    return ", ".join(
        f"{thread} {value:g} N·m" for thread, value in sorted(torques.items(), key=lambda pair: pair[1])
    )
