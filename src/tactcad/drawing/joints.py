"""How placed parts come off each other: read off a scene's contacts and the parts' boxes, without a kernel.

A screw leaves its thread along its own axis, on the side of its head; so does any turned part that stands in
a hole. Other parts leave normal to the faces at which they meet, or else the shortest way out of each other's
boxes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tactcad.parts.description import Revolution
from tactcad.scenes.scene import Contact, Placement

from .extent import box_corners, part_box, placed

TOUCH = 0.01  # mm: boxes that overlap by no more meet face to face

Extent = np.ndarray  # least and largest corner, (2, 3), mm


@dataclass(frozen=True)
class Joint:
    """Part `upper` comes off part `lower` (designators) in the positive direction of an axis (0, 1, 2)."""

    lower: str
    upper: str
    axis: int


def box_of(p: Placement) -> Extent:
    """Of a placed part, in the scene; exact where it is not turned by odd angles."""
    corners = np.array([placed(p, corner) for corner in box_corners(part_box(p.part))])
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def joints_of(placements: Sequence[Placement], contacts: Sequence[Contact]) -> list[Joint]:
    """A joint for each contact. Parts of one number that meet, such as weights on each other, have none."""
    at = {p.designator: p for p in placements}
    boxes = {name: box_of(p) for name, p in at.items()}
    leaving = {
        c.first: way
        for c in contacts
        if c.kind == "thread"
        and (way := _out_of_thread(at[c.first], boxes[c.first], boxes[c.second])) is not None
    }
    joints = []
    for c in contacts:
        if at[c.first].part.part_no == at[c.second].part.part_no:
            continue
        screw = next((name for name in (c.first, c.second) if name in leaving), None)
        if screw:
            axis, sign = leaving[screw]
            pair = (c.first if screw == c.second else c.second, screw)
        else:
            axis, sign = way_off(at[c.first], at[c.second], boxes)
            pair = (c.first, c.second)
        joints.append(Joint(*(pair if sign > 0 else pair[::-1]), axis))
    return joints


def way_off(first: Placement, second: Placement, boxes: Mapping[str, Extent]) -> tuple[int, int]:
    """Axis and sign along which the second part comes off the first."""
    a, b = boxes[first.designator], boxes[second.designator]
    ways = np.array([a[1] - b[0], b[1] - a[0]])  # distance to go, up and down, along each axis
    axis = int(ways.min(axis=0).argmin())
    if ways[:, axis].min() > TOUCH:
        turned = [k for p in (first, second) if (k := axis_of(p)) is not None and _inside(a, b, k)]
        axis = turned[-1] if turned else axis
    return axis, 1 if ways[0, axis] <= ways[1, axis] else -1


def axis_of(p: Placement) -> int | None:
    """The scene's axis that is the axis of a turned part."""
    if not isinstance(p.part.body, Revolution):
        return None
    return int(np.abs([row[2] for row in p.rotation]).argmax())


def _out_of_thread(screw: Placement, its_box: Extent, into: Extent) -> tuple[int, int] | None:
    """Axis and sign along which a screw leaves its thread; None where the part is not a turned one."""
    axis = axis_of(screw)
    return None if axis is None else (axis, 1 if its_box[:, axis].sum() > into[:, axis].sum() else -1)


def _inside(a: Extent, b: Extent, axis: int) -> bool:
    """Whether one's section across the axis lies inside the other's."""
    across = [k for k in range(3) if k != axis]
    return any(
        (p[0, across] >= q[0, across] - TOUCH).all() and (p[1, across] <= q[1, across] + TOUCH).all()
        for p, q in ((a, b), (b, a))
    )
