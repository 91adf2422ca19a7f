"""tactcad schema [TABLE | target | study] [--json]"""

from __future__ import annotations

import argparse
import json

from .parser import BY_NAME, UNLISTED


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("table", nargs="?", metavar="TABLE")
    for other in ("target", "study"):
        parser.add_argument(
            f"--{other}", action="store_const", const=other, dest=f"table{BY_NAME}", help=UNLISTED
        )
    parser.add_argument("--json", action="store_true")


def run(args: argparse.Namespace) -> int:
    from tactcad.design.schema import json_schema, text_schema

    if args.table == "target":
        from tactcad.synthesis.target import target_schema, target_text

        print(json.dumps(target_schema(), indent=1) if args.json else target_text())
    elif args.table == "study":
        from tactcad.sweep.study import study_schema, study_text

        print(json.dumps(study_schema(), indent=1) if args.json else study_text())
    else:
        print(json.dumps(json_schema(args.table), indent=1) if args.json else text_schema(args.table))
    return 0
