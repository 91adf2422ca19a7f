"""tactcad design TARGET.toml --out DIR [--best] [--within P] [--in SECONDS] [--json]"""

from __future__ import annotations

import argparse
import json
import sys
from typing import TYPE_CHECKING

from tactcad.design.allowance import Allowance, Picked, pick
from tactcad.design.messages import CheckFailure

from .parser import add_allowance, add_json, allowance

if TYPE_CHECKING:
    from tactcad.synthesis.synthesise import Synthesis
    from tactcad.synthesis.target import Target

EXAMPLES = """\
  tactcad design hardware/targets/better-array.toml --out better
  tactcad design mine.toml --out mine --within 0.5%    the yield's 95 % interval plus and minus 0.5 % at most
  tactcad design mine.toml --out mine --in 60   as many arrays as 60 s allow
  tactcad design mine.toml --out mine --best    the best there is, even where the target is not met
  tactcad schema --target                       every field of a target file

DIR gets design.toml, which every rule accepts, report.html and report.json, and a design file for each
alternative. The search is never cut short for time. Exit status 1 where the target cannot be met: what it
misses, and the least change of each single field that would make it possible; nothing is written then but
with --best."""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("target", metavar="TARGET.toml", help="what is to be felt, with which means")
    parser.add_argument(
        "-o", "--out", metavar="DIR", required=True, help="new or empty folder for design and report"
    )
    parser.add_argument(
        "--best", action="store_true", help="write the best there is where the target is not met, too"
    )
    add_allowance(parser, "half-width of the yield's 95 % interval", "number of arrays")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    from tactcad.costs.grades import arrays_of
    from tactcad.design.family import family_of
    from tactcad.synthesis import target_report as report
    from tactcad.synthesis.synthesise import ARRAYS
    from tactcad.synthesis.target import read_target
    from tactcad.synthesis.target_report import answer, refuse_unwritable, write

    from .streams import slow_work

    asked = allowance(args)
    target = read_target(args.target)
    refuse_unwritable(args.out)
    picked = _picked(target, asked) if asked else None
    count = arrays_of(picked.grade) if picked else ARRAYS
    with slow_work(sys.stderr) as tell:
        design = family_of(target.base).must("variables", "target.base")
        got = design(target, arrays=count, seconds=asked.seconds, tell=tell)
    r = report.record(got)
    written = got.met or (args.best and got.found.accepted)
    if written:
        write(got, args.out)
    if args.json:
        print(json.dumps(r | ({"budget": picked.record()} if picked else {}), indent=1))
    else:
        print(answer(r))
        _print(got, r)
        if picked:
            print(picked.text())
        if written:
            print(f"{args.out}: written\nnext: {_next(args.out)}")
        elif args.best:
            print(f"{args.out}: not written: no candidate keeps every limit and rule, so none is the best")
    return 0 if got.met else 1


def _next(out: str) -> str:
    """The command that can run here on the design."""
    from tactcad.design.extras import missing

    if not missing("cad"):
        return f"tactcad check {out}/design.toml"
    return (
        f"tactcad estimate {out}/design.toml (`tactcad check` needs the CAD kernel, which is not installed)"
    )


def _picked(target: Target, asked: Allowance) -> Picked:
    """With the whole report in the time, or else with what of it the search and the yield leave."""
    from tactcad.costs.grades import YIELD, synthesis_grades
    from tactcad.synthesis.synthesise import work_ahead

    try:
        return pick(synthesis_grades(work_ahead(target, True)), asked, YIELD)
    except CheckFailure:
        return pick(synthesis_grades(work_ahead(target, False)), asked, YIELD)


def _print(got: Synthesis, r: dict) -> None:
    from tactcad.synthesis.target_report import no_other_change

    for limit in r["binding"][:5]:
        print(
            f"  {limit['field']}: {_text(limit['value'])} eased to {_text(limit['eased'])}: half-width "
            f"{100 * limit['half_width']:.3g} % ({-100 * limit['gain']:.2g} %)"
        )
    for change in r["changes"]:
        print(
            f"  possible with {change['field']} {_text(change['needed'])} instead of {_text(change['value'])}"
        )
    if not r["met"]:
        print(f"  {no_other_change(got)}")
    elif r["left_out"]:
        print(f"  left out of the report for time: {', '.join(r['left_out'])}")
    for note in r["notes"]:
        print(f"  note: {note}")


def _text(value: object) -> str:
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_text, value)) + "]"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
