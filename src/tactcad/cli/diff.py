"""tactcad diff A B [--json] [--html FILE]"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict

from .parser import add_json

EXAMPLES = """\
  tactcad diff exports/golden/macro-array.json macro-array     what changed since the committed geometry
  tactcad diff before exports/macro-array --html changes.html  two exports, with their pictures side by side
  tactcad diff macro-array my/design.toml --json               two designs, as JSON

A and B are each a design (a path or a name in hardware/), an export's folder, or a golden file (.json).
What only one of them tells is left out, and said. The exit status is 0 whether anything changed or not."""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("old", metavar="A", help="design, export's folder or golden file")
    parser.add_argument("new", metavar="B", help="the same, what it became")
    add_json(parser)
    parser.add_argument(
        "--html", metavar="FILE", help="also write one offline page with contours laid over each other"
    )


def run(args: argparse.Namespace) -> int:
    from tactcad.design.files import refuse_overwriting, write_whole
    from tactcad.export.sides import compare_sides, named, not_compared, read_side

    if args.html:
        refuse_overwriting(args.html, named(args.old), named(args.new), option="--html")
    old, new = read_side(args.old), read_side(args.new)
    changes = compare_sides(old, new)
    left_out = not_compared(old, new)
    if args.html:
        from tactcad.export.difference_page import page

        write_whole(args.html, page(old, new, changes))
    if args.json:
        sides = {
            name: {"source": side.source, "kind": side.kind, "design": side.design, "revision": side.revision}
            for name, side in (("old", old), ("new", new))
        }
        record = {
            **sides,
            "identical": not changes,
            "not_compared": left_out,
            "changes": [asdict(c) for c in changes],
        }
        print(json.dumps(record, indent=1))
        return 0
    for change in changes:
        print(change)
    for text in left_out:
        print(f"not compared: {text}")
    if not changes:
        print(f"no difference: {old.source} and {new.source}")
    return 0
