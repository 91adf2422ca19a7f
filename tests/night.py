"""Designs drawn by chance, checks broken one at a time, commands killed: as a sweep, kept as they end.

    python tests/night.py exports/night                        all of it, some hours
    python tests/night.py exports/night --kinds design --designs 50
    python tests/night.py exports/night --publish              counts to docs/tried.md, too

Stopped, it goes on where it was when it is started again. When it has ended, or the source is another, the
next run is another night: designs of another seed, which TACTCAD_SEED names. Prints what failed, and counts;
ends with status 1 where anything failed.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import sys
from datetime import date
from pathlib import Path
from random import SystemRandom

sys.path.insert(0, str(Path(__file__).parent / "mutation"))

import mutants  # noqa: E402
from night_items import KILLS, ROOT, Item, Night  # noqa: E402
from random_designs import Counts, Judged  # noqa: E402

from tactcad.cli.streams import slow_work
from tactcad.design.files import scratch_folder, write_whole  # noqa: E402
from tactcad.export.inputs import digest  # noqa: E402
from tactcad.export.manifest import sha256_of  # noqa: E402
from tactcad.sweep.on_dask import all_done, cluster, cores  # noqa: E402

KINDS = ("design", "whole", "mutant", "kill")
DOCUMENT = ROOT / "docs" / "tried.md"
BEGIN, END = "<!-- table night -->\n", "<!-- end -->\n"


def sources() -> str:
    """Digest of what all outcomes depend on: tests and fixtures count where they are run."""
    files = [
        p for name in ("src", "tests", "hardware") for p in sorted((ROOT / name).rglob("*")) if p.is_file()
    ]
    other = re.compile(r"test_.*\.py|conftest\.py|.*\.pyc")
    return digest(
        {str(p.relative_to(ROOT)): sha256_of(p.read_bytes()) for p in files if not other.fullmatch(p.name)}
    )


def this_night(folder: Path) -> Night:
    """The one that was stopped there, or a new one."""
    mark, own = folder / "night.json", sources()
    kept = json.loads(mark.read_text()) if mark.exists() else {}
    named = os.environ.get("TACTCAD_SEED")
    if kept.get("sources") != own or kept.get("ended") or named:
        kept = {"seed": int(named) if named else SystemRandom().randrange(10**9), "sources": own}
        write_whole(mark, json.dumps(kept).encode())
    return Night(str(folder), kept["seed"], own)


def items(night: Night, kinds: list[str], designs: int) -> list[Item]:
    """Long ones first, so that none of them is waited for alone."""
    every = mutants.every()
    whats = {
        "kill": KILLS,
        "whole": tuple(dict.fromkeys(name for m in every for name in mutants.tests_of(m))),
        "mutant": tuple(m.label for m in every),
        "design": tuple(map(str, range(designs))),
    }
    chosen = [(kind, what) for kind in whats if kind in kinds for what in whats[kind]]
    return [Item(night, n, kind, what) for n, (kind, what) in enumerate(chosen)]


def carried_out(orders: list[Item], workers: int) -> int:
    """How many of them were tried now; the others had ended before."""
    left = [item for item in orders if item.found() is None]
    if not left:
        return 0
    with (
        slow_work(sys.stderr) as tell,
        scratch_folder("night") as scratch,
        cluster(None, workers, [], lambda: None, print, scratch) as client,
    ):
        before = len(orders) - len(left)
        tell(before, len(orders), "tried")
        for n, _ in enumerate(all_done(client, left), before + 1):
            tell(n, len(orders), "tried")
    return len(left)


def counts(orders: list[Item]) -> tuple[list[str], list[str]]:
    """Lines of the published table, and what failed."""
    lines, failed = [], []
    for kind in KINDS:
        mine = [(item, item.found()) for item in orders if item.kind == kind]
        bad = [f"{kind} {item.what}: {'; '.join(f['failed'][:3])}" for item, f in mine if f and f["failed"]]
        failed += bad
        if kind == "design" and mine:
            designs = Counts()
            for item, found in mine:
                own = Judged(found["rule"], tuple(found["scenes"]), tuple(found["failed"]))
                designs.add(f"draw {found['draw']}", own)
            lines.append(f"| random designs, seed {mine[0][0].night.seed} | {designs} |")
        elif mine:
            said = {
                "whole": "files of tests, nothing broken: passed",
                "mutant": "checks broken, one at a time: a test failed for",
                "kill": "tests of killed commands, twenty kills or more each: passed",
            }[kind]
            lines.append(f"| {len(mine)} {said} | {len(mine) - len(bad)} |")
    return lines, failed


def publish(lines: list[str]) -> None:
    text = DOCUMENT.read_text(encoding="utf-8")
    new = BEGIN + f"| night of {date.today()} | |\n|---|---|\n" + "\n".join(lines) + "\n" + END
    pattern = re.compile(re.escape(BEGIN) + ".*?" + re.escape(END), re.DOTALL)
    write_whole(DOCUMENT, pattern.sub(lambda _: new, text).encode())


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS)
    parser.add_argument("--designs", type=int, default=1000)
    parser.add_argument("--workers", type=int, default=cores())
    parser.add_argument("--publish", action="store_true", help="write the counts to docs/tried.md")
    args = parser.parse_args()
    folder = args.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    os.environ["TACTCAD_CACHE"] = str(folder / "cache")  # nobody else's
    night = this_night(folder)
    orders = items(night, args.kinds, args.designs)
    tried = carried_out(orders, args.workers)
    lines, failed = counts(orders)
    print("\n".join([f"seed {night.seed}: {tried} tried now, {len(orders) - tried} before", *failed, *lines]))
    if args.publish:
        publish(lines)
    ended = {"seed": night.seed, "sources": night.sources, "ended": True}
    write_whole(folder / "night.json", json.dumps(ended).encode())
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
