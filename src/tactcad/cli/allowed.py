"""--within P and --in SECONDS: how much error and how much time an answer may take."""

from __future__ import annotations

import argparse

from tactcad.design.allowance import Allowance, read_seconds, read_within
from tactcad.design.messages import InputError


def add_allowance(parser: argparse.ArgumentParser, of: str, chosen: str) -> None:
    """The two options; `of` says whose error P is, `chosen` what is chosen by it."""
    of = of.replace("%", "%%")  # argparse formats help
    parser.add_argument(
        "--within",
        metavar="P",
        help=f"largest {of} that may be left, as 1%% or 0.01; takes the {chosen} of least work that keeps "
        "it, or refuses; says what a step more or less would cost (docs/accuracy.md)",
    )
    parser.add_argument(
        "--in",
        dest="seconds",
        metavar="SECONDS",
        help=f"time it may take: the {chosen} of least error in it; with --within both must hold; a time too "
        "short is refused before anything is begun, with the time needed: no check is left out for it",
    )


def allowance(args: argparse.Namespace) -> Allowance:
    """What was asked; false where neither was. Raises InputError."""
    return Allowance(
        None if args.within is None else read_within(args.within, "--within"),
        None if args.seconds is None else read_seconds(args.seconds, "--in"),
    )


def refuse_named(asked: Allowance, option: str, given: object) -> None:
    """Raise InputError where what the allowance chooses is named as well."""
    if asked and given is not None:
        by = "--within" if asked.within is not None else "--in"
        raise InputError(by, f"makes this choice itself; leave out {option} {given}")
