"""Whether placed parts overlap, and whether those that meet are meant to.

Pairs whose boxes are apart are skipped. Of the rest only distinct situations reach the kernel. Pairs of the
same parts in the same relative position have the same verdict. So have pairs where all of part A near part B
is described alike: B along a rod, a bar or a plate's edge, in one opening of a sheet or the next. An array of
many elements needs as few verdicts of the kernel as one of a few.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.TopoDS import TopoDS_Shape

from tactcad.contour import Arc, Line, Segment
from tactcad.contour.inside import side
from tactcad.contour.nearest import box_around
from tactcad.parts.language.description import (
    Extrusion,
    Feature,
    Hole,
    Part,
    Revolution,
    Vector,
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
    """Relation of two placed parts: overlap in mm3, distance in mm, a point of it, mm."""

    overlap: float
    distance: float
    place: Vector


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
    around = {part.part_no: Surroundings(part) for part in scene.parts}
    known = {} if known is None else known
    findings = []
    met: set[frozenset[str]] = set()
    for i, j in near_pairs(boxes):
        first, second = scene.placements[i], scene.placements[j]
        situations = [*_situations((first, second), local, around)]
        found = next(
            (replace(m, place=_in_scene(p, m.place)) for key, p in situations if (m := known.get(key))), None
        )
        if found is None:
            found = meeting((first, second), (boxes[i], boxes[j]), shapes, faces)
            known |= {key: replace(found, place=_seen_from(p, found.place)) for key, p in situations}
        pair = frozenset((first.designator, second.designator))
        if found.overlap > OVERLAP_MM3 or found.distance < TOUCH_MM:
            met.add(pair)
        findings += _verdict(first, second, found, meant.get(pair))
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


def _in_scene(p: Placement, point: Vector) -> Vector:
    return vector((np.array(p.rotation) @ np.array(point) + np.array(p.origin)).tolist())


def _seen_from(p: Placement, point: Vector) -> Vector:
    return vector((np.array(p.rotation).T @ (np.array(point) - np.array(p.origin))).tolist())


def _situations(
    pair: tuple[Placement, Placement], local: Mapping[str, list], around: Mapping[str, Surroundings]
) -> Iterator[tuple[tuple, Placement]]:
    """Keys that two pairs share only if they have the same verdict, each with the part in whose frame its
    point is: by what of one part lies near the other one, or else by their relative position."""
    numbers, told = tuple(p.part.part_no for p in pair), False
    for n, (other, bounds) in enumerate(zip(pair, (around[number] for number in reversed(numbers)))):
        seen = relative(pair[1 - n], other)
        box = boxed(local[other.part.part_no], np.reshape(seen[:9], (3, 3)), np.array(seen[9:]))
        if (near := bounds.near(box, np.array(seen[9:]))) is not None:
            told = True
            yield (*numbers, n, seen[:9], near), other
    if not told:
        yield (*numbers, relative(*pair)), pair[0]


def meeting(
    pair: tuple[Placement, Placement],
    boxes: tuple[np.ndarray, np.ndarray],
    shapes: Mapping[str, TopoDS_Shape],
    faces: dict[str, Faces],
) -> Meeting:
    """The kernel's verdict on a pair of placed parts, its point in the scene.

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
    """
    first, second = (
        faces_within(_faces(p, shapes, faces), p, box, TOUCH_MM) for p, box in zip(pair, reversed(boxes))
    )
    distance, place = met_at_vertex(first, second, TOUCH_MM) or nearest(first, second)
    if distance > TOUCH_MM and not (_holds(*boxes) or _holds(*reversed(boxes))):
        return Meeting(0.0, distance, (0.0, 0.0, 0.0))
    shared = np.minimum(boxes[0][1], boxes[1][1]) - np.maximum(boxes[0][0], boxes[1][0])
    overlap = float(np.prod(np.maximum(shared, 0.0)))  # at most: of their boxes, which layers only touch
    if overlap > OVERLAP_MM3:
        common = BRepAlgoAPI_Common(
            *(shapes[p.part.part_no].Located(location(p.origin, p.rotation)) for p in pair)
        ).Shape()
        overlap = volume(common)
        if overlap > OVERLAP_MM3:
            place = tuple(measure(common)["centre"])
    return Meeting(overlap, distance, place)


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
        return [Finding(check, "fail", first.designator, m.place, value, limit, f"{pair} {message}")]

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
SOMEWHERE = np.array([0.437, 0.561, 0.5])  # of a box's sides; chosen: drawn edges hardly pass there


class Surroundings:
    """What bounds a described part: segments of its contours or of its turned profile, and its features, each
    with a box around it, in the part's own frame, mm."""

    def __init__(self, part: Part) -> None:
        self.body = body = part.body
        segments: list[Segment] = []
        boxes: list = []
        if isinstance(body, Extrusion):
            segments = [s for contour in (body.outer, *body.openings) for s in contour]
            boxes = [((x, y, 0.0), (u, v, body.thickness)) for x, y, u, v in map(box_around, segments)]
        elif isinstance(body, Revolution):
            r, segments = body.profile.box[2], [*body.profile]
            boxes = [((-r, -r, z), (r, r, w)) for _, z, _, w in map(box_around, segments)]
        self.pieces: list[Segment | Feature] = [*segments, *part.features]
        self.boxes = np.array([*boxes, *map(feature_box, part.features)])

    def near(self, box: np.ndarray, at: np.ndarray) -> tuple | None:
        """All that bounds the part in a box (2, 3) and NEAR_MM around it, as seen from a point, mm; a line
        along an axis as far as there. None if the part is not described, or SOMEWHERE in the box is an edge.
        """
        low, high = np.array(box) + [[-NEAR_MM], [NEAR_MM]]
        body = self.body
        if isinstance(body, Extrusion):
            point = tuple((low + SOMEWHERE * (high - low))[:2].tolist())
            where = [side(c, point) for c in (body.outer, *body.openings) if _spans(c.box, point)]
            if 0 in where:
                return None
            # that point is outside (0), in material (1) or in an opening (2)
            rest = (where.count(1), *(np.clip((0.0, body.thickness), low[2], high[2]) - at[2]))
            plane = np.array([low[:2], high[:2], at[:2]])
        elif isinstance(body, Revolution):
            rest = tuple(at[:2])
            plane = np.array([(-np.inf, low[2]), (np.inf, high[2]), (0.0, at[2])])
        else:
            return None
        close = np.flatnonzero(np.all((self.boxes[:, 0] <= high) & (self.boxes[:, 1] >= low), axis=1))
        found: list = [_told(rest)]
        for piece in (self.pieces[i] for i in close):
            if isinstance(piece, (Line, Arc)):
                found.append(_segment(piece, *plane))
            else:
                found.append(replace(piece, at=_told(np.array(piece.at) - at)))
        return tuple(found)


def _spans(box: tuple[float, float, float, float], point: tuple[float, ...]) -> bool:
    return box[0] <= point[0] <= box[2] and box[1] <= point[1] <= box[3]


def _segment(s: Segment, low: np.ndarray, high: np.ndarray, at: np.ndarray) -> tuple:
    """A segment as seen from a point, a line along an axis within limits only."""
    ends = np.array([s.start, s.end])
    if isinstance(s, Arc):
        return (*_told((*(ends - at).ravel(), *(s.centre - at))), s.ccw)
    across = ends[0] == ends[1]
    return _told((np.where(across[::-1], np.clip(ends, low, high), ends) - at).ravel())


def _told(values: np.ndarray | tuple) -> tuple:
    """Rounded to a picometre."""
    return tuple((np.round(values, 9) + 0.0).tolist())


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


def _pairs(scene: Scene, job: Job) -> list[Finding]:
    return check_interference(scene, job.shapes, job.meetings)


CHECKS = (Check("interference", "scene", _pairs, place=10), Check("configurations", "pose", _pairs, place=10))
