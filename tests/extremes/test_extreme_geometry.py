"""Designs at the ends of what can be written: every part whole, or a refusal that names field, value and what
is legal."""

from __future__ import annotations

import warnings
from dataclasses import fields, is_dataclass, replace
from math import isfinite

import numpy as np
import pytest
from variants import variant

from tactcad.contour import Contour
from tactcad.design.fields import Number, NumberRows, Numbers
from tactcad.design.messages import InputError
from tactcad.design.tree import Design
from tactcad.export.dxf import check_dxf, dxf_bytes
from tactcad.fem.elements import solve_plane
from tactcad.fem.shape import cut_element
from tactcad.parts.array.element import element
from tactcad.parts.array.layout import Layout
from tactcad.parts.language.description import Extrusion, Revolution
from tactcad.parts.rules import broken_rules, refuse_broken
from tactcad.scenes import make_scene, scene_names

LONG = [4.0, 5, 6, 7, 8]

# name -> what is changed in the shipped array; all parts of all its scenes must be whole
WHOLE = {
    "hinge 0.02 mm": {"element.hinge_thickness": 0.02, "rating.overload_force": 5.0},
    "hinge 2 mm": {"element.hinge_thickness": 2.0},
    "slot of its fillets alone": {
        "element.hinge_length": 0.3,
        "element.fillet_radius": 0.15,
        "calibration.travel": 0.1,
    },
    "full round": {"element.fillet_radius": 0.44},
    "arm 0.5 mm": {
        "array.row_arms": [[0.5, 0.5]],
        "readout.excitation": 2.0,  # so small a grid bears no more
        "tolerance.ledge": 0.0005,
        "tolerance.pad_height": 0.002,
        "array.row_pitch": 0.4,
        "element.pad_length": 0.1,
        "element.pad_height": 0.3,
        "element.hinge_length": 0.2,
        "element.fillet_radius": 0.05,
        "element.hinge_thickness": 0.05,
        "element.pad_root_radius": 0.05,
        "element.corner_radius": 0.05,
        "element.arm_height": 0.4,
        "element.body_height": 0.6,
        "element.recess_depth": 0.25,
        "element.seat_length": 4.0,
        "gauge.carrier_arm_side": 0.12,
        "gauge.grid_length": 0.1,
        "stop.land_length": 0.06,
        "stop.tolerance": 0.001,
        "clamp.stop_plate_thickness": 5.0,
    },
    "arm 100 mm": {"array.row_arms": [[100.0]], "clamp.stop_plate_thickness": 5.0},
    "arms of 4 and 100 mm": {
        "array.row_arms": [[4.0, 100.0]],
        "clamp.hold_down_pitch": 100.0,
        "rating.overload_force": 12.0,
    },
    "1 x 1": {"array.row_arms": [[4.0]]},
    "2 x 20": {"array.row_arms": [LONG * 4] * 2},
    "foil of 0.1 mm": {
        "sheet.thickness": 0.1,
        "array.pitch": 1.1,
        "gauge.carrier_width": 0.1,
        "gauge.grid_width": 0.1,
        "readout.excitation": 2.0,  # so small a grid bears no more
        "rating.overload_force": 5.0,
    },
    "block of 20 mm": {"sheet.thickness": 20.0, "array.pitch": 21.0},
}

