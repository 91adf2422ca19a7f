"""Changes between two records of geometry: added, removed, changed, with old and new value.

Tolerances, stated once: lengths 1e-6 mm; volumes, areas, masses, stiffness and forces a share of 1e-6 (the
kernel's agreement with the closed forms); everything else has to be equal.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import isclose
from typing import Any, Literal

from tactcad.contour import Contour, Point
from tactcad.contour.nearest import distance_to

from .geometry import Record, contour_of

LENGTH_MM = 1e-6
SHARE = 1e-6
MOST_ROWS = 8  # of a list of lists that are printed
BY_SHARE = ("_mm2", "_mm3", "_g", "_n_per_mm", "_n")


@dataclass(frozen=True)
class Change:
    """One difference. `path` leads to the value; `old` and `new` are None if there is none.

    `moved` is the largest distance (mm) of a contour from the other one, at point `at`; None for other
    values.
    """

    kind: Literal["added", "removed", "changed"]
    path: tuple[str, ...]
    old: Any
    new: Any
    moved: float | None = None
    at: Point | None = None

    def __str__(self) -> str:
        where = " / ".join(self.path)
        old, new = self.shown()
        if self.kind != "changed":
            return f"{self.kind:7} {where}: {new if self.kind == 'added' else old}"
        remark = self.remark()
        return f"changed {where}: {old} -> {new}" + (f" ({remark})" if remark else "")

    def shown(self) -> tuple[str, str]:
        """Old and new value on one line each."""
        if self.path[-1] == "contours":
            return _drawn(self.old), _drawn(self.new)
        return shown(self.old), shown(self.new)

    def remark(self) -> str:
        """The change's size: per cent of a number, millimetres of a contour."""
        if self.moved is not None:
            return f"up to {self.moved:.6g} mm apart"
        if is_number(self.old) and is_number(self.new) and self.old:
            return f"{100 * (self.new - self.old) / abs(self.old):+.3g} %"
        return ""


def differences(old: Record, new: Record) -> list[Change]:
    """Every difference, in the order of the records; a part or hole that is only in one counts once."""
    return list(_compare(old, new, ()))


def _compare(old: Any, new: Any, path: tuple[str, ...]) -> Iterator[Change]:
    if isinstance(old, dict) and isinstance(new, dict):
        for key in [*old, *(k for k in new if k not in old)]:
            here = (*path, key)
            if key not in new:
                yield Change("removed", here, old[key], None)
            elif key not in old:
                yield Change("added", here, None, new[key])
            else:
                yield from _compare(old[key], new[key], here)
    elif path[-1:] == ("contours",):
        yield from _compare_contours(old, new, path)
    elif path[:1] == ("values",):  # the user's own text: every digit counts
        if old != new:
            yield Change("changed", path, old, new)
    elif not _same(old, new, path[-1] if path else ""):
        yield Change("changed", path, old, new)


def _same(old: Any, new: Any, name: str) -> bool:
    if isinstance(old, list) and isinstance(new, list):
        return len(old) == len(new) and all(_same(a, b, name) for a, b in zip(old, new))
    if is_number(old) and is_number(new):
        if name.endswith(BY_SHARE):
            return isclose(old, new, rel_tol=SHARE, abs_tol=0.0)
        return abs(old - new) <= LENGTH_MM
    return type(old) is type(new) and old == new


def is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _compare_contours(old: list, new: list, path: tuple[str, ...]) -> Iterator[Change]:
    """Contours differ if they do not cover the same curve; their division into segments does not
    matter.
    """
    if old == new:
        return
    before, after = [contour_of(rows) for rows in old], [contour_of(rows) for rows in new]
    if not before or not after:
        yield Change("changed", path, old, new)
        return
    moved, at = max(_stray(before, after), _stray(after, before))
    if moved > LENGTH_MM:
        yield Change("changed", path, old, new, moved, at)


def _stray(contours: list[Contour], others: list[Contour]) -> tuple[float, Point]:
    """Largest distance (mm) of ends and middles of the one's segments from the others' curves, and where."""
    segments = [s for c in others for s in c]
    points = [s.at(u) for c in contours for s in c for u in (0.0, 0.5)]
    return max((min(distance_to(s, p) for s in segments), p) for p in points)


def shown(value: Any) -> str:
    """A value on one line: numbers to nine digits, of a whole part or hole its first values."""
    if isinstance(value, dict):
        plain = [
            f"{k} {shown(v)}"
            for k, v in value.items()
            if not isinstance(v, dict | list) and v not in (None, "")
        ]
        return ", ".join(plain[:6])
    if isinstance(value, list) and len(value) > MOST_ROWS and isinstance(value[0], list):
        return f"{len(value)} rows"
    if isinstance(value, list):
        return "[" + ", ".join(shown(v) for v in value) + "]"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.9g}"
    return "none" if value is None else str(value).replace("\n", "\\n") or '""'


def _drawn(contours: list | None) -> str:
    if contours is None:
        return "none"
    return f"{sum(len(c) for c in contours)} segments in {len(contours)} contours"
