"""A board as a solid for the assembly: the bare board with the holes of its screws and ties, and a block for
everything that is fitted. mm, x and y as in the outline's DXF, z = 0 on the underside. Soldered pins, which
protrude 1.4 mm below it, are left out.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from tactcad.circuit.copper import BoardCopper
from tactcad.circuit.footprints import Footprint
from tactcad.contour import circle, rectangle
from tactcad.design.messages import CheckFailure
from tactcad.parts.language.description import Extrusion, Material, Part
from tactcad.scenes.scene import UPRIGHT, Placement, Scene, rotation

from .shapes import Shapes
from .step_text import Header

FR4 = Material("FR-4", 1850)  # kg/m3, usual
SOLDERED = Material("electronic part", 2000)  # of no meaning: a block around it
TURNED = {
    0: UPRIGHT,
    90: rotation(((0, -1, 0), (1, 0, 0), (0, 0, 1))),
    180: rotation(((-1, 0, 0), (0, -1, 0), (0, 0, 1))),
    270: rotation(((0, 1, 0), (-1, 0, 0), (0, 0, 1))),
}
LAST = 1e-3  # mm, KiCad's last digit as written
NUMBER = r"([-\d.]+)"
EDGE = re.compile(rf'\(gr_line \(start {NUMBER} {NUMBER}\) \(end {NUMBER} {NUMBER}\) \(layer "Edge.Cuts"\)')
THICK = re.compile(rf"\(general \(thickness {NUMBER}\)\)")
HOLE = re.compile(rf'\(footprint "tactcad:hole" .*?\(at {NUMBER} {NUMBER}\)\n.*\n\(pad .*?\(drill {NUMBER}\)')


def board_scene(board: BoardCopper, name: str) -> Scene:
    """The board, and blocks on it under their designators."""
    bare = _bare(board, f"{name}-bare")
    blocks = {f: _block(f, name) for f in {p.footprint for p in board.placed if p.component.fitted}}
    placed = (
        Placement(
            p.component.designator,
            blocks[p.footprint],
            (p.at[0], board.height - p.at[1], board.thickness),
            TURNED[p.turn],
        )
        for p in board.placed
        if p.component.fitted
    )
    return Scene(name, (Placement("BOARD", bare), *placed))


def _bare(board: BoardCopper, part_no: str) -> Part:
    holes = tuple(circle((x, board.height - y), d) for x, y, d in board.holes)
    body = Extrusion(rectangle(0.0, 0.0, board.width, board.height), board.thickness, holes)
    return Part(part_no, "bare board", "reference", FR4, body, colour="#1f6b3a")


def _block(f: Footprint, name: str) -> Part:
    x, y = f.body[0] / 2, f.body[1] / 2
    body = Extrusion(rectangle(-x, -y, x, y), f.height)
    return Part(f"{name}-{f.name}", f.name, "reference", SOLDERED, body, colour="#3a3a3a")


def board_step(board: BoardCopper, kicad: bytes, shapes: Shapes, header: Header) -> bytes:
    """The STEP file, read back and compared with the edge and the holes of KiCad's file."""
    from tactcad.solids.measure import bounding_box, holes_through

    from .step_file import read_assembly, scene_step

    scene = board_scene(board, header.name)
    data = scene_step(scene, {part.part_no: shapes.of(part) for part in scene.parts}, header)
    bare = scene.parts[0].part_no
    shape = read_assembly(data).shapes[bare]
    check_bare_board(bare, bounding_box(shape), holes_through(shape), kicad)
    return data


def check_bare_board(
    name: str, box: Sequence[Sequence[float]], cylinders: Sequence[tuple[float, float, float]], kicad: bytes
) -> None:
    """Raises CheckFailure if a solid's box or its holes (x, y, diameter) are not those of KiCad's file."""
    text = kicad.decode()
    (thick,) = (float(found) for found in THICK.findall(text))
    ends = [tuple(map(float, found)) for found in EDGE.findall(text)]
    xs, ys = ({v for e in ends for v in (e[k], e[k + 2])} for k in (0, 1))
    low, high = (min(xs), min(ys), 0.0), (max(xs), max(ys), thick)
    if max(abs(a - b) for got, meant in zip(box, (low, high)) for a, b in zip(got, meant)) > LAST:
        raise CheckFailure(f"{name}: the STEP file reads back in a box of {box}, not {low} to {high}")
    holes = [(float(x), max(ys) - float(y), float(d)) for x, y, d in HOLE.findall(text)]
    if sorted(_rounded(cylinders)) != sorted(_rounded(holes)):
        raise CheckFailure(f"{name}: the STEP file reads back with other holes than KiCad's board")


def _rounded(holes: Sequence[tuple[float, float, float]]) -> list[tuple[float, ...]]:
    return [tuple(round(v, 3) + 0.0 for v in hole) for hole in holes]
