"""Whether the assembly's steps can be carried out: every move is made with the solids past all parts then
present, every step has its needs, and contacts fix the freedoms that it states.

A pair is tried on meshes at PLACES or more of each leg, no further apart than a third of both parts'
lengths along it: an overlap of more than FILM is in the way; pairs alike around the way share one trial. The
overlap of a screw or pin with its hole at its final place is allowed on the way.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from math import ceil, pi
from typing import Any

import manifold3d
import numpy as np
from OCP.TopoDS import TopoDS_Shape

from tactcad.parts.array.layout import LEVER
from tactcad.parts.language.description import Vector
from tactcad.parts.language.finding import Finding
from tactcad.parts.language.metric import METRIC
from tactcad.scenes.moves import CLAMP, FINGERTIP, PRESS, TWEEZED, Moment, entering, moments
from tactcad.scenes.scene import FREEDOMS, HAND, STILL, Held, Placement, Scene, Step
from tactcad.solids.build import build
from tactcad.solids.changed import closed
from tactcad.solids.measure import boxed
from tactcad.solids.triangles import triangles
from tactcad.stacks.mechanic import TAKEN_AS_SET

from ..check import Check
from .interference import Surroundings
from .tools import REACH as KEY
from .tools import tool_of

PLACES = 9  # on a leg, at least, from the first to the last contact of a pair's boxes; chosen
FILM = 0.05  # mm3: what chords of two curved faces, 0.002 mm off, may share over a pin's length
CHORD, TURN = 0.02, 0.2  # mm, rad: of the meshes; the kernel's facets turn by half as much
AROUND = 0.1  # mm around a body's path on a leg: only this much of a large part is cut each time
REACH = 0.03  # mm that a body is shifted to find its contacts
SLIP = 0.1  # mm, in a hole that slips over a pin: 0.075 is the play to one side that rules leave a dowel
PATCH = 1e-3  # mm3 of overlap that shows a contact: 0.03 mm2
WIDE, THICK = FINGERTIP
GRIP = 4.0  # mm of a pin's end that two fingertips cover
FINGER = 40.0  # mm of a finger behind its tip; chosen: two of its joints
HEADED = ("cap screw", "nut")  # a set screw presses by itself on what it holds
SPAN = 100.0  # mm between thumb and finger of one hand; chosen: half an adult's span
OPENING = 300.0  # mm between a hand clamp's jaws, as wide as fingertips; chosen: a usual small bar clamp's
TWEEZERS, TWEEZERS_LONG = (1.0, 1.0), 20.0  # mm: the tip of plastic ones, and behind it; chosen
# Chosen, in mm: an arbor press's ram over a pin, and the wall of the sleeve that is its stop; an open-ended
# spanner of a usual kind: its head over the flats, its handle's length from the nut, its thickness.
RAM, SLEEVE = (20.0, 30.0), 2.0
HEAD, HANDLE, FLAT = (2.0, 4.0), 60.0, 5.0
SWING = 30.0  # degrees between two grips of an open-ended spanner that is turned over
WAYS = {f: f"along {f}" if len(f) == 1 else f"to turn about {f[1]}" for f in FREEDOMS}


def check_steps(
    scene: Scene, shapes: Mapping[str, TopoDS_Shape], known: dict[tuple, Any] | None = None
) -> list[Finding]:
    """Findings on the steps of a scene; shapes by part number. `known` keeps meshes and what was tried,
    for the design's other scenes."""
    trial = Trial(scene, shapes, {} if known is None else known)
    return [*trial.findings(), *trial.freedoms()]


