"""tactcad completion bash|zsh|fish: what the shell asks while a command is typed."""

from __future__ import annotations

import argparse

from .parser import UNLISTED

NAMES_DESIGN = ("design", "source", "old", "new")  # arguments that take a design's name


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("shell", choices=("bash", "zsh", "fish", "words"), metavar="SHELL")
    parser.add_argument("words", nargs=argparse.REMAINDER, help=UNLISTED)  # of the scripts: typed so far


def run(args: argparse.Namespace) -> int:
    from .main import WORDS

    print("\n".join(candidates(args.words)) if args.shell == "words" else WORDS["completion"][args.shell])
    return 0


def candidates(words: list[str]) -> list[str]:
    """Completions of the last of these words of a command; none for a file's name."""
    from tactcad.design.load import names

    from .main import COMMANDS, LOUDNESS, parser_of

    *before, last = words[words[:1] in LOUDNESS :] or [""]
    if not before or before == ["help"]:
        return [name for name in (*COMMANDS, "help") if name.startswith(last)]
    if before[0] not in COMMANDS:
        return []
    actions = [a for a in parser_of(before[0])._actions if a.help != UNLISTED]
    of = next((a for a in actions if before[-1] in a.option_strings and a.nargs != 0), None)
    if of is None and last.startswith("-"):
        options = [a.option_strings[-1] for a in actions if a.option_strings]
        return [option for option in (*options, "--help") if option.startswith(last)]
    asked = [of] if of else [a for a in actions if not a.option_strings]
    found = [str(choice) for a in asked for choice in a.choices or ()]
    found += [name for a in asked if a.dest in NAMES_DESIGN for name in names()]
    return [word for word in dict.fromkeys(found) if word.startswith(last)]
