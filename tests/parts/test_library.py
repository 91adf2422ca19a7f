"""Standard parts against another library's tables (bd_warehouse) and the standards' own well-known rows."""

from __future__ import annotations

import csv
from importlib.resources import files
from math import pi, sqrt, tan

import pytest

from tactcad.parts.bought import screws, standard_parts
from tactcad.parts.bought.screws import (
    CAP_SCREW_LENGTHS,
    SET_SCREW_LENGTHS,
    cap_screw,
    nut,
    set_screw,
    threaded_rod,
)
from tactcad.parts.language.description import Extrusion, Hole, Material, Part, drill_point_height
from tactcad.parts.language.metric import METRIC, counterbore_diameter, tapped_depth


def published(name: str, key: str) -> dict[str, dict[str, str]]:
    text = files("bd_warehouse").joinpath("data", f"{name}.csv").read_text(encoding="utf-8-sig")
    return {row[key]: {k.strip(): v for k, v in row.items()} for row in csv.DictReader(text.splitlines())}


@pytest.mark.parametrize("thread", METRIC)
def test_sizes_are_the_published_ones(thread):
    m = METRIC[thread]
    size = f"{thread}-{m.pitch:g}"
    cap = published("socket_head_cap_parameters", "Size")[size]
    assert (m.head_height, m.key, m.key_depth) == tuple(float(cap[f"iso4762:{k}"]) for k in "kst")
    assert m.d < m.head <= float(cap["iso4762:dk"])  # the table there has the knurled head, the larger one
    assert (CAP_SCREW_LENGTHS[thread][0], CAP_SCREW_LENGTHS[thread][-1]) == (
        float(cap["iso4762:short"]),
        float(cap["iso4762:long"]),
    )
    listed = published("nominal_screw_lengths", "Screw_Type")["iso4762"]["Nominal_Sizes"].split(",")
    assert set(CAP_SCREW_LENGTHS[thread]) <= {float(n) for n in listed}
    grub = published("setscrew_parameters", "Size")[size]
    assert (m.set_key, m.set_key_depth) == (float(grub["iso4026:s"]), float(grub["iso4026:t"]))
    hexagon = published("hex_nut_parameters", "Size")[size]
    assert (m.nut, m.nut_height) == (float(hexagon["iso4032:s"]), float(hexagon["iso4032:m"]))
    assert m.clearance == float(published("clearance_hole_sizes", "Size")[thread]["Normal"])
    assert m.tap_drill == float(published("tap_hole_sizes", "Size")[size]["Soft"])
    assert counterbore_diameter(thread) > float(cap["iso4762:dk"]), "a knurled head goes in too"


def test_rows_that_every_workshop_knows():
    """ISO 4762 M3: head 5.5 x 3, key 2.5; M4: 7 x 4, key 3; M5: 8.5 x 5, key 4. ISO 4026 points: M3 2.0, M5
    3.5."""
    assert [(METRIC[t].head, METRIC[t].head_height, METRIC[t].key) for t in ("M3", "M4", "M5")] == [
        (5.5, 3, 2.5),
        (7, 4, 3),
        (8.5, 5, 4),
    ]
    assert [METRIC[t].set_point for t in ("M2", "M2.5", "M3", "M4", "M5")] == [1.0, 1.5, 2.0, 2.5, 3.5]
    assert SET_SCREW_LENGTHS["M3"] == (3, 4, 5, 6, 8, 10, 12, 16)
    assert CAP_SCREW_LENGTHS["M3"] == (5, 6, 8, 10, 12, 16, 20, 25, 30)
    assert standard_parts.dowel_lengths("3") == (8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30)


def hexagon_area(across_flats: float) -> float:
    return sqrt(3) / 2 * across_flats**2


