"""tactcad export [DESIGN]... [--scene NAME]... [--strict] [--out DIR] [--within P] [--in SECONDS] [--json]"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any

from tactcad.design.allowance import pick
from tactcad.design.messages import CheckFailure, InputError

from .parser import add_allowance, add_design, add_others, allowance

if TYPE_CHECKING:
    from tactcad.export.pipeline import Progress


def configure(parser: argparse.ArgumentParser) -> None:
    add_design(parser, several=True)
    parser.add_argument("--scene", action="append", metavar="NAME")
    parser.add_argument("--pose", action="append", metavar="KEY=VALUE", default=[])
    parser.add_argument("--detail", choices=("full", "envelope"), default="full")
    parser.add_argument("--guide", action="store_true")
    parser.add_argument("--drawings", action="store_true")
    parser.add_argument("--robot", action="store_true")
    parser.add_argument("--measured", metavar="FILE")
    parser.add_argument("--strict", action="store_true")
    parser.add_argument("-o", "--out", metavar="DIR")
    add_others(parser)
    add_allowance(parser, "relative error of a part's meshed volume, written as stl/PART_REV.stl,", "mesh")
    parser.add_argument("--json", action="store_true")


def run(args: argparse.Namespace) -> int:
    from .streams import progress

    if args.out and len(args.design) > 1:
        raise InputError("--out", "names one folder for several designs", legal="one design, or no --out")
    say, status, records = progress(sys.stderr), 0, []
    for source in args.design:
        try:
            record, missing = _exported(source, args, say)
        except (InputError, CheckFailure) as error:  # the other designs still have their turn
            if len(args.design) == 1:
                raise
            print(f"tactcad: {error}", file=sys.stderr)
            record, missing, status = {"design": source, "failure": str(error)}, [], 1
        records.append(record)
        status = 1 if args.strict and missing else status
    if args.json:
        print(json.dumps(records[0] if len(records) == 1 else records, indent=1))
    return status


def _exported(source: str, args: argparse.Namespace, say: Progress) -> tuple[dict[str, Any], list[str]]:
    """Export one design; returns its report and the scenes left out."""
    from tactcad.design.files import refuse_overwriting
    from tactcad.design.load import find, read
    from tactcad.export.formats import ExportOptions
    from tactcad.export.pipeline import export
    from tactcad.parts.rules import broken_rules
    from tactcad.scenes import chosen_scenes, left_out, refuse_unknown_parts
    from tactcad.scenes.rig import pose_of

    asked = allowance(args)
    design, again = read(source), None
    if args.measured:
        from tactcad.design.family import family_of
        from tactcad.design.tree import Design
        from tactcad.lab.inspection_sheet import reissued
        from tactcad.parts.rules import refuse_broken

        if not isinstance(design, Design):
            family = family_of(design).name
            raise InputError("--measured", "does not take designs of this family", value=family)
        refuse_broken(design)
        again = reissued(design, args.measured)
        design = again.design
        refuse_broken(design)
        for line in again.lines:
            say.line(line)
    scenes = chosen_scenes(design, args.scene)
    if not args.scene and not broken_rules(design):
        refuse_unknown_parts(design)
    out = args.out or f"exports/{design.name}" + ("" if args.detail == "full" else f"-{args.detail}")
    refuse_overwriting(out, find(source), *([args.measured] if args.measured else []))
    options = ExportOptions(tuple(scenes), pose_of(args.pose, design), args.guide, args.detail, args.drawings)
    options = replace(options, robot=args.robot)
    picked = None
    if asked:
        from tactcad.costs.grades import VOLUME, export_grades, meshing_of
        from tactcad.parts.rules import refuse_broken

        refuse_broken(design)
        picked = pick(export_grades(design, scenes, args.drawings, args.guide), asked, VOLUME)
        options = replace(options, meshing=meshing_of(picked.grade))
    done = export(design, options, out, say, args.others)
    if design.design.unchanged and done.made:
        from tactcad.export.golden_file import doubts, golden_path

        golden = golden_path(find(source), design)
        if not args.scene or not (golden and golden.exists()):  # golden files hold all scenes
            for doubt in doubts(design, golden):
                say.line(f"warning: {doubt}")
    missing = [] if args.scene else [str(left) for left in left_out(design)]
    for line in missing:
        say.line(f"warning: {line}")
    if picked and not args.json:
        say.line(picked.text())
    record = {**asdict(done), "folder": str(done.folder), "left_out": missing}
    record |= {"measured": again.record} if again else {}
    return record | ({"budget": picked.record()} if picked else {}), missing
