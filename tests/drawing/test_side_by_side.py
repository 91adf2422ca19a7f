"""Parts side by side, the last resort: each at a preferred scale that is stated, on a full sheet, clean and
complete."""

from __future__ import annotations

import re
from itertools import combinations

import numpy as np
import pytest
from built import shapes_of
from variants import variant

from tactcad.drawing.assemblies import numbered
from tactcad.drawing.assemblies.assembly_sheets import assembly_faults, assembly_sheets
from tactcad.drawing.engine.sheet_files import pdf_bytes
from tactcad.scenes import make_scene
from tactcad.scenes.bom import bom_rows

AREA = (25.0, 74.0, 405.0, 274.0)


def square(a: float):
    corners = [(0.0, 0.0), (a, 0.0), (a, a), (0.0, a), (0.0, 0.0)]
    return [tuple(pair) for pair in zip(corners, corners[1:])]


def box(lines) -> np.ndarray:
    points = np.array([p for line in lines for p in line])
    return np.array([points.min(axis=0), points.max(axis=0)])


@pytest.mark.parametrize("seed", range(4))
def test_every_part_at_its_scale_inside_the_sheet_and_clear_of_the_others(seed):
    rng = np.random.default_rng(seed)
    sides = {n: float(10 ** rng.uniform(0.3, 2.6)) for n in range(1, int(rng.integers(5, 60)))}
    (page,) = numbered.side_by_side({n: square(a) for n, a in sides.items()}, AREA)
    assert [part.balloon.item for part in page] == list(sides)
    boxes = []
    for part in page:
        b = box(part.lines)
        a, f = sides[part.balloon.item], part.scale[0] / part.scale[1]
        assert b[1] - b[0] == pytest.approx([a * f, a * f])
        assert max(part.scale) in (1, 2, 5, 10, 20, 50) and min(part.scale) == 1
        above, below = part.balloon.centre[1] + 4.5, part.below[1]
        boxes.append(
            np.array(
                [
                    [min(b[0, 0], part.balloon.centre[0] - 4.5), below],
                    [max(b[1, 0], part.balloon.centre[0] + 4.5), above],
                ]
            )
        )
        assert (boxes[-1][0] >= AREA[:2]).all() and (boxes[-1][1] <= AREA[2:]).all() and below < b[0, 1]
    assert not any((np.minimum(a[1], b[1]) > np.maximum(a[0], b[0])).all() for a, b in combinations(boxes, 2))
    # none is dwarfed: between two neighbours of the series lies a factor of 2.5 at most
    widths = [b[1, 0] - b[0, 0] for b in map(box, (part.lines for part in page))]
    assert max(widths) / min(widths) < 2.6


def test_parts_too_many_for_one_sheet_go_over_several_and_too_large_ones_are_refused():
    own = {n: square(30.0) for n in range(300)}
    made = numbered.side_by_side(own, AREA)
    assert len(made) > 1 and [part.balloon.item for page in made for part in page] == list(own)
    assert numbered.side_by_side({1: square(50 * 400.0)}, AREA) is None


@pytest.mark.cad
def test_where_no_exploded_view_finds_room_the_sheets_are_complete_all_the_same(monkeypatch):

    monkeypatch.setattr(numbered, "exploded_page", lambda *_: None)
    design = variant(base="soft-tissue")
    scene = make_scene(design, "array")
    rows = bom_rows(scene, design.design, {})
    sheets = assembly_sheets(design, scene, rows, shapes_of(scene))
    assert (
        assembly_faults(
            pdf_bytes(sheets, "x", "y", "2026-11-21"), f"{design.name}-array", design.design.revision, rows
        )
        == []
    )
    texts = [t for t in sheets[1].texts if re.fullmatch(r"\d+:\d+", t.text)]
    main = [t.text for t in texts if t.role == "table"]
    assert (
        len(main) == 1
        and {t.text for t in texts if t.role != "table"}
        and main[0] not in {t.text for t in texts if t.role != "table"}
    )
