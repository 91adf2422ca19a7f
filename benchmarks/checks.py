"""Interference by meshes and by the kernel, and by every near pair: a part of `tactcad bench`, with its options (--smoke, --full, --out DIR, --json)."""

import sys

from tactcad.cli.main import main

if __name__ == "__main__":
    sys.exit(main(["bench", "--only", "interference", *sys.argv[1:]]))
