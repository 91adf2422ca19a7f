"""Rules between fields of a design, one file a subject: what cannot be built or held is refused before
anything is made.

In: a layout. Out: findings, each with the field to look at and what is legal. A field's own range is tried
when the file is read, these after. A rule is a function with `@rule` above it; `@fits` says that a rig takes
this array.
"""

from __future__ import annotations

from importlib import import_module

from tactcad.design.messages import InputError
from tactcad.design.tree import Design

from ..finding import Finding
from ..layout import Layout
from .readout_blame import blamed
from .rule import Rule

READOUT = ("readout_rules",)
# Files in the order in which their rules are tried. Those of the rigs load no numpy: which scenes a design
# has is known without.
ARRAY = (
    "element_rules",
    "gauge_rules",
    "stop_rules",
    "clamp_rules",
    "pressed_rules",
    "slot_gauge_rules",
    *READOUT,
)
RIGS = (
    "cart_rules",
    "holder_rules",
    "calibration_rules",
    "grasping_rules",
    "bonding_rules",
    "stiffness_rules",
)


def design_rules() -> dict[str, Rule]:
    """Every rule that a design must keep, by name, in the order in which they are tried."""
    return {name: r for name, r in _rules(ARRAY + RIGS).items() if not r.scenes}


def scene_rules(scene: str) -> dict[str, Rule]:
    """Rules that the array must keep for that scene's rig to take it."""
    return {name: r for name, r in _rules(RIGS).items() if scene in r.scenes}


def _rules(subjects: tuple[str, ...]) -> dict[str, Rule]:
    modules = [import_module(f"{__name__}.{subject}") for subject in subjects]
    return {r.name: r for module in modules for r in vars(module).values() if isinstance(r, Rule)}


def broken_rules(design: Design) -> list[Finding]:
    """The first finding of every rule that the design breaks, in the order of the rules."""
    return _broken(design, design_rules())


def _broken(design: Design, rules: dict[str, Rule]) -> list[Finding]:
    layout = Layout(design)
    broken: list[Finding] = []
    kept: dict[str, bool] = {}  # rule -> it and all before it are kept, as those are that are not tried
    for name, rule in rules.items():
        if kept.get(rule.after, True):
            broken += rule(layout)
        kept[name] = not broken
    return broken


def refuse_broken(design: Design) -> None:
    """Raise InputError for the first rule that the design breaks, naming the others."""
    broken = broken_rules(design)
    if broken:
        first, on_readout = broken[0], _rules(READOUT)
        if first.check in on_readout:
            first = blamed(design, first, lambda d: _broken(d, on_readout))
        others = f" (and {', '.join(b.check for b in broken[1:])})" if broken[1:] else ""
        raise InputError(
            first.part,
            f"rule {first.check}{others}: {first.message}",
            value=first.value,
            legal=str(first.limit),
        )


def misfit(layout: Layout, scene: str) -> Finding | None:
    """Why the scene's rig cannot take this array; None where it can."""
    return next((finding for rule in scene_rules(scene).values() for finding in rule(layout)), None)
