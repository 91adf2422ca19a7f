"""What a reviewer asks of a part, read off its description: no kernel, no mesh."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from tactcad.assembly.stack import StackLine
from tactcad.parts.description import Extrusion, Part, Vector
from tactcad.parts.limits import Characteristic
from tactcad.parts.surface_pieces import Piece, pieces
from tactcad.scenes.requirement import DimensionLimits


@dataclass(frozen=True)
class LimitFact:
    """A toleranced dimension: nominal and limits in mm, and the features that it stands on."""

    name: str
    nominal: float
    lower: float
    upper: float
    key: bool
    between: tuple[str, ...]


@dataclass(frozen=True)
class GeometricFact:
    """A geometric tolerance: zone in mm."""

    name: str
    symbol: str
    zone: float
    round: bool
    features: tuple[str, ...]
    datums: tuple[str, ...]


@dataclass(frozen=True)
class FeatureFact:
    """A piece of a named feature's surface, exact and in the part's frame (mm): a plane through `point`
    square to `direction`, or a cylinder about the axis through `point` along `direction`. `middle` lies on
    it."""

    name: str
    kind: str
    point: Vector
    direction: Vector
    diameter: float | None
    middle: Vector


@dataclass(frozen=True)
class ShareFact:
    """A requirement of the assembled sensor that depends on the part: the share of its variance that the
    part's limits have, the arrays that keep it, and the limits with their own shares."""

    requirement: str
    unit: str
    nominal: float
    worst_low: float
    worst_high: float
    kept: float
    share: float
    limits: tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class PartFacts:
    """One part number. Mass in g; volume in mm3, None of a model file's envelope."""

    part_no: str
    name: str
    process: str
    material: str
    mass_g: float
    volume_mm3: float
    colour: str
    finish: str
    notes: tuple[str, ...]
    designation: str
    limits: tuple[LimitFact, ...]
    geometric: tuple[GeometricFact, ...]
    datums: tuple[tuple[str, str], ...]
    features: tuple[FeatureFact, ...]
    shares: tuple[ShareFact, ...]


def part_facts(part: Part, variables: dict[str, DimensionLimits], lines: Sequence[StackLine]) -> PartFacts:
    """The facts of one part.

    Parameters
    ----------
    part
        Its description.
    variables, lines
        Of the assembled sensor, as `assembly.virtual_build.Sensor` has them: what depends on the part.
    """
    return PartFacts(
        part_no=part.part_no,
        name=part.name,
        process=part.process,
        material=str(part.material),
        mass_g=part.mass,
        volume_mm3=part.volume,
        colour=part.colour,
        finish=part.finish,
        notes=part.notes,
        designation=part.purchase.designation if part.purchase else "",
        limits=tuple(map(_limit, part.characteristics)),
        geometric=tuple(
            GeometricFact(g.name, g.symbol, g.zone, g.round, g.features, g.datums) for g in part.geometric
        ),
        datums=tuple((d.letter, d.feature) for d in part.datums),
        features=tuple(_features(part)),
        shares=tuple(_shares(part, variables, lines)),
    )


def _limit(c: Characteristic) -> LimitFact:
    # to a nanometre: 0.25 - 0.005 is a binary fraction
    nominal, lower, upper = (round(value, 6) for value in (c.nominal, c.lower, c.upper))
    return LimitFact(c.name, nominal, lower, upper, c.key, c.between)


def _features(part: Part) -> Iterator[FeatureFact]:
    """Every named feature's pieces, equal ones once; an extrusion's alone."""
    if not isinstance(part.body, Extrusion):
        return
    for name in sorted(part.feature_names - {""}):
        yield from dict.fromkeys(_feature(name, piece) for piece in pieces(part, name))


def _feature(name: str, piece: Piece) -> FeatureFact:
    kind = "plane" if piece.diameter is None else "cylinder"
    return FeatureFact(name, kind, piece.point, piece.direction, piece.diameter, piece.middle)


def _of_element(v: DimensionLimits, part: Part) -> tuple[tuple[str, str], ...]:
    """The limit of an element that a variable is of: it names no part, being the same of every length."""
    is_element = {"pad_face", "stop_land"} <= part.feature_names
    found = is_element and v.element in {c.name for c in part.characteristics}
    return ((part.part_no, v.element),) if found else ()


def _shares(
    part: Part, variables: dict[str, DimensionLimits], lines: Iterable[StackLine]
) -> Iterator[ShareFact]:
    """Requirements on which the part's limits have a share, the largest share first."""
    found = []
    for line in lines:
        limits: dict[str, float] = {}
        for c in line.contributors:
            for number, name in (*variables[c.name].stated, *_of_element(variables[c.name], part)):
                if number == part.part_no:
                    limits[name] = max(limits.get(name, 0.0), c.share)
        if limits:
            r, ranked = line.requirement, sorted(limits.items(), key=lambda item: (-item[1], item[0]))
            found.append(
                ShareFact(
                    r.name,
                    r.unit,
                    line.nominal,
                    line.worst_low,
                    line.worst_high,
                    line.kept,
                    max(limits.values()),
                    tuple(ranked),
                )
            )
    yield from sorted(found, key=lambda fact: (-fact.share, fact.requirement))
