"""The circuit's files: KiCad's netlist, the same as a table, the SPICE deck, the leads to cut; read back and
compared with the netlist before they leave.
"""

from __future__ import annotations

import csv
import io
import re

from tactcad.circuit.harness import harness_csv
from tactcad.circuit.netlist import Netlist
from tactcad.circuit.netlist_files import deck_bytes, kicad_bytes, netlist_csv, wiring_csv
from tactcad.design.family import family_of
from tactcad.design.messages import CheckFailure
from tactcad.design.tree import CommonTables

Nets = dict[str, frozenset[tuple[str, str]]]  # designators and pins by net


def kicad_file(design: CommonTables, circuit: Netlist) -> bytes:
    """KiCad's netlist. Raises CheckFailure if it does not read back as the circuit."""
    d = design.design
    data = kicad_bytes(circuit, d.title, d.organisation, d.date, d.revision)
    check_nets("KiCad's netlist", nets_in_kicad(data), circuit)
    return data


def table_file(design: CommonTables, circuit: Netlist) -> bytes:
    """The netlist as CSV. Raises CheckFailure if it does not read back as the circuit."""
    data = netlist_csv(circuit)
    check_nets("the netlist's table", nets_in_table(data), circuit)
    return data


def deck_file(design: CommonTables, circuit: Netlist) -> bytes:
    """The SPICE deck, with the boards' tracks."""
    family = family_of(design)
    return deck_bytes(family.must("readout", "export").tracks(family.layout(design), circuit))


def wiring_file(design: CommonTables, circuit: Netlist) -> bytes:
    """The leads to cut. Raises CheckFailure if they are not the circuit's, each once."""
    family = family_of(design)
    data = wiring_csv(family.must("readout", "export").wiring(family.layout(design), circuit))
    check_leads(data, circuit)
    return data


def harness_file(design: CommonTables, circuit: Netlist) -> bytes:
    """Every wire with both its ends."""
    family = family_of(design)
    return harness_csv(circuit, family.must("readout", "export").wiring(family.layout(design), circuit))


def nets_in_kicad(data: bytes) -> Nets:
    """Nets of a KiCad netlist."""
    _, _, text = data.decode().partition("(nets")
    nets: dict[str, set[tuple[str, str]]] = {}
    name = ""
    for key, word, pin in re.findall(r'\((name|node \(ref) "([^"]*)"\)?(?: \(pin "([^"]*)"\))?', text):
        if key == "name":
            name = word.removeprefix("/")
        else:
            nets.setdefault(name, set()).add((word, pin))
    return {name: frozenset(nodes) for name, nodes in nets.items()}


def nets_in_table(data: bytes) -> Nets:
    """Nets of a netlist as CSV."""
    nets: dict[str, set[tuple[str, str]]] = {}
    for row in csv.DictReader(io.StringIO(data.decode(), newline=""), strict=True):
        if row["net"]:
            nets.setdefault(row["net"], set()).add((row["designator"], row["pin"]))
    return {name: frozenset(nodes) for name, nodes in nets.items()}


def check_nets(what: str, read: Nets, circuit: Netlist) -> None:
    """Raises CheckFailure if the nets read back are not the circuit's."""
    meant = {
        name: frozenset((c.designator, p.number) for c, p in nodes) for name, nodes in circuit.nets.items()
    }
    wrong = sorted(name for name in {*read, *meant} if read.get(name) != meant.get(name))
    if wrong:
        raise CheckFailure(f"{what} reads back with other nets: {', '.join(wrong[:3])}")


def check_leads(data: bytes, circuit: Netlist) -> None:
    """Raises CheckFailure if the wiring list does not name every lead of the circuit once."""
    rows = csv.DictReader(io.StringIO(data.decode(), newline=""))
    if sorted(row["lead"] for row in rows) != sorted(c.designator for c in circuit.of_kind("lead")):
        raise CheckFailure("the wiring list does not name every lead of the circuit once")
