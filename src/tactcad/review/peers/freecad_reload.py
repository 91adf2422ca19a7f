"""Makes the document in its folder again from its design, and shows it in place of the old one.

Written by `tactcad review --freecad`; runs inside FreeCAD 0.20 or later: Macro > Macros, or, once it is open
in FreeCAD, the green arrow.
"""

import os
import subprocess

import FreeCAD

COMMAND = ["tactcad"]
FOLDER = "."
DOCUMENT = "review.FCStd"


def reload() -> None:
    # FreeCAD's own Python is not the one that tactcad is installed in
    own = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    run = subprocess.run(COMMAND, cwd=FOLDER, env=own, capture_output=True, text=True, check=False)
    if run.returncode:
        FreeCAD.Console.PrintError(run.stderr)  # the document remains unchanged
        return
    for name, document in FreeCAD.listDocuments().items():
        if document.FileName and os.path.realpath(document.FileName) == DOCUMENT:
            eye = camera(name)
            document.restore()
            camera(name, eye)
            return
    FreeCAD.openDocument(DOCUMENT)


def camera(name: str, to: str = "") -> str:
    """The camera of a document's views, each set to the given one; "" if no view is open."""
    import FreeCADGui  # there with a window alone

    views = FreeCADGui.getDocument(name).mdiViewsOfType("Gui::View3DInventor") if FreeCAD.GuiUp else []
    for view in views if to else []:
        view.setCamera(to)
    return views[0].getCamera() if views else ""


reload()
