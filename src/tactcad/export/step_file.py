"""STEP files (AP214, mm): one product a single part, and assemblies with shared prototypes.

In an assembly the product of a part carries its part number, each instance its reference designator.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from math import isclose

from OCP.IFSelect import IFSelect_RetDone
from OCP.Quantity import Quantity_Color, Quantity_ColorRGBA, Quantity_TOC_sRGB
from OCP.STEPCAFControl import STEPCAFControl_Reader, STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_SOLID
from OCP.TopoDS import TopoDS_Shape
from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

from tactcad.design.messages import CheckFailure
from tactcad.parts.language.description import Part
from tactcad.profiling import under_way
from tactcad.scenes.scene import Placement, Scene
from tactcad.solids.measure import volume
from tactcad.solids.occt import TDF_LabelSequence, location, subshapes
from tactcad.solids.step import leave_unmended, set_up_writer, silence
from tactcad.solids.valid import is_clear_prism, is_valid

from .step_text import AP214, AP242, Header, canonical

# Agreement of the written and the read file: a share of the volume, and mm of a place.
VOLUME_AGREES = 1e-6
PLACE_AGREES = 1e-7


def part_step(part: Part, shape: TopoDS_Shape, header: Header) -> bytes:
    """A part alone as a STEP file: one PRODUCT, no assembly.

    Parameters
    ----------
    part
        What the file is compared with.
    shape
        Its solid in its own frame, mm.
    header
        Entries of the file's header.

    Returns
    -------
    bytes
        The file in canonical form.

    Raises
    ------
    CheckFailure
        If it differs when read back: product, validity, or the volume by more than a share of 1e-6.
    """
    document, shape_tool = new_document()
    add_prototype(document, shape_tool, part, shape)
    data = written(document, header)
    check_part(data, read_assembly(data), part)
    return data


def scene_step(scene: Scene, shapes: Mapping[str, TopoDS_Shape], header: Header) -> bytes:
    """A scene as a STEP assembly named after the header.

    Parameters
    ----------
    scene
        Its placements become instances, named by designator, of one product a part.
    shapes
        Solids by part number, each in its own frame, mm.
    header
        Entries of the file's header.

    Returns
    -------
    bytes
        The file in canonical form.

    Raises
    ------
    CheckFailure
        If it does not read back to the same names, places (1e-7 mm) and volumes.
    """
    document = scene_document(scene, shapes, header.name)
    under_way("writing")
    data = written(document, header)
    under_way("reading back")
    read = read_assembly(data)
    if read.name != header.name or not read.valid:
        raise CheckFailure(f"scene {scene.name}: STEP file reads back as {read.name!r}, valid: {read.valid}")
    for part in scene.parts:
        _check_volume(read, part)
    _check_instances(read.instances, scene.placements, scene.name)
    return data


def scene_document(scene: Scene, shapes: Mapping[str, TopoDS_Shape], name: str) -> TDocStd_Document:
    """The assembly of that name, before it is written."""
    document, shape_tool = new_document()
    prototypes = {p.part_no: add_prototype(document, shape_tool, p, shapes[p.part_no]) for p in scene.parts}
    top = shape_tool.NewShape()
    _name(top, name)
    for p in scene.placements:
        _name(
            shape_tool.AddComponent(top, prototypes[p.part.part_no], location(p.origin, p.rotation)),
            p.designator,
        )
    shape_tool.UpdateAssemblies()
    return document


def new_document() -> tuple[TDocStd_Document, XCAFDoc_ShapeTool]:
    document = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    return document, XCAFDoc_DocumentTool.ShapeTool_s(document.Main())


def add_prototype(
    document: TDocStd_Document, tool: XCAFDoc_ShapeTool, part: Part, shape: TopoDS_Shape
) -> TDF_Label:
    label = tool.AddShape(shape, False)
    _name(label, part.part_no)
    colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    colours.SetColor(label, _rgba(part.colour), XCAFDoc_ColorSurf)
    return label


def _name(label: TDF_Label, name: str) -> None:
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))


def _rgba(colour: str) -> Quantity_ColorRGBA:
    r, g, b = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    return Quantity_ColorRGBA(Quantity_Color(r, g, b, Quantity_TOC_sRGB))  # the kernel keeps linear RGB


def written(document: TDocStd_Document, header: Header, schema: str = AP214) -> bytes:
    """The document as a STEP file; of AP242 alone with its dimensions and tolerances."""
    writer = STEPCAFControl_Writer()
    writer.SetColorMode(True)
    writer.SetNameMode(True)
    set_up_writer("AP242DIS" if schema == AP242 else "AP214IS")
    writer.SetDimTolMode(schema == AP242)
    writer.Transfer(document, STEPControl_AsIs)
    # no file: a killed export leaves none behind, and a full temporary folder does not matter
    stream = BytesIO()
    if writer.WriteStream(stream) != IFSelect_RetDone:
        raise CheckFailure(f"{header.name}: the kernel could not write the STEP file")
    return canonical(stream.getvalue().decode("latin-1"), header, schema).encode("latin-1")


# --- reading back ---


@dataclass(frozen=True)
class Instance:
    """One component as read: designator, product name, 3 x 4 matrix (row major)."""

    designator: str
    product: str
    matrix: tuple[float, ...]


@dataclass(frozen=True)
class Assembly:
    """A STEP file as read. shapes: by product name, and whether they are valid; solids: volumes (mm3) of each
    one's solids."""

    name: str
    instances: tuple[Instance, ...]
    shapes: Mapping[str, TopoDS_Shape]
    solids: Mapping[str, tuple[float, ...]]
    valid: bool


