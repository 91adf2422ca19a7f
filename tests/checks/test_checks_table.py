"""docs/checks.md has every check that the code can report, with the message that its bad part really gets."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest
from bad_parts import BAD

from tactcad.checks.check import declared
from tactcad.design.tree import Design
from tactcad.scenes.rig import all_rigs

ROOT = Path(__file__).parents[2]
FAMILIES = ("tactcad.checks.facing_rows", "tactcad.families.planar.checks")
sys.path.append(str(ROOT / "tests" / "mutation"))


def names_in_code() -> set[str]:
    import mutants

    return {m.name for m in mutants.findings()}


def test_every_check_in_the_code_has_its_bad_part():
    for name in names_in_code() - set(BAD):
        pytest.fail(f"check {name} has no bad part: add one to tests/bad_parts.py")
    assert set(BAD) == names_in_code()
    for name, bad in BAD.items():
        assert (ROOT / bad.test).is_file(), name


# Bad parts that are the shipped array with a value changed: its next revision changes the numbers, not the
# words.
OF_THE_SHIPPED = {
    "strength",
    "fatigue",
    "circuit",
    "signals",
    "clearance",
    "assembly",
    "rigidity",
    "planar strength",
    "calibration travel",
    "moving weight",
    "scenes left out",
    "golden",
}


@pytest.mark.cad
def test_the_table_says_what_the_checks_say():
    """Where this fails, run `python tests/checks_table.py` and read what it changes."""
    import checks_table

    text = checks_table.DOCUMENT.read_text(encoding="utf-8")
    now = checks_table.renewed(text)

    def comparable(document: str) -> list[str]:
        run, lines = "", []
        for line in document.splitlines():
            run = (line.split(" | ")[0].strip("| ") or run) if line.startswith("| ") else ""
            lines.append(re.sub(r"[0-9.]+", "#", line) if run in OF_THE_SHIPPED else line)
        return lines

    assert comparable(now) == comparable(text)


def test_every_timed_check_has_its_rows():
    timed = {c.name for folder in ("described", *FAMILIES, "on_solids") for c in declared(folder)}
    timed |= {"build", "origins", "scenes left out"} | {
        name for rig in all_rigs(Design).values() for name, _ in rig.checks
    }
    assert timed - {"configurations"} == {bad.run for bad in BAD.values()} - {"golden"}
