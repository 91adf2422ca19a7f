"""The array as a mechanism: who stands where, what moves, what holds what, and whether it can be put
together."""

from __future__ import annotations

import json
from math import cos, sin
from pathlib import Path

import numpy as np
import pytest
from variants import variant

from tactcad.contour import Arc
from tactcad.drawing.engine.boxes import placed
from tactcad.parts.array.layout import Layout
from tactcad.parts.language.description import Hole
from tactcad.parts.language.metric import METRIC
from tactcad.scenes import chosen_scenes, make_scene, overall_size, scene_names
from tactcad.scenes.scene import Placement, Scene

GOLDEN = Path(__file__).parents[2] / "exports" / "golden"
# Table 1's arm lengths by element number; no. 5 did not work and is not given.
PUBLISHED = {1: 4, 2: 7, 3: 6, 4: 8, 6: 8, 7: 5, 8: 4, 9: 5, 10: 7}

DESIGNS = {
    "macro": variant(),
    "soft": variant({}, base="soft-tissue"),
    "one element": variant({"array.row_arms": [[4]]}),
    "uneven rows": variant({"array.row_arms": [[4, 7, 6], [5]]}),
    "tie rods": variant({"array.row_arms": [[4, 5] * 6, [6] * 11]}),
}


@pytest.fixture(params=DESIGNS, scope="module")
def case(request):
    design = DESIGNS[request.param]
    return design, Layout(design), make_scene(design, "array")


def by_name(scene: Scene) -> dict[str, Placement]:
    return {p.designator: p for p in scene.placements}


def elements(scene: Scene) -> dict[int, Placement]:
    return {
        int(p.designator[1:]): p
        for p in scene.placements
        if p.designator[0] == "E" and p.designator[1:].isdigit()
    }


def direction(p: Placement, v) -> np.ndarray:
    return np.array(p.rotation) @ np.array(v, float)


def box(p: Placement) -> np.ndarray:
    """Least and largest corner of the placed part's box."""
    (x0, y0, z0), (x1, y1, z1) = p.part.body.box
    corners = np.array([placed(p, (x, y, z)) for x in (x0, x1) for y in (y0, y1) for z in (z0, z1)])
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def apart(a: np.ndarray, b: np.ndarray, gap: float = 1e-6) -> bool:
    return bool(np.any(a[0] >= b[1] - gap) or np.any(b[0] >= a[1] - gap))


def test_designators_are_table_1s():
    scene = make_scene(DESIGNS["macro"], "array")
    arms = {
        n: float(p.part.part_no.rsplit("-a", 1)[1].removesuffix("mm")) for n, p in elements(scene).items()
    }
    assert sorted(arms) == list(range(1, 11))
    assert {n: arms[n] for n in PUBLISHED} == PUBLISHED
    assert [
        p.designator for p in scene.placements if p.designator.startswith("E") and p.designator[1:].isdigit()
    ] == [f"E{n}" for n in (1, 2, 3, 4, 5, 6, 7, 8, 9, 10)]


def test_rotations_are_rotations(case):
    _, _, scene = case
    for p in scene.placements:
        r = np.array(p.rotation, float)
        assert np.allclose(r @ r.T, np.eye(3), atol=1e-12) and np.linalg.det(r) == pytest.approx(1.0)


def test_pads_are_coplanar_at_their_pitch_and_face_each_other(case):
    design, _, scene = case
    e = design.element
    centres = {}
    for n, p in elements(scene).items():
        x0, z0, _, _ = p.part.body.outer.box
        face = p.part.body.outer.named("pad_face")
        ends = [placed(p, (*end, z)) for end in (face.start, face.end) for z in (0.0, design.sheet.thickness)]
        assert {round(v[2], 9) for v in ends} == {-e.pad_height}
        xs, ys = [v[0] for v in ends], [v[1] for v in ends]
        assert max(xs) - min(xs) == pytest.approx(e.pad_length)
        assert max(ys) - min(ys) == pytest.approx(design.sheet.thickness)
        centres[n] = ((max(xs) + min(xs)) / 2, (max(ys) + min(ys)) / 2)
    rows = design.array.row_arms
    number = 0
    for row, arms in enumerate(rows):
        side = 1 if row == 0 else -1
        for i in range(len(arms)):
            number += 1
            x, y = centres[number]
            assert x == pytest.approx(side * design.array.row_pitch / 2)
            if i:
                assert y - centres[number - 1][1] == pytest.approx(design.array.pitch)
    if len(rows) == 2:
        for i in range(min(len(rows[0]), len(rows[1]))):
            assert centres[1 + i][1] == pytest.approx(centres[1 + len(rows[0]) + i][1]), (
                "facing pads are in line"
            )


