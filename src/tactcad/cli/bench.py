"""tactcad bench [--full | --smoke] [--only NAME]... [--seed N] [--out DIR] [--json]"""

from __future__ import annotations

import argparse
import sys
from contextlib import nullcontext

from .parser import add_json, add_others

EXAMPLES = """\
  tactcad bench                              everything in short: four minutes on two quiet cores
  tactcad bench --full --out bench           for publication: report.json, report.md, tables/, plots/
  tactcad bench --only rungs --only meshes   two of them
  tactcad bench --smoke                      does everything run? its figures mean nothing

What is compared is measured in turns, in one run. CalculiX and FreeCAD are measured beside it where they are
installed, and reported as missing where not. The folder is replaced in one step by a finished one."""

SHORT_SEED = 8  # any; a full run draws its own unless it is given one


def configure(parser: argparse.ArgumentParser) -> None:
    mode = parser.add_mutually_exclusive_group()
    mode.add_argument(
        "--full", action="store_true", help="converged elements computed anew, all sizes, more repeats"
    )
    mode.add_argument("--smoke", action="store_true", help="the least of everything, once")
    parser.add_argument(
        "--only", action="append", metavar="NAME", help="this benchmark; may be repeated (default: all)"
    )
    parser.add_argument(
        "--seed", type=int, metavar="N", help="seed of the random designs and pairs (full: a new one)"
    )
    parser.add_argument("--out", metavar="DIR", help="write the report into this folder")
    add_others(parser)
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    import os

    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):  # before numpy: one thread, as every child
        os.environ[variable] = "1"
    from tactcad.bench import render, truth
    from tactcad.bench.run_plan import Mode, RunPlan
    from tactcad.bench.session import SCHEMA
    from tactcad.bench.session import run as measure
    from tactcad.design.files import scratch_folder
    from tactcad.export.publication import turn

    from .progress import progress

    names = _names(args.only)
    say = progress(sys.stderr)
    mode: Mode = "full" if args.full else "smoke" if args.smoke else "short"
    seed = _seed(args.seed, args.full)
    with turn(args.out, SCHEMA, args.others, say.line) if args.out else nullcontext() as work:
        with scratch_folder("bench") as scratch:
            plan = RunPlan(mode, seed, scratch)
            say.line(f"{mode} run, seed {plan.seed}")
            result = measure(plan, names, say.step)
            files = render.files(result)
            if (plan.folder / truth.SHIPPED).is_file():
                files[truth.SHIPPED] = (plan.folder / truth.SHIPPED).read_bytes()
        if work:
            work.write(files)
    print(render.to_json(result) if args.json else render.to_text(result))
    return 1 if any("failed" in entry for entry in result["benchmarks"].values()) else 0


def _names(only: list[str] | None) -> list[str]:
    from tactcad.bench.session import BENCHMARKS
    from tactcad.design.messages import InputError, one_of

    for name in only or ():
        if name not in BENCHMARKS:
            raise InputError("--only", "no such benchmark", value=name, legal=one_of(name, BENCHMARKS))
    return [name for name in BENCHMARKS if not only or name in only]


def _seed(given: int | None, full: bool) -> int:
    import secrets

    from tactcad.design.messages import InputError

    if given is not None and not 0 <= given < 2**32:
        raise InputError("--seed", "not a seed", value=given, legal="a whole number from 0 to 2^32 - 1")
    if given is not None:
        return given
    return secrets.randbelow(2**31) if full else SHORT_SEED
