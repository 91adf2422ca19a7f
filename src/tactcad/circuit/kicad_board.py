"""A board as KiCad 6 reads it (S-expressions, version 20211014), its planes filled, ready to check and plot.
Opened and checked with KiCad 6.0.11; other versions are untried.
"""

from __future__ import annotations

from collections.abc import Iterator
from uuid import NAMESPACE_OID, uuid5

from .copper import (
    BOTTOM,
    CLEARANCE,
    GAP,
    LAYERS,
    PLANES,
    SPOKE,
    TOP,
    VIA,
    VIA_DRILL,
    BoardCopper,
    Placed,
    Point,
)
from .printed import INK, printed

VERSION = "20211014"
NUMBER = {TOP: 0, "In1.Cu": 1, "In2.Cu": 2, BOTTOM: 31}
OTHERS = (
    (34, "B.Paste"), (35, "F.Paste"), (36, "B.SilkS"), (37, "F.SilkS"), (38, "B.Mask"), (39, "F.Mask"),
    (44, "Edge.Cuts"), (46, "B.CrtYd"), (47, "F.CrtYd"), (48, "B.Fab"), (49, "F.Fab"),
)  # fmt: skip
EDGE_LINE = 0.1  # mm


def board_bytes(board: BoardCopper, name: str, title: str, date: str, revision: str) -> bytes:
    """The file (UTF-8); `name` is printed on the board; equal boards give equal bytes."""
    head = (
        f"(kicad_pcb (version {VERSION}) (generator tactcad)",
        f'(general (thickness {board.thickness:g})) (paper "A4" portrait)',
        f"(title_block (title {_quoted(title)}) (date {_quoted(date)}) (rev {_quoted(revision)}))",
        f"(layers {' '.join(_layers())})",
        '(setup (pad_to_mask_clearance 0.05)) (net 0 "")',
    )
    writer = _Writer(board)
    lines = (
        *head,
        *writer.nets(),
        *writer.footprints(),
        *writer.holes(),
        *writer.drawn(name),
        *writer.copper(),
    )
    return ("\n".join([*lines, *writer.zones(), ")"]) + "\n").encode()


def _layers() -> Iterator[str]:
    for name in LAYERS:
        yield f'({NUMBER[name]} "{name}" {"power" if name in PLANES else "signal"})'
    for number, name in OTHERS:
        yield f'({number} "{name}" user)'


def _xy(name: str, p: Point) -> str:
    return f"({name} {p[0]:.7g} {p[1]:.7g})"


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


