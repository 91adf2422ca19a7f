"""Plates milled from plate stock: end plates, carrier and the rigs' plates, which differ in contour and
features.
"""

from __future__ import annotations

from collections.abc import Iterable

from tactcad.design.tree import CommonTables

from .description import Extrusion, Feature, Hole, Part
from .limits import FACES, Characteristic, DatumFeature, Geometric, within
from .metric import METRIC
from .stock import plate_material

# A plate is faced on both sides to this, plus and minus mm, so that screws through it end in place; a thicker
# part is a block, with general tolerances.
THICKNESS, THICKEST = 0.05, 20.0
# Zone of a screw hole, mm; chosen: drilled in one clamping. A screw of M3 in a hole of 3.4 takes it twice.
PLACE = 0.1
FRAME = ("A", "B", "C")  # the datums of a plate's holes
FRAME_DATUMS = (DatumFeature("A", FACES[0]), DatumFeature("B", "left edge"), DatumFeature("C", "lower edge"))
RIG_COLOUR = "#8d99a6"
BREAK_EDGES = "break edges 0.2"
ANODISED = "Ra 1.6, clear anodised 10 um after machining"


def plate(
    design: CommonTables,
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
    """A plate of the design's plate alloy; its part number is the design's name and `number`.

    Screw holes without a stated position get a zone each, from a face and two edges.
    """
    features = tuple(features)
    limited = {f for c in characteristics for f in c.between} | {f for g in geometric for f in g.features}
    geometric += tuple(
        Geometric(f"{name.replace('_', ' ')} holes", "position", PLACE, (name,), FRAME, True)
        for name in _screw_holes(features)
        if name not in limited
    )
    if geometric and not datums:
        datums = FRAME_DATUMS
    return Part(
        part_no=f"{design.name}-{number}",
        name=name,
        process="milled",
        material=plate_material(design),
        body=body,
        features=features,
        colour=colour,
        finish=finish,
        notes=notes,
        characteristics=(*_thickness(body, characteristics), *characteristics),
        geometric=geometric,
        datums=datums,
    )


def _screw_holes(features: Iterable[Feature]) -> list[str]:
    """Names of holes that screws pass or enter, each once."""
    clearances = [m.clearance for m in METRIC.values()]
    holes = (f for f in features if isinstance(f, Hole) and not f.tolerance)
    return list(dict.fromkeys(h.name for h in holes if h.thread or h.counterbore or h.diameter in clearances))


def _thickness(body: Extrusion, own: tuple[Characteristic, ...]) -> tuple[Characteristic, ...]:
    if body.thickness > THICKEST or any(c.name == "thickness" for c in own):
        return ()
    return (within("thickness", body.thickness, THICKNESS, between=FACES),)
