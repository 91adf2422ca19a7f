"""Every rung and mesh density, CalculiX beside them: a part of `tactcad bench`, with its options (--smoke, --full, --out DIR, --json)."""

import sys

from tactcad.cli.main import main

if __name__ == "__main__":
    sys.exit(main(["bench", "--only", "rungs", "--only", "meshes", *sys.argv[1:]]))
