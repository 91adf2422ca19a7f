"""Do placed parts overlap, and where they meet, was it meant?

Pairs whose boxes are apart are passed over. Of the rest only different situations reach the kernel: two parts
that stand to each other as another pair of the same parts does have the same verdict, and so have two places
of a part along another one that looks the same there (`sliding`), which is what makes long rows cheap.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.TopoDS import TopoDS_Shape

from tactcad.scenes.scene import Contact, Placement, Scene
from tactcad.solids.measure import bounding_box, measure, volume
from tactcad.solids.place import location

from .finding import Finding
from .sliding import stretch, zones

# Solids nearer than this touch (mm); overlaps of less volume are the rounding of touching faces (mm3).
TOUCH_MM = 1e-5
OVERLAP_MM3 = 1e-6


@dataclass(frozen=True)
class Meeting:
    """How two placed parts stand to each other: overlap in mm3, distance in mm, a point of it (mm, in the frame
    of the part `anchor`: 0 the first, 1 the second)."""

    overlap: float
    distance: float
    place: tuple[float, float, float]
    anchor: int


def check_interference(
    scene: Scene, shapes: Mapping[str, TopoDS_Shape], known: dict[tuple, Meeting] | None = None
) -> list[Finding]:
    """Findings on every pair of placed leaves of the scene; shapes by part number, each in its own frame.

    `known` keeps verdicts from scene to scene of one design: an array in a rig is not looked at again.
    """
    meant = {frozenset((c.first, c.second)): c for c in scene.contacts}
    local = {part.part_no: bounding_box(shapes[part.part_no]) for part in scene.parts}
    boxes = np.array([placed_box(p, local[p.part.part_no]) for p in scene.placements])
    changing = {part.part_no: zones(part) for part in scene.parts}
    known = {} if known is None else known
    found = []
    met: set[frozenset[str]] = set()
    for i, j in near_pairs(boxes):
        first, second = scene.placements[i], scene.placements[j]
        key, anchor = _situation(first, second, local, changing)
        if key not in known:
            known[key] = meeting(first, second, shapes, anchor)
        pair = frozenset((first.designator, second.designator))
        if known[key].overlap > OVERLAP_MM3 or known[key].distance < TOUCH_MM:
            met.add(pair)
        found += _verdict(first, second, known[key], meant.get(pair))
    for contact in scene.contacts:
        if frozenset((contact.first, contact.second)) not in met:
            message = f"declared to be in {contact.kind} contact with {contact.second}, but they are apart"
            found.append(Finding("contact", "fail", contact.first, (), 0, 0, message))
    return found


def near_pairs(boxes: np.ndarray) -> Iterator[tuple[int, int]]:
    """Index pairs i < j whose boxes (n, 2, 3) come within TOUCH_MM: a sweep along the longest extent."""
    axis = int(np.argmax(boxes[:, 1].max(axis=0) - boxes[:, 0].min(axis=0)))
    order = np.argsort(boxes[:, 0, axis], kind="stable")
    low, high = boxes[order, 0] - TOUCH_MM, boxes[order, 1] + TOUCH_MM
    pairs = []
    for n in range(len(order)):
        last = int(np.searchsorted(low[:, axis], high[n, axis], side="right"))
        ahead = slice(n + 1, last)
        meets = np.all((low[ahead] <= high[n]) & (high[ahead] >= low[n]), axis=1)
        pairs += [tuple(sorted((int(order[n]), int(order[n + 1 + k])))) for k in np.flatnonzero(meets)]
    return iter(sorted(pairs))


def relative(first: Placement, second: Placement) -> tuple[float, ...]:
    """Second's place as seen from first: rotation and offset, rounded to a picometre."""
    a, b = np.array(first.rotation), np.array(second.rotation)
    offset = a.T @ (np.array(second.origin) - np.array(first.origin))
    return tuple(np.round(np.concatenate([(a.T @ b).ravel(), offset]), 9) + 0.0)


