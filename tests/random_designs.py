"""Designs drawn over everything that a design file may hold, and the verdict on each.

Every second one is a sound design (sound_designs.py), the others have one to three of their fields drawn
again over the field's whole legal range, whatever the rest says. A design is written as TOML, read as
commands read it, and either refused by a rule that it breaks, or it passes every check.
"""

from __future__ import annotations

import json
import tempfile
import traceback
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Any

from sound_designs import LEGAL, Draw, as_table, sound_table

from tactcad.design.family import section_types
from tactcad.design.fields import OneOf
from tactcad.design.messages import InputError
from tactcad.design.tree import Design

NAMED = 4  # rules that the line of counts names
# Letters of names and titles: more than ASCII, quotes and backslashes among them.
TITLE = "aZ09 -_.,:;/\\\"'<>&#%äßøŁжλ日本語€"
CHOICES = {
    f"{section}.{name}": f.metadata["spec"].options
    for section, kind in section_types(Design).items()
    if section != "origin"
    for name, f in kind.__dataclass_fields__.items()
    if isinstance(f.metadata.get("spec"), OneOf)
}


def raw_table(number: int, row_lengths: tuple[int, ...], rigs: float) -> dict[str, Any]:
    """The design file of that draw as TOML gives it; `rigs` is the share of designs that have any."""
    random = Random(number)
    values = sound_table(random.randrange(2**48), row_lengths, rigs=random.random() < rigs)
    if random.random() < 0.5:
        redraw(values, random)
    tree = as_table(values)
    name = "".join(
        random.choice("abcdefghijklmnopqrstuvwxyz0123456789-") for _ in range(random.randint(1, 38))
    )
    tree["design"] |= {
        "name": f"x{name}x",
        "title": "".join(random.choice(TITLE) for _ in range(random.randint(0, 70))) + "!",
        "revision": random.choice(("A", "Z", "AB")),
        "date": f"20{random.randint(10, 99)}-{random.randint(1, 12):02d}-{random.randint(1, 28):02d}",
    }
    return tree


def redraw(values: dict[str, Any], random: Random) -> None:
    """One to three fields anywhere in their ranges."""
    again = Draw(random.randrange(2**48), ends=5)
    for path in random.sample(sorted(values), random.randint(1, 3)):
        field_path = ".".join(p for p in path.split(".") if not p.isdigit() and p != "override")
        if isinstance(values[path], dict):
            values[path] = {key: again.number(path) for key in values[path]}
        elif field_path in LEGAL:
            values[path] = again.number(field_path)
        elif path in CHOICES:
            values[path] = again.choice(*CHOICES[path])
        elif path in ("holes.screw_offsets", "holes.dowel_offsets"):
            values[path] = [again.between(0.1, 200.0) for _ in range(random.randint(1, 4))]
        elif path == "array.row_arms":
            values[path] = [[again.between(0.1, 100.0) for _ in row] for row in values[path]]


def as_toml(tree: dict[str, Any], path: tuple[str, ...] = ()) -> str:
    """TOML text of nested tables; JSON's text of numbers, strings and lists is TOML's too."""
    lines = [f"[{'.'.join(path)}]"] if path else []
    lines += [f"{json.dumps(key)} = {json.dumps(v)}" for key, v in tree.items() if not isinstance(v, dict)]
    return "\n".join([*lines, *(as_toml(v, (*path, key)) for key, v in tree.items() if isinstance(v, dict))])


@dataclass(frozen=True)
class Judged:
    """The rule that refuses a design ("" where none does), its scenes, and what the checks have against
    it."""

    rule: str
    scenes: tuple[str, ...]
    failed: tuple[str, ...]


@dataclass
class Counts:
    """What became of the designs drawn so far."""

    drawn: int = 0
    accepted: int = 0
    refused: Counter = field(default_factory=Counter)
    scenes: Counter = field(default_factory=Counter)
    failed: list[str] = field(default_factory=list)

    def judge(self, who: str, tree: dict[str, Any]) -> None:
        """Count the design as accepted, as refused by its rule, or as failed, with what the checks have
        against it."""
        self.add(who, judged(tree))

    def add(self, who: str, one: Judged) -> None:
        self.drawn += 1
        if one.rule:
            self.refused[one.rule] += 1
        elif not one.failed:
            self.accepted += 1
            self.scenes.update(one.scenes)
        else:
            more = f" and {len(one.failed) - 3} more" if one.failed[3:] else ""
            self.failed.append(f"{who}: {'; '.join(one.failed[:3])}{more}")

    def __str__(self) -> str:
        refused = sum(self.refused.values())
        most = ", ".join(f"{rule} {n}" for rule, n in self.refused.most_common(NAMED))
        if len(self.refused) > NAMED:
            most += f", and {len(self.refused) - NAMED} other rules"
        scenes = ", ".join(f"{name} {n}" for name, n in self.scenes.items())
        return (
            f"{self.drawn} designs drawn: {self.accepted} accepted ({scenes}), {refused} refused by a named "
            "rule "
            f"({most}), {len(self.failed)} failed"
        )


def judged(tree: dict[str, Any]) -> Judged:
    """The verdict; a crash is a failure as any other, and says where it was."""
    try:
        rule, scenes, failed = verdict(tree)
    except Exception as error:
        at = traceback.extract_tb(error.__traceback__)[-1]
        return Judged("", (), (f"{type(error).__name__} in {at.name}, line {at.lineno}: {error}",))
    return Judged(rule, scenes, tuple(failed))


def verdict(tree: dict[str, Any]) -> tuple[str, tuple[str, ...], list[str]]:
    """The rule that refuses the design ("" where none does), its scenes, and what the checks have against
    it."""
    from tactcad.checks.run import run_checks
    from tactcad.parts.rules import load
    from tactcad.scenes import scene_names

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "design.toml"
        file.write_text(as_toml(tree), encoding="utf-8")
        try:
            design = load(file)
        except InputError as error:
            assert error.legal, f"refused without saying what is legal: {error}"
            return _rule(error), (), []
    names = scene_names(design)
    # tolerances drawn over their whole ranges mostly do not add up; tests/stacks draws usual ones
    failures = [f for f in run_checks(design, names).failures if f.check != "assembly"]
    shop = [f for f in failures if f.check in SHOP_RULES | WISHES]
    if shop and len(shop) == len(failures):
        return f"{'shop' if shop[0].check in SHOP_RULES else 'wish'}: {shop[0].check}", (), []
    return "", names, [str(f) for f in failures if f not in shop]


# Rules of the shop's file: a design may break them and be good for another shop.
SHOP_RULES = frozenset({"inside corner", "slot width", "wall", "start hole"})
# What a load gives is known to the estimator only, not to a rule: such a design is refused by its check.
WISHES = frozenset({"signal-range", "force-resolution"})


def _rule(error: InputError) -> str:
    """The rule's name; a value outside its own range is refused by that range."""
    return (
        error.what.removeprefix("rule ").split(" ")[0].rstrip(":")
        if error.what.startswith("rule ")
        else "range"
    )
