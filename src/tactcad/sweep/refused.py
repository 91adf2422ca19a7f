"""Which designs of a chunk are refused, each with the first reason that was found."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

# Of a chunk: all of them, which takes views instead of copies, or those of an index.
Rows = slice | NDArray[np.int64]
ALL = slice(None)


class Refused:
    """Of `count` designs, which are `valid`, and of the others `reason` ("" of a valid one)."""

    def __init__(self, count: int) -> None:
        self.valid = np.ones(count, bool)
        self._reason: NDArray[Any] | None = None  # made when one is refused: mostly none is

    @property
    def reason(self) -> NDArray[Any]:
        if self._reason is None:
            self._reason = np.full(len(self.valid), "", object)
        return self._reason

    def add(self, rows: Rows, why: NDArray[Any] | str) -> None:
        """Refuse those of the rows that are not refused yet and have a reason that is not ""."""
        index = np.arange(len(self.valid))[rows]
        first = self.valid[index]
        self.reason[index[first]] = np.broadcast_to(why, len(index))[first]
        self.valid[index] = self.reason[index] == ""

    def left(self, rows: Rows) -> Rows:
        """Those of the rows that are not refused."""
        if isinstance(rows, slice) and self.valid.all():
            return rows
        index = np.arange(len(self.valid))[rows]
        return index[self.valid[index]]