# name -> what is changed, and the field, value and legal range that the refusal must name
REFUSED = {
    "slot of zero length": (
        {"element.hinge_length": 0.0},
        "element.hinge_length",
        "0.0",
        "from 0.01 to 50 mm",
    ),
    "slot of its least length": (
        {"element.hinge_length": 0.01, "element.fillet_radius": 0.005},
        "stop.tolerance",
        "0.005",
        "less",
    ),
    "slot longer than the arm": (
        {"element.hinge_length": 9.0},
        "array.row_arms[0][0]",
        "4.0",
        "at least pad_length",
    ),
    "fillets a nanometre over the full round": (
        {"element.fillet_radius": 0.44 + 1e-6},
        "element.fillet_radius",
        "0.440001",
        "at most",
    ),
    "arm 0.5 mm behind the usual pad": (
        {"array.row_arms": [[0.5]]},
        "array.row_arms[0][0]",
        "0.5",
        "at least pad_length",
    ),
    "arm of zero length": ({"array.row_arms": [[0.0]]}, "array.row_arms[0][0]", "0.0", "from 0.1 to 100 mm"),
    "2 x 501": ({"array.row_arms": [[4.0] * 501] * 2}, "array.row_arms[0]", "501", "1 to 500"),
    "three rows": ({"array.row_arms": [[4.0]] * 3}, "array.row_arms", "3 rows", "one or two rows"),
    "modulus in GPa": (
        {"material.youngs_modulus": 71.0},
        "material.youngs_modulus",
        "71.0",
        "from 1000 to 1e+06 MPa",
    ),
    "modulus in Pa": (
        {"material.youngs_modulus": 71e9},
        "material.youngs_modulus",
        "71000000000.0",
        "from 1000",
    ),
    "strength in Pa": (
        {"material.yield_strength": 5e8},
        "material.yield_strength",
        "500000000.0",
        "from 1 to 5000 MPa",
    ),
    "density in g/cm3": ({"material.density": 2.8}, "material.density", "2.8", "from 500"),
    "sheet in metres": ({"sheet.thickness": 0.003}, "sheet.thickness", "0.003", "from 0.1 to 20 mm"),
    "sheet in micrometres": ({"sheet.thickness": 3000.0}, "sheet.thickness", "3000.0", "from 0.1 to 20 mm"),
    "hinge in micrometres": (
        {"element.hinge_thickness": 250.0},
        "element.hinge_thickness",
        "250.0",
        "from 0.005 to 5 mm",
    ),
    "hinge in metres": (
        {"element.hinge_thickness": 2.5e-4},
        "element.hinge_thickness",
        "0.00025",
        "from 0.005 to 5 mm",
    ),
    "arms in micrometres": (
        {"array.row_arms": [[4000.0]]},
        "array.row_arms[0][0]",
        "4000.0",
        "from 0.1 to 100 mm",
    ),
    "hinge 0.02 mm under the usual weight": (
        {"element.hinge_thickness": 0.02},
        "rating.overload_force",
        "13.04",
        "at most",
    ),
    "overload in millinewtons": (
        {"rating.overload_force": 13040.0},
        "rating.overload_force",
        "13040.0",
        "at most 179.1",
    ),
    "screws of a jaw": ({"holes.dowel_hole": 3.012 / 25}, "holes.dowel_hole", "0.12048", "from 0.2 to 20 mm"),
}


@pytest.fixture(autouse=True)
def loud():
    with warnings.catch_warnings(), np.errstate(over="raise", divide="raise", invalid="raise"):
        warnings.simplefilter("error")
        yield


def require_whole(design: Design) -> None:
    """Every part of every scene: closed contours, a finite volume inside its box, and a cut file that reads
    back."""
    assert broken_rules(design) == []
    for name in scene_names(design):
        scene = make_scene(design, name)
        assert len({p.designator for p in scene.placements}) == len(scene.placements)
        assert all(isfinite(v) for p in scene.placements for v in p.origin)
        for part in scene.parts:
            for contour in contours(part.body):
                assert contour.area > 0  # that it closes, Contour itself has tried
            assert isfinite(part.volume) and 0 < part.volume <= part.body.volume * (1 + 1e-12)
            if part.process == "wire-cut" and name == "array":
                assert check_dxf(dxf_bytes(part), part) == []


def contours(body) -> list[Contour]:
    if isinstance(body, Extrusion):
        return [body.outer, *body.openings]
    return [body.profile] if isinstance(body, Revolution) else []


@pytest.mark.by_day(4, "every scene of an extreme design each")
@pytest.mark.parametrize("name", WHOLE)
def test_every_part_of_every_scene_is_whole(name):
    require_whole(variant(WHOLE[name]))


