"""A netlist: components with designators, values and part numbers, and their pins' nets.

Designators by IEC 81346-2: B gauges, C capacitors, D diodes, J connectors, Q transistors, R resistors, U
integrated circuits, W leads, X terminals; A boards. Those of element n: Bn, Xn, W(10 n + 1) and on; those of
board b begin with Ab- and go on as printed on the board (read_board.py).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

Kind = Literal[
    "gauge",
    "resistor",
    "lead",
    "terminal",
    "switch",
    "multiplexer",
    "converter",
    "decoder",
    "amplifier",
    "capacitor",
    "connector",
    "regulator",
    "supply",
    "diode",
    "sensor",
]
GROUND = "GND"


@dataclass(frozen=True)
class Pin:
    """A pin by its number or letter, its role, and its net; "" if it stays open."""

    number: str
    role: str
    net: str


@dataclass(frozen=True)
class Component:
    """One component. `part_no` is its line of the bill. `figures` in V, ohm, F, Hz by name, for the deck.

    `element` and `board`: numbers of its element and board; 0 for none. `footprint`: its name
    (footprints.py), for components on a board; if not `fitted`, its place stays empty.
    """

    designator: str
    kind: Kind
    value: str
    part_no: str
    pins: tuple[Pin, ...]
    figures: tuple[tuple[str, float], ...] = ()
    element: int = 0
    board: int = 0
    footprint: str = ""
    fitted: bool = True

    def net(self, role: str) -> str:
        """The net of the pin with that role; raises KeyError if it has none."""
        return {pin.role: pin.net for pin in self.pins}[role]

    def figure(self, name: str) -> float:
        """Raises KeyError if it has none of that name."""
        return dict(self.figures)[name]


@dataclass(frozen=True)
class Netlist:
    """All components; equal designs give equal netlists, in the same order.

    Raises ValueError if two components share a designator.
    """

    name: str
    excitation: float
    supplies: tuple[tuple[str, float], ...]
    components: tuple[Component, ...] = field(repr=False)

    def __post_init__(self) -> None:
        names = [c.designator for c in self.components]
        if len(set(names)) != len(names):
            raise ValueError(f"netlist {self.name}: designators are not unique")

    @cached_property
    def nets(self) -> dict[str, tuple[tuple[Component, Pin], ...]]:
        """The pins on every net, by its name, in the order of the components."""
        nets: dict[str, list[tuple[Component, Pin]]] = {}
        for component in self.components:
            for pin in component.pins:
                if pin.net:
                    nets.setdefault(pin.net, []).append((component, pin))
        return {name: tuple(nodes) for name, nodes in nets.items()}

    def of_kind(self, kind: Kind) -> Iterator[Component]:
        """Those that are fitted."""
        return (c for c in self.components if c.kind == kind and c.fitted)

    def pin_at(self, place: str) -> Pin:
        """A pin by designator and number: X1.2. Raises StopIteration if there is none."""
        name, _, number = place.rpartition(".")
        return next(p for c in self.components if c.designator == name for p in c.pins if p.number == number)

    @cached_property
    def excitations(self) -> frozenset[str]:
        """The bridges' supplies, a net a board."""
        return frozenset(c.net("out") for c in self.of_kind("regulator"))

    def on_board(self, kind: Kind, board: int) -> Component:
        """The amplifier, multiplexer or decoder of a board. Raises KeyError if there is none."""
        return self._once["board", kind, board]

    def of_element(self, kind: Kind, element: int) -> Component:
        """The gauge, terminal or switch of an element. Raises KeyError if there is none."""
        return self._once["element", kind, element]

    @cached_property
    def _once(self) -> dict[tuple[str, Kind, int], Component]:
        own = {("element", c.kind, c.element): c for c in self.components if c.element}
        return own | {("board", c.kind, c.board): c for c in self.components if not c.element}
