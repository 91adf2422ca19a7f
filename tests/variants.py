"""Designs for tests: the shipped ones with a few values changed."""

from __future__ import annotations

import copy
import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from tactcad.design.load import from_table
from tactcad.design.tree import Design

HARDWARE = Path(__file__).parents[1] / "hardware"
# Shipped designs of facing rows, which have [array]: tests of what is facing rows' own take these.
FACING_ROWS = sorted(
    p.stem for p in HARDWARE.glob("*.toml") if "array" in tomllib.loads(p.read_text("utf-8"))
)
DROP = object()
# All that a text or table of the published array needs of its origins: its modulus is not its alloy's.
ORIGIN = {"material.youngs_modulus": "paper: 69000 MPa"}
# A gauge that lies on the floor of the array's slot, between its fillets.
IN_SLOT = {"gauge.carrier_arm_side": 0.14, "gauge.carrier_body_side": 0.14, "gauge.grid_length": 0.2}
# One element on ledges of 3 mm under a stop plate of 44; a row of blanks on dowels near their fronts.
ROCKING_PLATE = {
    "array.row_arms": [[4.0]],
    "array.pitch": 24.0,
    "array.spacer": 21.0,
    "clamp.mount_pitch_y": 30.0,
}
ROCKING_BLANK = {
    "array.row_arms": [[6.0, 6.0]],
    "element.rear_length": 150.0,
    "holes.dowel_offsets": [3.5],
    "holes.screw_offsets": [9.1],
}


def one_letter(text: str) -> str:
    """A design's text without the letters that parts keep: of what is changed, parts may be gone."""
    return re.sub(r"(?s)\n\[design\.unchanged\.\w+\]\n.*?(?=\n\[|\Z)", "", text)


BARE_TEXT = (
    one_letter((HARDWARE / "macro-array.toml").read_text("utf-8")).split("\n[origin]\n")[0]
    + '\n[origin]\n"material.youngs_modulus" = "paper: 69000 MPa"\n'
)


def without_rigs(name: str) -> str:
    """The text of a shipped design with its array only."""
    return array_only((HARDWARE / f"{name}.toml").read_text("utf-8"))


def array_only(text: str) -> str:
    """A design's text without the tables of rigs."""
    text = one_letter(text)
    return re.sub(r"(?s)\n\[(calibration|sample|cart|holder|grasping|bonding)\]\n.*?(?=\n\[|\Z)", "", text)


# The shipped array's file with one element, no rig and the name tiny.
TINY_TEXT = (
    array_only(BARE_TEXT)
    .replace('name = "macro-array"', 'name = "tiny"')
    .replace("[[4, 7, 6, 8, 6], [8, 5, 4, 5, 7]]", "[[5]]")
)


@cache
def _table(base: str) -> dict[str, Any]:
    return tomllib.loads(one_letter((HARDWARE / f"{base}.toml").read_text("utf-8")))


def table(changes: dict[str, Any] | None = None, base: str = "macro-array") -> dict[str, Any]:
    """The design file of that name as TOML gives it, with values by dotted path set, or dropped (DROP)."""
    tree = copy.deepcopy(_table(base))
    for path, value in (changes or {}).items():
        *sections, name = path.split(".")
        node = tree
        for section in sections:
            node = node.setdefault(section, {})
        if value is DROP:
            del node[name]
        else:
            node[name] = value
    return tree


def variant(changes: dict[str, Any] | None = None, base: str = "macro-array") -> Design:
    """That table as a design. Rules between fields are not tried. Origins are left out but for the
    material's, without which its values would have to be those of its name."""
    tree = table(changes, base)
    origin = tree.pop("origin", {})
    return from_table(tree | {"origin": {k: v for k, v in ORIGIN.items() if k in origin}})
