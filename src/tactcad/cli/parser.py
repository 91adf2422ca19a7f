"""Command-line arguments and the options that commands share; refused like all other bad input, in one line
with the legal values."""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from typing import Any, NoReturn

from tactcad.design.allowance import Allowance, read_seconds, read_within
from tactcad.design.load import DEFAULT_DESIGN
from tactcad.design.messages import InputError, did_you_mean, one_of
from tactcad.design.text_values import as_number, as_whole


class Parser(argparse.ArgumentParser):
    """argparse's parser without the usage page before the message, and with a suggestion for a mistyped
    word.
    """

    def __init__(self, *args: Any, raises: bool = False, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.raises = raises  # InputError in place of ending the program
        self.register("type", float, as_number)
        self.register("type", int, as_whole)
        self._negative_number_matcher = re.compile(r"-\.?\d")  # argparse's takes -1% and -1e-3 for options

    def parse(self, args: Sequence[str]) -> argparse.Namespace:
        """The parsed arguments; ends the program with exit status 2 if they are wrong."""
        takes_all = any(action.nargs == argparse.REMAINDER for action in self._actions)
        if args and args[-1] == "--" and not takes_all:
            self._refuse("--", "nothing follows it", legal="leave it out, or name what it is for")
        parsed, unknown = super().parse_known_args(args)
        if unknown:
            hint = did_you_mean(unknown[0], self._option_string_actions) if unknown[0].startswith("-") else ""
            self._refuse(unknown[0], "unknown argument", legal=hint or f"see `{self.prog} --help`")
        for action in self._actions:
            self._refuse_empty(action, getattr(parsed, action.dest, None))
            if action.dest.endswith(BY_NAME):  # argparse drops the shared attributes of an omitted positional
                given = vars(parsed).pop(action.dest, None)
                if given is not None:
                    setattr(parsed, action.dest.removesuffix(BY_NAME), given)
        return parsed

    def _refuse_empty(self, action: argparse.Action, value: Any) -> None:
        """Refuse an empty text: it is a mistake in the calling script, never a wish for the default."""
        if action.nargs == argparse.REMAINDER:  # words that a shell is completing
            return
        if "" in (value if isinstance(value, list) else [value]):
            self._refuse(_named(action), "empty", value="", legal=_help(action))

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            legal = one_of(value, map(str, action.choices))
            self._refuse(_named(action), "unknown", value=value, legal=legal)

    def _refuse(self, where: str, what: str, *, value: object = ..., legal: str) -> NoReturn:
        refusal = InputError(where, what, value=value, legal=legal)
        if self.raises:
            raise refusal
        self.error(str(refusal))

    def error(self, message: str) -> NoReturn:
        """One line, exit status 2."""
        if self.raises:
            raise InputError(self.prog, message)
        self.exit(2, f"tactcad: {message}\n")


def add_design(parser: argparse.ArgumentParser, several: bool = False) -> None:
    """DESIGN, or several of them."""
    parser.add_argument(
        "design",
        nargs="*" if several else "?",
        default=[DEFAULT_DESIGN] if several else DEFAULT_DESIGN,
        metavar="DESIGN",
        help=f"a path, or a name in hardware/ (default {DEFAULT_DESIGN})",
    )


def add_others(
    parser: argparse.ArgumentParser,
    where: str = "the folder holds files that tactcad did not write",
    kept: str = "DIR-kept-1",
) -> None:
    """--keep and --discard, for commands that write a folder (tactcad.export.publication), or zips."""
    others = parser.add_mutually_exclusive_group()
    others.add_argument(
        "--keep",
        dest="others",
        action="store_const",
        const="keep",
        default="refuse",
        help=f"if {where}: move it aside, as {kept} (default: refuse)",
    )
    others.add_argument("--discard", dest="others", action="store_const", const="discard")


BY_NAME = "_by_name"  # suffix of the dest of an option that replaces a positional
UNLISTED = argparse.SUPPRESS  # help of an option that works and that --help does not name


def _help(action: argparse.Action) -> str:
    return "" if action.help in (None, UNLISTED) else str(action.help).replace("%%", "%")


def _named(action: argparse.Action) -> str:
    return action.option_strings[-1] if action.option_strings else str(action.metavar or action.dest)


def add_allowance(parser: argparse.ArgumentParser, of: str, chosen: str) -> None:
    """The two budgets; `of`: the quantity with error P; `chosen`: the object of the choice by --within."""
    of = of.replace("%", "%%")  # argparse formats help
    parser.add_argument(
        "--within",
        metavar="P",
        help=f"largest {of} that you accept, as 1%% or 0.01; picks the quickest {chosen} within it, or "
        f"refuses, and prints the cost of a step more or less (docs/accuracy.md)",
    )
    parser.add_argument("--in", dest="seconds", metavar="SECONDS")


def add_needless_allowance(parser: argparse.ArgumentParser) -> None:
    """The two options on a command that answers at once, with nothing to choose: read, and without effect."""
    for option, dest in (("--within", "within"), ("--in", "seconds")):
        parser.add_argument(option, dest=dest, help=UNLISTED)


def allowance(args: argparse.Namespace) -> Allowance:
    """The allowance asked for; false if there is none. Raises InputError."""
    return Allowance(
        None if args.within is None else read_within(args.within, "--within"),
        None if args.seconds is None else read_seconds(args.seconds, "--in"),
    )


def refuse_named(asked: Allowance, option: str, given: object) -> None:
    """Raise InputError if what the allowance chooses is named as well."""
    if asked and given is not None:
        by = "--within" if asked.within is not None else "--in"
        raise InputError(by, f"makes this choice itself; leave out {option} {given}")
