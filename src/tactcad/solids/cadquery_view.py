"""The same parts and scenes for people who work in CadQuery, and their models as bought parts here.

from tactcad.solids.cadquery_view import assembly, workplane from tactcad.parts.rules import load from
tactcad.scenes import make_scene

scene = make_scene(load("macro-array"), "array")
workplane(scene.parts[1])      # a cadquery.Workplane with the part's solid
assembly(scene).export("array.step")
"""

from __future__ import annotations

from pathlib import Path

import cadquery as cq

from tactcad.design.messages import InputError
from tactcad.parts.language.description import Material, Part, Purchase
from tactcad.scenes.scene import Scene

from .build import build
from .occt import location


def workplane(part: Part) -> cq.Workplane:
    """The part's solid in its own frame (mm), on CadQuery's stack."""
    return cq.Workplane("XY").newObject([cq.Shape.cast(build(part))])


def assembly(scene: Scene) -> cq.Assembly:
    """The scene with the same designators, colours and places; equal parts share one solid."""
    solids = {part.part_no: cq.Shape.cast(build(part)) for part in scene.parts}
    whole = cq.Assembly(name=scene.name)
    for p in scene.placements:
        r, g, b = (int(p.part.colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
        whole.add(
            solids[p.part.part_no],
            name=p.designator,
            loc=cq.Location(location(p.origin, p.rotation)),
            color=cq.Color(r, g, b, 1.0),
            metadata={"part_no": p.part.part_no},
        )
    return whole


def bought_from_step(
    path: str | Path, part_no: str, name: str, material: Material, purchase: Purchase
) -> Part:
    """A bought part whose shape is the one solid of a STEP file.

    Parameters
    ----------
    path
        The STEP file, mm.
    part_no, name, material, purchase
        Of the part, see `tactcad.parts.language.description.Part`.

    Raises
    ------
    InputError
        If the file does not hold exactly one solid.
    """
    from .step import model_file

    return Part(part_no, name, "bought", material, model_file(path), purchase=purchase)


def bought_from_cadquery(
    model: cq.Workplane | cq.Shape,
    path: str | Path,
    part_no: str,
    name: str,
    material: Material,
    purchase: Purchase,
) -> Part:
    """A bought part modelled in CadQuery.

    Parameters
    ----------
    model
        One solid, mm.
    path
        The STEP file that is written, and read from then on.
    part_no, name, material, purchase
        Of the part, see `tactcad.parts.language.description.Part`.

    Raises
    ------
    InputError
        If the model is not one solid.
    """
    shape = model.val() if isinstance(model, cq.Workplane) else model
    solids = shape.Solids() if isinstance(shape, cq.Shape) else []
    if len(solids) != 1:
        raise InputError(
            part_no, "a CadQuery model that is not one solid", value=len(solids), legal="one solid"
        )
    solids[0].exportStep(str(path))
    return bought_from_step(path, part_no, name, material, purchase)
