"""tactcad review [DESIGN|EXPORT] [--scene NAME]... [--drawings] [--out FILE] [--json]"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path

from .parser import UNLISTED


def configure(parser: argparse.ArgumentParser) -> None:
    from tactcad.design.load import DEFAULT_DESIGN

    parser.add_argument(
        "design",
        nargs="?",
        default=DEFAULT_DESIGN,
        metavar="DESIGN",
        help=f"a path, a name in hardware/ (default {DEFAULT_DESIGN}), or an export's folder",
    )
    parser.add_argument("--scene", action="append", metavar="NAME")
    parser.add_argument("--drawings", action="store_true")
    parser.add_argument("-o", "--out", metavar="FILE")
    parser.add_argument("--freecad", help=UNLISTED)  # beside a page
    parser.add_argument("--json", action="store_true")


def run(args: argparse.Namespace) -> int:
    from tactcad.design.files import refuse_overwriting, write_whole
    from tactcad.design.messages import InputError
    from tactcad.review.freecad import freecad_document, refuse_no_document, reload_macro
    from tactcad.review.review_page import review_page, viewer_library
    from tactcad.review.review_record import review_record
    from tactcad.review.subject import drawn_sheets, shapes_of, subject
    from tactcad.scenes import chosen_scenes, make_scene

    from .streams import progress

    started, say = time.perf_counter(), progress(sys.stderr)
    if args.out and args.out.endswith(".FCStd") and not args.freecad:
        args.out, args.freecad = None, args.out
    seen = subject(args.design)
    out = args.out or (None if args.freecad else "review.html")
    macro = str(Path(args.freecad).with_suffix(".FCMacro")) if args.freecad else ""
    for option, path in (("--out", out), ("--freecad", args.freecad), ("--freecad", macro)):
        if path:
            refuse_overwriting(path, seen.path, option=option)
            folder = Path(path).parent
            if not folder.is_dir():  # said before any work
                legal = "a file in a folder that is there"
                raise InputError(option, "no such folder", value=str(folder), legal=legal)
    names = chosen_scenes(seen.design, args.scene or (list(seen.scenes) if seen.scenes else None))
    if args.freecad:
        refuse_no_document(args.freecad)
    library = viewer_library() if out else None  # report a missing one before any work
    shapes, sheets = shapes_of(seen.design, say.line), dict(seen.sheets)
    made: dict[str, bytes] = {}
    if args.freecad:
        made[args.freecad] = freecad_document(seen.design, names, shapes, say.step)
        again = ["review", args.design, *(word for name in names for word in ("--scene", name))]
        made[macro] = reload_macro([*again, "--freecad", args.freecad], Path(args.freecad))
    if out and library:
        if args.drawings:
            scenes = [make_scene(seen.design, name) for name in names]
            sheets = drawn_sheets(seen.design, scenes, shapes, say.step)
        made[out] = review_page(*review_record(seen.design, names, shapes, say.step, sheets), library)
    for path, data in made.items():
        write_whole(path, data)
    shapes.cache.trim()
    record = {
        "design": seen.design.name,
        "revision": seen.design.design.revision,
        "scenes": list(names),
        "files": {path: len(data) for path, data in made.items()},
        "seconds": round(time.perf_counter() - started, 3),
    }
    if args.json:
        print(json.dumps(record, indent=1))
    else:
        for path, data in made.items():
            what = "reloads it in FreeCAD" if path == macro else ", ".join(names)
            size = f"{len(data) / 1e6:.2f} MB" if len(data) >= 1e5 else f"{len(data) / 1e3:.1f} kB"
            print(f"{path}: {what}; {size}")
    return 0
