"""tactcad validate [DESIGN] [--out DIR] [--json] [--table1 FILE] [--table2 FILE]"""

from __future__ import annotations

import argparse
import sys
from contextlib import nullcontext

from .parser import BY_NAME, UNLISTED, add_design, add_others


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("-o", "--out", metavar="DIR")
    add_others(parser)
    parser.add_argument("--json", action="store_true")
    add_design(parser)
    parser.add_argument("--design", dest=f"design{BY_NAME}", help=UNLISTED)
    parser.add_argument("--table1", metavar="FILE")
    parser.add_argument("--table2", metavar="FILE")


def run(args: argparse.Namespace) -> int:
    from tactcad.design.family import taken_as
    from tactcad.design.files import refuse_overwriting
    from tactcad.design.load import find
    from tactcad.design.tree import Design
    from tactcad.export.publication import replacing
    from tactcad.paper import array_model as array
    from tactcad.paper import published, validation
    from tactcad.parts.rules import load
    from tactcad.report import report

    if args.out:
        refuse_overwriting(args.out, args.table1, args.table2, find(args.design))
    with replacing(args.out, report.SCHEMA, args.others) if args.out else nullcontext() as work:
        data = published.load(args.table1, args.table2)
        made = validation.validate(data, array.from_design(taken_as(load(args.design), Design, "validate")))
        as_json = report.to_json(made)
        if work:
            files = {"report.html": report.to_html(made).encode(), "report.json": as_json.encode()}
            files |= {
                f"plots/{f.name}.svg": report.standalone(f).encode() for s in made.sections for f in s.figures
            }
            work.write(files)
    if args.json:
        sys.stdout.write(as_json)
    else:
        print(report.to_text(made))
        if args.out:
            print(f"\n{args.out}/report.html")
    return 0