def test_every_arm_is_free_to_close_its_gap_and_no_further(case):
    """The arm turned rigidly about its hinge until the land meets the stop plate: everything else keeps
    clear."""
    design, layout, scene = case
    found = by_name(scene)
    facing = design.array.row_pitch - design.element.pad_length
    for place in layout.elements:
        p = found[place.designator]
        contour, (hx, hz) = p.part.body.outer, (place.hinge_x, place.hinge.t / 2)
        gap = next(c.nominal for c in p.part.characteristics if c.name == "stop gap")
        turn = -gap / place.arm  # tip away from the object, +z
        arm = [
            s.at(k / 8)
            for s in contour
            for k in range(9 if isinstance(s, Arc) else 2)
            if s.at(k / 8 if isinstance(s, Arc) else k)[0] < hx - place.hinge.l / 2 + 1e-9
        ]
        moved = [
            (
                hx + (x - hx) * cos(turn) - (z - hz) * sin(turn),
                hz + (x - hx) * sin(turn) + (z - hz) * cos(turn),
            )
            for x, z in arm
        ]
        top = max(z for _, z in moved)
        assert top == pytest.approx(layout.ledge, abs=0.02 * gap + 0.1 * gap * place.hinge.h / place.arm)
        # the slot stays open, and the facing pads apart even if both turn
        wall = max(x for (x, z), (x0, _) in zip(moved, arm) if x0 > hx - place.hinge.l)
        assert wall < hx + place.hinge.l / 2 - 0.05
        assert min(x for x, _ in moved) > layout.pad_inner - facing / 2 + 1e-3
    # neighbours: a spacer apart, and nothing else of the scene reaches into the arms' room
    room = {n: box(p) for n, p in elements(scene).items()}
    others = [p for p in scene.placements if p.designator not in {f"E{n}" for n in room}]
    for n, b in room.items():
        arm_room = b.copy()
        side = 1 if scene_row(layout, n) == 1 else -1
        edge = side * layout.elements[n - 1].hinge_x
        arm_room[:, 0] = sorted((side * layout.pad_inner / 2, edge))
        arm_room[1, 2] = layout.ledge - 1e-6
        arm_room[0, 1] -= layout.spacer / 2
        arm_room[1, 1] += layout.spacer / 2
        for other in others:
            assert apart(arm_room, box(other)), f"{other.designator} in the room of E{n}'s arm"


def scene_row(layout: Layout, number: int) -> int:
    return layout.elements[number - 1].row


def test_wires_leave_along_the_recess_to_the_outside(case):
    """From behind the gauge to the rear end and beyond, under every element: nothing else stands there."""
    design, layout, scene = case
    e = design.element
    boxes = {p.designator: box(p) for p in scene.placements}
    for place in layout.elements:
        side = 1 if place.row == 1 else -1
        xs = sorted((side * layout.recess_start, side * (layout.rear_end + 50)))
        half = design.sheet.thickness / 2
        channel = np.array([[xs[0], place.y - half, -e.pad_height], [xs[1], place.y + half, e.recess_depth]])
        for name, b in boxes.items():
            if name != place.designator:
                assert apart(channel, b), f"{name} in the channel of {place.designator}"
        # the element itself is above it
        contour = boxes[place.designator]
        assert contour[1][2] > e.recess_depth
        gauge_end = place.hinge_x + design.gauge.carrier_body_side
        assert gauge_end <= layout.recess_start + 1e-9, "leads start where the recess does"


def axis_of(p: Placement) -> tuple[np.ndarray, np.ndarray]:
    """A point on a revolved or drilled part's own axis, and its direction."""
    return np.array(p.origin), direction(p, (0, 0, 1))


def holes_of(p: Placement) -> list[tuple[Hole | None, np.ndarray, np.ndarray, float]]:
    """Feature (None for wire-cut openings), a point of the axis, its direction, and the diameter, in the
    scene."""
    found = []
    for f in p.part.features:
        if isinstance(f, Hole):
            found.append((f, np.array(placed(p, f.at)), direction(p, f.axis), f.diameter))
    for opening in getattr(p.part.body, "openings", ()):
        (x, y), r = opening.as_circle()
        found.append((None, np.array(placed(p, (x, y, 0.0))), direction(p, (0, 0, 1)), 2 * r))
    return found


def in_line(point, axis, other_point, other_axis) -> bool:
    parallel = np.allclose(np.cross(axis, other_axis), 0, atol=1e-9)
    off = np.cross(np.array(other_point) - np.array(point), axis)
    return parallel and bool(np.linalg.norm(off) < 1e-9)