def _situation(
    first: Placement, second: Placement, local: Mapping[str, list], changing: Mapping[str, tuple | None]
) -> tuple[tuple, int]:
    """A key that pairs have in common only where they have one verdict, and which part it is seen from (0, 1).

    Where one part looks the same along an axis around the other one, the place along that axis is left out.
    """
    numbers = (first.part.part_no, second.part.part_no)
    for anchor, (slider, other) in enumerate(((second, first), (first, second))):
        seen = relative(slider, other)
        slides = changing[slider.part.part_no]
        if slides is None:
            continue
        low, high = _boxed(local[other.part.part_no], np.reshape(seen[:9], (3, 3)), np.array(seen[9:]))
        stretches = [stretch(slides[k], low[k], high[k]) for k in range(3)]
        if any(s is not None for s in stretches):
            offset = tuple(("along", s) if s is not None else seen[9 + k] for k, s in enumerate(stretches))
            return (*numbers, anchor, seen[:9], offset), anchor
    return (*numbers, relative(first, second)), 0


def meeting(first: Placement, second: Placement, shapes: Mapping[str, TopoDS_Shape], anchor: int = 0) -> Meeting:
    """What the kernel says of two placed parts; the common volume is asked for only where they touch."""
    a, b = (shapes[p.part.part_no].Located(location(p.origin, p.rotation)) for p in (first, second))
    nearest = BRepExtrema_DistShapeShape(a, b)
    point = nearest.PointOnShape1(1) if nearest.NbSolution() else None
    place = (point.X(), point.Y(), point.Z()) if point else (0.0, 0.0, 0.0)
    distance = nearest.Value()
    if distance > TOUCH_MM:
        return Meeting(0.0, distance, place, anchor)
    common = BRepAlgoAPI_Common(a, b).Shape()
    overlap = volume(common)
    if overlap > OVERLAP_MM3:
        place = tuple(measure(common)["centre"])
    seen_from = (first, second)[anchor]
    there = np.array(seen_from.rotation).T @ (np.array(place) - np.array(seen_from.origin))
    return Meeting(overlap, distance, tuple(map(float, there)), anchor)


def _verdict(first: Placement, second: Placement, m: Meeting, meant: Contact | None) -> list[Finding]:
    kind = meant.kind if meant else ""
    pair = f"{first.designator} ({first.part.part_no}) and {second.designator} ({second.part.part_no})"
    if m.overlap > OVERLAP_MM3 and kind != "thread":
        declared = f", although only {kind} contact is declared" if kind else ""
        return [_finding("overlap", first, second, m, m.overlap, f"{pair} overlap by {m.overlap:.4g} mm3{declared}")]
    if m.overlap <= OVERLAP_MM3 and m.distance < TOUCH_MM and not kind:
        return [_finding("undeclared-touch", first, second, m, m.distance, f"{pair} touch, which the scene does not declare")]
    return []


def _finding(check: str, first: Placement, second: Placement, m: Meeting, value: float, message: str) -> Finding:
    seen_from = (first, second)[m.anchor]
    place = np.array(seen_from.rotation) @ np.array(m.place) + np.array(seen_from.origin)
    return Finding(check, "fail", first.designator, tuple(map(float, place)), value, 0.0, message)


def placed_box(p: Placement, box: list[list[float]]) -> np.ndarray:
    """Box (2, 3) in the scene of a placed part, from its own (least, largest corner)."""
    return _boxed(box, np.array(p.rotation), np.array(p.origin))


def _boxed(box: list[list[float]], rotation: np.ndarray, origin: np.ndarray) -> np.ndarray:
    """Least and largest corner (2, 3) of a box (mm) turned and moved."""
    (x0, y0, z0), (x1, y1, z1) = box
    corners = np.array([(x, y, z) for x in (x0, x1) for y in (y0, y1) for z in (z0, z1)])
    there = corners @ rotation.T + origin
    return np.array([there.min(axis=0), there.max(axis=0)])
