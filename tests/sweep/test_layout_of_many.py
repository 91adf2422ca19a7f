"""The layout of many designs at once: each design's own, and what the contours of its parts measure."""

from __future__ import annotations

import dataclasses
from functools import reduce

import numpy as np
import pytest

from tactcad.contour.cut import crossings
from tactcad.design.load import from_table, paths, read
from tactcad.design.tree import Design
from tactcad.export.inputs import flattened, nested
from tactcad.mechanics.section import HingeSection
from tactcad.parts.array.element import element
from tactcad.parts.array.hinge_section import element_section, hinge_section
from tactcad.parts.array.layout import Layout
from tactcad.sweep.designs_taken import placed, spec_at, with_value

FIELDS = [f.name for f in dataclasses.fields(HingeSection)]
PATHS = (
    "element.hinge_thickness", "element.hinge_length", "element.fillet_radius", "element.arm_height",
    "element.override.2.hinge_length", "element.override.9.hinge_thickness", "element.body_height",
    "element.pad_length", "element.pad_height", "element.seat_length", "array.row_pitch", "sheet.thickness",
    "array.row_arms[0][1]", "array.row_arms[1][4]", "rating.friction", "material.youngs_modulus",
    "material.poisson",
)  # fmt: skip
COUNT = 40


def table(design: Design) -> dict:
    origin = {f"material.{name}": "measured" for name in ("youngs_modulus", "poisson")}
    return nested(flattened(dataclasses.replace(design, origin=origin)))


def drawn(base: Design) -> tuple[Layout, list[Layout]]:
    """Designs drawn about one: at once, and one by one as their files would be read."""
    rng = np.random.default_rng(19)
    last = f"array.row_arms[{len(base.array.row_arms) - 1}][0]"
    columns = {}
    for path in [p if "row_arms[1]" not in p else last for p in PATHS]:
        if spec_at(base, path):
            at = paths(base).get(path.replace("override.2.", "").replace("override.9.", ""))
            middle = at if isinstance(at, float) else 6.0
            columns[path] = np.round(middle * rng.uniform(0.97, 1.03, COUNT) + 1e-3, 5)
    full_round = columns["element.hinge_length"][:20] / 2
    columns["element.fillet_radius"][:20] = full_round * (1 - 3e-9)
    one_by_one = []
    for i in range(COUNT):
        own = table(base)
        for path, column in columns.items():
            own = placed(own, base, path, float(column[i]))
        one_by_one.append(Layout(from_table(own)))
    return Layout(reduce(lambda d, item: with_value(d, *item), columns.items(), base)), one_by_one


@pytest.mark.parametrize("name", ["macro-array", "soft-tissue", "better-array"])
def test_it_is_each_designs_own_to_the_last_bit(name):
    many, one_by_one = drawn(read(name))
    for place in many.elements:
        got = element_section(many, place)
        for i, layout in enumerate(one_by_one):
            wanted = hinge_section(layout, (layout.elements[place.number - 1],))
            for field in FIELDS:
                value = np.broadcast_to(getattr(got, field), (COUNT,))[i]
                assert value == getattr(wanted, field), (field, place.number)
    lengths = np.broadcast_to(many.carrier_length, (COUNT,))
    assert list(lengths) == [layout.carrier_length for layout in one_by_one]


@pytest.mark.parametrize("name", ["macro-array", "soft-tissue"])
def test_it_is_what_the_contours_measure(name):
    """Hinge, slot and lengths read off the wire's path, by lines across it."""
    many, one_by_one = drawn(read(name))
    for place in many.elements:
        got = element_section(many, place)
        for i in range(0, COUNT, 13):
            s = {field: float(np.broadcast_to(getattr(got, field), (COUNT,))[i]) for field in FIELDS}
            layout = one_by_one[i]
            contour = element(layout, layout.elements[place.number - 1], 0.1).body.outer
            x0, _, _, _ = contour.box
            mouth = s["hinge_thickness"] + s["fillet_radius"] + 0.01
            slot = sorted(crossings(contour, "y", mouth))[1:3]
            pad = sorted(crossings(contour, "y", -s["pad_height"] / 2))[:2]
            rear = min(crossings(contour, "y", (layout.ledge + layout.design.element.rear_height) / 2))
            hinge = sorted(crossings(contour, "x", sum(slot) / 2))
            assert np.diff(slot).item() == pytest.approx(s["hinge_length"], abs=1e-9)
            assert np.diff(hinge).item() == pytest.approx(s["hinge_thickness"], abs=1e-9)
            assert (sum(slot) - sum(pad)) / 2 == pytest.approx(s["load_arm"], abs=1e-9)
            assert pad[0] == pytest.approx(x0, abs=1e-9)
            assert rear - slot[1] == pytest.approx(s["body_length"], abs=2e-6)
