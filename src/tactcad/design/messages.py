"""Refusal of bad input: its place, value, and the legal range; and of what needs an extra that is missing."""

from __future__ import annotations

from collections.abc import Iterable
from importlib.util import find_spec


class InputError(ValueError):
    """Input that cannot be used. Commands print it as one line and exit with status 2.

    where   the field's path, or file with line and column ("element.hinge_thickness", "loads.csv:3:2")
    what    the fault, one clause without a full stop; both are shown on one line and shortened
    value   the value found, shown with repr and shortened; leave it out if there is none
    legal   the legal values
    """

    def __init__(self, where: str, what: str, *, value: object = ..., legal: str = "") -> None:
        self.where, self.what, self.value, self.legal = where, what, value, legal
        parts = [f"{_on_one_line(where)}: {_on_one_line(what, 500)}"]
        if value is not ...:
            parts.append(f"found {shortened(value)}")
        if legal:
            parts.append(f"legal: {legal}")
        super().__init__("; ".join(parts))


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """ "did you mean X?" for the known word that `word` looks like; "" if none does."""
    likely = nearest(word, known)
    return f"did you mean {likely}?" if likely else ""


def nearest(word: str, known: Iterable[str]) -> str:
    """The known word that `word` looks like; "" if none does."""
    import difflib  # rarely needed

    return next(iter(difflib.get_close_matches(word[:200], list(known), n=1)), "")


def one_of(word: object, known: Iterable[str]) -> str:
    """The legal words in place of a mistyped one: the whole list, and a suggestion.

    Parameters
    ----------
    word
        What was typed.
    known
        The legal words.
    """
    known = list(known)
    return "one of " + ", ".join(known) + in_brackets(did_you_mean(str(word), known))


def in_brackets(hint: str) -> str:
    return f" ({hint})" if hint else ""


class CheckFailure(RuntimeError):
    """A check failed or a request cannot be met. Commands print it and exit with status 1."""


SHOWN = 60  # characters of a value


def shortened(value: object) -> str:
    """repr(value), cut to SHOWN characters, so that a hostile value cannot flood the terminal."""
    try:
        text = repr(value)
    except RecursionError:
        text = f"a deeply nested {type(value).__name__}"
    except ValueError:  # Python shows no integer of more than 4300 digits
        text = f"a very large {type(value).__name__}"
    return text if len(text) <= SHOWN else text[: SHOWN - 3] + "..."


def hidden(text: str) -> str:
    """Description of invisible characters in a text that change its display; "" if there are none.

    By the categories of Unicode: controls other than line ends, separators of lines and paragraphs, surrogate
    halves, and formats, among them all that turn the direction of text. The two joiners that scripts and
    emoji need are accepted.
    """
    if text.isprintable():
        return ""
    import unicodedata  # hardly a text needs it

    strange = (c for c in text if c not in "\n\u200c\u200d")
    hiding = next((c for c in strange if unicodedata.category(c) in ("Cc", "Cf", "Cs", "Zl", "Zp")), "")
    return hiding and f"U+{ord(hiding):04X} {unicodedata.name(hiding, '(a control, or half a pair)')}"


def visible(text: str) -> bool:
    """Whether a letter or digit can be seen in the text; Hangul's fillers are letters that cannot."""
    return any(c.isalnum() and c not in "\u115f\u1160\u3164\uffa0" for c in text)


def _on_one_line(where: str, most: int = 200) -> str:
    text = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in where)
    return text if len(text) <= most else f"{text[: most // 2]}...{text[-most // 4 :]}"


EXTRAS = {  # and the packages of each that are imported
    "cad": ("OCP", "build123d", "manifold3d", "trimesh"),
    "logs": ("nptdms",),
    "review": ("ocp_viewer",),
    "robot": ("mujoco", "yourdfpy"),
    "sweep": ("dask", "distributed", "pyarrow"),
}


def missing(*extras: str) -> list[str]:
    """The packages of these extras that are not installed."""
    return [package for extra in extras for package in EXTRAS[extra] if find_spec(package) is None]


def refuse_missing(what: str, *extras: str) -> None:
    """Raise InputError if a package of these extras, which `what` needs, is not installed."""
    if packages := missing(*extras):
        lacking = [extra for extra in extras if missing(extra)]
        raise InputError(what, f"needs {', '.join(packages)}, not installed here", legal=install(*lacking))


def install(*extras: str) -> str:
    """How to get these extras: tactcad is on no package index."""
    return f"pip install '.[{','.join(extras)}]' in a checkout of tactcad"


def refusal(error: ImportError) -> InputError | None:
    """The message for a package of an extra that cannot be imported; None if it belongs to none."""
    name = error.name or ""
    extra = next((extra for extra, packages in EXTRAS.items() if name.split(".")[0] in packages), None)
    if extra is None:
        return None
    if isinstance(error, ModuleNotFoundError):
        return InputError(name, "needed, but not installed here", legal=install(extra))
    system = "on Debian or Ubuntu: apt-get install libgl1 libx11-6"
    return InputError(name, f"cannot be loaded: {error}", legal=system)
