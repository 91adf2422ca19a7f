"""Areas, moments, lengths and boxes of lines and arcs against closed forms, polygons and quadrature."""

from __future__ import annotations

import random
from math import cos, hypot, pi, sin, sqrt, tan

import mpmath
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tactcad.contour import Arc, Contour, Corner, Line, chain, circle, rectangle, rounded_polygon


def sector(r: float, first: float, last: float, cx: float = 0.0, cy: float = 0.0) -> Contour:
    """Circular sector: two radii and an arc, counter-clockwise."""
    a, b = (cx + r * cos(first), cy + r * sin(first)), (cx + r * cos(last), cy + r * sin(last))
    return Contour((Line((cx, cy), a), Arc(a, b, (cx, cy), True), Line(b, (cx, cy))))


def segment_of(r: float, w: float) -> Contour:
    """Circular segment of sweep w about (0, 0), symmetric to the x axis, closed by its chord."""
    a, b = (r * cos(w / 2), -r * sin(w / 2)), (r * cos(w / 2), r * sin(w / 2))
    return Contour((Arc(a, b, (0.0, 0.0), True), Line(b, a)))


def slot(length: float, r: float) -> Contour:
    """Stadium about the origin: two half circles and two lines."""
    h = length / 2
    return Contour(
        (
            Line((-h, -r), (h, -r)),
            Arc((h, -r), (h, r), (h, 0.0), True),
            Line((h, r), (-h, r)),
            Arc((-h, r), (-h, -r), (-h, 0.0), True),
        )
    )


def by_quadrature(contour: Contour, f) -> float:
    """Integral of f over the area by Green: F dy with F = the x-antiderivative of f, each segment by
    mpmath."""
    total = mpmath.mpf(0)
    for s in contour:
        if isinstance(s, Line):
            (x0, y0), (x1, y1) = s.start, s.end
            total += mpmath.quad(lambda u: f(x0 + u * (x1 - x0), y0 + u * (y1 - y0)) * (y1 - y0), [0, 1])
        else:
            (cx, cy), r, w0, w = s.centre, s.radius, s.start_angle, s.sweep
            total += mpmath.quad(
                lambda u: (
                    f(cx + r * mpmath.cos(w0 + u * w), cy + r * mpmath.sin(w0 + u * w))
                    * r
                    * mpmath.cos(w0 + u * w)
                    * w
                ),  # noqa: B023
                mpmath.linspace(0, 1, 9),
            )
    return float(total)


def as_polygon(contour: Contour, n: int) -> list[tuple[float, float]]:
    return [s.at(k / n) for s in contour for k in range(n if isinstance(s, Arc) else 1)]


def shoelace(points) -> tuple[float, float, float]:
    pairs = list(zip(points, points[1:] + points[:1]))
    cross = [x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in pairs]
    area = sum(cross) / 2
    cx = sum(c * (a[0] + b[0]) for c, (a, b) in zip(cross, pairs)) / (6 * area)
    cy = sum(c * (a[1] + b[1]) for c, (a, b) in zip(cross, pairs)) / (6 * area)
    return area, cx, cy


def test_rectangle():
    c = rectangle(1.0, -2.0, 5.0, 1.0)
    assert c.area == 12.0 and c.length == 14.0 and c.ccw
    assert c.centroid == (3.0, -0.5)
    assert c.box == (1.0, -2.0, 5.0, 1.0)
    assert c.product_moment == pytest.approx((25 - 1) / 2 * (1 - 4) / 2)


def test_circle():
    c = circle((3.0, -2.0), 5.0)
    assert c.area == pytest.approx(pi * 6.25, rel=1e-14)
    assert c.length == pytest.approx(pi * 5, rel=1e-14)
    assert c.centroid == pytest.approx((3.0, -2.0), abs=1e-14)
    assert c.box == pytest.approx((0.5, -4.5, 5.5, 0.5), abs=1e-14)
    assert c.product_moment == pytest.approx(pi * 6.25 * 3 * -2, rel=1e-13)
    assert c.as_circle() == ((3.0, -2.0), 2.5)
    assert rectangle(0, 0, 1, 1).as_circle() is None
    assert slot(3, 1).as_circle() is None


