"""Rules between fields of a design, one file a subject. Designs that cannot be built or held are refused
before anything is made.

In: a layout. Out: findings, each with the field at fault and its legal range. A field's own range is checked
when the file is read, these rules afterwards. A rule is a function with `@rule` above it in any file of this
folder; `@fits` marks one that an array must keep to fit a rig, whose declaration lists it.
"""

from __future__ import annotations

import pkgutil
from contextlib import suppress
from importlib import import_module
from pathlib import Path

from tactcad.design.family import family_of
from tactcad.design.load import read
from tactcad.design.messages import CheckFailure, InputError
from tactcad.design.tree import CommonTables

from ..language.finding import Finding
from .rule import Rule

# Subjects of files whose order matters, in that order; any other file of this folder follows by name.
FIRST = "element gauge stop clamp pressed readout cart calibration".split()


def design_rules() -> dict[str, Rule]:
    """Every rule that a design must keep, by name, in the order in which they are tried."""
    found = sorted(name for _, name, _ in pkgutil.iter_modules(__path__) if name.endswith("_rules"))
    names = dict.fromkeys([*(f"{subject}_rules" for subject in FIRST), *found])
    modules = [import_module(f"{__name__}.{name}") for name in names]
    every = [r for module in modules for r in vars(module).values() if isinstance(r, Rule)]
    return {r.name: r for r in every if not r.fit}


def broken_rules(design: CommonTables, every: bool = False) -> list[Finding]:
    """The first finding of every rule of its family that the design breaks, in the order of the rules.

    With `every`, rules that follow a broken one are tried too; those that it makes incomputable are left out.
    """
    family = family_of(design)
    layout = family.layout(design)
    broken: list[Finding] = []
    kept: dict[str, bool] = {}  # rule -> it and all before it are kept, as those are that are not tried
    for name, rule in family.rules().items():
        if kept.get(rule.after, True):
            broken += rule(layout)
        elif every:
            with suppress(CheckFailure, ArithmeticError, LookupError, ValueError):
                broken += rule(layout)
        kept[name] = not broken
    return broken


def refuse_broken(design: CommonTables) -> None:
    """Raise InputError for the first rule that the design breaks, naming the others."""
    broken = broken_rules(design)
    if broken:
        first = broken[0]
        others = f" (and {', '.join(b.check for b in broken[1:])})" if broken[1:] else ""
        raise refusal(first, others)


def refusal(broken: Finding, others: str = "") -> InputError:
    """A broken rule as the refusal of the field that it names; `others` follows the rule's name."""
    # not 3.5999999999999996
    value = round(broken.value, 9) if isinstance(broken.value, float) else broken.value
    what = f"rule {broken.check}{others}: {broken.message}"
    return InputError(broken.part, what, value=value, legal=str(broken.limit))


def load(source: str | Path) -> CommonTables:
    """A design, checked against every rule between its fields.

    Parameters
    ----------
    source
        A path (it has a '/' or ends in .toml), or the name of a design in hardware/.

    Raises
    ------
    InputError
        If the file is missing or not a design, a value is not legal, or a rule is broken.
    """
    design = read(source)
    refuse_broken(design)
    return design
