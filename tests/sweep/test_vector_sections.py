"""Sections of many designs at once are those of each design's own layout, to the last bit."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from tactcad.design.fields import Number, Whole
from tactcad.design.load import SECTION_TYPES, from_table, paths, read
from tactcad.design.tree import Design
from tactcad.export.inputs import flattened, nested
from tactcad.mechanics.section import HingeSection
from tactcad.parts.hinge_section import hinge_section
from tactcad.parts.layout import Layout
from tactcad.sweep.field_paths import placed, spec_at
from tactcad.sweep.vector_sections import TAKEN, VectorDesigns

FIELDS = [f.name for f in dataclasses.fields(HingeSection)]
PATHS = (
    "element.hinge_thickness", "element.hinge_length", "element.fillet_radius", "element.arm_height",
    "element.override.2.hinge_length", "element.override.9.hinge_thickness", "element.body_height",
    "element.pad_length", "element.pad_height", "element.seat_length", "array.row_pitch", "sheet.thickness",
    "array.row_arms[0][1]", "array.row_arms[1][4]", "rating.friction", "material.youngs_modulus",
    "material.poisson",
)  # fmt: skip


def table(design: Design) -> dict:
    origin = {f"material.{name}": "measured" for name in ("youngs_modulus", "poisson")}
    return nested(flattened(dataclasses.replace(design, origin=origin)))


def sections(design: Design) -> dict[str, np.ndarray]:
    layout = Layout(design)
    s = hinge_section(layout, layout.elements)
    return {name: np.broadcast_to(getattr(s, name), s.shape) for name in FIELDS}


@pytest.mark.parametrize("name", ["macro-array", "soft-tissue", "better-array"])
def test_they_are_the_layouts_own(name):
    rng = np.random.default_rng(19)
    base = read(name)
    last = f"array.row_arms[{len(base.array.row_arms) - 1}][0]"
    taken = [p if "row_arms[1]" not in p else last for p in PATHS]
    taken = [p for p in taken if spec_at(base, p)]
    columns = {}
    for path in taken:
        at = base
        for part in path.replace("override.2.", "").replace("override.9.", "").split("[")[0].split("."):
            at = getattr(at, part)
        middle = at if isinstance(at, float) else 6.0
        columns[path] = np.round(middle * rng.uniform(0.97, 1.03, 40) + 1e-3, 5)
    full_round = columns["element.hinge_length"][:20] / 2
    columns["element.fillet_radius"][:20] = full_round * (1 - 3e-9)
    many = VectorDesigns(base, columns)
    got = {p.number: many.section(p.number) for p in many.layout.elements}
    for i in range(40):
        own = table(base)
        for path, column in columns.items():
            own = placed(own, base, path, float(column[i]))
        wanted = sections(from_table(own))
        for number, section in got.items():
            for field in FIELDS:
                value = np.broadcast_to(getattr(section, field), (40,))[i]
                assert value == wanted[field][number - 1], (field, number)


def test_no_other_number_of_a_design_reaches_a_section():
    """Every number of the schema is moved by itself; what moves a section is a field that is taken."""
    base = read("macro-array")
    before, own = sections(base), table(base)
    tried = 0
    for path, value in paths(base).items():
        if path.partition(".")[0] not in SECTION_TYPES or not isinstance(value, (int, float)):
            continue
        spec = spec_at(base, path)
        if not isinstance(spec, (Number, Whole)):
            continue
        step = 1 if isinstance(spec, Whole) else abs(value) * 1e-3 or 1e-3
        other = value + step if value + step <= spec.high else value - step
        after = sections(from_table(placed(own, base, path, other)))
        moved = any(not np.array_equal(before[f], after[f]) for f in FIELDS)
        assert moved == bool(TAKEN.fullmatch(path)) or not moved, path
        tried += 1
    assert tried > 100
