"""Runs inside FreeCAD's window program, without a screen: imports one assembly as a person would, with the
user's settings.

Takes REVIEW_FILE, writes what the tree shows to REVIEW_OUT as JSON: for each child of the assembly its label,
the label of the part that it shows, and that part's colour.
"""

import json
import os

import FreeCAD
import FreeCADGui  # noqa: F401  the window has to be up
import ImportGui

document = FreeCAD.newDocument("review")
ImportGui.insert(os.environ["REVIEW_FILE"], document.Name)
groups = [o for o in document.Objects if o.TypeId == "App::LinkGroup"]
children = []
for child in groups[0].OutList if len(groups) == 1 else ():
    part = (
        child.getLinkedObject()
        if child.TypeId == "App::Link"
        else child.OutList[0]
        if child.OutList
        else child
    )
    children.append(
        {
            "label": child.Label,
            "part": part.Label,
            "colour": [round(c, 3) for c in part.ViewObject.ShapeColor[:3]],
        }
    )
with open(os.environ["REVIEW_OUT"], "w") as out:
    json.dump({"groups": len(groups), "children": children}, out)
os._exit(0)  # closing a window that was never shown crashes FreeCAD 0.20
