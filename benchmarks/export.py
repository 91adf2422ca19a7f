"""Whole exports and the detail levels of each scene: a part of `tactcad bench`, with its options (--smoke, --full, --out DIR, --json)."""

import sys

from tactcad.cli.main import main

if __name__ == "__main__":
    sys.exit(main(["bench", "--only", "export", "--only", "detail", *sys.argv[1:]]))
