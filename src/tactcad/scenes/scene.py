"""A scene is a list of placements, not geometry; everything else is read off it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import product
from math import floor, pi
from typing import Literal

from tactcad.parts.bought.electronic_parts import Supply
from tactcad.parts.language.description import Extrusion, Hole, Part, Revolution, Vector, envelope, vector

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
    `by`: what makes the usual moves, if no hand or driver does. `limit`: the limit that the step must reach,
    noted on the assembly drawing. `view`: of its picture in the guide (drawing/engine/picture.py).
    `apart`: what its last moves take off stays off.
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
    by: str = ""
    limit: str = ""
    view: str = "above"
    apart: bool = False


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
    aids
        Boxes of what steps bring, use and mostly take away: gauge blocks, plates, boards beside a rig. They
        are in no file of the scene but the guide's.

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
    aids: tuple[Placement, ...] = ()

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


# Largest deviation of a screw from its hole's axis (mm and radians).
COAXIAL = 1e-6


def thread_overlap(first: Placement, second: Placement) -> float:
    """Largest overlap (mm3) that a thread between the two explains: pi/4 (D^2 - d^2) e, with D the thread's
    major diameter, d the tapped hole's as drilled, e the length of full thread that the screw reaches into.

    The screw's axis is its part's z. 0 if neither is in a tapped hole of the other.
    """
    return max((_ring(hole, *ends) for hole, *ends in engaged(first, second)), default=0.0)


def _ring(hole: Hole, start: float, end: float) -> float:
    from_, to = thread_range(hole)
    return pi / 4 * (hole.thread_diameter**2 - hole.diameter**2) * max(0.0, min(end, to) - max(start, from_))


def thread_range(hole: Hole) -> tuple[float, float]:
    """Range along its axis in which a hole has full thread, mm; it begins under a counterbore."""
    start = hole.counterbore[1] if hole.counterbore else 0.0
    return start, start + hole.thread_depth


def engaged(first: Placement, second: Placement) -> Iterator[tuple[Hole, float, float]]:
    """Tapped holes of either part with the other one in their axis, and the range along that axis."""
    import numpy as np  # listing a design's scenes does not load it

    for tapped, screw in ((first, second), (second, first)):
        turn, low_high = np.array(tapped.rotation), _along_z(screw.part)
        axis = np.array(screw.rotation)[:, 2]
        for hole in tapped.part.features:
            if not (isinstance(hole, Hole) and hole.thread) or low_high is None:
                continue
            along, mouth = turn @ np.array(hole.axis, float), turn @ np.array(hole.at, float) + tapped.origin
            way = np.array(screw.origin) - mouth
            beside = way - (way @ along) * along
            if abs(abs(axis @ along) - 1.0) > COAXIAL or np.linalg.norm(beside) > COAXIAL:
                continue
            ends = sorted(float(way @ along + z * (axis @ along)) for z in low_high)
            yield hole, ends[0], ends[1]


def _along_z(part: Part) -> tuple[float, float] | None:
    """The part's extent along its own z, mm."""
    if isinstance(part.body, Extrusion):
        return 0.0, part.body.thickness
    return (part.body.profile.box[1], part.body.profile.box[3]) if isinstance(part.body, Revolution) else None
