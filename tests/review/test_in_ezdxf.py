"""The reviewer's own reading of a cut file sees what is wrong with it."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

from tactcad.contour import Contour, Corner, circle, rounded_polygon
from tactcad.export.dxf import dxf_bytes
from tactcad.parts.language.description import Extrusion, Material, Part

SCRIPT = Path(__file__).parents[2] / "packaging" / "review" / "in_ezdxf.py"
spec = importlib.util.spec_from_file_location("review_ezdxf", SCRIPT)
review = importlib.util.module_from_spec(spec)
spec.loader.exec_module(review)


def slotted(web: float, slot: float, radius: float) -> Contour:
    """A 20 x 8 block with a slot from above that leaves `web` mm; radius = slot/2 is a full round."""
    a, b = 10 + slot / 2, 10 - slot / 2
    points = [
        (0, 0, 0),
        (20, 0, 0),
        (20, 8, 0),
        (a, 8, 0),
        (a, web, radius),
        (b, web, radius),
        (b, 8, 0),
        (0, 8, 0),
    ]
    return rounded_polygon([Corner((x, y), r) for x, y, r in points])


def facts(body: Extrusion, number: str = "x-element-a4") -> dict:
    box = body.outer.box
    return {
        "part_no": number,
        "volume_mm3": body.volume,
        "section_area_mm2": body.section_area,
        "box_mm": [[*box[:2], 0.0], [*box[2:], body.thickness]],
    }


def faults(
    tmp_path, body: Extrusion, meant: Extrusion, hinge: float, number: str = "x-element-a4"
) -> list[str]:
    path = tmp_path / "part.dxf"
    path.write_bytes(dxf_bytes(Part(number, "", "wire-cut", Material("", 2810.0), body)))
    return review.file_faults(path, facts(meant, number), {"hinge_thickness": hinge})


@pytest.mark.parametrize("radius", [0.2, 0.3, 0.44])
def test_a_true_file_passes(tmp_path, radius):
    body = Extrusion(slotted(0.25, 0.88, radius), 3.0, (circle((4, 4), 3.4),))
    assert faults(tmp_path, body, body, 0.25) == []


@pytest.mark.parametrize("radius", [0.3, 0.44])
@pytest.mark.parametrize("off", [0.0011, -0.0011])
def test_a_hinge_off_by_a_micrometre_is_seen(tmp_path, radius, off):
    body = Extrusion(slotted(0.25 + off, 0.88, radius), 3.0)
    (fault,) = faults(tmp_path, body, body, 0.25)
    assert "hinge" in fault


def test_an_overridden_hinge_is_read_from_the_part_number(tmp_path):
    body = Extrusion(slotted(0.3, 0.88, 0.3), 3.0)
    assert faults(tmp_path, body, body, 0.25, "x-element-a4-t0.3") == []


def test_another_area_is_seen(tmp_path):
    body, meant = (Extrusion(slotted(0.25, 0.88, 0.3), 3.0, (circle((4, 4), d),)) for d in (3.4, 3.401))
    found = faults(tmp_path, body, meant, 0.25)
    assert found and all("area" in fault for fault in found)


def test_a_foil_s_narrowest_beam_is_the_design_s(tmp_path):
    """A frame with a beam of 0.4 mm across, between two openings."""
    openings = tuple(
        rounded_polygon([Corner(p, 0.1) for p in ((1, y), (9, y), (9, y + 3), (1, y + 3))]) for y in (1, 4.4)
    )
    body = Extrusion(
        rounded_polygon([Corner(p, 0.0) for p in ((0, 0), (10, 0), (10, 8.4), (0, 8.4))]), 0.08, openings
    )
    path = tmp_path / "foil.dxf"
    path.write_bytes(dxf_bytes(Part("x-foil", "", "etched", Material("", 7900.0), body)))
    assert review.file_faults(path, facts(body, "x-foil"), {"beam_width": 0.4}) == []
    (fault,) = review.file_faults(path, facts(body, "x-foil"), {"beam_width": 0.41})
    assert "narrowest beam" in fault
    assert review.element_table("jaw-array") == {"beam_width": 0.2}
