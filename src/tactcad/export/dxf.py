"""The cut file of a part that is cut from sheet or plate, written from its contours and read back.

AC1015 with LINE, ARC and CIRCLE on one layer is read exactly by every importer that was tried. Entities
follow each contour head to tail; openings come before the outline, in the order of cutting, since the part
drops with the last cut. The file holds the nominal contour: wire compensation belongs to the machine.
"""

from __future__ import annotations

import io
import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import degrees, dist, isclose
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tactcad.contour import Arc, Contour, Line, Point, Segment
from tactcad.design.messages import CheckFailure
from tactcad.parts.language.description import Extrusion, Part
from tactcad.parts.language.stock import cut_section

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.entities import DXFEntity

LAYER = "CUT"
CLOSED_MM = 1e-6  # a chain with a larger gap is open
ARC_END_MM = 1e-9  # an end computed from a written arc may differ by rounding only
MILLIMETRES, METRIC = 4, 1


@dataclass(frozen=True)
class CutFile:
    """Contents of a cut file: closed contours in mm, as read, and their surroundings.

    `gap` is the largest distance (mm) between the end of one entity and the start of the next.
    """

    outer: Contour
    openings: tuple[Contour, ...]
    entities: tuple[tuple[str, Segment], ...]  # type and geometry, in file order
    layers: frozenset[str]
    version: str
    insunits: int
    measurement: int
    gap: float
    flat: bool  # everything on Z = 0, seen from +Z


def _section(part: Part) -> Extrusion:
    cut = cut_section(part)
    if cut is None:
        raise ValueError(f"{part.part_no} is not cut along a contour")
    return cut


def dxf_bytes(part: Part) -> bytes:
    """The cut file of a part that is cut from sheet or plate.

    Its bytes depend on neither process, time zone nor home folder.

    Parameters
    ----------
    part
        A part that has a cut file (`tactcad.parts.language.stock`).

    Raises
    ------
    ValueError
        If the part has none.
    """
    cut = _section(part)
    return layered_dxf({LAYER: (*cut.openings, cut.outer)}, cut.outer.box)


def layered_dxf(
    layers: Mapping[str, Sequence[Contour | Line]], box: tuple[float, float, float, float]
) -> bytes:
    """Contours and lines on named layers within a box (mm), in their order, as DXF R2000 in millimetres."""
    import ezdxf

    earlier = ezdxf.options.write_fixed_meta_data_for_testing
    ezdxf.options.write_fixed_meta_data_for_testing = True  # no dates, no random GUIDs
    try:
        drawing = ezdxf.new("R2000")
        drawing.header["$INSUNITS"] = MILLIMETRES
        drawing.header["$MEASUREMENT"] = METRIC
        for colour, (layer, drawn) in enumerate(layers.items(), start=8 - len(layers)):
            drawing.layers.add(layer, color=colour)
            for contour in drawn:
                _add(drawing, contour, layer)
        lower, upper = (box[0], box[1], 0.0), (box[2], box[3], 0.0)
        drawing.modelspace().reset_extents(lower, upper)
        drawing.header["$EXTMIN"], drawing.header["$EXTMAX"] = lower, upper
        text = io.StringIO(newline="\n")
        drawing.write(text)
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = earlier
    return drawing.encode(text.getvalue())


def checked_dxf(part: Part) -> bytes:
    """The part's cut file, read back. Raises CheckFailure if it differs from the part."""
    data = dxf_bytes(part)
    wrong = check_dxf(data, part)
    if wrong:
        raise CheckFailure(f"{part.part_no}: DXF file: {'; '.join(wrong)}")
    return data


def _add(drawing: Drawing, contour: Contour | Line, layer: str) -> None:
    """Append a contour's entities to the model space, head to tail."""
    space, on_layer = drawing.modelspace(), {"layer": layer}
    if isinstance(contour, Contour) and (round_one := contour.as_circle()):
        centre, radius = round_one
        space.add_circle(_clean(centre), radius, dxfattribs=on_layer)
        return
    for s in contour if isinstance(contour, Contour) else (contour,):
        if isinstance(s, Line):
            space.add_line(_clean(s.start), _clean(s.end), dxfattribs=on_layer)
        else:
            first, last = (s.start_angle, s.end_angle) if s.ccw else (s.end_angle, s.start_angle)
            angles = degrees(first) % 360.0, degrees(last) % 360.0  # DXF arcs run counter-clockwise
            space.add_arc(_clean(s.centre), s.radius, *angles, dxfattribs=on_layer)


