"""tactcad design TARGET.toml --out DIR [--best] [--within P] [--in SECONDS] [--json]"""

from __future__ import annotations

import argparse
import json
import sys
import time
from typing import TYPE_CHECKING

from tactcad.design.allowance import Allowance, pick

from .parser import add_allowance, allowance

if TYPE_CHECKING:
    from tactcad.synthesis.synthesise import Synthesis


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("target", metavar="TARGET.toml")
    parser.add_argument("-o", "--out", metavar="DIR", required=True)
    parser.add_argument("--best", action="store_true")
    add_allowance(parser, "half-width of the yield's 95 % interval", "number of arrays")
    parser.add_argument("--json", action="store_true")


def run(args: argparse.Namespace) -> int:
    from tactcad.costs.grades import YIELD, arrays_of, yield_grades
    from tactcad.design.family import all_families, family_of
    from tactcad.design.files import read_text
    from tactcad.design.load import MOST_BYTES
    from tactcad.design.text_values import parse_toml
    from tactcad.synthesis import target_report as report
    from tactcad.synthesis.synthesise import ARRAYS
    from tactcad.synthesis.target import read_target

    from .streams import slow_work

    started = time.perf_counter()
    asked = allowance(args)
    picked = pick(yield_grades(), Allowance(asked.within), YIELD) if asked.within else None
    count = arrays_of(picked.grade) if picked else ARRAYS
    tables = parse_toml(read_text(args.target, MOST_BYTES, "a target file (TOML)"), args.target)
    for family in all_families().values():
        if family.targets and family.name in tables:
            status = int(
                family.targets.design(args, asked.seconds, picked and count, lambda: _next(args.out))
            )
            if picked and not args.json:
                print(picked.text())
            return status
    target = read_target(args.target)
    report.refuse_unwritable(args.out)
    writing = 0.0

    def is_written(got: Synthesis) -> bool:
        return got.met or (args.best and got.found.accepted)

    def answered(got: Synthesis) -> None:
        """Print the answer as soon as it is known; the rest of the report follows."""
        nonlocal writing
        before = time.perf_counter()
        if is_written(got):
            report.write(got, args.out)
        if not args.json:
            r = report.record(got)
            print(report.answer(r))
            for bound in r["bounds"]:
                print(f"  {report.bound_line(bound)}")
            for field, by in r["room"].items() if got.met else ():
                print(f"  {field}: {by}")
            if is_written(got):
                print(f"{args.out}: written; limits and alternatives follow", flush=True)
        writing = time.perf_counter() - before

    with slow_work(sys.stderr) as tell:
        design = family_of(target.base).must("variables", "target.base")
        seconds = asked.seconds and asked.seconds - (time.perf_counter() - started)
        got = design(
            target, arrays=count, seconds=seconds, tell=tell, answered=answered, ending=lambda: writing
        )
        if is_written(got):
            report.complete(got, args.out)
    took = time.perf_counter() - started
    if args.json:
        budget = {"in_s": asked.seconds, "took_s": round(took, 1)} if asked.seconds else {}
        budget |= picked.record() if picked else {}
        print(json.dumps(report.record(got) | ({"budget": budget} if budget else {}), indent=1))
    else:
        _print(got, report.record(got))
        if picked:
            print(picked.text())
        if is_written(got):
            print(f"{args.out}: written\nnext: {_next(args.out)}")
        elif args.best:
            print(f"{args.out}: not written: no candidate keeps every limit and rule, so none is the best")
    return 0 if got.met else 1


def _next(out: str) -> str:
    """The command that can run here on the design."""
    from tactcad.design.messages import missing

    if not missing("cad"):
        return f"tactcad check {out}/design.toml"
    return (
        f"tactcad estimate {out}/design.toml (`tactcad check` needs the CAD kernel, which is not installed)"
    )


def _print(got: Synthesis, r: dict) -> None:
    from tactcad.synthesis.target_report import limit_line, no_other_change, said

    for limit in r["binding"][:5]:
        print(f"  {limit_line(limit)}")
    for change in r["changes"]:
        print(
            f"  possible with {change['field']} {said(change['needed'])} instead of {said(change['value'])}"
        )
    if not got.met:
        print(f"  {no_other_change(got)}")
    elif r["left_out"]:
        print(f"  left out of the report for time: {', '.join(r['left_out'])}")
    for note in r["notes"]:
        print(f"  note: {note}")
