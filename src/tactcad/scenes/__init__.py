"""Which parts stand where, under which designator, with which intended contacts, and in which order they are
put together.

In: a design, and a pose. Out: a scene, which is a list of placements and no geometry; a scene is a module of
this room with a function of its own name. Finding out which scenes a design has must be cheap, so it imports
none of them.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from tactcad.account import making
from tactcad.design.messages import InputError, one_of
from tactcad.design.tree import Design
from tactcad.parts.finding import Finding
from tactcad.parts.layout import Layout
from tactcad.parts.rules import scene_rules
from tactcad.parts.rules.rule import Rule

if TYPE_CHECKING:
    from .scene import Pose, Scene

# Scene name -> the design's tables that it needs.
NEEDS: dict[str, tuple[str, ...]] = {
    "array": (),
    "calibration": ("calibration",),
    "sample-stiffness": ("calibration", "sample", "cart", "holder"),
    "grasping": ("grasping", "sample", "cart", "holder"),
    "bonding": ("bonding",),
}


def scene_names(design: Design) -> tuple[str, ...]:
    """Names of the scenes that this design has: the tables are there, and the rig takes the array."""
    return tuple(name for name in _with_tables(design) if _misfit(design, name) is None)


def left_out(design: Design) -> list[str]:
    """Why scenes whose tables the design has are not among its scenes, one line for each."""
    lines = []
    for name in _with_tables(design):
        why = _misfit(design, name)
        if why:
            lines.append(
                f"scene {name} left out: rule {why.check}: {why.message} ({why.part} = {why.value}; "
                f"legal: {why.limit})"
            )
    return lines


def fitting_rules(scene: str) -> dict[str, Rule]:
    """Rules that an array must keep to have that scene, by name; those that need placements are defined in
    this room.
    """
    rules = scene_rules(scene)
    if scene == "grasping":
        from .moving_axis import ballast_trims_moving_weight as trimmed

        rules[trimmed.name] = trimmed
    return rules


def _misfit(design: Design, scene: str) -> Finding | None:
    """Why the scene's rig cannot take this array; None where it can."""
    layout = Layout(design)
    return next((finding for rule in fitting_rules(scene).values() for finding in rule(layout)), None)


def _with_tables(design: Design) -> list[str]:
    return [name for name, tables in NEEDS.items() if all(getattr(design, t) is not None for t in tables)]


def chosen_scenes(design: Design, wanted: list[str] | None) -> tuple[str, ...]:
    """The scenes asked for, each once, in the order of `NEEDS`; all scenes of the design where none is asked
    for.

    Raises InputError for a scene that the design does not have.
    """
    names = scene_names(design)
    for name in wanted or ():
        if name not in names:
            why = [line for line in left_out(design) if line.startswith(f"scene {name} ")]
            raise InputError(
                "--scene",
                why[0] if why else "no such scene in this design",
                value=name,
                legal=one_of(name, names),
            )
    return tuple(name for name in names if not wanted or name in wanted)


def make_scene(design: Design, name: str, pose: Pose | None = None) -> Scene:
    """One scene of a design.

    Parameters
    ----------
    design
        Must keep every rule, as `tactcad.parts.designs.load` ensures.
    name
        One of `scene_names(design)`.
    pose
        By default the rest pose; the scene `array` has no other.

    Raises
    ------
    InputError
        Where the pose is impossible.
    """
    own = name.replace("-", "_")
    make = getattr(importlib.import_module(f"tactcad.scenes.{own}"), own)
    with making("scene", name):
        return make(design) if pose is None or name == "array" else make(design, pose)
