"""tactcad view [DESIGN] [--scene NAME] [--port PORT]"""

from __future__ import annotations

import argparse
import sys

from .parser import add_design


def configure(parser: argparse.ArgumentParser) -> None:
    add_design(parser)
    parser.add_argument("--scene", default="array", metavar="NAME")
    parser.add_argument("--port", type=int, default=0)


def run(args: argparse.Namespace) -> int:
    import threading
    import time

    from tactcad.design.load import find
    from tactcad.export.shapes import Shapes
    from tactcad.parts.rules import load
    from tactcad.review.live import POLL, Live, LiveServer, load_kernel
    from tactcad.review.review_page import viewer_library
    from tactcad.review.subject import shapes_of

    from .streams import progress

    say = progress(sys.stderr)
    path, library = find(args.design), viewer_library()
    known = shapes_of(load(path), say.line)

    def followed() -> Live:
        return Live(path, args.scene, lambda: Shapes(known.cache, known.made_by))

    with LiveServer(followed, library, args.port) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        print(f"{path}: {server.url}", flush=True)
        load_kernel()
        while True:
            time.sleep(POLL)
            server.live.look()