def test_one_arc_with_equal_ends_is_the_full_circle():
    for ccw in (True, False):
        c = Contour((Arc((1.0, 0.0), (1.0, 0.0), (0.0, 0.0), ccw),))
        assert c.signed_area == pytest.approx(pi if ccw else -pi)
        assert c.length == pytest.approx(2 * pi)
        assert c.box == pytest.approx((-1, -1, 1, 1))
        assert c.as_circle() == ((0.0, 0.0), 1.0)


@pytest.mark.parametrize("w", [1e-4, 0.01, 0.5, 1.0, pi / 2, 2.0, pi, 4.0, 6.0, 2 * pi - 1e-3])
def test_sector_and_segment_closed_forms(w):
    r = 2.5
    c = sector(r, -w / 2, w / 2)
    assert c.area == pytest.approx(r * r * w / 2, rel=1e-12)
    assert c.centroid[0] == pytest.approx(4 * r * sin(w / 2) / (3 * w), rel=1e-9, abs=1e-12)
    assert c.centroid[1] == pytest.approx(0.0, abs=1e-12)
    assert c.length == pytest.approx(r * (w + 2), rel=1e-12)
    if w < 2 * pi - 0.01:
        c = segment_of(r, w)
        exact = float(r * r * (mpmath.mpf(w) - mpmath.sin(mpmath.mpf(w))) / 2)
        assert c.area == pytest.approx(exact, rel=1e-8 if w < 0.01 else 1e-12)


@pytest.mark.parametrize("first", [0.0, 0.3, 2.0, -2.5])
@pytest.mark.parametrize("sweep", [0.2, 1.7, 3.5, 5.9])
def test_moments_of_a_sector_anywhere_against_quadrature(first, sweep):
    c = sector(1.7, first, first + sweep, 4.0, -3.0)
    assert c.area == pytest.approx(by_quadrature(c, lambda x, y: x), rel=1e-12)
    assert c.centroid[0] * c.area == pytest.approx(by_quadrature(c, lambda x, y: x * x / 2), rel=1e-12)
    assert c.centroid[1] * c.area == pytest.approx(by_quadrature(c, lambda x, y: x * y), rel=1e-12)
    assert c.product_moment == pytest.approx(by_quadrature(c, lambda x, y: x * x * y / 2), rel=1e-12)


def test_a_far_away_contour_keeps_its_digits():
    near, far = slot(3.0, 0.5), None
    shift = 1e5
    moved = []
    for s in near:
        a, b = ((p[0] + shift, p[1] - shift) for p in (s.start, s.end))
        moved.append(
            Line(a, b)
            if isinstance(s, Line)
            else Arc(a, b, (s.centre[0] + shift, s.centre[1] - shift), s.ccw)
        )
    far = Contour(tuple(moved))
    assert far.area == pytest.approx(near.area, rel=1e-9)
    assert far.centroid == pytest.approx((shift, -shift), abs=1e-8)


def test_polygons_of_the_arcs_converge_to_area_and_centroid():
    """Chords of n pieces miss the area as 1/n^2: refining by 2 takes the error to a quarter."""
    contour = rounded_polygon(
        [
            Corner((0, 0), 1.0),
            Corner((6, 0), 0.5),
            Corner((6, 4), 1.2),
            Corner((2, 2), 0.4),
            Corner((0, 5), 0.3),
        ]
    )
    errors = []
    for n in (8, 16, 32, 64):
        area, cx, cy = shoelace(as_polygon(contour, n))
        errors.append((contour.area - area, contour.centroid[0] - cx, contour.centroid[1] - cy))
    for before, after in zip(errors, errors[1:]):
        for a, b in zip(before, after):
            assert b / a == pytest.approx(0.25, rel=0.02)


def test_direction_changes_signs_only():
    c = slot(3.0, 0.5)
    r = c.reversed()
    assert r.signed_area == pytest.approx(-c.signed_area)
    assert (r.area, r.length, *r.box) == pytest.approx((c.area, c.length, *c.box))
    assert r.centroid == pytest.approx(c.centroid, abs=1e-14)
    shifted = sector(1.0, 0.2, 1.4, 2.0, 3.0)
    assert shifted.reversed().product_moment == pytest.approx(shifted.product_moment)
    assert r.reversed() == c
    assert not r.ccw and c.ccw


