"""tactcad schema [--target | --study] [--json]"""

from __future__ import annotations

import argparse
import json

EXAMPLES = """\
  tactcad schema              every field of a design file, table by table
  tactcad schema --target     every field of a target file
  tactcad schema --study      every field of a study file
  tactcad schema --json       the same as JSON Schema, for editors that check TOML"""


def configure(parser: argparse.ArgumentParser) -> None:
    other = parser.add_mutually_exclusive_group()
    other.add_argument("--target", action="store_true", help="of a target file, which `tactcad design` takes")
    other.add_argument("--study", action="store_true", help="of a study file, which `tactcad sweep` takes")
    parser.add_argument("--json", action="store_true", help="print JSON Schema")


def run(args: argparse.Namespace) -> int:
    from tactcad.design.schema import json_schema, text_schema

    if args.target:
        from tactcad.synthesis.target import target_schema, target_text

        print(json.dumps(target_schema(), indent=1) if args.json else target_text())
        return 0
    if args.study:
        from tactcad.sweep.study import study_schema, study_text

        print(json.dumps(study_schema(), indent=1) if args.json else study_text())
        return 0
    print(json.dumps(json_schema(), indent=1) if args.json else text_schema())
    return 0
