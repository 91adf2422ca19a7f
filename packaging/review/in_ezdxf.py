"""ezdxf reads every cut file of an export: closed chains, entity types, area, and the hinge in the file.

No tactcad in here: areas and thicknesses are computed anew from the entities, the design is read from its
TOML file.

usage: in_ezdxf.py FOLDER...    exit status 1 if something differs
"""

from __future__ import annotations

import json
import re
import sys
import tomllib
from math import acos, cos, degrees, dist, radians, sin, sqrt, tau
from pathlib import Path

import ezdxf

HARDWARE = Path(__file__).parents[2] / "hardware"
CLOSED = 1e-6  # mm
HINGE = 1e-3  # mm
AREA = 1e-6  # relative


def main() -> int:
    return max(review(Path(name)) for name in sys.argv[1:])


def review(folder: Path) -> int:
    """1 if something differs or nothing is there, else 0; says so line by line."""
    manifest = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    parts = {part["part_no"]: part for part in manifest["parts"]}
    element = element_table(manifest["design"])
    files = [file for file in manifest["files"] if file["kind"] == "dxf"]
    wrong = []
    for file in files:
        faults = file_faults(folder / file["path"], parts[file["part_no"]], element)
        wrong += [f"{file['path']}: {fault}" for fault in faults]
    for fault in wrong:
        print(f"make review: {folder}: {fault}", file=sys.stderr)
    print(f"{folder}: ezdxf {ezdxf.__version__} read {len(files)} cut files, {len(wrong)} findings")
    return 1 if wrong or not files else 0


def element_table(name: str) -> dict:
    """What a design says of its elements; of planar cells, the narrower beam's width."""
    tables = [tomllib.loads(path.read_text(encoding="utf-8")) for path in sorted(HARDWARE.glob("*.toml"))]
    (table,) = [table for table in tables if table["design"]["name"] == name]
    if "planar" in table:
        return {"beam_width": min(table[kind]["beam_width"] for kind in ("measuring", "reference"))}
    return table["element"]


def file_faults(path: Path, part: dict, element: dict) -> list[str]:
    entities = list(ezdxf.readfile(path).modelspace())
    kinds = {entity.dxftype() for entity in entities} - {"LINE", "ARC", "CIRCLE"}
    if kinds:
        return [f"entities of type {', '.join(sorted(kinds))}"]
    loops, faults = closed_loops(entities)
    areas = sorted(abs(sum(map(area_share, loop))) for loop in loops)
    section = areas[-1] - sum(areas[:-1]) if areas else 0.0
    if abs(section / part["section_area_mm2"] - 1) > AREA:
        faults.append(f"area {section} mm2, the manifest has {part['section_area_mm2']} mm2")
    if (
        "-element-" in part["part_no"]
    ):  # nothing but the wire shapes an element: its section makes up its volume
        thickness = part["box_mm"][1][2] - part["box_mm"][0][2]
        if abs(section * thickness / part["volume_mm3"] - 1) > AREA:
            faults.append(f"area {section} mm2 times {thickness} mm is not {part['volume_mm3']} mm3")
        found, meant = thinnest(entities), hinge_thickness(part["part_no"], element)
        if abs(found - meant) > HINGE:
            faults.append(f"hinge is {found} mm thick in the file, {meant} mm in the design")
    if part["part_no"].endswith("-foil") and abs(thinnest(entities) - element["beam_width"]) > HINGE:
        width = element["beam_width"]
        faults.append(f"narrowest beam is {thinnest(entities)} mm in the file, {width} mm in the design")
    return faults


def hinge_thickness(part_no: str, element: dict) -> float:
    """The design's, or what an override wrote into the part number (-t0.3)."""
    override = re.search(r"-t([\d.]+)", part_no)
    return float(override.group(1)) if override else element["hinge_thickness"]


def ends(entity) -> tuple[tuple[float, float], tuple[float, float]]:
    if entity.dxftype() == "LINE":
        return (entity.dxf.start.x, entity.dxf.start.y), (entity.dxf.end.x, entity.dxf.end.y)
    d = entity.dxf
    first, last = (0.0, 360.0) if entity.dxftype() == "CIRCLE" else (d.start_angle, d.end_angle)
    points = [
        (d.center.x + d.radius * cos(radians(a)), d.center.y + d.radius * sin(radians(a)))
        for a in (first, last)
    ]
    return points[0], points[1]


def closed_loops(entities: list) -> tuple[list[list[tuple]], list[str]]:
    """Loops of (entity, forwards); entities are picked up by their ends, not by their order."""
    left, loops, faults = list(entities), [], []
    while left:
        loop = [(left.pop(0), True)]
        start, end = ends(loop[0][0])
        while dist(start, end) > CLOSED:
            fitting = [
                (e, way)
                for e in left
                for way in (True, False)
                if dist(ends(e)[0 if way else 1], end) <= CLOSED
            ]
            if not fitting:
                faults.append(f"a chain is open at ({end[0]:.6f}, {end[1]:.6f})")
                break
            entity, way = fitting[0]
            left = [e for e in left if e is not entity]
            loop.append((entity, way))
            end = ends(entity)[1 if way else 0]
        loops.append(loop)
    return loops, faults


def area_share(piece: tuple) -> float:
    """Half of the integral of x dy - y dx along the entity."""
    entity, forwards = piece
    (x0, y0), (x1, y1) = ends(entity)
    share = (x0 * y1 - x1 * y0) / 2
    if entity.dxftype() != "LINE":
        d = entity.dxf
        sweep = tau if entity.dxftype() == "CIRCLE" else radians((d.end_angle - d.start_angle) % 360)
        share += d.radius**2 * (sweep - sin(sweep)) / 2
    return share if forwards else -share


def thinnest(entities: list) -> float:
    """Thinnest material met by cuts along y through the middles and centres of all entities, mm."""
    cuts = set()
    for entity in entities:
        (x0, _), (x1, _) = ends(entity)
        cuts.add((x0 + x1) / 2)
        if entity.dxftype() != "LINE":
            cuts.add(entity.dxf.center.x)
    spans = [b - a for x in sorted(cuts) for a, b in material(entities, x)]
    return min(spans)


def material(entities: list, x: float) -> list[tuple[float, float]]:
    """Spans of y inside the part on the cut at x; a cut through a corner is moved aside by 1e-6 mm."""
    if any(abs(p[0] - x) < 1e-9 for entity in entities for p in ends(entity)):
        x += 1e-6
    heights = sorted(y for entity in entities for y in crossings(entity, x))
    return list(zip(heights[::2], heights[1::2]))


def crossings(entity, x: float) -> list[float]:
    if entity.dxftype() == "LINE":
        (x0, y0), (x1, y1) = ends(entity)
        return [y0 + (x - x0) / (x1 - x0) * (y1 - y0)] if min(x0, x1) < x < max(x0, x1) else []
    d = entity.dxf
    off = x - d.center.x
    if abs(off) >= d.radius:
        return []
    half = sqrt(d.radius**2 - off**2)
    both = [(degrees(acos(off / d.radius)), half), (-degrees(acos(off / d.radius)), -half)]
    if entity.dxftype() == "ARC":
        both = [(a, h) for a, h in both if (a - d.start_angle) % 360 < (d.end_angle - d.start_angle) % 360]
    return [d.center.y + h for _, h in both]


if __name__ == "__main__":
    sys.exit(main())
