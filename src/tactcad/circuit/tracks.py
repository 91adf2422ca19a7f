"""The tracks' resistance in a circuit: every track and via of a board as a resistor of its own.

A net of a board falls apart into nodes, NET__1 and on: one for every track end, pad or via. Planes are
without resistance. A net keeps its name on its plane and at its connector.
"""

from __future__ import annotations

from dataclasses import replace
from math import dist, pi

from tactcad.parts.array.layout import Layout
from tactcad.parts.array.leads import ReadBoard, boards
from tactcad.parts.bought.electronic_parts import COMPLETION

from .board_layout import laid_out
from .bridges import array_net
from .copper import BOTTOM, PLANES, TOP, VIA_DRILL, BoardCopper, Point
from .netlist import Component, Netlist
from .read_board import two

COPPER = 1.7241e-5  # ohm mm, annealed at 20 C (IEC 60028)
FOIL, PLATING, THROUGH = 0.035, 0.020, 1.6  # mm: tracks' thickness, vias' wall, the board
VIA_OHM = COPPER * THROUGH / (pi * VIA_DRILL * PLATING)
TRACK_PART = "TRACK"


def with_tracks(layout: Layout, circuit: Netlist) -> Netlist:
    """The array's circuit with the tracks of its boards."""
    made = {_used(b.netlist): b for b in laid_out(layout)}
    found: list[Component] = [c for c in circuit.components if not c.designator.startswith("A")]
    for board in boards(layout):
        copper = made[len(board.places)]
        nodes, tracks = _nodes(copper)
        ends = (node for a, b, _ in tracks for node in (a, b))
        names = {node: _named(board, node) for node in {*nodes.values(), *ends}}
        own = [c for c in circuit.components if c.designator.startswith(f"A{board.number}-")]
        for c in own:
            name = c.designator.partition("-")[2]
            pins = tuple(
                replace(p, net=names[nodes[name, p.number]] if (name, p.number) in nodes else p.net)
                for p in c.pins
            )
            found.append(replace(c, pins=pins))
        for i, (a, b, ohm) in enumerate(tracks, start=1):
            nets = (names[a], names[b])
            found.append(
                replace(
                    two(f"A{board.number}-T{i}", "resistor", "track", TRACK_PART, nets, ohm=ohm),
                    board=board.number,
                )
            )
    return replace(circuit, components=tuple(found))


def _used(circuit: Netlist) -> int:
    """Elements that a board reads: three arms of each."""
    return sum(c.part_no == COMPLETION for c in circuit.of_kind("resistor")) // 3


def _on(p: Point, a: Point, b: Point) -> bool:
    return dist(a, p) + dist(p, b) - dist(a, b) < 1e-9


Between = tuple[str, str, float]  # two nodes, and the ohm between them


def _named(board: ReadBoard, node: str) -> str:
    """A board's node in the array's circuit."""
    net, mark, number = node.partition("__")
    return array_net(board, net) + (f"{mark}{board.number}_{number}" if mark else "")


def _nodes(board: BoardCopper) -> tuple[dict[tuple[str, str], str], list[Between]]:
    """The node of every pin, and every track and via between two nodes with its ohm."""
    numbers: dict[tuple[str, str, Point], int] = {}
    on_plane = set(PLANES.values())

    def node(net: str, layer: str, at: Point) -> str:
        return f"{net}__{numbers.setdefault((net, layer, at), len(numbers) + 1)}"

    at_pads: dict[str, list[Point]] = {}
    for _, _, at, net in board.pads:
        at_pads.setdefault(net, []).append(at)
    tracks: list[Between] = []
    for t in board.tracks:
        inside = [p for p in at_pads.get(t.net, ()) if t.layer == TOP and _on(p, t.start, t.end)]
        stops = sorted({t.start, t.end, *inside}, key=lambda p: dist(p, t.start))
        for a, b in zip(stops, stops[1:]):
            ohm = COPPER * dist(a, b) / (t.width * FOIL)
            tracks.append((node(t.net, t.layer, a), node(t.net, t.layer, b), ohm))
    for via in board.vias:
        other = via.net if via.net in on_plane else node(via.net, BOTTOM, via.at)
        tracks.append((node(via.net, TOP, via.at), other, VIA_OHM))
    pins: dict[tuple[str, str], str] = {}
    for placed, pad, at, net in board.pads:
        if not net:
            continue
        here = node(net, TOP, at)
        if placed.component.kind == "connector" or (pad.drill and net in on_plane):
            tracks.append((here, net, VIA_OHM))  # at a wire's entry, or for a pin in its plane
        pins[placed.component.designator, pad.number] = here
    return pins, tracks
