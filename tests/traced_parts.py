"""Electronic parts that remember when a figure of theirs is asked for."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from unittest.mock import patch

from tactcad.design import sensing
from tactcad.parts.bought.electronic_parts import parts_used


class _Traced:
    def __init__(self, part: sensing.Bought, seen: set[str]) -> None:
        self._part, self._seen = part, seen

    def __getattr__(self, name: str):
        if name not in ("name", "maker", "mpn", "verified"):
            self._seen.add(self._part.name)
        return getattr(self._part, name)


def unnamed(design, asked: set[str], message: str) -> set[str]:
    """Of the design's parts that were asked for figures those that a message does not name as unread."""
    own = {part.name for part in parts_used(design).values()}
    assert asked & own
    return {name for name in asked & own if name not in message.partition("; unread: ")[2]}


@contextmanager
def asked_parts() -> Iterator[set[str]]:
    """Names of the parts whose figures are asked for meanwhile; none of them counts as read."""
    seen: set[str] = set()
    tables = [
        table
        for table in vars(sensing).values()
        if isinstance(table, dict) and any(isinstance(part, sensing.Bought) for part in table.values())
    ]
    found = [{n: _Traced(replace(p, verified=False), seen) for n, p in table.items()} for table in tables]
    patches = [patch.dict(table, traced) for table, traced in zip(tables, found)]
    for one in patches:
        one.start()
    try:
        yield seen
    finally:
        for one in patches:
            one.stop()
