"""tactcad build [DESIGN] [--count N] [--within P] [--in SECONDS] [--seed S] [--json]"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict
from math import isfinite
from typing import TYPE_CHECKING

from tactcad.design.allowance import pick
from tactcad.design.messages import InputError

from .parser import add_allowance, add_design, allowance, refuse_named

if TYPE_CHECKING:
    from tactcad.parts.array.layout import Layout
    from tactcad.stacks.stack import StackLine
    from tactcad.stacks.virtual_build import Builds


USUAL, MOST = 1000, 1_000_000


def configure(parser: argparse.ArgumentParser) -> None:
    add_design(parser)
    parser.add_argument(
        "--count", type=int, metavar="N", help=f"arrays of each distribution (default: {USUAL})"
    )
    add_allowance(parser, "half-width of the yield's 95 % interval", "number of arrays")
    parser.add_argument("--seed", type=int, metavar="S")
    parser.add_argument("--json", action="store_true")


def run(args: argparse.Namespace) -> int:
    from tactcad.parts.rules import load
    from tactcad.stacks.stack import SEED
    from tactcad.stacks.virtual_build import sensor

    asked = allowance(args)
    refuse_named(asked, "--count", args.count)
    count = USUAL if args.count is None else args.count
    if not 1 <= count <= MOST:
        raise InputError("--count", "out of range", value=count, legal=f"1 to {MOST}")
    if args.seed is not None and args.seed < 0:
        raise InputError("--seed", "out of range", value=args.seed, legal="0 or more")
    started = time.perf_counter()
    design, picked = load(args.design), None
    if asked:
        from tactcad.costs.grades import YIELD, arrays_of, build_grades

        picked = pick(build_grades(design), asked, YIELD)
        count = arrays_of(picked.grade)
    made = sensor(design)
    builds = made.built(count, SEED if args.seed is None else args.seed)
    seconds = time.perf_counter() - started
    lines = made.stack()
    refusal = made.refusal(builds)
    if args.json:
        record = _record(builds, lines, seconds, refusal)
        record |= {"budget": picked.record()} if picked else {}
        print(json.dumps(record, indent=1, allow_nan=False))
    else:
        _print(made.layout, builds, lines)
        if picked:
            print(picked.text())
    if refusal:
        print(f"tactcad: {made.layout.design.name}: {refusal}", file=sys.stderr)
    return 1 if refusal else 0


def _record(builds: Builds, lines: list[StackLine], seconds: float, refusal: str) -> dict:
    """`assembled` and `failures` under the worse of normal and uniform parts; the rest by distribution."""
    return {
        "count": builds.count,
        "seed": builds.seed,
        "assembled": round(builds.share * builds.count),
        "yield": builds.share,
        "yield_interval": list(builds.interval),
        "distribution": builds.worse,
        "failures": builds.failures[builds.worse],
        "stiffness_within_10_percent": builds.near,
        "distributions": {
            name: {"yield": builds.kept[name], "failures": builds.failures[name]} for name in builds.kept
        },
        "requirements": [
            {
                "name": line.requirement.name,
                "unit": line.requirement.unit,
                "nominal": line.nominal,
                "worst_low": line.worst_low,
                "worst_high": line.worst_high,
                "sigma": line.sigma,
                "yield": line.kept,
                "contributors": [asdict(c) for c in line.contributors],
            }
            for line in lines
        ],
        "elements": [e.known() for e in builds.elements],
        "refused": refusal,
        "seconds": seconds,
    }


def _print(layout: Layout, builds: Builds, lines: list[StackLine]) -> None:
    from tactcad.stacks.virtual_build import NEAR

    print(f"{layout.design.name}: {builds.count} arrays of each distribution, seed {builds.seed}")
    for which, share in builds.kept.items():
        failed = sorted(builds.failures[which].items(), key=lambda item: -item[1])
        why = "; ".join(f"{n} miss: {requirement}" for requirement, n in failed)
        print(f"  {which:8} {100 * share:6.2f} % meet all requirements{f' ({why})' if why else ''}")
    low, high = builds.interval
    print(f"  yield    {100 * builds.share:6.2f} % ({100 * low:.4g} to {100 * high:.4g} %)")
    if builds.near is not None:
        print(f"  K        {100 * builds.near:6.2f} % have every K within {100 * NEAR:g} % of the drawn one")
    told = (line.requirement for line in lines)
    named = {r.name: f"{r.name} ({r.unit})" if r.unit else r.name for r in told}
    wide = max(map(len, named.values()), default=0)
    print(f"  {'requirement':{wide}} {'nominal':>9} {'worst case':>21} {'sigma':>8}  largest contributor")
    for line in lines:
        top = line.contributors[0] if line.contributors else None
        who = f"{top.name}, {100 * top.share:.0f} %" if top else ""
        worst = f"{line.worst_low:.4g} to {line.worst_high:.4g}"
        r = named[line.requirement.name]
        print(f"  {r:{wide}} {line.nominal:9.4g} {worst:>21} {line.sigma:8.2g}  {who}")
    if builds.elements:
        print("  element  K, N/mm         load arm, mm    stop gap, mm    closes at least at, N")
    for e in builds.elements:
        known = isfinite(e.stiffness[0])
        K = f"{e.stiffness[0]:6.2f} +-{e.stiffness[1]:5.2f}" if known else f"{'none':15}"
        closes = f"{e.stop_closes_at_least:.3g}" if known else "not known"
        print(
            f"  E{e.number:<6}  {K}  {e.load_arm[0]:6.3f} +-{e.load_arm[1]:.3f}  {e.stop_gap[0]:6.3f} "
            f"+-{e.stop_gap[1]:.3f}  {closes}"
        )
    for reason in _reasons(layout, builds):
        print(f"  {reason}")


def _reasons(layout: Layout, builds: Builds) -> Iterator[str]:
    """Why elements have no stiffness: as drawn, or in one of the arrays built."""
    from tactcad.mechanics import ladder
    from tactcad.parts.array.hinge_section import hinge_section, not_reached

    for place, e in zip(layout.elements if builds.elements else (), builds.elements, strict=True):
        if not isfinite(e.stiffness[0]):
            drawn = not_reached(layout, (place,), hinge_section(layout, (place,)), ladder.DEFAULT_RUNG)
            near = f"rung {ladder.DEFAULT_RUNG} does not reach element {place.number} with its tolerances"
            yield f"E{place.number} has no stiffness: {drawn or near}"
