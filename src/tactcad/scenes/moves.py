"""The moves of a scene's assembly: which part comes from where, along what way, by which hand or tool.

A step states exceptions; the rest follows from the placements. A screw comes along its axis, a pin along its
hole from the side where it protrudes, any other part along the normal of the face it is laid on. Parts
assembled on the bench move as one. No CAD kernel: ways follow from the parts' boxes, and the check of steps
(checks/on_solids/steps.py) moves the solids along them.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from tactcad.parts.language.description import Part, Vector, vector
from tactcad.parts.language.metric import METRIC

from .scene import FREEDOMS, HAND, STILL, Contact, Freedom, Held, Move, Need, Placement, Scene, Step

# mm that a part starts clear of all that it comes between; chosen: fingers hold it there
APPROACH = 20.0
# mm between bench and assembly; chosen: two hands' width
BENCH = 100.0
SAME = 1e-6  # mm: boxes that touch
FASTENERS = ("cap screw", "set screw", "nut")
TWEEZED = "tweezers"
# mm: width and thickness of a fingertip. Chosen: half of an adult's 16 to 20 mm, which is soft (often quoted
# from Dandekar et al., J. Biomech. Eng. 125, 2003; not read).
FINGERTIP = (12.0, 10.0)
PRESS = "arbor press or vice with soft jaws"
CLAMP = "hand clamp, soft jaws"

Box = tuple[Vector, Vector]


@dataclass(frozen=True)
class Moment:
    """A move, and the offsets of the other parts present from their final places meanwhile, mm. On the bench
    only the parts that lie there count."""

    step: int
    move: Move
    standing: Mapping[str, Vector]


def moments(scene: Scene) -> list[Moment]:
    """Every move of the assembly in order."""
    return [moment for some in _Assembly(scene).steps() for moment in some]


def step_moves(scene: Scene) -> list[tuple[Move, ...]]:
    """The moves of every step."""
    return [tuple(moment.move for moment in some) for some in _Assembly(scene).steps()]


def box(p: Placement, shift: Vector = STILL) -> Box:
    """Least and largest corner of a part's stock, mm."""
    ends = p.part.body.box
    low, high = [], []
    for i, row in enumerate(p.rotation):
        a = [row[k] * ends[0][k] for k in range(3)]
        b = [row[k] * ends[1][k] for k in range(3)]
        low.append(sum(map(min, a, b)) + p.origin[i] + shift[i])
        high.append(sum(map(max, a, b)) + p.origin[i] + shift[i])
    return vector(low), vector(high)


def way_of_screw(p: Placement) -> Vector | None:
    """Direction from which a screw comes: against its own axis; None for any other part."""
    if p.part.kind not in ("cap screw", "set screw"):
        return None
    return vector(-row[2] + 0.0 for row in p.rotation)


