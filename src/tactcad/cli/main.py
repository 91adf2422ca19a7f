"""The `tactcad` command: finds the sub-command's module, runs it, turns refusals into exit status.

A sub-command is one module with EXAMPLES (text), configure(parser) and run(args) -> exit status; it imports
what it needs inside run, so that `tactcad estimate` never pays for the kernel.
"""

from __future__ import annotations

import argparse
import gc
import importlib
import json
import os
import sys
from collections.abc import Callable
from contextlib import suppress

from tactcad import __version__
from tactcad.design import extras
from tactcad.design.files import NO_ROOM
from tactcad.design.messages import CheckFailure, InputError, one_of
from tactcad.export.cache import take_libraries_in
from tactcad.profiling import profiled, text
from tactcad.shutdown import end_on_signals, ignore_signals

from . import streams
from .parser import Parser

COMMANDS = {
    "new": "write a design file to start from",
    "design": "a sensor from a target: what is to be felt, to the design that feels it, and how surely",
    "export": "write the files of a design: STEP, DXF, bill of materials, pictures",
    "check": "run every check on a design",
    "build": "build a thousand arrays virtually from parts within their limits, and say what fails",
    "sweep": "measure many designs, on one machine or a cluster, into one table; stopped, it goes on",
    "release": "run every check, and write one zip that a shop can quote from",
    "review": "one offline page: the sensor in 3-D, with limits, findings, estimates and bill part by part",
    "view": "the same page live: it follows the design file while it is written",
    "golden": "run every check, show what changed, and write a design's golden geometry",
    "diff": "what changed between two designs, git revisions, exports or golden files, and what it means",
    "estimate": "stiffness, strain and strength of a design's elements, or of a table of designs",
    "size": "the hinge that gives a wanted stiffness, and what cutting tolerance leaves of it",
    "validate": "hold the models against the paper's Tables 1 and 2, as a report",
    "calibrate": "force, deflection and signal readings to stiffness and sensitivity, with intervals",
    "stiffness": "grasp readings and a calibration to the object's stiffness, with intervals",
    "grasp": "press an array on a soft body: deflection, force and signal of every element",
    "schema": "print every field of a design file with unit, range, default and meaning",
}

# Extras without which a command, or one of its options, is refused before any work.
NEEDS = {
    "export": ("cad",),
    "check": ("cad",),
    "sweep": ("sweep",),
    "release": ("cad",),
    "review": ("cad",),
    "view": ("cad", "review"),
    "golden": ("cad",),
    "diff --review": ("cad", "review"),
    "diff --freecad": ("cad",),
}

DONE, FAILED, BAD_INPUT = 0, 1, 2

# Garbage is looked for after so many. By Python's own 700 that is done hundreds of times while the half a
# million objects of the CAD kernel are loaded, which stay: so a check takes 7 % less, and no more memory.
NEW_OBJECTS = 100_000


def main(argv: list[str] | None = None) -> int:
    """Run `tactcad ARGV`; returns 0 done, 1 check failed or request not met, 2 bad input.

    Without ARGV this process is the command itself: it takes its own arguments, survives closed output
    streams, and is ended by signals.
    """
    if argv is None:
        return _own_process()
    streams.mend()
    try:
        return _dispatch(argv)
    except InputError as error:
        return _refused(error, BAD_INPUT)
    except CheckFailure as error:
        return _refused(error, FAILED)
    except OSError as error:
        if error.errno not in NO_ROOM:
            raise
        return _refused(f"the output cannot be written: {error.strerror}", FAILED)
    except ImportError as error:
        if (why := extras.refusal(error)) is None:
            raise
        return _refused(why, BAD_INPUT)


def _own_process() -> int:
    end_on_signals()
    gc.set_threshold(NEW_OBJECTS)
    # Python that is started from here on, as Dask's helpers, looks for no module in the working folder
    os.environ["PYTHONSAFEPATH"] = "1"
    with suppress(RuntimeError):  # a user without home
        take_libraries_in()
    output = streams.own()
    try:
        status = main(sys.argv[1:])
    except SystemExit as ended:  # the parser's help and refusals
        status = ended.code if isinstance(ended.code, int) else DONE
    sys.stdout.flush()
    ignore_signals()
    gc.freeze()  # nothing is collected once more at the end: that took 0.6 s with the CAD kernel loaded
    if output.failed and status == DONE:
        return _refused(f"the output cannot be written: {output.failed.strerror}", FAILED)
    return status


def _refused(why: object, status: int) -> int:
    print(f"tactcad: {why}", file=sys.stderr)
    return status


def _profiled(run: Callable[[argparse.Namespace], int], args: argparse.Namespace) -> int:
    """Run the command and print its profile, whether it succeeds or not."""
    with profiled() as made:
        try:
            return run(args)
        finally:
            record = made.record()
            as_json = getattr(args, "json", False)
            print(json.dumps(record, indent=1) if as_json else text(record), file=sys.stderr)


def parser_of(command: str, raises: bool = False) -> Parser:
    """The parser of one of COMMANDS, as its --help and the reference pages show it; `raises` as of Parser."""
    module = importlib.import_module(f"tactcad.cli.{command}")
    parser = Parser(
        prog=f"tactcad {command}",
        description=COMMANDS[command],
        epilog=f"examples:\n{module.EXAMPLES}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        raises=raises,
    )
    module.configure(parser)
    parser.add_argument(
        "--profile",
        action="store_true",
        help="at the end, on standard error: what was loaded, which parts, meshes and finite-element "
        "solutions were "
        "made, how often, how long, and how much memory it took (with --json as JSON)",
    )
    return parser


def _dispatch(argv: list[str]) -> int:
    if argv and argv[0] in COMMANDS:
        args = parser_of(argv[0]).parse(argv[1:])
        for what, needed in NEEDS.items():
            command, _, option = what.partition(" --")
            if command == argv[0] and (not option or getattr(args, option)):
                extras.refuse_missing(what, *needed)
        run = importlib.import_module(f"tactcad.cli.{argv[0]}").run
        return _profiled(run, args) if args.profile else run(args)
    parser = Parser(
        prog="tactcad",
        description="From one text file to a spring-based tactile sensor array.",
        epilog="commands:\n"
        + "\n".join(f"  {name:10} {text}" for name, text in COMMANDS.items())
        + "\n\n`tactcad COMMAND --help` shows a command's options, with examples.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"tactcad {__version__}")
    parser.add_argument("command", choices=list(COMMANDS), metavar="COMMAND")
    if not argv:
        parser.error(str(InputError("COMMAND", "missing", legal=one_of("", COMMANDS))))
    parser.parse(argv[:1])
    return BAD_INPUT
