"""Run by test_publish.py: exports a folder of three equal files, killed before its n-th file operation.

usage: publish_child.py DIR CONTENT N    prints the number of operations seen; N = 0 lets it live
"""

from __future__ import annotations

import os
import signal
import sys

from tactcad.export.publish import locked, new_build

CHANGES = {
    "os.rename",
    "os.mkdir",
    "os.symlink",
    "os.remove",
    "os.rmdir",
    "open",
    "os.truncate",
    "fcntl.flock",
}


def export(directory: str, content: str) -> None:
    with locked(directory) as place, new_build(place) as folder:
        for name in ("a.step", "b.dxf", "sub/c.svg"):
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).write_text(content)


def main() -> None:
    directory, content, fatal = sys.argv[1], sys.argv[2], int(sys.argv[3])
    seen = 0

    def count(event: str, args: tuple) -> None:
        nonlocal seen
        if event in CHANGES:
            seen += 1
            if seen == fatal:
                os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(count)
    export(directory, content)
    print(seen)


if __name__ == "__main__":
    main()