@pytest.mark.nightly
def test_every_part_of_the_longest_array_is_whole():
    require_whole(variant({"array.row_arms": [LONG * 100] * 2}))


@pytest.mark.parametrize("name", REFUSED)
def test_refusal_names_field_value_and_what_is_legal(name):
    changes, path, value, legal = REFUSED[name]
    with pytest.raises(InputError) as refusal:
        refuse_broken(variant(changes))
    text = str(refusal.value)
    assert path in text and value in text and legal in text and "legal:" in text


CAD = [
    "hinge 0.02 mm",
    "hinge 2 mm",
    "full round",
    "slot of its fillets alone",
    "arm 0.5 mm",
    "arm 100 mm",
    "foil of 0.1 mm",
    "block of 20 mm",
]


@pytest.mark.cad
@pytest.mark.parametrize("name", CAD)
def test_the_kernel_makes_every_extreme_element_spacer_and_plate(name):
    """`build` refuses what is not one valid solid of the description's own volume."""
    from tactcad.solids.build import build

    scene = make_scene(variant(WHOLE[name]), "array")
    own = [p for p in scene.parts if not p.bought]
    assert {p.process for p in own} >= {"wire-cut"} and len(own) >= 5
    elements = [p for p in own if "-element-" in p.part_no]
    for part in (*elements[:2], *(p for p in own if p not in elements)):
        build(part)


@pytest.mark.cad
@pytest.mark.nightly
@pytest.mark.parametrize("name", WHOLE)
def test_the_kernel_makes_every_part_of_every_extreme_scene(name):
    from tactcad.solids.build import build

    design = variant(WHOLE[name])
    for part in {p.part_no: p for s in scene_names(design) for p in make_scene(design, s).parts}.values():
        build(part)


def shrunk(tree, factor: float):
    """A table, or the whole design, with every length times the factor, whatever a field's range says."""
    changes = {}
    for f in fields(tree):
        value, spec = getattr(tree, f.name), f.metadata.get("spec")
        if is_dataclass(value):
            changes[f.name] = shrunk(value, factor)
        elif isinstance(spec, Number) and spec.unit == "mm" and isinstance(value, float):
            changes[f.name] = value * factor
        elif isinstance(spec, Number) and spec.unit == "mm" and isinstance(value, dict):
            changes[f.name] = {k * factor: v * factor for k, v in value.items()}
        elif isinstance(spec, Numbers) and spec.unit == "mm":
            changes[f.name] = tuple(v * factor for v in value)
        elif isinstance(spec, NumberRows):
            changes[f.name] = tuple(tuple(v * factor for v in row) for row in value)
    return replace(tree, **changes)


@pytest.mark.parametrize("factor", [1 / 25, 1e-3, 25.0])
def test_a_jaw_sized_element_is_the_large_one_made_smaller(factor):
    """Length and area of its outline, and the stiffness of the contour's own finite elements; screws stay
    what they are."""
    large = variant({"stop.gaps": {"4": 0.1, "5": 0.1, "6": 0.1, "7": 0.1, "8": 0.1}})
    small = shrunk(large, factor)
    assert small.element.hinge_thickness == pytest.approx(0.25 * factor)
    K = []
    for design in (large, small):
        layout = Layout(design)
        place = layout.elements[0]
        part = element(layout, place)
        shape = cut_element(part.body.outer, layout.clamp_edge, place.hinge_x - place.load_arm)
        K.append(
            (part.body.outer, solve_plane(shape, 71000.0, 0.33, design.sheet.thickness, density=1).stiffness)
        )
    (outer, stiff), (small_outer, small_stiff) = K
    assert len(small_outer) == len(outer)
    assert small_outer.length == pytest.approx(outer.length * factor, rel=1e-9)
    assert small_outer.area == pytest.approx(outer.area * factor**2, rel=1e-9)
    assert small_stiff == pytest.approx(stiff * factor, rel=1e-6)
