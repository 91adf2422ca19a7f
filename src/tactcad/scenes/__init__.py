"""Placements: which parts stand where, under which designator, with which meant contacts.

A scene is a module of this room with a function of its own name. Which scenes a design has is known without
importing any of them, so that an export with nothing to do costs nothing.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from tactcad.design.messages import InputError
from tactcad.design.tree import Design

if TYPE_CHECKING:
    from .scene import Scene

# Scene name -> the design's table that it needs, "" for none.
NEEDS = {"array": ""}


def scene_names(design: Design) -> tuple[str, ...]:
    """Names of the scenes that this design has."""
    return tuple(name for name, table in NEEDS.items() if not table or getattr(design, table) is not None)


def chosen_scenes(design: Design, wanted: list[str] | None) -> tuple[str, ...]:
    """The scenes asked for, each once, in the house's order; all where none is. Raises InputError for an unknown one."""
    names = scene_names(design)
    for name in wanted or ():
        if name not in names:
            raise InputError("--scene", "no such scene in this design", value=name, legal=", ".join(names))
    return tuple(name for name in names if not wanted or name in wanted)


def make_scene(design: Design, name: str) -> Scene:
    """The scene of that name (one of scene_names) of a design that keeps every rule."""
    return getattr(importlib.import_module(f"tactcad.scenes.{name}"), name)(design)
