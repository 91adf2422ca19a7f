"""The `tactcad` command: finds the sub-command's module, runs it, turns refusals into exit status.

A sub-command is one module with configure(parser) and run(args) -> exit status, and its words in
commands.toml; it imports what it needs inside run, so that `tactcad estimate` never pays for the kernel.
"""

from __future__ import annotations

import argparse
import gc
import importlib
import json
import os
import sys
import tomllib
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from time import perf_counter

from tactcad import __version__
from tactcad.design.allowance import read_seconds
from tactcad.design.files import NO_ROOM
from tactcad.design.messages import CheckFailure, InputError, one_of, refusal, refuse_missing
from tactcad.export.cache import take_libraries_in
from tactcad.profiling import profiled, text
from tactcad.shutdown import end_on_signals, ignore_signals

from . import streams
from .parser import UNLISTED, Parser

WORDS = tomllib.loads((Path(__file__).parent / "commands.toml").read_text("utf-8"))
GROUPS: dict[str, dict[str, str]] = WORDS["groups"]
COMMANDS = {name: text for group in GROUPS.values() for name, text in group.items() if name != "help"}
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
LATE = 1.1  # of the seconds asked for by --in, above which an overrun is reported
LOUD = (("-q", "--quiet"), ("-v", "--verbose"))
LOUDNESS = [[word] for words in LOUD for word in words]

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
        if (why := refusal(error)) is None:
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
        epilog=f"examples:\n{WORDS['examples'][command]}\n\n-q, -v, exit statuses, variables: tactcad help",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        add_help=False,
        raises=raises,
    )
    module.configure(parser)
    said = WORDS["options"]["shared"] | WORDS["options"].get(command, {})
    for action in parser._actions:  # by its long name, or a positional's own
        action.help = action.help or said.get([action.dest, *action.option_strings][-1])
    parser.add_argument("-h", "--help", action="help", help=UNLISTED)
    loud = parser.add_mutually_exclusive_group()
    for short, long in LOUD:
        loud.add_argument(short, long, action="store_const", const=long, dest="loudness", help=UNLISTED)
    return parser


def overview() -> str:
    """The output of `tactcad` alone: the commands by task, and their common options."""
    groups = [
        "\n".join([f"{group}:", *(f"  {name:10} {text}" for name, text in commands.items())])
        for group, commands in GROUPS.items()
    ]
    head = "usage: tactcad COMMAND ...\n\nFrom one text file to a spring-based tactile sensor array."
    return "\n\n".join([head, *groups, WORDS["text"]["common"]])


def _dispatch(argv: list[str]) -> int:
    if argv[:1] in LOUDNESS and argv[1:2] and argv[1] in COMMANDS:
        argv = [argv[1], argv[0], *argv[2:]]  # before the command as well as after it
    if argv and argv[0] in COMMANDS:
        args = parser_of(argv[0]).parse(argv[1:])
        streams.set_loudness(args.loudness)
        for what, needed in NEEDS.items():
            command, _, option = what.partition(" --")
            if command == argv[0] and (not option or getattr(args, option)):
                refuse_missing(what, *needed)
        run = importlib.import_module(f"tactcad.cli.{argv[0]}").run
        started = perf_counter()
        status = _profiled(run, args) if os.environ.get("TACTCAD_PROFILE") else run(args)
        # A line on standard error if a command took longer than --in allows (s)
        asked = getattr(args, "seconds", None)
        took = perf_counter() - started
        if asked is not None and took > LATE * read_seconds(asked, "--in"):
            why = "the least work takes so long here, or this machine is busy"
            print(f"tactcad: took {took:.3g} s, more than --in {asked}: {why}", file=sys.stderr)
        return status
    if argv[:1] == ["help"] and len(argv) == 2 and argv[1] in COMMANDS:
        parser_of(argv[1]).print_help()
        return DONE
    if not argv or argv in LOUDNESS or (len(argv) < 3 and set(argv) <= {"help", "-h", "--help"}):
        print(overview())
        return DONE
    if argv == ["--version"]:
        print(f"tactcad {__version__}")
        return DONE
    word = argv[1] if argv[0] == "help" else argv[0]
    Parser(prog="tactcad").error(
        str(InputError("COMMAND", "unknown", value=word, legal=one_of(word, (*COMMANDS, "help"))))
    )
