"""Whether placed parts overlap, and whether those that meet are meant to.

Pairs whose boxes are apart are skipped. Of the rest only distinct situations reach the kernel. Pairs of the
same parts in the same relative position have the same verdict. If all of part A near part B stays the same
while B moves along one of A's axes (a rod, a plate's edge, a bar), all these places also have one verdict, by
the descriptions. A long array needs as few verdicts of the kernel as a short one.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.TopoDS import TopoDS_Shape

from tactcad.contour import Contour, Line
from tactcad.parts.language.description import (
    Extrusion,
    Feature,
    Hole,
    Part,
    Revolution,
    drill_point_height,
    vector,
)
from tactcad.parts.language.finding import Finding
from tactcad.scenes.scene import Contact, Placement, Scene, thread_overlap
from tactcad.solids.measure import (
    Faces,
    bounding_box,
    boxed,
    faces_within,
    measure,
    met_at_vertex,
    nearest,
    volume,
)
from tactcad.solids.occt import location

from ..check import Check, Job

# Solids nearer than this touch (mm); overlaps of less volume are the rounding of touching faces (mm3).
TOUCH_MM = 1e-5
OVERLAP_MM3 = 1e-6
# The kernel's volumes agree with closed forms within this share.
VOLUME_AGREES = 1e-6


@dataclass(frozen=True)
class Meeting:
    """Relation of two placed parts: overlap in mm3, distance in mm, a point of it (mm, in the frame of the
    part `anchor`: 0 the first, 1 the second)."""

    overlap: float
    distance: float
    place: tuple[float, float, float]
    anchor: int


def check_interference(
    scene: Scene, shapes: Mapping[str, TopoDS_Shape], known: dict[tuple, Meeting] | None = None
) -> list[Finding]:
    """Findings on every pair of placed parts of a scene that overlap, or touch without being meant to.

    Parameters
    ----------
    scene
        Placements and intended contacts.
    shapes
        By part number, each in its own frame, mm.
    known
        Verdicts from other scenes of the design, extended here: an array in a rig is not measured again.
    """
    meant = {frozenset((c.first, c.second)): c for c in scene.contacts}
    local = {part.part_no: bounding_box(shapes[part.part_no]) for part in scene.parts}
    boxes = np.array([placed_box(p, local[p.part.part_no]) for p in scene.placements])
    faces: dict[str, Faces] = {}
    changing = {part.part_no: zones(part) for part in scene.parts}
    known = {} if known is None else known
    findings = []
    met: set[frozenset[str]] = set()
    for i, j in near_pairs(boxes):
        first, second = scene.placements[i], scene.placements[j]
        key, anchor = _situation(first, second, local, changing)
        if key not in known:
            known[key] = meeting((first, second), (boxes[i], boxes[j]), shapes, faces, anchor)
        pair = frozenset((first.designator, second.designator))
        if known[key].overlap > OVERLAP_MM3 or known[key].distance < TOUCH_MM:
            met.add(pair)
        findings += _verdict(first, second, known[key], meant.get(pair))
    for contact in scene.contacts:
        if frozenset((contact.first, contact.second)) not in met:
            message = f"declared to be in {contact.kind} contact with {contact.second}, but they are apart"
            findings.append(Finding("contact", "fail", contact.first, (), 0, 0, message))
    return findings


def near_pairs(boxes: np.ndarray) -> Iterator[tuple[int, int]]:
    """Index pairs i < j whose boxes (n, 2, 3) come within TOUCH_MM: a sweep along the longest extent."""
    axis = int(np.argmax(boxes[:, 1].max(axis=0) - boxes[:, 0].min(axis=0)))
    order = np.argsort(boxes[:, 0, axis], kind="stable")
    low, high = boxes[order, 0] - TOUCH_MM, boxes[order, 1] + TOUCH_MM
    pairs: list[tuple[int, int]] = []
    for n in range(len(order)):
        last = int(np.searchsorted(low[:, axis], high[n, axis], side="right"))
        ahead = slice(n + 1, last)
        meets = np.all((low[ahead] <= high[n]) & (high[ahead] >= low[n]), axis=1)
        others = order[n + 1 + np.flatnonzero(meets)]
        pairs += [(int(min(order[n], k)), int(max(order[n], k))) for k in others]
    return iter(sorted(pairs))


def relative(first: Placement, second: Placement) -> tuple[float, ...]:
    """Second's place as seen from first: rotation and offset, rounded to a picometre."""
    a, b = np.array(first.rotation), np.array(second.rotation)
    offset = a.T @ (np.array(second.origin) - np.array(first.origin))
    return tuple(np.round(np.concatenate([(a.T @ b).ravel(), offset]), 9) + 0.0)


