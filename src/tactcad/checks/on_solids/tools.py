"""Whether a key or a socket reaches every screw and nut when the assembly's steps put them in.

A tool is a cylinder out of the screw's socket, or over the nut, as long as a hand needs. Obstacles are the
parts present when the screw goes in, each at its place at that time (scenes/moves.py).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from math import cos, pi

import numpy as np
from OCP.TopoDS import TopoDS_Shape

from tactcad.checks.on_solids.interference import TOUCH_MM
from tactcad.contour import Contour, circle
from tactcad.parts.language.description import Extrusion, Hole, Material, Part, Pocket, Vector, vector
from tactcad.parts.language.finding import Finding
from tactcad.parts.language.metric import SOCKET_WALL
from tactcad.scenes.moves import FASTENERS, moments
from tactcad.scenes.scene import Placement, Scene, rotation
from tactcad.solids.build import build
from tactcad.solids.measure import Faces, bounding_box, boxed, faces_within, nearest

from ..check import Check

# A key's long arm or a bit with its handle reaches this far from the screw (mm); chosen: a hand needs no
# less.
REACH = 40.0
# The tool begins this far off the faces of its fastener (mm), so that it does not count as touching them.
OFF = 0.05

Known = Callable[[str], tuple[Faces, list[list[float]]]]


def check_tools(scene: Scene, shapes: Mapping[str, TopoDS_Shape]) -> list[Finding]:
    """Findings on every screw and nut that a step of the scene puts in; shapes by part number."""
    placed = {p.designator: p for p in (*scene.placements, *scene.aids)}
    shapes = {**shapes, **{p.part.part_no: build(p.part) for p in scene.aids}}
    known = cache(lambda number: (Faces(shapes[number]), bounding_box(shapes[number])))
    findings: list[Finding] = []
    for moment in moments(scene):
        step, names = scene.steps[moment.step], moment.move.designators
        if len(names) > 1 or names[0] in step.ready or names[0] not in step.designators:
            continue
        fastener = _shifted(placed[names[0]], moment.move.path[-1])
        tool = tool_of(fastener)
        if tool is not None:
            others = [_shifted(placed[name], at) for name, at in moment.standing.items()]
            # all are put in before any is tightened
            coming = (n for n in step.designators if n not in moment.standing and n != names[0])
            others += [_shifted(placed[n], step.at) for n in coming if placed[n].part.kind in FASTENERS]
            findings += _reached(fastener, tool, others, known)
    return findings


def _shifted(p: Placement, by: Vector) -> Placement:
    return replace(p, origin=vector(o + d for o, d in zip(p.origin, by))) if any(by) else p


def _reached(
    fastener: Placement, tool: Placement, others: list[Placement], known: Known
) -> Iterator[Finding]:
    shape, local = _cylinder(tool.part)
    box = boxed(local, np.array(tool.rotation), np.array(tool.origin))
    for other in others:
        faces, other_local = known(other.part.part_no)
        other_box = boxed(other_local, np.array(other.rotation), np.array(other.origin))
        if np.any(box[0] > other_box[1]) or np.any(other_box[0] > box[1]) or _screwed(fastener, other):
            continue
        free, place = nearest(faces_within(shape, tool, other_box, 0.0), faces_within(faces, other, box, 0.0))
        if free < TOUCH_MM:
            message = (
                f"{other.designator} ({other.part.part_no}) is in the way of the {tool.part.name} of "
                f"{REACH:g} mm for {fastener.designator} ({fastener.part.part_no})"
            )
            yield Finding("tool-room", "fail", fastener.designator, place, free, OFF, message)


def _screwed(nut: Placement, other: Placement) -> bool:
    """Whether the other part is the rod in the nut."""
    beside = (np.array(other.origin) - np.array(nut.origin)) @ np.array(nut.rotation)[:, :2]
    return not _socket(nut.part) and bool(np.linalg.norm(beside) < OFF)


@cache
def _cylinder(part: Part) -> tuple[Faces, list[list[float]]]:
    shape = build(part)
    return Faces(shape), bounding_box(shape)


def tool_of(p: Placement) -> Placement | None:
    """The tool at the fastener, pointing away from it; None for parts that no tool turns."""
    socket = _socket(p.part)
    if socket is not None:
        return _placed(p, _round("key", _corners(socket.contour)), socket.at[2] - OFF, -1.0)
    tapped = any(isinstance(f, Hole) and f.thread for f in p.part.features)
    if tapped and isinstance(p.part.body, Extrusion) and len(p.part.body.outer.segments) == 6:
        return _placed(p, _round("socket", _corners(p.part.body.outer) + 2 * SOCKET_WALL), OFF, 1.0)
    return None


def _socket(part: Part) -> Pocket | None:
    return next((f for f in part.features if isinstance(f, Pocket) and f.name == "socket"), None)


def _corners(hexagon: Contour) -> float:
    """Across its corners, mm."""
    x0, y0, x1, y1 = hexagon.box
    return min(x1 - x0, y1 - y0) / cos(pi / 6)


def _round(name: str, diameter: float) -> Part:
    number = f"TOOL-{name}-{diameter:.4f}"
    return Part(
        number, name, "reference", Material("steel", 7850), Extrusion(circle((0, 0), diameter), REACH)
    )


def _placed(p: Placement, tool: Part, z: float, way: float) -> Placement:
    """The tool on the fastener's axis, from its own z on, along z or against it."""
    turn = np.array(p.rotation)
    origin = np.array(p.origin) + turn @ np.array((0.0, 0.0, z))
    name, turned = f"tool at {p.designator}", rotation((turn @ np.diag((1.0, way, way))).tolist())
    return Placement(name, tool, vector(origin.tolist()), turned)


CHECKS = (Check("tools", "scene", lambda scene, job: check_tools(scene, job.shapes), place=20),)
