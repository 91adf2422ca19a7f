"""Run by test_archive.py: writes a file of 50 kB of one letter, killed before its n-th file operation.

usage: archive_child.py TARGET LETTER N    N = 0 lets it live
"""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

from tactcad.design.files import whole_file

CHANGES = {"os.rename", "os.mkdir", "os.remove", "open", "os.truncate", "os.chmod", "fcntl.flock"}


def main() -> None:
    target, letter, fatal = Path(sys.argv[1]), sys.argv[2], int(sys.argv[3])
    seen = 0

    def count(event: str, args: tuple) -> None:
        nonlocal seen
        if event in CHANGES:
            seen += 1
            if seen == fatal:
                os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(count)
    target.parent.mkdir(exist_ok=True)
    with whole_file(target) as part:
        part.write_text(letter * 50_000)


if __name__ == "__main__":
    main()
