"""tactcad diff A B [DESIGN] [--their-code] [--json] [--out FILE]... [--review FILE] ..."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tactcad.design.messages import InputError

from .parser import UNLISTED

if TYPE_CHECKING:
    from tactcad.export.difference import Change
    from tactcad.export.sides import Side
    from tactcad.review.consequences import Meaning


MOST_CHANGES = 40  # lines of differences without --full; chosen: about a screen
KINDS = {".html": "html", ".md": "markdown", ".FCStd": "freecad"}  # by a file's ending its option


class _ByEnding(argparse.Action):
    """The option that --out means, by the file's ending."""

    def __call__(
        self, parser: object, namespace: argparse.Namespace, values: Any, option: object = None
    ) -> None:
        if (kind := KINDS.get(Path(values).suffix)) is None:
            raise InputError(
                "--out", "not a kind of file that diff writes", value=values, legal=", ".join(KINDS)
            )
        setattr(namespace, kind, values)


def configure(parser: argparse.ArgumentParser) -> None:
    # what --fail-on takes; tactcad.review.consequences, which has them, loads numpy
    kinds = ("changes", "geometry", "stiffness", "checks", "revision")
    parser.add_argument("old", metavar="A")
    parser.add_argument("new", metavar="B")
    parser.add_argument("design", metavar="DESIGN", nargs="?")
    parser.add_argument("--their-code", action="store_true")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--full", action="store_true")
    parser.add_argument("-o", "--out", action=_ByEnding, metavar="FILE")
    parser.add_argument("--review", metavar="FILE")
    for option in KINDS.values():
        parser.add_argument(f"--{option}", help=UNLISTED)
    parser.add_argument("--fail-on", action="append", default=[], choices=kinds, metavar="KIND")


def run(args: argparse.Namespace) -> int:
    from tactcad.design.files import write_whole
    from tactcad.export.sides import compare_sides
    from tactcad.review.consequences import Compared, held, meaning
    from tactcad.review.summary import html, markdown

    old, new = _sides(args)
    changes = compare_sides(old, new)
    meant = meaning(old, new)
    met = held(args.fail_on, Compared(old, new, changes, meant))
    made: dict[str, bytes] = {}  # written when all is made: a side may tell no design
    if args.freecad or args.review:
        made |= _material(args, old, new, changes, meant)
    if args.html:
        from tactcad.export.difference_page import page

        made[args.html] = page(old, new, changes, html(meant))
    if args.markdown:
        made[args.markdown] = markdown(old, new, changes, meant).encode()
    for path, data in made.items():
        write_whole(path, data)
    if args.json:
        print(json.dumps(_record(old, new, changes, meant), indent=1))
    else:
        _print(old, new, changes, meant, args.full)
    for kind in met:
        print(f"tactcad: --fail-on {kind} is met", file=sys.stderr)
    return 1 if met else 0


def _sides(args: argparse.Namespace) -> tuple[Side, Side]:
    from tactcad.design.files import refuse_overwriting
    from tactcad.export.sides import named, read_side
    from tactcad.review.freecad import refuse_no_document
    from tactcad.review.review_page import viewer_library
    from tactcad.review.revisions import design_file, revision_sides

    if args.their_code and args.design is None:
        raise InputError("--their-code", "goes with revisions only", legal="A B DESIGN")
    read = [named(args.old), named(args.new)] if args.design is None else [design_file(args.design)]
    outs: dict[str, str] = {}  # option by file
    for option in ("--html", "--review", "--markdown", "--freecad"):
        out = vars(args)[option[2:]]
        if not out:
            continue
        refuse_overwriting(out, *read, option=option)
        if (other := outs.setdefault(out, option)) != option:
            raise InputError(option, f"{other} is written there", value=out, legal="another file")
        if not (folder := Path(out).parent).is_dir():  # said before any work
            legal = "a file in a folder that is there"
            raise InputError(option, "no such folder", value=str(folder), legal=legal)
    if args.freecad:
        refuse_no_document(args.freecad)
    if args.review:
        viewer_library()
    if args.design is None:
        return read_side(args.old), read_side(args.new)
    return revision_sides(args.old, args.new, args.design, _say_code if args.their_code else None)


def _say_code(what: str) -> None:
    print(f"tactcad: --their-code {what}", file=sys.stderr)


def _material(
    args: argparse.Namespace, old: Side, new: Side, changes: list[Change], meant: Meaning
) -> dict[str, bytes]:
    """What shows material that changed, by file: the page, the document of FreeCAD."""
    from tactcad.review.change_record import change_record
    from tactcad.review.consequences import kept_designs
    from tactcad.review.freecad import freecad_changes
    from tactcad.review.review_page import review_page, viewer_library
    from tactcad.review.subject import shapes_of
    from tactcad.review.summary import rows

    from .streams import progress

    say = progress(sys.stderr)
    designs = kept_designs(old, new)
    shapes = shapes_of(designs[0], say.line), shapes_of(designs[1], say.line)
    made: dict[str, bytes] = {}
    if args.review:
        record, block = change_record((old, new), designs, shapes, changes, meant, say.step)
        made[args.review] = review_page(record, block, viewer_library())
    if args.freecad:
        made[args.freecad] = freecad_changes(designs, shapes, rows(meant), say.step)
    return made


def _record(old: Side, new: Side, changes: list[Change], meant: Meaning) -> dict:
    from tactcad.export.sides import not_compared
    from tactcad.review.summary import as_record

    sides = {
        name: {"source": side.source, "kind": side.kind, "design": side.design, "revision": side.revision}
        for name, side in (("old", old), ("new", new))
    }
    return {
        **sides,
        "identical": not changes,
        "not_compared": not_compared(old, new),
        "changes": [asdict(c) for c in changes],
        "meaning": as_record(meant),
    }


def _seen(change: Change) -> bool:
    """Whether both values differ as they are printed."""
    old, new = change.shown()
    return old != new or change.moved is not None


def _rank(change: Change) -> tuple[bool, bool]:
    """Values and elements first, then contours, then the rest of parts, places and bills."""
    return change.path[0] in ("parts", "scenes"), change.path[-1] != "contours"


def _print(old: Side, new: Side, changes: list[Change], meant: Meaning, full: bool) -> None:
    from tactcad.export.sides import not_compared
    from tactcad.review.summary import lines

    for line in lines(meant):
        print(line)
    told = changes if full else sorted(filter(_seen, changes), key=_rank)
    for change in told if full else told[:MOST_CHANGES]:
        print(change)
    if left := len(changes) - (len(told) if full else min(len(told), MOST_CHANGES)):
        print(f"and {left} more differences of parts, places and bills, or too small to print: --full")
    for text in (*not_compared(old, new), *meant.untold):
        print(f"not compared: {text}")
    if not changes:
        print(f"no difference: {old.source} and {new.source}")
