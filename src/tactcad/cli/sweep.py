"""tactcad sweep STUDY.toml --out DIR [--scheduler ADDRESS] [--workers N] [--within P] [--in SECONDS] [--csv]
[--json]; sweep plot DIR"""

from __future__ import annotations

import argparse
import json
import sys
from typing import TYPE_CHECKING

from tactcad.design.messages import CheckFailure, InputError, refuse_missing

from .parser import add_allowance, allowance

if TYPE_CHECKING:
    from tactcad.design.allowance import Picked
    from tactcad.sweep.run_sweep import Swept
    from tactcad.sweep.study import Study


MOST_WORKERS = 1000


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("study", nargs="+", metavar="STUDY.toml")
    parser.add_argument("-o", "--out", metavar="DIR")
    parser.add_argument("--scheduler", metavar="ADDRESS")
    parser.add_argument("--store", metavar="ADDRESS")
    parser.add_argument("--workers", type=int, metavar="N")
    parser.add_argument("--csv", action="store_true")
    add_allowance(
        parser,
        "error of K, and half-width of the yield's 95 % interval if the study has builds,",
        "rung and number of arrays",
    )
    parser.add_argument("--json", action="store_true")


def run(args: argparse.Namespace) -> int:
    if args.study[0] == "plot":
        from tactcad.sweep.study_page import write_page

        if len(args.study) != 2:
            raise InputError("plot", "takes one folder", legal="tactcad sweep plot DIR")
        for name in ("out", "scheduler", "store", "workers", "csv", "within", "seconds", "json"):
            if given := getattr(args, name):
                option = "--in" if name == "seconds" else f"--{name}"
                raise InputError(option, "belongs to a study, not to its plot", value=given, legal="left out")
        print(f"{write_page(args.study[1])}: written")
        return 0
    return _sweep(args)


def _sweep(args: argparse.Namespace) -> int:
    from tactcad.sweep.on_dask import cores
    from tactcad.sweep.run_sweep import sweep
    from tactcad.sweep.study import CHECKS, EXPORT, read_study

    from .streams import progress, slow_work

    if len(args.study) > 1:
        raise InputError("STUDY.toml", "more than one", value=args.study[1], legal="one study, or plot DIR")
    if args.out is None:
        raise InputError("--out", "missing", legal="a folder for this study")
    if args.workers is not None and not 1 <= args.workers <= MOST_WORKERS:
        raise InputError("--workers", "out of range", value=args.workers, legal=f"1 to {MOST_WORKERS}")
    if args.workers is not None and args.scheduler is not None:
        raise InputError("--workers", "are the scheduler's own", value=args.workers, legal="left out")
    if args.store is not None and args.store.startswith("memory:"):
        legal = "a folder, or an address such as s3://bucket/path"
        raise InputError(
            "--store", "the memory of a process, and workers are others", value=args.store, legal=legal
        )
    asked = allowance(args)
    if asked.seconds is not None and args.scheduler is not None:
        raise InputError("--in", "a cluster's time is not known here", value=args.seconds, legal="--within")
    study = read_study(args.study[0])
    if solid := [name for name in (CHECKS, EXPORT) if name in study.measure.what]:
        refuse_missing(f"measure.what, {solid[0]}", "cad")
    workers = args.workers or cores()
    picked = None
    if asked:
        from tactcad.sweep.study_grades import with_allowance

        study, picked = with_allowance(study, asked, workers)
    say = progress(sys.stderr).line
    with slow_work(sys.stderr) as tell:
        got = sweep(study, args.out, args.scheduler, workers, args.csv, say, tell, args.store)
    if args.json:
        budget = {"budget": picked.record()} if picked else {}
        print(json.dumps(_record(study, got) | budget, indent=1))
    else:
        _print(study, got, picked)
    if got.tally.refused == got.tally.rows:
        why, count = got.tally.reasons.most_common(1)[0]
        raise CheckFailure(f"{study.study.name}: every design is refused ({count} of them: {why})")
    return 0


def _record(study: Study, got: Swept) -> dict:
    return {
        "study": study.study.name,
        "designs": got.tally.rows,
        "measured": got.tally.rows - got.tally.refused,
        "refused": got.tally.refused,
        "reasons": dict(got.tally.reasons.most_common()),
        "computed": got.computed,
        "kept": got.kept,
        "seconds": got.seconds,
        "in_workers": round(got.in_workers, 3),
        "folder": str(got.folder),
        "files": list(got.files),
    }


def _print(study: Study, got: Swept, picked: Picked | None) -> None:
    tally = got.tally
    refused = f", {tally.refused} refused" if tally.refused else ""
    print(f"{study.study.name}: {tally.rows} designs{refused}; {got.computed} computed now, {got.kept} kept")
    for why, count in tally.reasons.most_common(5):
        print(f"  {count} refused: {why}")
    print("  " + ", ".join(f"{name} {seconds:.1f} s" for name, seconds in got.seconds.items()))
    print(f"{got.folder}: {', '.join(got.files)}")
    if picked:
        print(picked.text())
