"""The views in which a scene of several sub-assemblies is taken apart, read off its steps' units and its
ready scenes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from string import ascii_uppercase

from tactcad.scenes.scene import Placement, Scene

from .apart import Piece, pieces_of


@dataclass(frozen=True)
class UnitView:
    """A view's letter and title, the scene whose contacts tell how its pieces meet, and the pieces; no pieces
    where the whole scene is drawn as its steps explode it.
    """

    letter: str
    title: str
    scene: Scene
    pieces: tuple[Piece, ...] = ()


def unit_views(scene: Scene) -> list[UnitView]:
    """The whole, with each sub-assembly assembled in it; then each sub-assembly by itself, followed by the
    ready scenes that stand in it.

    None where the scene has fewer than two sub-assemblies.
    """
    units: dict[str, list[str]] = {}
    for step in scene.steps:
        if step.unit and step.designators:
            units.setdefault(step.unit, []).extend(step.designators)
    if len(units) < 2:
        return []
    at = {p.designator: p for p in scene.placements}
    letters = iter(ascii_uppercase)
    whole_letter = next(letters)
    views, blocks = [], []
    for title, names in units.items():
        letter = next(letters)
        inside = [
            (next(letters), ready)
            for ready in scene.ready
            if {p.designator for p in ready.placements} <= set(names)
        ]
        standing = {own: {p.designator for p in ready.placements} for own, ready in inside}
        views.append(UnitView(letter, title, scene, _pieces(scene, [at[d] for d in names], standing)))
        views += [UnitView(own, ready.name, ready) for own, ready in inside]
        blocks.append(Piece(tuple(at[d] for d in names), letter))
    return [UnitView(whole_letter, "the sub-assemblies", scene, tuple(blocks)), *views]


def _pieces(
    scene: Scene, placements: Sequence[Placement], inside: Mapping[str, set[str]]
) -> tuple[Piece, ...]:
    """The parts one by one, the ready scenes (designators by letter) behind them, each as one piece."""
    ready = set().union(*inside.values())
    blocks = [
        Piece(tuple(p for p in placements if p.designator in names), letter)
        for letter, names in inside.items()
    ]
    return (*pieces_of(scene, [p for p in placements if p.designator not in ready]), *blocks)