def test_every_thread_contact_is_a_screw_in_line_with_a_thread_deep_enough(case):
    design, _, scene = case
    found = by_name(scene)
    threads = [c for c in scene.contacts if c.kind == "thread"]
    assert threads
    for contact in threads:
        screw, tapped = found[contact.first], found[contact.second]
        point, axis = axis_of(screw)
        if tapped.designator.startswith("NU"):
            assert in_line(point, axis, *axis_of(tapped))
            continue
        fitting = [h for h in holes_of(tapped) if in_line(point, axis, h[1], h[2]) and h[0] and h[0].thread]
        assert len(fitting) == 1, f"{contact.first} in {contact.second}"
        hole, at, into, _ = fitting[0]
        d = METRIC[hole.thread].d
        assert hole.thread == design.clamp.screw
        # engaged length along the hole's axis, of the screw's shank in the full thread
        (_, _, z0), (_, _, z1) = screw.part.body.box
        ends = [float((np.array(placed(screw, (0, 0, z))) - at) @ into) for z in (max(z0, 0.0), z1)]
        tip, ends = ends[1], sorted(ends)
        engaged = min(ends[1], hole.thread_depth) - max(ends[0], 0.0)
        assert engaged >= 1.5 * d - 1e-9, f"{contact.first}: {engaged} mm"
        if contact.second.startswith("EP"):
            assert -1e-9 <= tip <= hole.depth + 1e-9, (
                "a screw stands out of the end plate, or bottoms in its hole"
            )


def test_screws_and_dowels_pass_through_every_part_of_their_row(case):
    """Each stacked part has a hole in line with each of its row's screws and dowels: they locate each
    other."""
    design, layout, scene = case
    through = [p for p in scene.placements if p.designator[:2] in ("DW", "TR")]
    through += [
        p for p in scene.placements if p.designator.startswith("SC") and abs(direction(p, (0, 0, 1))[1]) > 0.9
    ]
    assert len(through) == 2 * (len(design.holes.screw_offsets) + len(design.holes.dowel_offsets))
    stacked = [
        p
        for p in scene.placements
        if p.designator[0] == "E" and p.designator[1:].isdigit() or p.designator[:2] in ("SP", "BL")
    ]
    for rod in through:
        point, axis = axis_of(rod)
        diameter = rod.part.body.box[1][0] * 2 if rod.designator[:2] != "SC" else METRIC[design.clamp.screw].d
        row = [p for p in stacked if direction(p, (1, 0, 0))[0] * point[0] > 0]
        assert len(row) == 2 * layout.positions + 1
        for p in [*row, *(q for q in scene.placements if q.designator in ("EP1", "EP2"))]:
            (hole,) = [h for h in holes_of(p) if in_line(point, axis, h[1], h[2])]
            if rod.designator.startswith("DW"):
                play = hole[3] - diameter
                assert 0 <= play < 0.12 if p.designator != "EP2" else play == pytest.approx(0, abs=1e-9)
            elif p.designator != "EP2":
                assert hole[3] > diameter
    for rod in through:
        b, ends = box(rod), (layout.stack / 2, -layout.stack / 2)
        assert b[1][1] > ends[0] and b[0][1] < ends[1], f"{rod.designator} reaches both end plates"


def test_end_plates_join_both_rows_and_everything_rests_on_something(case):
    _, layout, scene = case
    linked = {p.designator: {p.designator} for p in scene.placements}
    for c in scene.contacts:
        whole = linked[c.first] | linked[c.second]
        for name in whole:
            linked[name] = whole
    # screws' and dowels' slide fits leave nothing but contacts: one assembly, no loose part
    assert linked["EP1"] == set(linked)
    half = layout.end_plate_half
    for name in ("EP1", "EP2"):
        b = box(by_name(scene)[name])
        assert b[0][0] == pytest.approx(-half) and b[1][0] == pytest.approx(half)


def test_the_stop_plate_lies_on_every_ledge_under_set_screws_that_stand_on_it(case):
    design, layout, scene = case
    found = by_name(scene)
    plate = box(found["ST1"])
    for n, p in elements(scene).items():
        ledge = p.part.body.outer.named("ledge")
        xs = sorted(placed(p, (*end, 0.0))[0] for end in (ledge.start, ledge.end))
        ys = sorted(placed(p, (0.0, 0.0, z))[1] for z in (0.0, design.sheet.thickness))
        along = min(xs[1], plate[1][0]) - max(xs[0], plate[0][0])
        across = min(ys[1], plate[1][1]) - max(ys[0], plate[0][1])
        assert along >= 0.5 - 1e-9 and across >= design.sheet.thickness / 2 - 1e-9, (
            f"E{n} carries no stop plate"
        )
    point = METRIC[design.clamp.screw].set_point / 2
    for p in scene.placements:
        if p.designator.startswith("SS"):
            x, y, _ = p.origin
            assert plate[0][0] <= x - point and x + point <= plate[1][0]
            assert plate[0][1] <= y - point and y + point <= plate[1][1]


