"""tactcad check [DESIGN]... [--scene NAME]... [--shop FILE] [--strict] [--out DIR] [--within P]
[--in SECONDS] [--json]"""

from __future__ import annotations

import argparse
import json
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tactcad.checks.check_report import Report
    from tactcad.design.allowance import Allowance, Picked
    from tactcad.solids import Meshing

from .parser import UNLISTED, add_allowance, add_design, allowance


def configure(parser: argparse.ArgumentParser) -> None:
    add_design(parser, several=True)
    parser.add_argument("--scene", action="append", metavar="NAME")
    parser.add_argument("--shop", metavar="FILE")
    parser.add_argument("--strict", action="store_true")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("-o", "--out", metavar="DIR")
    parser.add_argument("--report", dest="out", help=UNLISTED)
    add_allowance(parser, "relative error of a part's meshed volume", "mesh")
    parser.add_argument("--json", action="store_true")


def run(args: argparse.Namespace) -> int:
    from tactcad.checks.check_report import as_record, failure_table, json_bytes, junit_bytes
    from tactcad.checks.shop import DEFAULT, load_shop
    from tactcad.solids import USUAL

    from .streams import coloured

    if args.all and (refused := _every_rule(args.design)):
        print("\n".join(refused), file=sys.stderr)
        return 2
    asked = allowance(args)
    shop = Path(args.shop) if args.shop else DEFAULT
    if args.out:
        _refuse_overwriting(Path(args.out), [*args.design, shop])
    load_shop(shop)  # a shop file that cannot be used is refused before the kernel is loaded
    meshing, picked = _picked(args, asked) if asked else (USUAL, None)
    reports = [_checked(source, args, shop, meshing) for source in args.design]
    if args.out:
        _write(Path(args.out), {"check.json": json_bytes(reports), "junit.xml": junit_bytes(reports)})
    if args.json:
        records = [as_record(report) | ({"budget": picked.record()} if picked else {}) for report in reports]
        print(json.dumps(records[0] if len(records) == 1 else records, indent=1))
    else:
        for report in reports:
            _print(report)
        for n, line in enumerate(failure_table(reports)):
            print(coloured(line, "fail" if n > 1 else "", sys.stdout))
        if picked:
            print(picked.text())
    for report in reports:
        if report.failures:
            print(f"tactcad: {report.design}: {len(report.failures)} failures", file=sys.stderr)
    return 1 if any(report.failures for report in reports) else 0


def _every_rule(sources: list[str]) -> list[str]:
    """A line for each broken rule of each design."""
    from tactcad.design.load import read
    from tactcad.parts.rules import broken_rules, refusal

    return [
        f"tactcad: {source}: {refusal(b)}"
        for source in sources
        for b in broken_rules(read(source), every=True)
    ]


def _picked(args: argparse.Namespace, asked: Allowance) -> tuple[Meshing, Picked]:
    """One mesh for all designs; one that is refused costs nothing here."""
    from tactcad.costs.grades import VOLUME, check_grades, meshing_of
    from tactcad.design.allowance import pick
    from tactcad.design.messages import InputError
    from tactcad.parts.rules import load
    from tactcad.scenes import chosen_scenes

    checked = []
    for source in args.design:
        with suppress(*([InputError] if len(args.design) > 1 else [])):
            design = load(source)
            checked.append((design, chosen_scenes(design, args.scene)))
    picked = pick(check_grades(checked), asked, VOLUME)
    return meshing_of(picked.grade), picked


def _checked(source: str, args: argparse.Namespace, shop: Path, meshing: Meshing) -> Report:
    """The design's report. Where several designs are checked, one that is refused counts as failed and the
    others go on.
    """
    from tactcad.checks.check_report import Case, Report
    from tactcad.design.load import find
    from tactcad.design.messages import InputError
    from tactcad.export.golden_file import check_golden, golden_path
    from tactcad.parts.language.finding import Finding
    from tactcad.parts.rules import load
    from tactcad.scenes import chosen_scenes, refuse_unknown_parts

    from .streams import progress

    try:
        design = load(source)
        names = chosen_scenes(design, args.scene)
        refuse_unknown_parts(design)
    except InputError as error:
        if len(args.design) == 1:
            raise
        refusal = Finding("design", "fail", source, (), 0, 0, str(error))
        return Report(source, "", [Case("design", source, 0.0, (refusal,))])

    from tactcad.export.cache import Cache, default_root
    from tactcad.export.kept_checks import checked

    cache, step = Cache(default_root()), progress(sys.stderr).step
    report = checked(design, names, cache, shop, step, args.strict, meshing, anew=True)
    path = golden_path(find(source), design)
    if path or design.design.unchanged:
        report.run("golden", check_golden, design, path)
    return report


def _refuse_overwriting(folder: Path, sources: list[str | Path]) -> None:
    from tactcad.design.files import refuse_overwriting
    from tactcad.design.load import find
    from tactcad.design.messages import InputError

    inputs = []
    for source in sources:
        with suppress(InputError):  # where several designs are checked, a missing one is a failed check
            inputs.append(find(source))
    for name in ("check.json", "junit.xml"):
        refuse_overwriting(folder / name, *inputs, option="--out")


def _write(folder: Path, files: dict[str, bytes]) -> None:
    from tactcad.design.files import make_folder, write_whole

    make_folder(folder)
    for name, data in files.items():
        write_whole(folder / name, data)


def _print(report: Report) -> None:
    from tactcad.parts.language.finding import grouped
    from tactcad.scenes import stated_size

    from .streams import coloured

    size = f", {stated_size(report.size)} overall" if report.size else ""
    print(f"{report.design} revision {report.revision}{size}")
    seconds = report.seconds
    for check, runs in report.runs.items():
        print(f"  {check:14} {runs:5} runs {seconds[check]:8.2f} s")
    flags = [f for f in report.findings if f.severity == "flag"]
    for said in grouped(flags):
        print(coloured(f"  flag: {said}", "flag", sys.stdout))
    print(f"  {len(report.failures)} failed, {len(flags)} flagged")
