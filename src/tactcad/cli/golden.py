"""tactcad golden [DESIGN]..."""

from __future__ import annotations

import argparse
import sys

from .parser import add_design


def configure(parser: argparse.ArgumentParser) -> None:
    add_design(parser, several=True)


def run(args: argparse.Namespace) -> int:
    from tactcad.design.messages import CheckFailure

    status = 0
    for source in args.design:
        try:
            _renew(source)
        except CheckFailure as error:  # the other designs still have their turn
            print(f"tactcad: {error}", file=sys.stderr)
            status = 1
    return status


def _renew(source: str) -> None:
    from tactcad.design.files import refuse_overwriting
    from tactcad.design.load import find
    from tactcad.design.messages import InputError
    from tactcad.export.golden_file import accept, changes_of, compared, golden_path
    from tactcad.parts.rules import load
    from tactcad.scenes import refuse_unknown_parts, scene_names

    from .streams import progress

    design = load(source)
    path = golden_path(find(source), design)
    if path is None:
        raise InputError(source, "has no golden file", legal="a design in a folder hardware/")
    refuse_overwriting(path, find(source), option=source)
    refuse_unknown_parts(design)
    old, new = compared(path, design)
    changes = changes_of(old, new) if old else None

    from tactcad.export.cache import Cache, default_root
    from tactcad.export.kept_checks import checked

    for change in changes or ():
        print(f"{design.name}: {change}")
    step = progress(sys.stderr).step
    report = checked(design, scene_names(design), Cache(default_root()), say=step)
    for failure in report.failures:
        print(failure, file=sys.stderr)
    told = accept(design, path, report.failures)
    said = {None: "written, there was none before", 0: "unchanged"}.get(
        len(changes) if changes is not None else None, f"written, {len(changes or ())} differences"
    )
    print(f"{path.name}: {said}", *told, sep="\n")
