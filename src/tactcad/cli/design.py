"""tactcad design TARGET.toml --out DIR [--best] [--within P] [--in SECONDS] [--json]"""

from __future__ import annotations

import argparse
import json
import sys

from tactcad.design.messages import InputError

from .parser import add_json

EXAMPLES = """\
  tactcad design hardware/targets/better-array.toml --out better
  tactcad design mine.toml --out mine --in 30   the search whole, of the report what 30 s allow
  tactcad design mine.toml --out mine --best    the best there is, even where the target is not met
  tactcad schema --target                       every field of a target file

DIR gets design.toml, which every rule accepts, report.html and report.json, and a design file for each
alternative. Exit status 1 where the target cannot be met: what it misses, and the least change of each single
field that would make it possible; nothing is written then but with --best."""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("target", metavar="TARGET.toml", help="what is to be felt, with which means")
    parser.add_argument(
        "--out", metavar="DIR", required=True, help="new or empty folder for design and report"
    )
    parser.add_argument(
        "--best", action="store_true", help="write the best there is where the target is not met, too"
    )
    parser.add_argument(
        "--within",
        type=float,
        default=0.1,
        metavar="P",
        help="percent of the half-width by which more search may still change the answer (default 0.1)",
    )
    parser.add_argument(
        "--in",
        dest="seconds",
        type=float,
        metavar="SECONDS",
        help="leave out of the report what is not done by then; the search itself is never cut short",
    )
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    from tactcad.synthesis import target_report as report
    from tactcad.synthesis.synthesise import design
    from tactcad.synthesis.target import read_target
    from tactcad.synthesis.target_answer import answer
    from tactcad.synthesis.write import refuse_unwritable, write

    from .progress import slow_work

    if not 1e-4 <= args.within <= 10:
        raise InputError("--within", "out of range", value=args.within, legal="0.0001 to 10 (%)")
    if args.seconds is not None and not 0 <= args.seconds <= 1e6:
        raise InputError("--in", "out of range", value=args.seconds, legal="0 to 1e6 (s)")
    target = read_target(args.target)
    refuse_unwritable(args.out)
    with slow_work(sys.stderr) as tell:
        got = design(target, within=args.within / 100, seconds=args.seconds, tell=tell)
    r = report.record(got)
    written = got.met or (args.best and got.found.accepted)
    if written:
        write(got, args.out)
    if args.json:
        print(json.dumps(r, indent=1))
    else:
        print(answer(r))
        _print(r)
        if written:
            print(f"{args.out}: written\nnext: tactcad check {args.out}/design.toml")
        elif args.best:
            print(f"{args.out}: not written: no candidate keeps every limit and rule, so none is the best")
    return 0 if got.met else 1


def _print(r: dict) -> None:
    from tactcad.synthesis.target_answer import no_other_change

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
        print(f"  {no_other_change(r)}")
    for note in r["notes"]:
        print(f"  note: {note}")


def _text(value: object) -> str:
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_text, value)) + "]"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