def _situation(
    first: Placement, second: Placement, local: Mapping[str, list], changing: Mapping[str, tuple | None]
) -> tuple[tuple, int]:
    """A key that two pairs share only if they have the same verdict, and the part (0, 1) whose frame it uses.

    If one part is uniform along an axis around the other one, the place along that axis is left out.
    """
    numbers = (first.part.part_no, second.part.part_no)
    for anchor, (slider, other) in enumerate(((second, first), (first, second))):
        seen = relative(slider, other)
        slides = changing[slider.part.part_no]
        if slides is None:
            continue
        low, high = boxed(local[other.part.part_no], np.reshape(seen[:9], (3, 3)), np.array(seen[9:]))
        stretches = [stretch(slides[k], low[k], high[k]) for k in range(3)]
        if any(s is not None for s in stretches):
            offset = tuple(("along", s) if s is not None else seen[9 + k] for k, s in enumerate(stretches))
            return (*numbers, anchor, seen[:9], offset), anchor
    return (*numbers, relative(first, second)), 0


def meeting(
    pair: tuple[Placement, Placement],
    boxes: tuple[np.ndarray, np.ndarray],
    shapes: Mapping[str, TopoDS_Shape],
    faces: dict[str, Faces],
    anchor: int = 0,
) -> Meeting:
    """The kernel's verdict on a pair of placed parts.

    Touching surfaces are faces that reach the other part's box: only these are measured. One part can contain
    the other without touching it only if its box contains the other's.

    Parameters
    ----------
    pair
        The two placements.
    boxes : two ndarrays, shape (2, 3)
        Their least and largest corners in the scene, mm.
    shapes
        By part number, each in its own frame, mm.
    faces
        By part number; extended by those that are missing.
    anchor
        Index of the part in whose frame the point is given.
    """
    first, second = (
        faces_within(_faces(p, shapes, faces), p, box, TOUCH_MM) for p, box in zip(pair, reversed(boxes))
    )
    distance, place = met_at_vertex(first, second, TOUCH_MM) or nearest(first, second)
    if distance > TOUCH_MM and not (_holds(*boxes) or _holds(*reversed(boxes))):
        return Meeting(0.0, distance, (0.0, 0.0, 0.0), anchor)
    shared = np.minimum(boxes[0][1], boxes[1][1]) - np.maximum(boxes[0][0], boxes[1][0])
    overlap = float(np.prod(np.maximum(shared, 0.0)))  # at most: of their boxes, which layers only touch
    if overlap > OVERLAP_MM3:
        common = BRepAlgoAPI_Common(
            *(shapes[p.part.part_no].Located(location(p.origin, p.rotation)) for p in pair)
        ).Shape()
        overlap = volume(common)
        if overlap > OVERLAP_MM3:
            place = tuple(measure(common)["centre"])
    seen_from = pair[anchor]
    there = np.array(seen_from.rotation).T @ (np.array(place) - np.array(seen_from.origin))
    return Meeting(overlap, distance, vector(there.tolist()), anchor)


def _faces(p: Placement, shapes: Mapping[str, TopoDS_Shape], known: dict[str, Faces]) -> Faces:
    number = p.part.part_no
    if number not in known:
        known[number] = Faces(shapes[number])
    return known[number]


def _holds(outer: np.ndarray, inner: np.ndarray) -> bool:
    return bool(np.all(outer[0] <= inner[0] + TOUCH_MM) and np.all(outer[1] >= inner[1] - TOUCH_MM))


def _verdict(first: Placement, second: Placement, m: Meeting, meant: Contact | None) -> list[Finding]:
    kind = meant.kind if meant else ""

    def _finding(check: str, value: float, message: str, limit: float = 0.0) -> list[Finding]:
        pair = f"{first.designator} ({first.part.part_no}) and {second.designator} ({second.part.part_no})"
        seen_from = (first, second)[m.anchor]
        place = np.array(seen_from.rotation) @ np.array(m.place) + np.array(seen_from.origin)
        at = tuple(map(float, place))
        return [Finding(check, "fail", first.designator, at, value, limit, f"{pair} {message}")]

    if kind == "thread":
        most = thread_overlap(first, second)
        if m.overlap > most * (1 + VOLUME_AGREES) + OVERLAP_MM3:
            message = f"overlap by {m.overlap:.4g} mm3, the thread between them explains {most:.4g} mm3"
            return _finding("thread", m.overlap, message, most)
    elif m.overlap > OVERLAP_MM3:
        declared = f", although only {kind} contact is declared" if kind else ""
        return _finding("overlap", m.overlap, f"overlap by {m.overlap:.4g} mm3{declared}")
    elif m.distance < TOUCH_MM and not kind:
        return _finding("undeclared-touch", m.distance, "touch, which the scene does not declare")
    return []


