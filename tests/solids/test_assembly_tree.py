"""A scene as an assembly of build123d: sub-assemblies in sub-assemblies, each part where and what it is."""

from __future__ import annotations

import pytest

pytestmark = pytest.mark.cad
DEEP = ("outer", "inner")


@pytest.fixture(scope="module")
def tree(macro_scene, macro_shapes):
    from tactcad.solids.assembly_tree import assembly_tree

    # elements two deep, spacers one deep in the same, the rest at the top
    deep = {"E": DEEP, "SP": DEEP[:1]}
    under = {p.designator: deep.get(p.designator.rstrip("0123456789"), ()) for p in macro_scene.placements}
    return assembly_tree(macro_scene, macro_shapes, under)


def labels(node) -> set[str]:
    return {child.label for child in node.children}


def test_each_part_stands_in_its_sub_assembly(tree, macro_scene):
    names = {p.designator for p in macro_scene.placements}
    elements = {name for name in names if name.startswith("E") and name[1:].isdigit()}
    spacers = {name for name in names if name.startswith("SP")}
    assert tree.label == macro_scene.name and elements and spacers
    (outer,) = [child for child in tree.children if child.label == "outer"]
    (inner,) = [child for child in outer.children if child.label == "inner"]
    assert labels(inner) == elements
    assert labels(outer) == spacers | {"inner"}
    assert labels(tree) == names - elements - spacers | {"outer"}


def test_parts_are_the_scenes_and_equal_ones_share_a_shape(tree, macro_scene):
    leaves = {leaf.label: leaf for leaf in tree.leaves}
    shared = {}
    for p in macro_scene.placements:
        leaf = leaves[p.designator]
        assert leaf.volume == pytest.approx(p.part.volume, rel=1e-6)
        assert tuple(leaf.location.position) == pytest.approx(p.origin, abs=1e-9)
        first = shared.setdefault(p.part.part_no, leaf)
        assert leaf.wrapped.IsPartner(first.wrapped)
    # the whole as one shape, as a STEP writer sees it; a compound's own volume leaves nested ones out
    whole = sum(solid.volume for solid in tree.solids())
    assert whole == pytest.approx(sum(p.part.volume for p in macro_scene.placements), rel=1e-6)
