"""Runs inside FreeCAD: builds an element from its contour, writes it as STEP, and prints volume and times.

The job is JSON in the environment variable TACTCAD_PEER: `outer` and `openings` (closed chains of ["line",
start, end] and ["arc", start, middle, end], or one ["circle", centre, radius]), `thickness` (mm), `repeats`,
`step` (path).
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable
from typing import Any

import FreeCAD
import Part
from FreeCAD import Vector


def edge(segment: list) -> Part.Edge:
    kind, *where = segment
    if kind == "circle":
        (x, y), radius = where
        return Part.makeCircle(radius, Vector(x, y, 0))
    points = [Vector(x, y, 0) for x, y in where]
    return Part.makeLine(*points) if kind == "line" else Part.Arc(*points).toShape()


def build(job: dict) -> Part.Shape:
    wires = [Part.Wire([edge(s) for s in chain]) for chain in [job["outer"], *job["openings"]]]
    face = Part.makeFace(wires, "Part::FaceMakerBullseye")  # which turns the openings' wires the right way
    return face.extrude(Vector(0, 0, job["thickness"]))


def seconds(action: Callable[[], Any]) -> tuple[float, Any]:
    start = time.perf_counter()
    result = action()
    return time.perf_counter() - start, result


job = json.loads(os.environ["TACTCAD_PEER"])
found: dict = {"version": ".".join(FreeCAD.Version()[:3]), "build": [], "write": []}
for _ in range(job["repeats"]):
    taken, solid = seconds(lambda: build(job))
    found["build"].append(taken)
    found["write"].append(seconds(lambda: solid.exportStep(job["step"]))[0])
    found |= {"volume": solid.Volume, "valid": solid.isValid() and solid.ShapeType == "Solid"}
print("PEER " + json.dumps(found))
