"""`tactcad fit`: the ladder's constants and every rung's worst errors from finite elements, with their
report."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable
from datetime import UTC, date, datetime
from pathlib import Path

from tactcad.design.messages import InputError
from tactcad.design.plain_numbers import as_whole

EXAMPLES = """\
  tactcad fit --out fit                      # samples, constants and report, about half an hour on one core
  tactcad fit --out fit --solids 40 --samples 60 --held-out 20 --held-out-solids 5
  tactcad fit --out fit --reuse              # constants again from the samples that lie in fit/
  tactcad fit --out fit --shipped-samples    # the shipped constants again from the shipped samples
"""

# more data than constants, and some in every zone of the accuracy's envelope
LEAST = {"samples": 60, "solids": 40, "held_out": 10, "held_out_solids": 5, "range": 240, "corners": 40}


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for samples and ladder.json")
    parser.add_argument(
        "--samples",
        type=int,
        default=1200,
        help="designs that are fitted, and a third more on the box's edges (default 1200)",
    )
    parser.add_argument(
        "--solids",
        type=int,
        default=400,
        help="of them with solid elements too, and a fifth more on the edges (default 400)",
    )
    parser.add_argument(
        "--held-out",
        type=int,
        default=300,
        help="designs kept out of the fit, and a third more (default 300)",
    )
    parser.add_argument(
        "--held-out-solids",
        type=int,
        default=120,
        help="of them with solid elements, and a fifth more (default 120)",
    )
    parser.add_argument(
        "--range",
        type=int,
        default=240,
        help="designs over the whole range, on which worst errors are measured (default 240)",
    )
    parser.add_argument(
        "--corners",
        type=int,
        default=240,
        help="of each draw in the corners of the range so many designs at most (default 240, all)",
    )
    source = parser.add_mutually_exclusive_group()
    source.add_argument("--reuse", action="store_true", help="take the samples that lie in DIR")
    source.add_argument(
        "--shipped-samples", action="store_true", help="take the samples that come with the program"
    )


def run(args: argparse.Namespace) -> int:
    from tactcad.design.files import make_folder, refuse_overwriting, write_whole
    from tactcad.fit import fit_samples
    from tactcad.fit.accuracy_table import accuracy_table
    from tactcad.fit.fit import fit

    for option, least in LEAST.items():
        if getattr(args, option) < least:
            name = f"--{option.replace('_', '-')}"
            raise InputError(name, "too few", value=getattr(args, option), legal=f"at least {least}")
    out = Path(args.out)
    make_folder(out)
    results = [out / name for name in ("ladder.json", "accuracy.json")]
    if args.shipped_samples:
        tables = fit_samples.shipped()
    elif args.reuse:
        missing = [str(out / name) for name in fit_samples.FILES.values() if not (out / name).is_file()]
        if missing:
            raise InputError("--reuse", f"{missing[0]} is not there")
        for path in results:
            refuse_overwriting(path, *(out / name for name in fit_samples.FILES.values()))
        tables = {kind: fit_samples.load(out / name) for kind, name in fit_samples.FILES.items()}
    else:
        tables = _sample(args, out)
    result = fit(tables, _today())
    accuracy = accuracy_table(tables, result, _today())
    for path, document in zip(results, (result, accuracy)):
        write_whole(path, (json.dumps(document, indent=1) + "\n").encode())
    for side, errors in result["report"]["relative_error"]["held out, box"].items():
        rungs = ("plane, against plane elements", "solid, against solid elements")
        worst = {name: errors[name]["max"] for name in rungs}
        print(
            f"{side}-sided, held out: "
            + "; ".join(f"{name}: max {100 * e:.2f} %" for name, e in worst.items())
        )
    print(f"{results[0]} and {results[1]} written")
    return 0


def _sample(args: argparse.Namespace, out: Path) -> dict:
    from tactcad.fit import fit_samples
    from tactcad.fit.accuracy_samples import compute_range, draw_range, draw_refined, meshes_of
    from tactcad.fit.corner_samples import DRAWS, compute_all

    def reporting(kind: str) -> Callable[[str], None]:
        return lambda line: print(f"{kind}: {line}", file=sys.stderr, flush=True)

    plan = {"fitted": (args.samples, args.solids), "held out": (args.held_out, args.held_out_solids)}

    for kind, (count, solids) in plan.items():
        inside, edges = fit_samples.designs(kind, count)
        tables = [
            fit_samples.compute(inside, solids, reporting(kind)),
            fit_samples.compute(edges, solids // 5, reporting(kind)),
        ]
        fit_samples.write(fit_samples.joined(tables), out / fit_samples.FILES[kind])
    whole = compute_range(draw_range(args.range), reporting("range"), meshes_of)
    refined = compute_range(draw_refined(), reporting("range"), lambda i: (2, 3, 4))
    fit_samples.write(fit_samples.joined([whole, refined]), out / fit_samples.FILES["range"])
    for kind in DRAWS:
        fit_samples.write(compute_all(kind, args.corners, reporting(kind)), out / fit_samples.FILES[kind])
    # read back: the fit sees the digits that the files hold
    return {kind: fit_samples.load(out / name) for kind, name in fit_samples.FILES.items()}


def _today() -> date:
    """The date of the report; SOURCE_DATE_EPOCH, where set, keeps it. Raises InputError where that is no
    time."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    try:
        return datetime.fromtimestamp(as_whole(epoch), UTC).date() if epoch else date.today()
    except (ValueError, OverflowError, OSError):
        raise InputError(
            "SOURCE_DATE_EPOCH", "no time", value=epoch, legal="seconds since 1970, digits only"
        ) from None
