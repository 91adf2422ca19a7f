"""Runs inside FreeCAD: makes a document from a record (JSON) and the parts' shapes (BREP files in its
folder).

TACTCAD_RECORD names the record, TACTCAD_OUT the document to write. The window program also keeps colours and
hidden parts; FreeCAD's command line has neither. Writes the empty file `done` next to the record.
"""

from __future__ import annotations

import json
import os
import sys
from typing import Any

for folder in ("/usr/lib/freecad/lib", "/usr/lib/freecad-python3/lib"):  # Debian's freecad-python3
    sys.path.append(folder)
import FreeCAD
import Part

EXPLODE = "Review.explode"  # the cell that every exploded place reads: 0 assembled, 1 apart


def made(record: dict, folder: str) -> Any:
    # E1 is E1 in every scene
    FreeCAD.ParamGet("User parameter:BaseApp/Preferences/Document").SetBool("DuplicateLabels", True)
    document = FreeCAD.newDocument("Review")
    document.Label = record["label"]
    views = View()
    review_sheet(document, record)
    for name, rows in record["tables"].items():
        table(document, name, rows)
    store = document.addObject("App::DocumentObjectGroup", "Parts")
    parts = {}
    for part in record["parts"]:
        parts[part["part_no"]] = source(document, store, part, folder, views)
    views.hide(store)
    for n, scene in enumerate(record["scenes"]):
        group = assembly(document, scene, parts, views)
        if n:
            views.hide(group)
    document.recompute()
    return document


def review_sheet(document: Any, record: dict) -> None:
    """Title, and the cell by which assemblies are taken apart."""
    sheet = document.addObject("Spreadsheet::Sheet", "Review")
    rows = [*record["about"], ("explode: 0 assembled, 1 apart", "")]
    for n, (name, value) in enumerate(rows, 1):
        sheet.set(f"A{n}", text(name))
        sheet.set(f"B{n}", text(value))
    sheet.set(f"B{len(rows)}", "0")
    sheet.setAlias(f"B{len(rows)}", "explode")
    sheet.setColumnWidth("A", 220)
    sheet.setColumnWidth("B", 420)
    document.recompute()  # expressions read the cell


def table(document: Any, name: str, rows: list) -> None:
    """A spreadsheet of rows; the first is the heading."""
    sheet = document.addObject("Spreadsheet::Sheet", name)
    for n, row in enumerate(rows, 1):
        for column, value in zip("ABCDEFGHIJKLMNOPQRSTUVWXYZ", row):
            sheet.set(f"{column}{n}", text(value) if isinstance(value, str) else repr(value))
    last = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"[len(rows[0]) - 1]
    sheet.setStyle(f"A1:{last}1", "bold")
    sheet.setColumnWidth("A", 220)


def text(value: object) -> str:
    """A cell's content shown literally: never a formula, however a design's text begins."""
    return "'" + str(value).replace("\n", " ")


def source(document: Any, store: Any, part: dict, folder: str, views: View) -> Any:
    """The one shape that all places of a part link to."""
    shape = Part.Shape()
    shape.read(os.path.join(folder, part["file"]))
    made = document.addObject("Part::Feature", "Part")
    made.Label = part["part_no"]
    made.Shape = shape
    for name, value in part["properties"]:
        made.addProperty("App::PropertyString", name, "tactcad")
        setattr(made, name, value)
    store.addObject(made)
    views.colour(made, part["colour"], part["transparency"])
    return made


def assembly(document: Any, scene: dict, parts: dict, views: View) -> Any:
    """A scene: sub-assemblies as groups, links under their designators, findings as labels at their place."""
    whole = document.addObject("App::Part", "Scene")
    whole.Label = scene["name"]
    groups = {}
    for placed in scene["placed"]:
        group = whole
        for depth in range(len(placed["under"])):
            key = tuple(placed["under"][: depth + 1])
            if key not in groups:
                groups[key] = document.addObject("App::Part", "Unit")
                groups[key].Label = key[-1]
                group.addObject(groups[key])
            group = groups[key]
        group.addObject(link(document, placed, parts[placed["part_no"]]))
    if scene["findings"]:
        marks = document.addObject("App::DocumentObjectGroup", "Findings")
        marks.Label = "Findings of " + scene["name"]
        whole.addObject(marks)
        for finding in scene["findings"]:
            mark = document.addObject("App::Annotation", "Finding")
            mark.Label = finding["label"]
            mark.LabelText = [f"{finding['severity']}: {finding['check']}"]
            mark.addProperty("App::PropertyString", "Message", "tactcad")
            mark.Message = finding["message"]
            mark.Position = FreeCAD.Vector(*finding["at"])
            exploded(mark, "Position", finding, "")
            marks.addObject(mark)
            views.mark(mark, finding["severity"])
    return whole


def link(document: Any, placed: dict, part: Any) -> Any:
    one = document.addObject("App::Link", "Placed")
    one.Label = placed["designator"]
    one.LinkedObject = part
    r, (x, y, z) = placed["rotation"], placed["origin"]
    turn = FreeCAD.Matrix(*r[0], x, *r[1], y, *r[2], z, 0, 0, 0, 1)
    one.Placement = FreeCAD.Placement(turn)
    exploded(one, "Placement.Base", {"at": placed["origin"], "way": placed["way"]}, " mm")
    return one


def exploded(one: Any, place: str, item: dict, unit: str) -> None:
    """Move the place along its way by the cell's share."""
    for axis, start, way in zip("xyz", item["at"], item["way"]):
        if way:
            one.setExpression(f"{place}.{axis}", f"{start!r}{unit} + {EXPLODE} * {way!r}{unit}")


class View:
    """Display state: kept by the window program only."""

    def __init__(self) -> None:
        self.on = bool(FreeCAD.GuiUp)

    def colour(self, made: Any, colour: str, transparency: int) -> None:
        if self.on:
            made.ViewObject.Transparency = transparency
            made.ViewObject.ShapeColor = tuple(int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
            made.ViewObject.Visibility = False

    def hide(self, made: Any) -> None:
        if self.on:
            made.ViewObject.Visibility = False

    def mark(self, made: Any, severity: str) -> None:
        if self.on:
            made.ViewObject.TextColor = (0.8, 0.1, 0.1) if severity == "fail" else (0.7, 0.4, 0.0)
            made.ViewObject.FontSize = 14
            made.ViewObject.Visibility = severity == "fail"  # flags are many: the space bar shows them


def main() -> None:
    path = os.environ["TACTCAD_RECORD"]
    with open(path, encoding="utf-8") as stream:
        record = json.load(stream)
    document = made(record, os.path.dirname(path))
    document.saveAs(os.environ["TACTCAD_OUT"])
    with open(os.path.join(os.path.dirname(path), "done"), "w", encoding="utf-8"):
        pass  # the document is whole
    os._exit(0)  # closing a window that was never shown crashes FreeCAD 0.20


main()
