"""A scene at another detail level."""

from __future__ import annotations

from dataclasses import replace

from tactcad.parts.envelope import envelope

from .scene import Scene


def at_detail(scene: Scene, detail: str) -> Scene:
    """The scene with every part `full` or as its `envelope`."""
    if detail == "full":
        return scene
    parts = {part.part_no: envelope(part) for part in scene.parts}
    placed = tuple(replace(p, part=parts[p.part.part_no]) for p in scene.placements)
    return replace(scene, placements=placed)
