"""Scenes: the places of parts, their designators, intended contacts, and order of assembly.

In: a design, and a pose. Out: a scene, which is a list of placements and no geometry. Which scenes there are,
and what hangs on each, their declarations say (`rig`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tactcad.design.family import family_of
from tactcad.design.messages import InputError, one_of
from tactcad.design.tree import CommonTables
from tactcad.parts.language.description import NOT_MADE, Vector
from tactcad.parts.language.finding import Finding
from tactcad.parts.rules.rule import misfit
from tactcad.profiling import making

from .rig import ARRAY, Rig, all_rigs, rig_of

if TYPE_CHECKING:
    from .scene import Pose, Scene


@dataclass(frozen=True)
class LeftOut:
    """A scene whose tables the design has, but whose rig cannot take the array, and why."""

    scene: str
    why: Finding

    @property
    def reason(self) -> str:
        why = self.why
        return f"rule {why.check}: {why.message} ({why.part} = {why.value}; legal: {why.limit})"

    def __str__(self) -> str:
        return f"scene {self.scene} left out: {self.reason}"


def scene_names(design: CommonTables) -> tuple[str, ...]:
    """Names of the scenes that this design has: the tables are there, and the rig takes the array."""
    layout = family_of(design).layout(design)
    return tuple(rig.name for rig in _with_tables(design) if misfit(layout, rig.rules) is None)


def left_out(design: CommonTables) -> list[LeftOut]:
    """Scenes whose tables the design has and that are not among its scenes."""
    layout = family_of(design).layout(design)
    found = ((rig.name, misfit(layout, rig.rules)) for rig in _with_tables(design))
    return [LeftOut(name, why) for name, why in found if why is not None]


def _with_tables(design: CommonTables) -> list[Rig]:
    return [
        rig
        for rig in all_rigs(type(design)).values()
        if all(getattr(design, t) is not None for t in rig.tables)
    ]


def chosen_scenes(design: CommonTables, wanted: list[str] | None) -> tuple[str, ...]:
    """The scenes asked for, each once, in the order of `all_rigs`; all of the design if none is asked for.

    Raises InputError for a scene that the design does not have.
    """
    names = scene_names(design)
    for name in wanted or ():
        if name not in names:
            why = next((str(left) for left in left_out(design) if left.scene == name), None)
            raise InputError(
                "--scene", why or "no such scene in this design", value=name, legal=one_of(name, names)
            )
    return tuple(name for name in names if not wanted or name in wanted)


def refuse_unknown_parts(design: CommonTables) -> None:
    """Raise InputError if [design.unchanged] names what is no part made for any scene, nor the boards."""
    if not (unchanged := design.design.unchanged):
        return
    scenes = (make_scene(design, name) for name in scene_names(design))
    made = {part.part_no for scene in scenes for part in scene.parts if part.process not in NOT_MADE}
    made |= {design.design.board_no} if family_of(design).boards else set()
    known = sorted(number.removeprefix(f"{design.name}-") for number in made)
    for letter, issue in unchanged.items():
        for name in issue.parts:
            if name not in known:
                where, what = f"design.unchanged.{letter}.parts", "no part that is made"
                raise InputError(where, what, value=name, legal=one_of(name, known))


def make_scene(design: CommonTables, name: str, pose: Pose | None = None) -> Scene:
    """One scene of a design.

    Parameters
    ----------
    design
        Must keep every rule, as `tactcad.parts.rules.load` ensures.
    name
        One of `scene_names(design)`.
    pose
        By default the rest pose; the scene `array` has no other.

    Raises
    ------
    InputError
        If the pose is impossible.
    """
    from .scene import REST, with_added

    with making("scene", name):
        scene = rig_of(design, name).make(design, pose or REST)
        return with_added(scene, (added for added in design.added if added.scene == name))


def overall_size(design: CommonTables) -> Vector:
    """Length, width and height (mm) of the array as built: the box around all parts of its scene `array`."""
    return make_scene(design, ARRAY).size


def stated_size(size: Vector) -> str:
    """The size in reports: "63.0 x 38.2 x 21.6 mm"."""
    return " x ".join(f"{side:.1f}" for side in size) + " mm"
