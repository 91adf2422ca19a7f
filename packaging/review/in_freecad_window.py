"""Runs inside FreeCAD's window program, without a screen: imports assemblies as a person would, each into a
document of its own, with the user's settings.

Takes REVIEW_FILE, a path a line; writes what each tree shows to REVIEW_OUT as JSON by path: for each child of
the assembly its label, the label of the part that it shows, and that part's colour.
"""

import json
import os

import FreeCAD
import FreeCADGui  # noqa: F401  the window has to be up
import ImportGui


def tree(path):
    document = FreeCAD.newDocument("review")
    ImportGui.insert(path, document.Name)
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
    return {"groups": len(groups), "children": children}


found = {path: tree(path) for path in os.environ["REVIEW_FILE"].splitlines()}
with open(os.environ["REVIEW_OUT"], "w") as out:
    json.dump(found, out)
os._exit(0)  # closing a window that was never shown crashes FreeCAD 0.20
