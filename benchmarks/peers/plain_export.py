"""The same kinds of files by a plain script, without tactcad: what an export has to measure itself against.

Every distinct shape goes through the kernel once; every file is written once and read back once: STEP a part
and of the assembly (shared prototypes in one document), DXF a sheet part, hidden-line SVG, bill of materials,
manifest. No cache, no lock, no repeatable bytes; what is read back is compared by count and volume only.

usage: plain_export.py NUMBER_OF_ELEMENTS FOLDER
"""

from __future__ import annotations

import csv
import hashlib
import json
import math
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

import ezdxf
from build123d import (
    Box,
    Circle,
    Compound,
    Cylinder,
    ExportDXF,
    ExportSVG,
    Face,
    Location,
    Part,
    Plane,
    Polyline,
    Pos,
    RegularPolygon,
    Shape,
    Solid,
    Unit,
    Vector,
    export_step,
    extrude,
    fillet,
    import_step,
    make_face,
)
from OCP.BRepLib import BRepLib
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.HLRAlgo import HLRAlgo_Projector
from OCP.HLRBRep import HLRBRep_PolyAlgo, HLRBRep_PolyHLRToShape
from OCP.IFSelect import IFSelect_RetDone
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.XCAFDoc import XCAFDoc_DocumentTool

ARMS = ((4, 7, 6, 8, 6), (8, 5, 4, 5, 7))  # the published array's rows, repeated for longer ones
CLAMP, REAR, HOLE_Z = 11.4, 29.5, 4.7
SCREW_X, DOWEL_X = (15.5, 25.5), 20.5
ALONG, AGAINST, DOWN = (0, 1, 0), (0, -1, 0), (0, 0, -1)
VIEWS = {"above": (1, -1.4, 1), "below": (1, -1.4, -1), "open": (1, -1.4, 1)}
COVER = ("CA", "ST", "HS", "SS")  # taken off in the picture "open"

EXACT_UP_TO = 64  # solids in a picture; above, the same triangles that tactcad takes

Point = tuple[float, float, float]
Placed = tuple[str, str, Location]  # reference designator, part, place


def element_profile(arm: float) -> Face:
    """Outline of an element in its plane, holes included (mm)."""
    body, tip_arm = 1 + arm + 0.44, 1 + arm - 0.44
    land = 3 - (0.13 + 0.03 * (arm - 4))
    points = [
        (1, -2),
        (3, -2),
        (3, 0),
        (13, 0),
        (13, 0.8),
        (REAR, 0.8),
        (REAR, 8),
        (CLAMP, 8),
        (CLAMP, 3),
        (body, 3),
        (body, 0.25),
        (tip_arm, 0.25),
        (tip_arm, 2.6),
        (2 + land - 2.6, 2.6),
        (2, land),
        (1, land),
    ]
    face = make_face(Polyline(*points, close=True))
    rounded = [points[i] for i in (2, 4, 8, 10, 11)]
    corners = [v for v in face.vertices() if any(math.dist((v.X, v.Y), p) < 1e-6 for p in rounded)]
    return fillet(corners, 0.3) - mounting_holes()


def spacer_profile() -> Face:
    points = [(CLAMP, 0.9), (REAR, 0.9), (REAR, 7.9), (CLAMP, 7.9)]
    return make_face(Polyline(*points, close=True)) - mounting_holes()


def mounting_holes() -> list:
    return [Pos(x, HOLE_Z) * Circle(1.7) for x in SCREW_X] + [Pos(DOWEL_X, HOLE_Z) * Circle(1.5075)]


def end_plate(head: bool) -> Part:
    bores = [Pos(s * x, -5.8, 4) * Cylinder(1.7 if head else 1.25, 8) for x in SCREW_X for s in (1, -1)]
    bores += [Pos(s * DOWEL_X, -5.8, 4) * Cylinder(1.5025, 8) for s in (1, -1)]
    if head:
        bores += [Pos(s * x, -5.8, 6.3) * Cylinder(3, 3.4) for x in SCREW_X for s in (1, -1)]
    return Pos(0, 0, 4) * Box(60, 21, 8) - bores


def carrier(
    stack: float, tapped: Sequence[tuple[float, float]], clear: Sequence[tuple[float, float]]
) -> Part:
    bores = [Pos(x, y, 3) * Cylinder(1.25, 6) for x, y in tapped] + [
        Pos(x, y, 3) * Cylinder(1.7, 6) for x, y in clear
    ]
    return Pos(0, 0, 3) * Box(64, stack + 16, 6) - bores


def cap_screw(length: float) -> Part:
    head = Pos(0, 0, -1.5) * Cylinder(2.75, 3) - Pos(0, 0, -3) * extrude(RegularPolygon(1.443, 6), 1.3)
    return head + Pos(0, 0, length / 2) * Cylinder(1.5, length)


def set_screw(length: float) -> Part:
    return Pos(0, 0, length / 2) * Cylinder(1.5, length) - extrude(RegularPolygon(0.866, 6), 2)