@pytest.mark.parametrize("thread", METRIC)
def test_volumes_in_closed_form(thread):
    m = METRIC[thread]
    for length in CAP_SCREW_LENGTHS[thread]:
        volume = pi / 4 * (m.head**2 * m.head_height + m.d**2 * length) - hexagon_area(m.key) * m.key_depth
        assert cap_screw(thread, length).volume == pytest.approx(volume, rel=1e-12)
    for length in SET_SCREW_LENGTHS[thread]:
        r, p = m.d / 2, m.set_point / 2
        shank = length - (r - p)
        socket = hexagon_area(m.set_key) * min(m.set_key_depth, length / 2)
        volume = pi * r**2 * shank + pi * (r - p) * (r * r + r * p + p * p) / 3 - socket
        assert set_screw(thread, length).volume == pytest.approx(volume, rel=1e-12)
    assert nut(thread).volume == pytest.approx(
        (hexagon_area(m.nut) - pi / 4 * m.tap_drill**2) * m.nut_height, rel=1e-12
    )
    assert threaded_rod(thread, 100).volume == pytest.approx(pi / 4 * m.d**2 * 100, rel=1e-12)


@pytest.mark.parametrize("thread", METRIC)
def test_lengths_that_no_standard_has_are_refused(thread):
    for make, lengths in ((cap_screw, CAP_SCREW_LENGTHS), (set_screw, SET_SCREW_LENGTHS)):
        for length in (lengths[thread][0] - 1, lengths[thread][-1] + 5, 7.3):
            with pytest.raises(ValueError, match="has no length"):
                make(thread, length)
    with pytest.raises(KeyError):
        cap_screw("M99", 10)


@pytest.mark.parametrize("size", ["2", "2.5", "3", "4", "5"])
def test_dowels_are_m6(size):
    """ISO 286-2: m6 is +2 to +8 um up to 3 mm, +4 to +12 um above."""
    low, high = (0.002, 0.008) if float(size) <= 3 else (0.004, 0.012)
    assert standard_parts.dowel_limits(size) == pytest.approx(
        (float(size) + low, float(size) + high), abs=1e-12
    )
    assert standard_parts.dowel_diameter(size) == pytest.approx(float(size) + (low + high) / 2, abs=1e-12)
    pin = standard_parts.dowel(size, standard_parts.dowel_lengths(size)[-1])
    assert pin.purchase.designation.startswith(f"ISO 8734 {size} m6 x ")
    assert pin.part_no != standard_parts.dowel(size, 55.0).part_no
    assert "ground rod" in standard_parts.dowel(size, 55.0).purchase.designation


def test_designations_can_be_ordered():
    assert cap_screw("M3", 10).purchase.designation == "ISO 4762 M3x10 A2-70"
    assert set_screw("M2.5", 6).purchase.designation == "ISO 4026 M2.5x6 A2-21H"
    assert nut("M4").purchase.designation == "ISO 4032 M4 A2-70"
    for part in (
        cap_screw("M3", 10),
        set_screw("M3", 10),
        nut("M3"),
        threaded_rod("M3", 50),
        standard_parts.dowel("3", 20),
    ):
        assert part.bought and part.purchase.source_verified is False


def test_holes_counted_by_hand():
    m = METRIC["M3"]
    blind = Hole(
        "tap",
        (0, 0, 10),
        (0, 0, -1),
        m.tap_drill,
        6.5,
        False,
        thread="M3",
        thread_depth=5.5,
        drill_point=True,
    )
    cone = m.tap_drill / 2 / tan(pi * 59 / 180)
    assert drill_point_height(m.tap_drill) == pytest.approx(cone, rel=1e-12)
    assert blind.volume == pytest.approx(pi / 4 * m.tap_drill**2 * (6.5 + cone / 3), rel=1e-12)
    assert tapped_depth("M3") == pytest.approx(1.5 * 3 + 1.5 + 2 * 0.5 + cone, rel=1e-12)
    sunk = Hole("screw", (0, 0, 10), (0, 0, -1), 3.4, 10, True, counterbore=(6.0, 3.2))
    assert sunk.volume == pytest.approx(pi / 4 * (3.4**2 * 10 + (6.0**2 - 3.4**2) * 3.2), rel=1e-12)


