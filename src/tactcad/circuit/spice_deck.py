"""The netlist as a SPICE deck, for ngspice: every element is read in turn, and the deck prints its bridge's
and its amplifier's output.

Switches are resistors, open at OPEN; an amplifier is its gain behind a resistor without current whose Johnson
noise is the amplifier's own, and one pole at its bandwidth. Logic is left out: the deck's commands close the
switches as the decoder would.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import pi

from .bridges import EXCITATION
from .netlist import Component, Netlist

OPEN = 1e12  # ohm of an open switch; chosen: a millionth of a microvolt at a bridge
POLE_OHM = 1e3  # of the amplifier's pole; chosen: its own noise is nothing behind a gain
FOUR_K_T = 4 * 1.380649e-23 * 300.15  # J, at SPICE's 27 C
WITHOUT_LINES = ("terminal", "decoder", "connector")


def deck_bytes(netlist: Netlist) -> bytes:
    """The deck that reads every element once: lines `E7 output`, with the bridge and the amplifier in V."""
    return deck(netlist, list(reading(netlist))).encode()


def deck(netlist: Netlist, commands: Sequence[str]) -> str:
    """The circuit with all switches open, and commands of ngspice for it."""
    lines = [f"* {netlist.name}: run with ngspice -b", f"VEXC {EXCITATION} 0 {netlist.excitation!r} AC 1"]
    lines += [f"V{rail} {rail} 0 {volts!r}" for rail, volts in netlist.supplies]
    for component in netlist.components:
        lines += _lines(component)
    return "\n".join([*lines, ".control", "set numdgt=13", *commands, ".endc", ".end", ""])


def reading(netlist: Netlist) -> Iterator[str]:
    """Commands that read every element: its bridge's output and the amplifier's."""
    for gauge in netlist.of_kind("gauge"):
        b, n = gauge.board, gauge.element
        amplifier = netlist.on_board("amplifier", b)
        yield from closed(netlist, n)
        yield "op"
        yield f"let bridge{n} = v({_node(amplifier.net('plus'))}) - v({_node(amplifier.net('minus'))})"
        yield f"let output{n} = v({_node(amplifier.net('out'))})"
        yield f"print bridge{n} output{n}"
        yield from closed(netlist, n, OPEN)


def closed(netlist: Netlist, element: int, ohm: float | None = None) -> Iterator[str]:
    """Commands that close the switches of one element; opens them where `ohm` is OPEN."""
    switch = netlist.of_element("switch", element)
    multiplexer = netlist.on_board("multiplexer", switch.board)
    channel = channel_of(multiplexer, element)
    yield f"alter RQ{element} = {switch.figure('ohm') if ohm is None else ohm!r}"
    for side in "AB":
        on = multiplexer.figure("ohm") if ohm is None else ohm
        yield f"alter R{multiplexer.designator}S{channel}{side} = {on!r}"


def channel_of(multiplexer: Component, element: int) -> int:
    """The channel, from 1, that an element's bridge is on."""
    return next(
        int(p.role[1:-1]) for p in multiplexer.pins if p.net == f"E{element}_PLUS" and p.role.startswith("S")
    )


def _node(net: str) -> str:
    return "0" if net == "GND" else net.lower()


def _lines(c: Component) -> list[str]:
    """The component's lines of the deck."""
    if c.kind in WITHOUT_LINES:
        return []
    if c.kind == "switch":
        return [f"RQ{c.element} {_node(c.net('drain'))} {_node(c.net('source'))} {OPEN!r}"]
    if c.kind == "capacitor":
        return [f"{c.designator} {_node(c.net('1'))} {_node(c.net('2'))} {c.figure('farad')!r}"]
    if c.kind == "multiplexer":
        ends = {side: _node(c.net(f"out_{side.lower()}")) for side in "AB"}
        channels = [pin for pin in c.pins if pin.role[0] == "S"]
        return [f"R{c.designator}{p.role} {_node(p.net)} {ends[p.role[-1]]} {OPEN!r}" for p in channels]
    if c.kind == "amplifier":
        inner, name = c.designator.lower(), c.designator
        noise = c.figure("noise") ** 2 / FOUR_K_T
        farad = 1 / (2 * pi * POLE_OHM * c.figure("bandwidth"))
        out = _node(c.net("out"))
        set_by = {pin.net for pin in c.pins if pin.role.startswith("rg") and pin.net}
        return [
            *(f"R{name}{net} {_node(net)} 0 {OPEN!r}" for net in sorted(set_by)),  # none floats
            f"R{name}N {_node(c.net('plus'))} {inner}n {noise!r}",
            f"E{name} {inner}e {_node(c.net('ref'))} {inner}n {_node(c.net('minus'))} {c.figure('gain')!r}",
            f"R{name}P {inner}e {out} {POLE_OHM!r}",
            f"C{name}P {out} 0 {farad!r}",
        ]
    first, second = (_node(c.net(role)) for role in "12")
    return [f"R{c.designator} {first} {second} {c.figure('ohm')!r}"]
