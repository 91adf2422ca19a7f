"""A shape alone through a STEP file (AP214, mm) and back."""

from __future__ import annotations

from io import BytesIO

from OCP.IFSelect import IFSelect_RetDone
from OCP.Interface import Interface_Static
from OCP.Message import Message
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Reader, STEPControl_Writer
from OCP.TopoDS import TopoDS_Shape


def write_step(shape: TopoDS_Shape) -> bytes:
    """The shape as a STEP file, without names or colours. Raises ValueError where the kernel cannot write
    it."""
    writer, stream = STEPControl_Writer(), BytesIO()
    set_up_writer()
    if (
        writer.Transfer(shape, STEPControl_AsIs) != IFSelect_RetDone
        or writer.WriteStream(stream) != IFSelect_RetDone
    ):
        raise ValueError("the kernel cannot write it as STEP")
    return stream.getvalue()


def read_step(data: bytes) -> TopoDS_Shape:
    """The shape in a STEP file, mm. Raises ValueError where there is none."""
    silence()
    reader = STEPControl_Reader()
    if reader.ReadStream("written.step", BytesIO(data)) != IFSelect_RetDone or not reader.TransferRoots():
        raise ValueError("the STEP file cannot be read back")
    return reader.OneShape()


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