def test_a_screwdriver_reaches_every_screw_when_it_goes_in(case):
    """A cylinder of the head's width from the head outwards, 60 mm long, meets nothing that stands by
    then."""
    design, _, scene = case
    m = METRIC[design.clamp.screw]
    boxes = [(p.designator, box(p)) for p in scene.placements]
    for i, p in enumerate(scene.placements):
        kind = p.designator[:2]
        if kind not in ("SC", "SS", "NU"):
            continue
        outwards = -direction(p, (0, 0, 1)) if kind != "NU" else direction(p, (0, 0, 1))
        top = np.array(p.origin) + outwards * {"SC": m.head_height, "SS": 0.0, "NU": m.nut_height}[kind]
        wide = {"SC": m.head, "SS": m.set_key, "NU": m.nut * 1.2}[kind] / 2
        far = top + 60 * outwards
        room = np.array([np.minimum(top, far), np.maximum(top, far)])
        across = np.abs(outwards) < 0.5
        room[0][across] -= wide
        room[1][across] += wide
        own = {"SC": ("EP1", "CA1"), "SS": ("CA1",), "NU": ("TR",)}[
            kind
        ]  # its own counterbore, thread or rod
        for name, b in boxes[:i]:
            assert apart(room, b) or name.startswith(own), f"{name} bars the way to {p.designator}"


def test_a_guide_sends_nobody_to_a_scene_that_is_not_there():
    """Two rows of twelve are too long for the calibration's stages."""
    for name, there in (("macro", True), ("tie rods", False)):
        design = DESIGNS[name]
        assert ("calibration" in scene_names(design)) == there
        texts = [s.text for scene in ("array", "setting") for s in make_scene(design, scene).steps]
        assert any("calibrat" in text for text in texts) == there


def test_counts_by_hand():
    for name, screws, rods in (("macro", 8, 0), ("one element", 8, 0), ("tie rods", 4, 4)):
        design = DESIGNS[name]
        scene = make_scene(design, "array")
        rows = design.array.row_arms
        n = max(map(len, rows))
        count = {
            kind: sum(p.designator.startswith(kind) for p in scene.placements)
            for kind in ("SP", "BL", "SC", "TR", "NU", "DW", "EP", "ST", "CA")
        }
        assert count == {
            "SP": 2 * (n + 1),
            "BL": 2 * n - sum(map(len, rows)),
            "SC": screws,
            "TR": rods,
            "NU": 2 * rods,
            "DW": 2,
            "EP": 2,
            "ST": 1,
            "CA": 1,
        }
        assert len(elements(scene)) == sum(map(len, rows))


def test_the_cover_hides_the_elements_and_can_be_taken_off(case):
    _, _, scene = case
    names = {p.designator for p in scene.placements}
    assert scene.cover <= names and {"ST1", "CA1"} <= scene.cover
    assert not scene.cover & {f"E{n}" for n in elements(scene)}
    assert not any(d.startswith(("SP", "BL")) for d in scene.cover)


def test_scenes_of_a_design_are_known_and_unknown_ones_refused():
    from tactcad.design.messages import InputError

    design = DESIGNS["macro"]
    assert "array" in scene_names(design)
    assert chosen_scenes(design, ["array", "array"]) == ("array",)
    assert chosen_scenes(design, None) == scene_names(design)
    with pytest.raises(InputError, match="no such scene"):
        chosen_scenes(design, ["array", "moon"])


def test_a_scene_refuses_double_names_and_unlike_parts_of_one_number():
    scene = make_scene(DESIGNS["one element"], "array")
    first = scene.placements[0]
    with pytest.raises(ValueError, match="not unique"):
        Scene("x", (first, first))
    from dataclasses import replace

    other = replace(first, designator="Z", part=replace(first.part, finish="painted"))
    with pytest.raises(ValueError, match="share the number"):
        Scene("x", (first, other))


@pytest.mark.parametrize("name", ["macro-array", "soft-tissue"])
def test_overall_size_is_what_the_kernel_measured(name):
    """The golden file keeps every part's box as the kernel measured it, and where each stands."""
    golden = json.loads((GOLDEN / f"{name}.json").read_text("utf-8"))
    corners = []
    for p in golden["scenes"]["array"]["placed"].values():
        box = np.array(golden["parts"][p["part_no"]]["box_mm"])
        corners += list(box @ np.array(p["rotation"]).T + np.array(p["origin_mm"]))
    assert overall_size(variant({}, base=name)) == pytest.approx(np.ptp(corners, axis=0), abs=1e-6)
