"""A scene is a list of placements, not geometry; everything else is read off it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import product
from math import floor
from typing import Literal

from tactcad.parts.bought.electronic_parts import Supply
from tactcad.parts.language.description import Part, Vector, envelope, vector

Rotation = tuple[Vector, Vector, Vector]  # rows of the matrix that turns local into scene directions


def rotation(rows: Iterable[Iterable[float]]) -> Rotation:
    """Three rows of three numbers as a Rotation."""
    x, y, z = map(vector, rows)
    return (x, y, z)


UPRIGHT: Rotation = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
ALONG_Y: Rotation = ((-1, 0, 0), (0, 0, 1), (0, 1, 0))  # local z runs along +y
AGAINST_Y: Rotation = ((1, 0, 0), (0, 0, -1), (0, 1, 0))  # local z runs along -y
DOWN: Rotation = ((1, 0, 0), (0, -1, 0), (0, 0, -1))  # local z runs along -z


@dataclass(frozen=True)
class Placement:
    """A part at a place: scene point = rotation x local point + origin (mm)."""

    designator: str
    part: Part
    origin: Vector = (0.0, 0.0, 0.0)
    rotation: Rotation = UPRIGHT


ContactKind = Literal["thread", "press", "touch"]


@dataclass(frozen=True)
class Contact:
    """Two placed parts that are meant to meet.

    thread  a screw in its tapped hole: modelled as an overlap of the thread's depth
    press   a pin in a hole of its own size: the surfaces coincide
    touch   faces in contact
    """

    first: str
    second: str
    kind: ContactKind


@dataclass(frozen=True)
class Motion:
    """A straight way of some groups, all at the same time: (group, from, to), offsets from the placed pose
    in mm."""

    name: str
    ways: tuple[tuple[str, Vector, Vector], ...]


STILL: Vector = (0.0, 0.0, 0.0)
HAND = "hand"


@dataclass(frozen=True)
class Move:
    """Parts that move as one on straight legs, not turned; a screw turns about its own axis.

    start  where they are before: offset from their final place, mm, in the scene's directions
    path   where they come by in turn, offsets likewise; at the last one they stay
    by     hand, or the tool that moves them
    """

    designators: tuple[str, ...]
    start: Vector
    path: tuple[Vector, ...]
    by: str = HAND


Freedom = Literal["x", "y", "z", "rx", "ry", "rz"]
FREEDOMS: tuple[Freedom, ...] = ("x", "y", "z", "rx", "ry", "rz")


@dataclass(frozen=True)
class Held:
    """Bodies whose freedoms contacts fix: along x, y, z, or turns about these axes.

    bodies  designators of each, which move as one
    by      what they lie on, or hang on
    """

    bodies: tuple[tuple[str, ...], ...]
    by: tuple[str, ...]
    freedoms: tuple[Freedom, ...]


@dataclass(frozen=True)
class Need:
    """Parts that must be in place for a step, or `away`: not yet in place; with the reason."""

    what: tuple[str, ...]
    why: str
    away: bool = False


@dataclass(frozen=True)
class Step:
    """A step of the assembly: its parts, their direction (mm, for the exploded view), and its instructions.

    `fan` spreads the step's parts over the outer half of that way, in their order, so many abreast; 0: all
    come together. A `bench` step is done away from the assembly; the next other step brings its parts in.
    `ready` ones were put together before. `unit` names the sub-assembly of the scene that the step belongs
    to; empty if the scene is one. `tools`: those needed besides the drivers of its screws. A step on
    `elements` handles them one by one, so each must be identifiable.

    `order` states the moves that do not follow from the placements (scenes/moves.py), in turn: a Move; or
    designators that come together on their usual way; () brings in what lies on the bench. The step's other
    parts follow one by one. `at`: offset of its parts from their final place for now, mm. `held`: bodies
    fixed by contacts, which the check of steps tries with the solids. `sets` and `leaves`: freedoms that it
    fixes and leaves, if contacts do not show them; `needs`: other parts that must be in place or away.
    `limit`: the limit that the step must reach, noted on the assembly drawing.
    """

    title: str
    designators: tuple[str, ...]
    explode: Vector
    text: str
    fan: int = 0
    bench: bool = False
    ready: frozenset[str] = frozenset()
    unit: str = ""
    tools: tuple[str, ...] = ()
    elements: bool = False
    order: tuple[Move | tuple[str, ...], ...] = ()
    at: Vector = STILL
    sets: tuple[str, ...] = ()
    leaves: tuple[str, ...] = ()
    held: tuple[Held, ...] = ()
    needs: tuple[Need, ...] = ()
    limit: str = ""


@dataclass(frozen=True)
class Pose:
    """A configuration of a scene.

    element     the one under the force sensor (its number; calibration)
    deflection  mm: of that element's pad (calibration), or of the tip or the pads into the sample
    weights     how many lie on the platform; None: the design's (grasping)
    height      mm that the vertical axis is lifted from touching
    cart        mm that the cart has rolled along x
    """

    element: int = 1
    deflection: float = 0.0
    weights: int | None = None
    height: float = 0.0
    cart: float = 0.0


REST = Pose()


def whole_um(mm: float) -> float:
    """A length cut to whole micrometres."""
    return floor(mm * 1e3 + 1e-6) / 1e3


@dataclass(frozen=True)
class Scene:
    """Placements with unique designators, their intended contacts, and supplies without a solid.

    Parameters
    ----------
    name
        Such as "array".
    placements
        The parts and their places.
    contacts
        Pairs that are meant to meet.
    supplies
        Lines of the bill without a solid.
    cover
        Designators of the parts taken off to look inside.
    groups
        Parts that move as one: a name and designators; parts in none do not move.
    motions
        Ways of the groups that are checked for collisions.
    steps
        Of the assembly; they place every designator once.
    ready
        Scenes, at their places, that were assembled before and whose parts are in this one.

    Raises
    ------
    ValueError
        If designators are not unique, the steps do not place each once, or two parts share a number.
    """

    name: str
    placements: tuple[Placement, ...]
    contacts: tuple[Contact, ...] = ()
    supplies: tuple[Supply, ...] = ()
    cover: frozenset[str] = frozenset()
    groups: tuple[tuple[str, frozenset[str]], ...] = ()
    motions: tuple[Motion, ...] = ()
    steps: tuple[Step, ...] = ()
    ready: tuple[Scene, ...] = ()

    def __post_init__(self) -> None:
        names = [p.designator for p in self.placements]
        if len(set(names)) != len(names):
            raise ValueError(f"scene {self.name}: designators are not unique")
        stepped = [d for step in self.steps for d in step.designators]
        if self.steps and sorted(stepped) != sorted(names):
            raise ValueError(f"scene {self.name}: the assembly's steps do not place every part once")
        known: dict[str, Part] = {}
        for p in self.placements:
            if known.setdefault(p.part.part_no, p.part) != p.part:
                raise ValueError(f"scene {self.name}: two parts share the number {p.part.part_no}")

    @property
    def parts(self) -> tuple[Part, ...]:
        """Every part placed, once, in the order of first placement."""
        return tuple({p.part.part_no: p.part for p in self.placements}.values())

    @property
    def size(self) -> Vector:
        """Length, width and height (mm) of the box around all parts, by their descriptions' stock."""
        corners = [
            [
                sum(row[k] * (low, high)[pick[k]][k] for k in range(3)) + p.origin[i]
                for i, row in enumerate(p.rotation)
            ]
            for p in self.placements
            for low, high in [p.part.body.box]
            for pick in product((0, 1), repeat=3)
        ]
        return vector(round(max(along) - min(along), 6) for along in zip(*corners))

    def count(self, part: Part) -> int:
        return sum(p.part.part_no == part.part_no for p in self.placements)