@settings(max_examples=60, derandomize=True, deadline=None)
@given(st.floats(-pi, pi), st.floats(0.01, 2 * pi - 0.01), st.booleans())
def test_boxes_of_arcs_hold_every_point_and_are_reached(first, sweep, ccw):
    a = (3 * cos(first), 3 * sin(first))
    last = first + (sweep if ccw else -sweep)
    b = (3 * cos(last), 3 * sin(last))
    arc = Arc(a, b, (0.0, 0.0), ccw)
    assert abs(arc.sweep) == pytest.approx(sweep, rel=1e-9)
    points = [arc.at(k / 2000) for k in range(2001)]
    x0, y0, x1, y1 = Contour((arc, Line(b, a))).box
    xs, ys = zip(*points)
    for got, reached in (
        (x0, min(xs)),
        (y0, min(ys)),
        (-x1, min(-x for x in xs)),
        (-y1, min(-y for y in ys)),
    ):
        assert reached - 1e-5 < got <= reached + 1e-12


def test_open_empty_and_zero_chains_are_refused():
    with pytest.raises(ValueError, match="open"):
        Contour((Line((0, 0), (1, 0)), Line((1, 0), (1, 1))))
    with pytest.raises(ValueError, match="open"):
        Contour((Line((0, 0), (1, 0)), Line((1, 1e-15), (0, 0))))
    with pytest.raises(ValueError, match="at least one"):
        Contour(())
    with pytest.raises(ValueError, match="without length"):
        chain([(0, 0), (1, 0), (1, 0), (0, 1)])


def test_names():
    c = rounded_polygon(
        [Corner((0, 0), 0.5, "bottom", "left"), Corner((4, 0), 0.0, "slope"), Corner((0, 3), 0.0, "wall")]
    )
    assert {s.name for s in c} == {"bottom", "left", "slope", "wall"}
    assert isinstance(c.named("left"), Arc) and isinstance(c.named("bottom"), Line)
    with pytest.raises(KeyError):
        c.named("nothing")
    with pytest.raises(KeyError):
        circle((0, 0), 1, "twice").named("twice")


# --- rounded polygons ---


def random_polygon(seed: int) -> list[tuple[float, float]]:
    """Star-shaped, with inside and outside corners."""
    chance = random.Random(seed)
    n = chance.randint(4, 9)
    return [
        (
            r * cos(2 * pi * (k + chance.uniform(-0.3, 0.3)) / n),
            r * sin(2 * pi * (k + chance.uniform(-0.3, 0.3)) / n),
        )
        for k, r in ((k, chance.uniform(3, 10)) for k in range(n))
    ]


@pytest.mark.parametrize("seed", range(25))
def test_fillets_are_tangent_have_their_radius_and_their_closed_form_area(seed):
    """Each fillet takes r^2 (tan(w/2) - w/2) off an outside corner (w the turn), or adds it to an inside
    one."""
    points = random_polygon(seed)
    radius = 0.15
    contour = rounded_polygon([Corner(p, radius, f"edge {i}", f"fillet {i}") for i, p in enumerate(points)])
    assert len(contour) == 2 * len(points)
    area, saved = shoelace(points)[0], 0.0
    for i, p in enumerate(points):
        before, arc, after = (
            contour.named(f"edge {(i - 1) % len(points)}"),
            contour.named(f"fillet {i}"),
            contour.named(f"edge {i}"),
        )
        assert arc.radius == pytest.approx(radius, rel=1e-12)
        for line, at in ((before, arc.start), (after, arc.end)):
            ux, uy = (line.end[0] - line.start[0]) / line.length, (line.end[1] - line.start[1]) / line.length
            rx, ry = at[0] - arc.centre[0], at[1] - arc.centre[1]
            assert abs(ux * rx + uy * ry) < 1e-12, "radius at the joint is not square to the edge"
            # and the arc runs on in the line's direction
            side = 1 if arc.ccw else -1
            assert -ry * side * ux + rx * side * uy > 0.999 * radius
        assert hypot(p[0] - arc.centre[0], p[1] - arc.centre[1]) == pytest.approx(
            radius / cos(arc.sweep / 2), rel=1e-9
        )
        turn = abs(arc.sweep)
        saved += (1 if arc.ccw else -1) * radius**2 * (tan(turn / 2) - turn / 2)
    assert contour.signed_area == pytest.approx(area - saved, rel=1e-10)


