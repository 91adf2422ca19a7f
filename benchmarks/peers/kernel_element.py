"""The bare kernel: builds an element from its contour, writes it as STEP, and prints volume and times.

No CAD library between script and kernel, no check, no names, no repeatable bytes. The job is the one of
freecad_element.py, as the only argument.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from typing import Any

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
from OCP.GC import GC_MakeArcOfCircle
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape, TopoDS_Wire


def edge(segment: list) -> TopoDS_Edge:
    kind, *where = segment
    if kind == "circle":
        (x, y), radius = where
        return BRepBuilderAPI_MakeEdge(gp_Circ(gp_Ax2(gp_Pnt(x, y, 0), gp_Dir(0, 0, 1)), radius)).Edge()
    points = [gp_Pnt(x, y, 0) for x, y in where]
    return BRepBuilderAPI_MakeEdge(
        *points if kind == "line" else [GC_MakeArcOfCircle(*points).Value()]
    ).Edge()


def wire(chain: list) -> TopoDS_Wire:
    maker = BRepBuilderAPI_MakeWire()
    for segment in chain:
        maker.Add(edge(segment))
    return maker.Wire()


def build(job: dict) -> TopoDS_Shape:
    maker = BRepBuilderAPI_MakeFace(wire(job["outer"]))
    for opening in job["openings"]:
        hole = wire(opening)
        hole.Reverse()
        maker.Add(hole)
    return BRepPrimAPI_MakePrism(maker.Face(), gp_Vec(0, 0, job["thickness"])).Shape()


def write(solid: TopoDS_Shape, path: str) -> None:
    writer = STEPControl_Writer()
    writer.Transfer(solid, STEPControl_AsIs)
    writer.Write(path)


def volume(solid: TopoDS_Shape) -> float:
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(solid, properties)
    return properties.Mass()


def seconds(action: Callable[[], Any]) -> tuple[float, Any]:
    start = time.perf_counter()
    result = action()
    return time.perf_counter() - start, result


job = json.loads(sys.argv[1])
found: dict = {"build": [], "write": []}
for _ in range(job["repeats"]):
    taken, solid = seconds(lambda: build(job))
    found["build"].append(taken)
    found["write"].append(seconds(lambda: write(solid, job["step"]))[0])
    found["volume"] = volume(solid)
print("PEER " + json.dumps(found))
