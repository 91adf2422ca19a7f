"""tactcad check [DESIGN] [--scene NAME]... [--shop FILE] [--json]"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict
from pathlib import Path

EXAMPLES = """\
  tactcad check                           every check of hardware/macro-array.toml
  tactcad check soft-tissue --json        findings, runs and times as JSON
  tactcad check --shop my-shop.toml       with your own shop's limits for wire cutting

Exit status 1 where anything fails; what is only flagged (such as the hinge, for the quotation) is listed."""


def configure(parser: argparse.ArgumentParser) -> None:
    from tactcad.design.load import DEFAULT_DESIGN

    parser.add_argument(
        "design", nargs="?", default=DEFAULT_DESIGN, metavar="DESIGN",
        help=f"a path, or a name in hardware/ (default {DEFAULT_DESIGN})",
    )
    parser.add_argument("--scene", action="append", metavar="NAME", help="check this scene; may be repeated (default: all)")
    parser.add_argument("--shop", metavar="FILE", help="your shop's limits (default: the ones that come with tactcad)")
    parser.add_argument("--json", action="store_true", help="report on standard output as JSON")


def run(args: argparse.Namespace) -> int:
    from tactcad.checks.shop import DEFAULT, load_shop
    from tactcad.parts.designs import load
    from tactcad.scenes import chosen_scenes

    from .progress import progress

    design = load(args.design)
    names = chosen_scenes(design, args.scene)
    shop = Path(args.shop) if args.shop else DEFAULT
    load_shop(shop)  # a shop file that cannot be used is refused before the kernel is waited for

    from tactcad.checks.run import run_checks

    report = run_checks(design, names, shop, progress(sys.stderr).step)
    failed = report.failures
    if args.json:
        record = {
            "design": design.name,
            "revision": design.design.revision,
            "passed": not failed,
            "findings": [asdict(f) for f in report.findings],
            "runs": report.runs,
            "seconds": {name: round(s, 4) for name, s in report.seconds.items()},
        }
        print(json.dumps(record, indent=1))
    else:
        _print(design.name, report)
    if failed:
        print(f"tactcad: {design.name}: {len(failed)} of the checks failed", file=sys.stderr)
    return 1 if failed else 0


def _print(name: str, report) -> None:
    print(f"{name}")
    for check, runs in report.runs.items():
        print(f"  {check:14} {runs:5} runs {report.seconds[check]:8.2f} s")
    for finding in report.findings:
        print(f"  {finding}")
    flags = len(report.findings) - len(report.failures)
    print(f"  {len(report.failures)} failed, {flags} flagged")