def read_assembly(data: bytes) -> Assembly:
    """Names, places and volumes in a STEP file. Raises CheckFailure if it cannot be read."""
    return assembly_in(read_document(data))


def read_document(data: bytes) -> TDocStd_Document:
    """A STEP file as a document, its dimensions and tolerances too. Raises CheckFailure if it cannot be
    read."""
    silence()
    document, _ = new_document()
    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    reader.SetGDTMode(True)
    read = reader.ReadStream("written.step", BytesIO(data)) == IFSelect_RetDone
    leave_unmended(reader)
    if not read or not reader.Transfer(document):
        raise CheckFailure("the written STEP file cannot be read back")
    return document


def assembly_in(document: TDocStd_Document) -> Assembly:
    """Names, places and volumes in a document that was read. Raises CheckFailure unless it has one top."""
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    free = TDF_LabelSequence()
    tool.GetFreeShapes(free)
    if free.Length() != 1:
        raise CheckFailure(f"the STEP file has {free.Length()} top-level shapes instead of one")
    top = free.Value(1)
    parts = TDF_LabelSequence()
    XCAFDoc_ShapeTool.GetComponents_s(top, parts)
    instances: list[Instance] = []
    products: dict[str, TDF_Label] = {}
    for i in range(1, parts.Length() + 1):
        component, prototype = parts.Value(i), TDF_Label()
        XCAFDoc_ShapeTool.GetReferredShape_s(component, prototype)
        product = _name_of(prototype)
        products.setdefault(product, prototype)
        trsf = XCAFDoc_ShapeTool.GetLocation_s(component).Transformation()
        matrix = tuple(trsf.Value(r, c) for r in (1, 2, 3) for c in (1, 2, 3, 4))
        instances.append(Instance(_name_of(component), product, matrix))
    if not instances:
        products[_name_of(top)] = top
    shapes = {name: XCAFDoc_ShapeTool.GetShape_s(label) for name, label in products.items()}
    return Assembly(
        _name_of(top),
        tuple(instances),
        shapes,
        {name: tuple(map(volume, subshapes(shape, TopAbs_SOLID))) for name, shape in shapes.items()},
        all(is_valid(shape, is_clear_prism(shape)) for shape in shapes.values()),
    )


def _name_of(label: TDF_Label) -> str:
    name = TDataStd_Name()
    return name.Get().ToExtString() if label.FindAttribute(TDataStd_Name.GetID_s(), name) else ""


def check_part(data: bytes, read: Assembly, part: Part) -> None:
    """Raise CheckFailure if a part's file, or its content, is not that one part."""
    text = data.decode("latin-1")
    for entity, count in (
        ("PRODUCT(", 1),
        ("NEXT_ASSEMBLY_USAGE_OCCURRENCE(", 0),
        ("MANIFOLD_SOLID_BREP(", 1),
    ):
        if text.count(f"={entity}") != count:
            raise CheckFailure(
                f"{part.part_no}: STEP file has {text.count(f'={entity}')} {entity[:-1]}, not {count}"
            )
    if read.name != part.part_no or read.instances or not read.valid:
        raise CheckFailure(f"{part.part_no}: STEP file reads back as {read.name!r}, valid: {read.valid}")
    _check_volume(read, part)


def _check_volume(read: Assembly, part: Part) -> None:
    volumes = read.solids.get(part.part_no, ())
    if len(volumes) != 1 or not isclose(volumes[0], part.volume, rel_tol=VOLUME_AGREES):
        raise CheckFailure(
            f"{part.part_no}: STEP file reads back with volumes {volumes} mm3, not {part.volume:.9g}"
        )


def _check_instances(instances: Sequence[Instance], placements: Sequence[Placement], name: str) -> None:
    if len(instances) != len(placements):
        raise CheckFailure(f"scene {name}: STEP file has {len(instances)} instances, not {len(placements)}")
    for got, meant in zip(instances, placements):
        (a, b, c), (x, y, z) = meant.rotation, meant.origin
        matrix = (*a, x, *b, y, *c, z)
        off = max(abs(g - m) for g, m in zip(got.matrix, matrix))
        if (got.designator, got.product) != (meant.designator, meant.part.part_no) or off > PLACE_AGREES:
            raise CheckFailure(
                f"scene {name}: STEP file has {got.designator} of {got.product} where "
                f"{meant.designator} of {meant.part.part_no} was written, off by {off:.3g} mm"
            )
