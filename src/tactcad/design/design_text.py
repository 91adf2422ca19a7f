"""A design as the text of a design file: what `load.parse` reads back as the same design."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

from .tree import Design


def design_text(design: Design, heading: str = "") -> str:
    """TOML text of a design: every table with every value that is not derived, then their origins.

    Parameters
    ----------
    design
        As read or made.
    heading
        Lines of comment before the first table.
    """
    lines = [f"# {line}".rstrip() for line in heading.splitlines()]
    for f in dataclasses.fields(design):
        table = getattr(design, f.name)
        if f.name == "origin" or table is None:
            continue
        lines += ["", f"[{f.name}]", *_values(table)]
        for number, hinge in getattr(table, "override", {}).items():
            lines += ["", f"[{f.name}.override.{number}]", *_values(hinge)]
        if getattr(table, "gaps", None):
            lines += ["", f"[{f.name}.gaps]", *(f'"{arm!r}" = {gap!r}' for arm, gap in table.gaps.items())]
    if design.origin:
        lines += ["", "[origin]", *(f"{json.dumps(path)} = {_text(v)}" for path, v in design.origin.items())]
    return "\n".join(lines).lstrip("\n") + "\n"


def _values(table: Any) -> list[str]:
    return [
        f"{f.name} = {_text(getattr(table, f.name))}"
        for f in dataclasses.fields(table)
        if "spec" in f.metadata and f.name != "gaps" and getattr(table, f.name) is not None
    ]


def _text(value: Any) -> str:
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, tuple):
        return "[" + ", ".join(_text(v) for v in value) + "]"
    return repr(value)