def placed_box(p: Placement, box: list[list[float]]) -> np.ndarray:
    """Box (2, 3) in the scene of a placed part, from its own (least, largest corner)."""
    return boxed(box, np.array(p.rotation), np.array(p.origin))


# What lies within this distance (mm) of the other part counts as near it: far more than what counts as
# touching.
NEAR_MM = 0.1

Zones = tuple[tuple[float, float], ...]


def zones(part: Part) -> tuple[Zones, Zones, Zones] | None:
    """Along x, y and z of the part's own frame: the intervals (mm) in which its shape changes; merged and
    sorted.

    None if the shape is not known from a description.
    """
    body = part.body
    if isinstance(body, Extrusion):
        contours = (body.outer, *body.openings)
        along = [_along(contours, 0), _along(contours, 1), [(0.0, 0.0), (body.thickness, body.thickness)]]
    elif isinstance(body, Revolution):
        radius = body.profile.box[2]
        along = [[(-radius, radius)], [(-radius, radius)], _along((body.profile,), 1)]
    else:
        return None
    for feature in part.features:
        low, high = feature_box(feature)
        for k in range(3):
            along[k].append((float(low[k]), float(high[k])))
    x, y, z = (_merged(intervals) for intervals in along)
    return x, y, z


def _along(contours: Iterable[Contour], axis: int) -> list[tuple[float, float]]:
    """A line along the axis changes at its ends only; every other segment over its whole extent."""
    intervals = []
    for s in (s for c in contours for s in c):
        if isinstance(s, Line) and s.start[1 - axis] == s.end[1 - axis]:
            intervals += [(s.start[axis], s.start[axis]), (s.end[axis], s.end[axis])]
        elif isinstance(s, Line):
            low, high = sorted((s.start[axis], s.end[axis]))
            intervals.append((low, high))
        else:  # the whole circle: more than the arc, and simple
            intervals.append((s.centre[axis] - s.radius, s.centre[axis] + s.radius))
    return intervals


def feature_box(feature: Feature) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest corner (mm) of a box around a feature's removed material."""
    at, axis = np.array(feature.at, float), np.array(feature.axis, float)
    if isinstance(feature, Hole):
        depth = feature.depth + (drill_point_height(feature.diameter) if feature.drill_point else 0.0)
        radius = max(feature.diameter, feature.counterbore[0] if feature.counterbore else 0.0) / 2
        ends = np.array([at, at + depth * axis])
        across = radius * np.sqrt(np.maximum(0.0, 1.0 - axis**2))  # a disc's reach along each axis
        return ends.min(axis=0) - across, ends.max(axis=0) + across
    x_axis = np.array(feature.x_axis, float)
    y_axis = np.cross(axis, x_axis)
    x0, y0, x1, y1 = feature.contour.box
    corners = np.array(
        [
            at + x * x_axis + y * y_axis + d * axis
            for x in (x0, x1)
            for y in (y0, y1)
            for d in (0.0, feature.depth)
        ]
    )
    return corners.min(axis=0), corners.max(axis=0)


def _merged(intervals: Sequence[tuple[float, float]]) -> Zones:
    merged: list[tuple[float, float]] = []
    for low, high in sorted(intervals):
        if merged and low <= merged[-1][1]:
            merged[-1] = (merged[-1][0], max(merged[-1][1], high))
        else:
            merged.append((low, high))
    return tuple(merged)


def stretch(along: Zones, low: float, high: float) -> int | None:
    """Stretch between zones that holds low to high with a margin of NEAR_MM (mm); None if a zone is near."""
    n = bisect_left(along, (low - NEAR_MM, -np.inf))
    before = along[n - 1][1] < low - NEAR_MM if n else True
    after = along[n][0] > high + NEAR_MM if n < len(along) else True
    return n if before and after else None


def _pairs(scene: Scene, job: Job) -> list[Finding]:
    return check_interference(scene, job.shapes, job.meetings)


CHECKS = (Check("interference", "scene", _pairs, place=10), Check("configurations", "pose", _pairs, place=10))
