"""Command-line arguments, refused like all other bad input: one line that says what is legal."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any, NoReturn

from tactcad.design.messages import InputError, near, one_of
from tactcad.design.plain_numbers import as_number, as_whole


class Parser(argparse.ArgumentParser):
    """argparse's parser without its page of usage before the message, and with the word that was meant."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.register("type", float, as_number)
        self.register("type", int, as_whole)

    def parse_args(self, args: Sequence[str] | None = None, namespace: Any = None) -> argparse.Namespace:
        if args and args[-1] == "--":
            self.error(
                str(InputError("--", "nothing follows it", legal="leave it out, or name what it is for"))
            )
        parsed, unknown = super().parse_known_args(args, namespace)
        if unknown:
            hint = near(unknown[0], self._option_string_actions) if unknown[0].startswith("-") else ""
            self.error(
                str(InputError(unknown[0], "unknown argument", legal=hint or f"see `{self.prog} --help`"))
            )
        for action in self._actions:
            self._refuse_empty(action, getattr(parsed, action.dest, None))
        return parsed

    def _refuse_empty(self, action: argparse.Action, value: Any) -> None:
        """An empty text is a slip of whoever wrote the script, never a wish for the default."""
        if "" in (value if isinstance(value, list) else [value]):
            self.error(str(InputError(_named(action), "empty", value="", legal=action.help or "")))

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            self.error(
                str(
                    InputError(
                        _named(action), "unknown", value=value, legal=one_of(value, map(str, action.choices))
                    )
                )
            )

    def error(self, message: str) -> NoReturn:
        """One line, exit status 2."""
        self.exit(2, f"tactcad: {message}\n")


def add_others(parser: argparse.ArgumentParser) -> None:
    """--keep and --discard, for commands that write a folder (tactcad.export.publish)."""
    others = parser.add_mutually_exclusive_group()
    others.add_argument(
        "--keep",
        dest="others",
        action="store_const",
        const="keep",
        default="refuse",
        help="where the folder holds what tactcad did not write there: move it beside, as DIR-kept-1 (default: refuse)",
    )
    others.add_argument(
        "--discard",
        dest="others",
        action="store_const",
        const="discard",
        help="remove it, unread, with the folder",
    )


def _named(action: argparse.Action) -> str:
    return "/".join(action.option_strings) or str(action.metavar or action.dest)
