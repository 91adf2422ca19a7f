"""Runs inside FreeCAD's window program on a screen: shows one document as a person would see it.

Takes REVIEW_FILE, writes pictures of the whole screen, without and with the document's parts, to REVIEW_EMPTY
and REVIEW_FULL.
"""

import os

import FreeCAD
import FreeCADGui
from PySide2 import QtCore, QtGui, QtWidgets

SETTLES = 3000  # ms until the window has drawn; chosen: software draws a large rig in one


def picture(name: str) -> None:
    QtGui.QGuiApplication.primaryScreen().grabWindow(0).save(os.environ[name])


def opened() -> None:
    for dock in FreeCADGui.getMainWindow().findChildren(QtWidgets.QDockWidget):
        dock.setVisible(dock.objectName() == "Combo View")
    FreeCAD.openDocument(os.environ["REVIEW_FILE"])
    FreeCADGui.activeDocument().activeView().viewIsometric()
    FreeCADGui.SendMsgToActiveView("ViewFit")
    QtCore.QTimer.singleShot(SETTLES, full)


def full() -> None:
    picture("REVIEW_FULL")
    for one in FreeCAD.ActiveDocument.RootObjects:
        one.ViewObject.Visibility = False
    QtCore.QTimer.singleShot(SETTLES, empty)


def empty() -> None:
    picture("REVIEW_EMPTY")
    os._exit(0)


QtCore.QTimer.singleShot(SETTLES, opened)
