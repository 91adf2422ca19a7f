"""The pairs with known verdicts are what they say, and wrong verdicts are counted as such."""

from __future__ import annotations

from collections import Counter
from itertools import product
from math import pi, sqrt

import numpy as np
import pytest
from bench_geometry import Prepared, count_wrong, kernel_verdict, mesh_verdict, volume
from known_pairs import GAPS, KINDS, known_pairs, lens
from scipy.integrate import quad

from tactcad.parts.language.description import Extrusion

PAIRS = list(known_pairs(2, seed=5))


@pytest.mark.parametrize(
    "r, s, d", [(1.0, 1.0, 1.0), (2.0, 0.7, 1.9), (1.0, 3.0, 2.5), (1.0, 1.0, 1.99999), (2.0, 2.0, 1e-3)]
)
def test_the_area_of_two_circles_is_the_integral(r, s, d):
    def common(x: float) -> float:
        heights = [sqrt(max(q * q - (x - c) ** 2, 0.0)) for q, c in ((r, 0.0), (s, d))]
        return 2 * min(heights)

    crossing = (d * d + r * r - s * s) / (2 * d)
    assert lens(r, s, d) == pytest.approx(
        quad(common, max(-r, d - s), min(r, d + s), points=[crossing], limit=200)[0], rel=1e-6
    )


def test_circles_apart_inside_and_equal():
    assert (
        lens(1.0, 2.0, 3.0) == 0.0
        and lens(1.0, 2.0, 0.9) == pi
        and lens(1.5, 1.5, 0.0) == pytest.approx(pi * 2.25)
    )


def test_every_kind_at_every_gap_in_every_round():
    assert Counter((p.kind, p.gap) for p in PAIRS) == {key: 2 for key in product(KINDS, GAPS)}
    assert all((p.overlap > 1e-6) == (p.gap < 0) for p in PAIRS), (
        "an overlap that the check's limit would let pass proves nothing"
    )
    assert len({p.placements[0].rotation for p in PAIRS}) == len(PAIRS)


def test_turns_are_turns():
    for place in (place for pair in PAIRS for place in pair.placements):
        q = np.array(place.rotation)
        assert np.allclose(q @ q.T, np.eye(3), atol=1e-12) and np.linalg.det(q) == pytest.approx(1.0)


def inside(part, points: np.ndarray) -> np.ndarray:
    """Which points lie in an extruded rectangle or circle with circular openings; its own definition of a
    solid."""
    body: Extrusion = part.body
    x, y, z = points.T

    def within(contour):
        round_ = contour.as_circle()
        if round_:
            (cx, cy), radius = round_
            return (x - cx) ** 2 + (y - cy) ** 2 < radius**2
        x0, y0, x1, y1 = contour.box
        return (x0 < x) & (x < x1) & (y0 < y) & (y < y1)

    return (
        within(body.outer)
        & (z > 0)
        & (z < body.thickness)
        & ~np.any([within(c) for c in body.openings] or [x != x], axis=0)
    )


@pytest.mark.parametrize("pair", [p for p in PAIRS if p.gap == -0.1][:4], ids=lambda p: p.kind)
def test_the_common_volume_is_the_share_of_random_points(pair):
    """Points in the first part's box: 4 standard deviations."""
    a, b = pair.placements
    box = a.part.body.outer.box
    low, high = np.array([*box[:2], 0.0]), np.array([*box[2:], a.part.body.thickness])
    local = np.random.default_rng(1).uniform(low, high, (200_000, 3))
    scene = local @ np.array(a.rotation).T + np.array(a.origin)
    other = (scene - np.array(b.origin)) @ np.array(b.rotation)
    share = np.mean(inside(a.part, local) & inside(b.part, other))
    size = np.prod(high - low)
    assert pair.overlap == pytest.approx(share * size, abs=4 * size * sqrt(share / 2e5))


def test_wrong_verdicts_are_counted_by_kind():
    true = ["overlap", "overlap", "touch", "touch", "clear", "clear"]
    assert count_wrong(true, true) == {"wrong": 0, "missed": 0, "false": 0, "others": 0}
    found = ["overlap", "clear", "overlap", "clear", "overlap", "touch"]
    assert count_wrong(found, true) == {"wrong": 5, "missed": 1, "false": 2, "others": 2}


def prepared(pair, *angular) -> Prepared:
    made = Prepared()
    for p in pair.placements:
        made.add(p.part, angular, {})
    return made


@pytest.mark.cad
def test_the_kernel_knows_them_all_and_its_volume_is_the_closed_form():
    from tactcad.checks.on_solids.interference import meeting, placed_box

    for pair in PAIRS[::7]:  # every kind, every gap at some kind
        made = prepared(pair)
        assert kernel_verdict(pair.placements, made) == pair.verdict, (pair.kind, pair.gap)
        boxes = tuple(placed_box(p, made.boxes[p.part.part_no]) for p in pair.placements)
        overlap = meeting(pair.placements, boxes, made.shapes, made.faces).overlap
        assert overlap == pytest.approx(pair.overlap, rel=1e-4, abs=1e-7)


@pytest.mark.cad
def test_flat_faced_meshes_are_exact_and_round_ones_miss_what_is_thinner_than_their_chords():
    """At 0.5 rad a chord of a radius r stands r (1 - cos 0.25) off: 0.03 r. A pin's overlap of 0.1 um is lost
    in that."""
    wrong = Counter()
    for pair in PAIRS:
        made = prepared(pair, 0.5)
        for p in pair.placements:
            flat = not any(c.as_circle() for c in (p.part.body.outer, *p.part.body.openings))
            assert made.meshes[p.part.part_no, 0.5].volume() == pytest.approx(
                p.part.volume, rel=1e-9 if flat else 0.1
            )
        wrong[pair.kind] += mesh_verdict(pair.placements, made, 0.5) != pair.verdict
    assert wrong["box on box"] == 0 and wrong["pin in its hole"] > 0 and wrong["pin beside pin"] > 0


@pytest.mark.cad
def test_the_volume_of_triangles_is_the_mesh_librarys():
    import trimesh

    from tactcad.solids.build import build
    from tactcad.solids.triangles import triangles

    for pair in PAIRS[:9]:
        mesh = triangles(build(pair.placements[1].part), 0.05, 0.5)
        assert volume(mesh) == pytest.approx(trimesh.Trimesh(*mesh, process=False).volume, rel=1e-12)
