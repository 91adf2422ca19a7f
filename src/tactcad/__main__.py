"""`python -m tactcad` is the same command as `tactcad`."""

import sys

from tactcad.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
