"""The mesh is the part's own contour: read, cut, refused where it cannot be followed."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tactcad.contour import Arc, Contour, Line, chain
from tactcad.design.messages import CheckFailure
from tactcad.fem.elements import solve_plane
from tactcad.fem.shape import cut_element, outline, read, reference_shape
from tactcad.mechanics import ladder
from tactcad.mechanics.section import REFERENCE
from tactcad.parts.array.element import element
from tactcad.parts.array.hinge_section import hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.parts.rules import load

SECTIONS = {
    "two": REFERENCE,
    "one": REFERENCE.with_(two_sided=False),
    "two, full round": REFERENCE.with_(fillet_radius=0.375),
    "one, full round": REFERENCE.with_(fillet_radius=0.375, two_sided=False),
    "two, taller arm": REFERENCE.with_(arm_height=5.0),
}


@pytest.fixture(scope="module")
def layout():
    return Layout(load("macro-array"))


def moved(contour, dx, mirror=False):
    sign = -1.0 if mirror else 1.0
    at = lambda p: (sign * p[0] + dx, p[1])  # noqa: E731
    return Contour(
        tuple(
            Line(at(s.start), at(s.end), s.name)
            if isinstance(s, Line)
            else Arc(at(s.start), at(s.end), at(s.centre), s.ccw != mirror, s.name)
            for s in contour
        )
    )


@pytest.mark.parametrize("name", SECTIONS)
@pytest.mark.parametrize("mirror", [False, True])
def test_reference_contour_is_read_back(name, mirror):
    s = SECTIONS[name]
    contour = moved(outline(reference_shape(s)), 11.0, mirror)
    shape = read(contour, 11.0 + (-6.0 if mirror else 6.0))
    assert shape.hinge_thickness == pytest.approx(0.25, abs=1e-12)
    assert outline(shape).area == pytest.approx(contour.area, rel=1e-12)
    assert shape.two_sided == bool(s.two_sided)
    K = solve_plane(shape, 69000.0, 0.33, 3.0, density=1).stiffness
    assert K == pytest.approx(
        solve_plane(reference_shape(s), 69000.0, 0.33, 3.0, density=1).stiffness, rel=1e-7
    )


def test_element_of_the_array_cut_at_clamp_and_load_line_is_the_model(layout):
    section = hinge_section(layout, layout.elements)
    for i in (0, 1, 3):  # arms 4, 7, 8
        place = layout.elements[i]
        shape = cut_element(
            element(layout, place).body.outer, layout.clamp_edge, place.hinge_x - place.load_arm
        )
        K = solve_plane(shape, 69000.0, 0.33, 3.0, density=4).stiffness
        assert K == pytest.approx(float(ladder.stiffness(section.rows(i), "plane")), rel=3.5e-3)


def test_rounded_coordinates_of_a_fillet_at_its_wall_are_no_deviation(layout):
    """A cut along the slot's wall touches the fillet's end: 1e-15 mm beside it is 3e-8 mm up the fillet."""
    d = layout.design
    hinge = replace(d.element, hinge_thickness=0.395, hinge_length=1.02, fillet_radius=0.46)
    other = Layout(replace(d, array=replace(d.array, row_arms=((8.3, 7.3),)), element=hinge))
    place = next(p for p in other.elements if p.arm == 7.3)
    ends = other.clamp_edge, place.hinge_x - place.load_arm
    assert cut_element(element(other, place).extrusion.outer, *ends).hinge_thickness == 0.395


def test_changing_the_contour_alone_changes_the_stiffness(layout):
    """The slot's floor moves 10 um in the contour; design and section stay as they were."""
    place = layout.elements[2]
    contour = element(layout, place).body.outer
    floor = place.hinge.t
    lower = lambda p: (p[0], p[1] - 0.01)  # noqa: E731
    fillet_ends = {
        p for s in contour if s.name in ("slot_body_fillet", "slot_arm_fillet") for p in (s.start, s.end)
    }

    def changed(p):
        return lower(p) if p in fillet_ends else p

    cut = Contour(
        tuple(
            Line(changed(s.start), changed(s.end), s.name)
            if isinstance(s, Line)
            else Arc(
                changed(s.start),
                changed(s.end),
                lower(s.centre) if s.start in fillet_ends else s.centre,
                s.ccw,
                s.name,
            )
            for s in contour
        )
    )
    load_x = place.hinge_x - place.load_arm
    before, after = (cut_element(c, layout.clamp_edge, load_x) for c in (contour, cut))
    assert (before.hinge_thickness, after.hinge_thickness) == (
        pytest.approx(floor),
        pytest.approx(floor - 0.01),
    )
    ratio = [solve_plane(s, 69000.0, 0.33, 3.0, density=2).stiffness for s in (after, before)]
    # K goes nearly with t^3: the roots take a part with t^2
    assert (1 - 0.01 / floor) ** 3 < ratio[0] / ratio[1] < (1 - 0.01 / floor) ** 2.3


def test_moving_clamp_edge_or_load_line_changes_the_stiffness(layout):
    place = layout.elements[0]
    contour = element(layout, place).body.outer
    load_x = place.hinge_x - place.load_arm

    def K(clamp, at):
        return solve_plane(cut_element(contour, clamp, at), 69000.0, 0.33, 3.0, density=1).stiffness

    base = K(layout.clamp_edge, load_x)
    assert K(layout.clamp_edge - 2.0, load_x) > base  # less body to bend
    assert K(layout.clamp_edge, load_x + 0.3) > 1.1 * base  # shorter arm


def test_contour_with_a_lump_on_the_arm_is_refused():
    contour = chain(
        [
            (-4, 0),
            (6, 0),
            (6, 2),
            (5, 2),
            (5, 2.5),
            (4, 2.5),
            (4, 2),
            (0.4, 2),
            (0.4, 0.5),
            (-0.4, 0.5),
            (-0.4, 4),
            (-4, 4),
        ]
    )
    with pytest.raises(CheckFailure, match="no slot with rounded corners"):
        read(contour, 6.0)


def test_notched_arm_is_refused_not_smoothed_over():
    s = REFERENCE.with_(two_sided=False)
    pieces = list(outline(reference_shape(s)))
    at = next(i for i, p in enumerate(pieces) if p.name == "arm-high")
    top = pieces[at]
    bump = [(5.0, 2.0), (5.0, 2.4), (4.0, 2.4), (4.0, 2.0)]
    points = [top.start, *bump, top.end]
    contour = Contour((*pieces[:at], *(Line(a, b) for a, b in zip(points, points[1:])), *pieces[at + 1 :]))
    with pytest.raises(CheckFailure, match="protrudes from the arm"):
        read(contour, 6.0)
    hollow = [(5.0, 2.0), (5.0, 1.6), (4.0, 1.6), (4.0, 2.0)]
    points = [top.start, *hollow, top.end]
    contour = Contour((*pieces[:at], *(Line(a, b) for a, b in zip(points, points[1:])), *pieces[at + 1 :]))
    with pytest.raises(CheckFailure, match="not a plain rectangle"):
        read(contour, 6.0)
