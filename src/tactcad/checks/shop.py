"""The limits of a wire-EDM shop, read from a file that the shop can write."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import isfinite
from pathlib import Path
from typing import Any

from tactcad.design.files import read_text
from tactcad.design.messages import InputError, one_of
from tactcad.design.toml_text import parse_toml

MOST_BYTES = 100_000  # a page of limits and their sources
DEFAULT = Path(__file__).parent / "data" / "shop.toml"


@dataclass(frozen=True)
class Limits:
    """Limits in mm, all positive.

    wire_diameter            of the wire that is used
    spark_gap                between wire and cut face, per side
    advised_slot             narrower slots are flagged
    wall, wall_aluminium     thinnest free-standing wall, and in aluminium
    thinnest_published_web   thinner hinges are flagged as not known to have been cut
    start_hole               smallest hole through which the wire is threaded
    """

    wire_diameter: float
    spark_gap: float
    advised_slot: float
    wall: float
    wall_aluminium: float
    thinnest_published_web: float
    start_hole: float

    @property
    def corner_radius(self) -> float:
        """Smallest inside radius that the wire leaves."""
        return self.wire_diameter / 2 + self.spark_gap

    @property
    def slot(self) -> float:
        """Width of a single cut."""
        return self.wire_diameter + 2 * self.spark_gap


@dataclass(frozen=True)
class Shop:
    """A shop's limits, and where each is from (by field name)."""

    name: str
    limits: Limits
    source: Mapping[str, str]


def load_shop(path: str | Path = DEFAULT) -> Shop:
    """Read a shop file. Raises InputError where it cannot be read or a field is missing, unknown or not legal."""
    where = str(path)
    table = parse_toml(read_text(path, MOST_BYTES, "a shop file (TOML)"), where)
    _names(where, "", table, {"name", "limits", "source"})
    if not isinstance(table["name"], str):
        raise InputError(f"{where}: name", "is no text", value=table["name"])
    known = {f.name for f in fields(Limits)}
    for section in ("limits", "source"):
        if not isinstance(table[section], dict):
            raise InputError(f"{where}: {section}", "is no table", value=table[section])
        _names(where, f"{section}.", table[section], known)
    limits = Limits(**{name: _length(f"{where}: limits.{name}", v) for name, v in table["limits"].items()})
    for name, text in table["source"].items():
        if not isinstance(text, str) or not text.strip():
            raise InputError(f"{where}: source.{name}", "is no text", value=text, legal="where the limit is from")
    return Shop(table["name"], limits, table["source"])


def _names(where: str, path: str, table: Mapping[str, Any], known: set[str]) -> None:
    for name in [*table, *known]:
        if name not in known:
            raise InputError(f"{where}: {path}{name}", "unknown field", legal=one_of(name, sorted(known)))
        if name not in table:
            raise InputError(f"{where}: {path}{name}", "missing field")


def _length(where: str, value: object) -> float:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if not (number and isfinite(value) and 0 < value <= 100):
        raise InputError(where, "is no length", value=value, legal="mm, more than 0, at most 100")
    return float(value)