def _clean(point: Point) -> Point:
    """Without negative zeros, which would write one point in two ways."""
    return (point[0] + 0.0, point[1] + 0.0)


def read_dxf(file: str | Path | bytes) -> CutFile:
    """Read a cut file, by its path or as its bytes, whose entities follow its contours head to tail.

    Raises ValueError if the file is no DXF, if there is anything but LINE, ARC and CIRCLE, if a chain is
    open, or if entities do not follow each other.
    """
    import ezdxf

    logging.getLogger("ezdxf").setLevel(logging.CRITICAL)  # its message on a damaged file is in ours
    try:
        if isinstance(file, bytes):
            drawing = ezdxf.read(io.StringIO(file.decode("cp1252")))
        else:
            drawing = ezdxf.readfile(file)
    except Exception as error:  # its parser raises whatever it meets: IndexError, StopIteration, ...
        raise ValueError(f"not readable as DXF: {error}") from error
    read = [_segment(entity) for entity in drawing.modelspace()]
    others = sum(len(layout) for layout in drawing.layouts if layout.name != "Model")
    if others:
        raise ValueError(f"{others} entities outside the model space")
    chains, gap = _chains([s for _, s in read])
    if not chains:
        raise ValueError("the file is empty")
    outer = max(chains, key=lambda c: c.area)
    return CutFile(
        outer=outer,
        openings=tuple(c for c in chains if c is not outer),
        entities=tuple(read),
        layers=frozenset(entity.dxf.layer for entity in drawing.modelspace()),
        version=drawing.dxfversion,
        insunits=drawing.header.get("$INSUNITS", 0),
        measurement=drawing.header.get("$MEASUREMENT", 0),
        gap=gap,
        flat=all(_is_flat(entity) for entity in drawing.modelspace()),
    )


def _segment(entity: Any) -> tuple[str, Segment]:
    """Type and geometry of one entity; a circle is an arc that ends where it starts."""
    kind, data = entity.dxftype(), entity.dxf
    if kind == "LINE":
        return kind, Line((data.start.x, data.start.y), (data.end.x, data.end.y))
    if kind == "ARC":
        first, last, centre = ((p.x, p.y) for p in (entity.start_point, entity.end_point, data.center))
        return kind, Arc(first, last, centre, ccw=True)
    if kind == "CIRCLE":
        centre, east = (data.center.x, data.center.y), (data.center.x + data.radius, data.center.y)
        return kind, Arc(east, east, centre, ccw=True)
    raise ValueError(f"entity {data.handle} is a {kind}; only LINE, ARC and CIRCLE may be in a cut file")


def _is_flat(entity: DXFEntity) -> bool:
    data = entity.dxf
    points = (data.start, data.end) if entity.dxftype() == "LINE" else (data.center,)
    upright = tuple(data.get("extrusion", (0.0, 0.0, 1.0))) == (0.0, 0.0, 1.0)
    return upright and data.get("thickness", 0.0) == 0.0 and all(p.z == 0.0 for p in points)


def _chains(segments: list[Segment]) -> tuple[list[Contour], float]:
    """Closed contours of segments that follow each other, and the largest gap between neighbours."""
    contours: list[Contour] = []
    chain: list[Segment] = []
    largest = 0.0
    for s in segments:
        if not chain and s.start == s.end and s.length > 0:
            contours.append(Contour((s,)))
            continue
        if len(chain) == 1 and isinstance(chain[0], Arc) and not _follows(chain[0].end, s):
            chain[0] = chain[0].reversed()  # an arc in a file has no direction; the next entity gives it
        if chain:
            # The segment in the direction in which it starts at `end`; only arcs may be turned.
            end = chain[-1].end
            if not _follows(end, s):
                raise ValueError(f"the chain is open: {end} is followed by {s.start}")
            turned = s if dist(end, s.start) <= CLOSED_MM else s.reversed()
            largest = max(largest, dist(chain[-1].end, turned.start))
            s = turned
        chain.append(s)
        if len(chain) > 1 and dist(s.end, chain[0].start) <= CLOSED_MM:
            largest = max(largest, dist(s.end, chain[0].start))
            contours.append(_snapped(chain))
            chain = []
    if chain:
        raise ValueError(f"the chain that starts at {chain[0].start} is open")
    return contours, largest


