"""Runs inside FreeCAD's own Python: opens the STEP, DXF and FCStd files named, prints what it
finds as JSON.

usage: python3 in_freecad.py FILE...

Every STEP file is read as a shape; an assembly also as a document, for its tree's names. (FreeCAD 0.20's
command line crashes on Import.insert of an assembly unless the arguments are named and links are off.)
"""

import json
import sys

for folder in ("/usr/lib/freecad/lib", "/usr/lib/freecad-python3/lib"):
    sys.path.append(folder)
import FreeCAD
import Import
import Part


def step(path):
    shape = Part.Shape()
    shape.read(path)
    found = {
        "solids": [
            {"volume": s.Volume, "area": s.Area, "valid": s.isValid(), "closed": s.isClosed()}
            for s in shape.Solids
        ],
        "names": [],
    }
    if len(shape.Solids) > 1:
        document = FreeCAD.newDocument("review")
        Import.insert(name=path, docName=document.Name, useLinkGroup=False)
        found["names"] = [
            o.Label for o in document.Objects if hasattr(o, "Shape") and len(o.Shape.Solids) == 1
        ]
        FreeCAD.closeDocument(document.Name)
    return found


def dxf(path):
    """The outline's section as faces: the area inside the largest closed wire less the others."""
    FreeCAD.ParamGet("User parameter:BaseApp/Preferences/Mod/Draft").SetBool("dxfUseLegacyImporter", False)
    document = FreeCAD.newDocument("cut")
    Import.readDXF(path, document.Name)
    document.recompute()
    edges = [e for o in document.Objects if hasattr(o, "Shape") for e in o.Shape.Edges]
    wires = [Part.Wire(chain) for chain in Part.sortEdges(edges)]
    areas = sorted((Part.Face(w).Area for w in wires if w.isClosed()), reverse=True)
    box = max((w.BoundBox for w in wires), key=lambda b: b.DiagonalLength)
    FreeCAD.closeDocument(document.Name)
    return {
        "closed": all(w.isClosed() for w in wires),
        "area": areas[0] - sum(areas[1:]) if areas else 0.0,
        "length": sum(e.Length for e in edges),
        "size": [box.XLength, box.YLength],
    }


def document(path):
    """Every place of each assembly with its part, assembled and apart."""
    held = FreeCAD.openDocument(path)
    links = [o for o in held.Objects if o.TypeId == "App::Link"]
    placed = [
        {
            "label": o.Label,
            "part": o.LinkedObject.Label,
            "scene": [
                p.Label for p in o.InListRecursive if p.TypeId == "App::Part" and p.Name.startswith("Scene")
            ],
            "volume": o.Shape.Volume,
            "valid": o.Shape.isValid() and o.Shape.isClosed(),
            "at": list(o.Placement.Base),
        }
        for o in links
    ]
    held.Review.set(held.Review.getCellFromAlias("explode"), "1")
    held.recompute()
    for one, link in zip(placed, links):
        one["apart"] = list(link.Placement.Base)
    sheets = {
        o.Label: [[o.getContents(f"{c}{n}") for c in "AB"] for n in range(1, 400) if o.getContents(f"A{n}")]
        for o in held.Objects
        if o.TypeId == "Spreadsheet::Sheet"
    }
    marks = [[o.Label, list(o.Position)] for o in held.Objects if o.TypeId == "App::Annotation"]
    FreeCAD.closeDocument(held.Name)
    return {"placed": placed, "sheets": sheets, "marks": marks}


READERS = {".step": step, ".dxf": dxf, ".FCStd": document}
report = {"version": ".".join(FreeCAD.Version()[:3]), "files": {}}
for name in sys.argv[1:]:
    report["files"][name] = next(read for ending, read in READERS.items() if name.endswith(ending))(name)
print("REVIEW " + json.dumps(report))