@dataclass(frozen=True)
class AddedPart:
    """A part that Python put into a scene, beyond what the design places.

    scene    its name
    placed   the part, under a designator of its own
    step     title of the step that puts it there: one of the scene's, or a new last one
    touches  designators of what it is meant to meet
    """

    scene: str
    placed: Placement
    step: str
    touches: tuple[str, ...] = ()


LIFTED = 30.0  # mm that a new step's part comes from above, in the exploded view


def with_added(scene: Scene, added: Iterable[AddedPart]) -> Scene:
    """The scene with these parts, in its contacts and steps too."""
    for a in added:
        name, steps = a.placed.designator, list(scene.steps)
        if a.step in (titles := [step.title for step in steps]):
            at = titles.index(a.step)
            steps[at] = replace(steps[at], designators=(*steps[at].designators, name))
        elif steps:
            text = f"Put {a.placed.part.name} in place."
            steps.append(Step(a.step, (name,), (0.0, 0.0, LIFTED), text, unit=steps[-1].unit))
        meets = tuple(Contact(name, other, "touch") for other in a.touches)
        scene = replace(
            scene,
            placements=(*scene.placements, a.placed),
            contacts=scene.contacts + meets,
            steps=tuple(steps),
        )
    return scene


def at_detail(scene: Scene, detail: str) -> Scene:
    """The scene with every part `full` or as its `envelope`."""
    if detail == "full":
        return scene
    parts = {part.part_no: envelope(part) for part in scene.parts}
    placed = tuple(replace(p, part=parts[p.part.part_no]) for p in scene.placements)
    return replace(scene, placements=placed)
