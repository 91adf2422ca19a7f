"""tactcad release [DESIGN]... [--out DIR] [--shop FILE] [--draft] [--json]"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict
from pathlib import Path

from .parser import add_design, add_json, add_shop

EXAMPLES = """\
  tactcad release                     exports/releases/macro-array-<revision>.zip
  tactcad release soft-tissue --out to-the-shop
  tactcad release --shop my-shop.toml with your own shop's limits for wire cutting
  tactcad release --draft             although a check fails: PRELIMINARY on sheets, in README and file name

One zip that a shop can quote from: README, cut files, solids, drawing sheets, bills of materials, inspection
sheet, strength summary, checksums. Every check runs first, and the golden file is compared; where one fails
nothing is written and an earlier zip stays as it is."""


def configure(parser: argparse.ArgumentParser) -> None:
    add_design(parser, several=True)
    parser.add_argument(
        "--out",
        metavar="DIR",
        default="exports/releases",
        help="folder of the zip (default exports/releases)",
    )
    add_shop(parser)
    parser.add_argument(
        "--draft", action="store_true", help="write a PRELIMINARY zip whatever the checks say"
    )
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    from tactcad.checks.shop import DEFAULT, load_shop
    from tactcad.design.load import find
    from tactcad.design.messages import CheckFailure
    from tactcad.parts.designs import load
    from tactcad.release.make import release

    from .progress import progress

    shop = Path(args.shop) if args.shop else DEFAULT
    load_shop(shop)  # files that cannot be used are refused before any work
    designs = [(load(source), find(source)) for source in args.design]
    say, records = progress(sys.stderr), []
    for design, path in designs:
        try:
            done = release(design, path, args.out, shop, say, args.draft)
        except CheckFailure as error:  # the other designs still have their turn
            print(f"tactcad: {error}", file=sys.stderr)
            reasons = getattr(error, "failures", (str(error),))
            records.append(
                {"design": design.name, "revision": design.design.revision, "path": None, "failures": reasons}
            )
            continue
        records.append({**asdict(done), "path": str(done.path)})
        if done.replaced:
            say.line(f"{done.path}: replaces an earlier one; other in {', '.join(done.replaced)}")
        if not args.json:
            print(f"{done.path}: {len(done.files)} files, read back and found right")
    if args.json:
        print(json.dumps(records[0] if len(records) == 1 else records, indent=1))
    return 0 if all(record["path"] for record in records) else 1