def rod(diameter: float, length: float) -> Part:
    return Pos(0, 0, length / 2) * Cylinder(diameter / 2, length)


def scene(elements: int) -> tuple[dict[str, Solid], dict[str, Face], list[Placed]]:
    """Distinct solids and sheet profiles by part number, and the placements."""
    row = elements // 2
    stack = 4 * row + 1
    face = stack / 2
    rods = stack + 9 > 50  # longer than any standard screw
    holds = math.ceil(stack / 40) + 1
    spots = [(s * 7.5, -face + 4 + i * (stack - 8) / (holds - 1)) for s in (1, -1) for i in range(holds)]
    corners = [(sx * 22, sy * (face + 4)) for sx in (1, -1) for sy in (1, -1)]
    arms = [[ARMS[r][i % 5] for i in range(row)] for r in range(2)]

    profiles = {f"element-a{a}": element_profile(a) for a in sorted({*arms[0], *arms[1]})}
    profiles["spacer"] = spacer_profile()
    parts = {name: extrude(p, 1.0 if name == "spacer" else 3.0) for name, p in profiles.items()}
    parts["end-plate-head"], parts["end-plate-tapped"] = end_plate(head=True), end_plate(head=False)
    parts["stop-plate"] = Pos(0, 0, 2) * Box(22, stack, 4)
    parts["carrier"] = carrier(stack, spots, corners)
    parts |= {"M3x8": cap_screw(8), "M3-set": set_screw(16), "dowel": rod(3, stack)}
    if rods:
        parts["rod"] = rod(3, stack + 26)
        parts["nut"] = extrude(RegularPolygon(3.175, 6), 2.4) - Pos(0, 0, 1.2) * Cylinder(1.5, 2.4)
        parts["washer"] = Pos(0, 0, 0.25) * Cylinder(3.5, 0.5) - Pos(0, 0, 0.25) * Cylinder(1.6, 0.5)
    else:
        parts["M3x30"] = cap_screw(30)

    places: list[Placed] = []

    def place(
        designator: str, part: str, at: Point, z_dir: Point = (0, 0, 1), x_dir: Point = (1, 0, 0)
    ) -> None:
        places.append((designator, part, Plane(at, x_dir, z_dir).location))

    for r, (x_dir, z_dir, turned) in enumerate((((1, 0, 0), AGAINST, 1), ((-1, 0, 0), ALONG, 0))):
        for i in range(row + 1):
            y = -face + 4 * i
            place(f"SP{r * (row + 1) + i + 1}", "spacer", (0, y + turned, 0), z_dir, x_dir)
            if i < row:
                place(
                    f"E{r * row + i + 1}", f"element-a{arms[r][i]}", (0, y + 1 + 3 * turned, 0), z_dir, x_dir
                )
    place("EP1", "end-plate-head", (0, -face, 10.5), AGAINST)
    place("EP2", "end-plate-tapped", (0, face, 10.5), ALONG, (-1, 0, 0))
    place("ST1", "stop-plate", (0, 0, 3))
    place("CA1", "carrier", (0, 0, 21))
    for n, x in enumerate([s * x for x in SCREW_X for s in (1, -1)], 1):
        if rods:
            place(f"TR{n}", "rod", (x, -face - 13, HOLE_Z), ALONG)
            for m, z_dir in ((2 * n - 1, AGAINST), (2 * n, ALONG)):
                place(f"WA{m}", "washer", (x, z_dir[1] * (face + 8), HOLE_Z), z_dir)
                place(f"NU{m}", "nut", (x, z_dir[1] * (face + 8.5), HOLE_Z), z_dir)
        else:
            place(f"SC{n}", "M3x30", (x, -face - 4.6, HOLE_Z), ALONG)
    for n, s in enumerate((1, -1), 1):
        place(f"DW{n}", "dowel", (s * DOWEL_X, -face, HOLE_Z), ALONG)
    for n, (x, y) in enumerate(corners, 1):
        place(f"HS{n}", "M3x8", (x, y, 27), DOWN)
    for n, (x, y) in enumerate(spots, 1):
        place(f"SS{n}", "M3-set", (x, y, 23), DOWN)
    return {name: part.solid() for name, part in parts.items()}, profiles, places


def write_part(folder: Path, name: str, solid: Solid) -> Path:
    path = folder / f"{name}.step"
    solid.label = name
    export_step(solid, path)
    (read,) = import_step(path).solids()
    assert math.isclose(read.volume, solid.volume, rel_tol=1e-6), name
    return path


