"""Which kinds of change a comparison holds, for `tactcad diff --fail-on`."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from tactcad.design.messages import InputError
from tactcad.export.difference import Change
from tactcad.export.sides import Side

from .consequences import Meaning


@dataclass(frozen=True)
class Compared:
    """Two sides with what changed and what it means."""

    old: Side
    new: Side
    changes: Sequence[Change]
    meaning: Meaning


def _geometry(c: Compared) -> bool:
    """A part, a placement or a line of a bill."""
    return any(change.path[0] in ("parts", "scenes") for change in c.changes)


def _stiffness(c: Compared) -> bool:
    """K of an element."""
    for side in (c.old, c.new):
        if "elements" not in side.record and not c.meaning.checked:
            raise InputError("--fail-on", f"{side.source} holds no stiffness", value="stiffness")
    return any(element.stiffness for effect in c.meaning.effects for element in effect.elements)


def _checks(c: Compared) -> bool:
    """A check or rule fails that did not."""
    if not c.meaning.checked:
        legal = "sides that hold a design which keeps its rules"
        raise InputError("--fail-on", "nothing to check on both sides", value="checks", legal=legal)
    return any(effect.now_fails for effect in c.meaning.effects)


def _revision(c: Compared) -> bool:
    """The letter stands for one content of every part number."""
    same_letter = (c.old.design, c.old.revision) == (c.new.design, c.new.revision)
    return same_letter and any(effect.parts_revised for effect in c.meaning.effects)


KINDS: dict[str, Callable[[Compared], bool]] = {
    "changes": lambda c: bool(c.changes),
    "geometry": _geometry,
    "stiffness": _stiffness,
    "checks": _checks,
    "revision": _revision,
}


def held(kinds: Collection[str], compared: Compared) -> list[str]:
    """Those of the kinds that the comparison holds. Raises InputError where the sides do not tell."""
    return [kind for kind in kinds if KINDS[kind](compared)]
