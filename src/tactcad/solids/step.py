"""Shapes as bytes and back: STEP files (AP214, mm), bought shapes from them, and for caches the kernel's own
text (BREP).

The text drops the sign of zero, so a shape that went through it may give other bytes in a STEP file than the
one just built: for equal files both must be taken from the text.
"""

from __future__ import annotations

import hashlib
from io import BytesIO
from pathlib import Path
from typing import Any

from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
from OCP.BRepTools import BRepTools
from OCP.IFSelect import IFSelect_RetDone
from OCP.Interface import Interface_Static
from OCP.Message import Message
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Reader, STEPControl_Writer
from OCP.TCollection import TCollection_AsciiString
from OCP.TopAbs import TopAbs_SOLID
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape

from tactcad.design.messages import InputError
from tactcad.parts.language.description import ModelFile

from .measure import measure
from .occt import subshapes


def write_step(shape: TopoDS_Shape) -> bytes:
    """The shape as a STEP file, without names or colours. Raises ValueError if the kernel cannot write
    it."""
    writer, stream = STEPControl_Writer(), BytesIO()
    set_up_writer()
    if (
        writer.Transfer(shape, STEPControl_AsIs) != IFSelect_RetDone
        or writer.WriteStream(stream) != IFSelect_RetDone
    ):
        raise ValueError("the kernel cannot write it as STEP")
    return stream.getvalue()


def read_step(data: bytes, mended: bool = True) -> TopoDS_Shape:
    """The shape in a STEP file, mm; `mended`: wires that meet or lie the wrong way round are put right.
    Raises ValueError if there is none."""
    silence()
    reader = STEPControl_Reader()
    read = reader.ReadStream("written.step", BytesIO(data)) == IFSelect_RetDone
    if not mended:
        leave_unmended(reader)
    if not read or not reader.TransferRoots():
        raise ValueError("the STEP file cannot be read back")
    return reader.OneShape()


def leave_unmended(reader: STEPControl_Reader | STEPCAFControl_Reader) -> None:
    """Let a reader that has read its file take a face's wires as they are written: what a check looks for is
    not mended before it looks. (Mending takes time with the square of the number of openings.)"""
    modes = reader.GetShapeFixParameters()
    for mode in ("SelfIntersection", "Orientation", "IntersectingWires", "LoopWires"):
        modes.Bind(TCollection_AsciiString(f"FixShape.Fix{mode}Mode"), TCollection_AsciiString("0"))
    reader.SetShapeFixParameters(modes)


def set_up_writer(schema: str = "AP214IS") -> None:
    """Settings of every STEP file that tactcad writes, and its schema by the kernel's name; the kernel knows
    them once it has made a writer.
    """
    silence()
    Interface_Static.SetCVal_s("write.step.schema", schema)
    Interface_Static.SetCVal_s("write.step.unit", "MM")
    # without parameter curves: planes, cylinders and cones need none, and the file is a third smaller
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)


def silence() -> None:
    """Keep the kernel from reporting every transfer on standard output, which carries our own messages."""
    messenger = Message.DefaultMessenger_s()
    for printer in list(messenger.Printers()):
        messenger.RemovePrinter(printer)


def read_step_solid(model: ModelFile) -> TopoDS_Shape:
    """The one solid of a STEP file. Raises InputError if file, hash or solid are not as described."""
    if _sha256(model.path) != model.sha256:
        raise InputError(
            model.path, "the STEP file has changed since it was described", legal=f"sha256 {model.sha256}"
        )
    return _only_solid(model.path)


def model_file(path: str | Path) -> ModelFile:
    """Describe a STEP file as a bought part's body: its hash, and its solid's volume (mm3) and box (mm).

    Raises InputError if there is no such file, or not one solid in it.
    """
    sha256 = _sha256(str(path))
    facts = measure(_only_solid(str(path)))
    low, high = facts["box"]
    return ModelFile(str(path), sha256, facts["volume"], (tuple(low), tuple(high)))


def kept_model(shape: Any, folder: Path) -> ModelFile:
    """A build123d solid as a bought part's body: written once as STEP in `folder`, under its content's name.

    Raises InputError if it is not one solid.
    """
    from build123d import export_step

    solids = list(shape.solids())
    if len(solids) != 1:
        raise InputError("part", "not one solid", value=len(solids), legal="a shape of one solid")
    stream = BytesIO()
    export_step(solids[0], stream, timestamp="2000-01-01T00:00:00")  # equal bytes for an equal solid
    data = stream.getvalue()
    path = folder / f"{hashlib.sha256(data).hexdigest()}.step"
    folder.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)
    return model_file(path)


def _sha256(path: str) -> str:
    if not Path(path).is_file():
        raise InputError(path, "no such STEP file")
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def _only_solid(path: str) -> TopoDS_Shape:
    try:
        solids = subshapes(read_step(Path(path).read_bytes()), TopAbs_SOLID)
    except (OSError, ValueError) as error:
        raise InputError(path, f"cannot be read as STEP: {error}") from None
    if len(solids) != 1:
        raise InputError(path, "not one solid", value=len(solids), legal="a STEP file with one solid")
    (shape,) = solids  # its place becomes its geometry: a located solid is written as an assembly
    base, place = shape.Located(TopLoc_Location()), shape.Location().Transformation()
    return BRepBuilderAPI_Transform(base, place, True).Shape()


def to_bytes(shape: TopoDS_Shape) -> bytes:
    """The shape without triangulation."""
    stream = BytesIO()
    BRepTools.Clean_s(shape)
    BRepTools.Write_s(shape, stream)
    return stream.getvalue()


def from_bytes(data: bytes) -> TopoDS_Shape:
    """The shape that `to_bytes` wrote. Raises ValueError if the bytes hold none."""
    shape = TopoDS_Shape()
    BRepTools.Read_s(shape, BytesIO(data), BRep_Builder())
    if shape.IsNull():
        raise ValueError("not a shape")
    return shape
