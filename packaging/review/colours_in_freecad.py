"""Runs inside FreeCAD's window program, without a screen: opens one document of tactcad's as a person would.

Takes REVIEW_FILE, writes the colour of every part to REVIEW_OUT as JSON.
"""

import json
import os

import FreeCAD
import FreeCADGui  # noqa: F401  the window has to be up

document = FreeCAD.openDocument(os.environ["REVIEW_FILE"])
parts = document.getObjectsByLabel("Parts")[0].Group


def hexadecimal(colour):
    return "#" + "".join(f"{round(255 * c):02x}" for c in colour[:3])


found = {"colours": {part.Label: hexadecimal(part.ViewObject.ShapeColor) for part in parts}}
with open(os.environ["REVIEW_OUT"], "w") as out:
    json.dump(found, out)
os._exit(0)  # closing a window that was never shown crashes FreeCAD 0.20
