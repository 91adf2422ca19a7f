"""Collects placements, contacts, groups and assembly steps of a scene."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from tactcad.contour import rectangle
from tactcad.parts.bought import screws
from tactcad.parts.bought.electronic_parts import Supply
from tactcad.parts.language.description import Extrusion, Material, Part, Vector, vector

from .scene import (
    AGAINST_Y,
    ALONG_Y,
    DOWN,
    UPRIGHT,
    Contact,
    ContactKind,
    Motion,
    Move,
    Placement,
    Rotation,
    Scene,
    Step,
)
from .scene import rotation as turn

POINTING: dict[Vector, Rotation] = {
    (0, 0, 1): UPRIGHT,
    (0, 0, -1): DOWN,
    (0, 1, 0): ALONG_Y,
    (0, -1, 0): AGAINST_Y,
}

AID = Material("steel", 7850)


def telling(module: str) -> Callable[..., str]:
    """A function from the name of a text of the guide, in the .toml beside that module, to its words."""
    texts = tomllib.loads(Path(module).with_suffix(".toml").read_text("utf-8"))

    def said(name: str, /, **blanks: object) -> str:
        return texts[name].format(**blanks)

    return said


class Builder:
    """Collects placements in order. A group or a step takes the parts placed while it is open; `placed_in`
    keeps parts placed for a step named with the part.
    """

    def __init__(self) -> None:
        self.placements: list[Placement] = []
        self.contacts: list[Contact] = []
        self.supplies: list[Supply] = []
        self.groups: dict[str, list[str]] = {}
        self.steps: list[Step] = []
        self.placed_in: dict[str, list[str]] = {}
        self._numbers: dict[str, int] = {}
        self._group: str | None = None
        self._open: list[str] = []  # placed, in no step yet
        self._ready: set[str] = set()
        self._scenes: list[Scene] = []
        self.aids: list[Placement] = []
        self._unit = ""

    def group(self, name: str | None) -> None:
        """Parts placed from here on move with the group `name` (None: they do not move)."""
        self._group = name

    def unit(self, name: str) -> None:
        """Steps from here on belong to the sub-assembly `name`."""
        self._unit = name

    def name(self, prefix: str) -> str:
        """The next designator with that prefix."""
        self._numbers[prefix] = self._numbers.get(prefix, 0) + 1
        return f"{prefix}{self._numbers[prefix]}"

    def place(
        self, prefix: str, part: Part, at: Vector, turned: Rotation = UPRIGHT, step: str = "", on: str = ""
    ) -> str:
        """Put a part in place, in the step of that title if one is given, where it touches `on`; returns its
        designator."""
        name = self.put(Placement(self.name(prefix), part, at, turned))
        if step:
            self.placed_in.setdefault(step, []).append(name)
        if on:
            self.meet(name, on)
        return name

    def put(self, placement: Placement) -> str:
        """A part under a designator of its own; returns it."""
        placement = replace(placement, origin=_rounded(placement.origin))
        self.placements.append(placement)
        self._open.append(placement.designator)
        if self._group is not None:
            self.groups.setdefault(self._group, []).append(placement.designator)
        return placement.designator

    def meet(self, first: str, second: str, kind: ContactKind = "touch") -> None:
        self.contacts.append(Contact(first, second, kind))

    def screw(
        self, thread: str, length: float, under_head: Vector, direction: Vector, head_on: str, into: str
    ) -> str:
        """A cap screw with its head's bearing face at `under_head`, pointing in `direction`."""
        made = screws.cap_screw(thread, length)
        name = self.place("RS", made, under_head, POINTING[direction], on=head_on)
        self.meet(name, into, "thread")
        return name

    def aid(self, name: str, low: Vector, high: Vector) -> str:
        """A box between two corners that steps bring, and that is no part of the scene; its designator."""
        x, y, z = (round(b - a, 9) for a, b in zip(low, high))
        body = Extrusion(rectangle(0.0, 0.0, x, y), z)
        designator = f"AID{len(self.aids) + 1}"
        box = Part(f"AID-{x:g}x{y:g}x{z:g}", name, "reference", AID, body)
        self.aids.append(Placement(designator, box, _rounded(low)))
        return designator

    def subassembly(self, scene: Scene, rotation: Rotation, shift: Vector) -> None:
        """Everything of another scene, turned and moved; its designators are kept."""
        for p in scene.placements:
            turned = turn(
                (sum(rotation[i][k] * p.rotation[k][j] for k in range(3)) for j in range(3)) for i in range(3)
            )
            at = vector(sum(rotation[i][k] * p.origin[k] for k in range(3)) + shift[i] for i in range(3))
            self._ready.add(self.put(Placement(p.designator, p.part, at, turned)))
        self._scenes.append(scene)
        self.contacts += scene.contacts
        self.supplies += scene.supplies

    def step(
        self,
        title: str,
        explode: Vector,
        text: str,
        order: Sequence[Move | Sequence[str]] = (),
        later: Sequence[str] = (),
        **more: Any,
    ) -> None:
        """Close a step: it takes all parts placed since the previous step, but `later` ones, which the next
        one takes; parts of a subassembly are ready. Other arguments are fields of `Step`."""
        names = tuple(n for n in self._open if n not in later)
        self._open = [*later]
        ready = frozenset(self._ready & set(names))
        moves = tuple(item if isinstance(item, Move) else tuple(item) for item in order)
        self.steps.append(
            Step(title, names, explode, text, ready=ready, unit=self._unit, order=moves, **more)
        )

    def scene(self, name: str, motions: Iterable[Motion] = (), cover: Iterable[str] = ()) -> Scene:
        groups = tuple((group, frozenset(names)) for group, names in self.groups.items())
        return Scene(
            name,
            tuple(self.placements),
            tuple(self.contacts),
            tuple(self.supplies),
            frozenset(cover),
            groups,
            tuple(motions),
            tuple(self.steps),
            tuple(self._scenes),
            tuple(self.aids),
        )


def _rounded(point: Vector) -> Vector:
    return vector(round(float(v), 9) + 0.0 for v in point)
