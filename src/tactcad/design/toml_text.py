"""TOML text from untrusted sources: parsed, or refused with where and why, and never slowly."""

from __future__ import annotations

import re
import tomllib
from typing import Any

from .messages import InputError

# Keys of our files have at most four names (element.override.N.hinge_thickness). Python's parser takes
# minutes for keys of many thousand names, so keys of more than 16 are refused before it sees them. Comments
# and strings are skipped: they may hold anything. The quantifiers are possessive, so the search is linear in
# the length of the text.
_LONG_KEY = re.compile(
    r"""
    \#[^\n]*+
    | "{3} (?:[^"\\] | \\. | "{1,2}(?!"))*+ (?:"{3} | \\?\Z)
    | '{3} (?:[^'] | '{1,2}(?!'))*+ (?:'{3} | \Z)
    | (?P<long> (?<![\w-]) (?:(?:[\w-]++ | "(?:[^"\\\n]|\\.)*+" | '[^'\n]*+') [ \t]*+ \. [ \t]*+){16})
    | "(?:[^"\\\n] | \\.)*+"?
    | '[^'\n]*+'?
    """,
    re.VERBOSE | re.DOTALL,
)


def parse_toml(text: str, where: str) -> dict[str, Any]:
    """The table that TOML text holds; `where` names the text in messages. Raises InputError where it is
    not TOML.
    """
    text = text.replace("\r\n", "\n")
    long = next((token for token in _LONG_KEY.finditer(text) if token["long"]), None)
    if long:
        line = text.count("\n", 0, long.start()) + 1
        raise InputError(
            f"{where}:{line}",
            "a key of too many names",
            value=long["long"],
            legal="names joined by at most 3 dots",
        )
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(where, f"is not TOML: {error}") from None
    except RecursionError:
        raise InputError(where, "nested too deeply", legal="tables at most 3 deep") from None
    except ValueError as error:  # an impossible date, or an integer of thousands of digits
        raise InputError(where, f"is not TOML: {error}") from None
