"""A scene as one assembly of build123d, for viewers that show what build123d makes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from build123d import Color, Compound, Shape, Solid
from OCP.TopoDS import TopoDS_Shape

from tactcad.scenes.scene import Placement, Scene

from .occt import placed_shape

Leaf = tuple[tuple[str, ...], Shape]  # the sub-assemblies that hold it, the outer one first; the part


def assembly_tree(
    scene: Scene, shapes: Mapping[str, TopoDS_Shape], under: Mapping[str, tuple[str, ...]]
) -> Compound:
    """The scene's parts, each named by its designator and coloured, in named sub-assemblies; equal parts
    share one shape.

    Parameters
    ----------
    scene
        Names the whole.
    shapes
        Solids by part number, each in its own frame, mm.
    under
        By designator the names of the sub-assemblies that hold it, the outer one first.
    """
    leaves = [(under[p.designator], _leaf(p, shapes[p.part.part_no])) for p in scene.placements]
    return _compound(scene.name, leaves)


def _leaf(placement: Placement, shape: TopoDS_Shape) -> Solid:
    solid = Solid(placed_shape(shape, placement.origin, placement.rotation))
    solid.label, solid.color = placement.designator, Color(placement.part.colour)
    return solid


def _compound(name: str, leaves: Sequence[Leaf]) -> Compound:
    names = dict.fromkeys(path[0] for path, _ in leaves if path)
    below = [_compound(n, [(path[1:], s) for path, s in leaves if path and path[0] == n]) for n in names]
    return Compound(label=name, children=[*below, *(shape for path, shape in leaves if not path)])
