"""tactcad release [DESIGN]... [--owner TEXT] [--contact TEXT] [--sample] [--sets one|all] [--out DIR]
[--keep|--discard] [--shop FILE] [--draft] [--json]
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict
from pathlib import Path

from .parser import add_design, add_others


def configure(parser: argparse.ArgumentParser) -> None:
    add_design(parser, several=True)
    parser.add_argument("-o", "--out", metavar="DIR", default="exports/releases")
    parser.add_argument("--owner", metavar="TEXT")
    parser.add_argument("--contact", metavar="TEXT")
    parser.add_argument("--sample", action="store_true")
    parser.add_argument("--sets", choices=("one", "all"), default="one")
    add_others(parser, "a zip there is not as tactcad wrote it", "NAME-kept-1.zip")
    parser.add_argument("--shop", metavar="FILE")
    parser.add_argument("--draft", action="store_true")
    parser.add_argument("--json", action="store_true")


def run(args: argparse.Namespace) -> int:
    from tactcad.checks.shop import DEFAULT, load_shop
    from tactcad.design.load import find
    from tactcad.design.messages import CheckFailure, InputError
    from tactcad.parts.rules import load
    from tactcad.release.make import Terms, looked_up, release
    from tactcad.release.release_contents import owned
    from tactcad.scenes import refuse_unknown_parts

    from .streams import progress

    shop = Path(args.shop) if args.shop else DEFAULT
    load_shop(shop)  # files that cannot be used are refused before any work
    designs = [
        (owned(load(source), args.owner, args.contact, args.sample), find(source)) for source in args.design
    ]
    terms = Terms(args.draft, args.sample, args.sets, args.others)
    known: dict[tuple[str, str], Path] = {}
    for design, path in designs:
        refuse_unknown_parts(design)
        looked_up(design, path, args.out, shop, terms)
        if (other := known.setdefault((design.name, design.design.revision), path)) is not path:
            what = f"has the name and revision of {other}, so one's zips would replace the other's"
            raise InputError(str(path), what, legal="another design.name, or releases one by one")
    say, records = progress(sys.stderr), []
    for design, path in designs:
        try:
            done = release(design, path, args.out, shop, say, terms)
        except CheckFailure as error:  # the other designs still have their turn
            print(f"tactcad: {error}", file=sys.stderr)
            reasons = getattr(error, "failures", (str(error),))
            records.append(
                {"design": design.name, "revision": design.design.revision, "path": None, "failures": reasons}
            )
            continue
        packages = [str(path) for path in done.packages]
        records.append({**asdict(done), "path": str(done.path), "packages": packages})
        if done.replaced:
            say.line(f"{done.path}: replaces an earlier one; other in {', '.join(done.replaced)}")
        if not args.json:
            print(f"{done.path}: {len(done.files)} files, read back and found right")
            for package in packages:
                print(package)
    if args.json:
        print(json.dumps(records[0] if len(records) == 1 else records, indent=1))
    return 0 if all(record["path"] for record in records) else 1
