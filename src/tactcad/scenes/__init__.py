"""Placements: which parts stand where, under which designator, with which meant contacts.

SCENES lists what can be made of a design, by name; a rig's scene exists where the design has its table.
"""

from __future__ import annotations

from tactcad.design.messages import InputError
from tactcad.design.tree import Design

from .array import array
from .scene import Scene

SCENES = {"array": array}


def scene_names(design: Design) -> tuple[str, ...]:
    """Names of the scenes that this design has."""
    return tuple(SCENES)


def scene(design: Design, name: str) -> Scene:
    """The scene of that name; raises InputError where the design has none."""
    if name not in scene_names(design):
        raise InputError("--scene", "no such scene in this design", value=name, legal=", ".join(scene_names(design)))
    return SCENES[name](design)