class Trial:
    def __init__(self, scene: Scene, shapes: Mapping[str, TopoDS_Shape], known: dict[tuple, Any]) -> None:
        self.scene, self.shapes, self.known = scene, shapes, known
        self.placed = {p.designator: p for p in (*scene.placements, *scene.aids)}
        self.aids = {p.designator for p in scene.aids}
        self.kind = {frozenset((c.first, c.second)): c.kind for c in scene.contacts}
        self.goes_into: dict[str, list[str]] = {}
        for name, host in entering(scene):
            self.goes_into.setdefault(name, []).append(host)
        self.boxes: dict[str, np.ndarray] = {}

    def findings(self) -> Iterator[Finding]:
        at: dict[str, Vector] = {}
        there: set[str] = set()
        loose: list[tuple[str, ...]] = []  # laid by hand, not screwed yet
        done, off = 0, set(self.aids)
        for moment in moments(self.scene):
            while done < moment.step:
                yield from self._needed(done, there)
                done += 1
            step, move = self.scene.steps[moment.step], moment.move
            there |= set(move.designators)
            for name in move.designators:
                for need in self.goes_into.get(name, ()):
                    if name in step.designators and name not in step.ready and need not in there:
                        yield from _order(step, name, f"goes into {need}, which is not there yet")
            if any(name in at and at[name] != move.start for name in move.designators):
                yield from _order(step, move.designators[0], "does not start where it was left")
            yield from self._moved(step, moment)
            if move.by == HAND and len(move.designators) == 1 and move.designators[0] in at:
                yield from self._finger_room(step, moment)
            elif move.by in (HAND, TWEEZED):
                yield from self._touched(step, moment)
            elif move.by == PRESS:
                yield from self._press_room(step, moment)
            elif move.by.startswith("spanner"):
                yield from self._spanner_room(step, moment)
            if move.by == HAND:
                loose = [body for body in loose if not {*body} & {*move.designators}] + [move.designators]
            elif (driven := self.placed[move.designators[0]].part.kind) in HEADED and not step.apart:
                no = (None, "thread") if driven == "nut" else (None,)  # its own rod
                pairs = {
                    n: self.kind.get(frozenset((move.designators[0], n))) for body in loose for n in body
                }
                for body in [b for b in loose if any(pairs[n] not in no for n in b)]:
                    yield from self._held_room(step, moment, body)
                    loose.remove(body)
            at |= dict.fromkeys(move.designators, move.path[-1])
            (off.update if step.apart else off.difference_update)(set(move.designators) - self.aids)
        for n in range(done, len(self.scene.steps)):
            yield from self._needed(n, there)
        for name, offset in at.items():
            if offset != STILL and name not in off:
                yield from _order(self.scene.steps[-1], name, f"is left {np.linalg.norm(offset):.3g} mm off")

    def freedoms(self) -> Iterator[Finding]:
        """Those that are free though a step, or the virtual build, has them set."""
        for step in self.scene.steps:
            for held in step.held:
                for body in held.bodies:
                    yield from self._unset(step, body, held)
        yield from self._taken()

    def _unset(self, step: Step, body: Sequence[str], held: Held) -> Iterator[Finding]:
        """Freedoms that a step states as fixed, but its contacts do not fix."""
        levers = self._levers(body, held.by)
        for freedom in held.freedoms:
            if levers[FREEDOMS.index(freedom)] < LEVER:
                message = (
                    f"step '{step.title}': {' '.join(body)} is free {WAYS[freedom]}: its contact with "
                    f"{' '.join(held.by)} does not set that"
                )
                yield Finding("freedom", "fail", body[0], (), 0.0, LEVER, message)

    def _taken(self) -> Iterator[Finding]:
        """Freedoms that virtual arrays take as fixed, but no step states."""
        taken = TAKEN_AS_SET.get(self.scene.name, {})
        said = {
            (n, f) for s in self.scene.steps for h in s.held for b in h.bodies for n in b for f in h.freedoms
        }
        for name in self.placed:
            for freedom in taken.get(name.rstrip("0123456789"), ()):
                if (name, freedom) not in said:
                    message = (
                        f"{name} is free {WAYS[freedom]}: no step sets that, virtual arrays take it as set"
                    )
                    yield Finding("freedom", "fail", name, (), 0.0, LEVER, message)

    def _levers(self, body: Sequence[str], by: Sequence[str]) -> np.ndarray:
        """Firmness of the contacts that fix a body's six freedoms about its middle: one over the root of the
        compliance on springs that share one stiffness at every patch, turns over half the body's diagonal
        across."""
        boxes = np.array([self._box(self.placed[name]) for name in body])
        ends = np.array([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])
        middle, half = ends.mean(axis=0), (ends[1] - ends[0]) / 2
        across = np.hypot(half[[1, 2, 0]], half[[2, 0, 1]])  # the turn's axis
        stiffness = 1e-12 * np.eye(6)
        for name in body:
            for other in by:
                for points, normals, areas in self._patches(self.placed[name], self.placed[other]):
                    rows = np.hstack([normals, np.cross(points - middle, normals) / across])
                    stiffness += (rows * areas[:, None]).T @ rows / areas.sum()
        return 1.0 / np.sqrt(np.diag(np.linalg.inv(stiffness)))

    def _patches(self, p: Placement, q: Placement) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Faces that keep a part from shifting against another one, by direction: triangles' corners on both
        faces, normals and areas."""
        a, b = self._box(p), self._box(q)
        pair = p.designator, q.designator
        slips = frozenset(pair) not in self.kind and any(n in self.goes_into for n in pair)
        reach = SLIP if slips else REACH
        if np.any(a[0] > b[1] + reach) or np.any(b[0] > a[1] + reach):
            return
        standing = self._mesh(q).translate(list(q.origin))
        for way in (*np.eye(3), *-np.eye(3)):
            shared = self._mesh(p).translate(list(np.array(p.origin) + reach * way)) ^ standing
            if shared.volume() <= PATCH:
                continue
            mesh = shared.to_mesh()
            corners = np.asarray(mesh.vert_properties)[:, :3][np.asarray(mesh.tri_verts)]
            cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            areas = np.maximum(np.linalg.norm(cross, axis=1), 1e-12)
            facing = np.abs(cross @ way) > 0.5 * areas  # not the sides, as high as the shift
            normals = (cross / areas[:, None])[facing].repeat(3, axis=0)
            yield corners[facing].reshape(-1, 3), normals, areas[facing].repeat(3)

    def _needed(self, number: int, there: set[str]) -> Iterator[Finding]:
        step = self.scene.steps[number]
        for need in step.needs:
            wrong = [n for n in need.what if n in self.placed and (n in there) == need.away]
            if wrong:
                how = "is there already" if need.away else "is not there yet"
                yield from _order(step, wrong[0], f"{how}: {need.why}")

    def _mesh(self, p: Placement) -> manifold3d.Manifold:
        """Turned, not moved."""
        key = ("steps", p.part.part_no)
        if (*key, p.rotation) not in self.known:
            if key not in self.known:
                shape = build(p.part) if p.designator in self.aids else self.shapes[p.part.part_no]
                # always by the quicker method: no file holds this mesh
                self.known[key] = closed(triangles(shape, CHORD, TURN, many=0))
            turn = np.column_stack([np.array(p.rotation), np.zeros(3)])
            self.known[*key, p.rotation] = self.known[key].transform(turn)
        return self.known[*key, p.rotation]

    def _box(self, p: Placement) -> np.ndarray:
        if p.designator not in self.boxes:
            ends = np.reshape(self._mesh(p).bounding_box(), (2, 3))
            self.boxes[p.designator] = ends + np.array(p.origin)
        return self.boxes[p.designator]

    def _moved(self, step: Step, moment: Moment) -> Iterator[Finding]:
        names = list(moment.standing)
        if not names:
            return
        boxes = np.array([self._box(self.placed[n]) + moment.standing[n] for n in names])
        legs = list(zip((moment.move.start, *moment.move.path[:-1]), moment.move.path))
        for name in moment.move.designators:
            own = self._box(self.placed[name])
            for start, end in legs:
                if start == end:
                    continue
                a, b = np.array(start), np.array(end)
                low, high = own[0] + np.minimum(a, b), own[1] + np.maximum(a, b)
                near = np.all((low < boxes[:, 1] - FILM) & (high > boxes[:, 0] + FILM), axis=1)
                for i in np.flatnonzero(near):
                    cut = self._cut(
                        name, names[i], a - moment.standing[names[i]], b - moment.standing[names[i]]
                    )
                    if cut:
                        yield self._in_the_way(step, name, names[i], *cut)
                        break

    def _in_the_way(self, step: Step, name: str, other: str, cut: float, off: float) -> Finding:
        a, b = self.placed[name].part.part_no, self.placed[other].part.part_no
        where = f"{off:.3g} mm before its place"
        message = f"step '{step.title}': {name} ({a}) cuts {cut:.3g} mm3 into {other} ({b}), {where}"
        return Finding("insertion", "fail", name, (), cut, FILM, message)

    def _cut(self, name: str, other: str, start: np.ndarray, end: np.ndarray) -> tuple[float, float] | None:
        """Largest volume that both share on the leg beyond what they may, mm3, and how far from the leg's
        end."""
        p, q = self.placed[name], self.placed[other]
        apart = np.array(p.origin) - np.array(q.origin)
        kind = self.kind.get(frozenset((name, other)), "touch")
        way = tuple((np.round([*start, *end], 6) + 0.0).tolist())
        numbers = ("steps", p.part.part_no, q.part.part_no, p.rotation, q.rotation, kind, way)
        offs = np.array([start, end, STILL])  # in place some overlap is allowed
        low, high = offs.min(axis=0), offs.max(axis=0)
        views = (q, self._box(p) + [low, high], p.origin), (p, self._box(q) - [high, low], q.origin)
        seen = [(n, near) for n, view in enumerate(views) if (near := self._near(*view)) is not None]
        keys = [(*numbers, *s) for s in seen or [tuple((np.round(apart, 6) + 0.0).tolist())]]
        known = next((key for key in keys if key in self.known), None)
        found = self.known[known] if known else self._tried(p, q, apart, start, end, kind)
        self.known |= dict.fromkeys(keys, found)
        return found

    def _near(self, p: Placement, box: np.ndarray, at: Sequence[float]) -> tuple | None:
        """What bounds a part in place in a box and around it, as seen from a point (`Surroundings.near`)."""
        key = ("bounds", p.part.part_no)
        if key not in self.known:
            self.known[key] = Surroundings(p.part)
        turn = np.array(p.rotation).T
        off = -turn @ np.array(p.origin)
        return self.known[key].near(boxed(box, turn, off), turn @ np.array(at) + off)

    def _tried(
        self, p: Placement, q: Placement, apart: np.ndarray, start: np.ndarray, end: np.ndarray, kind: str
    ) -> tuple[float, float] | None:
        moving, standing = self._mesh(p), self._mesh(q)
        boxes = [np.reshape(m.bounding_box(), (2, 3)) for m in (moving, standing)]
        allowed = FILM
        screw = next((a.part for a in (p, q) if a.part.thread and a.part.kind), None)
        if kind == "thread" and screw:  # as deep as the part it goes through
            m = METRIC[screw.thread]
            host = boxes[1] if screw is p.part else boxes[0]
            through = float((host[1] - host[0]) @ np.abs(end - start)) / float(np.linalg.norm(end - start))
            allowed += pi / 4 * (m.d**2 - m.tap_drill**2) * through
        elif kind != "touch":
            allowed += (moving.translate(list(apart)) ^ standing).volume()
        way = end - start
        length = float(np.linalg.norm(way))
        reach = sum(float((b[1] - b[0]) @ np.abs(way)) / length for b in boxes)
        # the stretch on which their boxes meet: low <= start + t way <= high along every axis
        low, high = boxes[1][0] - boxes[0][1] - apart - start, boxes[1][1] - boxes[0][0] - apart - start
        moving_along = np.abs(way) > 0
        ends = np.sort(np.stack([low, high])[:, moving_along] / way[moving_along], axis=0)
        t0, t1 = max(0.0, ends[0].max()), min(1.0, ends[1].min())
        if t0 > t1 or np.any((low > 0) | (high < 0), where=~moving_along):
            return None
        passed = boxes[0] + apart + start + np.sort([t0 * way, t1 * way], axis=0) + [[-AROUND], [AROUND]]
        standing = manifold3d.Manifold.cube(list(passed[1] - passed[0])).translate(list(passed[0])) ^ standing
        worst = (0.0, 0.0)
        for t in np.linspace(t0, t1, max(PLACES, 1 + ceil(3 * length * (t1 - t0) / reach))):
            cut = (moving.translate(list(apart + start + t * way)) ^ standing).volume()
            if cut - allowed > worst[0] + 1e-6:  # the first of equal ones
                worst = (cut - allowed, length * (1.0 - float(t)))
        return worst if worst[0] > 0.0 else None

    def _finger_room(self, step: Step, moment: Moment) -> Iterator[Finding]:
        """Fingertips have room, from one side or the other, at the end by which a part is pulled out of its
        hole or left in place."""
        (name,) = moment.move.designators
        at, pulled = moment.move.start, np.array(moment.move.path[0]) - moment.move.start
        box = self._box(self.placed[name]) + at
        k = int(np.argmax(np.abs(pulled)))
        if max(side for i, side in enumerate(box[1] - box[0]) if i != k) > THICK:
            return  # no pin: held by its faces
        end, sign = (box[1][k], 1.0) if pulled[k] > 0 else (box[0][k], -1.0)
        middle, half = box.mean(axis=0), (box[1] - box[0]) / 2
        for first, second in ((THICK, WIDE / 2), (WIDE / 2, THICK)):
            wide = np.empty(3)
            wide[[i for i in range(3) if i != k]] = first, second
            wide += np.where(wide == THICK, half, 0.0)
            hand = np.array([middle - wide, middle + wide])
            hand[:, k] = sorted((end - sign * (GRIP - FILM), end + sign * 2 * THICK))
            if self._free(hand, moment, self._standing(moment)):
                return
        message = (
            f"step '{step.title}': {name}: no room for fingertips, {2 * THICK:g} mm across and {WIDE:g} "
            f"wide, on its last {GRIP:g} mm"
        )
        yield Finding("fingers", "fail", name, (), 0.0, GRIP, message)

    def _touched(self, step: Step, moment: Moment) -> Iterator[Finding]:
        """A fingertip, or tweezers, come at the part in place from some side but ahead, somewhere along its
        face."""
        ends = [moment.move.start, *moment.move.path]
        way = np.subtract(ends[-1], ends[-2])
        tip, long = (TWEEZERS, TWEEZERS_LONG) if moment.move.by == TWEEZED else ((WIDE, THICK), FINGER)
        boxes = self._standing(moment)
        for name in moment.move.designators:
            part = self._box(self.placed[name]) + ends[-1]
            for k, side in product((2, 1, 0), (1, 0)):
                if way[k] * (2 * side - 1) > 0:
                    continue  # ahead
                for low, wide in product(product(range(5), repeat=2), (tip, tip[::-1])):
                    if self._free(_fingertip(part, k, side, low, wide, long), moment, boxes):
                        return
        name = moment.move.designators[0]
        what = "tweezers" if moment.move.by == TWEEZED else "fingertip"
        message = f"step '{step.title}': {name}: no {what}, {tip[0]:g} x {tip[1]:g} mm, reaches it in place"
        yield Finding("fingers", "fail", name, (), 0.0, tip[1], message)

    def _held_room(self, step: Step, moment: Moment, loose: Sequence[str]) -> Iterator[Finding]:
        """While a part's first screw is driven one hand holds it: by a fingertip that presses it on what it
        stands on, or else by two fingertips opposite each other, or the jaws of a clamp that the step names;
        the other hand has the key."""
        span = OPENING if CLAMP in step.tools else SPAN
        (name,) = moment.move.designators
        at, boxes = np.array(moment.move.path[-1]), self._standing(moment)
        driven = [self._mesh(self.placed[name]).translate(list(self.placed[name].origin + at))]
        if (key := tool_of(self.placed[name])) is not None:
            bar = manifold3d.Manifold.cylinder(KEY, key.part.body.box[1][0])
            driven.append(bar.transform(np.column_stack([key.rotation, np.add(key.origin, at)])))

        def free(room: np.ndarray) -> bool:
            hand = manifold3d.Manifold.cube(list(room[1] - room[0])).translate(list(room[0]))
            return self._free(room, moment, boxes) and all((hand ^ d).volume() <= FILM for d in driven)

        ways = (0, 1, 2) if step.bench else (2,)  # pressed down; on the bench all can be turned over
        presses = {
            (n, k, side)
            for n in loose
            for other, box in boxes.items()
            if other not in loose and frozenset((n, other)) in self.kind
            for k, side in product(ways, (0, 1) if step.bench else (1,))
            if abs(box[side][k] - boxes[n][1 - side][k]) < REACH
        }
        tips = [*product(product(range(5), repeat=2), ((WIDE, THICK), (THICK, WIDE)))]
        for (n, k, side), (low, wide) in product(sorted(presses), tips):
            if free(_fingertip(boxes[n], k, side, low, wide, FINGER)):
                return
        largest = sorted(loose, key=lambda n: -float(np.prod(boxes[n][1] - boxes[n][0])))
        for n, k, (low, wide) in product(largest, (0, 1, 2), tips):
            near, far = (_fingertip(boxes[n], k, side, low, wide, FINGER) for side in (0, 1))
            if boxes[n][1][k] - boxes[n][0][k] <= span and free(near) and free(far):
                return
        message = (
            f"step '{step.title}': {' '.join(loose)}: no fingertip presses it down, and no two hold it, "
            f"{span:g} mm apart at most, while {name} is driven"
        )
        yield Finding("fingers", "fail", loose[0], (), 0.0, THICK, message)

    def _press_room(self, step: Step, moment: Moment) -> Iterator[Finding]:
        """Over a pressed pin there is room for the press's ram, and around it for the sleeve: beyond the part
        that the pin is in."""
        (name,) = moment.move.designators
        way = np.subtract(moment.move.start, moment.move.path[-1])
        pin = self._box(self.placed[name]) + moment.move.path[-1]
        hosts = self.goes_into.get(name, ())
        k = int(np.argmax(np.abs(way)))
        end, sign = (pin[1][k], 1.0) if way[k] > 0 else (pin[0][k], -1.0)
        faces = [sign * self._box(self.placed[host])[1 if sign > 0 else 0][k] for host in hosts]
        foot = sign * max(faces, default=sign * end)
        radius = float(np.delete(pin[1] - pin[0], k).min()) / 2
        for what, half, start, stop, without in (
            ("ram", RAM[0] / 2, end + sign * FILM, end + sign * RAM[1], ()),
            ("sleeve", radius + SLEEVE, foot, end, hosts),
        ):
            middle = pin.mean(axis=0)
            room = np.array([middle - half, middle + half])
            room[:, k] = sorted((start, stop))
            if sign * (stop - start) > FILM and not self._free(room, moment, self._standing(moment, without)):
                message = (
                    f"step '{step.title}': {name}: no room for the press's {what}, {2 * half:.3g} mm wide"
                )
                yield Finding("tool-room", "fail", name, (), 0.0, 2 * half, message)

    def _spanner_room(self, step: Step, moment: Moment) -> Iterator[Finding]:
        """An open-ended spanner goes on in two places next to each other, with its lower or its upper face
        flush with the nut's."""
        (name,) = moment.move.designators
        flats, thick = [*map(float, re.findall(r"([\d.]+) mm", moment.move.by)), FLAT][:2]
        p, at = self.placed[name], np.array(moment.move.path[-1])
        radius, high = (HEAD[0] * flats + HEAD[1]) / 2, p.part.body.box[1][2]
        spanner = manifold3d.Manifold.cylinder(thick, radius)
        spanner += manifold3d.Manifold.cube([HANDLE, flats, thick]).translate([0.0, -flats / 2, 0.0])
        jaw = [radius + flats / 2, flats, thick]
        spanner -= manifold3d.Manifold.cube(jaw).translate([-radius, -flats / 2, 0.0])
        for z in (0.0, high - thick):
            fits = []
            for n in range(round(360 / SWING)):
                turned = spanner.rotate([0.0, 0.0, n * SWING]).translate([0.0, 0.0, z])
                turned = turned.transform(np.column_stack([p.rotation, np.add(p.origin, at)]))
                fits.append(not any(self._meets(turned, other, moment) for other in moment.standing))
            if any(a and b for a, b in zip(fits, fits[1:] + fits[:1])):
                return
        message = f"step '{step.title}': {name}: no spanner of {flats:g} mm turns by {SWING:g} degrees on it"
        yield Finding("tool-room", "fail", name, (), 0.0, SWING, message)

    def _standing(self, moment: Moment, without: Sequence[str] = ()) -> dict[str, np.ndarray]:
        """Boxes of what stands there."""
        return {n: self._box(self.placed[n]) + at for n, at in moment.standing.items() if n not in without}

    def _free(self, room: np.ndarray, moment: Moment, boxes: Mapping[str, np.ndarray]) -> bool:
        """Whether nothing of what has these boxes reaches into a box, by its corners."""
        ends = np.array([*boxes.values()])
        if not len(ends):
            return True
        near = np.all((room[0] < ends[:, 1]) & (room[1] > ends[:, 0]), axis=1)
        return not any(self._reaches(n, room, moment) for n, close in zip(boxes, near) if close)

    def _reaches(self, name: str, room: np.ndarray, moment: Moment) -> bool:
        """Whether a part reaches into a box."""
        p, own = self.placed[name], room - moment.standing[name]
        near = self._near(p, own, own[0])
        place = near if near is not None else tuple(np.round(own[0] - p.origin, 6).tolist())
        key = ("room", p.part.part_no, p.rotation, *np.round(room[1] - room[0], 6).tolist(), place)
        if key not in self.known:
            hand = manifold3d.Manifold.cube(list(room[1] - room[0])).translate(list(room[0]))
            self.known[key] = self._meets(hand, name, moment)
        return self.known[key]

    def _meets(self, hand: manifold3d.Manifold, name: str, moment: Moment) -> bool:
        p, at = self.placed[name], moment.standing[name]
        room, box = np.reshape(hand.bounding_box(), (2, 3)), self._box(p) + at
        if np.any(room[0] >= box[1]) or np.any(room[1] <= box[0]):
            return False
        return (hand ^ self._mesh(p).translate(list(np.array(p.origin) + at))).volume() > FILM


def _fingertip(
    part: np.ndarray, k: int, side: int, low: Sequence[int], wide: Sequence[float], long: float
) -> np.ndarray:
    """Room of a fingertip so wide, its finger behind it, on a box's upper (1) or lower side along k: in its
    middle, over an edge, or up to one."""
    room = np.empty((2, 3))
    room[:, k] = sorted((part[side][k], part[side][k] + (2 * side - 1) * long))
    for i, at, w in zip((i for i in range(3) if i != k), low, wide):
        (a, b), grip = part[:, i], min(GRIP, part[1, i] - part[0, i])
        starts = (a + b - w) / 2, b - grip, a + grip - w, a, b - w
        room[:, i] = starts[at], starts[at] + w
    return room


def _order(step: Step, part: str, what: str) -> Iterator[Finding]:
    yield Finding("order", "fail", part, (), 0, 0, f"step '{step.title}': {part} {what}")


CHECKS = (
    Check(
        "steps",
        "scene",
        lambda scene, job: check_steps(scene, job.shapes, job.meetings),
        place=25,
        applies=lambda scene: bool(scene.steps),
    ),
)