class _Assembly:
    """Moves step by step, and where everything is."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.placed = {p.designator: p for p in (*scene.placements, *scene.aids)}
        self.aids = {p.designator for p in scene.aids}
        self.boxes = {name: box(p) for name, p in self.placed.items()}
        self.contacts: dict[str, list[Contact]] = {}
        for c in scene.contacts:
            self.contacts.setdefault(c.first, []).append(c)
            self.contacts.setdefault(c.second, []).append(c)
        self.at: dict[str, Vector] = {}
        self.bench: dict[str, list[str]] = {}  # by unit

    def steps(self) -> list[list[Moment]]:
        return [self._step(n, step) for n, step in enumerate(self.scene.steps)]

    def _step(self, number: int, step: Step) -> list[Moment]:
        found: list[Moment] = []
        own = self.bench.setdefault(step.unit, [])
        place = step.at
        if step.bench and not any(place):
            place = self._on_bench(number)
        given = {name for item in step.order for name in (_names(item) or own)}
        items: list[Move | tuple[str, ...]] = [*step.order]
        if own and not step.bench and not given & set(own):
            items.insert(0, ())
        ready = tuple(name for name in step.designators if name in step.ready and name not in given)
        rest = [name for name in step.designators if name not in given and name not in ready]
        items += [*([ready] if ready else []), *((name,) for name in rest)]
        for item in items:
            apart = {name for names in self.bench.values() for name in names}
            landing = item == () or (not step.bench and _names(item)[0] in apart)
            there = set(own) if step.bench else set(self.at) - apart
            move = self._move(step, item or tuple(own), place, there)
            moving = set(move.designators)
            found.append(Moment(number, move, {name: self.at[name] for name in there - moving}))
            self.at |= dict.fromkeys(move.designators, move.path[-1])
            if any(move.path[-1]):  # an aid that is taken away
                self.at = {n: p for n, p in self.at.items() if n not in self.aids & moving}
            if step.bench:
                own += [n for n in move.designators if n not in own]
            elif landing:
                for names in self.bench.values():
                    names[:] = [n for n in names if n not in moving]
        return found

    def _move(self, step: Step, item: Move | tuple[str, ...], place: Vector, there: set[str]) -> Move:
        if isinstance(item, Move):
            return item
        if item[0] in self.at:  # from the bench
            start = self.at[item[0]]
            out = vector(a + b for a, b in zip(start, place))
            return Move(item, start, (out, place) if any(place) else (place,))
        way = self._way(item, there, step.explode)
        fastened = all(self.placed[n].part.kind in FASTENERS for n in item)
        far = self._clear(item, way, there, fastened, place) + APPROACH
        start = vector(p + far * w for p, w in zip(place, way))
        return Move(item, start, (place,), step.by or self._by(item))

    def _on_bench(self, number: int) -> Vector:
        """Place on the bench of parts assembled there: out along the normal by which they come in."""
        steps = self.scene.steps
        if own := self.bench[steps[number].unit]:
            return self.at[own[0]]
        end = next((n for n in range(number, len(steps)) if not steps[n].bench), len(steps))
        unit = tuple(name for step in steps[number:end] for name in step.designators)
        way = self._way(unit, set(self.at), steps[number].explode)
        far = self._clear(unit, way, set(self.at), False) + BENCH
        return vector(far * w for w in way)

    def _way(self, names: Sequence[str], there: set[str], explode: Vector) -> Vector:
        """Unit vector out of the final place, along an axis."""
        first, moving = self.placed[names[0]], set(names)
        if len(names) == 1 and (axis := way_of_screw(first)):
            return axis
        normals: list[Vector] = []
        for name in names:
            for c in self.contacts.get(name, ()):
                other = c.second if c.first == name else c.first
                if other in there and other not in moving:
                    if c.kind != "touch":
                        return self._out_of_hole(name, other)
                    normals += _normals(self.boxes[name], self.boxes[other])
        seen = _dominant(explode)
        if not normals:
            return seen
        count = Counter(normals)
        most = max(count.values())
        best = [n for n, k in count.items() if k == most]
        return seen if seen in best else best[0]

    def _out_of_hole(self, name: str, host: str) -> Vector:
        """Along a pin's axis, from the side on which most of it protrudes from its hole's part."""
        p = self.placed[name]
        axis = [row[2] for row in p.rotation]
        k = max(range(3), key=lambda i: abs(axis[i]))
        own, other = (sum(b[i][k] for i in (0, 1)) for b in (self.boxes[name], self.boxes[host]))
        return vector((1.0 if own >= other else -1.0) if i == k else 0.0 for i in range(3))

    def _clear(
        self, names: Sequence[str], way: Vector, there: set[str], fastened: bool, place: Vector = STILL
    ) -> float:
        """mm along the way until the parts are clear of all others; a screw, of the part it is in."""
        k = max(range(3), key=lambda i: abs(way[i]))
        sides = [i for i in range(3) if i != k]
        far = 0.0
        for name in names:
            a = box(self.placed[name], place) if any(place) else self.boxes[name]
            for other in there - set(names):
                b = box(self.placed[other], self.at[other]) if any(self.at[other]) else self.boxes[other]
                if any(a[0][i] >= b[1][i] - SAME or b[0][i] >= a[1][i] - SAME for i in sides):
                    continue
                if fastened and (a[0][k] >= b[1][k] - SAME or b[0][k] >= a[1][k] - SAME):
                    continue
                far = max(far, b[1][k] - a[0][k] if way[k] > 0 else a[1][k] - b[0][k])
        return round(far, 6)

    def _by(self, names: Sequence[str]) -> str:
        if len(names) > 1:
            return HAND
        tool = driver(self.placed[names[0]].part)
        if tool:
            return tool
        pressed = any(c.kind == "press" and c.first == names[0] for c in self.contacts.get(names[0], ()))
        return PRESS if pressed else HAND


def driver(part: Part) -> str:
    """The driver of a screw or nut; "" for other parts. Nuts stand too near each other, or too low over the
    setting fixture, for spanners."""
    if part.kind not in FASTENERS:
        return ""
    m = METRIC[part.thread]
    if part.kind == "nut":
        return f"nut driver {m.nut:g} mm"
    return f"hex key {m.set_key if part.kind == 'set screw' else m.key:g} mm"


def _names(item: Move | tuple[str, ...]) -> tuple[str, ...]:
    return item.designators if isinstance(item, Move) else item


def _normals(a: Box, b: Box) -> list[Vector]:
    """Normals out of box b into box a at their common faces."""
    found = []
    for k in range(3):
        for sign, gap in ((1.0, a[0][k] - b[1][k]), (-1.0, b[0][k] - a[1][k])):
            if abs(gap) < 1e-3:
                found.append(vector(sign if i == k else 0.0 for i in range(3)))
    return found


def _dominant(explode: Vector) -> Vector:
    """Along the vector's largest component; up if it is zero."""
    k = max(range(3), key=lambda i: abs(explode[i])) if any(explode) else 2
    return vector(((explode[k] >= 0) - (explode[k] < 0)) * 1.0 if i == k else 0.0 for i in range(3))


