"""The limits of a workshop, wire cutting and machining, read from a file that the shop can write."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from tactcad.design.fields import shown_text
from tactcad.design.files import read_text
from tactcad.design.messages import InputError, one_of
from tactcad.design.text_values import parse_toml

MOST_BYTES = 100_000  # a page of limits and their sources
OPTIONAL = {"machining", "machining_source", "feed", "feed_source"}
DEFAULT = Path(__file__).parent / "data" / "shop.toml"


@dataclass(frozen=True)
class Limits:
    """Limits of wire cutting in mm, all positive.

    wire_diameter            of the wire
    spark_gap                between wire and cut face, per side
    advised_slot             narrower slots are flagged
    wall, wall_aluminium     thinnest free-standing wall, and in aluminium
    thinnest_published_web   thinner hinges are flagged: no published cut is known
    start_hole               smallest hole for threading the wire
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
class Machining:
    """Limits of mills, drills, taps and a lathe; mm unless stated otherwise, all positive.

    cutter_radius      smallest radius that a cutter leaves
    cutter_reach       depth that it reaches, in diameters
    drill              smallest drilled hole
    drill_reach        depth of a hole, in diameters
    thread_reach       length of full thread, in diameters
    run_out            between full thread and drilled depth, in pitches
    wall, wall_least   thinner walls and webs between holes are flagged, and fail
    floor              thinnest floor of a pocket or a blind hole
    ring               thinnest wall of a turned ring
    slenderness        largest length of a turned part, in diameters
    """

    cutter_radius: float
    cutter_reach: float
    drill: float
    drill_reach: float
    thread_reach: float
    run_out: float
    wall: float
    wall_least: float
    floor: float
    ring: float
    slenderness: float


@dataclass(frozen=True)
class Feed:
    """Cutting speeds of the wire, all positive.

    area        mm2 of cut face a minute in the main cut
    most        mm a minute that the main cut does not pass, however thin the sheet
    skim        mm a minute in every further pass
    threading   minutes to thread the wire and start, for every contour
    """

    area: float
    most: float
    skim: float
    threading: float


@dataclass(frozen=True)
class Shop:
    """A shop's limits, and where each is from (by field name)."""

    name: str
    limits: Limits
    source: Mapping[str, str]
    machining: Machining
    machining_source: Mapping[str, str]
    feed: Feed
    feed_source: Mapping[str, str]


def load_shop(path: str | Path = DEFAULT) -> Shop:
    """Read a shop file: name, [limits] and [source] of its wire cutting, and optionally [feed],
    [feed_source], [machining] and [machining_source]: all values, or those that differ from tactcad's own.

    Raises InputError if it cannot be read or a field is missing, unknown or not legal.
    """
    where = str(path)
    table = parse_toml(read_text(path, MOST_BYTES, "a shop file (TOML)"), where)
    _names(where, "", table, {"name", "limits", "source"}, OPTIONAL)
    shown_text(table["name"], f"{where}: name", "what the shop is called")
    limits, source = _section(where, table, Limits, "limits", "source")
    usual = None if path == DEFAULT else load_shop()
    machining = _section(where, table, Machining, "machining", "machining_source", usual)
    feed = _section(where, table, Feed, "feed", "feed_source", usual)
    return Shop(table["name"], limits, source, *machining, *feed)


def _section(
    where: str, table: Mapping[str, Any], kind: type, name: str, source_name: str, usual: Shop | None = None
) -> tuple[Any, Mapping[str, str]]:
    """Limits and their sources from two tables of the same fields; missing ones are taken from `usual`,
    where given.
    """
    known = {f.name for f in fields(kind)}
    given = []
    for section in (name, source_name):
        values = table.get(section, {})
        if not isinstance(values, dict):
            raise InputError(f"{where}: {section}", "is no table", value=values)
        _names(where, f"{section}.", values, set() if usual else known, known)
        given.append(values)
    values, source = given
    for one in values:
        if one not in source:
            raise InputError(
                f"{where}: {source_name}.{one}", "missing field", legal="where the limit is from"
            )
    values = {one: _size(f"{where}: {name}.{one}", v) for one, v in values.items()}
    for one, text in source.items():
        shown_text(text, f"{where}: {source_name}.{one}", "where the limit is from")
    if usual:
        values = {**vars(getattr(usual, name)), **values}
        source = {**getattr(usual, source_name), **source}
    return kind(**values), source


def _names(where: str, path: str, table: Mapping[str, Any], needed: set[str], known: set[str]) -> None:
    known = known | needed
    for name in table:
        if name not in known:
            raise InputError(f"{where}: {path}{name}", "unknown field", legal=one_of(name, sorted(known)))
    for name in sorted(needed):
        if name not in table:
            raise InputError(f"{where}: {path}{name}", "missing field")


def _size(where: str, value: object) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool) or not 0 < value <= 100:
        legal = "mm, diameters, pitches, or as a feed is stated, more than 0, at most 100"
        raise InputError(where, "is no size", value=value, legal=legal)
    return float(value)
