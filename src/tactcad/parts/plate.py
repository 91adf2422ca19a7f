"""Plates milled from plate stock: end plates, carrier and the rigs' plates, which differ in contour and
features.
"""

from __future__ import annotations

from collections.abc import Iterable

from tactcad.design.tree import Design

from .description import Extrusion, Feature, Part
from .limits import FACES, Characteristic, DatumFeature, Geometric, within
from .part_materials import plate_material

# A plate is faced on both sides to this, plus and minus mm, so that screws through it end where they should;
# what is thicker is a block, with general tolerances.
THICKNESS, THICKEST = 0.05, 20.0
RIG_COLOUR = "#8d99a6"
BREAK_EDGES = "break edges 0.2"
ANODISED = "Ra 1.6, clear anodised after machining"


def plate(
    design: Design,
    number: str,
    name: str,
    body: Extrusion,
    features: Iterable[Feature],
    finish: str = ANODISED,
    colour: str = RIG_COLOUR,
    notes: tuple[str, ...] = (BREAK_EDGES,),
    characteristics: tuple[Characteristic, ...] = (),
    geometric: tuple[Geometric, ...] = (),
    datums: tuple[DatumFeature, ...] = (),
) -> Part:
    """A plate of the design's plate alloy; its part number is the design's name and `number`."""
    return Part(
        part_no=f"{design.name}-{number}",
        name=name,
        process="milled",
        material=plate_material(design),
        body=body,
        features=tuple(features),
        colour=colour,
        finish=finish,
        notes=notes,
        characteristics=(*_thickness(body, characteristics), *characteristics),
        geometric=geometric,
        datums=datums,
    )


def _thickness(body: Extrusion, own: tuple[Characteristic, ...]) -> tuple[Characteristic, ...]:
    if body.thickness > THICKEST or any(c.name == "thickness" for c in own):
        return ()
    return (within("thickness", body.thickness, THICKNESS, between=FACES),)
