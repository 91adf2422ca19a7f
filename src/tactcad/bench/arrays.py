"""The published array with its rows repeated to a number of elements."""

from __future__ import annotations

import dataclasses
import tomllib
from collections.abc import Sequence
from functools import lru_cache

from tactcad.design.load import DEFAULT_DESIGN, find, parse
from tactcad.design.tree import Design

LONGER = 0.5  # mm, of the first arm where a design is to differ


@lru_cache(maxsize=1)
def published_text() -> str:
    return find(DEFAULT_DESIGN).read_text("utf-8")


def published() -> Design:
    """The design as shipped."""
    return parse(published_text(), DEFAULT_DESIGN)


def text(elements: int, changed: bool = False) -> str:
    """The design file of an array of that many elements, an even number; `changed` makes its first arm
    longer."""
    (line,) = (line for line in published_text().splitlines() if line.startswith("row_arms"))
    rows = _repeated(tomllib.loads(line)["row_arms"], elements)
    if changed:
        rows[0][0] += LONGER
    return published_text().replace(line, f"row_arms = {rows}")


def of(elements: int) -> Design:
    """The same as a design."""
    design = published()
    rows = tuple(map(tuple, _repeated(design.array.row_arms, elements)))
    return dataclasses.replace(design, array=dataclasses.replace(design.array, row_arms=rows))


def _repeated(rows: Sequence[Sequence[float]], elements: int) -> list[list[float]]:
    return [[row[i % len(row)] for i in range(elements // 2)] for row in rows]
