"""Materials that no field of a design names, and a part's stock: flat stock as sold, the allowance on each
face and edge, and the section in its cut file; plates milled from it. Lengths in mm.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from tactcad.contour import rectangle
from tactcad.design.materials import ALLOYS, family
from tactcad.design.text_values import data_rows, number
from tactcad.design.tree import CommonTables

from .description import Extrusion, Feature, Hole, Material, Part, Pocket, section
from .limits import FACES, Characteristic, DatumFeature, Geometric, general, within
from .metric import METRIC

# Densities in kg/m3: usual values of these materials.
ALUMINIUM = Material("aluminium", 2700, magnetic="no")
BRASS = Material("brass, nickel plated", 8500)
CARBON_STEEL = Material("steel", 7850)
PLAIN_STEEL = Material("S235JR steel", 7850, standard="EN 10025-2", magnetic="yes")
RUBBER = Material("rubber", 1200)
STAINLESS = Material("X5CrNi18-10 (1.4301)", 7900, standard="EN 10088-3", magnetic="weakly")  # bar
STAINLESS_PLATE = replace(STAINLESS, standard="EN 10088-2")
# Martensitic, annealed: a magnetic chuck holds it for grinding. Density after EN 10088-1.
MAGNETIC_STAINLESS = Material("X46Cr13 (1.4034)", 7700, "+A", "EN 10088-2", magnetic="yes")
# Plate is stretched after quenching, so that it stays flat when one side is milled off (EN 515).
STRETCHED = {"-T6": "-T651", "-T3": "-T351"}


def plate_material(design: CommonTables) -> Material:
    """End plates, carrier and the rigs' plates: the design's `plate_alloy`."""
    alloy = bar_material(design)
    stem, temper = alloy.name[:-3], alloy.name[-3:]
    standard = ALLOYS[design.plate_alloy].standard
    return replace(alloy, name=stem + STRETCHED.get(temper, temper), standard=standard)


def bar_material(design: CommonTables) -> Material:
    """Extruded bar of the plates' alloy, for turned parts."""
    alloy = ALLOYS[design.plate_alloy]
    standard = alloy.standard.replace("EN 485-2", "EN 755-2")
    return Material(alloy.name, alloy.density, standard=standard, magnetic=alloy.magnetic or "")


def held_for_grinding(material: Material) -> str:
    """Workholding on a surface grinder: a magnetic chuck holds magnetic material only."""
    if material.magnetic == "yes":
        return "on a magnetic chuck, demagnetised afterwards"
    if material.magnetic:
        return "held by vacuum or wax: a magnetic chuck does not hold it"
    return "on a magnetic chuck only if a magnet draws it"


# Over the finished edge, mm, by the thickness that is cut, up to `to`: after ISO 9013:2017, machining
# allowances of thermal cuts, not read again here; a saw takes less.
EDGE = ((20.0, 2.0), (50.0, 3.0), (80.0, 5.0), (120.0, 7.0))
# Over each finished face, mm; chosen: milled off, the skin and bow of a rolled plate of 200 mm; ground off
# (and so before it is wire-cut), the skin alone.
FACE = {"ground": 0.2, "milled": 0.5, "wire-cut": 0.2, "etched": 0.0}
# Spring strip is rolled to any thickness up to this, mm: picked by the part's own limits; chosen. It is
# cold-rolled: the table's limits, of hot-rolled steel, are not its own.
STRIP, THICKEST_STRIP = "EN 10151", 1.0
_SOLD = data_rows(__file__, "stock")


@dataclass(frozen=True)
class FlatStock:
    """Flat stock of a part.

    thickness, lower, upper  as ordered, and the limits of delivery
    standard                 of these limits; "" if no table here has them
    face, edge               over the finished part, at least, on each face and on each edge; 0: not finished
    """

    thickness: float
    lower: float
    upper: float
    standard: str
    face: float
    edge: float


def own_thickness(part: Part) -> Characteristic | None:
    """The limits that a part states between its two faces."""
    return next((c for c in part.characteristics if {*c.between} == {*FACES}), None)


def stock_of(part: Part) -> FlatStock | None:
    """The thinnest stock sold that leaves enough on both faces. Wire-cut or etched sheet of a thickness
    that is sold is left as rolled, picked by measurement if the part's limits are closer than the standard's.
    None for parts that are no extrusion, or are turned, and if no stock sold is thick enough."""
    if not isinstance(part.body, Extrusion) or part.process not in FACE:
        return None
    t, own, metal = part.body.thickness, own_thickness(part), family(part.material.density)
    sold = [
        (number(r["thickness"]), float(r["tolerance"]), r["standard"]) for r in _SOLD if r["metal"] == metal
    ]
    strip = part.material.standard.startswith(STRIP)
    if strip and t <= THICKEST_STRIP:
        sold = []
    standard = next(("" if strip else name for size, _, name in sold if size == t), None if sold else "")
    if part.by_contour and own and standard is not None:
        return FlatStock(t, own.lower, own.upper, standard, 0.0, 0.0)
    face, high = FACE[part.process], own.upper if own else t + general(t)
    for size, off, standard in sold:
        if size - off >= high + 2 * face - 1e-9:
            edge = 0.0 if part.by_contour else next(e for to, e in EDGE if size <= to)
            return FlatStock(size, size - off, size + off, standard, face, edge)
    return None


def cut_section(part: Part) -> Extrusion | None:
    """The section that a part's cut file describes, extruded; None if the part has no cut file.

    Wire-cut and etched parts are cut with all their holes. Parts milled or ground from plate have a cut file
    of the blank: a rectangle that leaves material on every edge, as thick as its stock, without holes. Parts
    with a pocket, or thicker than wide, are milled from a block and have no cut file.
    """
    if part.by_contour:
        outer, openings = section(part)
        return Extrusion(outer, part.extrusion.thickness, openings)
    stock = stock_of(part) if _is_plate(part) else None
    if stock is None:
        return None
    x0, y0, x1, y1 = part.extrusion.outer.box
    e = stock.edge
    return Extrusion(rectangle(x0 - e, y0 - e, x1 + e, y1 + e), stock.thickness)


def _is_plate(part: Part) -> bool:
    if not isinstance(part.body, Extrusion) or any(isinstance(f, Pocket) for f in part.features):
        return False
    x0, y0, x1, y1 = part.body.outer.box
    return part.body.thickness < min(x1 - x0, y1 - y0)


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
