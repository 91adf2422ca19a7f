"""Run by test_publish.py: publishes a folder of three equal files, killed before its n-th file operation.

usage: publish_child.py DIR CONTENT N [HOW]...    N = 0 lets it live
HOW: keep or discard what others put there; "two-renames", as where names cannot be exchanged; "meddled",
somebody writes a file into the earlier folder while the new one is made; "hanging", it says so and waits in
the middle.
"""

from __future__ import annotations

import os
import signal
import sys
import time
from pathlib import Path

from tactcad.export import publication as publish

CHANGES = {
    "os.rename",
    "os.mkdir",
    "os.remove",
    "os.rmdir",
    "open",
    "ctypes.dlopen",  # before every renameat2
    "fcntl.flock",
}


def main(directory: str, content: str, fatal: int, *how: str) -> None:
    others = next((word for word in how if word in (publish.KEEP, publish.DISCARD)), publish.REFUSE)
    if "two-renames" in how:
        publish._exchange = lambda one, other: False
    seen = 0

    def count(event: str, args: tuple) -> None:
        nonlocal seen
        if event in CHANGES:
            seen += 1
            if seen == fatal:
                os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(count)
    with publish.replacing(directory, "tactcad-test-1", others) as work:
        if "hanging" in how:
            print("hanging", flush=True)
            time.sleep(60)
        if "meddled" in how:
            Path(directory, "meanwhile.txt").write_text("of somebody")
        work.write({name: content.encode() for name in ("a.step", "b.dxf", "sub/c.svg")})


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]), *sys.argv[4:])