def write_assembly(folder: Path, solids: dict[str, Solid], places: list[Placed]) -> Path:
    """One prototype a part, one component a placement."""
    document = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    prototypes = {name: named(tool.AddShape(solid.wrapped, False), name) for name, solid in solids.items()}
    top = named(tool.NewShape(), "array")
    for designator, part, location in places:
        named(tool.AddComponent(top, prototypes[part], location.wrapped), designator)
    tool.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    writer.Transfer(document, STEPControl_AsIs)
    path = folder / "array.step"
    assert writer.Write(str(path)) == IFSelect_RetDone
    read = import_step(path).solids()
    assert len(read) == len(places)
    volume = sum(solids[part].volume for _, part, _ in places)
    assert math.isclose(sum(s.volume for s in read), volume, rel_tol=1e-6)
    return path


def named(label: TDF_Label, name: str) -> TDF_Label:
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
    return label


def write_dxf(folder: Path, name: str, profile: Face) -> Path:
    path = folder / f"{name}.dxf"
    drawing, edges = ExportDXF(unit=Unit.MM), profile.edges()
    drawing.add_shape(edges)
    drawing.write(str(path))
    assert len(ezdxf.readfile(path).modelspace()) == len(edges)
    return path


def write_picture(folder: Path, name: str, shape: Shape, eye: Point) -> Path:
    path = folder / f"{name}.svg"
    drawing = ExportSVG(unit=Unit.MM, margin=2)
    drawing.add_shape(visible_edges(shape, eye))
    drawing.write(str(path))
    assert ElementTree.parse(path).getroot().tag.endswith("svg")
    return path


def visible_edges(shape: Shape, eye: Point) -> list:
    """Exact hidden-line removal, or on triangles where that would take minutes and gigabytes."""
    if len(shape.solids()) <= EXACT_UP_TO:
        box = shape.bounding_box()
        origin = box.center() + tuple(10 * box.diagonal * c for c in eye)
        visible, _ = shape.project_to_viewport(origin, (0, 0, 1), box.center())
        return list(visible)
    BRepMesh_IncrementalMesh(shape.wrapped, 0.05, False, 0.35)
    removal = HLRBRep_PolyAlgo()
    removal.Load(shape.wrapped)
    right = Vector(0, 0, 1).cross(Vector(eye))
    removal.Projector(HLRAlgo_Projector(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(*eye), gp_Dir(*right))))
    removal.Update()
    result = HLRBRep_PolyHLRToShape()
    result.Update(removal)
    kept = [edges for edges in (result.VCompound(), result.OutLineVCompound()) if edges is not None]
    for compound in kept:
        BRepLib.BuildCurves3d_s(compound)
    return [edge for compound in kept for edge in Compound(compound).edges()]


def write_bill(folder: Path, solids: dict[str, Solid], places: list[Placed]) -> list[Path]:
    counts = Counter(part for _, part, _ in places)
    rows = [
        {
            "part_no": name,
            "qty": counts[name],
            "volume": solid.volume,
            "designators": " ".join(d for d, part, _ in places if part == name),
        }
        for name, solid in solids.items()
    ]
    with open(folder / "bom.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    (folder / "bom.json").write_text(json.dumps(rows, indent=1))
    with open(folder / "bom.csv", newline="") as file:
        assert sum(int(row["qty"]) for row in csv.DictReader(file)) == len(places)
    assert json.loads((folder / "bom.json").read_text()) == rows
    return [folder / "bom.csv", folder / "bom.json"]


def write_manifest(folder: Path, files: list[Path], solids: dict[str, Solid]) -> None:
    parts = []
    for name, solid in solids.items():
        box = solid.bounding_box()
        numbers = {"volume": solid.volume, "area": solid.area, "centre": list(solid.center())}
        parts.append({"part_no": name, **numbers, "box": [list(box.min), list(box.max)]})
    digests = [{"path": f.name, "sha256": hashlib.sha256(f.read_bytes()).hexdigest()} for f in files]
    (folder / "manifest.json").write_text(json.dumps({"files": digests, "parts": parts}, indent=1))
    assert len(json.loads((folder / "manifest.json").read_text())["files"]) == len(files)


def main() -> None:
    elements, folder = int(sys.argv[1]), Path(sys.argv[2])
    folder.mkdir(parents=True)
    solids, profiles, places = scene(elements)
    files = [write_part(folder, name, solid) for name, solid in solids.items()]
    files += [write_dxf(folder, name, profile) for name, profile in profiles.items()]
    made_here = [name for name in solids if name in profiles or name.startswith(("end-", "stop-", "carrier"))]
    files += [write_picture(folder, name, solids[name], (0.7, 0.5, 1.4)) for name in made_here]
    files.append(write_assembly(folder, solids, places))
    for view, eye in VIEWS.items():
        shown = [p for p in places if view != "open" or not p[0].startswith(COVER)]
        placed = Compound([solids[part].moved(location) for _, part, location in shown])
        files.append(write_picture(folder, f"array-{view}", placed, eye))
    files += write_bill(folder, solids, places)
    write_manifest(folder, files, solids)
    print(f"{len(files) + 1} files, {len(solids)} distinct parts, {len(places)} solids")


if __name__ == "__main__":
    main()
