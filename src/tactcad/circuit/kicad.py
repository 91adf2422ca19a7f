"""The netlist as KiCad reads it: S-expressions, version E, as eeschema of KiCad 6 and later writes them."""

from __future__ import annotations

from uuid import NAMESPACE_OID, uuid5

from .netlist import Component, Netlist

PASSIVE = ("lead", "terminal", "gauge", "resistor", "capacitor", "connector")
Expression = str | tuple


def kicad_bytes(netlist: Netlist, title: str, company: str | None, date: str, revision: str) -> bytes:
    """The file (UTF-8); `date` of issue, so that equal designs give equal bytes."""
    # with all that eeschema writes there: readers ask for it
    comments = (("comment", ("number", str(i)), ("value", "")) for i in range(1, 10))
    texts = (
        ("title", title),
        ("company", *([company] if company else [])),
        ("rev", revision),
        ("date", date),
        ("source", netlist.name),
    )
    block = ("title_block", *texts, *comments)
    sheet = ("sheet", ("number", "1"), ("name", "/"), ("tstamps", "/"), block)
    head = ("design", ("source", netlist.name), ("date", date), ("tool", "tactcad"), sheet)
    kinds = {c.part_no: c for c in reversed(netlist.components)}
    parts = tuple(_part(kinds[name]) for name in sorted(kinds))
    nets = tuple(
        (
            "net",
            ("code", str(code)),
            ("name", f"/{name}"),
            *(
                ("node", ("ref", c.designator), ("pin", pin.number), ("pinfunction", pin.role))
                for c, pin in nodes
            ),
        )
        for code, (name, nodes) in enumerate(sorted(netlist.nets.items()), start=1)
    )
    components = tuple(_component(netlist, c) for c in netlist.components)
    whole = (
        "export",
        ("version", "E"),
        head,
        ("components", *components),
        ("libparts", *parts),
        ("libraries",),
        ("nets", *nets),
    )
    return (_text(whole, 0) + "\n").encode()


def _component(netlist: Netlist, c: Component) -> Expression:
    own = str(uuid5(NAMESPACE_OID, f"{netlist.name}/{c.designator}"))
    return (
        "comp",
        ("ref", c.designator),
        ("value", c.value),
        ("fields", ("field", ("name", "part_no"), c.part_no)),
        ("libsource", ("lib", "tactcad"), ("part", c.part_no), ("description", c.kind)),
        ("sheetpath", ("names", "/"), ("tstamps", "/")),
        ("tstamps", own),
    )


def _part(c: Component) -> Expression:
    kind = "passive" if c.kind in PASSIVE else "unspecified"
    # a connector's pins by number: what is on them differs from board to board
    names = (p.number if c.kind == "connector" else p.role for p in c.pins)
    pins = tuple(("pin", ("num", p.number), ("name", name), ("type", kind)) for p, name in zip(c.pins, names))
    return ("libpart", ("lib", "tactcad"), ("part", c.part_no), ("description", c.kind), ("pins", *pins))


def _text(expression: Expression, depth: int) -> str:
    """Lists that hold no list of lists stand on one line; words after the first are quoted."""
    if isinstance(expression, str):
        return '"' + expression.replace("\\", "\\\\").replace('"', '\\"') + '"'
    head, *rest = expression
    if any(isinstance(r, tuple) and any(isinstance(x, tuple) for x in r) for r in rest):
        inner = "".join(f"\n{'  ' * (depth + 1)}{_text(r, depth + 1)}" for r in rest)
        return f"({head}{inner})"
    return f"({' '.join([head, *(_text(r, depth) for r in rest)])})"
