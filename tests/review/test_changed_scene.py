"""Added, removed and kept material are what closed forms say, and what did not change is the same."""

from __future__ import annotations

from math import pi

import pytest
from variants import variant

from tactcad.review.changed_scene import changed_scene
from tactcad.scenes import make_scene

pytestmark = pytest.mark.cad


def pieces(before, after, scene: str = "array"):
    from tactcad.review.subject import shapes_of

    made = tuple(shapes_of(d, lambda _: None) for d in (before, after))
    return changed_scene((before, after), (make_scene(before, scene), make_scene(after, scene)), made)


def volumes(found) -> dict[tuple[str, str], float]:
    from tactcad.solids.measure import volume

    return {(p.designator, p.kind): volume(p.shape) for p in found}


def test_a_design_is_the_same_as_itself():
    design = variant(base="soft-tissue")
    assert {p.kind for p in pieces(design, design)} == {"same"}


def test_a_thicker_hinge_adds_what_the_closed_form_says_and_nothing_else():
    before = variant(base="soft-tissue")
    after = variant({"element.hinge_thickness": before.element.hinge_thickness + 0.01}, "soft-tissue")
    found = volumes(pieces(before, after))
    was, now = ({p.designator: p.part for p in make_scene(d, "array").placements} for d in (before, after))
    touched = {d for d, kind in found if kind != "same"}
    assert touched and all(d.startswith("E") for d in touched)
    for d in (d for d in touched if was[d].process == "wire-cut"):
        came, went = found.get((d, "added"), 0.0), found.get((d, "removed"), 0.0)
        assert came - went == pytest.approx(now[d].volume - was[d].volume, abs=1e-6)
        assert found[d, "kept"] + went == pytest.approx(was[d].volume, rel=1e-9)


@pytest.mark.slow  # the kernel on a whole array, twice
def test_a_wider_pitch_moves_elements_and_no_material_is_lost():
    before = variant(base="soft-tissue")
    after = variant({"array.pitch": before.array.pitch + 0.5}, "soft-tissue")
    found = volumes(pieces(before, after))
    was, now = ({p.designator: p.part for p in make_scene(d, "array").placements} for d in (before, after))
    moved = {d for d, kind in found if d.startswith("E") and kind == "added"}
    assert len(moved) > 2
    for d in moved:
        kept = found.get((d, "kept"), 0.0)
        assert kept + found[d, "removed"] == pytest.approx(was[d].volume, rel=1e-6)
        assert kept + found[d, "added"] == pytest.approx(now[d].volume, rel=1e-6)


def test_the_material_of_two_cylinders_that_overlap_is_told_apart():
    from build123d import Cylinder, Pos

    from tactcad.solids.changed import changed
    from tactcad.solids.measure import volume

    low, high = Cylinder(2.0, 10.0), Pos(0, 0, 4.0) * Cylinder(2.0, 10.0)
    got = changed(low.wrapped, high.wrapped)
    assert got.by == "kernel"
    for shape, height in ((got.kept, 6.0), (got.removed, 4.0), (got.added, 4.0)):
        assert volume(shape) == pytest.approx(4.0 * pi * height, rel=1e-9)
    apart = changed(low.wrapped, (Pos(9, 0, 0) * Cylinder(2.0, 10.0)).wrapped)
    assert apart.kept is None and volume(apart.added) == pytest.approx(40.0 * pi)


class Fails:
    """A boolean of the kernel that raises, says that it failed, or gives wrong material."""

    def __init__(self, how: str) -> None:
        self.how = how

    def __call__(self, a, b):
        from OCP.Standard import Standard_Failure

        if self.how == "raises":
            raise Standard_Failure("injected")
        self.shape = a
        return self

    def IsDone(self) -> bool:
        return self.how != "not done"

    def Shape(self):
        return self.shape


@pytest.fixture(params=["raises", "not done", "wrong"])
def no_boolean(request, monkeypatch):
    import tactcad.solids.changed as module

    for name in ("BRepAlgoAPI_Common", "BRepAlgoAPI_Cut"):
        monkeypatch.setattr(module, name, Fails(request.param))


@pytest.mark.by_day(1, "meshes each")
def test_meshes_tell_material_apart_where_the_kernel_fails(no_boolean):
    from build123d import Cylinder, Pos
    from OCP.BRepCheck import BRepCheck_Analyzer

    from tactcad.solids.changed import CHORD, changed
    from tactcad.solids.measure import volume

    low, high = Cylinder(2.0, 10.0), Pos(0, 0, 4.0) * Cylinder(2.0, 10.0)
    got = changed(low.wrapped, high.wrapped)
    assert got.by == "meshes"
    for shape, height in ((got.kept, 6.0), (got.removed, 4.0), (got.added, 4.0)):
        assert BRepCheck_Analyzer(shape).IsValid()
        # inscribed polygons: all that is missing lies within a chord's error of the round face
        assert 0.0 <= 4.0 * pi * height - volume(shape) <= 4.0 * pi * height * CHORD
    apart = changed(low.wrapped, (Pos(9, 0, 0) * Cylinder(2.0, 10.0)).wrapped)
    assert apart.kept is None and volume(apart.added) == pytest.approx(40.0 * pi, rel=CHORD)


@pytest.mark.by_day(1, "meshes of a whole array each")
def test_a_hinge_5_um_thicker_is_found_by_meshes_too(no_boolean):
    before = variant()
    after = variant({"element.hinge_thickness": before.element.hinge_thickness + 0.005})
    found = pieces(before, after)
    was, now = ({p.designator: p.part for p in make_scene(d, "array").placements} for d in (before, after))
    by = {(p.designator, p.kind): p for p in found if p.kind != "same"}
    assert by and all(p.remark.startswith("by meshes") for p in by.values())
    measured = volumes(by.values())
    for d in {d for d, _ in by}:
        assert (d, "removed") not in by
        # the same faces are meshed alike on both sides: what came has the exact volume
        assert measured[d, "added"] == pytest.approx(now[d].volume - was[d].volume, rel=1e-6)


def test_where_nothing_tells_material_apart_the_whole_parts_are_shown(no_boolean, monkeypatch):
    from build123d import Box

    import tactcad.solids.changed as module

    def fails(*_):
        raise ValueError("not a closed mesh")

    monkeypatch.setattr(module, "closed", fails)
    old, new = Box(1, 2, 3).wrapped, Box(1, 2, 4).wrapped
    got = module.changed(old, new)
    assert (got.kept, got.removed, got.added, got.by) == (None, old, new, "nothing")


def test_a_round_face_that_was_meshed_twice_is_no_change(no_boolean):
    """The same rod, turned: its facets lie elsewhere, and what lies between them is no material."""
    from build123d import Cylinder, Rot

    from tactcad.solids.changed import changed

    rod = Cylinder(2.0, 10.0)
    got = changed(rod.wrapped, (Rot(0, 0, 3.7) * rod).wrapped)
    assert got.by == "meshes" and got.removed is None and got.added is None
