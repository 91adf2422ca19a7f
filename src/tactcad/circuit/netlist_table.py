"""The netlist as CSV: a row for every pin."""

from __future__ import annotations

import csv
import io

from .netlist import Netlist

COLUMNS = ("designator", "pin", "role", "net", "kind", "value", "part_no", "element", "board")


def netlist_csv(netlist: Netlist) -> bytes:
    """The table (RFC 4180, UTF-8), components in the netlist's order; an open pin's net is blank."""
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(COLUMNS)
    for c in netlist.components:
        for pin in c.pins:
            where = (c.element or "", c.board or "")
            writer.writerow((c.designator, pin.number, pin.role, pin.net, c.kind, c.value, c.part_no, *where))
    return text.getvalue().encode()