def _follows(end: Point, s: Segment) -> bool:
    return dist(end, s.start) <= CLOSED_MM or (isinstance(s, Arc) and dist(end, s.end) <= CLOSED_MM)


def _snapped(chain: list[Segment]) -> Contour:
    """A contour with shared ends: where an arc meets a line, the line's written end holds."""
    joints = []
    for before, after in zip([chain[-1], *chain], chain):
        joints.append(after.start if isinstance(after, Line) else before.end)
    ends = [*joints[1:], joints[0]]
    return Contour(
        tuple(
            Line(a, b) if isinstance(s, Line) else Arc(a, b, s.centre, s.ccw)
            for s, a, b in zip(chain, joints, ends)
        )
    )


def check_dxf(written: str | Path | bytes, part: Part) -> list[str]:
    """Faults of a written cut file compared with its part.

    Parameters
    ----------
    written
        Path of the file, or its bytes.
    part
        A part that has a cut file (`cut_section`).

    Returns
    -------
    list of str
        Version, units, layers, gaps, double entities, and contours that differ in area, length or box; empty
        if nothing is wrong.
    """
    try:
        file = read_dxf(written)
    except ValueError as error:
        return [str(error)]
    wrong = []
    if file.version != "AC1015":
        wrong.append(f"version {file.version} instead of AC1015")
    if (file.insunits, file.measurement) != (MILLIMETRES, METRIC):
        wrong.append(f"$INSUNITS={file.insunits} $MEASUREMENT={file.measurement} are not metric millimetres")
    if file.layers != {LAYER}:
        wrong.append(f"layers {sorted(file.layers)} instead of {LAYER} alone")
    if not file.flat:
        wrong.append("something lies off Z=0")
    if file.gap > ARC_END_MM:
        wrong.append(f"neighbours are {file.gap:.3g} mm apart")
    wrong += _short_or_double(file)
    cut = _section(part)
    return wrong + _differences(file, cut.outer, cut.openings)


def _short_or_double(file: CutFile) -> list[str]:
    segments = [s for _, s in file.entities]
    short = [f"entity without length at {s.start}" for s in segments if s.length <= CLOSED_MM]
    double = [f"two equal entities at {a.start}" for a, b in combinations(segments, 2) if _same(a, b)]
    return short + double


def _same(a: Segment, b: Segment) -> bool:
    """Whether two segments are the same curve, in either direction."""
    if isinstance(a, Line) != isinstance(b, Line):
        return False
    ends = max(dist(a.start, b.start), dist(a.end, b.end))
    turned = max(dist(a.start, b.end), dist(a.end, b.start))
    return min(ends, turned) <= CLOSED_MM and dist(a.at(0.5), b.at(0.5)) <= CLOSED_MM


def _differences(file: CutFile, outer: Contour, openings: tuple[Contour, ...]) -> list[str]:
    """Contours of the file against those of the part, pair by pair: count, area, length and box."""
    if len(file.openings) != len(openings):
        return [f"{len(file.openings)} openings instead of {len(openings)}"]
    wrong = []
    for name, read, made in (
        ("outline", file.outer, outer),
        *((f"opening {i}", read, made) for i, (read, made) in enumerate(zip(file.openings, openings), 1)),
    ):
        for what in ("area", "length"):
            a, b = getattr(read, what), getattr(made, what)
            if not isclose(a, b, rel_tol=1e-9):
                wrong.append(f"{what} of the {name} is {a!r} instead of {b!r}")
        if max(abs(a - b) for a, b in zip(read.box, made.box)) > ARC_END_MM:
            wrong.append(f"box of the {name} is {read.box} instead of {made.box}")
    return wrong