def settles(scene: Scene, number: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Freedoms that a step fixes and leaves: as it states, or by the contacts that it closes."""
    step = scene.steps[number]
    placed = {p.designator: p for p in scene.placements}
    before = scene.steps[: number + 1]
    near = [s for s in before if s.bench and s.unit == step.unit] if step.bench else before
    there = {d for s in near for d in s.designators}
    new = set(step.designators)
    ready = {d for s in scene.steps for d in s.ready}
    screwed: dict[tuple[str, str], list[str]] = {}
    laid: dict[tuple[str, str], list[str]] = {}
    sets: list[str] = []
    for c in scene.contacts:
        pair = {c.first, c.second}
        if not (pair & new and pair <= there) or pair <= ready:
            continue
        screw = next((n for n in sorted(pair) if placed[n].part.kind in FASTENERS), None)
        if c.kind == "thread" and screw:
            into = next(iter(pair - {screw}))
            heads = {
                n
                for d in scene.contacts
                if d.kind == "touch" and screw in (d.first, d.second)
                for n in (d.first, d.second)
            } - {screw}
            screwed.setdefault((next(iter(sorted(heads)), screw), into), []).append(screw)
        elif c.kind == "press":
            sets.append(f"{c.first} in {c.second}: all")
        elif not screw and not pair & ready:
            a, b = (c.first, c.second) if c.first in new else (c.second, c.first)
            for n in _normals(box(placed[a]), box(placed[b]))[:1]:
                axis = "xyz"[max(range(3), key=lambda i: abs(n[i]))]
                laid.setdefault((axis, b if len(new) < 8 else "its neighbour"), []).append(a)
    sets = [f"{head} to {into}: all, by {' '.join(by)}" for (head, into), by in screwed.items()] + sets
    screwed_on = {n for pair in screwed for n in pair}
    fixed = screwed_on | {n for held in step.held for body in held.bodies for n in body}
    sets = [*map(_held_text, step.held), *sets]
    leaves: list[str] = []
    for (axis, on), names in laid.items():
        own = tuple(dict.fromkeys(names))
        if set(own) <= fixed:
            continue
        sets.append(f"{' '.join(own)} on {on}: along {axis}")
        others = " and ".join(w for w in "xyz" if w != axis)
        leaves.append(f"{' '.join(own)} on {on}: along {others}, turn about {axis}")
    left: dict[str, list[str]] = {}
    for body in dict.fromkeys(
        body for held in step.held for body in held.bodies if not set(body) <= screwed_on
    ):
        kept = {f for held in step.held if body in held.bodies for f in held.freedoms}
        left.setdefault(_ways([f for f in FREEDOMS if f not in kept]), []).append(" ".join(body))
    leaves += [f"{' '.join(names)}: {ways}" for ways, names in left.items() if ways]
    return (step.sets, step.leaves) if step.sets else (tuple(sets), step.leaves or tuple(leaves))


def _held_text(held: Held) -> str:
    each = ", each" if len(held.bodies) > 1 else ""
    names = " ".join(n for body in held.bodies for n in body)
    return f"{names}{each} by {' '.join(held.by)}: {_ways(held.freedoms)}"


def _ways(freedoms: Sequence[Freedom]) -> str:
    along = " and ".join(f for f in freedoms if len(f) == 1)
    about = " and ".join(f[1] for f in freedoms if len(f) == 2)
    return ", ".join(f"{how} {axes}" for how, axes in (("along", along), ("turn about", about)) if axes)


def entering(scene: Scene) -> Iterator[tuple[str, str]]:
    """Screws and pins, each with the part that it goes into."""
    kinds = {p.designator: p.part.kind for p in scene.placements}
    for c in scene.contacts:
        if c.kind == "press":
            yield c.first, c.second
        elif c.kind == "thread":
            for name, host in ((c.first, c.second), (c.second, c.first)):
                if kinds[name] in FASTENERS:
                    yield name, host


FRAME = (
    "from and path: offsets of the part from its final place in the scene's STEP file, mm, along the "
    "scene's axes; straight from each to the next, the part not turned but a screw about its own axis; "
    "after the last one of path it stays there. Moves of one number in `together` are made at the same "
    "time. `aids` are boxes, in no STEP file: one that does not end at its place is out of the way. What a "
    "step `apart` takes off stays off."
)


def guide_json(scene: Scene) -> bytes:
    """guide/SCENE.json."""
    steps, into = [], list(entering(scene))
    for number, (step, moves) in enumerate(zip(scene.steps, step_moves(scene))):
        sets, leaves = settles(scene, number)
        own = set(step.designators) - step.ready
        needed = [*step.needs, *(Need((host,), f"{name} goes into it") for name, host in into if name in own)]
        steps.append(
            {
                "title": step.title,
                "moves": [
                    {
                        "designator": name,
                        "from": _rounded(move.start),
                        "path": [_rounded(p) for p in move.path],
                        "by": move.by,
                        "together": n,
                    }
                    for n, move in enumerate(moves, start=1)
                    for name in move.designators
                ],
                "sets": list(sets),
                "leaves": list(leaves),
                "needs": [
                    {"parts": list(need.what), "there": not need.away, "why": need.why} for need in needed
                ],
                "bench": step.bench,
                "apart": step.apart,
            }
        )
    aids = [
        {"designator": p.designator, "name": p.part.name, "box": [_rounded(end) for end in box(p)]}
        for p in scene.aids
    ]
    told = {"schema": 1, "scene": scene.name, "units": "mm", "frame": FRAME, "aids": aids, "steps": steps}
    return (json.dumps(told, indent=1) + "\n").encode()


def _rounded(v: Iterable[float]) -> list[float]:
    return [round(x, 6) + 0.0 for x in v]
