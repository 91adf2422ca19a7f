"""tactcad new FILE [--from DESIGN]"""

from __future__ import annotations

import argparse


def configure(parser: argparse.ArgumentParser) -> None:
    from tactcad.design.load import DEFAULT_DESIGN

    parser.add_argument("file", metavar="FILE")
    parser.add_argument(
        "--from",
        dest="source",
        default=DEFAULT_DESIGN,
        metavar="DESIGN",
        help=f"what to start from: a path, or a name in hardware/ (default {DEFAULT_DESIGN})",
    )


def run(args: argparse.Namespace) -> int:
    from datetime import date
    from pathlib import Path

    from tactcad.design.design_text import name_of, started
    from tactcad.design.files import write_whole
    from tactcad.design.load import parse
    from tactcad.parts.rules import refuse_broken

    path = Path(args.file)
    name = name_of(path)
    text = started(args.source, name, date.today())
    refuse_broken(parse(text, args.source))
    write_whole(path, text.encode())
    print(f"{args.file}: written, from {args.source}\nnext: tactcad estimate {args.file}")
    return 0
