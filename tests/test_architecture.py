"""docs/architecture.md draws the rooms as tests/test_rooms.py has them, and says truly who imports whom."""

from __future__ import annotations

import re
from pathlib import Path

from test_rooms import MODULES, ROOMS, dotted, imports_of, room

PAGE = (Path(__file__).parents[1] / "docs" / "architecture.md").read_text("utf-8")


def test_the_picture_has_every_room_from_the_top_down():
    levels = re.findall(r"^    \| ([a-z ]+?) *\|", PAGE, re.MULTILINE)
    assert [name for level in reversed(levels) for name in level.split()] == list(ROOMS)


def test_the_table_says_who_imports_whom():
    imported: dict[str, set[str]] = {name: set() for name in ROOMS}
    for path in MODULES:
        if here := room(dotted(path)):
            imported[here] |= {room(name) for name in imports_of(path)} - {here, ""}
    said = re.findall(r"^\| `(\w+)` \| [^|]+ \| ([a-z, ]+) \|$", PAGE, re.MULTILINE)
    wanted = [(name, ", ".join(r for r in ROOMS if r in imported[name]) or "nothing") for name in ROOMS]
    assert said == wanted
