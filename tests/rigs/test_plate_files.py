"""Cut files of plates: the solid that the kernel builds has that outline, and is open where the file cuts a
hole."""

from __future__ import annotations

from math import cos, pi, sin

import pytest

from tactcad.export.dxf import check_dxf, dxf_bytes, read_dxf
from tactcad.parts.designs import load
from tactcad.parts.language.description import Hole
from tactcad.parts.language.stock import cut_section
from tactcad.scenes import make_scene, scene_names
from tactcad.solids.build import build

DESIGN = load("smallest-bearing")
PARTS = {p.part_no: p for name in scene_names(DESIGN) for p in make_scene(DESIGN, name).parts}
PLATES = sorted(n for n, p in PARTS.items() if p.process in ("milled", "ground") and cut_section(p))


@pytest.mark.cad
@pytest.mark.parametrize("number", PLATES)
def test_the_solid_is_open_where_the_cut_file_has_a_hole(number, tmp_path):
    part = PARTS[number]
    path = tmp_path / "plate.dxf"
    path.write_bytes(dxf_bytes(part))
    assert check_dxf(path, part) == []
    file, solid = read_dxf(path), build(part)
    low, high = solid.bounding_box().min, solid.bounding_box().max
    assert file.outer.box == pytest.approx((low.X, low.Y, high.X, high.Y), abs=1e-6)
    levels = [low.Z + (high.Z - low.Z) * k / 8 for k in (0.5, 2, 4, 6, 7.5)]
    for opening in file.openings:
        (x, y), r = opening.as_circle()
        # open right to the circle at every level, closed just outside it at one at least
        assert not any(
            solid.is_inside((x + 0.98 * r * cos(a), y + 0.98 * r * sin(a), z))
            for z in levels
            for a in (0, pi / 2, pi)
        )
        assert any(
            solid.is_inside((x + (r + 0.05) * cos(a), y + (r + 0.05) * sin(a), z))
            for z in levels
            for a in (0.1, 2, 4)
        )
    fits = [h for h in part.features if isinstance(h, Hole) and h.tolerance]
    assert not [h for h in fits for o in file.openings if o.centroid == h.at[:2]]


def test_what_is_not_cut_from_plate_has_no_cut_file():
    without = {
        n.removeprefix("smallest-bearing-")
        for n, p in PARTS.items()
        if p.process in ("milled", "turned", "ground") and not cut_section(p)
    }
    assert without == {"holder-body", "tip-flat", "weight-pin", "ballast", "SHIM-3.1x4.1x0.3-ring"}