@pytest.mark.cad
def test_volumes_and_centres_against_the_kernel(macro_scene, macro_shapes):
    from tactcad.solids.build import build
    from tactcad.solids.measure import measure

    extra = [
        cap_screw("M5", 20),
        set_screw("M2", 3),
        set_screw("M4", 12),
        nut("M2.5"),
        threaded_rod("M4", 60),
        standard_parts.dowel("2.5", 8),
    ]
    shapes = {**macro_shapes, **{p.part_no: build(p) for p in extra}}
    for part in (*macro_scene.parts, *extra):
        got = measure(shapes[part.part_no])
        assert got["volume"] == pytest.approx(part.volume, rel=1e-9)
        assert got["centre"] == pytest.approx(part.centre, abs=1e-8)


@pytest.mark.cad
def test_every_kind_of_feature_against_the_kernel():
    """Holes from all sides, counterbored, blind, with drill points, and pockets with islands on a slanted x
    axis."""
    from tactcad.contour import circle, rectangle
    from tactcad.parts.language.description import Pocket
    from tactcad.solids.build import build
    from tactcad.solids.measure import measure

    s = sqrt(0.5)
    features = (
        Hole("through", (5, 5, 0), (0, 0, 1), 3, 20, True, counterbore=(6, 4)),
        Hole("blind", (15, 0, 10), (0, 1, 0), 4, 6, False, drill_point=True),
        Hole("from the side", (0, 22, 12), (1, 0, 0), 2.5, 5, False),
        Pocket("slanted", (28, 20, 20), (0, 0, -1), (s, s, 0), rectangle(-4, -2, 4, 2), 3.5),
        Pocket("groove", (28, 8, 0), (0, 0, 1), (1, 0, 0), circle((0, 0), 10), 2, (circle((0.5, 0), 6),)),
        Pocket("wall", (40, 14, 12), (-1, 0, 0), (0, 1, 0), rectangle(0, 0, 3, 2), 4),
    )
    part = Part("X", "x", "milled", Material("m", 1000), Extrusion(rectangle(0, 0, 40, 30), 20), features)
    got = measure(build(part))
    assert got["volume"] == pytest.approx(part.volume, rel=1e-10)
    assert got["centre"] == pytest.approx(part.centre, abs=1e-9)
    assert part.mass == pytest.approx(part.volume * 1e-3)


@pytest.mark.parametrize("thread", METRIC)
def test_a_screw_in_a_picture_stays_clear_of_its_tapped_hole_and_keeps_its_length_and_head(thread):
    m = METRIC[thread]
    made = (
        cap_screw(thread, CAP_SCREW_LENGTHS[thread][0]),
        set_screw(thread, SET_SCREW_LENGTHS[thread][-1]),
        threaded_rod(thread, 50.0),
    )
    for part in made:
        shown = screws.for_pictures(part)
        if isinstance(part.body, Extrusion):
            assert shown.body.outer.box[2] < m.tap_drill / 2 < part.body.outer.box[2]
            assert shown.body.thickness == part.body.thickness
            continue
        reach = [max(s.start[0] for s in p.body.profile if s.start[1] > 0) for p in (shown, part)]
        assert reach[0] < m.tap_drill / 2 < reach[1] == m.d / 2
        assert (
            shown.body.profile.box[1:2] + shown.body.profile.box[3:]
            == part.body.profile.box[1:2] + part.body.profile.box[3:]
        )
        head = [
            max(s.start[0] for s in p.body.profile if s.start[1] < 0)
            for p in (shown, part)
            if part.body.profile.box[1] < 0
        ]
        assert len(set(head)) <= 1
    assert screws.for_pictures(nut(thread)) == nut(thread)
