"""`python -m tactcad`, and what the console script runs: signals have their way out before anything else is
loaded."""

import sys

from tactcad.shutdown import end_on_signals

end_on_signals()


def main() -> int:
    """The command with this process's own arguments; returns the exit status."""
    from tactcad.cli.main import main as command

    return command()


if __name__ == "__main__":
    sys.exit(main())
