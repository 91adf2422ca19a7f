"""A part's limits in its model (STEP AP242, mm): each dimension, datum and geometric tolerance on the faces
that it is about, for machines to read.

The kernel crashes on some documents with tolerances, so a file is made in a process of its own.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import OCP.XCAFDimTolObjects as xcaf
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.ShapeUpgrade import ShapeUpgrade_RemoveLocations
from OCP.TCollection import TCollection_HAsciiString
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopoDS import TopoDS_Shape
from OCP.XCAFDoc import (
    XCAFDoc_Datum,
    XCAFDoc_Dimension,
    XCAFDoc_DimTolTool,
    XCAFDoc_DocumentTool,
    XCAFDoc_GeomTolerance,
    XCAFDoc_ShapeTool,
)

from tactcad.design.messages import CheckFailure
from tactcad.parts.language.description import Part
from tactcad.parts.language.limits import Characteristic
from tactcad.parts.language.surface import Piece, measured, pieces
from tactcad.solids.occt import FaceFinder, TDF_LabelSequence
from tactcad.solids.step import from_bytes

from .step_file import add_prototype, assembly_in, check_part, new_document, read_document, written
from .step_text import AP242, Header

KINDS = {
    "diameter": xcaf.XCAFDimTolObjects_DimensionType_Size_Diameter,
    "radius": xcaf.XCAFDimTolObjects_DimensionType_Size_Radius,
    "distance": xcaf.XCAFDimTolObjects_DimensionType_Location_LinearDistance,
}
SYMBOLS = {
    "position": xcaf.XCAFDimTolObjects_GeomToleranceType_Position,
    "flatness": xcaf.XCAFDimTolObjects_GeomToleranceType_Flatness,
    "parallelism": xcaf.XCAFDimTolObjects_GeomToleranceType_Parallelism,
    "perpendicularity": xcaf.XCAFDimTolObjects_GeomToleranceType_Perpendicularity,
}
ROUND = xcaf.XCAFDimTolObjects_GeomToleranceTypeValue_Diameter
NOT_ROUND = xcaf.XCAFDimTolObjects_GeomToleranceTypeValue_None
DATUM = re.compile(r"=DATUM\('','',#\d+,\.F\.,'([A-Z]+)'\)")
DIGITS = 9  # of a limit in mm: 0.25 + 0.005 is a binary fraction
AGREES = 1e-6  # mm or mm2, tolerance of a face's place or size when read back

Shapes = tuple[TopoDS_Shape, ...]


@dataclass(frozen=True)
class Annotation:
    """A dimension or geometric tolerance in a model.

    kind    as the kernel calls it
    text    a dimension's note; whether a tolerance's zone is round, and its datums' letters
    values  mm: nominal, minus, plus; or lower and upper limit; or a zone's width
    faces   of a dimension: from, to; of a tolerance: its features, and those of each datum
    """

    kind: object
    text: tuple[str, ...]
    values: tuple[float, ...]
    faces: tuple[Shapes, ...]


def part_step_pmi(part: Part, shape: bytes, header: Header) -> bytes:
    """A part's model with its limits.

    Parameters
    ----------
    part
        It has limits.
    shape
        Its solid in its own frame (solids/step.py).
    header
        Entries of the file's header.

    Returns
    -------
    bytes
        The file in canonical form.

    Raises
    ------
    CheckFailure
        If a limit refers to no face, or the file does not read back to the same part, values, datums and
        faces.
    """
    solid = _without_locations(from_bytes(shape))
    document, tool = new_document()
    label = add_prototype(document, tool, part, solid)
    faces = FaceFinder(solid)
    meant = {c.name: _dimension(part, c, faces) for c in part.characteristics}
    for g in part.geometric:
        features = _faces(part, g.name, [p for f in g.features for p in pieces(part, f)], faces)
        standing = {d.letter: d.feature for d in part.datums}
        datums = (_faces(part, f"datum {x}", pieces(part, standing[x]), faces) for x in g.datums)
        text = ("round" if g.round else "", *g.datums)
        meant[g.name] = Annotation(SYMBOLS[g.symbol], text, (g.zone,), (features, *datums))
    _annotate(document, label, part, meant, faces)
    data = written(document, header, AP242)
    read = read_document(data)
    check_part(data, assembly_in(read), part)
    _check_limits(part, meant, _annotations(read), DATUM.findall(data.decode("latin-1")))
    return data


def _without_locations(solid: TopoDS_Shape) -> TopoDS_Shape:
    """The solid with faces of its own: an extrusion's two are one face in two places, which the kernel mixes
    up."""
    tool = ShapeUpgrade_RemoveLocations()
    tool.Remove(solid)
    return tool.GetResult()


def _dimension(part: Part, c: Characteristic, faces: FaceFinder) -> Annotation:
    on = measured(part, c)
    plus, minus = round(c.upper - c.nominal, DIGITS), round(c.nominal - c.lower, DIGITS)
    note = [c.name, *(["key characteristic"] if c.key else [])]
    values: tuple[float, ...] = (c.nominal, minus, plus)
    if plus < 0 or minus < 0:  # the kernel reads both deviations without their sign
        values = (c.lower, c.upper)
        note.append(f"nominal {c.nominal:g}")
    if len(c.between) > 2:
        note.append(f"to the middle between {' and '.join(c.between[1:])}")
    sides = tuple(_faces(part, c.name, some, faces) for some in (on.first, on.second) if some)
    return Annotation(KINDS[on.kind], (", ".join(note),), values, sides)


def _faces(part: Part, name: str, some: Iterable[Piece], faces: FaceFinder) -> Shapes:
    """The faces on these pieces of surface, each of which must have left one."""
    found = [faces.on(piece) for piece in some]
    if not found or not all(found):
        raise CheckFailure(f"{part.part_no}: {name} refers to a face that the solid does not have")
    return tuple(face for one in found for face in one)


# --- into the kernel's document ---


def _annotate(
    document: TDocStd_Document,
    part_label: TDF_Label,
    part: Part,
    meant: dict[str, Annotation],
    faces: FaceFinder,
) -> None:
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    tool = XCAFDoc_DocumentTool.DimTolTool_s(document.Main())

    def labels(some: Shapes) -> TDF_LabelSequence:
        sequence = TDF_LabelSequence()
        for face in some:
            sequence.Append(shapes.AddSubShape(part_label, face))
        return sequence

    def datum(letter: str, place: int, some: Shapes) -> TDF_Label:
        label, what = tool.AddDatum(), xcaf.XCAFDimTolObjects_DatumObject()
        tool.SetDatum(labels(some), label)
        what.SetName(_text(letter))
        what.SetPosition(place)
        XCAFDoc_Datum.Set_s(label).SetObject(what)
        return label

    for name, one in meant.items():
        if one.kind in KINDS.values():
            label = tool.AddDimension()
            tool.SetDimension(*(labels(some) for some in (*one.faces, ())[:2]), label)
            XCAFDoc_Dimension.Set_s(label).SetObject(_dimension_object(name, one))
        else:
            label = tool.AddGeomTolerance()
            tool.SetGeomTolerance(labels(one.faces[0]), label)
            # the kernel takes the unit from a dimension: without one the number is in metres
            what = _tolerance_object(name, one, 1.0 if part.characteristics else 1e-3)
            XCAFDoc_GeomTolerance.Set_s(label).SetObject(what)
            for place, (letter, some) in enumerate(zip(one.text[1:], one.faces[1:]), start=1):
                tool.SetDatumToGeomTol(datum(letter, place, some), label)
    referred = {letter for g in part.geometric for letter in g.datums}
    for d in part.datums:
        if d.letter not in referred:
            datum(d.letter, 0, _faces(part, f"datum {d.letter}", pieces(part, d.feature), faces))


def _dimension_object(name: str, one: Annotation) -> xcaf.XCAFDimTolObjects_DimensionObject:
    what = xcaf.XCAFDimTolObjects_DimensionObject()
    what.SetType(one.kind)
    if len(one.values) == 3:
        nominal, minus, plus = one.values
        what.SetValue(nominal)
        what.SetLowerTolValue(minus)
        what.SetUpperTolValue(plus)
    else:
        lower, upper = one.values
        what.SetUpperBound(upper)
        what.SetLowerBound(lower)
    what.AddDescription(_text(one.text[0]), _text("dimensional note"))
    what.SetSemanticName(_text(f"limit {name}"))  # the writer drops the first word
    return what


def _tolerance_object(name: str, one: Annotation, unit: float) -> xcaf.XCAFDimTolObjects_GeomToleranceObject:
    what = xcaf.XCAFDimTolObjects_GeomToleranceObject()
    what.SetType(one.kind)
    what.SetValue(one.values[0] * unit)
    what.SetTypeOfValue(ROUND if one.text[0] else NOT_ROUND)
    what.SetSemanticName(_text(f"limit {name}"))
    return what


def _text(text: str) -> TCollection_HAsciiString:
    return TCollection_HAsciiString(text)


# --- reading back ---


def _check_limits(
    part: Part, meant: dict[str, Annotation], read: Sequence[Annotation], letters: Sequence[str]
) -> None:
    """Raise CheckFailure if a limit is missing, different, or not one of the part's.

    The kernel does not read a datum that no tolerance refers to: `letters` are from the text.
    """
    left = list(read)
    for name, one in meant.items():
        alike = next((other for other in left if _same_annotation(one, other)), None)
        if alike is None:
            raise CheckFailure(
                f"{part.part_no}: {name} does not read back from the AP242 model as it was meant"
            )
        left.remove(alike)
    datums = sorted(d.letter for d in part.datums)
    if left or sorted(letters) != datums:
        raise CheckFailure(
            f"{part.part_no}: the AP242 model has {len(left)} limits too many, and datums "
            f"{', '.join(sorted(letters))} instead of {', '.join(datums)}"
        )


def _annotations(document: TDocStd_Document) -> list[Annotation]:
    """The dimensions and geometric tolerances in a document that was read."""
    tool = XCAFDoc_DocumentTool.DimTolTool_s(document.Main())
    dimensions, tolerances = TDF_LabelSequence(), TDF_LabelSequence()
    tool.GetDimensionLabels(dimensions)
    tool.GetGeomToleranceLabels(tolerances)
    return [*map(_read_dimension, _each(dimensions)), *map(_read_tolerance, _each(tolerances))]


def _read_dimension(label: TDF_Label) -> Annotation:
    what = XCAFDoc_Dimension.Set_s(label).GetObject()
    notes = tuple(what.GetDescription(i).ToCString() for i in range(what.NbDescriptions()))
    values = what.GetValues()
    numbers = tuple(values.Value(i) for i in range(1, values.Length() + 1))
    return Annotation(what.GetType(), notes, numbers, _referred(label))


def _read_tolerance(label: TDF_Label) -> Annotation:
    what, datums = XCAFDoc_GeomTolerance.Set_s(label).GetObject(), TDF_LabelSequence()
    XCAFDoc_DimTolTool.GetDatumWithObjectOfTolerLabels_s(label, datums)
    placed = [(XCAFDoc_Datum.Set_s(d).GetObject(), _referred(d)) for d in _each(datums)]
    placed.sort(key=lambda pair: pair[0].GetPosition())
    text = ("round" if what.GetTypeOfValue() == ROUND else "", *(d.GetName().ToCString() for d, _ in placed))
    faces = (*_referred(label), *(some for _, groups in placed for some in groups))
    return Annotation(what.GetType(), text, (what.GetValue(),), faces)


def _referred(label: TDF_Label) -> tuple[Shapes, ...]:
    """The faces of a dimension, tolerance or datum; of a dimension from one side to another."""
    sides = TDF_LabelSequence(), TDF_LabelSequence()
    XCAFDoc_DimTolTool.GetRefShapeLabel_s(label, *sides)
    return tuple(tuple(map(XCAFDoc_ShapeTool.GetShape_s, _each(some))) for some in sides if some.Length())


def _each(labels: TDF_LabelSequence) -> list[TDF_Label]:
    return [labels.Value(i) for i in range(1, labels.Length() + 1)]


def _same_annotation(a: Annotation, b: Annotation) -> bool:
    return (
        (a.kind, a.text, len(a.faces)) == (b.kind, b.text, len(b.faces))
        and _agree(a.values, b.values, 10**-DIGITS)
        and all(_same_faces(some, others) for some, others in zip(a.faces, b.faces))
    )


def _same_faces(some: Shapes, others: Shapes) -> bool:
    there = [_where(face) for face in others]
    return len(some) == len(others) and all(any(_agree(_where(f), w, AGREES) for w in there) for f in some)


def _where(face: TopoDS_Shape) -> tuple[float, ...]:
    """Centre and area of a face, mm and mm2."""
    surface = GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, surface)
    centre = surface.CentreOfMass()
    return (centre.X(), centre.Y(), centre.Z(), surface.Mass())


def _agree(a: Sequence[float], b: Sequence[float], within: float) -> bool:
    return len(a) == len(b) and all(abs(p - q) <= within for p, q in zip(a, b))