class _Writer:
    """The file's parts, line by line."""

    def __init__(self, board: BoardCopper) -> None:
        self.board = board
        self.codes = {net: i for i, net in enumerate(sorted(board.netlist.nets), start=1)}

    def own(self, *what: object) -> str:
        """A mark that is the same in every file of this board."""
        return f"(tstamp {uuid5(NAMESPACE_OID, f'{self.board.netlist.name}/{what}')})"

    def net(self, name: str) -> str:
        return f'(net {self.codes[name]} "/{name}")'

    def nets(self) -> Iterator[str]:
        return map(self.net, self.codes)

    def footprints(self) -> Iterator[str]:
        for placed in self.board.placed:
            c, f, name = placed.component, placed.footprint, placed.component.designator
            at = f"(at {placed.at[0]:.7g} {placed.at[1]:.7g} {placed.turn})"
            yield f'(footprint "tactcad:{f.name}" (layer "F.Cu") {self.own(name)} {at}'
            fitted = "yes" if c.fitted else "no"
            yield f'(property "part_no" {_quoted(c.part_no)}) (property "fitted" "{fitted}")'
            off = "" if c.fitted else " exclude_from_pos_files exclude_from_bom"
            path = uuid5(NAMESPACE_OID, f"{self.board.netlist.name}/{name}")
            yield f'(path "/{path}") (attr {"through_hole" if f.through else "smd"}{off})'
            effects = "(effects (font (size 1 1) (thickness 0.15)))"
            for kind, text in (("reference", name), ("value", c.value)):
                where = '(at 0 0) (layer "F.Fab") hide'
                yield f"(fp_text {kind} {_quoted(text)} {where} {effects} {self.own(name, kind)})"
            for layer, (x, y) in (("F.CrtYd", f.half), ("F.Fab", (f.body[0] / 2, f.body[1] / 2))):
                ends = f"{_xy('start', (-x, -y))} {_xy('end', (x, y))}"
                yield f'(fp_rect {ends} (layer "{layer}") (width 0.05) (fill none) {self.own(name, layer)})'
            yield from self._pads(placed)
            yield ")"

    def _pads(self, placed: Placed) -> Iterator[str]:
        pins = {p.number: p for p in placed.component.pins}
        for pad in placed.footprint.pads:
            kind, layers = "smd", '"F.Cu" "F.Paste" "F.Mask"'
            if pad.drill:
                kind, layers = "thru_hole", "*.Cu *.Mask"
            pin = pins.get(pad.number)
            words = [
                f'(pad "{pad.number}" {kind} {"circle" if pad.round else "rect"}',
                f"(at {pad.x:.7g} {pad.y:.7g} {placed.turn}) {_xy('size', (pad.w, pad.h))}",
                f"(drill {pad.drill})" if pad.drill else "",
                f"(layers {layers})",
                self.net(pin.net) if pin and pin.net else "",
                f"(pinfunction {_quoted(pin.role)})" if pin else "",
                f"{self.own(placed.component.designator, pad.number)})",
            ]
            yield " ".join(word for word in words if word)

    def holes(self) -> Iterator[str]:
        for i, (x, y, d) in enumerate(self.board.holes, start=1):
            yield f'(footprint "tactcad:hole" (layer "F.Cu") {self.own("hole", i)} {_xy("at", (x, y))}'
            yield "(attr exclude_from_pos_files exclude_from_bom)"
            yield f'(pad "" np_thru_hole circle (at 0 0) (size {d} {d}) (drill {d}) (layers *.Cu *.Mask)))'

    def drawn(self, name: str) -> Iterator[str]:
        """The edge, and the print."""
        corners = self.board.corners()
        for layer, width, lines in (
            ("Edge.Cuts", EDGE_LINE, zip(corners, corners[1:] + corners[:1])),
            ("F.SilkS", INK, printed(self.board, name)),
        ):
            for a, b in lines:
                ends = f"{_xy('start', a)} {_xy('end', b)}"
                yield f'(gr_line {ends} (layer "{layer}") (width {width}) {self.own(layer, a, b)})'

    def copper(self) -> Iterator[str]:
        for t in self.board.tracks:
            ends = f"{_xy('start', t.start)} {_xy('end', t.end)}"
            net = f"(net {self.codes[t.net]})"
            yield f'(segment {ends} (width {t.width}) (layer "{t.layer}") {net} {self.own(t)})'
        for v in self.board.vias:
            size = f'(size {VIA}) (drill {VIA_DRILL}) (layers "F.Cu" "B.Cu")'
            yield f"(via {_xy('at', v.at)} {size} (net {self.codes[v.net]}) {self.own(v)})"

    def zones(self) -> Iterator[str]:
        inside = " ".join(_xy("xy", p) for p in self.board.corners(inside=True))
        for layer, net in self.board.planes.items():
            yield f'(zone (net {self.codes[net]}) (net_name "/{net}") (layer "{layer}") {self.own(layer)}'
            yield f"(hatch edge 0.508) (connect_pads (clearance {CLEARANCE})) (min_thickness 0.1)"
            yield f"(filled_areas_thickness no) (fill yes (thermal_gap {GAP}) (thermal_bridge_width {SPOKE}))"
            filled = " ".join(_xy("xy", p) for p in self.board.outlines[layer])
            yield f'(polygon (pts {inside})) (filled_polygon (layer "{layer}") (pts {filled})))'