def test_sharp_corners_stay_the_polygons():
    points = random_polygon(3)
    assert rounded_polygon([Corner(p) for p in points]) == chain(points)


def test_rounded_square_closed_forms():
    c = rounded_polygon([Corner(p, 1.0) for p in ((0, 0), (6, 0), (6, 4), (0, 4))])
    assert c.area == pytest.approx(24 - (4 - pi))
    assert c.length == pytest.approx(2 * (4 + 2) + 2 * pi)
    assert c.box == (0, 0, 6, 4)
    assert c.centroid == pytest.approx((3, 2))


@pytest.mark.parametrize("turned", range(4))
def test_a_full_round_is_one_arc_wherever_the_chain_begins(turned):
    """A slot 2 r wide: both fillets meet, and are one half circle; no edge of no length is left."""
    corners = [Corner((0, 0), 1.0), Corner((2, 0), 1.0), Corner((2, 5)), Corner((0, 5))]
    c = rounded_polygon(corners[turned:] + corners[:turned])
    arcs = [s for s in c if isinstance(s, Arc)]
    assert [round(a.sweep, 12) for a in arcs] == [round(pi, 12)]
    assert len(c) == 4
    assert c.area == pytest.approx(10 - (4 - pi) / 2)


def test_four_full_rounds_are_a_circle():
    c = rounded_polygon([Corner(p, 1.0) for p in ((0, 0), (2, 0), (2, 2), (0, 2))])
    assert c.area == pytest.approx(pi)
    assert c.as_circle()[0] == pytest.approx((1, 1))


@pytest.mark.parametrize("turned", range(4))
def test_a_fillet_that_uses_up_an_edge_between_sharp_corners(turned):
    corners = [Corner((0, 0), 2.0), Corner((2, 0)), Corner((2, 5)), Corner((0, 5))]
    c = rounded_polygon(corners[turned:] + corners[:turned])
    assert c.area == pytest.approx(10 - (4 - pi))
    assert len(c) == 4


def test_inside_fillets_of_unlike_radii_that_just_meet():
    """An S of two arcs on one edge: the edge vanishes, the arcs join with one tangent."""
    c = rounded_polygon(
        [
            Corner((0, 0)),
            Corner((4, 0), 1.0),
            Corner((4, 3), 2.0),
            Corner((9, 3)),
            Corner((9, 8)),
            Corner((0, 8)),
        ]
    )
    first, second = (s for s in c if isinstance(s, Arc))
    assert first.end == second.start == pytest.approx((4, 1))
    assert c.area == pytest.approx(9 * 8 - 5 * 3 - (1 - pi / 4) * 1 + (1 - pi / 4) * 4)


def test_fillets_that_do_not_fit_are_refused_with_the_edge():
    corners = [Corner((0, 0), 1.5, "floor"), Corner((2, 0), 1.0), Corner((2, 5)), Corner((0, 5))]
    with pytest.raises(ValueError, match="overlap by 0.5 mm on the edge 'floor'"):
        rounded_polygon(corners)
    with pytest.raises(ValueError, match="parallel"):
        rounded_polygon([Corner((0, 0)), Corner((1, 0), 0.1), Corner((2, 0)), Corner((1, 3))])
    with pytest.raises(ValueError, match="coincide"):
        rounded_polygon([Corner((0, 0)), Corner((1, 0), 0.1), Corner((1, 0)), Corner((1, 3))])


def test_a_45_degree_ramp_uses_tan_of_half_the_turn():
    c = rounded_polygon([Corner((0, 0)), Corner((5, 0), 1.0, fillet="foot"), Corner((8, 3)), Corner((0, 3))])
    foot = c.named("foot")
    assert foot.start[0] == pytest.approx(5 - tan(pi / 8))
    assert foot.end == pytest.approx((5 + tan(pi / 8) / sqrt(2), tan(pi / 8) / sqrt(2)))
