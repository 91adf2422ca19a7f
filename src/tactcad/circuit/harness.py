"""The harness: every wire with both its ends. Leads from the array to the boards, with shield and the array's
metal; cables from the boards to the converter's card and the supplies; what each wire carries, and each
supply in all.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from tactcad.design.files import as_csv
from tactcad.parts.bought.electronic_parts import TO_CARD

from .netlist import GROUND, Component, Netlist
from .netlist_files import Lead

HEAD = ("from", "to", "signal", "wire", "length_mm", "current_mA")
# mA, largest current of a board's circuits without its warm bridge; chosen: twice what amplifier (1.3) and
# LT3042 (2) take, and a decoder that drives nothing.
OWN = {"VPOS": 7.0, "VNEG": 3.0, "V5": 1.0}
CABLE = 500.0  # mm, the bill's
OUT = "OUT"
AT_CARD = {
    OUT: "analogue input {b} +",
    "EXC": "analogue input, free, to see the bridges' supply",
    "ON": "digital output ON, or a jumper to VPOS beside it: high, the bridges are on",
    "DOUT": "digital input, all boards' together: CS{b} picks this one",
}
Row = tuple[str, str, str, str, float, float]


def harness_csv(circuit: Netlist, leads: Sequence[Lead]) -> bytes:
    """The table (RFC 4180, UTF-8)."""
    rows = ((*names, f"{length:g}", f"{current:.3g}") for *names, length, current in _rows(circuit, leads))
    return as_csv([HEAD, *rows])


def _rows(circuit: Netlist, leads: Sequence[Lead]) -> Iterator[Row]:
    # a bridge is two parallel halves of twice the resistance; the gauge's half carries half of the current
    bridge = 1e3 * circuit.excitation / next(circuit.of_kind("gauge")).figure("ohm")
    digital = any(circuit.of_kind("converter"))  # all bridges are warm, not one of a board
    read = Counter(g.board for g in circuit.of_kind("gauge"))
    warm = {board: bridge * (count if digital else 1) for board, count in read.items()}
    for lead in leads:
        signal = circuit.pin_at(lead.end).net
        current = 0.0 if signal.endswith("PLUS") else bridge / 2
        wire = f"{lead.designator}: {lead.wire} {lead.colour}"
        yield lead.start, lead.end, signal, wire, lead.length, current
    for connector in circuit.of_kind("connector"):
        if connector.part_no == TO_CARD:
            yield from _cable(connector, warm[connector.board])
        else:
            (shield, array), b, name = connector.pins[-2:], connector.board, connector.designator
            along = max(lead.length for lead in leads)
            yield f"bundle {b}", f"{name}.{shield.number}", "SHIELD", "braid over the leads", along, 0.0
            bonded = "AWG 26, bonded with silver adhesive"
            yield "array's metal", f"{name}.{array.number}", "ARRAY", bonded, along, 0.0
    for rail, volts in circuit.supplies:
        bridges = sum(warm.values()) if rail == "VPOS" else 0.0
        yield (
            f"supply {rail}",
            "all boards; supplies in any order",
            f"{rail} {volts:g} V",
            "",
            0.0,
            OWN[rail] * len(warm) + bridges,
        )


def _cable(connector: Component, warm: float) -> Iterator[Row]:
    b, last, nets = connector.board, connector.pins[-1], {p.net.rstrip("0123456789") for p in connector.pins}
    for pin in connector.pins:
        current = OWN.get(pin.net, 0.0) + (warm if pin.net == "VPOS" else 0.0)
        if pin is last:
            to = f"analogue input {b} -" if OUT in nets else "0 V of the controller"
        elif pin.net == GROUND:
            to, current = "0 V of the supplies", warm + OWN["VPOS"]
        elif pin.net in OWN:
            to = f"supply {pin.net}"
        else:
            to = AT_CARD.get(pin.net.rstrip("0123456789"), f"digital output {pin.net}").format(b=b)
        yield f"{connector.designator}.{pin.number}", to, pin.net, f"cable {b}", CABLE, current
