"""The bare kernel: builds an element from its contour, writes it as STEP, and prints volume and times.

No CAD library between script and kernel, no check, no names, no repeatable bytes. The job is the one of
freecad_element.py, as the only argument.
"""

import json
import sys
import time

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
from OCP.GC import GC_MakeArcOfCircle
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer


def edge(segment):
    kind, *where = segment
    if kind == "circle":
        (x, y), radius = where
        return BRepBuilderAPI_MakeEdge(gp_Circ(gp_Ax2(gp_Pnt(x, y, 0), gp_Dir(0, 0, 1)), radius)).Edge()
    points = [gp_Pnt(x, y, 0) for x, y in where]
    return BRepBuilderAPI_MakeEdge(
        *points if kind == "line" else [GC_MakeArcOfCircle(*points).Value()]
    ).Edge()


def wire(chain):
    maker = BRepBuilderAPI_MakeWire()
    for segment in chain:
        maker.Add(edge(segment))
    return maker.Wire()


def build(job):
    maker = BRepBuilderAPI_MakeFace(wire(job["outer"]))
    for opening in job["openings"]:
        hole = wire(opening)
        hole.Reverse()
        maker.Add(hole)
    return BRepPrimAPI_MakePrism(maker.Face(), gp_Vec(0, 0, job["thickness"])).Shape()


def write(solid, path):
    writer = STEPControl_Writer()
    writer.Transfer(solid, STEPControl_AsIs)
    writer.Write(path)


def volume(solid):
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(solid, properties)
    return properties.Mass()


def seconds(action):
    start = time.perf_counter()
    result = action()
    return time.perf_counter() - start, result


job = json.loads(sys.argv[1])
found = {"build": [], "write": []}
for _ in range(job["repeats"]):
    taken, solid = seconds(lambda: build(job))
    found["build"].append(taken)
    found["write"].append(seconds(lambda: write(solid, job["step"]))[0])
    found["volume"] = volume(solid)
print("PEER " + json.dumps(found))
